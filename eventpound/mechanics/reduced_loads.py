"""Loads on bodies (`eventpound.motion.loads`) in the equations of motion of one mode.

A mode knows its clusters by links: each load has one of its own, without a law, from its body
to the ground. What is pushed at a barrier has no link that moves.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from eventpound.motion.loads import (
    heavy_mass,
    is_driven,
    load_taylor,
    load_value,
    own_mass,
    row_of_link,
)
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import deferred_kernel, kernel


@kernel
def add_loads(t: float, system: Any, forcing: Any, rate: Floats) -> None:
    """Add the loads at the time t (s) to the forces on clusters, which stand in place of v'.

    Of a cluster with a support only what drives that counts.
    """
    coefficients, heavy = forcing.coefficients, heavy_mass(forcing.coefficients)
    for a in range(system.link.size):
        row = row_of_link(system.link[a], coefficients)
        if row <= 0:
            continue
        c = system.ends[a, 0]
        if is_driven(row, coefficients):
            rate[system.iv[c]] = load_value(row, coefficients, forcing.samples, t)
        elif system.mass[c] < heavy:
            rate[system.iv[c]] += load_value(row, coefficients, forcing.samples, t)


@deferred_kernel
def add_load_coefficients(t: float, system: Any, forcing: Any, order: int, force: Floats) -> None:
    """Add the Taylor coefficients of the loads at the time t (s) to `force` (order, C) (N).

    To a cluster with a support only that of what drives it.
    """
    coefficients, heavy = forcing.coefficients, heavy_mass(forcing.coefficients)
    work = force[:, 0].copy()
    for a in range(system.link.size):
        row, c = row_of_link(system.link[a], coefficients), system.ends[a, 0]
        if row > 0 and (is_driven(row, coefficients) or system.mass[c] < heavy):
            load_taylor(row, coefficients, forcing.samples, t, order, work)
            for k in range(order):
                force[k, c] += work[k]


@deferred_kernel
def masses_without_supports(system: Any, forcing: Any) -> Floats:
    """Mass of each cluster without the support in it, shape (C,) (kg)."""
    mass = np.zeros(system.mass.size)
    for a in range(system.link.size):
        row = row_of_link(system.link[a], forcing.coefficients)
        if row > 0:
            mass[system.ends[a, 0]] += own_mass(row, forcing.coefficients)
    return mass


@deferred_kernel
def input_forces(
    own: Floats,
    system: Any,
    forcing: Any,
    pulled: Floats,
    pushed: Floats,
    a: Floats,
    ground: float,
    out: Floats,
) -> None:
    """Forces that give clusters energy, times whose velocity is the power of the input (N).

    Loads and the ground push a cluster; a support gives what moves with it what that takes.

    Parameters
    ----------
    own : ndarray, shape (C,)
        `masses_without_supports`.
    system, forcing : Reduced, Forcing
        The mode; the piece, LOADED.
    pulled, pushed : ndarray, shape (C,)
        Forces of the links on the clusters, without and with the loads (N).
    a : ndarray, shape (C,)
        Accelerations relative to the ground (m/s²).
    ground : float
        Ground acceleration (m/s²).
    out : ndarray, shape (C,)
        Overwritten. Like all others perhaps Taylor coefficients of one order.
    """
    heavy = heavy_mass(forcing.coefficients)
    for c in range(own.size):
        if system.mass[c] >= heavy:
            out[c] = own[c] * a[c] - pulled[c]
        else:
            out[c] = pushed[c] - pulled[c] - own[c] * ground
