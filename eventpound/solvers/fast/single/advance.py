"""One step of a single body: taken, judged, and what ends it."""

from __future__ import annotations

import numpy as np

from eventpound.numerics.arrays import Ints
from eventpound.solvers.events.cascade import IN_A_ROW, INTERVAL, SINCE_IMPACT, T
from eventpound.solvers.events.event_rows import list_all
from eventpound.solvers.events.impacts import FULL
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.run import (
    CASCADE_OVER,
    DUE,
    EXPANSIONS,
    GOING_ON,
    MORE_TERMS,
    MOST_HALVINGS,
    MOST_STALLS,
    NO_STEP,
    NOT_FINITE,
    OUTPUT,
    PENETRATION,
    STALLED,
    STEPS,
    STUCK,
    Piece,
)
from eventpound.solvers.fast.single.body import (
    Body,
    SingleRun,
    absolute_acceleration,
    pass_border,
    spring_state,
    turn_round,
)
from eventpound.solvers.fast.single.record import (
    damped_acceleration,
    sample_single,
    take_if_new,
    write_present,
)
from eventpound.solvers.fast.single.series import (
    expand_ground,
    motion,
    other_acceleration,
    pair_at,
)
from eventpound.solvers.fast.single.step import (
    CLOSED_RIGHT,
    CROSSED,
    FREE,
    TURNED,
    expand_step,
    expected_length,
    first_event,
)


@compiled
def take_step(
    wanted: float,
    stop: float,
    pair: bool,
    segment: int,
    piece: Piece,
    run: SingleRun,
) -> int:
    """One step of at most `wanted` (s); GOING_ON, or why not."""
    count, body, times, t = run.count, run.body, run.times, run.clock[T]
    a_g = body.even
    if not pair:
        a_g = expand_ground(t, run.limits.order + MORE_TERMS, piece, body.ground[:])
        body.even = body.odd = 1.0
    wanted = body.step = min(wanted, expected_length(a_g, body))
    body.of_u = body.atol_u + body.rtol * abs(body.u)
    body.of_v = body.atol_v + body.rtol * abs(body.v)
    order, first, h = expand_step(wanted, run.limits.order, a_g, run.limits.time, run.table, body)
    count[EXPANSIONS] += 1
    tau, event, turn = first_event(h, order, first, run)
    for halving in range(MOST_HALVINGS):
        t_end = stop if tau == stop - t else t + tau
        _look(t_end, pair, segment, piece, run)
        if fits(tau, order, body):
            break
        if halving == MOST_HALVINGS - 1:
            return NO_STEP
        event = FREE
        tau *= _shortened(tau, order, body)
        body.change, body.rate, body.bend = motion(tau, order, body)
    if body.damping > 0.0:
        damped_acceleration(t, tau, order, run)
    due = count[OUTPUT] < times.size and times[count[OUTPUT]] < t_end
    if due and not sample_single(t, t_end, order, piece, run):
        return FULL
    turned = event == TURNED or (turn <= tau and event == FREE)
    return arrive(tau, t_end, turned, event, run)


@compiled
def arrive(tau: float, t_end: float, turned: bool, event: int, run: SingleRun) -> int:
    """Make the end of a step of length tau (s) the present state, and do what ends it there."""
    clock, count, body = run.clock, run.count, run.body
    if turned:
        body.rate = 0.0
        take_if_new(t_end, body.u + body.change, body.next_a, run)
    clock[T] = t_end
    clock[SINCE_IMPACT] += tau
    count[STEPS] += 1
    count[STALLED] = count[STALLED] + 1 if tau == 0.0 else 0
    _move(body)
    code = audit(count, body)
    if code == GOING_ON and event != FREE:
        _happen(event, t_end, run)
    elif body.held_back or count[IN_A_ROW] > 0:
        _end_cascade(run)
    return code


@compiled
def fits(tau: float, order: int, body: Body) -> bool:
    """Whether the equations of motion hold at the end of a step, of length tau (s).

    A defect that grows like τ^(p-1) leaves τ/p of itself in v and τ²/p² in u.
    """
    defect = abs(body.next_a - body.next_g - body.bend) * tau
    return defect <= body.of_v * order and defect * tau <= body.of_u * order


@compiled_apart
def _shortened(tau: float, order: int, body: Body) -> float:
    """Factor by which a step is to be shortened that does not fit."""
    defect = abs(body.next_a - body.next_g - body.bend) * tau
    error = max(defect / (body.of_v * order), defect * tau / (body.of_u * order))
    return max(0.1, 0.9 * error ** (-1.0 / order)) if error < np.inf else 0.1


@compiled
def audit(count: Ints, body: Body) -> int:
    """Invariants after every step: finite numbers, no penetration, progress."""
    if not (abs(body.u) < np.inf and abs(body.v) < np.inf):
        return NOT_FINITE
    if min(body.right, body.left) < body.least_gap:
        return PENETRATION
    return GOING_ON if count[STALLED] <= MOST_STALLS else STUCK


@compiled
def _look(
    t: float,
    pair: bool,
    segment: int,
    piece: Piece,
    run: SingleRun,
) -> None:
    """What the forces and the ground are at the end of a step."""
    body = run.body
    if pair:
        even, odd = pair_at(t, piece, segment, body)
        body.next_even, body.next_odd, body.next_g = even, odd, even
    else:
        body.next_g = other_acceleration(t, piece)
    u = body.u + body.change
    body.next_z = spring_state(u, run.table, body)
    body.next_a = absolute_acceleration(u, body.rate, body.next_z, body)


@compiled
def _move(body: Body) -> None:
    """Make the end of the step the present state.

    A gap that is small is a variable of its own.
    """
    change = body.change
    u = body.u + change
    near, far = body.right - change, body.right_gap - u
    body.right = far if far >= body.own_gap else near
    near, far = body.left + change, body.left_gap + u
    body.left = far if far >= body.own_gap else near
    body.u, body.v, body.z, body.a = u, body.rate, body.next_z, body.next_a
    body.even, body.odd = body.next_even, body.next_odd


@compiled
def _end_cascade(run: SingleRun) -> None:
    """List what was held back once the last impact is long ago."""
    if run.clock[SINCE_IMPACT] > CASCADE_OVER * run.limits.time:
        list_all(run.count, run.events)
        run.count[IN_A_ROW] = 0
        run.body.held_back = False


@compiled
def _happen(event: int, t: float, run: SingleRun) -> None:
    """Do what ended the step; an impact is settled next."""
    body = run.body
    if event == TURNED:
        turn_round(body.u, run.table, body)
    elif event == CROSSED:
        pass_border(body.u, body)
    else:
        run.clock[INTERVAL] = run.clock[SINCE_IMPACT]
        if event == CLOSED_RIGHT:
            body.right = 0.0
        else:
            body.left = 0.0
        write_present(t, body.next_g, run)
        run.count[DUE] = 1
