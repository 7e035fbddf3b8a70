"""A step of a single body: its series and the first event within it.

What is special is the motion between two reversals: it goes one way, so a gap
has closed, or a border of the backbone was passed, if it is behind at the end.
"""

from __future__ import annotations

import math

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.solvers.events import noise
from eventpound.solvers.fast.compiled import compiled, compiled_apart, compiled_deferred
from eventpound.solvers.fast.links import CORE, DOWN, SATURATED, UNLOADING, UP
from eventpound.solvers.fast.run import MORE_TERMS
from eventpound.solvers.fast.single.body import (
    BEND,
    CHANGE,
    CORE_END,
    DOWN_END,
    KAPPA_DOWN,
    LEFT,
    OF_X,
    PART,
    PER_SCALE,
    RATE,
    RIGHT,
    SATURATION,
    SCALE,
    SIGMA,
    STANDING,
    STIFFNESS,
    STILL,
    STRENGTH,
    A,
    SingleRun,
    U,
    V,
    Z,
    place_of,
    turn_round,
)
from eventpound.solvers.fast.single.instant import acceleration_level, side_closed
from eventpound.solvers.fast.single.record import exceeds, force_exceeds
from eventpound.solvers.fast.single.search import crossing, first_reached, first_turn
from eventpound.solvers.fast.single.series import curved_series, linear_series, motion, shorter

FREE, TURNED, CROSSED, CLOSED_RIGHT, CLOSED_LEFT = 0, 1, 2, 3, 4
"""How a step ends."""
BEYOND = 1.5
"""Length of a step in times of that to the next turn, or impact, of a body under constant pull."""
BEYOND_REACH = 2.0 * BEYOND * (1.0 + BEYOND)
"""How far, in ``v²/a``, a body comes that goes on for twice that, both ways."""
MOST_REVERSALS = 4
"""Times a body that all but stands still is turned round at the start of a step."""


@compiled
def expand_step(
    wanted: float, most: int, a_g: float, time: float, table: Floats, w: Floats
) -> tuple[int, int, float]:
    """Series of a step, in the direction in which the body moves.

    Parameters
    ----------
    wanted : float
        Longest step (s).
    most : int
        Highest order; a linear body may have `MORE_TERMS` more.
    a_g : float
        Acceleration of the ground (m/s²).
    time : float
        The scene's own (s).
    table : ndarray
        That of the backbone.
    w : ndarray
        Places of `eventpound.solvers.fast.single.body`.

    Returns
    -------
    order, first, h
        Highest power, lowest that differs from zero, and length (s).
    """
    order, first, good = 0, 1, False
    for _ in range(MOST_REVERSALS):
        if w[PART] == UP and place_of(w[U], w) >= w[SATURATION]:
            w[PART], w[Z] = SATURATED, w[SIGMA]
        w[OF_X + 1], w[OF_X + 2] = w[V], 0.5 * (w[A] - a_g)
        part = w[PART]
        if part in (UP, DOWN):
            reached = curved_series(1.0 if part == UP else w[KAPPA_DOWN], most, w)
            order, good = abs(reached), reached > 0
        else:
            tangent = w[STRENGTH] * w[PER_SCALE] if part <= UNLOADING else 0.0
            order, good = linear_series(w[STIFFNESS] + tangent, most + MORE_TERMS, w)
        first = 1
        if abs(w[V]) <= w[STILL]:
            first = _leading(order, w[STILL] / time, w)
        if part == CORE or w[SIGMA] * w[OF_X + first] >= 0.0:
            break
        turn_round(w[U], table, w)
    h = wanted if good else shorter(order, w)
    return order, first, h


@compiled_apart
def _leading(order: int, level: float, w: Floats) -> int:
    """First coefficient that differs from rounding, of a body that all but stands still.

    One that leaves a barrier from rest has those before made zero.
    """
    side = side_closed(w)
    if w[OF_X + 1] == 0.0 and side != 0.0:
        for k in range(2, order + 1):
            least = noise.ROUNDING * abs(w[OF_X + k])
            if k == 2:
                least = 0.5 * acceleration_level(w)
            if -side * w[OF_X + k] > least:
                break
            w[OF_X + k] = 0.0
    for k in range(2, order + 1):
        if abs(w[OF_X + k]) > (level if k == 2 else 0.0):
            return k
    return 1


@compiled
def expected_length(a_g: float, w: Floats) -> float:
    """Time in which the body is sure to have turned or met a barrier, were its pull constant (s).

    A shorter step takes fewer terms. One whose link all but stands still does not end
    where it turns.
    """
    v, a = w[V], w[A] - a_g
    if v * a < 0.0:
        stands = BEYOND_REACH * v * v <= w[STANDING] * abs(a)
        return (2.0 * BEYOND if stands else BEYOND) * abs(v / a)
    gap = w[RIGHT] if a > 0.0 else w[LEFT]
    if v == 0.0 and a != 0.0 and gap > 0.0:
        return BEYOND * math.sqrt(2.0 * gap / abs(a))
    return np.inf


@compiled
def first_event(h: float, order: int, first: int, run: SingleRun) -> tuple[float, int, float]:
    """Length of a step of at most h (s), how it ends, and when the body turns (s), or inf.

    The motion at its end stands in CHANGE, RATE and BEND then.
    """
    w = run.w
    reach = h * (abs(w[V]) + h * abs(w[OF_X + 2]))
    if reach <= w[STANDING]:
        reach = 0.0
        for k in range(order, 0, -1):
            reach = (reach + abs(w[OF_X + k])) * h
    if reach <= w[STANDING]:
        # A link that all but stands still reverses at the level of rounding.
        tau, event, turn = _of_standing(h, reach, order, first, run)
        w[CHANGE], w[RATE], w[BEND] = motion(tau, order, w)
    else:
        tau, event, turn = _of_one_way(h, order, first, w)
    return tau, event, turn


@compiled
def _of_one_way(h: float, order: int, first: int, w: Floats) -> tuple[float, int, float]:
    """The same for a step that ends where the body turns; before, it goes one way."""
    way = 1.0 if w[OF_X + first] > 0.0 else -1.0
    event, tau = FREE, h
    turn = first_turn(order, first, h, w)
    if turn <= h:
        tau, event = turn, FREE if w[PART] == CORE else TURNED
    w[CHANGE], w[RATE], w[BEND] = motion(tau, order, w)
    gone, one_way = way * w[CHANGE], tau
    gap = w[RIGHT] if way > 0.0 else w[LEFT]
    if gap <= gone and tau > 0.0:
        tau = crossing(gap, way, order, one_way, w)
        event = CLOSED_RIGHT if way > 0.0 else CLOSED_LEFT
    if w[PART] < UP and w[STRENGTH] > 0.0:
        border = w[DOWN_END] if w[PART] == DOWN else w[CORE_END]
        distance = (border - way * w[SIGMA] * place_of(w[U], w)) * w[SCALE]
        if distance <= 1e-15 * w[SCALE]:
            tau, event = 0.0, CROSSED
        elif distance <= gone:
            at = crossing(distance, way, order, one_way, w)
            if at < tau:
                tau, event = at, CROSSED
    if tau < one_way:
        w[CHANGE], w[RATE], w[BEND] = motion(tau, order, w)
    return tau, event, turn


@compiled_deferred
def _of_standing(
    h: float, reach: float, order: int, first: int, run: SingleRun
) -> tuple[float, int, float]:
    """The same for a body that may turn within the step.

    The step ends there if it may be an extreme. `reach` bounds the change of displacement (m).
    """
    w, turn = run.w, np.inf
    tau, event = _first_unordered(h, reach, order, w)
    spread = reach * (w[STIFFNESS] + w[STRENGTH] * w[PER_SCALE])
    if exceeds(0, w[U] - reach, w[U] + reach, run.running) or force_exceeds(
        w[A] - spread, w[A] + spread, run
    ):
        turn = first_turn(order, first, tau, w)
        if turn < tau:
            tau, event = turn, FREE
    return tau, event, turn


@compiled
def _first_unordered(h: float, reach: float, order: int, w: Floats) -> tuple[float, int]:
    """First closing or border within h (s), and `reach` (m), of a body that may turn."""
    tau, event = h, FREE
    for side in (1.0, -1.0):
        gap = w[RIGHT] if side > 0.0 else w[LEFT]
        if gap <= reach:
            at = first_reached(gap, side, order, tau, w)
            if at <= tau:
                tau, event = at, CLOSED_RIGHT if side > 0.0 else CLOSED_LEFT
    if w[STRENGTH] > 0.0 and w[PART] <= DOWN:
        xi = place_of(w[U], w)
        border = w[CORE_END] if w[PART] <= UNLOADING else w[DOWN_END]
        for side in (1.0, -1.0):
            if side < 0.0 and w[PART] != CORE:
                continue
            distance = (border - side * xi) * w[SCALE]
            if distance <= 1e-15 * w[SCALE]:
                distance = 0.0
            if distance <= reach:
                at = first_reached(distance, side * w[SIGMA], order, tau, w)
                if at < tau:
                    tau, event = at, CROSSED
    return tau, event
