"""Least forces in bounds (`eventpound.numerics.box`): what a problem is, and passive forces by G.

Where joints are at coordinates that follow others, G is no sum of inverse masses. The passive
ones never depend on each other, so that theirs has an inverse.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import deferred_kernel, kernel, scalar_kernel
from eventpound.numerics.small_systems import solve_definite
from eventpound.tolerances import SINGULAR


class BoxJoints(NamedTuple):
    """A problem of k joints between n - 1 bodies and the ground, which is the last.

    left, right, low, high, start: shape (k,). mass (n,), acceleration (n, m) and the noise of its
    first column (n,). G (k, k), empty where it follows from the masses.
    """

    left: Ints
    right: Ints
    low: Floats
    high: Floats
    start: Floats
    mass: Floats
    acceleration: Floats
    noise: Floats
    G: Floats


class Pivoting(NamedTuple):
    """Where it has come to.

    x, w, doubt (k, m): forces, their rates, rounding of the forces. passive (k,). along (k,): how
    forces move with the one that enters. Of each body (n,): root, the heaviest of its cluster;
    above, the joint on the way there, and next, the body behind that; order, all from roots on;
    weight, with all that hang on it. load, rate (n, 2): forces on these and accelerations of
    clusters beside that of the root alone, each with its noise. What may stop the one that enters,
    its own w, other forces at their bounds, itself at its own: slack, level (k + 2, m) before it
    and noise of that, speed (k + 2,) at which it is taken, 0 where there is none, and bound.
    """

    x: Floats
    w: Floats
    doubt: Floats
    passive: Bools
    along: Floats
    root: Ints
    above: Ints
    next: Ints
    order: Ints
    weight: Floats
    load: Floats
    rate: Floats
    slack: Floats
    level: Floats
    speed: Floats
    bound: Floats


@scalar_kernel
def unless_rounding(value: float, noise: float) -> float:
    """A value, zero where it is within its noise."""
    return value if abs(value) > noise else 0.0


@scalar_kernel
def take_force(
    joints: BoxJoints, i: int, c: int, force: float, noise: float, rounding: float, work: Pivoting
) -> None:
    """Give a passive joint its force beside the start."""
    # Bounds, and `start`, are of the first coefficient alone.
    if c > 0:
        work.x[i, c], work.doubt[i, c] = unless_rounding(force, noise), noise
        return
    noise += rounding * abs(joints.start[i])
    # It comes on top of what the accelerations have in them.
    force += joints.start[i]
    for bound in (joints.low[i], joints.high[i]):
        force = bound if abs(force - bound) <= noise else force
    work.x[i, 0], work.doubt[i, 0] = force, noise


@kernel
def _inverse(joints: BoxJoints, passive: Ints) -> Floats:
    """Of G of the passive joints, which do not depend on each other."""
    return solve_definite(joints.G[passive][:, passive], np.eye(passive.size))


@deferred_kernel
def settle_coupled(joints: BoxJoints, rounding: float, work: Pivoting) -> None:
    """`_settle` by G."""
    passive, k, G = np.flatnonzero(work.passive), work.passive.size, joints.G
    inverse = _inverse(joints, passive)
    for c in range(work.x.shape[1]):
        rate, noise = np.zeros(k), np.zeros(k)
        for i in range(k):
            for end, sign in ((joints.left[i], -1.0), (joints.right[i], 1.0)):
                rate[i] += sign * joints.acceleration[end, c]
                noise[i] += rounding * abs(joints.acceleration[end, c])
                noise[i] += joints.noise[end] if c == 0 else 0.0
            for j in range(k):
                start = joints.start[j] if c == 0 else 0.0
                force = 0.0 if work.passive[j] else G[i, j] * (work.x[j, c] - start)
                rate[i], noise[i] = rate[i] + force, noise[i] + rounding * abs(force)
        for a in range(passive.size):
            force, doubt = 0.0, 0.0
            for b in range(passive.size):
                force -= inverse[a, b] * rate[passive[b]]
                doubt += abs(inverse[a, b]) * noise[passive[b]]
            take_force(joints, passive[a], c, force, doubt, rounding, work)
        for i in range(k):
            for a in range(passive.size):
                j = passive[a]
                start = joints.start[j] if c == 0 else 0.0
                rate[i] += G[i, j] * (work.x[j, c] - start)
                noise[i] += abs(G[i, j]) * work.doubt[j, c]
            work.w[i, c] = 0.0 if work.passive[i] else unless_rounding(rate[i], noise[i])


@deferred_kernel
def along_coupled(joints: BoxJoints, j: int, way: float, work: Pivoting) -> float:
    """`_set_along` by G."""
    passive, G = np.flatnonzero(work.passive), joints.G
    inverse, growth = _inverse(joints, passive), G[j, j]
    work.along[:], work.along[j] = 0.0, way
    for a in range(passive.size):
        change = 0.0
        for b in range(passive.size):
            change -= inverse[a, b] * G[passive[b], j]
        work.along[passive[a]] = change * way
        growth += G[j, passive[a]] * change
    return growth if growth > SINGULAR * G[j, j] else 0.0
