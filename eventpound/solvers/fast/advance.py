"""The loop of the compiled stepper: settle what is due, go by samples, or take a step."""

from __future__ import annotations

from eventpound.mechanics.reduced import Forcing
from eventpound.motion.base import Family
from eventpound.motion.forcing import ground_acceleration, ground_onset, next_sample
from eventpound.solvers.events.cascade import T
from eventpound.solvers.events.impacts import DONE, FULL
from eventpound.solvers.events.inspection import Running, update_settled
from eventpound.solvers.fast.compiled import compiled_apart, compiled_whole
from eventpound.solvers.fast.elongation import elongations
from eventpound.solvers.fast.extremes import take_instant
from eventpound.solvers.fast.fleeting import hold
from eventpound.solvers.fast.history import has_room, write_row
from eventpound.solvers.fast.instant import choose_branches, settle
from eventpound.solvers.fast.outcome import GOING_ON
from eventpound.solvers.fast.plan import DUE, PIECE, STEPS, Happened, Plan, Record, Series, State
from eventpound.solvers.fast.sample_steps import may_go_by_samples, sample_steps
from eventpound.solvers.fast.seen import Seen, look_apart
from eventpound.solvers.fast.step import take_step

_ZERO, _SAMPLES = int(Family.ZERO), int(Family.SAMPLES)


@compiled_whole
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
    ground, clock, count, end = plan.ground, state.clock, state.count, plan.limits.end
    table = record.extremes
    running = Running(table[0], table[1], table[2], table[3], table[4])
    last_step = count[STEPS] + budget
    while count[STEPS] < last_step:
        if not has_room(plan, state, record):
            return FULL
        if clock[T] >= end or count[DUE] == 1:
            ended = _settle_instant(plan, state, series, happened, record, seen, running)
            if ended != DONE or clock[T] >= end:
                return ended
        i = count[PIECE]
        family = ground.family[i]
        coefficients = ground.coefficients[ground.first[i] : ground.first[i + 1]]
        samples = ground.samples[ground.first_sample[i] : ground.first_sample[i + 1]]
        stop = min(ground.ends[i], end)
        if family in (_SAMPLES, _ZERO) and may_go_by_samples(plan, state, series):
            sample_steps(
                last_step - count[STEPS], stop, family, coefficients, samples,
                plan, state, series, seen, record, running,
            )  # fmt: skip
            if count[DUE] == 1 or count[STEPS] >= last_step or not has_room(plan, state, record):
                continue
        if family == _SAMPLES:
            stop = next_sample(coefficients, clock[T], stop)
        ended = take_step(
            stop, family, coefficients, samples,
            plan, state, series, happened, seen, record, running,
        )  # fmt: skip
        if ended != DONE:
            return ended
        if clock[T] >= ground.ends[i]:
            count[DUE] = 1
    return GOING_ON


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
            onset = ground_onset(family, coefficients, samples, t, order, series.ground)
            choose_branches(plan, state, series, seen.a, g, onset)
        ended = settle(forcing, happened, plan, state, series, record, seen.z)
        if ended != DONE:
            return ended
        count[DUE] = 0
        hold(plan, state, series, record)
        happened.released[:] = False
    look_apart(0.0, order, g, plan, state, series, seen)
    write_row(t, plan, seen, state, record)
    elongations(plan.links.ends, seen.u, seen.v, series.x, series.x_rate)
    update_settled(seen.u, series.x, seen.gap, plan.links.springs, t, running)
    take_instant(t, plan, seen, running)
    return DONE
