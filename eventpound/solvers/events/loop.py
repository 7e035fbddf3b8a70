"""The one imperative loop: smooth stretches, events, restarts.

A run alternates between *settling* an instant (impacts, then the acceleration
problem, as `eventpound.solvers.events.modes` tabulates) followed by short
Taylor steps (`settling`), and a *segment* on which the integrator carries the
motion up to the next event, breakpoint of the ground motion, or the end.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from eventpound.errors import ComputationError
from eventpound.mechanics.model import Model, assemble
from eventpound.mechanics.observables import Observed, blank
from eventpound.mechanics.packing import observe_packed
from eventpound.mechanics.reduced import Forcing, motion_rate
from eventpound.motion.base import Family, Piece
from eventpound.motion.forcing import next_sample
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import in_python
from eventpound.numerics.compiling import Stopwatch
from eventpound.solvers.base import Energy, Recording, Task, Work, steps_used_up
from eventpound.solvers.events.audit import check_contacts, check_energy
from eventpound.solvers.events.beginning import lines_before
from eventpound.solvers.events.energy import energy_ledger
from eventpound.solvers.events.examination import unpack_marks
from eventpound.solvers.events.happening import Happening, Noise, first_happening
from eventpound.solvers.events.inspection import blank_marks, inspect_step
from eventpound.solvers.events.integrator import Integrator
from eventpound.solvers.events.modes import Mode, ModeTable, State
from eventpound.solvers.events.recorder import Recorder, resting_times
from eventpound.solvers.events.scales import scene_scales, state_tolerances, tolerances
from eventpound.solvers.events.segment import Part, Segment, copy_observed
from eventpound.solvers.events.settling import Settling

FORCE_NOISE = 1e-12
"""Contact forces below this part of m L/T² have no meaningful sign."""
LENGTH_NOISE = 1e-15
"""Gaps and distances to a kink below this part of L have no meaningful sign."""


SAME_INSTANT = 1e-12
"""Part of T within which closings and passed kinks belong to one instant."""
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
        self.task = task
        self.integrator = integrator
        self.model: Model = assemble(task.scene)
        self.scales = scene_scales(task.scene, self.model, task.end - task.start)
        self.moving = moving and self.scales.own_length.min() >= FRAMED * self.scales.length
        self.atol = tolerances(task, self.scales)
        self.noise = Noise(
            LENGTH_NOISE * self.scales.length,
            FORCE_NOISE * self.scales.force,
            SAME_INSTANT * self.scales.time,
        )
        self.table = ModeTable(self.model, ledger=task.energy, force_noise=self.noise.force)
        first = lines_before(task, self.model, self.scales)
        self.recorder = Recorder(self.model, task.output_times, self.scales, first)
        self.pieces: list[Piece] = task.scene.motion.pieces()
        self.steps = 0
        model = self.model
        self.marks = blank_marks(model.bodies, model.links, model.springs, model.contacts)
        self.found = in_python(unpack_marks)(self.marks, model.contacts, model.links)
        self.frames: dict[float, Floats] = {}
        self.seen = [blank(self.model) for _ in range(3)]
        self.state = self._initial_state()
        self.settling = Settling(self)

    def _initial_state(self) -> State:
        model = self.model
        gap = model.initial_gaps(self.scales.length)
        return State(
            self.task.start,
            model.u0.copy(),
            model.v0.copy(),
            model.z0.copy(),
            gap,
            model.rates(model.v0),
            np.zeros(model.contacts, np.bool_),
            np.zeros(model.contacts, np.bool_),
            np.zeros(model.links, np.int64),
            np.zeros(3),
        )

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
                check_energy(self.state.t, energy, self.task.rtol)
        except ComputationError as error:
            error.recording = self._recording(False, str(error), clock)
            raise
        return self._recording(True, "reached the end of the run", clock)

    def _advance_to_end(self) -> None:
        nobody = np.zeros(self.model.contacts, np.bool_)
        for piece in self.pieces:
            stop = min(piece.end, self.task.end)
            if stop <= self.state.t:
                continue
            self.settling.settle(piece, stop, nobody)
            while self.state.t < stop:
                happening = self._segment(piece, stop)
                if happening is not None:
                    self.settling.settle(piece, stop, happening.released)
            if stop == self.task.end:
                break
        mode = self.mode()
        forcing = self.forcing(piece)
        self.recorder.instant(self.state.t, self.observed(mode, forcing, self.seen[0]))

    def mode(self) -> Mode:
        """The present mode."""
        return self.table.mode(self.state.resting, self.state.branch, self.state.pressed)

    def forcing(self, piece: Piece) -> Forcing:
        """The ground motion from the present instant on."""
        return Forcing(int(piece.family), piece.coefficients, piece.samples, self.state.t)

    def observed(self, mode: Mode, forcing: Forcing, out: Observed) -> Observed:
        """Everything observed of the present state, gaps by their own variables."""
        y = mode.pack(self.state)
        rate = np.empty(y.size)
        motion_rate(0.0, y, rate, mode.system, forcing)
        observe_packed(0.0, y, rate, mode.ints, mode.floats, forcing, out)
        out.gap[0], out.gap[1] = self.state.gap, self.state.gap_rate
        return out

    def weights(self, mode: Mode, y: Floats) -> Floats:
        """Tolerance of each entry of a state vector, shape (size,)."""
        of_body = mode.clusters.of_body
        return state_tolerances(mode.system, of_body, self.atol) + self.task.rtol * np.abs(y)

    @staticmethod
    def next_stop(piece: Piece, t: float, stop: float) -> float:
        """Next time after t the acceleration is not smooth: a sample, or `stop` (s)."""
        if piece.family is not Family.SAMPLES:
            return stop
        return next_sample(piece.coefficients, t, stop)

    def _segment(self, piece: Piece, stop: float) -> Happening | None:
        """Integrate until something happens or `stop` is reached."""
        mode = self.mode()
        segment = Segment(self, mode, piece, stop)
        self.observed(mode, segment.forcing, segment.before)
        while segment.end < stop - segment.origin:
            try:
                self.go_on(segment.origin + segment.end)
                happening = self._step(segment)
            except ComputationError:
                self.take(segment.reached_state, mode, segment.origin + segment.reached)
                raise
            if happening is not None:
                self.take(segment.state(happening.tau), mode, segment.origin + happening.tau)
                self._mark(happening)
                return happening
        self.take(segment.y, mode, stop)
        return None

    def _step(self, segment: Segment) -> Happening | None:
        """Some steps without events, or one with what happens first in it, if anything does."""
        if segment.advance():
            happening = self._look_again(segment)
            segment.accept()
            return happening
        segment.accept()
        end = segment.origin + segment.end
        if self.recorder.due(end):
            self.recorder.samples(segment, segment.origin, segment.end)
        return None

    def go_on(self, t: float) -> None:
        """Report the time reached (s).

        Raises
        ------
        ComputationError
            Where whoever watches the run or the limit of steps ends it there.
        """
        task = self.task
        if task.progress is not None:
            task.progress(t)
        if task.max_steps is not None and self.steps >= task.max_steps:
            raise steps_used_up(task.max_steps, t)

    def _look_again(self, segment: Segment) -> Happening | None:
        """Look for events in a step that was marked, from sample to sample."""
        nodes = segment.nodes()
        before, after = self.seen[0], self.seen[1]
        copy_observed(segment.before, before)
        for low, high in pairwise(nodes):
            part = Part(segment, low, high)
            copy_observed(segment.look(high), after)
            happening = self.inspect(part, segment, before, after)
            if happening is not None:
                return happening
            before, after = after, before
        return None

    def inspect(
        self, step: Part, segment: Segment, before: Observed, after: Observed
    ) -> Happening | None:
        """Look for events in a part of a step, then record it up to the first of them."""
        recorder, found = self.recorder, self.found
        origin, watched = segment.origin, segment.watched
        # An event that the integrator has found is where its step ends.
        happening = segment.happening if step.end == segment.end else None
        if inspect_step(before, after, step.end - step.start, watched, recorder.running, found):
            happening = happening or first_happening(step, found, watched, self.noise)
        end = step.end if happening is None else happening.tau
        recorder.peaks(step, origin, end, found)
        if recorder.due(origin + end):
            recorder.samples(step, origin, end)
        if happening is None:
            check_contacts(origin + end, after, segment.mode.watched, self.noise, self.task.scene)
            recorder.extremes(origin + end, after)
        else:
            recorder.instant(origin + end, step.look(end))
        return happening

    def take(self, y: Floats, mode: Mode, t: float) -> None:
        """Make a state vector the present state."""
        state, clusters, system = self.state, mode.clusters, mode.system
        moving = clusters.of_body >= 0
        place = clusters.of_body[moving]
        state.t = t
        state.u = clusters.offset.copy()
        state.u[moving] += y[system.iq[place]]
        state.v = np.zeros(state.u.size)
        state.v[moving] = y[system.iv[place]]
        active = system.z_of >= 0
        state.z[active] = y[system.z_of[active]]
        if system.ledger >= 0:
            state.ledger = y[system.ledger :].copy()
        state.gap, state.gap_rate = self.model.gaps(state.u), self.model.rates(state.v)
        state.gap[state.resting] = 0.0
        state.gap_rate[state.resting] = 0.0

    def _mark(self, happening: Happening) -> None:
        """Put what happened exactly on its constraint."""
        state = self.state
        state.gap[happening.closing] = 0.0
        together = (state.gap_rate < 0.0) & (state.gap <= -self.noise.instant * state.gap_rate)
        state.gap[together & ~state.resting] = 0.0
        state.branch[happening.kinked] *= -1

    def _energy(self) -> Energy | None:
        """The ledger of the present state, where it is kept."""
        if not self.task.energy:
            return None
        state = self.state
        lost = sum(event.energy_lost for event in self.recorder.events)
        return energy_ledger(self.model, self.scales, state.u, state.v, state.ledger, lost)

    def _recording(self, success: bool, message: str, clock: Stopwatch) -> Recording:
        state, recorder = self.state, self.recorder
        return Recording(
            success,
            message,
            state.t,
            state.u.copy(),
            state.v.copy(),
            state.z.copy(),
            recorder.history(),
            # Impacts held back until a cascade was seen to end come late into the list.
            tuple(sorted(recorder.events, key=lambda event: event.t)),
            recorder.bounds("displacement"),
            recorder.bounds("elongation"),
            recorder.bounds("acceleration"),
            recorder.bounds("shear"),
            recorder.bounds("gap").minimum,
            resting_times(recorder.events, self.model.contacts, state.t),
            np.maximum(recorder.bounds("contact_force").maximum, 0.0),
            recorder.unique_forces,
            Work(
                self.integrator.rhs_calls,
                self.integrator.jacobian_calls,
                self.steps,
                max(self.integrator.starts - 1, 0),
                clock.seconds,
                clock.compilation,
            ),
            self._energy(),
        )
