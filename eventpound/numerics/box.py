"""Forces in bounds between bodies, with Gauss's function least, also where they are not unique.

With W the incidence of k joints on the bodies, from their left to their right ones, and M the
masses, infinite those of ground and supports, whose accelerations a(ε) are given,

    min ½ xᵀ G x + q(ε)ᵀ x,   low <= x <= high,   G = Wᵀ M⁻¹ W,   q(ε) = Wᵀ a(ε) - G start

for the smallest ε > 0, a(ε) = a_0 + ε a_1 + ε² a_2 + ... Where joints close a cycle, G is singular,
and a_0 alone may leave several x, or none that a small change would not carry off; a_1 and those
that follow say which one.

The limit of x is found by principal pivoting (E. L. Keller, Mathematical Programming 4, 1973) on
numbers that are polynomials in ε, told apart by their first coefficient that is not rounding. What
has to hold at the end: forces at a bound have a rate w = G x + q that does not point into the box,
all others one of zero, each to the rounding of what w is summed from.

Joints whose w vanish, the passive ones, never close a cycle: they make clusters that move as one.
So w is the difference of two of their accelerations, and changes with its own force by the sum of
their inverse masses, or by nothing: G is neither inverted nor tested for its rank, whatever the
ratio of the masses. Only where joints are at points, and are given by their G, is that done. Each
pivot moves one force by a way that is no rounding, and Gauss's function
falls; since forces are the best of their passive set then, no set comes twice.
"""

from __future__ import annotations

import numpy as np

from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.box_by_matrix import (
    BoxJoints,
    Pivoting,
    along_coupled,
    settle_coupled,
    take_force,
    unless_rounding,
)
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.tolerances import LCP_ROUNDING

_PATIENCE = 8
"""Pivots for each joint, after which rounding is taken to be twice as large."""


@kernel
def least_in_box(
    ends: tuple[Ints, Ints],
    mass: Floats,
    acceleration: Floats,
    noise: Floats,
    box: tuple[Floats, Floats],
    start: Floats,
    G: Floats,
) -> tuple[Floats, bool]:
    """The limit of x for ε to zero, shape (k,), and whether there is a least value.

    There is one wherever the bounds along a cycle are finite.

    Parameters
    ----------
    ends : tuple of ndarray, shape (k,)
        Left and right bodies of the joints; -1 is the ground.
    mass : ndarray, shape (n,)
        Of the bodies, infinite where they move as they are told to (kg).
    acceleration : ndarray, shape (m, n)
        Row i is a_i, with the forces `start` (m/s²).
    noise : ndarray, shape (n,)
        What those of a_0 may be wrong by (m/s²).
    box : tuple of ndarray, shape (k,)
        Lower and upper bounds (N); they may be infinite.
    start : ndarray, shape (k,)
        A corner of the box, on which forces stay that nothing moves.
    G : ndarray, shape (k, k)
        Where joints are at coordinates that follow others (1/kg), else empty.
    """
    k, m, n = start.size, acceleration.shape[0], mass.size + 1
    # The ground is the last body, of infinite mass and no acceleration.
    masses, given, level = np.full(n, np.inf), np.zeros((n, m)), np.zeros(n)
    masses[:-1], given[:-1], level[:-1] = mass, acceleration.T, noise
    left, right = np.where(ends[0] < 0, n - 1, ends[0]), np.where(ends[1] < 0, n - 1, ends[1])
    joints = BoxJoints(left, right, box[0], box[1], start, masses, given, level, G)
    x = np.zeros((k, m))
    x[:, 0] = start
    work = Pivoting(
        x=x,
        w=np.zeros((k, m)),
        doubt=np.zeros((k, m)),
        passive=np.zeros(k, np.bool_),
        along=np.zeros(k),
        root=np.zeros(n, np.int64),
        above=np.zeros(n, np.int64),
        next=np.zeros(n, np.int64),
        order=np.zeros(n, np.int64),
        weight=np.zeros(n),
        load=np.zeros((n, 2)),
        rate=np.zeros((n, 2)),
        slack=np.zeros((k + 2, m)),
        level=np.zeros((k + 2, m)),
        speed=np.zeros(k + 2),
        bound=np.zeros(k + 2),
    )
    found = _pivot(joints, work)
    return np.minimum(np.maximum(x[:, 0], box[0]), box[1]), found


@scalar_kernel
def _pivot(joints: BoxJoints, work: Pivoting) -> bool:
    """`least_in_box`, its limit in the first column of x at last."""
    pivots, rounding = 0, LCP_ROUNDING
    while True:
        _settle(joints, rounding, work)
        j = _first_wrong(joints, work)
        if j < 0:
            return True
        if not _enter(joints, j, rounding, work):
            return False
        pivots += 1
        # Pivots that only rounding asks for would go on for ever: now twice as much is none.
        if pivots % (_PATIENCE * (work.passive.size + 1)) == 0:
            rounding *= 2.0


@scalar_kernel
def _settle(joints: BoxJoints, rounding: float, work: Pivoting) -> None:
    """Give passive joints the forces with which their w vanish; set the w of all."""
    if joints.G.size > 0:
        settle_coupled(joints, rounding, work)
        return
    _plant(joints, work)
    for c in range(work.x.shape[1]):
        _set_loads(joints, c, rounding, work)
        _share(joints.mass, work)
        for b in range(work.root.size):
            if work.above[b] >= 0:
                _set_force(joints, b, c, rounding, work)
        for i in range(work.passive.size):
            one, other = work.root[joints.left[i]], work.root[joints.right[i]]
            # The roots' own accelerations first: supports that move alike leave exactly zero.
            apart = joints.acceleration[other, c] - joints.acceleration[one, c]
            rate = apart + (work.rate[other, 0] - work.rate[one, 0])
            noise = work.rate[one, 1] + work.rate[other, 1] + rounding * abs(apart)
            # Within a cluster nothing parts: w is zero there, not zero to rounding.
            work.w[i, c] = unless_rounding(rate, noise) if one != other else 0.0


@scalar_kernel
def _plant(joints: BoxJoints, work: Pivoting) -> None:
    """Find the clusters that passive joints make, each from its heaviest body on.

    What the joints of a light body carry is not left of a difference of heavy ones then.
    """
    root, order = work.root, work.order
    for b in range(root.size):
        root[b] = -1
    count, grown = 0, 0
    while count < order.size:
        if grown == count:
            heaviest = -1
            for b in range(root.size):
                if root[b] < 0 and (heaviest < 0 or joints.mass[b] > joints.mass[heaviest]):
                    heaviest = b
            order[count], root[heaviest], work.above[heaviest] = heaviest, heaviest, -1
            count += 1
        here = order[grown]
        grown += 1
        for i in range(work.passive.size):
            if work.passive[i] and (joints.left[i] == here or joints.right[i] == here):
                there = joints.left[i] + joints.right[i] - here
                if root[there] < 0:
                    order[count], root[there] = there, root[here]
                    work.above[there], work.next[there] = i, here
                    count += 1


@scalar_kernel
def _set_loads(joints: BoxJoints, c: int, rounding: float, work: Pivoting) -> None:
    """Set what acts on bodies beside what moves their roots, without passive joints."""
    load, rate, mass = work.load, work.rate, joints.mass
    for b in range(mass.size):
        # Beside its root: what all of a cluster do alike asks no force of its joints.
        apart = joints.acceleration[b, c] - joints.acceleration[work.root[b], c]
        noise = joints.noise[b] if c == 0 else 0.0
        # What moves as it is told to does so under any load.
        rate[b, 0], rate[b, 1], load[b, 0], load[b, 1] = 0.0, noise, 0.0, 0.0
        if np.isfinite(mass[b]):
            load[b, 0], load[b, 1] = mass[b] * apart, mass[b] * (noise + rounding * abs(apart))
    for i in range(work.passive.size):
        # The accelerations have the forces `start` in them already.
        start = joints.start[i] if c == 0 else 0.0
        force = 0.0 if work.passive[i] else work.x[i, c] - start
        _load(joints, i, force, rounding * (abs(start) + abs(force)), work)


@scalar_kernel
def _load(joints: BoxJoints, i: int, force: float, noise: float, work: Pivoting) -> None:
    """Add the force of a joint to the loads."""
    for b, sign in ((joints.left[i], -1.0), (joints.right[i], 1.0)):
        work.load[b, 0] += sign * force
        work.load[b, 1] += noise


@scalar_kernel
def _share(mass: Floats, work: Pivoting) -> None:
    """Add up weights and loads towards the roots, and set the rates of those that can move."""
    load, rate, weight = work.load, work.rate, work.weight
    for b in range(mass.size):
        weight[b] = mass[b]
    # From the leaves on: `order` has each body behind the one that it hangs on.
    for place in range(mass.size - 1, -1, -1):
        b = work.order[place]
        if work.above[b] >= 0:
            weight[work.next[b]] += weight[b]
            load[work.next[b], 0] += load[b, 0]
            load[work.next[b], 1] += load[b, 1]
        elif np.isfinite(weight[b]):
            rate[b, 0], rate[b, 1] = load[b, 0] / weight[b], load[b, 1] / weight[b]


@scalar_kernel
def _carried(b: int, joints: BoxJoints, work: Pivoting) -> float:
    """Force of the joint above a body."""
    # m a of all that hangs on the joint, less what else pulls at it.
    force = work.weight[b] * work.rate[work.root[b], 0] - work.load[b, 0]
    return force if joints.right[work.above[b]] == b else -force


@scalar_kernel
def _set_force(joints: BoxJoints, b: int, c: int, rounding: float, work: Pivoting) -> None:
    """Give the joint above a body what it carries, its bound where it is there to rounding."""
    i, force = work.above[b], _carried(b, joints, work)
    noise = work.weight[b] * work.rate[work.root[b], 1] + work.load[b, 1] + rounding * abs(force)
    take_force(joints, i, c, force, noise, rounding, work)


@scalar_kernel
def _first_wrong(joints: BoxJoints, work: Pivoting) -> int:
    """The first force on a bound whose w tells it to leave that, or -1."""
    for i in range(work.passive.size):
        way = -1.0 if work.x[i, 0] <= joints.low[i] else 1.0
        # Where both bounds are one there is no way to go.
        free = not work.passive[i] and joints.low[i] < joints.high[i]
        if free and _sign(work.w[i]) * way > 0.0:
            return i
    return -1


@scalar_kernel
def _enter(joints: BoxJoints, j: int, rounding: float, work: Pivoting) -> bool:
    """Move x_j off its bound until its w vanishes, or it comes to its other bound.

    Passive joints keep their w of zero on the way, and leave where they come to a bound. False
    where nothing stops x_j.
    """
    x, w_j, along = work.x, work.w[j], work.along
    way = -_sign(w_j)
    while True:
        # Anew each time, for with a joint that leaves the clusters are others.
        curvature = _set_along(joints, j, way, work)
        _set_stops(joints, j, way, curvature, rounding, work)
        first = _first(work)
        if first < 0:
            return False
        for c in range(w_j.size):
            step = work.slack[first, c] / work.speed[first]
            w_j[c] += curvature * way * step
            for i in range(along.size):
                x[i, c] += along[i] * step
        if first == 0:
            work.passive[j] = True
            return True
        blocking = j if first == along.size + 1 else first - 1
        for c in range(w_j.size):
            # On its bound whatever ε is: no coefficient behind the first is left.
            x[blocking, c] = work.bound[first] if c == 0 else 0.0
        if blocking == j:
            return True
        work.passive[blocking] = False
        if joints.G.size == 0:
            _plant(joints, work)


@scalar_kernel
def _set_along(joints: BoxJoints, j: int, way: float, work: Pivoting) -> float:
    """Set how forces move with x_j, which moves by `way`; by how much its w grows with it."""
    if joints.G.size > 0:
        return along_coupled(joints, j, way, work)
    along = work.along
    for b in range(work.root.size):
        for s in range(2):
            work.load[b, s] = work.rate[b, s] = 0.0
    _load(joints, j, way, 0.0, work)
    _share(joints.mass, work)
    for i in range(along.size):
        along[i] = 0.0
    for b in range(work.root.size):
        if work.above[b] >= 0:
            along[work.above[b]] = _carried(b, joints, work)
    # The one that enters is in no cluster, so `_carried` knows nothing of it.
    along[j] = way
    one, other = work.root[joints.left[j]], work.root[joints.right[j]]
    return (work.rate[other, 0] - work.rate[one, 0]) * way if one != other else 0.0


@scalar_kernel
def _set_stops(
    joints: BoxJoints, j: int, way: float, curvature: float, rounding: float, work: Pivoting
) -> None:
    """Set what may stop x_j, whose w changes by `curvature` on its way."""
    x, along, k = work.x, work.along, work.along.size
    work.speed[0], work.speed[j + 1] = curvature, 0.0
    for c in range(x.shape[1]):
        work.slack[0, c] = -work.w[j, c] * way
        work.level[0, c] = rounding * abs(work.w[j, c])
    for i in range(k):
        stop = k + 1 if i == j else i + 1
        bound = joints.low[i] if along[i] < 0.0 else joints.high[i]
        work.speed[stop] = abs(along[i]) if np.isfinite(bound) else 0.0
        work.bound[stop] = bound
        for c in range(x.shape[1]):
            slack = (bound if c == 0 else 0.0) - x[i, c]
            work.slack[stop, c] = -slack if along[i] < 0.0 else slack
            # What is not passive stands on its bound exactly.
            work.level[stop, c] = work.doubt[i, c] if work.passive[i] else 0.0


@scalar_kernel
def _first(work: Pivoting) -> int:
    """The first stop, by the coefficients of their steps one after the other; or -1.

    Stops that come later lose their speed.
    """
    slack, level, speed = work.slack, work.level, work.speed
    for c in range(slack.shape[1]):
        least, noise = np.inf, 0.0
        for i in range(speed.size):
            if speed[i] > 0.0 and slack[i, c] / speed[i] < least:
                least, noise = slack[i, c] / speed[i], level[i, c] / speed[i]
        # Each beside its own rounding: that of a direction that is all but zero would be as long as
        # any step, and all would count as first.
        for i in range(speed.size):
            if speed[i] > 0.0 and slack[i, c] / speed[i] > least + noise + level[i, c] / speed[i]:
                speed[i] = 0.0
    for i in range(speed.size):
        if speed[i] > 0.0:
            return i
    return -1


@scalar_kernel
def _sign(coefficients: Floats) -> float:
    """Sign of a polynomial for small arguments."""
    for value in coefficients:
        if value != 0.0:
            return 1.0 if value > 0.0 else -1.0
    return 0.0
