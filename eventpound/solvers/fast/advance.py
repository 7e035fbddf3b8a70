"""The loop of the compiled stepper: settle what is due, or take a step."""

from __future__ import annotations

from eventpound.contact.impacts import DONE, FULL
from eventpound.contact.kinks import (
    choose_branches,
    choose_clear_branches,
    lacks_branch,
    pass_kinks,
)
from eventpound.mechanics.followers import is_support
from eventpound.mechanics.monitored import update_settled
from eventpound.mechanics.reduced import Forcing
from eventpound.motion.base import Family
from eventpound.motion.forcing import CurrentPiece, ground_acceleration, ground_onset, next_corner
from eventpound.motion.loads import LOADED, support_motion
from eventpound.numerics.by_address import by_address
from eventpound.solvers.fast.compiled import compiled_deferred, compiled_noinline
from eventpound.solvers.fast.evaluate import observe_at_noinline
from eventpound.solvers.fast.extremes import distance_now, take_instant
from eventpound.solvers.fast.followed import follows, put_on_branches
from eventpound.solvers.fast.instant import instant_of, settle, start
from eventpound.solvers.fast.record import goes_with, has_room, save_record, write_row
from eventpound.solvers.fast.run import GOING_ON, SETTLED, FastRun, piece_of
from eventpound.solvers.fast.sliding import own_contacts
from eventpound.solvers.fast.step import take_step
from eventpound.tolerances import LENGTH

_SAMPLES = int(Family.SAMPLES)


@compiled_noinline
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
        How it ended: FINISHED, GOING_ON, FULL (the record needs more room), or an error; the state
        says when and where.
    """
    return carry_on(budget, by_address(run))


@compiled_deferred
def carry_on(budget: int, run: FastRun) -> int:
    """`advance`, the run by address."""
    ground, end = run.plan.ground, run.plan.limits.end
    now, progress = run.state.now[0], run.state.progress[0]
    last_step = progress.steps + budget
    if not progress.started:
        start(run)
        progress.started = True
    while progress.steps < last_step:
        if not has_room(run):
            return FULL
        if ground.family[progress.piece] == LOADED and progress.steps > 0:
            _put_supports(by_address(piece_of(progress.piece, ground)), run)
        if now.t >= end or progress.due != 0:
            ended = _settle_instant(run)
            if ended != DONE or now.t >= end:
                return ended
        i = progress.piece
        piece = by_address(piece_of(i, ground))
        stop = min(ground.ends[i], end)
        if piece.family >= _SAMPLES:
            stop = next_corner(piece, now.t, stop)
        ended = take_step(stop, piece, run)
        if ended != DONE:
            return ended
        if now.t >= ground.ends[i]:
            own, all_of_them = own_contacts(run), run.state.gap.size
            if own < all_of_them and progress.resting > 0 and progress.due == 0:
                # At a corner of the motion a stick may end: it has two sides.
                write_row(now.t, run)
            progress.due = 1
    return GOING_ON


@compiled_noinline
def _put_supports(piece: CurrentPiece, run: FastRun) -> None:
    """Put supports where they are now, and with them what they carry.

    A step leaves them where its series end, off by a part of the tolerance. What rests on a
    support goes with it, and open gaps, which are variables of their own, follow. Rounding is left
    alone, as a gap may be smaller, but for velocities: they tell whether a slip ends.
    """
    state, mass, limits, contacts = run.state, run.plan.mass, run.plan.limits, run.plan.contacts
    state.progress[0].known = False
    for s in range(mass.size):
        if not is_support(s, mass):
            continue
        # The load of a support has its number, from 1.
        u, v = support_motion(s + 1, piece, state.now[0].t)
        du, dv, time = u - state.u[s], v - state.v[s], limits.time
        size = limits.length + abs(u) + abs(v) * time
        strays = max(abs(du), abs(dv) * time) > LENGTH * size
        for b in range(mass.size):
            part = goes_with(b, s, run)
            if part != 0.0:
                state.v[b] += part * dv
                state.u[b] += part * du if strays else 0.0
        for j in range(state.gap.size):
            if strays and state.gap[j] > 0.0 and not state.resting[j]:
                side = goes_with(contacts.right[j], s, run) - goes_with(contacts.left[j], s, run)
                state.gap[j] = max(0.0, state.gap[j] + side * du)
                state.gap_rate[j] += side * dv


@compiled_deferred.but(ahead=True)
def _settle_instant(run: FastRun) -> int:
    """Do the duties of the present instant and write down what follows it."""
    plan, state, series, observed = run.plan, run.state, run.series, run.observed
    ground, progress = plan.ground, state.progress[0]
    t, order, progress.known = state.now[0].t, plan.limits.order, False
    # At a border of pieces the motion from now on counts.
    while progress.due == 1 and ground.ends[progress.piece] <= t:
        progress.piece += 1
    piece = by_address(piece_of(progress.piece, ground))
    g = ground_acceleration(piece, t)
    if progress.due == 1:
        forcing = by_address(Forcing(piece.family, piece.coefficients, piece.samples, t))
        at = by_address(instant_of(run))
        pass_kinks(run.located.kinked, observed.z, at)
        if lacks_branch(at):
            # Those that are clear come first: the others ask for accelerations, which these change.
            choose_clear_branches(at)
            if follows(run):
                put_on_branches(run)
            observe_at_noinline(0.0, order, g, run)
            onset = ground_onset(piece, t, order, series.ground)
            choose_branches(observed.a, g, onset, at)
        ended = settle(forcing, observed.z, at, run)
        if ended != DONE:
            return ended
        progress.due = SETTLED
    if progress.due == SETTLED:
        progress.due = 0
        save_record(run)
        run.located.released[:] = False
    observe_at_noinline(0.0, order, g, run)
    write_row(t, run)
    for k in range(plan.distances.first.size):
        there = distance_now(k, observed.u, observed.gap, plan.distances)
        update_settled(run.running.at.gap + k, there, t, run.running)
    take_instant(t, run)
    return DONE
