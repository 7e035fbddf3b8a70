"""Loads on bodies (`eventpound.motion.loads`) in the equations of motion of one mode.

A mode knows its clusters by links: each load has one of its own, without a law, from its body
to the ground. What is pushed at a barrier has no link that moves.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from eventpound.motion.loads import (
    body_of,
    heavy_mass,
    is_driven,
    load_taylor,
    load_value,
    own_mass,
    row_of_link,
)
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import kernel


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
            rate[system.iv[c]] = load_value(row, forcing, t)
        elif system.mass[c] < heavy:
            rate[system.iv[c]] += load_value(row, forcing, t)


@kernel
def carried_loads(t: float, system: Any, forcing: Any, out: Floats) -> None:
    """Forces at the time t (s) on bodies that move with a support into `out` (C,) (N)."""
    coefficients, heavy = forcing.coefficients, heavy_mass(forcing.coefficients)
    for c in range(out.size):
        out[c] = 0.0
    for a in range(system.link.size):
        row, c = row_of_link(system.link[a], coefficients), system.ends[a, 0]
        if row > 0 and not is_driven(row, coefficients) and system.mass[c] >= heavy:
            out[c] += load_value(row, forcing, t)


@kernel
def add_load_coefficients(
    t: float, system: Any, forcing: Any, order: int, carried: bool, force: Floats
) -> None:
    """Add the Taylor coefficients of the loads at the time t (s) to `force` (order, C) (N).

    To a cluster with a support only that of what drives it; or, `carried`, the others only.
    """
    coefficients, heavy = forcing.coefficients, heavy_mass(forcing.coefficients)
    work = force[:, 0].copy()
    for a in range(system.link.size):
        row, c = row_of_link(system.link[a], coefficients), system.ends[a, 0]
        if row <= 0:
            continue
        if (is_driven(row, coefficients) or system.mass[c] < heavy) != carried:
            load_taylor(row, forcing, t, order, work)
            for k in range(order):
                force[k, c] += work[k]


@kernel
def masses_without_supports(system: Any, forcing: Any) -> Floats:
    """Mass of each cluster without the support in it, shape (C,) (kg)."""
    mass = np.zeros(system.mass.size)
    for a in range(system.link.size):
        row = row_of_link(system.link[a], forcing.coefficients)
        if row > 0:
            mass[system.ends[a, 0]] += own_mass(row, forcing.coefficients)
    return mass


@kernel
def support_of(link: int, coefficients: Floats) -> int:
    """The support that the load of a link of a mode drives, from 0; -1 of any other link."""
    row = row_of_link(link, coefficients)
    return body_of(row, coefficients) if row > 0 and is_driven(row, coefficients) else -1


@kernel
def input_forces(
    own: Floats, system: Any, forcing: Any, forces: Floats, ground: float, out: Floats
) -> None:
    """Forces that give clusters energy, times whose velocity is a power (N).

    Loads and the ground push a cluster; a support gives what moves with it what that takes.

    Parameters
    ----------
    own : ndarray, shape (C,)
        `masses_without_supports`.
    system, forcing : Reduced, Forcing
        The mode; the piece, LOADED.
    forces : ndarray, shape (4, C)
        Forces of the links on the clusters, without and with the loads (N); accelerations
        relative to the ground (m/s²); loads on bodies that move with a support (N).
    ground : float
        Ground acceleration (m/s²).
    out : ndarray, shape (2, C)
        Overwritten: what the ground and loads give, what the support in a cluster gives. Like
        all others perhaps Taylor coefficients of one order.
    """
    heavy = heavy_mass(forcing.coefficients)
    pulled, pushed, a, carried = forces[0], forces[1], forces[2], forces[3]
    for c in range(own.size):
        if system.mass[c] >= heavy:
            out[0, c] = carried[c] - own[c] * ground
            out[1, c] = own[c] * (a[c] + ground) - pulled[c] - carried[c]
        else:
            out[0, c] = pushed[c] - pulled[c] - own[c] * ground
            out[1, c] = 0.0
