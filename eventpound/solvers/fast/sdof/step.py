"""A step of a single body: its series, the first event within it, and what that does.

What is special is the motion between two reversals: it goes one way, so a gap
has closed, or a border of the backbone was passed, if it is behind at the end.
"""

from __future__ import annotations

import math

import numpy as np

from eventpound.contact.cascade import end_flight, is_over
from eventpound.contact.event_rows import list_all
from eventpound.contact.impacts import FULL
from eventpound.motion.forcing import CurrentPiece
from eventpound.solvers.fast.compiled import compiled, compiled_deferred, compiled_noinline
from eventpound.solvers.fast.expansion import shortening
from eventpound.solvers.fast.extremes import stays_within
from eventpound.solvers.fast.links import CORE, DOWN, SATURATED, UNLOADING, UP
from eventpound.solvers.fast.record import is_due, pass_time
from eventpound.solvers.fast.run import (
    GOING_ON,
    MORE_TERMS,
    MOST_HALVINGS,
    MOST_STALLS,
    NO_STEP,
    NOT_FINITE,
    PENETRATION,
    STUCK,
)
from eventpound.solvers.fast.sdof.body import (
    SdofBody,
    SdofRun,
    acceleration_level,
    gap_to,
    observe_end,
    pass_border,
    place_of,
    set_tolerance,
    side_closed,
    tangent,
    turn_round,
)
from eventpound.solvers.fast.sdof.record import (
    damped_acceleration,
    force_exceeds,
    sample_sdof,
    take_if_new,
    write_present,
)
from eventpound.solvers.fast.sdof.series import (
    crossing,
    curved_series,
    expand_ground,
    first_reached,
    first_turn,
    linear_series,
    other_acceleration,
    pair_at,
    shorter,
)
from eventpound.solvers.fast.search import motion
from eventpound.tolerances import GAP_COEFFICIENT, OF_BACKBONE

FREE, TURNED, CROSSED, CLOSED_RIGHT, CLOSED_LEFT = 0, 1, 2, 3, 4
"""How a step ends."""
BEYOND = 1.5
"""Length of a step in times of that to the next turn, or impact, of a body under constant pull."""
BEYOND_REACH = 2.0 * BEYOND * (1.0 + BEYOND)
"""How far, in ``v²/a``, a body comes that goes on for twice that, both ways."""
MOST_REVERSALS = 4
"""Times a body that all but stands still is turned round at the start of a step."""


@compiled
def closed_at(way: float) -> int:
    """How a step ends at the barrier in one direction."""
    return CLOSED_RIGHT if way > 0.0 else CLOSED_LEFT


@compiled
def expand_step(a_g: float, solo: SdofRun) -> tuple[int, int, float]:
    """Series of a step, in the direction in which the body moves.

    Parameters
    ----------
    a_g : float
        Acceleration of the ground (m/s²).
    solo : SdofRun
        The run; the longest step is `SdofBody.step`, and a linear body may have `MORE_TERMS` more
        than its order.

    Returns
    -------
    order, first, h
        Highest power, lowest that differs from zero, and length (s).
    """
    body, most = solo.body, solo.plan.limits.order
    order, first, good = 0, 1, False
    for _ in range(MOST_REVERSALS):
        # No event: Φ is one there to within what does not count.
        if body.part == UP and place_of(body.u, body) >= body.saturation:
            body.part, body.z = SATURATED, body.sigma
        body.x[1], body.x[2] = body.v, 0.5 * (body.a - a_g)
        part = body.part
        if part in (UP, DOWN):
            reached = curved_series(1.0 if part == UP else body.kappa_down, most, body)
            order, good = abs(reached), reached > 0
        else:
            order, good = linear_series(tangent(body), most + MORE_TERMS, body)
        first = 1
        if abs(body.v) <= body.still:
            first = _leading(order, body.still / solo.plan.limits.time, body)
        # Else it is about to go against the curve that it is on.
        if part == CORE or body.sigma * body.x[first] >= 0.0:
            break
        turn_round(body.u, solo)
    h = body.step if good else shorter(order, body)
    return order, first, h


@compiled_noinline
def _leading(order: int, level: float, body: SdofBody) -> int:
    """First coefficient that differs from rounding, of a body that all but stands still.

    One that leaves a barrier from rest has those before made zero.
    """
    side = side_closed(body)
    if body.x[1] == 0.0 and side != 0.0:
        for k in range(2, order + 1):
            least = GAP_COEFFICIENT * abs(body.x[k])
            if k == 2:
                least = 0.5 * acceleration_level(body)
            # By this one it opens. Those before are rounding, and none may close it again.
            if -side * body.x[k] > least:
                break
            body.x[k] = 0.0
    for k in range(2, order + 1):
        if abs(body.x[k]) > (level if k == 2 else 0.0):
            return k
    return 1


@compiled
def expected_step_size(a_g: float, body: SdofBody) -> float:
    """Time in which the body is sure to have turned or met a barrier, were its pull constant (s).

    A shorter step takes fewer terms. One whose link all but stands still does not end
    where it turns.
    """
    v, a = body.v, body.a - a_g
    # It turns after |v/a|.
    if v * a < 0.0:
        stands = BEYOND_REACH * v * v <= body.standing * abs(a)
        return (2.0 * BEYOND if stands else BEYOND) * abs(v / a)
    gap = gap_to(a, body)
    if v == 0.0 and a != 0.0 and gap > 0.0:
        return BEYOND * math.sqrt(2.0 * gap / abs(a))
    return np.inf


@compiled
def first_event(h: float, order: int, first: int, solo: SdofRun) -> tuple[float, int, float]:
    """Length of a step of at most h (s), how it ends, and when the body turns (s), or inf.

    The motion at its end stands in `SdofBody` then: `change`, `rate` and `bend`.
    """
    body = solo.body
    reach = h * (abs(body.v) + h * abs(body.x[2]))
    # Two terms alone mostly tell that it moves; only where they do not the whole series is asked.
    if reach <= body.standing:
        reach = 0.0
        for k in range(order, 0, -1):
            reach = (reach + abs(body.x[k])) * h
    if reach <= body.standing:
        # A link that all but stands still reverses at the level of rounding.
        tau, event, turn = _of_standing(h, reach, order, first, solo)
        body.change, body.rate, body.bend = motion(tau, order, body.x[:])
    else:
        tau, event, turn = _of_one_way(h, order, first, solo)
    return tau, event, turn


@compiled
def _of_one_way(h: float, order: int, first: int, solo: SdofRun) -> tuple[float, int, float]:
    """The same for a step that ends where the body turns; before, it goes one way."""
    body = solo.body
    way = 1.0 if body.x[first] > 0.0 else -1.0
    event, tau = FREE, h
    turn = first_turn(order, first, h, body, solo.scratch.work)
    if turn <= h:
        tau, event = turn, FREE if body.part == CORE else TURNED
    body.change, body.rate, body.bend = motion(tau, order, body.x[:])
    gone, one_way = way * body.change, tau
    gap = gap_to(way, body)
    # Up to its turn it goes one way, so that what lies behind its end has been passed once.
    if gap <= gone and tau > 0.0:
        tau = crossing(gap, way, order, one_way, body)
        event = closed_at(way)
    if body.part < UP and body.hysteretic:
        border = body.down_end if body.part == DOWN else body.core_end
        distance = (border - way * body.sigma * place_of(body.u, body)) * body.scale
        # It stands on the border already, but for rounding.
        if distance <= OF_BACKBONE * body.scale:
            tau, event = 0.0, CROSSED
        elif distance <= gone:
            at = crossing(distance, way, order, one_way, body)
            if at < tau:
                tau, event = at, CROSSED
    if tau < one_way:
        body.change, body.rate, body.bend = motion(tau, order, body.x[:])
    return tau, event, turn


@compiled_deferred
def _of_standing(
    h: float, reach: float, order: int, first: int, solo: SdofRun
) -> tuple[float, int, float]:
    """The same for a body that may turn within the step.

    The step ends there if it may be an extreme. `reach` bounds the change of displacement (m).
    """
    body, turn = solo.body, np.inf
    tau, event = _first_unordered(h, reach, order, solo)
    spread = reach * (body.stiffness + body.strength * body.per_scale)
    place = solo.running.at.displacement
    new = not stays_within(place, body.u - reach, body.u + reach, solo.running)
    if new or force_exceeds(body.a - spread, body.a + spread, solo):
        turn = first_turn(order, first, tau, body, solo.scratch.work)
        if turn < tau:
            tau, event = turn, FREE
    return tau, event, turn


@compiled
def _first_unordered(h: float, reach: float, order: int, solo: SdofRun) -> tuple[float, int]:
    """First closing or border within h (s), and `reach` (m), of a body that may turn."""
    body, work = solo.body, solo.scratch.work
    tau, event = h, FREE
    for side in (1.0, -1.0):
        gap = gap_to(side, body)
        if gap <= reach:
            at = first_reached(gap, side, order, tau, body, work)
            if at <= tau:
                tau, event = at, closed_at(side)
    if body.hysteretic and body.part <= DOWN:
        xi = place_of(body.u, body)
        # What ends UNLOADING is the end of the core, and so for the core on either side.
        border = body.core_end if body.part <= UNLOADING else body.down_end
        for side in (1.0, -1.0):
            # Only the core has a border below.
            if side < 0.0 and body.part != CORE:
                continue
            distance = (border - side * xi) * body.scale
            if distance <= OF_BACKBONE * body.scale:
                distance = 0.0
            if distance <= reach:
                at = first_reached(distance, side * body.sigma, order, tau, body, work)
                if at < tau:
                    tau, event = at, CROSSED
    return tau, event


@compiled
def take_step(wanted: float, stop: float, piece: CurrentPiece, solo: SdofRun) -> int:
    """One step of at most `wanted` (s); GOING_ON, or why not."""
    body, t = solo.body, solo.now.t
    a_g = body.even
    # A ground of several terms is expanded anew, with 1 for both factors of its series.
    if not body.pair:
        a_g = expand_ground(t, solo.plan.limits.order + MORE_TERMS, piece, body.ground[:])
        body.even = body.odd = 1.0
    body.step = min(wanted, expected_step_size(a_g, body))
    set_tolerance(body)
    order, first, h = expand_step(a_g, solo)
    solo.progress.expansions += 1
    tau, event, turn = first_event(h, order, first, solo)
    for halving in range(MOST_HALVINGS):
        t_end = stop if tau == stop - t else t + tau
        _observe_ground(t_end, piece, body)
        observe_end(solo)
        if equations_hold(tau, order, body):
            break
        if halving == MOST_HALVINGS - 1:
            return NO_STEP
        # What ends the step now is its error.
        event = FREE
        tau *= _shortened(tau, order, body)
        body.change, body.rate, body.bend = motion(tau, order, body.x[:])
    turned = event == TURNED or (turn <= tau and event == FREE)
    if body.damping > 0.0:
        damped_acceleration(t, tau, order, solo)
    due = is_due(t_end, solo.plan.output_times, solo.progress)
    if due and not sample_sdof(t, t_end, order, piece, solo):
        return FULL
    return arrive(tau, t_end, turned, event, solo)


@compiled
def arrive(tau: float, t_end: float, turned: bool, event: int, solo: SdofRun) -> int:
    """Make the end of a step of length tau (s) the present state, and do what ends it there."""
    body = solo.body
    if turned:
        # Exactly, where the root has left its rounding.
        body.rate = 0.0
        take_if_new(t_end, body.u + body.change, body.next_a, solo)
    pass_time(tau, t_end, 1, solo.now, solo.progress)
    _move(body)
    code = audit(solo.progress.stalled, body)
    if code == GOING_ON and event != FREE:
        _do_event(event, t_end, solo)
    elif is_over(solo.now, solo.plan.limits.time):
        list_all(solo.now, solo.events)
    return code


@compiled
def equations_hold(tau: float, order: int, body: SdofBody) -> bool:
    """Whether the equations of motion hold at the end of a step, of length tau (s).

    A defect that grows like τ^(p-1) leaves τ/p of itself in v and τ²/p² in u.
    """
    defect = abs(body.next_a - body.next_g - body.bend) * tau
    return defect <= body.of_v * order and defect * tau <= body.of_u * order**2


@compiled_noinline
def _shortened(tau: float, order: int, body: SdofBody) -> float:
    """Factor by which a step is to be shortened that does not fit."""
    defect = abs(body.next_a - body.next_g - body.bend) * tau
    error = max(defect / (body.of_v * order), defect * tau / (body.of_u * order**2))
    return shortening(error, order)


@compiled
def audit(stalled: int, body: SdofBody) -> int:
    """Invariants after every step: finite numbers, no penetration, progress."""
    if not (abs(body.u) < np.inf and abs(body.v) < np.inf):
        return NOT_FINITE
    if min(body.right, body.left) < body.least_gap:
        return PENETRATION
    return GOING_ON if stalled <= MOST_STALLS else STUCK


@compiled
def _observe_ground(t: float, piece: CurrentPiece, body: SdofBody) -> None:
    """What the ground is at the end of a step, at t (s)."""
    if body.pair:
        body.next_g, body.next_odd = pair_at(t, piece, body)
    else:
        body.next_g = other_acceleration(t, piece)


@compiled
def _move(body: SdofBody) -> None:
    """Make the end of the step the present state.

    A gap that is small is a variable of its own.
    """
    change = body.change
    u = body.u + change
    # `near` counts from the gap itself, whose rounding becomes small with it.
    near, far = body.right - change, body.right_gap - u
    body.right = far if far >= body.own_gap else near
    near, far = body.left + change, body.left_gap + u
    body.left = far if far >= body.own_gap else near
    body.u, body.v, body.z, body.a = u, body.rate, body.next_z, body.next_a
    body.even, body.odd = body.next_g, body.next_odd


@compiled
def _do_event(event: int, t: float, solo: SdofRun) -> None:
    """Do what ended the step; an impact is settled next."""
    body = solo.body
    if event == TURNED:
        turn_round(body.u, solo)
    elif event == CROSSED:
        pass_border(body.u, body)
    else:
        # Before the impact sets back the time since the last one.
        end_flight(solo.now)
        if event == CLOSED_RIGHT:
            body.right = 0.0
        else:
            body.left = 0.0
        write_present(t, body.next_g, solo)
        solo.progress.due = 1
