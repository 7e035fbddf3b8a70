"""The loop of the compiled stepper: settle what is due, go by samples or apart, or take a step."""

from __future__ import annotations

from eventpound.contact.cascade import T
from eventpound.contact.impacts import DONE, FULL
from eventpound.contact.kinks import (
    choose_branches,
    choose_clear_branches,
    lacks_branch,
    pass_kinks,
)
from eventpound.mechanics.clusters import is_support
from eventpound.mechanics.monitored import update_settled
from eventpound.mechanics.reduced import Forcing
from eventpound.motion.base import Family
from eventpound.motion.forcing import CurrentPiece, ground_acceleration, ground_onset, next_corner
from eventpound.motion.loads import LOADED, support_motion
from eventpound.numerics.lending import lend
from eventpound.solvers.fast.apart.steps import forget_each, go_apart, may_go_apart
from eventpound.solvers.fast.compiled import compiled, compiled_apart, compiled_whole
from eventpound.solvers.fast.evaluate import look_apart
from eventpound.solvers.fast.extremes import take_instant
from eventpound.solvers.fast.followed import follows, put_on_branches
from eventpound.solvers.fast.instant import instant_of, settle, start
from eventpound.solvers.fast.links import elongations
from eventpound.solvers.fast.record import has_room, hold, write_row
from eventpound.solvers.fast.run import (
    DUE,
    GOING_ON,
    IN_PYTHON,
    PIECE,
    SETTLED,
    STARTED,
    STEPS,
    FastRun,
    piece_of,
)
from eventpound.solvers.fast.sampled.steps import may_go_by_samples, sample_steps
from eventpound.solvers.fast.sliding import any_slider
from eventpound.solvers.fast.step import take_step
from eventpound.tolerances import LENGTH

_SAMPLES = int(Family.SAMPLES)


@compiled_apart
def advance(budget: int, run: FastRun) -> int:
    """Carry a run on by at most `budget` steps.

    Parameters
    ----------
    budget : int
        Most steps.
    run : FastRun
        See `eventpound.solvers.fast.run`.

    Returns
    -------
    int
        How it ended: FINISHED, GOING_ON, FULL (the record needs more room), IN_PYTHON (an instant
        is to be settled by `settle_sliders`), or an error; the state says when and where.
    """
    return carry_on(budget, lend(run))


@compiled_whole
def carry_on(budget: int, run: FastRun) -> int:
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
        if ground.family[count[PIECE]] == LOADED and count[STEPS] > 0:
            _put_supports(lend(piece_of(count[PIECE], ground)), run)
        if clock[T] >= end or count[DUE] != 0:
            ended = _settle_instant(run)
            if ended != DONE or clock[T] >= end:
                return ended
        i = count[PIECE]
        piece = lend(piece_of(i, ground))
        stop = min(ground.ends[i], end)
        if may_go_apart(piece, run):
            go_apart(last_step - count[STEPS], stop, piece, run)
        elif piece.family == _SAMPLES and may_go_by_samples(run):
            sample_steps(last_step - count[STEPS], stop, piece, run)
        if clock[T] >= ground.ends[i]:
            count[DUE] = 1
        due = count[DUE] == 1 or clock[T] >= stop
        if due or count[STEPS] >= last_step or not has_room(run):
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
def _put_supports(piece: CurrentPiece, run: FastRun) -> None:
    """Put supports where they are now, and with them what they carry.

    A step leaves them where its series end, off by a part of the tolerance. What rests on a
    support goes with it, and open gaps, which are variables of their own, follow. Rounding is left
    alone: a gap may be smaller.
    """
    state, mass, limits, contacts = run.state, run.plan.mass, run.plan.limits, run.plan.contacts
    for s in range(mass.size):
        if not is_support(s, mass):
            continue
        # The load of a support has its number, from 1.
        u, v = support_motion(s + 1, piece, state.clock[T])
        du, dv, time = u - state.u[s], v - state.v[s], limits.time
        size = limits.length + abs(u) + abs(v) * time
        if max(abs(du), abs(dv) * time) <= LENGTH * size:
            continue
        for b in range(mass.size):
            if _goes_with(b, s, run):
                state.u[b], state.v[b] = state.u[b] + du, state.v[b] + dv
        for j in range(state.gap.size):
            if state.gap[j] > 0.0 and not state.resting[j]:
                side = 1.0 if _goes_with(contacts.right[j], s, run) else 0.0
                side -= 1.0 if _goes_with(contacts.left[j], s, run) else 0.0
                state.gap[j] = max(0.0, state.gap[j] + side * du)
                state.gap_rate[j] += side * dv


@compiled
def _goes_with(b: int, s: int, run: FastRun) -> bool:
    """Whether a body, -1 for none, is a support s or rests on it."""
    of_body = run.series.of_body
    return b == s or (b >= 0 and of_body[b] == of_body[s] >= 0 and not is_support(b, run.plan.mass))


@compiled_apart
def _settle_instant(run: FastRun) -> int:
    """Do the duties of the present instant and write down what follows it."""
    plan, state, series, seen = run.plan, run.state, run.series, run.seen
    count, ground = state.count, plan.ground
    t, order = state.clock[T], plan.limits.order
    while count[DUE] == 1 and ground.ends[count[PIECE]] <= t:
        count[PIECE] += 1
    piece = lend(piece_of(count[PIECE], ground))
    g = ground_acceleration(piece, t)
    if count[DUE] == 1:
        forcing = lend(Forcing(piece.family, piece.coefficients, piece.samples, t))
        at = lend(instant_of(run))
        pass_kinks(run.happened.kinked, seen.z, at)
        if lacks_branch(at):
            choose_clear_branches(at)
            if follows(run):
                put_on_branches(run)
            look_apart(0.0, order, g, run)
            onset = ground_onset(piece, t, order, series.ground)
            choose_branches(seen.a, g, onset, at)
        if any_slider(run):
            return IN_PYTHON
        run.happened.kinked[:] = False
        ended = settle(forcing, seen.z, at, run)
        if ended != DONE:
            return ended
        count[DUE] = SETTLED
    if count[DUE] == SETTLED:
        count[DUE] = 0
        hold(run)
        run.happened.released[:] = False
    look_apart(0.0, order, g, run)
    write_row(t, run)
    elongations(plan.links.ends, seen.u, seen.v, series.x, series.x_rate)
    update_settled(seen.u, series.x, seen.gap, t, run.running)
    take_instant(t, run)
    return DONE
