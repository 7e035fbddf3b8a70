"""A whole run of a single body, in scalars.

Each step is one that `eventpound.solvers.fast.advance` could have taken, and
leaves the same state: series, length from the last terms, first event, defect
at the end, extremes and history.
"""

from __future__ import annotations

import math

import numpy as np

from eventpound.motion.base import Family
from eventpound.motion.forcing import ground_acceleration, sample_time
from eventpound.numerics.arrays import Floats, Ints
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.event_rows import list_all
from eventpound.solvers.fast.length import GAUSSIAN_STEP
from eventpound.solvers.fast.outcome import (
    CASCADE_OVER,
    DONE,
    FULL,
    GOING_ON,
    MOST_HALVINGS,
    MOST_STALLS,
    NO_STEP,
    NOT_FINITE,
    PENETRATION,
    STUCK,
)
from eventpound.solvers.fast.plan import (
    DUE,
    EVENTS,
    EXPANSIONS,
    IN_A_ROW,
    INTERVAL,
    MORE_TERMS,
    OUTPUT,
    PIECE,
    ROWS,
    SINCE_IMPACT,
    STALLED,
    STEPS,
    Plan,
    Record,
    Series,
    State,
    T,
)
from eventpound.solvers.fast.single import absolute_acceleration, spring_state
from eventpound.solvers.fast.single_extremes import (
    damped_acceleration,
    take_if_new,
    take_settled,
)
from eventpound.solvers.fast.single_ground import (
    expand_ground,
    is_pair,
    know_piece,
    other_acceleration,
    pair_at,
    sample_after,
)
from eventpound.solvers.fast.single_history import sample_single, write_single_row
from eventpound.solvers.fast.single_instant import settle_single
from eventpound.solvers.fast.single_parts import pass_border, turn_round
from eventpound.solvers.fast.single_places import (
    ATOL_U,
    ATOL_V,
    BEND,
    CHANGE,
    DAMPING,
    EVEN,
    HELD_BACK,
    KNOWN,
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
    PIECE_KNOWN,
    RATE,
    RELEASED,
    RESTS_ON,
    RIGHT,
    RIGHT_GAP,
    ROOM,
    RTOL,
    SEGMENT,
    STEP,
    A,
    U,
    V,
    Z,
)
from eventpound.solvers.fast.single_record import sample_steps
from eventpound.solvers.fast.single_rest import rest_step, set_force
from eventpound.solvers.fast.single_run import Run, enter, leave, run_of
from eventpound.solvers.fast.single_series import motion
from eventpound.solvers.fast.single_step import (
    CLOSED_RIGHT,
    CROSSED,
    FREE,
    TURNED,
    expand_step,
    expected_length,
    first_event,
)

_SAMPLES, _GAUSSIAN = int(Family.SAMPLES), int(Family.GAUSSIAN)


@compiled_apart
def oscillate(budget: int, plan: Plan, state: State, series: Series, record: Record) -> int:
    """Carry a single body to the end of its run, or as far as steps and room reach.

    Parameters
    ----------
    budget : int
        Most steps.
    plan, state, series, record
        See `eventpound.solvers.fast.plan`; a record whose rows have no width takes none.

    Returns
    -------
    int
        As of `eventpound.solvers.fast.advance.advance`.
    """
    run = run_of(plan, state, series, record)
    w, clock, count = run.w, run.clock, run.count
    if w[KNOWN] == 0.0:
        enter(plan, state, run.table, w)
    last_step = count[STEPS] + budget
    code = GOING_ON
    while code == GOING_ON:
        if not _has_room(run):
            code = FULL
            break
        if count[DUE] == 1 or clock[T] >= run.end:
            _settle(run)
            if clock[T] >= run.end:
                code = DONE
                break
        if count[STEPS] >= last_step:
            break
        code = _rest(last_step, run) if w[RESTS_ON] != 0.0 else _swing(last_step, run)
    leave(plan, w, state)
    return code


@compiled
def _has_room(run: Run) -> bool:
    """Whether the record can take what an event and all output times may write."""
    count, rows = run.count, run.rows
    wanted = count[ROWS] + run.times.size - count[OUTPUT] + 4
    return count[EVENTS] + 6 <= run.events.shape[0] and (
        rows.shape[1] == 0 or wanted <= rows.shape[0]
    )


@compiled
def _write(t: float, g: float, run: Run) -> None:
    """Add the present state to the history."""
    w = run.w
    if run.rows.shape[1] > 0:
        write_single_row(t, g, 0.0, w[V], g if w[RESTS_ON] != 0.0 else w[A], w[Z], run)


@compiled
def _settle(run: Run) -> None:
    """Do the duties of the present instant and write down what follows it."""
    w, count, ground, t = run.w, run.count, run.ground, run.clock[T]
    while count[DUE] == 1 and ground.ends[count[PIECE]] <= t:
        count[PIECE] += 1
    i = count[PIECE]
    family = ground.family[i]
    coefficients = ground.coefficients[ground.first[i] : ground.first[i + 1]]
    samples = ground.samples[ground.first_sample[i] : ground.first_sample[i + 1]]
    g = ground_acceleration(family, coefficients, samples, t)
    if count[DUE] == 1:
        settle_single(g, family, coefficients, samples, run)
        count[DUE] = 0
        w[SEGMENT] = -1.0
    set_force(g, w)
    _write(t, g, run)
    take_settled(t, g if w[RESTS_ON] != 0.0 else w[A], run)


@compiled
def _rest(last_step: int, run: Run) -> int:
    """Steps of a body at rest, until something is to be settled."""
    ground, count, clock, w = run.ground, run.count, run.clock, run.w
    i = count[PIECE]
    family = ground.family[i]
    coefficients = ground.coefficients[ground.first[i] : ground.first[i + 1]]
    samples = ground.samples[ground.first_sample[i] : ground.first_sample[i + 1]]
    piece_end = min(ground.ends[i], run.end)
    while count[STEPS] < last_step and count[DUE] == 0 and clock[T] < piece_end:
        if not rest_step(piece_end, family, coefficients, samples, run):
            return FULL
        if w[RELEASED] != 0.0:
            clock[INTERVAL] = clock[SINCE_IMPACT]
            g = ground_acceleration(family, coefficients, samples, clock[T])
            _write(clock[T], g, run)
            count[DUE] = 1
        if count[STALLED] > MOST_STALLS:
            return STUCK
    if clock[T] >= ground.ends[i]:
        count[DUE] = 1
    return GOING_ON


@compiled
def _swing(last_step: int, run: Run) -> int:
    """Steps of a body that moves, until something is to be settled."""
    clock, count, w, ground = run.clock, run.count, run.w, run.ground
    i = count[PIECE]
    family = ground.family[i]
    coefficients = ground.coefficients[ground.first[i] : ground.first[i + 1]]
    samples = ground.samples[ground.first_sample[i] : ground.first_sample[i + 1]]
    piece_end = min(ground.ends[i], run.end)
    if w[PIECE_KNOWN] != i + 1.0:
        know_piece(i, family, coefficients, w)
    pair = is_pair(family, coefficients)
    longest = GAUSSIAN_STEP / math.sqrt(coefficients[1]) if family == _GAUSSIAN else np.inf
    stop, segment, code = piece_end, 0, GOING_ON
    if family == _SAMPLES:
        stop, segment = sample_after(coefficients, samples, clock[T], piece_end)
    while code == GOING_ON and count[DUE] == 0 and clock[T] < piece_end:
        if count[STEPS] >= last_step:
            break
        if family == _SAMPLES:
            dt = coefficients[1]
            if stop <= clock[T] + 1e-9 * dt and stop < piece_end:
                stop, segment = sample_after(coefficients, samples, clock[T], piece_end)
            if clock[T] == sample_time(coefficients[0], dt, segment):
                budget = last_step - count[STEPS]
                passed = sample_steps(
                    budget, segment, piece_end, family, coefficients, samples, run
                )
                if passed > segment:
                    stop, segment = sample_after(coefficients, samples, clock[T], piece_end)
                if count[STEPS] >= last_step:
                    break
        if pair and w[SEGMENT] != segment:
            w[EVEN], w[ODD] = pair_at(clock[T], family, coefficients, samples, segment, w)
            w[SEGMENT] = segment
        wanted = min(stop - clock[T], longest)
        code = _step(wanted, stop, pair, segment, family, coefficients, samples, run)
    if clock[T] >= ground.ends[i]:
        count[DUE] = 1
    if count[DUE] == 1 or clock[T] >= piece_end:
        # The end of a stretch may be an extreme.
        take_if_new(clock[T], w[U], w[A], run)
    return code


@compiled
def _step(
    wanted: float,
    stop: float,
    pair: bool,
    segment: int,
    family: int,
    coefficients: Floats,
    samples: Floats,
    run: Run,
) -> int:
    """One step of at most `wanted` (s); GOING_ON, or why not."""
    clock, count, w, times, t = run.clock, run.count, run.w, run.times, run.clock[T]
    a_g = w[EVEN]
    if not pair:
        g = w[OF_G : OF_G + ROOM]
        a_g = expand_ground(t, run.order + MORE_TERMS, family, coefficients, samples, g)
        w[EVEN] = w[ODD] = 1.0
    wanted = w[STEP] = min(wanted, expected_length(a_g, w))
    w[OF_U] = w[ATOL_U] + w[RTOL] * abs(w[U])
    w[OF_V] = w[ATOL_V] + w[RTOL] * abs(w[V])
    order, first, h = expand_step(wanted, run.order, a_g, run.time, run.table, w)
    count[EXPANSIONS] += 1
    tau, event, turn = first_event(h, order, first, run)
    for halving in range(MOST_HALVINGS):
        t_end = stop if tau == stop - t else t + tau
        _look(t_end, pair, segment, family, coefficients, samples, run)
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
    if due and not sample_single(t, t_end, order, family, coefficients, samples, run):
        return FULL
    if event == TURNED or (turn <= tau and event == FREE):
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
    family: int,
    coefficients: Floats,
    samples: Floats,
    run: Run,
) -> None:
    """What the forces and the ground are at the end of a step."""
    w = run.w
    if pair:
        even, odd = pair_at(t, family, coefficients, samples, segment, w)
        w[NEXT_EVEN], w[NEXT_ODD], w[NEXT_G] = even, odd, even
    else:
        w[NEXT_G] = other_acceleration(t, family, coefficients, samples)
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
def _end_cascade(run: Run) -> None:
    """List what was held back once the last impact is long ago."""
    if run.clock[SINCE_IMPACT] > CASCADE_OVER * run.time:
        list_all(run.count, run.events)
        run.count[IN_A_ROW] = 0
        run.w[HELD_BACK] = 0.0


@compiled
def _happen(event: int, t: float, run: Run) -> None:
    """Do what ended the step; an impact is settled next."""
    w = run.w
    if event == TURNED:
        turn_round(w[U], run.table, w)
    elif event == CROSSED:
        pass_border(w[U], w)
    else:
        run.clock[INTERVAL] = run.clock[SINCE_IMPACT]
        w[RIGHT if event == CLOSED_RIGHT else LEFT] = 0.0
        _write(t, w[NEXT_G], run)
        run.count[DUE] = 1
