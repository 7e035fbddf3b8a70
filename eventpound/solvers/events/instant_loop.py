"""Carries a run from an instant with duties to one without, mode after mode."""

from __future__ import annotations

import numpy as np

from eventpound.contact.cascade import endless_message, long_message
from eventpound.contact.impacts import DONE, ENDLESS, FULL, MEANING, NO_FORCES
from eventpound.contact.instant import no_forces_message
from eventpound.contact.kinks import choose_branches, choose_clear_branches
from eventpound.contact.rest import ORDER
from eventpound.contact.rubbing import FRICTION_MEANING, Rubs, friction_message
from eventpound.errors import ComputationError
from eventpound.mechanics.ground_frame import NO_FRAME
from eventpound.motion.forcing import CurrentPiece, ground_onset
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import by_python
from eventpound.solvers.events.dense import NO_GAPS, Dense
from eventpound.solvers.events.event_run import EventRun
from eventpound.solvers.events.instant import (
    FIRST_BRANCHES,
    IMPACTS,
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
from eventpound.solvers.events.modes import Mode
from eventpound.solvers.events.step_search import BROKEN, EVENT

NOWHERE = Dense(np.zeros((1, 1)), 0.0, 0.0, 0.0, NO_FRAME, False, NO_GAPS)
"""No step."""
STEPS_AT_ONCE = 256
"""Short steps after which whoever waits is told."""


def settle_instant(run: EventRun, piece: CurrentPiece) -> None:
    """Do the duties of the present instant and follow the motion until none is near.

    Parameters
    ----------
    run : EventRun
        The run; `located` tells whose contact force has just reached zero.
    piece : CurrentPiece
        The ground motion; its end is not passed.

    Raises
    ------
    ComputationError
        Where an instant has no solution or cascades have no end.
    """
    progress = run.state.progress
    progress["reversals"][0] = progress["short_steps"][0] = 0
    progress["phase"][0] = IMPACTS
    most = run.steps
    ended = DONE
    while ended != OVER:
        ended = proceed(SETTLE, most, run.arrays, run.mode.dynamics, piece, NOWHERE)
        if ended == PAUSED:
            run.report_time(run.t)
            most = run.steps + run.steps_left(STEPS_AT_ONCE)
        elif ended == NEW_MODE:
            run.enter_mode()
        elif ended == FULL:
            run.make_room()
        elif ended == FIRST_BRANCHES:
            _choose_branches(run, piece)
        elif ended != OVER:
            raise _failure(ended, run)


def _failure(ended: int, run: EventRun) -> ComputationError:
    """What to raise where an instant cannot be settled."""
    if ended == BROKEN:
        return run.broken_contact(run.t)
    if ended == ENDLESS:
        return ComputationError(endless_message(run.events(), run.task.scene.contacts), run.t)
    if run.model.rubbing.size > 0 and ended in FRICTION_MEANING:
        rubs = Rubs(run.model.rubbing, run.model.friction, run.table.rubbed)
        gaps = run.state.gap, run.state.gap_rate, run.state.resting
        return ComputationError(friction_message(ended, run.names, rubs, *gaps), run.t)
    if ended == NO_FORCES:
        message = no_forces_message(run.state.resting, run.names, run.model.supports)
        return ComputationError(message, run.t)
    if ended == UNENDING:
        return ComputationError(long_message(run.events(), run.task.scene.contacts), run.t)
    not_finite = "the motion after an event is not a number any more"
    return ComputationError(not_finite if ended == NOT_FINITE else MEANING[ended], run.t)


def _choose_branches(run: EventRun, piece: CurrentPiece) -> None:
    """Branch of every kinked link from where it is and where it goes."""
    state, table = run.state, run.table
    resting = state.resting & (state.gap == 0.0)
    # What is pressed shut, or pulled by a spring, moves what only touches.
    with by_python():
        choose_clear_branches(run.arrays.instant)
    mode = table.mode(resting, state.branch, state.pressed, run.arrays.instant.opening)
    run.take_closing_speeds(mode)
    make_ready(run, mode, piece)
    run.state.progress["phase"][0] = RESTS
    observed = run.arrays.observations[0]
    with by_python():
        onset = ground_onset(piece, run.t, ORDER, np.empty(ORDER))
        choose_branches(observed.a, 0.0, onset, run.arrays.instant)
    state.now["stale"][0] = True


def make_ready(run: EventRun, mode: Mode, piece: CurrentPiece) -> None:
    """Leave the present instant in `run.arrays` as a step in a mode begins with it."""
    proceed(READY, 0, run.arrays, mode.dynamics, piece, NOWHERE)


def set_present(run: EventRun, piece: CurrentPiece, y: Floats, t: float) -> None:
    """Make a state vector of the present mode the present state, at the time t (s)."""
    run.arrays.y[: y.size] = y
    proceed(SET_STATE, 0, run.arrays, run.mode.dynamics, piece, NOWHERE._replace(end=t))


def put_present_instant(run: EventRun, piece: CurrentPiece) -> None:
    """Put the present instant, the end of a piece or of the run, into history and extremes."""
    proceed(LAST, 0, run.arrays, run.mode.dynamics, piece, NOWHERE)


def search_step(run: EventRun, piece: CurrentPiece, dense: Dense) -> bool:
    """Look for events in a step of an integrator; whether there is one, now the present state.

    Raises
    ------
    ComputationError
        Where a contact penetrates or pulls.
    """
    found = proceed(SEARCH, 0, run.arrays, run.mode.dynamics, piece, dense)
    if found == BROKEN:
        raise run.broken_contact(run.t)
    return found == EVENT
