"""Forces in bounds between bodies, with Gauss's function least, also where they are not unique.

With the rows W of k joints, by which their gaps or elongations follow from n bodies, and M the
masses, infinite those of supports, whose accelerations a(ε) are given,

    min ½ xᵀ G x + q(ε)ᵀ x,   low <= x <= high,   G = W M⁻¹ Wᵀ,   q(ε) = W a(ε) - G start

for the smallest ε > 0, a(ε) = a_0 + ε a_1 + ε² a_2 + ... Where joints close a cycle, G is singular,
and a_0 alone may leave several x, or none that a small change would not carry off; a_1 and those
that follow say which one.

The limit of x is found by principal pivoting (E. L. Keller, Mathematical Programming 4, 1973) on
numbers that are polynomials in ε, told apart by their first coefficient that is not rounding. What
has to hold at the end: forces at a bound have a rate w = G x + q that does not point into the box,
all others one of zero, each to the rounding of what w is summed from.

Joints whose w vanish, the passive ones, never depend on each other. Each is solved for a light body
(`eventpound.numerics.elimination`), so that q = N y, y the bodies left, of which they are
rid: a w is then a sum of few accelerations, and exactly zero where nothing moves a joint. So G is
neither made nor tested for its rank, whatever the ratio of the masses: only NᵀMN is solved, which
is diagonal where joints are between two bodies each. Each pivot moves one force by a way that is no
rounding, and Gauss's function falls; since forces are the best of their passive set then, no set
comes twice.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.numerics.elimination import pivot_of, solve_for
from eventpound.numerics.small_systems import solve_definite
from eventpound.tolerances import LCP_ROUNDING

_PATIENCE = 8
"""Pivots for each joint, after which rounding is taken to be twice as large."""


class BoxJoints(NamedTuple):
    """A problem of k joints and n bodies.

    Parameters
    ----------
    rows : ndarray, shape (k, n)
        W.
    mass : ndarray, shape (n,)
        Of the bodies, infinite where they move as they are told to (kg).
    acceleration : ndarray, shape (m, n)
        Row i is a_i, with the forces `start` (m/s²).
    noise : ndarray, shape (n,)
        What those of a_0 may be wrong by (m/s²).
    low, high : ndarray, shape (k,)
        Bounds (N); they may be infinite.
    start : ndarray, shape (k,)
        A corner of the box, on which forces stay that nothing moves.
    """

    rows: Floats
    mass: Floats
    acceleration: Floats
    noise: Floats
    low: Floats
    high: Floats
    start: Floats


class _Pivoting(NamedTuple):
    """Where it has come to.

    x, w, doubt (k, m): forces, their rates, rounding of the forces. passive (k,). ties (k, n + k):
    the rows without the bodies for which passive ones are solved, and what they are summed from.
    own (k,), row (n,): of each joint that body, of each body that joint, or -1. inverse (n, n): of
    NᵀMN, zero but for bodies that are left and can move.
    """

    x: Floats
    w: Floats
    doubt: Floats
    passive: Bools
    ties: Floats
    own: Ints
    row: Ints
    inverse: Floats


class _Stops(NamedTuple):
    """What may stop a force: its own w, other forces at their bounds, itself at its own.

    slack, level (k + 2, m): what is before it, and noise of that. speed (k + 2,): at which it is
    taken, 0 where there is none. bound (k + 2,).
    """

    slack: Floats
    level: Floats
    speed: Floats
    bound: Floats


@kernel
def least_in_box(joints: BoxJoints) -> tuple[Floats, bool]:
    """The limit of x for ε to zero, shape (k,), and whether there is a least value.

    There is one wherever the bounds along a cycle are finite.
    """
    (k, n), m = joints.rows.shape, joints.acceleration.shape[0]
    x, w, doubt = np.zeros((k, m)), np.zeros((k, m)), np.zeros((k, m))
    x[:, 0] = joints.start
    places, passive = np.zeros((2, max(k, n)), np.int64), np.zeros(k, np.bool_)
    ties, inverse = np.zeros((k, n + k)), np.zeros((n, n))
    work = _Pivoting(x, w, doubt, passive, ties, places[0, :k], places[1, :n], inverse)
    found = _pivot(joints, work)
    return np.minimum(np.maximum(x[:, 0], joints.low), joints.high), found


@scalar_kernel
def unless_rounding(value: float, noise: float) -> float:
    """A value, zero where it is within its noise."""
    return value if abs(value) > noise else 0.0


@kernel
def _pivot(joints: BoxJoints, work: _Pivoting) -> bool:
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


@kernel
def _eliminate(joints: BoxJoints, work: _Pivoting) -> None:
    """Solve passive joints for a body each, and set how those that are left answer to forces."""
    mass, ties, passive = joints.mass, work.ties, work.passive
    k, n = joints.rows.shape
    ties[:, :n], ties[:, n:] = joints.rows, np.eye(k)
    work.own[:], work.row[:] = -1, -1
    for i in range(k):
        b = pivot_of(ties[i], mass) if passive[i] else -1
        # Of a joint that depends on others to rounding the force stays as it is.
        passive[i] = b >= 0
        if b >= 0:
            work.own[i], work.row[b] = b, i
            solve_for(ties, i, b, n)
    for i in range(k):
        if not passive[i] and pivot_of(ties[i], mass) < 0:
            # What depends on passive joints no force parts: what is left is rounding.
            ties[i, :n][mass < np.inf] = 0.0
    left, coupled = (work.row < 0) & (mass < np.inf), False
    K = np.diag(np.where(left, mass, 1.0))
    for row in np.flatnonzero(passive):
        held = np.flatnonzero(left & (ties[row, :n] != 0.0))
        coupled |= held.size > 1
        for g in held:
            for h in held:
                K[g, h] += mass[work.own[row]] * ties[row, g] * ties[row, h]
    work.inverse[:] = 0.0
    for g in np.flatnonzero(left):
        work.inverse[g, g] = 1.0 if coupled else 1.0 / K[g, g]
    if coupled:
        solve_definite(K, work.inverse)


@kernel
def _settle(joints: BoxJoints, rounding: float, work: _Pivoting) -> None:
    """Give passive joints the forces with which their w vanish; set the w of all."""
    _eliminate(joints, work)
    for c in range(work.x.shape[1]):
        move, pull = _answer(joints, _loads(joints, c, rounding, work), work)
        for i in range(work.passive.size):
            if work.passive[i]:
                _set_force(joints, i, c, _carried(i, pull, work), rounding, work)
                work.w[i, c] = 0.0
            else:
                apart, rounded = _apart(joints, i, c, rounding, work)
                rate, noise = _weighed(work.ties[i], move)
                work.w[i, c] = unless_rounding(apart + rate, rounded + noise)


@scalar_kernel
def _weighed(row: Floats, values: Floats) -> tuple[float, float]:
    """Sum over values (n, 2), of which the second is the noise of the first; and its noise."""
    total, noise = 0.0, 0.0
    for b in range(values.shape[0]):
        total += row[b] * values[b, 0]
        noise += abs(row[b]) * values[b, 1]
    return total, noise


@scalar_kernel
def _apart(
    joints: BoxJoints, i: int, c: int, rounding: float, work: _Pivoting
) -> tuple[float, float]:
    """What a tie makes of accelerations, and the noise of that, without what moves can change.

    A difference of two is rounded once, and exactly zero of supports that move alike.
    """
    total, noise, begun = 0.0, 0.0, False
    for b in range(joints.mass.size):
        tie = work.ties[i, b]
        if tie == 0.0:
            continue
        part = tie * joints.acceleration[c, b]
        total += part
        noise += rounding * (abs(part) * (abs(tie) != 1.0) + abs(total) * begun)
        if c == 0 and joints.mass[b] == np.inf:
            noise += abs(tie) * joints.noise[b]
        begun = True
    return total, noise


@kernel
def _loads(joints: BoxJoints, c: int, rounding: float, work: _Pivoting) -> Floats:
    """What acts on bodies beside what moves those left, without passive joints, and its noise."""
    mass = joints.mass
    load = np.zeros((mass.size, 2))
    for b in np.flatnonzero(mass < np.inf):
        apart, noise = 0.0, joints.noise[b] if c == 0 else 0.0
        if work.row[b] >= 0:
            # Beside those left: what all of a cluster do alike asks no force of its joints.
            apart, rounded = _apart(joints, work.row[b], c, rounding, work)
            noise += rounded
        load[b, 0], load[b, 1] = mass[b] * apart, mass[b] * noise
    for i in range(work.passive.size):
        # The accelerations have the forces `start` in them already.
        start = joints.start[i] if c == 0 else 0.0
        force = 0.0 if work.passive[i] else work.x[i, c] - start
        load[:, 0] += joints.rows[i] * force
        load[:, 1] += np.abs(joints.rows[i]) * (rounding * (abs(start) + abs(force)))
    return load


@kernel
def _answer(joints: BoxJoints, load: Floats, work: _Pivoting) -> tuple[Floats, Floats]:
    """How loads accelerate bodies that are left, and pull at passive joints by the others.

    ``move = (NᵀMN)⁻¹ Nᵀ load`` (n, 2), and ``m N move - load`` (k, 2) of the body that a joint is
    solved for; each with its noise.
    """
    (k, n), ties = joints.rows.shape, work.ties
    carried, move, pull = load.copy(), np.zeros((n, 2)), np.zeros((k, 2))
    for i in np.flatnonzero(work.passive):
        carried[:, 0] -= ties[i, :n] * load[work.own[i], 0]
        carried[:, 1] += np.abs(ties[i, :n]) * load[work.own[i], 1]
    for b in range(n):
        move[b, 0], move[b, 1] = _weighed(work.inverse[b], carried)
    for i in np.flatnonzero(work.passive):
        b = work.own[i]
        along, noise = _weighed(ties[i], move)
        pull[i, 0] = -joints.mass[b] * along - load[b, 0]
        pull[i, 1] = joints.mass[b] * noise + load[b, 1]
    return move, pull


@scalar_kernel
def _carried(i: int, pull: Floats, work: _Pivoting) -> tuple[float, float]:
    """Force of a passive joint, and its noise."""
    force, noise, bodies = 0.0, 0.0, work.row.size
    for j in range(pull.shape[0]):
        force += work.ties[j, bodies + i] * pull[j, 0]
        noise += abs(work.ties[j, bodies + i]) * pull[j, 1]
    return force, noise


@scalar_kernel
def _set_force(
    joints: BoxJoints,
    i: int,
    c: int,
    carried: tuple[float, float],
    rounding: float,
    work: _Pivoting,
) -> None:
    """Give a passive joint what it carries, its bound where it is there to rounding."""
    force, noise = carried[0], carried[1] + rounding * abs(carried[0])
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


@scalar_kernel
def _first_wrong(joints: BoxJoints, work: _Pivoting) -> int:
    """The first force on a bound whose w tells it to leave that, or -1."""
    for i in range(work.passive.size):
        way = -1.0 if work.x[i, 0] <= joints.low[i] else 1.0
        # Where both bounds are one there is no way to go.
        free = not work.passive[i] and joints.low[i] < joints.high[i]
        if free and _sign(work.w[i]) * way > 0.0:
            return i
    return -1


@kernel
def _enter(joints: BoxJoints, j: int, rounding: float, work: _Pivoting) -> bool:
    """Move x_j off its bound until its w vanishes, or it comes to its other bound.

    Passive joints keep their w of zero on the way, and leave where they come to a bound. False
    where nothing stops x_j.
    """
    x, w_j = work.x, work.w[j]
    way = -_sign(w_j)
    while True:
        # Anew each time, for with a joint that leaves the clusters are others.
        along, growth = _along(joints, j, way, rounding, work)
        stops = _stops(joints, j, along, growth, rounding, work)
        first = _first(stops)
        if first < 0:
            return False
        for c in range(w_j.size):
            step = stops.slack[first, c] / stops.speed[first]
            w_j[c] += growth * way * step
            x[:, c] += along * step
        if first == 0:
            work.passive[j] = True
            return True
        blocking = j if first == along.size + 1 else first - 1
        # On its bound whatever ε is: no coefficient behind the first is left.
        x[blocking], x[blocking, 0] = 0.0, stops.bound[first]
        if blocking == j:
            return True
        work.passive[blocking] = False
        _eliminate(joints, work)


@kernel
def _along(
    joints: BoxJoints, j: int, way: float, rounding: float, work: _Pivoting
) -> tuple[Floats, float]:
    """How forces move with x_j, which moves by `way`, (k,); by how much its w grows with it."""
    load, along = np.zeros((joints.mass.size, 2)), np.zeros(work.passive.size)
    load[:, 0] = way * joints.rows[j]
    load[:, 1] = rounding * np.abs(joints.rows[j])
    move, pull = _answer(joints, load, work)
    for i in range(along.size):
        # None of what is not passive.
        along[i] = unless_rounding(*_carried(i, pull, work))
    # The one that enters is not passive, so `_carried` knows nothing of it.
    along[j] = way
    return along, _weighed(work.ties[j], move)[0] * way


@kernel
def _stops(
    joints: BoxJoints, j: int, along: Floats, growth: float, rounding: float, work: _Pivoting
) -> _Stops:
    """What may stop x_j, whose w changes by `growth` on its way."""
    x, k, m = work.x, along.size, work.x.shape[1]
    speed, bound = np.zeros(k + 2), np.zeros(k + 2)
    slack, level = np.zeros((k + 2, m)), np.zeros((k + 2, m))
    speed[0], slack[0], level[0] = growth, -work.w[j] * along[j], rounding * np.abs(work.w[j])
    for i in range(k):
        stop = k + 1 if i == j else i + 1
        bound[stop] = joints.low[i] if along[i] < 0.0 else joints.high[i]
        speed[stop] = abs(along[i]) if np.isfinite(bound[stop]) else 0.0
        slack[stop] = -x[i]
        slack[stop, 0] += bound[stop]
        slack[stop] *= -1.0 if along[i] < 0.0 else 1.0
        # What is not passive stands on its bound exactly.
        level[stop] = work.doubt[i] if work.passive[i] else np.zeros(m)
    return _Stops(slack, level, speed, bound)


@scalar_kernel
def _first(stops: _Stops) -> int:
    """The first stop, by the coefficients of their steps one after the other; or -1.

    Stops that come later lose their speed.
    """
    slack, level, speed = stops.slack, stops.level, stops.speed
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
