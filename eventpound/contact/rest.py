"""The acceleration problem: which contacts with g = γ = 0 stay closed.

``0 <= g'' ⊥ λ >= 0``, ``g'' = G λ + q`` with q the accelerations of the gaps
without contact forces. Where g'' and λ both vanish the first derivative that
does not decides: the same problem is solved order by order on the Taylor
coefficients of the motion, over the contacts still undecided, with those
found pressed moving as one. What no order decides stays closed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.clusters import Clusters, form_clusters, is_support
from eventpound.mechanics.contact_problem import parts, solve_contacts
from eventpound.mechanics.elements import memory_stiffness, pull_per_z
from eventpound.mechanics.link_law import LinkLaw
from eventpound.mechanics.reduced import Branches, Forcing, Reduced, reduce, state_vector
from eventpound.mechanics.reduced_loads import support_of
from eventpound.mechanics.series import motion_series
from eventpound.motion.base import Family
from eventpound.motion.forcing import decay_time, ground_taylor
from eventpound.motion.loads import LOADED, is_sinusoidal, row_of_link
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.tolerances import ACCELERATION, DIRECT, UNDECIDED

_GAUSSIAN = int(Family.GAUSSIAN)
ORDER = 12
"""Highest Taylor coefficient looked at."""


LEFT_OVER = 2.0
"""Times the acceleration that is left of a contact just released, which counts as rounding: a
derivative that comes of it alone is as large as that makes it."""


class Touching(NamedTuple):
    """What the acceleration problem is about: N bodies, K contacts, L links, H of them hysteretic.

    undecided (K,): contacts with g = γ = 0. pressed (K,): others that are known to be. released
    (K,): those whose force has just been found to pass zero, for which the order zero has vanished
    by definition. u (m), v (m/s), shape (N,); z (H,). left, right, gap (K,), mass (N,), link_ends,
    law, hysteretic: those of the `Model`.
    stiffness k (N/m), preload f (N), shape (L,): of each link on its present branch. forcing: the
    ground motion from now on, its start at the time of the state. speed_noise: elongation rates
    without a meaningful sign (m/s). acceleration, time: the scene's own, L/T² (m/s²) and T (s).
    """

    undecided: Bools
    pressed: Bools
    released: Bools
    u: Floats
    v: Floats
    z: Floats
    left: Ints
    right: Ints
    gap: Floats
    mass: Floats
    link_ends: Ints
    law: LinkLaw
    hysteretic: Ints
    stiffness: Floats
    preload: Floats
    forcing: Forcing
    speed_noise: float
    acceleration: float
    time: float


class _Gaps(NamedTuple):
    """Coefficients of the gap accelerations of one order.

    opening, level (K,): the coefficients and their noise. first, second (K,): clusters.
    """

    opening: Floats
    level: Floats
    first: Ints
    second: Ints


@kernel
def rest_contacts(touching: Touching) -> tuple[Bools, Bools, bool]:
    """The acceleration problem, order by order.

    Returns
    -------
    resting, pressed : ndarray of bool, shape (K,)
        The resting contacts, and those of them that were found pressed. Where
        no solution was found, `resting` are the contacts of that problem.
    solved : bool
        False where no solution was found.
    """
    left, right, mass, released = touching.left, touching.right, touching.mass, touching.released
    undecided = touching.undecided.copy()
    pressed, kept = touching.pressed.copy(), np.zeros(undecided.size, np.bool_)
    no_ledger = np.empty(0)
    while undecided.any():
        # Those found pressed move as one.
        clusters = form_clusters(left, right, touching.gap, pressed, pressed, mass)
        system = reduce(
            touching.link_ends,
            touching.law,
            mass,
            touching.hysteretic,
            clusters,
            Branches(touching.stiffness, touching.preload),
            no_ledger.size,
        )
        y = state_vector(clusters, system, mass, touching.u, touching.v, touching.z, no_ledger)
        first, second = _clusters_of(left, clusters), _clusters_of(right, clusters)
        order, opening, level = _first_deciding(y, system, first, second, undecided, touching)
        if order < 0:
            break
        for j in range(undecided.size):
            if undecided[j] and first[j] == second[j]:
                kept[j], undecided[j] = True, False
        passed_over = released & (order == 0)
        gaps = _Gaps(opening, level, first, second)
        decided, solved = _decide(gaps, system.mass, passed_over, undecided, pressed)
        if not solved:
            return undecided, pressed, False
        if not decided:
            break
    return pressed | kept | undecided, pressed, True


@kernel
def _decide(
    gaps: _Gaps, mass: Floats, passed_over: Bools, undecided: Bools, pressed: Bools
) -> tuple[bool, bool]:
    """One order: who opens and who is pressed, taken from `undecided` (K,).

    `mass` (kg) is that of the clusters; `passed_over` (K,) are not decided here. Returns whether
    any was decided, and whether there was a solution.
    """
    members, level = np.flatnonzero(undecided), gaps.level
    force, after, solved = solve_contacts(
        gaps.first[members],
        gaps.second[members],
        1.0 / mass,
        gaps.opening[members],
        level[members].max(),
    )
    if not solved:
        return False, False
    return take_decided(members, force, after, level, passed_over, undecided, pressed), True


@scalar_kernel
def take_decided(
    members: Ints,
    force: Floats,
    after: Floats,
    level: Floats,
    passed_over: Bools,
    undecided: Bools,
    pressed: Bools,
) -> bool:
    """Take those of the members whom a solution lets open or presses from `undecided`; if any.

    `force` and `after`, the accelerations left, are those of the members, all others of (K,).
    """
    decided = False
    for i in range(members.size):
        j = members[i]
        opens, holds = after[i] > level[j], force[i] > 0.0
        if (opens or holds) and not passed_over[j]:
            decided = True
            undecided[j] = False
            pressed[j] = not opens
    return decided


@kernel
def _clusters_of(bodies: Ints, clusters: Clusters) -> Ints:
    """Cluster of each body given, -1 for barriers and what rests on them."""
    result = np.full(bodies.size, -1, np.int64)
    for i in range(bodies.size):
        if bodies[i] >= 0:
            result[i] = clusters.of_body[bodies[i]]
    return result


@kernel
def _first_deciding(
    y: Floats,
    system: Reduced,
    first: Ints,
    second: Ints,
    undecided: Bools,
    touching: Touching,
) -> tuple[int, Floats, Floats]:
    """Lowest order at which an undecided gap between clusters accelerates.

    Returns the order or -1, the coefficients of the accelerations of all
    gaps, shape (K,), and their noise, shape (K,).
    """
    forcing, released = touching.forcing, touching.released
    opening, level = np.zeros(undecided.size), np.zeros(undecided.size)
    members = np.flatnonzero(undecided & (first != second))
    label = parts(first[members], second[members], system.iv.size)
    pulled = _round_as_the_scene(system, forcing)
    noise, ground = np.empty(system.iv.size), np.zeros(ORDER)
    stiffness, damping = links_held(system)
    # In the tails of a pulse high orders are large beside what they are derivatives of.
    time = min(touching.time, decay_time(forcing, forcing.start))
    for highest in (1, ORDER):
        Y = motion_series(0.0, y, system, forcing, highest, touching.speed_noise)
        ground_taylor(forcing, forcing.start, highest, ground)
        # Rounding of an order whose terms cancel, or vanish for every body.
        rounding = np.zeros((highest + 2, noise.size))
        own = ACCELERATION * touching.acceleration
        for order in range(highest):
            coefficient = Y[order + 1][system.iv]
            take_noise(order, coefficient, ground[order], own, pulled, rounding[order], noise)
            if order == 0:
                _add_residual(coefficient, first, second, members, label, released, rounding[0])
            pass_on(rounding, order, system, stiffness, damping)
            _set_noise(noise, system.mass, first, second, members, label, level)
            own /= time * (order + 1)
            deciding = False
            for j in range(opening.size):
                ahead = coefficient[second[j]] if second[j] >= 0 else 0.0
                behind = coefficient[first[j]] if first[j] >= 0 else 0.0
                opening[j] = ahead - behind if abs(ahead - behind) > level[j] else 0.0
                vanished = opening[j] == 0.0 or (order == 0 and released[j])
                deciding |= undecided[j] and not vanished
            if deciding:
                return order, opening, level
    return -1, opening, level


@scalar_kernel
def take_noise(
    order: int,
    coefficient: Floats,
    ground: float,
    own: float,
    pulled: Bools,
    rounding: Floats,
    noise: Floats,
) -> None:
    """Noise of the accelerations of clusters (C,) of one order, and the `rounding` in it.

    ground: Taylor coefficient of its acceleration. own: what one of the scene's own rounds to.
    """
    part = DIRECT if order == 0 else UNDECIDED
    for c in range(noise.size):
        absolute = abs(coefficient[c] + ground / (order + 1))
        rounding[c] = max(rounding[c], own) if pulled[c] else 0.0
        noise[c] = max(part * absolute, rounding[c])


@kernel
def _add_residual(
    acceleration: Floats,
    first: Ints,
    second: Ints,
    members: Ints,
    label: Ints,
    released: Bools,
    rounding: Floats,
) -> None:
    """Add to the rounding of accelerations (C,) what is left of those of released contacts.

    These vanish at the instant of the release, which is known to rounding; so all bodies of a
    chain of undecided contacts err by as much, and their stiffness makes higher derivatives of it.
    """
    left_over, of_part = np.zeros(acceleration.size), np.zeros(acceleration.size)
    for j in range(released.size):
        if released[j] and first[j] != second[j]:
            ahead = acceleration[second[j]] if second[j] >= 0 else 0.0
            behind = acceleration[first[j]] if first[j] >= 0 else 0.0
            for c in (first[j], second[j]):
                if c >= 0:
                    left_over[c] = max(left_over[c], LEFT_OVER * abs(ahead - behind))
    for i in range(members.size):
        for c in (first[members[i]], second[members[i]]):
            if c >= 0:
                of_part[label[i]] = max(of_part[label[i]], left_over[c])
    for i in range(members.size):
        for c in (first[members[i]], second[members[i]]):
            if c >= 0:
                rounding[c] = max(rounding[c], of_part[label[i]])


@kernel
def links_held(system: Reduced) -> tuple[Floats, Floats]:
    """Initial stiffness (N/m) and dashpot (N s/m) of each link, shape (A,)."""
    stiffness = system.stiffness.copy()
    for a in range(stiffness.size):
        stiffness[a] += memory_stiffness(a, system.memory)
    return stiffness, system.damping


@kernel
def pass_on(
    rounding: Floats, order: int, system: Reduced, stiffness: Floats, damping: Floats
) -> None:
    """What the rounding of an order makes by way of the links in the next two.

    `rounding` (orders, C) is that of the Taylor coefficients of velocities, the first that of an
    acceleration: of coefficient k + 1 in k. An error e there moves coefficient k + 2 by
    ``c e / (m (k + 2))`` and k + 3 by ``k_l e / (m (k + 2) (k + 3))``. A stiff body
    makes of an acceleration that is rounding a large higher derivative.
    """
    for a in range(stiffness.size):
        error = 0.0
        for c in system.ends[a]:
            if c >= 0:
                error = max(error, rounding[order, c])
        for c in system.ends[a]:
            if c >= 0:
                part = error / (system.mass[c] * (order + 2))
                rounding[order + 1, c] += damping[a] * part
                rounding[order + 2, c] += stiffness[a] * part / (order + 3)


@kernel
def clusters_pulled(system: Reduced) -> Bools:
    """Clusters (C,) on which a link acts."""
    pulled = np.zeros(system.mass.size, np.bool_)
    for a in range(system.stiffness.size):
        pulls = system.stiffness[a] != 0.0 or system.damping[a] != 0.0
        if pulls or pull_per_z(a, system.memory) != 0.0:
            for c in system.ends[a]:
                if c >= 0:
                    pulled[c] = True
    return pulled


@kernel
def _round_as_the_scene(system: Reduced, forcing: Forcing) -> Bools:
    """Clusters (C,) of whose accelerations an own part of those of the scene is rounding.

    Not those that the tail of a Gaussian pulse alone moves, nor those of supports, which are said
    to the last digit; but sinusoids pass zero at times that are not.
    """
    result = clusters_pulled(system) | (forcing.family != _GAUSSIAN)
    if forcing.family == LOADED:
        for a in range(system.link.size):
            if support_of(system.link[a], forcing.coefficients) >= 0:
                row = row_of_link(system.link[a], forcing.coefficients)
                result[system.ends[a, 0]] = is_sinusoidal(row, forcing.coefficients)
    return result


@kernel
def _set_noise(
    noise: Floats,
    mass: Floats,
    first: Ints,
    second: Ints,
    members: Ints,
    label: Ints,
    level: Floats,
) -> None:
    """Noise of the undecided `members` into `level` (K,): of each part the largest of clusters.

    `noise`, `mass` (C,) are those of each cluster, `label` the part of each member. What is between
    two whose motion is given has their own alone.
    """
    largest = np.zeros(noise.size)
    for i in range(members.size):
        for c in (first[members[i]], second[members[i]]):
            if c >= 0:
                largest[label[i]] = max(largest[label[i]], noise[c])
    for i in range(members.size):
        one, other = first[members[i]], second[members[i]]
        level[members[i]] = largest[label[i]]
        if (one < 0 or is_support(one, mass)) and (other < 0 or is_support(other, mass)):
            level[members[i]] = max(
                noise[one] if one >= 0 else 0.0, noise[other] if other >= 0 else 0.0
            )


@scalar_kernel
def is_none(k: int, coefficient: float, level: float, rate: float, time: float) -> bool:
    """Whether Taylor coefficient k of a gap counts as zero, as those before it but the rate do.

    A gap that opens from rest, with no `rate`, can do nothing else. One that has opened already,
    at a speed that the rounding of an acceleration, `level`, takes away within T, must not be
    closed again by that.
    """
    if rate == 0.0:
        return coefficient <= level
    return k == 2 and -level <= coefficient < 0.0 and rate <= level * time


@scalar_kernel
def acceleration_noise(absolute: float, own: float) -> float:
    """Rounding of the acceleration of a body (m/s²): of a sum of forces, or of the scene, `own`.

    `absolute` is its absolute acceleration. What the ground alone accelerates, which has none,
    errs with its own acceleration only, however small.
    """
    return max(DIRECT * abs(absolute), own) if absolute != 0.0 else 0.0
