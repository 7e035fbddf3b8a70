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
NO_EVENT, BROKEN_BEFORE = np.inf, -np.inf
"""Times where there is none, and where a contact is broken before any."""
(OURSELVES, INTEGRATOR, FOUND_AT_END) = range(3)
"""Who finds events in a step of an integrator; it has found one at the end of its last."""
_SAMPLES = int(Family.SAMPLES)
"""This and what follows it in `Family` have samples at which the motion has corners."""


@kernel
def _observed_at(step: DenseStep, tau: float) -> Observed:
    observe_at(tau, step)
    return step.observed


@deferred_kernel
def search_step(arrays: Run, mode: Dynamics, piece: CurrentPiece, dense: Dense) -> float:
    """Search a step for its first event, from sample to sample, and record it up to there.

    Parameters
    ----------
    arrays, mode, piece : Run, Dynamics, CurrentPiece
        The run, at the instant from which times of the step count. Of its observations the first
        is at the start of a local series, or is made; the last becomes that at the event, at a
        broken contact, or at the end of a local series.
    dense : Dense
        The step. One on a local series has no corner of the motion inside, and tells itself which
        gaps close at its end.

    Returns
    -------
    float
        When the first event is (s, local), as `located` of the run tells; or NO_EVENT; or
        BROKEN_BEFORE where a contact penetrates or pulls, at the present time of the run then.
    """
    rules, state, record = arrays.rules, arrays.state, arrays.record
    origin, (before, after, there) = state.now[0].t, arrays.observations
    forcing = by_address(forcing_now(piece, origin))
    high = dense.start
    while True:
        low, high = high, dense.end
        if piece.family >= _SAMPLES and not dense.own:
            following = next_corner(piece, origin + low, origin + high)
            high = high if following >= origin + high else following - origin
        part = Dense(dense.Y, dense.center, low, high, dense.frame, dense.own, dense.gaps)
        step = by_address(DenseStep(part, mode, forcing, there))
        if not dense.own:
            observe_at(low, by_address(DenseStep(part, mode, forcing, before)))
        observe_at(high, by_address(DenseStep(part, mode, forcing, after)))
        tau = _search_part(arrays, step)
        # The integrator stands on its root: `located` has it, and what vanishes with it is added.
        if high == dense.end and not dense.own and state.progress[0].finder == FOUND_AT_END:
            tau = high
            add_vanished(after, mode.guards, rules, arrays.located)
        # Beyond an event there is another mode, in which none of these need hold.
        broken = tau == NO_EVENT and broken_contact(after, mode.guards, rules.length_noise) >= 0
        if tau < NO_EVENT or broken or dense.own:
            observe_at(min(high, tau), step)
        if broken:
            state.now[0].t = origin + high
            return BROKEN_BEFORE
        if tau < NO_EVENT:
            return tau
        update_extremes(after, origin + high, record.running)
        if high >= dense.end:
            return NO_EVENT


@kernel
def _search_part(arrays: Run, step: DenseStep) -> float:
    """When the first event of a part of a step without samples inside is (s, local), or NO_EVENT.

    The first two observations of the run are those of its ends.
    """
    dense, guards, origin = step.dense, step.dynamics.guards, step.forcing.start
    (before, after, _), marks, record = arrays.observations, arrays.marks, arrays.record
    marked = inspect_step(before, after, dense.end - dense.start, guards, record.running, marks)
    for j in range(marks.closing.size):
        marks.closing[j] = marks.closing[j] and not dense.own
    tau = NO_EVENT
    # Where the library finds events only turning points are left to look for.
    if marked and (dense.own or arrays.state.progress[0].finder == OURSELVES):
        tau = first_event(marks, guards, arrays.rules, arrays.located, step)
    end = min(dense.end, tau)
    if marked:
        update_peaks(marks.peak, end, arrays.rules.near, record.running, step)
    if is_due(origin + end, record.journal):
        write_samples(_observed_at, step, origin, dense.start, end, record.journal)
    if arrays.laws.contact.size > 0:
        add_shares(end, arrays, step)
    return tau


@kernel
def search_to_event(arrays: Run, mode: Dynamics, piece: CurrentPiece, dense: Dense) -> int:
    """`search_step` of an integrator's: CLEAR, EVENT, which becomes the present, or BROKEN."""
    state, origin, there = arrays.state, arrays.state.now[0].t, arrays.observations[2]
    tau = search_step(arrays, mode, piece, dense)
    if tau == BROKEN_BEFORE:
        return BROKEN
    if tau == NO_EVENT:
        return CLEAR
    put_instant(origin + tau, there, arrays.record)
    forcing = by_address(forcing_now(piece, origin))
    y = state_at(tau, by_address(DenseStep(dense, mode, forcing, there)))
    set_state(y, origin + tau, mode, forcing, state)
    close_located(arrays)
    return EVENT
