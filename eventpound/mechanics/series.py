"""Taylor coefficients of the motion in one contact mode.

``y(τ) = Σ_k Y_k τ^k`` by recurrence: the forces are linear in q, v and z, and the power
series of z' is built term by term (`eventpound.mechanics.elements`). The signs of x' and z are
those just after τ = 0, so the series holds up to the next reversal of x' or zero of z.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.contact_elements import CUT, FIRST_CODE
from eventpound.mechanics.contact_laws import element_exponents
from eventpound.mechanics.elements import (
    drag_coefficient,
    link_coefficient,
    pull_per_z,
    z_coefficient,
)
from eventpound.mechanics.followers import acceleration_of, answers, force_or_given
from eventpound.mechanics.model import WORK_OF_SUPPORTS
from eventpound.mechanics.reduced import Forcing, Reduced, link_motion
from eventpound.mechanics.reduced_loads import (
    add_load_coefficients,
    place_supports,
    support_of,
    taken,
)
from eventpound.motion.forcing import ground_taylor
from eventpound.motion.loads import LOADED
from eventpound.numerics.arrays import Floats
from eventpound.numerics.borrowing import copy_numbers
from eventpound.numerics.compiled import deferred_kernel, kernel
from eventpound.numerics.power_series import power_coefficient, sign_after
from eventpound.numerics.small_systems import dot


@deferred_kernel
def _element_coefficient(
    a: int, k: int, system: Reduced, x: Floats, x_rate: Floats, overlap: Floats, powers: Floats
) -> float:
    """Coefficient k of the force of a closed contact element, as a link pulls.

    `x` (k + 1,), `x_rate` (k + 1,): elongation and its rate. overlap, powers (2,): d, and the
    powers of it that E and C are; brought up to order k.
    """
    kind = FIRST_CODE - system.iz[a]
    stiffness, damping = system.stiffness[a], system.damping[a]
    # d = -(x + f/k), whose constant is in the first coefficient alone.
    overlap[k] = -x[k] - (system.preload[a] / stiffness if k == 0 else 0.0)
    approaching = sign_after(x_rate, k + 1, 0.0) < 0.0
    # k d - c x' below zero would pull, and is cut.
    if kind == CUT and stiffness * overlap[0] <= damping * x_rate[0]:
        return 0.0
    for i in range(2):
        exponent = element_exponents(kind, approaching)[i]
        if exponent == 1.0:
            powers[i, k] = overlap[k]
        elif exponent == 0.0:
            powers[i, k] = 1.0 if k == 0 else 0.0
        # Below zero it stands for no dashpot; an open gap has no depth to raise.
        elif exponent < 0.0 or overlap[0] < 0.0:
            powers[i, k] = 0.0
        else:
            powers[i, k] = power_coefficient(overlap, powers[i], exponent, k)
    # What presses with E + C d', d' = -x', pulls with the negative of it.
    pull = -stiffness * powers[0, k]
    for j in range(k + 1):
        pull += damping * powers[1, j] * x_rate[k - j]
    return pull


@deferred_kernel
def _add_ledger(
    k: int, system: Reduced, Y: Floats, ground: Floats, x_rate: Floats, out: Floats
) -> None:
    """Coefficient k of the rates of input, viscous and hysteretic work."""
    for c in range(system.mass.size):
        for j in range(k + 1):
            out[0] -= system.own_mass[c] * Y[j, system.iv[c]] * ground[k - j]
    for a in range(system.stiffness.size):
        for j in range(k + 1):
            # Lower codes are contact elements, whose losses are counted with their contacts.
            if system.iz[a] >= -1:
                out[1] += drag_coefficient(a, j, system, x_rate[a]) * x_rate[a, k - j]
            if system.iz[a] >= 0:
                z = Y[j, system.iz[a]]
                out[2] += pull_per_z(a, system.memory) * z * x_rate[a, k - j]


@deferred_kernel
def _add_work(
    k: int, system: Reduced, forcing: Forcing, Y: Floats, pushed: Floats, given: Floats
) -> None:
    """Add coefficient k of the rate of input, and k + 1 of the work of supports, to Y.

    `pushed`, `given` (order, C): coefficients of loads, and of what a support in a cluster gives.
    """
    ledger, iv = system.ledger, system.iv
    for c in range(system.mass.size):
        for j in range(k + 1):
            Y[k + 1, ledger] += Y[j, iv[c]] * pushed[k - j, c]
    for a in range(system.link.size):
        support = support_of(system.link[a], forcing.coefficients)
        if support >= 0:
            place, c = ledger + WORK_OF_SUPPORTS + support, system.ends[a, 0]
            for j in range(k + 1):
                # The caller divides the first three places of the ledger by k + 1, and not these.
                Y[k + 1, place] += Y[j, iv[c]] * given[k - j, c] / (k + 1)


@deferred_kernel
def _add_friction(k: int, system: Reduced, Y: Floats, forces: Floats) -> None:
    """Coefficient k + 1 of the work of friction at each contact.

    `forces` (order, C): coefficients of what acts on the clusters.
    """
    first = system.size - system.slide.shape[0]
    for i in range(system.slide.shape[0]):
        for j in range(k + 1):
            way = dot(system.slide[i], Y[j][system.iv])
            Y[k + 1, first + i] += way * dot(system.press[i], forces[k - j]) / (k + 1)


class _Terms(NamedTuple):
    """Taylor coefficients of links: elongation, of contact elements alone, and its rate (L, p).

    power (L, p): ``|z|^n``; sigma (L,): direction, 0 where it is not known yet. overlap (L, 3, p):
    of contact elements, the depth and its powers.
    """

    x: Floats
    x_rate: Floats
    power: Floats
    sigma: Floats
    overlap: Floats


@kernel
def _blank_terms(order: int, system: Reduced) -> _Terms:
    links = system.stiffness.size
    # Scenes without contact elements, nearly all, make no room for them.
    elements = links if (system.iz < -1).any() else 0
    return _Terms(
        np.zeros((elements, order)),
        np.zeros((links, order)),
        np.zeros((links, order)),
        np.zeros(links),
        np.zeros((elements, 3, order)),
    )


@kernel
def _set_forces(
    k: int, Y: Floats, system: Reduced, terms: _Terms, speed_noise: float, force: Floats
) -> None:
    """Coefficient k of what links put on the clusters, and coefficient k + 1 of every z.

    `speed_noise` (m/s): see `motion_series`.
    """
    iz, sigma = system.iz, terms.sigma
    force[:] = 0.0
    for a in range(system.stiffness.size):
        first, second = system.ends[a, 0], system.ends[a, 1]
        x_rate = terms.x_rate[a]
        x, x_rate[k] = link_motion(a, Y[k], system)
        z = Y[k, iz[a]] if iz[a] >= 0 else 0.0
        term = link_coefficient(a, k, system, x, x_rate, z)
        if iz[a] < -1:
            terms.x[a, k] = x
            d = terms.overlap[a]
            term = _element_coefficient(a, k, system, terms.x[a], x_rate, d[0], d[1:])
        elif iz[a] >= 0:
            # x' that starts from zero is given its sign as soon as a coefficient of it is known.
            if sigma[a] == 0.0:
                sigma[a] = sign_after(x_rate, k + 1, speed_noise)
            zs, beside, power = Y[:, iz[a]], Y[:, system.beside[a]], terms.power[a]
            rate = z_coefficient(a, k, system.memory, x_rate, zs, beside, power, sigma[a])
            Y[k + 1, iz[a]] = rate / (k + 1)
        if first >= 0:
            force[first] += term
        if second >= 0:
            force[second] -= term


@kernel
def _set_accelerations(
    k: int, ground: float, force: Floats, coupled: Floats, system: Reduced, Y: Floats
) -> None:
    """Coefficient k + 1 of q and v, from coefficient k of what acts on the clusters.

    `coupled` (C,), empty where no cluster follows others, is overwritten.
    """
    answers(system.compliance, force, coupled)
    for c in range(force.size):
        if coupled.size > 0:
            relative = coupled[c] - system.carried[c] * ground
        else:
            relative = acceleration_of(c, force[c], system.mass) - ground
        Y[k + 1, system.iq[c]] = Y[k, system.iv[c]] / (k + 1)
        Y[k + 1, system.iv[c]] = relative / (k + 1)


@kernel
def motion_series(
    tau: float, y: Floats, system: Reduced, forcing: Forcing, order: int, speed_noise: float
) -> Floats:
    """Taylor coefficients of the state.

    Parameters
    ----------
    tau : float
        Time of expansion since the start of the segment (s).
    y : ndarray, shape (size,)
        State there.
    system : Reduced
        The mode.
    forcing : Forcing
        The piece of the ground motion, continued as the same formula.
    order : int
        Highest power.
    speed_noise : float
        Elongation rates up to this (m/s) count as zero where the sign decides.

    Returns
    -------
    ndarray, shape (order + 1, size)
        ``Y[k]`` multiplies ``τ^k``.
    """
    Y = np.zeros((order + 1, system.size))
    copy_numbers(y, Y[0])
    ground = np.zeros(order)
    ground_taylor(forcing, forcing.start + tau, order, ground)
    terms = _blank_terms(order, system)
    force, coupled = np.empty(system.mass.size), np.empty(system.compliance.shape[0])
    forces = np.zeros((order if system.slide.size > 0 else 0, system.mass.size))
    loads = np.zeros((2, order if forcing.family == LOADED else 0, system.mass.size))
    pushed, driven, given = loads[0], loads[1], np.zeros(loads[0].shape)
    if forcing.family == LOADED and system.mass.size > 0:
        place_supports(forcing.start + tau, system, forcing, Y[0])
        add_load_coefficients(forcing.start + tau, system, forcing, order, pushed, driven)
    for k in range(order):
        _set_forces(k, Y, system, terms, speed_noise, force)
        if forcing.family == LOADED:
            if system.ledger >= 0:
                given[k] = taken(ground[k], force, pushed[k], driven[k], system)
            for c in range(force.size):
                pushing = force[c] + pushed[k, c]
                force[c] = force_or_given(c, pushing, driven[k, c], system.mass)
        if forces.size > 0:
            forces[k] = force
        _set_accelerations(k, ground[k], force, coupled, system, Y)
        if system.ledger >= 0:
            out = Y[k + 1, system.ledger : system.ledger + 3]
            _add_ledger(k, system, Y, ground, terms.x_rate, out)
            if forcing.family == LOADED:
                _add_work(k, system, forcing, Y, pushed, given)
            for i in range(out.size):
                out[i] /= k + 1
            if forces.size > 0:
                _add_friction(k, system, Y, forces)
    return Y


@kernel
def evaluate_series(Y: Floats, h: float) -> tuple[Floats, Floats]:
    """State and rate of state at τ = h from `motion_series`, each shape (size,)."""
    order, size = Y.shape[0] - 1, Y.shape[1]
    state, rate = np.empty(size), np.empty(size)
    for i in range(size):
        value, slope = Y[order, i], order * Y[order, i]
        for k in range(order - 1, -1, -1):
            value = value * h + Y[k, i]
            if k > 0:
                slope = slope * h + k * Y[k, i]
        state[i], rate[i] = value, slope
    return state, rate
