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
from eventpound.numerics.lending import lend
from eventpound.solvers.events.cascade import INTERVAL, SINCE_IMPACT, T
from eventpound.solvers.events.event_bounds import unpack_running
from eventpound.solvers.events.event_rows import events_wanted
from eventpound.solvers.events.impacts import DONE, FULL
from eventpound.solvers.fast.compiled import compiled, compiled_deferred_loop, compiled_loop
from eventpound.solvers.fast.expansion import GAUSSIAN_STEP
from eventpound.solvers.fast.record import rows_wanted
from eventpound.solvers.fast.run import (
    DUE,
    GOING_ON,
    MOST_STALLS,
    PIECE,
    STALLED,
    STEPS,
    STUCK,
    Plan,
    Record,
    Single,
    State,
    piece_of,
)
from eventpound.solvers.fast.single.advance import take_step
from eventpound.solvers.fast.single.body import (
    SingleRun,
    enter,
    leave,
)
from eventpound.solvers.fast.single.exact import (
    NOT_FREE,
    sample_steps,
    swing_freely,
    swings_freely,
)
from eventpound.solvers.fast.single.instant import rest_step, set_force, settle_single
from eventpound.solvers.fast.single.record import take_if_new, take_settled, write_present
from eventpound.solvers.fast.single.series import is_pair, know_piece, pair_at, sample_after

_SAMPLES, _GAUSSIAN, _ZERO = int(Family.SAMPLES), int(Family.GAUSSIAN), int(Family.ZERO)


@compiled_loop
def oscillate(budget: int, plan: Plan, state: State, single: Single, record: Record) -> int:
    """Carry a single body to the end of its run, or as far as steps and room reach.

    Parameters
    ----------
    budget : int
        Most steps.
    plan, state, single, record
        See `eventpound.solvers.fast.run`; a record whose rows have no width takes none.

    Returns
    -------
    int
        As of `eventpound.solvers.fast.advance.advance`.
    """
    start = plan.hysteresis.at[0] if plan.hysteresis.at.size > 0 else 0
    run = lend(
        SingleRun(
            single.body[0],
            state.clock,
            state.count,
            record.events,
            record.rows,
            unpack_running(record.extremes),
            plan.output_times,
            plan.hysteresis.tables[start:],
            plan.links,
            plan.contacts,
            plan.ground,
            plan.limits,
            plan.oscillator,
            single,
        )
    )
    body, clock, count = run.body, run.clock, run.count
    if not body.known:
        enter(plan, state, run.table, body)
    last_step = count[STEPS] + budget
    code = GOING_ON
    while code == GOING_ON:
        if not _has_room(run):
            code = FULL
            break
        if count[DUE] == 1 or clock[T] >= run.limits.end:
            _settle(run)
            if clock[T] >= run.limits.end:
                code = DONE
                break
        if count[STEPS] >= last_step:
            break
        code = _rest(last_step, run) if body.rests_on != 0.0 else _swing(last_step, run)
    leave(plan.oscillator, body, state)
    return code


@compiled
def _has_room(run: SingleRun) -> bool:
    """Whether the record can take what an event and all output times may write."""
    count, rows = run.count, run.rows
    return events_wanted(1, count) <= run.events.shape[0] and (
        rows.shape[1] == 0 or rows_wanted(run.times.size, count) <= rows.shape[0]
    )


@compiled
def _settle(run: SingleRun) -> None:
    """Do the duties of the present instant and write down what follows it."""
    body, count, ground, t = run.body, run.count, run.ground, run.clock[T]
    while count[DUE] == 1 and ground.ends[count[PIECE]] <= t:
        count[PIECE] += 1
    piece = lend(piece_of(count[PIECE], ground))
    g = ground_acceleration(piece, t)
    if count[DUE] == 1:
        settle_single(g, piece, run)
        count[DUE] = 0
        body.segment = -1
    set_force(g, body)
    write_present(t, g, run)
    take_settled(t, g if body.rests_on != 0.0 else body.a, run)


@compiled_deferred_loop
def _rest(last_step: int, run: SingleRun) -> int:
    """Steps of a body at rest, until something is to be settled."""
    ground, count, clock, body = run.ground, run.count, run.clock, run.body
    i = count[PIECE]
    piece = lend(piece_of(i, ground))
    piece_end = min(ground.ends[i], run.limits.end)
    while count[STEPS] < last_step and count[DUE] == 0 and clock[T] < piece_end:
        if not rest_step(piece_end, piece, run):
            return FULL
        if body.released:
            clock[INTERVAL] = clock[SINCE_IMPACT]
            g = ground_acceleration(piece, clock[T])
            write_present(clock[T], g, run)
            count[DUE] = 1
        if count[STALLED] > MOST_STALLS:
            return STUCK
    if clock[T] >= ground.ends[i]:
        count[DUE] = 1
    return GOING_ON


@compiled
def _swing(last_step: int, run: SingleRun) -> int:
    """Steps of a body that moves, until something is to be settled."""
    clock, count, body, ground = run.clock, run.count, run.body, run.ground
    i = count[PIECE]
    piece = lend(piece_of(i, ground))
    piece_end = min(ground.ends[i], run.limits.end)
    family, coefficients, samples = piece.family, piece.coefficients, piece.samples
    if body.piece_known != i + 1:
        know_piece(i, family, coefficients, body)
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
                passed = sample_steps(budget, segment, piece_end, piece, run)
                if passed > segment:
                    stop, segment = sample_after(coefficients, samples, clock[T], piece_end)
                if count[STEPS] >= last_step:
                    break
        if pair and body.segment != segment:
            body.even, body.odd = pair_at(clock[T], piece, segment, body)
            body.segment = segment
        if family == _ZERO and swings_freely(body):
            code = swing_freely(stop, run)
            if code != NOT_FREE:
                continue
        wanted = min(stop - clock[T], longest)
        code = take_step(wanted, stop, pair, segment, piece, run)
    if clock[T] >= ground.ends[i]:
        count[DUE] = 1
    if count[DUE] == 1 or clock[T] >= piece_end:
        # The end of a stretch may be an extreme.
        take_if_new(clock[T], body.u, body.a, run)
    return code
