"""The search of a step: its first event, its turning points, its rows of the history.

Steps of an integrator that were marked, and short steps, are gone through on their dense output.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.monitored import update_extremes
from eventpound.mechanics.observables import Observed
from eventpound.motion.base import Family
from eventpound.motion.forcing import CurrentPiece, next_corner
from eventpound.numerics.by_address import by_address
from eventpound.numerics.compiled import deferred_kernel, kernel
from eventpound.solvers.events.dense import Dense, DenseStep, observe_at, state_at
from eventpound.solvers.events.event_bounds import inspect_step
from eventpound.solvers.events.law_contacts import add_shares
from eventpound.solvers.events.location import add_vanished, first_event, update_peaks
from eventpound.solvers.events.present import close_located, forcing_now, put_instant, set_state
from eventpound.solvers.events.recorder import is_due, write_samples
from eventpound.solvers.events.run import Dynamics, Run
from eventpound.solvers.events.step_check import broken_contact

CLEAR, EVENT = 40, 41
"""What a search finds: nothing, or an event."""
BROKEN = 31
"""How it fails: a contact penetrates or pulls."""
(OURSELVES, INTEGRATOR, FOUND_AT_END) = range(3)
"""Who finds events in a step of an integrator; it has found one at the end of its last."""
_SAMPLES = int(Family.SAMPLES)
"""This and what follows it in `Family` have samples at which the motion has corners."""


@kernel
def _observed_at(step: DenseStep, tau: float) -> Observed:
    observe_at(tau, step)
    return step.observed


@kernel
def search_between(h: float, arrays: Run, mode: Dynamics, step: DenseStep) -> tuple[float, bool]:
    """Search a step for events between the first two observations of a run, h (s) apart.

    The end of the local series tells itself which gaps close there.

    Returns
    -------
    tau : float
        When the first is (s, local), as `located` of the run tells; or inf.
    marked : bool
        Whether anything was marked.
    """
    marks, watched, (before, after, _) = arrays.marks, mode.watched, arrays.observations
    if not inspect_step(before, after, h, watched, arrays.record.running, marks):
        return np.inf, False
    if not step.dense.own and arrays.state.progress[0].finder != OURSELVES:
        # Events are found by the library: only turning points are left to look for.
        return np.inf, True
    if step.dense.own:
        for j in range(marks.closing.size):
            marks.closing[j] = False
    return first_event(marks, watched, arrays.rules, arrays.located, step), True


@kernel
def record_inside(end: float, marked: bool, arrays: Run, step: DenseStep) -> None:
    """Take the turning points of a step up to `end` (s), where marked, and what is due there."""
    record, origin = arrays.record, step.forcing.start
    if marked:
        update_peaks(arrays.marks.peak, end, arrays.rules.near, record.running, step)
    if is_due(origin + end, record.journal):
        write_samples(_observed_at, step, origin, step.dense.start, end, record.journal)


@deferred_kernel.but(ahead=True)
def search_step(arrays: Run, mode: Dynamics, piece: CurrentPiece, dense: Dense) -> int:
    """Search a step of an integrator that was marked for events, from sample to sample.

    The step is recorded up to the first of them, whose state becomes the present one.

    Parameters
    ----------
    arrays, mode, piece : Run, Dynamics, CurrentPiece
        The run, at the start of the segment.
    dense : Dense
        The step, in times from there.

    Returns
    -------
    int
        CLEAR, EVENT or BROKEN; of a broken contact the last of `run.observations` tells.
    """
    rules, state, record = arrays.rules, arrays.state, arrays.record
    origin = state.now[0].t
    forcing = by_address(forcing_now(piece, origin))
    observations, watched = arrays.observations, mode.watched
    low, high = dense.start, dense.start
    while high < dense.end:
        low, high = high, dense.end
        if piece.family >= _SAMPLES:
            following = next_corner(piece, origin + low, origin + high)
            high = high if following >= origin + high else following - origin
        part = Dense(dense.Y, dense.center, low, high, dense.frame, dense.own, dense.gaps)
        observe_at(low, by_address(DenseStep(part, mode, forcing, observations[0])))
        observe_at(high, by_address(DenseStep(part, mode, forcing, observations[1])))
        step = by_address(DenseStep(part, mode, forcing, observations[2]))
        tau, marked = search_between(high - low, arrays, mode, step)
        # The integrator stands on its root: `located` has it, and what vanishes with it is added.
        if high == dense.end and state.progress[0].finder == FOUND_AT_END:
            tau = high
            observe_at(tau, step)
            add_vanished(step.observed, watched, rules, arrays.located)
        end = min(high, tau)
        record_inside(end, marked, arrays, step)
        if arrays.laws.contact.size > 0:
            add_shares(end, arrays, step)
        if tau < np.inf:
            observe_at(tau, step)
            put_instant(origin + tau, step.observed, record)
            set_state(state_at(tau, step), origin + tau, mode, forcing, state)
            close_located(arrays)
            return EVENT
        # Beyond an event there is another mode, in which none of these need hold.
        after = observations[1]
        if broken_contact(after, watched, rules.length_noise) >= 0:
            observe_at(high, step)
            state.now[0].t = origin + end
            return BROKEN
        update_extremes(after, origin + end, record.running)
    return CLEAR
