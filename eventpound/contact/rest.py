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

from eventpound.mechanics.clusters import Clusters, form_clusters
from eventpound.mechanics.contact_elements import FIRST_CODE
from eventpound.mechanics.contact_laws import element_pull
from eventpound.mechanics.contact_problem import (
    Joints,
    of_members,
    parts,
    solve_contacts,
)
from eventpound.mechanics.elements import memory_stiffness, pull_per_z
from eventpound.mechanics.followers import is_support
from eventpound.mechanics.link_law import LinkLaw
from eventpound.mechanics.observables import difference
from eventpound.mechanics.reduced import (
    Branches,
    Forcing,
    Reduced,
    link_motion,
    reduce,
    state_vector,
)
from eventpound.mechanics.series import motion_series
from eventpound.motion.base import Family
from eventpound.motion.forcing import decay_time, ground_taylor
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.numerics.polynomial import first_root
from eventpound.tolerances import ACCELERATION, DEPENDENT, DIRECT, UNDECIDED

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
    by definition. u (m), v (m/s), shape (N,); z (H,). left, right, gap (K,), mass (N,), weights,
    link_ends, law, hysteretic: those of the `Model`.
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
    weights: Floats
    link_ends: Ints
    law: LinkLaw
    hysteretic: Ints
    stiffness: Floats
    preload: Floats
    forcing: Forcing
    speed_noise: float
    acceleration: float
    time: float


class Pressed(NamedTuple):
    """What moves with the contacts pressed, C clusters.

    system, y: its equations of motion and its state. rough (C,): clusters of whose accelerations an
    own part of those of the scene is rounding. leaves (K,): gaps that are not closed for good.
    joints: clusters of the contacts (K,). members: the undecided contacts that are left,
    label: the part of the scene of each.
    """

    system: Reduced
    y: Floats
    rough: Bools
    leaves: Bools
    joints: Joints
    members: Ints
    label: Ints


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
    undecided, pressed = touching.undecided.copy(), touching.pressed.copy()
    kept = np.zeros(undecided.size, np.bool_)
    while undecided.any():
        # Those found pressed move as one.
        now = _pressed(touching, pressed, undecided)
        for j in range(undecided.size):
            if undecided[j] and not now.leaves[j]:
                # What is pressed makes its two sides move as one: no order opens it.
                kept[j], undecided[j] = True, False
        order, opening, level = _first_deciding(now, undecided, touching)
        if order < 0:
            break
        members = np.flatnonzero(undecided)
        joints, noise = of_members(now.joints, members), level[members].max()
        force, after, solved = solve_contacts(joints, opening[members], noise)
        if not solved:
            return undecided, pressed, False
        passed_over = touching.released & (order == 0)
        # The next turn would be this one again.
        if not _take_decided(members, force, after, level, passed_over, undecided, pressed):
            break
    return pressed | kept | undecided, pressed, True


@kernel
def system_of(touching: Touching, clusters: Clusters) -> tuple[Reduced, Floats]:
    """Equations of motion of clusters, and their state."""
    t, no_ledger = touching, np.empty(0)
    branches = Branches(t.stiffness, t.preload)
    system = reduce(t.link_ends, t.law, t.mass, t.hysteretic, clusters, branches, no_ledger.size)
    return system, state_vector(clusters, system, t.mass, t.u, t.v, t.z, no_ledger)


@kernel
def pressed_as_one(touching: Touching, pressed: Bools) -> Clusters:
    """Clusters that contacts (K,) press together."""
    t = touching
    return form_clusters(t.left, t.right, t.gap, pressed, pressed, t.mass, t.weights)


@kernel
def _pressed(touching: Touching, pressed: Bools, undecided: Bools) -> Pressed:
    """What moves with these pressed."""
    clusters = pressed_as_one(touching, pressed)
    system, y = system_of(touching, clusters)
    first = _clusters_of(touching.left, clusters)
    second = _clusters_of(touching.right, clusters)
    joints = Joints(first, second, 1.0 / system.mass, system.compliance)
    rough = round_as_the_scene(system, touching.forcing)
    leaves = first != second
    if system.compliance.size > 0:
        _spread_rough(system.compliance, rough)
        for j in range(leaves.size):
            leaves[j] = leaves[j] and _parts_two(joints, j)
    members = np.flatnonzero(undecided & leaves)
    label = parts(of_members(joints, members))
    return Pressed(system, y, rough, leaves, joints, members, label)


@kernel
def _parts_two(joints: Joints, j: int) -> bool:
    """Whether a force, or what is given, parts two clusters; what follows one is not both's."""
    # Columns of what is given have another unit.
    largest, size, n = np.zeros(2), np.zeros(2), joints.inverse_mass.size
    for c in range(n):
        kind = 1 if joints.inverse_mass[c] == 0.0 else 0
        one, other = joints.left[j], joints.right[j]
        apart = difference(joints.compliance[:, c], one, other)
        largest[kind] = max(largest[kind], abs(apart))
        for end in (one, other):
            size[kind] = max(size[kind], abs(joints.compliance[end, c]) if end >= 0 else 0.0)
    return largest[0] > DEPENDENT * size[0] or largest[1] > DEPENDENT * size[1]


@kernel
def _spread_rough(compliance: Floats, rough: Bools) -> None:
    """Let clusters (C,) be rough that have to do with one that is."""
    own = rough.copy()
    for c in range(rough.size):
        for d in range(rough.size):
            rough[c] |= own[d] and compliance[c, d] != 0.0


@scalar_kernel
def _take_decided(
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
        # Where both are nothing a higher order decides.
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
    now: Pressed, undecided: Bools, touching: Touching
) -> tuple[int, Floats, Floats]:
    """Lowest order at which an undecided gap accelerates.

    Returns the order or -1, the coefficients of the accelerations of all
    gaps, shape (K,), and their noise, shape (K,).
    """
    opening, level = np.zeros(undecided.size), np.zeros(undecided.size)
    # Mostly the accelerations decide, for which twelve orders need not be made.
    for highest in (1, ORDER):
        found = accelerations(now.y, now.system, highest, touching)
        left = _left_over(now, found[0], touching)
        noise = noise_of(found, left, now.rough, now.y, now.system, touching)
        for order in range(highest):
            _put_openings(now, found[order], noise[order], opening, level)
            deciding = False
            for j in range(opening.size):
                # Rounding must open nothing in the complementarity problem.
                opening[j] = opening[j] if abs(opening[j]) > level[j] else 0.0
                vanished = opening[j] == 0.0 or (order == 0 and touching.released[j])
                deciding |= undecided[j] and not vanished
            if deciding:
                return order, opening, level
    return -1, opening, level


@kernel
def accelerations(y: Floats, system: Reduced, highest: int, touching: Touching) -> Floats:
    """Taylor coefficients of the accelerations of clusters, (highest, C)."""
    Y = motion_series(0.0, y, system, touching.forcing, highest, touching.speed_noise)
    # Of velocities from the first on: that of the acceleration is k + 1 times as large, of one
    # sign.
    return Y[1:][:, system.iv]


@kernel
def noise_of(
    found: Floats, left_over: Floats, rough: Bools, y: Floats, system: Reduced, touching: Touching
) -> Floats:
    """Noise of `accelerations` that are `found`, (orders, C).

    left_over (C,): what counts as rounding of the first beside its own. rough, y: of `Pressed`.
    """
    orders, forcing = found.shape[0], touching.forcing
    ground, (stiffness, damping) = np.zeros(orders), _slopes(y, system)
    ground_taylor(forcing, forcing.start, orders, ground)
    # In the tails of a pulse high orders are large beside what they are derivatives of.
    time = min(touching.time, decay_time(forcing, forcing.start))
    # Rounding of an order whose terms cancel, or vanish for every body.
    noise, rounding = np.empty(found.shape), np.zeros((orders + 2, found.shape[1]))
    own, part = ACCELERATION * touching.acceleration, DIRECT
    for order in range(orders):
        for c in range(found.shape[1]):
            absolute = abs(found[order, c] + ground[order] / (order + 1))
            rounding[order, c] = max(rounding[order, c], own) if rough[c] else 0.0
            noise[order, c] = max(part * absolute, rounding[order, c])
            if order == 0:
                rounding[0, c] = max(rounding[0, c], left_over[c])
        if system.compliance.size > 0:
            _spread_noise(system.compliance, noise[order])
        _pass_on(rounding, order, system, stiffness, damping)
        # As derivatives in the scene's own time go; those of higher orders are no sums of forces.
        own, part = own / (time * (order + 1)), UNDECIDED
    return noise


@kernel
def _spread_noise(compliance: Floats, noise: Floats) -> None:
    """Let accelerations (C,) err as those that they are sums of."""
    own = noise.copy()
    for c in range(noise.size):
        for d in range(noise.size):
            if compliance[c, d] != 0.0:
                noise[c] = max(noise[c], own[d])


@kernel
def _left_over(now: Pressed, acceleration: Floats, touching: Touching) -> Floats:
    """What is left of the accelerations (C,) of released contacts.

    These vanish at the instant of the release, which is known to rounding; so all bodies of a
    chain of undecided contacts err by as much, and their stiffness makes higher derivatives of it.
    """
    first, second, members, label = now.joints.left, now.joints.right, now.members, now.label
    own, of_part = np.zeros(acceleration.size), np.zeros(acceleration.size)
    result = np.zeros(acceleration.size)
    for j in range(first.size):
        if touching.released[j] and first[j] != second[j]:
            left = LEFT_OVER * abs(difference(acceleration, first[j], second[j]))
            for c in (first[j], second[j]):
                if c >= 0:
                    own[c] = max(own[c], left)
    for i in range(members.size):
        for c in (first[members[i]], second[members[i]]):
            if c >= 0:
                of_part[label[i]] = max(of_part[label[i]], own[c])
    for i in range(members.size):
        for c in (first[members[i]], second[members[i]]):
            if c >= 0:
                result[c] = of_part[label[i]]
    return result


@kernel
def _slopes(y: Floats, system: Reduced) -> tuple[Floats, Floats]:
    """Sizes of initial stiffness (N/m) and damping (N s/m) of links, of an element at y, (A,)."""
    stiffness, damping = system.stiffness.copy(), system.damping.copy()
    for a in range(stiffness.size):
        if system.iz[a] <= FIRST_CODE:
            code, (x, x_rate), f = system.iz[a], link_motion(a, y, system), system.preload[a]
            # The numbers of its law are no stiffness and no dashpot: that of hertz-damp, over a
            # closing speed of 1e-12 m/s, would make all there is rounding.
            slopes = element_pull(code, stiffness[a], f, damping[a], x, x_rate, 0.0)
            stiffness[a], damping[a] = abs(slopes[1]), slopes[2]
        else:
            stiffness[a] = abs(stiffness[a] + memory_stiffness(a, system.memory))
            damping[a] = abs(damping[a])
    return stiffness, damping


@kernel
def _pass_on(
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
        # Both ends err by the worse of them, for the link pulls at both.
        for c in system.ends[a]:
            if c >= 0:
                error = max(error, rounding[order, c])
        for c in system.ends[a]:
            if c < 0 or is_support(c, system.mass):
                continue
            if system.compliance.size == 0:
                part = error / (system.mass[c] * (order + 2))
                _pass_to(c, part, order, rounding, stiffness[a], damping[a])
            for d in range(system.compliance.shape[0]):
                part = error * abs(system.compliance[d, c]) / (order + 2)
                _pass_to(d, part, order, rounding, stiffness[a], damping[a])


@scalar_kernel
def _pass_to(
    c: int, part: float, order: int, rounding: Floats, stiffness: float, damping: float
) -> None:
    """The same to cluster c, whose coefficient a force of 1 N for an error of 1 moves by `part`."""
    rounding[order + 1, c] += damping * part
    rounding[order + 2, c] += stiffness * part / (order + 3)


@kernel
def round_as_the_scene(system: Reduced, forcing: Forcing) -> Bools:
    """Clusters (C,) of whose accelerations an own part of those of the scene is rounding.

    All, but for those that the tail of a Gaussian pulse alone moves, on which no link acts.
    """
    rough = np.full(system.mass.size, forcing.family != _GAUSSIAN)
    for a in range(system.stiffness.size):
        pulls = system.stiffness[a] != 0.0 or system.damping[a] != 0.0
        if pulls or pull_per_z(a, system.memory) != 0.0:
            for c in system.ends[a]:
                if c >= 0:
                    rough[c] = True
    return rough


@kernel
def _put_openings(
    now: Pressed, acceleration: Floats, noise: Floats, opening: Floats, level: Floats
) -> None:
    """Accelerations of the gaps and their noise: in each part the largest of its clusters.

    What is between two whose motion is given has their own alone.
    """
    first, second, members, label = now.joints.left, now.joints.right, now.members, now.label
    for j in range(opening.size):
        opening[j] = difference(acceleration, first[j], second[j])
    largest = np.zeros(noise.size)
    for i in range(members.size):
        for c in (first[members[i]], second[members[i]]):
            if c >= 0:
                largest[label[i]] = max(largest[label[i]], noise[c])
    for i in range(members.size):
        one, other = first[members[i]], second[members[i]]
        level[members[i]] = largest[label[i]]
        mass = now.system.mass
        # Nothing that is undecided moves these, so nothing of its rounding is in them.
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
def closing_time(c: Floats, size: int, limit: float, work: Floats) -> float:
    """When a gap, a polynomial in time (s), closes up to a limit, or inf; as `first_root`.

    One closed to rounding, which an impact elsewhere has set moving, or which is found closed at
    the end of a stretch, closes at once.
    """
    return 0.0 if c[0] <= 0.0 and c[1] < 0.0 else first_root(c, size, limit, work)


@scalar_kernel
def acceleration_noise(absolute: float, own: float) -> float:
    """Rounding of the acceleration of a body (m/s²): of a sum of forces, or of the scene, `own`.

    `absolute` is its absolute acceleration. What the ground alone accelerates, which has none,
    errs with its own acceleration only, however small.
    """
    return max(DIRECT * abs(absolute), own) if absolute != 0.0 else 0.0
