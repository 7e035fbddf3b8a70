"""Carries a run from an instant with duties to one without, mode after mode."""

from __future__ import annotations

import numpy as np

from eventpound.contact.cascade import endless_message, long_message
from eventpound.contact.impacts import DONE, ENDLESS, FULL, MEANING, NO_FORCES
from eventpound.contact.kinks import choose_branches, choose_clear_branches, lacks_branch
from eventpound.contact.points import decide_at_points, settle_at_points
from eventpound.contact.rest import ORDER
from eventpound.contact.sliders import decide_sticks, settle_beside_sliders
from eventpound.errors import ComputationError
from eventpound.mechanics.ground_frame import NO_FRAME
from eventpound.motion.forcing import CurrentPiece, ground_onset
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import by_python, in_python
from eventpound.solvers.events.dense import NO_GAPS, Dense
from eventpound.solvers.events.instant import (
    FIRST_BRANCHES,
    HISTORY,
    IMPACTS,
    IN_PYTHON,
    LAST,
    NEW_MODE,
    NOT_FINITE,
    OVER,
    PAUSED,
    READY,
    RESTS,
    SEARCH,
    SET_STATE,
    SETTLE,
    UNENDING,
    proceed,
)
from eventpound.solvers.events.law_contacts import switch_elements
from eventpound.solvers.events.modes import Mode
from eventpound.solvers.events.present import forcing_now
from eventpound.solvers.events.step_search import BROKEN, EVENT
from eventpound.solvers.events.underway import Underway

NOWHERE = Dense(np.zeros((1, 1)), 0.0, 0.0, 0.0, NO_FRAME, False, NO_GAPS)
"""No step."""
STEPS_AT_ONCE = 256
"""Short steps after which whoever waits is told."""


def settle_instant(now: Underway, piece: CurrentPiece) -> None:
    """Do the duties of the present instant and follow the motion until none is near.

    Parameters
    ----------
    now : Underway
        The run; `located` tells whose contact force has just reached zero.
    piece : CurrentPiece
        The ground motion; its end is not passed.

    Raises
    ------
    ComputationError
        Where an instant has no solution or cascades have no end.
    """
    progress = now.state.progress
    progress["reversals"][0] = progress["short_steps"][0] = 0
    progress["phase"][0] = IMPACTS
    most = now.steps
    ended = DONE
    while ended != OVER:
        ended = proceed(SETTLE, most, now.run, now.mode.dynamics, piece, NOWHERE)
        if ended == PAUSED:
            now.report_time(now.t)
            most = now.steps + now.steps_left(STEPS_AT_ONCE)
        elif ended == NEW_MODE:
            now.enter_mode()
        elif ended == IN_PYTHON:
            ended = _settle_in_python(now, piece)
        if ended == FULL:
            now.make_room()
        elif ended == FIRST_BRANCHES:
            _choose_branches(now, piece)
        elif ended not in (OVER, DONE, PAUSED, NEW_MODE):
            raise _failure(ended, now)


def _settle_in_python(now: Underway, piece: CurrentPiece) -> int:
    """What the present instant demands beside contacts at points or sliders; ends as `proceed`.

    No scene has both. This is what `eventpound.solvers.events.instant` does in its first two
    phases, by other rules.
    """
    run, model, slides = now.run, now.model, now.model.sliders.size > 0
    at, progress = run.instant, run.state.progress[0]
    with by_python():
        if progress.phase == IMPACTS:
            if slides:
                # The last observation is at the event.
                force = run.observations[2].contact_force[0]
                ended = settle_beside_sliders(force, run.located.kinked, at, model)
            else:
                ended = settle_at_points(at, model)
            if ended != DONE:
                return ended
            progress.phase = RESTS
        if in_python(lacks_branch)(at):
            return FIRST_BRANCHES
        in_python(switch_elements)(run.laws, at)
        z, forcing = run.state.z, forcing_now(piece, now.t)
        if slides:
            ended = decide_sticks(z, forcing, now.table.force_noise, at, model)
        else:
            ended = decide_at_points(z, forcing, at, model)
        if ended == DONE:
            progress.phase = HISTORY
        return ended


def _failure(ended: int, now: Underway) -> ComputationError:
    """What to raise where an instant cannot be settled."""
    if ended == BROKEN:
        return now.broken_contact(now.t)
    if ended == ENDLESS:
        return ComputationError(endless_message(now.events(), now.task.scene.contacts), now.t)
    if ended == NO_FORCES:
        names = ", ".join(repr(now.names[j]) for j in np.flatnonzero(now.state.resting))
        message = f"{MEANING[NO_FORCES]}: {names}"
        if now.model.supports:
            message += "; something between ground and supports has to give way where these meet"
        return ComputationError(message, now.t)
    if ended == UNENDING:
        return ComputationError(long_message(now.events(), now.task.scene.contacts), now.t)
    not_finite = "the motion after an event is not a number any more"
    return ComputationError(not_finite if ended == NOT_FINITE else MEANING[ended], now.t)


def _choose_branches(now: Underway, piece: CurrentPiece) -> None:
    """Branch of every kinked link from where it is and where it goes."""
    state, table = now.state, now.table
    resting = state.resting & (state.gap == 0.0)
    # What is pressed shut, or pulled by a spring, moves what only touches.
    in_python(choose_clear_branches)(now.run.instant)
    mode = table.mode(resting, state.branch, state.pressed, now.run.instant.opening)
    now.take_closing_speeds(mode)
    make_ready(now, mode, piece)
    now.state.progress["phase"][0] = RESTS
    observed = now.run.observations[0]
    onset = ground_onset(piece, now.t, ORDER, np.empty(ORDER))
    in_python(choose_branches)(observed.a, 0.0, onset, now.run.instant)
    state.now["stale"][0] = True


def make_ready(now: Underway, mode: Mode, piece: CurrentPiece) -> None:
    """Leave the present instant in `now.run` as a step in a mode begins with it."""
    proceed(READY, 0, now.run, mode.dynamics, piece, NOWHERE)


def set_present(now: Underway, piece: CurrentPiece, y: Floats, t: float) -> None:
    """Make a state vector of the present mode the present state, at the time t (s)."""
    now.run.y[: y.size] = y
    proceed(SET_STATE, 0, now.run, now.mode.dynamics, piece, NOWHERE._replace(end=t))


def put_last_instant(now: Underway, piece: CurrentPiece) -> None:
    """Put the last instant of a run into the history and the extremes."""
    proceed(LAST, 0, now.run, now.mode.dynamics, piece, NOWHERE)


def search_step(now: Underway, piece: CurrentPiece, dense: Dense) -> bool:
    """Look for events in a step of an integrator; whether there is one, now the present state.

    Raises
    ------
    ComputationError
        Where a contact penetrates or pulls.
    """
    found = proceed(SEARCH, 0, now.run, now.mode.dynamics, piece, dense)
    if found == BROKEN:
        raise now.broken_contact(now.t)
    return found == EVENT
