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
    Body,
    SingleRun,
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
    wanted: float, most: int, a_g: float, time: float, table: Floats, body: Body
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
    body : Body
        Its numbers.

    Returns
    -------
    order, first, h
        Highest power, lowest that differs from zero, and length (s).
    """
    order, first, good = 0, 1, False
    for _ in range(MOST_REVERSALS):
        if body.part == UP and place_of(body.u, body) >= body.saturation:
            body.part, body.z = SATURATED, body.sigma
        body.x[1], body.x[2] = body.v, 0.5 * (body.a - a_g)
        part = body.part
        if part in (UP, DOWN):
            reached = curved_series(1.0 if part == UP else body.kappa_down, most, body)
            order, good = abs(reached), reached > 0
        else:
            tangent = body.strength * body.per_scale if part <= UNLOADING else 0.0
            order, good = linear_series(body.stiffness + tangent, most + MORE_TERMS, body)
        first = 1
        if abs(body.v) <= body.still:
            first = _leading(order, body.still / time, body)
        if part == CORE or body.sigma * body.x[first] >= 0.0:
            break
        turn_round(body.u, table, body)
    h = wanted if good else shorter(order, body)
    return order, first, h


@compiled_apart
def _leading(order: int, level: float, body: Body) -> int:
    """First coefficient that differs from rounding, of a body that all but stands still.

    One that leaves a barrier from rest has those before made zero.
    """
    side = side_closed(body)
    if body.x[1] == 0.0 and side != 0.0:
        for k in range(2, order + 1):
            least = noise.ROUNDING * abs(body.x[k])
            if k == 2:
                least = 0.5 * acceleration_level(body)
            if -side * body.x[k] > least:
                break
            body.x[k] = 0.0
    for k in range(2, order + 1):
        if abs(body.x[k]) > (level if k == 2 else 0.0):
            return k
    return 1


@compiled
def expected_length(a_g: float, body: Body) -> float:
    """Time in which the body is sure to have turned or met a barrier, were its pull constant (s).

    A shorter step takes fewer terms. One whose link all but stands still does not end
    where it turns.
    """
    v, a = body.v, body.a - a_g
    if v * a < 0.0:
        stands = BEYOND_REACH * v * v <= body.standing * abs(a)
        return (2.0 * BEYOND if stands else BEYOND) * abs(v / a)
    gap = body.right if a > 0.0 else body.left
    if v == 0.0 and a != 0.0 and gap > 0.0:
        return BEYOND * math.sqrt(2.0 * gap / abs(a))
    return np.inf


@compiled
def first_event(h: float, order: int, first: int, run: SingleRun) -> tuple[float, int, float]:
    """Length of a step of at most h (s), how it ends, and when the body turns (s), or inf.

    The motion at its end stands in CHANGE, RATE and BEND then.
    """
    body = run.body
    reach = h * (abs(body.v) + h * abs(body.x[2]))
    if reach <= body.standing:
        reach = 0.0
        for k in range(order, 0, -1):
            reach = (reach + abs(body.x[k])) * h
    if reach <= body.standing:
        # A link that all but stands still reverses at the level of rounding.
        tau, event, turn = _of_standing(h, reach, order, first, run)
        body.change, body.rate, body.bend = motion(tau, order, body)
    else:
        tau, event, turn = _of_one_way(h, order, first, body)
    return tau, event, turn


@compiled
def _of_one_way(h: float, order: int, first: int, body: Body) -> tuple[float, int, float]:
    """The same for a step that ends where the body turns; before, it goes one way."""
    way = 1.0 if body.x[first] > 0.0 else -1.0
    event, tau = FREE, h
    turn = first_turn(order, first, h, body)
    if turn <= h:
        tau, event = turn, FREE if body.part == CORE else TURNED
    body.change, body.rate, body.bend = motion(tau, order, body)
    gone, one_way = way * body.change, tau
    gap = body.right if way > 0.0 else body.left
    if gap <= gone and tau > 0.0:
        tau = crossing(gap, way, order, one_way, body)
        event = CLOSED_RIGHT if way > 0.0 else CLOSED_LEFT
    if body.part < UP and body.strength > 0.0:
        border = body.down_end if body.part == DOWN else body.core_end
        distance = (border - way * body.sigma * place_of(body.u, body)) * body.scale
        if distance <= 1e-15 * body.scale:
            tau, event = 0.0, CROSSED
        elif distance <= gone:
            at = crossing(distance, way, order, one_way, body)
            if at < tau:
                tau, event = at, CROSSED
    if tau < one_way:
        body.change, body.rate, body.bend = motion(tau, order, body)
    return tau, event, turn


@compiled_deferred
def _of_standing(
    h: float, reach: float, order: int, first: int, run: SingleRun
) -> tuple[float, int, float]:
    """The same for a body that may turn within the step.

    The step ends there if it may be an extreme. `reach` bounds the change of displacement (m).
    """
    body, turn = run.body, np.inf
    tau, event = _first_unordered(h, reach, order, body)
    spread = reach * (body.stiffness + body.strength * body.per_scale)
    if exceeds(0, body.u - reach, body.u + reach, run.running) or force_exceeds(
        body.a - spread, body.a + spread, run
    ):
        turn = first_turn(order, first, tau, body)
        if turn < tau:
            tau, event = turn, FREE
    return tau, event, turn


@compiled
def _first_unordered(h: float, reach: float, order: int, body: Body) -> tuple[float, int]:
    """First closing or border within h (s), and `reach` (m), of a body that may turn."""
    tau, event = h, FREE
    for side in (1.0, -1.0):
        gap = body.right if side > 0.0 else body.left
        if gap <= reach:
            at = first_reached(gap, side, order, tau, body)
            if at <= tau:
                tau, event = at, CLOSED_RIGHT if side > 0.0 else CLOSED_LEFT
    if body.strength > 0.0 and body.part <= DOWN:
        xi = place_of(body.u, body)
        border = body.core_end if body.part <= UNLOADING else body.down_end
        for side in (1.0, -1.0):
            if side < 0.0 and body.part != CORE:
                continue
            distance = (border - side * xi) * body.scale
            if distance <= 1e-15 * body.scale:
                distance = 0.0
            if distance <= reach:
                at = first_reached(distance, side * body.sigma, order, tau, body)
                if at < tau:
                    tau, event = at, CROSSED
    return tau, event
