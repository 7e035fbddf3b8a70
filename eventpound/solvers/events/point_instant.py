"""What an instant demands of a scene with contacts at points between bodies.

The table at the head of `eventpound.solvers.events.modes` holds; the impact law and the
acceleration problem over dense columns of W are run by Python, so that scenes without such
contacts have nothing more to compile. An instant takes some milliseconds.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.descriptor import contact_rows
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import by_python, in_python
from eventpound.solvers.events.impacts import DONE, NO_FORCES, end_impacts
from eventpound.solvers.events.instant import (
    DUTIES,
    FIRST_BRANCHES,
    RESTS,
    lacks_branch,
    take_rests,
    touching_of,
    turn_at_kinks,
)
from eventpound.solvers.events.law_contacts import turn_elements
from eventpound.solvers.events.point_impacts import settle_closed_at_points
from eventpound.solvers.events.point_rests import rest_contacts_at_points
from eventpound.solvers.events.present import closed_of
from eventpound.solvers.events.run import PHASE, Piece, Run, opened
from eventpound.solvers.events.underway import Underway


def settle_points(now: Underway, piece: Piece) -> int:
    """Impacts of the present instant, and who rests after them; ends as `proceed` does.

    Parameters
    ----------
    now : Underway
        The run.
    piece : Piece
        The ground motion.
    """
    rows = contact_rows(now.model)
    with by_python():
        run = in_python(opened)(now.run)
        if run.state.count[PHASE] == DUTIES:
            ended = _do_duties(run, rows)
            if ended != DONE:
                return ended
        if in_python(lacks_branch)(run):
            return FIRST_BRANCHES
        in_python(turn_elements)(run)
        at_points = np.zeros(now.model.contacts, np.bool_)
        at_points[now.model.points] = True
        return _decide_rests(run, piece, rows, at_points)


def _do_duties(run: Run, rows: Floats) -> int:
    state, before = run.state, run.state.v.copy()
    ended = settle_closed_at_points(rows, in_python(closed_of)(run))
    # What presses the bodies that an impact has moved is another matter than before it.
    moved = np.abs(rows) @ (state.v != before) > 0.0
    run.happened.released[moved] = False
    if ended == DONE:
        end_impacts(state.clock, state.count)
        in_python(turn_at_kinks)(run)
        state.count[PHASE] = RESTS
    return ended


def _decide_rests(run: Run, piece: Piece, rows: Floats, at_points: Bools) -> int:
    state = run.state
    undecided = (state.gap == 0.0) & (state.gap_rate == 0.0)
    resting = pressed = undecided
    if undecided.any():
        touching = in_python(touching_of)(undecided, run, piece)
        resting, pressed, solved = rest_contacts_at_points(touching, rows, at_points)
        if not solved:
            state.resting[:] = resting
            return NO_FORCES
    in_python(take_rests)(resting, pressed, run)
    return DONE
