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

from eventpound.contact.kinks import still_rate
from eventpound.contact.rounding import noise_of, round_as_the_scene
from eventpound.contact.state import Instant
from eventpound.mechanics.clusters import Clusters, ContactEnds, form_clusters
from eventpound.mechanics.contact_problem import Joints, of_members, parts, solve_contacts
from eventpound.mechanics.elements import memory_on_branches
from eventpound.mechanics.followers import is_unmoved
from eventpound.mechanics.link_law import LinkLaw
from eventpound.mechanics.observables import difference
from eventpound.mechanics.reduced import Branches, Forcing, Reduced, reduce, state_vector
from eventpound.mechanics.series import motion_series
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.numerics.polynomial import first_root
from eventpound.tolerances import DEPENDENT

ORDER = 12
"""Highest Taylor coefficient looked at."""


LEFT_OVER = 2.0
"""Times the acceleration that is left of a contact just released, which counts as rounding: a
derivative that comes of it alone is as large as that makes it."""


class Touching(NamedTuple):
    """What the acceleration problem of an instant is about: K contacts, L links.

    between: the contacts, those of sliders in the directions of their slips. undecided (K,): those
    with g = γ = 0. pressed (K,): others that are known to be. z (H,): hysteretic variables. law,
    branches: of the links, on their present branches. forcing: the ground motion from now on.
    """

    at: Instant
    between: ContactEnds
    undecided: Bools
    pressed: Bools
    z: Floats
    law: LinkLaw
    branches: Branches
    forcing: Forcing


@kernel
def touching_of(between: ContactEnds, z: Floats, forcing: Forcing, at: Instant) -> Touching:
    """The acceleration problem of contacts at an instant, of which no one is known to be pressed.

    Parameters
    ----------
    between : ContactEnds
        The contacts.
    z : ndarray, shape (H,)
        Hysteretic variables.
    forcing : Forcing
        The ground motion from now on.
    at : Instant
        The instant, its impacts over.
    """
    # Of the present branch; F = k (x - o) = k x + f.
    stiffness = np.where(at.branch < 0, at.compression, at.extension)
    return Touching(
        at,
        between,
        (at.gap == 0.0) & (at.gap_rate == 0.0),
        np.zeros(at.gap.size, np.bool_),
        z,
        LinkLaw(at.law.damping, memory_on_branches(at.law.memory, at.branch)),
        Branches(stiffness, -stiffness * at.offset),
        forcing,
    )


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
        just_released = touching.at.released & (order == 0)
        # The next turn would be this one again.
        if not _take_decided(members, force, after, level, just_released, undecided, pressed):
            break
    return pressed | kept | undecided, pressed, True


@kernel
def system_of(touching: Touching, pressed: Bools) -> tuple[Reduced, Floats, Clusters]:
    """Equations of motion of the clusters that contacts (K,) press together, and their state."""
    at, no_ledger = touching.at, np.empty(0)
    clusters = form_clusters(touching.between, pressed, pressed)
    system = reduce(
        at.ends, touching.law, at.mass, at.hysteretic, clusters, touching.branches, no_ledger.size
    )
    y = state_vector(clusters, system, at.mass, at.u, at.v, touching.z, no_ledger)
    return system, y, clusters


@kernel
def _pressed(touching: Touching, pressed: Bools, undecided: Bools) -> Pressed:
    """What moves with these pressed."""
    system, y, clusters = system_of(touching, pressed)
    first = _clusters_of(touching.between.left, clusters)
    second = _clusters_of(touching.between.right, clusters)
    joints = Joints(first, second, 1.0 / system.mass, system.compliance)
    rough = round_as_the_scene(system, touching.forcing)
    leaves = first != second
    if system.compliance.size > 0:
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


@scalar_kernel
def _take_decided(
    members: Ints,
    force: Floats,
    after: Floats,
    level: Floats,
    just_released: Bools,
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
        if (opens or holds) and not just_released[j]:
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
        noise = noise_of(found, left, now.rough, now.y, now.system, touching.forcing, touching.at)
        for order in range(highest):
            _put_openings(now, found[order], noise[order], opening, level)
            deciding = False
            for j in range(opening.size):
                # Rounding must open nothing in the complementarity problem.
                opening[j] = opening[j] if abs(opening[j]) > level[j] else 0.0
                vanished = opening[j] == 0.0 or (order == 0 and touching.at.released[j])
                deciding |= undecided[j] and not vanished
            if deciding:
                return order, opening, level
    return -1, opening, level


@kernel
def accelerations(y: Floats, system: Reduced, highest: int, touching: Touching) -> Floats:
    """Taylor coefficients of the accelerations of clusters, (highest, C)."""
    still = still_rate(touching.at.length, touching.at.time)
    Y = motion_series(0.0, y, system, touching.forcing, highest, still)
    # Of velocities from the first on: that of the acceleration is k + 1 times as large, of one
    # sign.
    return Y[1:][:, system.iv]


@kernel
def free_accelerations(highest: int, touching: Touching) -> tuple[Floats, Floats]:
    """The same of all coordinates without contacts, (highest, N), and their noise."""
    none = np.zeros(touching.undecided.size, np.bool_)
    system, y, _ = system_of(touching, none)
    found = accelerations(y, system, highest, touching)
    rough, nothing = round_as_the_scene(system, touching.forcing), np.zeros(touching.at.mass.size)
    noise = noise_of(found, nothing, rough, y, system, touching.forcing, touching.at)
    return found, noise


@kernel
def _left_over(now: Pressed, acceleration: Floats, touching: Touching) -> Floats:
    """What is left of the accelerations (C,) of released contacts.

    These vanish at the instant of the release, which is known to rounding; so all bodies of a
    chain of undecided contacts err by as much, and their stiffness makes higher derivatives of it.
    """
    first, second, released = now.joints.left, now.joints.right, touching.at.released
    own, result = np.zeros(acceleration.size), np.zeros(acceleration.size)
    for j in range(first.size):
        if released[j] and first[j] != second[j]:
            left = LEFT_OVER * abs(difference(acceleration, first[j], second[j]))
            for c in (first[j], second[j]):
                if c >= 0:
                    own[c] = max(own[c], left)
    largest = _largest(now, own)
    for i in range(now.members.size):
        for c in (first[now.members[i]], second[now.members[i]]):
            if c >= 0:
                result[c] = largest[now.label[i]]
    return result


@kernel
def _largest(now: Pressed, values: Floats) -> Floats:
    """The largest value (C,) of the clusters of each part, at its label."""
    largest = np.zeros(values.size)
    for i in range(now.members.size):
        j = now.members[i]
        for c in (now.joints.left[j], now.joints.right[j]):
            if c >= 0:
                largest[now.label[i]] = max(largest[now.label[i]], values[c])
    return largest


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
    largest = _largest(now, noise)
    for i in range(members.size):
        one, other = first[members[i]], second[members[i]]
        level[members[i]] = largest[label[i]]
        mass = now.system.mass
        # Nothing that is undecided moves these, so nothing of its rounding is in them.
        if is_unmoved(one, mass) and is_unmoved(other, mass):
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
