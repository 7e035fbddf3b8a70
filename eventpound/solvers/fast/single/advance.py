"""One step of a single body: taken, judged, and what ends it."""

from __future__ import annotations

import numpy as np

from eventpound.numerics.arrays import Floats, Ints
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
    ATOL_U,
    ATOL_V,
    BEND,
    CHANGE,
    DAMPING,
    EVEN,
    HELD_BACK,
    LEAST_GAP,
    LEFT,
    LEFT_GAP,
    NEXT_A,
    NEXT_EVEN,
    NEXT_G,
    NEXT_ODD,
    NEXT_Z,
    ODD,
    OF_G,
    OF_U,
    OF_V,
    OWN,
    RATE,
    RIGHT,
    RIGHT_GAP,
    ROOM,
    RTOL,
    STEP,
    A,
    SingleRun,
    U,
    V,
    Z,
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
    count, w, times, t = run.count, run.w, run.times, run.clock[T]
    a_g = w[EVEN]
    if not pair:
        g = w[OF_G : OF_G + ROOM]
        a_g = expand_ground(t, run.order + MORE_TERMS, piece, g)
        w[EVEN] = w[ODD] = 1.0
    wanted = w[STEP] = min(wanted, expected_length(a_g, w))
    w[OF_U] = w[ATOL_U] + w[RTOL] * abs(w[U])
    w[OF_V] = w[ATOL_V] + w[RTOL] * abs(w[V])
    order, first, h = expand_step(wanted, run.order, a_g, run.time, run.table, w)
    count[EXPANSIONS] += 1
    tau, event, turn = first_event(h, order, first, run)
    for halving in range(MOST_HALVINGS):
        t_end = stop if tau == stop - t else t + tau
        _look(t_end, pair, segment, piece, run)
        if fits(tau, order, w):
            break
        if halving == MOST_HALVINGS - 1:
            return NO_STEP
        event = FREE
        tau *= _shortened(tau, order, w)
        w[CHANGE], w[RATE], w[BEND] = motion(tau, order, w)
    if w[DAMPING] > 0.0:
        damped_acceleration(t, tau, order, run)
    due = count[OUTPUT] < times.size and times[count[OUTPUT]] < t_end
    if due and not sample_single(t, t_end, order, piece, run):
        return FULL
    turned = event == TURNED or (turn <= tau and event == FREE)
    return arrive(tau, t_end, turned, event, run)


@compiled
def arrive(tau: float, t_end: float, turned: bool, event: int, run: SingleRun) -> int:
    """Make the end of a step of length tau (s) the present state, and do what ends it there."""
    clock, count, w = run.clock, run.count, run.w
    if turned:
        w[RATE] = 0.0
        take_if_new(t_end, w[U] + w[CHANGE], w[NEXT_A], run)
    clock[T] = t_end
    clock[SINCE_IMPACT] += tau
    count[STEPS] += 1
    count[STALLED] = count[STALLED] + 1 if tau == 0.0 else 0
    _move(w)
    code = audit(count, w)
    if code == GOING_ON and event != FREE:
        _happen(event, t_end, run)
    elif w[HELD_BACK] != 0.0 or count[IN_A_ROW] > 0:
        _end_cascade(run)
    return code


@compiled
def fits(tau: float, order: int, w: Floats) -> bool:
    """Whether the equations of motion hold at the end of a step, of length tau (s).

    A defect that grows like τ^(p-1) leaves τ/p of itself in v and τ²/p² in u.
    """
    defect = abs(w[NEXT_A] - w[NEXT_G] - w[BEND]) * tau
    return defect <= w[OF_V] * order and defect * tau <= w[OF_U] * order


@compiled_apart
def _shortened(tau: float, order: int, w: Floats) -> float:
    """Factor by which a step is to be shortened that does not fit."""
    defect = abs(w[NEXT_A] - w[NEXT_G] - w[BEND]) * tau
    error = max(defect / (w[OF_V] * order), defect * tau / (w[OF_U] * order))
    return max(0.1, 0.9 * error ** (-1.0 / order)) if error < np.inf else 0.1


@compiled
def audit(count: Ints, w: Floats) -> int:
    """Invariants after every step: finite numbers, no penetration, progress."""
    if not (abs(w[U]) < np.inf and abs(w[V]) < np.inf):
        return NOT_FINITE
    if min(w[RIGHT], w[LEFT]) < w[LEAST_GAP]:
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
    w = run.w
    if pair:
        even, odd = pair_at(t, piece, segment, w)
        w[NEXT_EVEN], w[NEXT_ODD], w[NEXT_G] = even, odd, even
    else:
        w[NEXT_G] = other_acceleration(t, piece)
    u = w[U] + w[CHANGE]
    w[NEXT_Z] = spring_state(u, run.table, w)
    w[NEXT_A] = absolute_acceleration(u, w[RATE], w[NEXT_Z], w)


@compiled
def _move(w: Floats) -> None:
    """Make the end of the step the present state.

    A gap that is small is a variable of its own.
    """
    change = w[CHANGE]
    u = w[U] + change
    near, far = w[RIGHT] - change, w[RIGHT_GAP] - u
    w[RIGHT] = far if far >= w[OWN] else near
    near, far = w[LEFT] + change, w[LEFT_GAP] + u
    w[LEFT] = far if far >= w[OWN] else near
    w[U], w[V], w[Z], w[A] = u, w[RATE], w[NEXT_Z], w[NEXT_A]
    w[EVEN], w[ODD] = w[NEXT_EVEN], w[NEXT_ODD]


@compiled
def _end_cascade(run: SingleRun) -> None:
    """List what was held back once the last impact is long ago."""
    if run.clock[SINCE_IMPACT] > CASCADE_OVER * run.time:
        list_all(run.count, run.events)
        run.count[IN_A_ROW] = 0
        run.w[HELD_BACK] = 0.0


@compiled
def _happen(event: int, t: float, run: SingleRun) -> None:
    """Do what ended the step; an impact is settled next."""
    w = run.w
    if event == TURNED:
        turn_round(w[U], run.table, w)
    elif event == CROSSED:
        pass_border(w[U], w)
    else:
        run.clock[INTERVAL] = run.clock[SINCE_IMPACT]
        w[RIGHT if event == CLOSED_RIGHT else LEFT] = 0.0
        write_present(t, w[NEXT_G], run)
        run.count[DUE] = 1
