"""The one imperative loop: smooth segments, events, restarts.

A run alternates between *settling* an instant (impacts, then the acceleration
problem, as `eventpound.solvers.events.modes` tabulates) followed by short
Taylor steps (`instant_loop`), and a *segment* on which the integrator carries the
motion up to the next event, breakpoint of the ground motion, or the end.
"""

from __future__ import annotations

import numpy as np

from eventpound.errors import ComputationError
from eventpound.mechanics.ground_frame import NO_FRAME, moving_frame
from eventpound.motion.base import Family, Piece
from eventpound.motion.loads import place_supports
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import in_python
from eventpound.numerics.compiling import Stopwatch
from eventpound.solvers.base import Energy, Recording, Task, Work
from eventpound.solvers.events.energy import energy_ledger, impact_terms
from eventpound.solvers.events.instant_loop import put_last_instant, settle_instant
from eventpound.solvers.events.integrator import Integrator
from eventpound.solvers.events.invariants import check_energy
from eventpound.solvers.events.recorder import resting_times
from eventpound.solvers.events.segment import Segment
from eventpound.solvers.events.underway import Underway

FRAMED = 1e-5
"""Part of L that the stiffest body must move by for a moving frame to carry the scene: the
frame moves by some L, and what it carries is rounded so."""


class EventLoop:
    """Runs one task on one integrator.

    Parameters
    ----------
    task : Task
        What to compute.
    integrator : Integrator
        Carries the smooth motion.
    moving : bool
        Whether it does so in a moving frame where the ground motion is a record.
    """

    def __init__(self, task: Task, integrator: Integrator, *, moving: bool = True) -> None:
        self.integrator = integrator
        self.now = Underway(task)
        scales = self.now.scales
        self.moving = moving and scales.own_length.min() >= FRAMED * scales.length

    def run(self) -> Recording:
        """Carry the scene to the end of its task.

        Raises
        ------
        ComputationError
            With everything computed so far in its `recording`.
        """
        clock = Stopwatch()
        try:
            self._advance_to_end()
            energy = self._energy()
            if energy is not None:
                check_energy(self.now.t, energy, self.now.task.rtol)
        except ComputationError as error:
            error.recording = self._recording(False, str(error), clock)
            raise
        return self._recording(True, "reached the end of the run", clock)

    def _advance_to_end(self) -> None:
        now = self.now
        end = now.task.end
        for given in now.task.scene.motion.pieces():
            stop = min(given.end, end)
            if stop <= now.t:
                continue
            piece, frame = now.piece(given, stop), self._frame(given)
            if given.family is Family.LOADED and given.start >= now.task.start:
                in_python(place_supports)(given.coefficients, now.state.u, now.state.v)
            now.mark_happened(*(np.zeros(1, np.bool_) for _ in range(3)))
            settle_instant(now, piece)
            while now.t < stop:
                if Segment(now, self.integrator, piece, frame).run():
                    settle_instant(now, piece)
            if stop == end:
                break
        put_last_instant(now, piece)

    def _frame(self, piece: Piece) -> Floats:
        """The moving frame of a piece; none where none is wanted."""
        if self.moving and piece.family is Family.SAMPLES:
            return moving_frame(piece)
        return NO_FRAME

    def _energy(self) -> Energy | None:
        """The ledger of the present state, where it is kept."""
        now = self.now
        if not now.task.energy:
            return None
        state = now.state
        terms = impact_terms(now.model, now.task.scene.motion, now.events())
        return energy_ledger(now.model, now.scales, state.u, state.v, state.ledger, *terms)

    def _recording(self, success: bool, message: str, clock: Stopwatch) -> Recording:
        now, integrator = self.now, self.integrator
        events = now.events()
        return Recording(
            success,
            message,
            now.t,
            now.state.u.copy(),
            now.state.v.copy(),
            now.state.z.copy(),
            now.history(),
            tuple(events),
            now.bounds("displacement"),
            now.bounds("elongation"),
            now.bounds("acceleration"),
            now.bounds("shear"),
            now.bounds("gap").minimum,
            resting_times(events, now.model.contacts, now.t),
            np.maximum(now.bounds("contact_force").maximum, 0.0),
            now.unique_forces,
            Work(
                integrator.rhs_calls,
                integrator.jacobian_calls,
                now.steps,
                max(integrator.starts - 1, 0),
                clock.seconds,
                clock.compilation,
            ),
            self._energy(),
            laws=now.law_recording(),
        )
