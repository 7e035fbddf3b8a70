"""The loop of the compiled stepper: settle what is due, go by samples or apart, or take a step."""

from __future__ import annotations

from eventpound.mechanics.impact import immovable
from eventpound.mechanics.reduced import Forcing
from eventpound.motion.base import Family
from eventpound.motion.forcing import ground_acceleration, ground_onset, next_corner
from eventpound.motion.loads import LOADED, place_supports
from eventpound.numerics.borrowing import copy_numbers
from eventpound.numerics.lending import lend
from eventpound.solvers.events.cascade import T
from eventpound.solvers.events.event_bounds import update_settled
from eventpound.solvers.events.impacts import DONE, FULL
from eventpound.solvers.fast.apart.steps import forget_each, go_apart, may_go_apart
from eventpound.solvers.fast.compiled import compiled_apart, compiled_whole
from eventpound.solvers.fast.evaluate import look_apart
from eventpound.solvers.fast.extremes import take_instant
from eventpound.solvers.fast.instant import choose_branches, settle, start
from eventpound.solvers.fast.links import elongations, gap_of
from eventpound.solvers.fast.record import has_room, hold, write_row
from eventpound.solvers.fast.run import DUE, GOING_ON, PIECE, STARTED, STEPS, Piece, Run, piece_of
from eventpound.solvers.fast.sampled.steps import may_go_by_samples, sample_steps
from eventpound.solvers.fast.step import take_step

_SAMPLES = int(Family.SAMPLES)


@compiled_apart
def advance(budget: int, run: Run) -> int:
    """Carry a run on by at most `budget` steps.

    Parameters
    ----------
    budget : int
        Most steps.
    run : Run
        See `eventpound.solvers.fast.run`.

    Returns
    -------
    int
        How it ended: FINISHED, GOING_ON, FULL (the record needs more room), or
        an error; the state says when and where.
    """
    return carry_on(budget, lend(run))


@compiled_whole
def carry_on(budget: int, run: Run) -> int:
    """`advance`, the run lent."""
    ground, clock, count, end = (
        run.plan.ground,
        run.state.clock,
        run.state.count,
        run.plan.limits.end,
    )
    last_step = count[STEPS] + budget
    if count[STARTED] == 0:
        start(run)
        forget_each(run.series.each)
        count[STARTED] = 1
    while count[STEPS] < last_step:
        if not has_room(run):
            return FULL
        if clock[T] >= end or count[DUE] == 1:
            ended = _settle_instant(run)
            if ended != DONE or clock[T] >= end:
                return ended
        i = count[PIECE]
        piece = lend(piece_of(i, ground))
        stop = min(ground.ends[i], end)
        if piece.family == _SAMPLES and may_go_by_samples(run):
            sample_steps(last_step - count[STEPS], stop, piece, run)
            if count[DUE] == 1 or count[STEPS] >= last_step or not has_room(run):
                continue
        if may_go_apart(piece, run):
            go_apart(last_step - count[STEPS], stop, piece, run)
            if clock[T] >= stop or count[STEPS] >= last_step or not has_room(run):
                if clock[T] >= ground.ends[i]:
                    count[DUE] = 1
                continue
        if piece.family >= _SAMPLES:
            stop = next_corner(piece, clock[T], stop)
        ended = take_step(stop, piece, run)
        if ended != DONE:
            return ended
        if clock[T] >= ground.ends[i]:
            count[DUE] = 1
    return GOING_ON


@compiled_apart
def _put_supports(piece: Piece, run: Run) -> None:
    """Put supports where they are as a piece of their motion begins, and with them what they carry.

    What rests on a support goes with it, and open gaps, which are variables of their own, follow:
    otherwise they part by the error of the support's motion. `seen` is overwritten.
    """
    state, series, before, mass = run.state, run.series, run.seen, run.plan.mass
    copy_numbers(state.u, before.u)
    copy_numbers(state.v, before.v)
    place_supports(piece.coefficients, state.u, state.v)
    s = 0
    while immovable(s, mass):
        for b in range(s + 1, mass.size):
            if series.of_body[b] == series.of_body[s] >= 0 and not immovable(b, mass):
                state.u[b] += state.u[s] - before.u[s]
                state.v[b] += state.v[s] - before.v[s]
        s += 1
    for j in range(state.gap.size):
        if state.gap[j] > 0.0 and not state.resting[j]:
            now, rate = gap_of(j, run.plan.contacts, state.u, state.v)
            then, rate_then = gap_of(j, run.plan.contacts, before.u, before.v)
            state.gap[j] = max(0.0, state.gap[j] + (now - then))
            state.gap_rate[j] += rate - rate_then


@compiled_apart
def _settle_instant(run: Run) -> int:
    """Do the duties of the present instant and write down what follows it."""
    plan, state, series, seen = run.plan, run.state, run.series, run.seen
    count, ground = state.count, plan.ground
    t, order = state.clock[T], plan.limits.order
    before = count[PIECE]
    while count[DUE] == 1 and ground.ends[count[PIECE]] <= t:
        count[PIECE] += 1
    piece = piece_of(count[PIECE], ground)
    if piece.family == LOADED and count[PIECE] > before and state.count[STEPS] > 0:
        _put_supports(piece, run)
    g = ground_acceleration(piece, t)
    if count[DUE] == 1:
        forcing = Forcing(piece.family, piece.coefficients, piece.samples, t)
        if plan.links.kinked:
            look_apart(0.0, order, g, run)
            onset = ground_onset(piece, t, order, series.ground)
            choose_branches(seen.a, g, onset, run)
        ended = settle(forcing, seen.z, run)
        if ended != DONE:
            return ended
        count[DUE] = 0
        hold(run)
        run.happened.released[:] = False
    look_apart(0.0, order, g, run)
    write_row(t, run)
    elongations(plan.links.ends, seen.u, seen.v, series.x, series.x_rate)
    update_settled(seen.u, series.x, seen.gap, plan.links.springs, t, run.running)
    take_instant(t, run)
    return DONE
