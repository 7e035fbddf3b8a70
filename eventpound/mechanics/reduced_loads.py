"""Loads on bodies (`eventpound.motion.loads`) in the equations of motion of one mode.

A mode knows its clusters by links: each load has one of its own, without a law, from its body
to the ground. What is pushed at a barrier has no link that moves.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from eventpound.mechanics.followers import answers, force_or_given, supports_of
from eventpound.motion.loads import (
    LOADED,
    body_of,
    is_driven,
    load_taylor,
    row_of_link,
    support_motion,
)
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import kernel


@kernel
def place_supports(t: float, system: Any, forcing: Any, y: Floats) -> None:
    """Put the clusters of supports where these are at the time t (s) into y (size,).

    What follows them goes along by its part, so that it stays on its constraints.
    A support is the first body of its cluster, which has no offset; of several that one counts.
    """
    for a in range(system.link.size - 1, -1, -1):
        row, c = row_of_link(system.link[a], forcing.coefficients), system.ends[a, 0]
        if row > 0 and is_driven(row, forcing.coefficients):
            u, v = support_motion(row, forcing, t)
            for d in range(system.carried.size):
                part = system.compliance[d, c] if d != c else 0.0
                y[system.iq[d]] += part * (u - y[system.iq[c]])
                y[system.iv[d]] += part * (v - y[system.iv[c]])
            y[system.iq[c]], y[system.iv[c]] = u, v


@kernel
def placed(t: float, y: Floats, system: Any, forcing: Any) -> Floats:
    """The state (size,) at the time t (s) with supports in their places, whatever their steps err.

    An integrator carries them, too, so that its steps are as short as their motion demands.
    """
    if forcing.family != LOADED:
        return y
    result = y.copy()
    place_supports(t, system, forcing, result)
    return result


@kernel
def add_load_coefficients(
    t: float, system: Any, forcing: Any, order: int, force: Floats, driven: Floats
) -> None:
    """Add the Taylor coefficients of the forces at the time t (s) to `force` (order, C) (N).

    Those of the accelerations of supports in space (m/s²) go into `driven` (order, C).
    """
    work = np.zeros(order)
    for a in range(system.link.size - 1, -1, -1):
        row, c = row_of_link(system.link[a], forcing.coefficients), system.ends[a, 0]
        if row > 0:
            load_taylor(row, forcing, t, order, work)
            for k in range(order):
                if is_driven(row, forcing.coefficients):
                    driven[k, c] = work[k]
                else:
                    force[k, c] += work[k]


@kernel
def taken(ground: float, force: Floats, pushed: Floats, driven: Floats, system: Any) -> Floats:
    """What a support in each cluster gives (N), (C,): what that takes, less what acts on it.

    Parameters
    ----------
    ground : float
        Acceleration of the ground (m/s²).
    force, pushed : ndarray, shape (C,)
        Of links and of loads (N).
    driven : ndarray, shape (C,)
        Accelerations of supports in space (m/s²).
    system : Reduced
        The mode.
    """
    # Without points `carried` is empty: only what rests on a support, and goes with it, counts.
    acceleration, found = driven.copy(), np.empty(system.carried.size)
    for c in range(found.size):
        acting = force[c] + pushed[c]
        acceleration[c] = force_or_given(c, acting, driven[c], system.mass)
    answers(system.compliance, acceleration, found)
    for c in range(found.size):
        acceleration[c] = found[c] + (1.0 - system.carried[c]) * ground
    result = system.own_mass * acceleration - force - pushed
    for c in supports_of(system.mass):
        for d in range(found.size):
            if d != c:
                result[c] += system.compliance[d, c] * result[d]
    return result


@kernel
def support_of(link: int, coefficients: Floats) -> int:
    """The support that the load of a link of a mode drives, from 0; -1 of any other link."""
    row = row_of_link(link, coefficients)
    return body_of(row, coefficients) if row > 0 and is_driven(row, coefficients) else -1
