"""The loop of the compiled stepper: expand, choose a step, look for events, move.

One kind of step serves everything: smooth motion, the samples of a record,
and a cascade of impacts whose intervals shrink below the rounding of time.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.reduced import Forcing
from eventpound.motion.base import Family
from eventpound.motion.forcing import ground_acceleration, next_sample
from eventpound.solvers.events.inspection import Running, update_settled
from eventpound.solvers.fast import noise
from eventpound.solvers.fast.backbone_parts import cross_border, reverse
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.elongation import elongations
from eventpound.solvers.fast.event_rows import end_cascade
from eventpound.solvers.fast.expansion import expand_all, wrong_way
from eventpound.solvers.fast.extremes import inside_step, take_instant
from eventpound.solvers.fast.force_extremes import forces_inside_step
from eventpound.solvers.fast.history import copy_numbers, sample_step, write_row
from eventpound.solvers.fast.instant import choose_branches, mark_together, settle
from eventpound.solvers.fast.ledger import add_work
from eventpound.solvers.fast.length import choose_length, defect_error
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
    CLUSTERS,
    DUE,
    EVENTS,
    GUESS,
    IN_A_ROW,
    INTERVAL,
    ORDER,
    OUTPUT,
    PIECE,
    RESTING,
    ROWS,
    SINCE_IMPACT,
    STALLED,
    STEPS,
    Happened,
    Plan,
    Record,
    Series,
    State,
    T,
)
from eventpound.solvers.fast.search import first_happening, set_travel
from eventpound.solvers.fast.seen import Seen, contact_force_series, look, look_apart

_SAMPLES = int(Family.SAMPLES)


@compiled_apart
def advance(
    budget: int,
    plan: Plan,
    state: State,
    series: Series,
    happened: Happened,
    record: Record,
    seen: Seen,
) -> int:
    """Carry a run on by at most `budget` steps.

    Parameters
    ----------
    budget : int
        Most steps.
    plan, state, series, happened, record, seen
        See `eventpound.solvers.fast.plan` and `seen`.

    Returns
    -------
    int
        How it ended: FINISHED, GOING_ON, FULL (the record needs more room), or
        an error; the state says when and where.
    """
    limits, ground, clock, count = plan.limits, plan.ground, state.clock, state.count
    table = record.extremes
    running = Running(table[0], table[1], table[2], table[3], table[4])
    times = plan.output_times
    for _ in range(budget):
        if not has_room(plan, state, record):
            return FULL
        t = clock[T]
        if t >= limits.end or count[DUE] == 1:
            ended = _settle_instant(plan, state, series, happened, record, seen, running)
            if ended != DONE or t >= limits.end:
                return ended
        i = count[PIECE]
        family = ground.family[i]
        coefficients = ground.coefficients[ground.first[i] : ground.first[i + 1]]
        samples = ground.samples[ground.first_sample[i] : ground.first_sample[i + 1]]
        piece_end = min(ground.ends[i], limits.end)
        stop = next_sample(coefficients, t, piece_end) if family == _SAMPLES else piece_end
        order = count[ORDER]
        for _again in range(4):
            expand_all(t, order, family, coefficients, samples, plan, state, series)
            if not wrong_way(plan, state, series, order):
                break
        h = choose_length(order, stop - t, family, coefficients, plan, state, series)
        if count[RESTING] > 0:
            contact_force_series(order, plan, state, series)
        set_travel(order, h, count[CLUSTERS], series)
        first = first_happening(order, h, plan, state, series, happened)
        tau = min(h, first)
        error = np.inf
        for _again in range(MOST_HALVINGS):
            t_end = stop if tau == stop - t else t + tau
            g_end = ground_acceleration(family, coefficients, samples, t_end)
            look(tau, order, g_end, plan, state, series, seen)
            error = defect_error(tau, order, g_end, plan, state, series, seen)
            if error <= 1.0:
                break
            first = np.inf
            tau *= max(0.1, 0.9 * error ** (-1.0 / order)) if error < np.inf else 0.1
        ended = _audit(error, plan, state, seen)
        if ended != DONE:
            return ended
        if first <= tau and _still_pressed(tau, plan, happened, seen):
            first = np.inf
        inside_step(tau, order, plan, state, series, running)
        again = forces_inside_step(tau, order, plan, state, series, seen, running)
        if limits.ledger:
            add_work(tau, order, family, coefficients, samples, plan, state, series, seen)
            again = True
        if count[OUTPUT] < times.size and times[count[OUTPUT]] < t_end:
            sample_step(
                t, t_end, order, family, coefficients, samples, plan, state, series, seen, record
            )
            again = True
        if again:
            look_apart(tau, order, g_end, plan, state, series, seen)
        take_instant(t_end, plan, seen, running)
        _move(t_end, tau, state, seen)
        count[STEPS] += 1
        if first <= tau:
            _apply(tau, plan, state, series, happened, seen, record)
        else:
            clock[GUESS] = tau
            count[STALLED] = 0
            if count[IN_A_ROW] > 0 and clock[SINCE_IMPACT] > CASCADE_OVER * limits.time:
                end_cascade(state, record.events)
                count[IN_A_ROW] = 0
        if count[STALLED] > MOST_STALLS:
            return STUCK
        if t_end >= ground.ends[i]:
            count[DUE] = 1
    return GOING_ON


@compiled
def has_room(plan: Plan, state: State, record: Record) -> bool:
    """Whether the record can take what one more step may write, at the least."""
    rows = state.count[ROWS] + plan.output_times.size - state.count[OUTPUT] + 4
    events = state.count[EVENTS] + 3 * plan.contacts.gap.size + 4
    return rows <= record.rows.shape[0] and events <= record.events.shape[0]


@compiled_apart
def _settle_instant(
    plan: Plan,
    state: State,
    series: Series,
    happened: Happened,
    record: Record,
    seen: Seen,
    running: Running,
) -> int:
    """Do the duties of the present instant and write down what follows it."""
    count, ground = state.count, plan.ground
    t, order = state.clock[T], plan.limits.order
    while count[DUE] == 1 and ground.ends[count[PIECE]] <= t:
        count[PIECE] += 1
    i = count[PIECE]
    family = ground.family[i]
    coefficients = ground.coefficients[ground.first[i] : ground.first[i + 1]]
    samples = ground.samples[ground.first_sample[i] : ground.first_sample[i + 1]]
    g = ground_acceleration(family, coefficients, samples, t)
    if count[DUE] == 1:
        forcing = Forcing(family, coefficients, samples, t)
        if plan.links.kinked:
            look_apart(0.0, order, g, plan, state, series, seen)
            choose_branches(plan, state, series, seen.a, g)
        ended = settle(forcing, happened, plan, state, series, record)
        if ended != DONE:
            return ended
        count[DUE] = 0
        happened.released[:] = False
    look_apart(0.0, order, g, plan, state, series, seen)
    write_row(t, plan, seen, state, record)
    elongations(plan.links.ends, seen.u, seen.v, series.x, series.x_rate)
    update_settled(seen.u, series.x, seen.gap, plan.links.springs, t, running)
    take_instant(t, plan, seen, running)
    return DONE


@compiled
def _still_pressed(tau: float, plan: Plan, happened: Happened, seen: Seen) -> bool:
    """Whether truncation of the series released a contact too soon; the next step finds it."""
    limits = plan.limits
    if tau <= noise.RELEASED_AT * limits.time:
        return False
    weak = noise.FORCE * limits.mass * limits.length / limits.time**2
    for j in range(seen.gap.size):
        if happened.released[j] and seen.contact_force[j] > weak:
            return True
    return False


@compiled
def _audit(error: float, plan: Plan, state: State, seen: Seen) -> int:
    """Invariants after every step: its error, finite numbers, no penetration."""
    if not error <= 1.0:
        return NO_STEP
    for b in range(plan.mass.size):
        if not (abs(seen.u[b]) < np.inf and abs(seen.v[b]) < np.inf):
            return NOT_FINITE
    for j in range(seen.gap.size):
        if not seen.gap[j] >= -noise.PENETRATED * plan.limits.length:
            return PENETRATION
    return DONE


@compiled
def _move(t_end: float, tau: float, state: State, seen: Seen) -> None:
    """Make the end of the step the present state."""
    copy_numbers(seen.u, seen.u.size, state.u, 0)
    copy_numbers(seen.v, seen.v.size, state.v, 0)
    copy_numbers(seen.gap, seen.gap.size, state.gap, 0)
    copy_numbers(seen.gap_rate, seen.gap.size, state.gap_rate, 0)
    state.clock[T] = t_end
    state.clock[SINCE_IMPACT] += tau


@compiled
def _apply(
    tau: float,
    plan: Plan,
    state: State,
    series: Series,
    happened: Happened,
    seen: Seen,
    record: Record,
) -> None:
    """Do what happened at the end of a step; an event of contacts or kinks is settled next."""
    hysteresis = plan.hysteresis
    elongations(plan.links.ends, state.u, state.v, series.x, series.x_rate)
    for h in range(hysteresis.link.size):
        x = series.x[hysteresis.link[h]]
        if happened.turned[h]:
            reverse(h, x, hysteresis, state)
        elif happened.crossed[h]:
            cross_border(h, x, hysteresis, state)
    state.count[STALLED] = state.count[STALLED] + 1 if tau == 0.0 else 0
    due = False
    for j in range(state.gap.size):
        if happened.closing[j]:
            state.gap[j] = 0.0
        due = due or happened.closing[j] or happened.released[j]
    for a in range(state.branch.size):
        if happened.kinked[a]:
            state.branch[a] = -state.branch[a]
            due = True
    if due:
        mark_together(tau, plan, state, happened)
        state.clock[INTERVAL] = state.clock[SINCE_IMPACT]
        write_row(state.clock[T], plan, seen, state, record)
        state.count[DUE] = 1
