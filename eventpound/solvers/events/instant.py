"""What an instant demands, and the short steps that follow it, until nothing is near.

Impacts, the acceleration problem, the mode that follows
(`eventpound.contact.modes` tabulates them), then steps on the local
series: cascades whose intervals are too short for an integrator (accumulating
bounces, a light body caught between heavy ones, a chain of plastic contacts)
are followed impact by impact until `eventpound.contact.cascade` calls them over.
"""

from __future__ import annotations

import numpy as np

from eventpound.contact.cascade import LONGEST_CASCADE, is_fleeting
from eventpound.contact.event_rows import end_cascade, events_wanted
from eventpound.contact.friction import begin_beside_friction, decide_friction, settle_with_friction
from eventpound.contact.impacts import DONE, FULL
from eventpound.contact.instant import any_may_rest, decide_rests, settle_impacts
from eventpound.contact.kinks import lacks_branch, pass_kinks
from eventpound.contact.rubbing import Rubs
from eventpound.contact.sliders import begin_beside_sliders, decide_sticks
from eventpound.mechanics.series import evaluate_series
from eventpound.motion.forcing import CurrentPiece, longest_safe_step, next_corner
from eventpound.numerics.borrowing import borrow
from eventpound.numerics.by_address import by_address
from eventpound.numerics.compiled import deferred_kernel, kernel
from eventpound.solvers.events.dense import Dense
from eventpound.solvers.events.law_contacts import switch_elements
from eventpound.solvers.events.location import any_located, clear_located
from eventpound.solvers.events.present import (
    forcing_now,
    make_ready,
    put_instant,
    put_present,
    restore_record,
    save_record,
    set_state,
)
from eventpound.solvers.events.recorder import PASSED, WRITTEN
from eventpound.solvers.events.run import Dynamics, Run
from eventpound.solvers.events.short_series import local_series
from eventpound.solvers.events.step_search import (
    BROKEN,
    BROKEN_BEFORE,
    NO_EVENT,
    search_step,
    search_to_event,
)

MOST_REVERSALS = 3
"""Reversals of links after which short steps end although no event is in sight."""
IMPACTS, RESTS, HISTORY, SHORT_STEP = range(4)
"""Where an instant goes on: impacts; who rests; the instant into the history; a short step."""
SETTLE, SEARCH, SET_STATE, READY, LAST = range(5)
"""What `proceed` is asked for: all that an instant demands; to search a step of an
integrator; to make the state vector of the run the present state; to make the present instant
ready for a step; to put it, the last of a piece, into the history."""
OVER, NEW_MODE, PAUSED, FIRST_BRANCHES = range(20, 24)
"""How `proceed` returns beside the ends of impacts: nothing is near; the mode is another;
steps are used up; links have no branch yet."""
NOT_FINITE, UNENDING = 30, 32
"""How it fails, beside BROKEN: no numbers; more than `LONGEST_CASCADE` steps."""


@deferred_kernel.but(ahead=True)
def short_step(arrays: Run, mode: Dynamics, piece: CurrentPiece) -> int:
    """A step on the local series to what happens, perhaps nothing; DONE, OVER or how it fails."""
    rules, state, record, located = arrays.rules, arrays.state, arrays.record, arrays.located
    now, progress = state.now[0], state.progress[0]
    t = now.t
    # Neither over a corner of the motion nor over a pulse that is still to come.
    stop = min(next_corner(piece, t, piece.stop), t + longest_safe_step(piece, t))
    forcing = by_address(forcing_now(piece, t))
    series = local_series(arrays, forcing, mode, stop - t)
    if not series.finite:
        return NOT_FINITE
    # The arrays of `series` are kept alive by its use at the end.
    tau = search_step(arrays, mode, piece, series.dense)
    if tau == BROKEN_BEFORE:
        return BROKEN
    if tau == NO_EVENT:
        tau = series.dense.end
        clear_located(located)
        for j in range(series.closing.size):
            located.closing[j] = series.closing[j]
    any_event, observed = any_located(located), arrays.observations[2]
    fleeting = any_event and is_fleeting(tau, now, rules.time)
    # Where a mode is none no time passes either, and nothing recorded since is of one.
    end = t if fleeting else t + tau
    if fleeting:
        restore_record(record)
    elif any_event:
        put_instant(end, observed, record)
    since = now.since_impact
    set_state(evaluate_series(series.dense.Y, tau)[0], end, mode, forcing, state)
    pass_kinks(located.kinked, state.z, arrays.instant)
    # The differences of times are none where intervals are short.
    now.since_impact = since + tau
    for j in range(state.gap.size):
        if state.gap[j] == np.inf:
            continue
        closes = located.closing[j]
        state.gap[j], state.gap_rate[j] = 0.0 if closes else observed.gap[0, j], observed.gap[1, j]
    progress.reversals = 0 if any_event else progress.reversals + series.reverses
    progress.steps += 1
    progress.short_steps += 1
    progress.phase = IMPACTS if any_event else SHORT_STEP
    again = series.reverses and progress.reversals <= MOST_REVERSALS
    return DONE if any_event or mode.system.mass.size == 0 or again else OVER


@kernel
def proceed(
    wanted: int, most: int, arrays: Run, mode: Dynamics, piece: CurrentPiece, dense: Dense
) -> int:
    """Do what is wanted, of SETTLE to LAST, at the present instant.

    All that Python asks for is one function, since most of it shares most of its parts and each
    that Python calls is compiled with all of its own.

    Parameters
    ----------
    wanted : int
        Which of them.
    most : int
        Steps of the run after which SETTLE pauses.
    arrays : Run
        The run; SETTLE goes on where the `phase` of its progress says.
    mode : Dynamics
        The present mode.
    piece : CurrentPiece
        The ground motion.
    dense : Dense
        The step to SEARCH; its end is the time of SET_STATE.

    Returns
    -------
    int
        OVER, where the run is made ready for an integrator, or another of the ends above.
    """
    if wanted == SETTLE:
        return _settle(most, arrays, mode, piece)
    if wanted == SEARCH:
        return search_to_event(arrays, mode, piece, dense)
    if wanted == SET_STATE:
        t = dense.end
        set_state(
            arrays.y[: mode.system.size], t, mode, by_address(forcing_now(piece, t)), arrays.state
        )
        return OVER
    make_ready(arrays, mode, piece)
    if wanted == LAST:
        put_present(arrays, False)
    return OVER


@kernel
def _settle(most: int, arrays: Run, mode: Dynamics, piece: CurrentPiece) -> int:
    """Follow the motion from the present instant until nothing is near; ends as `proceed`."""
    state, at = arrays.state, arrays.instant
    now, progress, sliders = state.now[0], state.progress[0], mode.bodies.sliders
    rubbing = mode.bodies.rubbing.size
    ended = DONE
    while ended == DONE:
        if not _has_room(arrays):
            return FULL
        if progress.phase == IMPACTS:
            # The last observation is at the event.
            force = arrays.observations[2].contact_force[0]
            if sliders.size > 0:
                begin_beside_sliders(force, arrays.located.kinked, sliders, at)
            if rubbing > 0:
                rubs = _rubs(mode)
                begin_beside_friction(force, arrays.located.kinked, rubs, at)
                ended = settle_with_friction(rubs, at)
            else:
                ended = settle_impacts(at)
            if ended != DONE:
                return ended
            progress.phase = RESTS
        if progress.phase == RESTS:
            # Only at the start of a run: first branches need accelerations, and these a mode.
            if lacks_branch(at):
                return FIRST_BRANCHES
            if arrays.laws.contact.size > 0:
                switch_elements(arrays.laws, at)
            if sliders.size > 0 or any_may_rest(at):
                ended = _decide(arrays, mode, piece)
                if ended != DONE:
                    return ended
            progress.phase = HISTORY
        if progress.phase == HISTORY:
            if now.stale:
                return NEW_MODE
            if is_fleeting(0.0, now, arrays.rules.time):
                save_record(arrays.record)
            make_ready(arrays, mode, piece)
            put_present(arrays, True)
            progress.phase = SHORT_STEP
        if now.t >= piece.stop:
            ended = OVER
        elif progress.steps >= most:
            return PAUSED
        elif progress.short_steps >= LONGEST_CASCADE:
            return UNENDING
        else:
            ended = short_step(arrays, mode, piece)
            if progress.phase == SHORT_STEP:
                make_ready(arrays, mode, piece)
    if ended == OVER:
        end_cascade(state.resting, now, arrays.record.events)
    return ended


@kernel
def _rubs(mode: Dynamics) -> Rubs:
    """The contacts with friction."""
    bodies = mode.bodies
    return Rubs(borrow(bodies.rubbing), borrow(bodies.friction), borrow(bodies.rubbed))


@kernel
def _decide(arrays: Run, mode: Dynamics, piece: CurrentPiece) -> int:
    """Who rests, or sticks, after the impacts of an instant; ends as `decide_rests`."""
    z, at, sliders = arrays.state.z, arrays.instant, mode.bodies.sliders
    forcing = by_address(forcing_now(piece, arrays.state.now[0].t))
    if sliders.size > 0:
        return decide_sticks(z, forcing, mode.guards.force_noise, sliders, at)
    if mode.bodies.rubbing.size > 0:
        return decide_friction(z, forcing, mode.guards.force_noise, _rubs(mode), at)
    return decide_rests(z, forcing, at)


@kernel
def _has_room(arrays: Run) -> bool:
    """Whether the record can take what an instant and a step may write, at the least."""
    journal, events = arrays.record.journal, arrays.record.events
    rows = journal.cursor[WRITTEN] + journal.times.size - journal.cursor[PASSED] + 4
    wanted = events_wanted(arrays.state.gap.size, arrays.state.now[0])
    return rows <= journal.rows.shape[0] and wanted <= events.shape[0]
