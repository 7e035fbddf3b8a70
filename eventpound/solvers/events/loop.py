"""The one imperative loop: smooth segments, step by step, events, restarts.

A run alternates between *settling* an instant (impacts, then the acceleration
problem, as `eventpound.contact.modes` tabulates) followed by short
Taylor steps (`instant_loop`), and a *segment* on which the integrator carries the
motion up to the next event, breakpoint of the ground motion, or the end.
"""

from __future__ import annotations

import numpy as np

from eventpound.errors import ComputationError
from eventpound.mechanics.ground_frame import NO_FRAME, moving_frame
from eventpound.motion.base import Family
from eventpound.motion.forcing import CurrentPiece
from eventpound.motion.loads import shortest_times
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import foresee, in_python
from eventpound.numerics.compiling import Stopwatch
from eventpound.solvers.base import Energy, Recording, Task, Work
from eventpound.solvers.events.event_run import EventRun
from eventpound.solvers.events.instant import short_step
from eventpound.solvers.events.instant_loop import (
    put_present_instant,
    search_step,
    set_present,
    settle_instant,
)
from eventpound.solvers.events.integrator import Bounds, Integrator, StandstillError, Start
from eventpound.solvers.events.recorder import (
    energy_ledger,
    friction_of,
    impact_terms,
    kept,
    own_recording,
)
from eventpound.solvers.events.step_check import (
    BEYOND_BOUND,
    EVENT_FOUND,
    MARKED,
    NOT_FINITE,
    check_energy,
)
from eventpound.solvers.events.step_search import FOUND_AT_END, INTEGRATOR, OURSELVES
from eventpound.tolerances import FRAMED, STOP_AT_SAMPLES

MOST_HALVINGS = 40
"""Times a step is halved before the run gives up."""
STEPS_AT_ONCE = 256
"""Steps after which the integrator comes back although nothing was marked: a run can be stopped."""
SINUSOID_STEP = 1.0
"""Longest step while contacts rest, in radians of a sinusoid: contact forces follow the
ground and loads that may move no body, which no error of a step shows. Hermite's cubic through its
ends is off by h^4/384 of a fourth derivative, by 3e-3 of the load at most. Of a pulse
`eventpound.motion.forcing.longest_safe_step` misses nothing."""


class Segment:
    """A run of the integrator in one mode.

    Times are local, from `origin`; `start` and `end` are those of the last
    step.

    Parameters
    ----------
    run : EventRun
        The run, at the instant the segment begins.
    integrator : Integrator
        Carries the motion.
    piece : CurrentPiece
        The ground motion; its end is not passed.
    frame : ndarray
        A moving frame (`eventpound.mechanics.ground_frame`).
    """

    def __init__(
        self, run: EventRun, integrator: Integrator, piece: CurrentPiece, frame: Floats
    ) -> None:
        self.event_run, self.integrator, self.piece, self.frame = run, integrator, piece, frame
        self.mode, self.origin = run.mode, run.t
        self.start = self.end = self.reached = 0.0
        self.forcing = run.forcing()
        self._first = self._reached_row = 0
        self._excess = -1.0
        self._length = piece.stop - self.origin
        run.state.progress["finder"][0] = INTEGRATOR if integrator.finds_events else OURSELVES
        pressed = self.mode.bodies.resting.size > 0
        self._longest = np.inf
        if pressed:
            _, sinusoid, _ = in_python(shortest_times)(piece.family, piece.coefficients)
            self._longest = SINUSOID_STEP * sinusoid
        # In a moving frame a step is inspected from sample to sample.
        close = (pressed and frame.shape[1] == 0) or run.task.rtol < STOP_AT_SAMPLES
        self._stops = piece.family >= Family.SAMPLES and close
        size = self.mode.system.size
        e = self._examined = run.examination(frame, finds_events=integrator.finds_events)
        self.atol = run.arrays.atol[:size].copy()
        self._start = Start(self.mode, self.forcing, frame, e.y[0].copy(), self.atol)
        integrator.start(self._start)

    def run(self) -> bool:
        """Integrate until something happens or the piece ends; whether something did.

        Raises
        ------
        ComputationError
            Where the integrator fails or whoever watches the run ends it; the present state
            is then the end of the last step that passed.
        """
        run = self.event_run
        while self.end < self._length:
            try:
                run.report_time(self.origin + self.end)
                if self._advance():
                    step = self.integrator.dense(self.start, self.end)
                    if search_step(run, self.piece, step):
                        return True
            except ComputationError:
                y = self._examined.y[self._reached_row]
                set_present(run, self.piece, y, self.origin + self.reached)
                raise
            self.reached, self._reached_row = self.end, 1 - self._first
        y = self._examined.y[1 - self._first]
        set_present(run, self.piece, y, self.piece.stop)
        return False

    def _advance(self) -> bool:
        """Steps that pass the audit; true where something may have happened in the last of them.

        A step may leap over the knee of the hysteresis, which |z|^n hides until
        it is reached; z then ends beyond its bound, and the step is taken anew
        with half the length.

        Raises
        ------
        ComputationError
            Where the integrator stands still or no step passes.
        """
        run, integrator = self.event_run, self.integrator
        bounds = Bounds(self._length, self._stops, self._longest, run.steps_left(STEPS_AT_ONCE))
        tau, first = self.end, 1 - self._first if self.end > 0.0 else self._first
        for _ in range(MOST_HALVINGS):
            try:
                done = integrator.advance(tau, first, self._excess, bounds, self._examined)
            except StandstillError as error:
                self.reached, self._reached_row = error.taken.start, error.taken.first
                raise
            self._first, self.start, self.end = done.first, done.start, done.end
            self.reached, self._reached_row = done.start, done.first
            run.state.progress["steps"][0] += done.steps
            if done.end <= done.start:
                raise ComputationError(
                    "the integrator makes no progress; try a larger rtol", self.origin + self.end
                )
            if done.verdict == NOT_FINITE:
                raise ComputationError(
                    "the state is not a number any more; try a smaller rtol", self.origin + self.end
                )
            if done.verdict != BEYOND_BOUND:
                self._excess = done.excess
                if done.verdict == EVENT_FOUND and integrator.located is not None:
                    run.state.progress["finder"][0] = FOUND_AT_END
                    run.mark_located(*integrator.located)
                return done.verdict in (MARKED, EVENT_FOUND)
            tau, first = done.start, done.first
            bounds = bounds._replace(stop=tau + 0.5 * (done.end - tau), most=1)
            y = self._examined.y[first]
            integrator.start(self._start._replace(y=y, tau=tau))
        raise ComputationError(
            f"z exceeds its bound by {done.excess:.3g}; try a smaller rtol", self.origin + self.end
        )


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
    finds_events : bool
        Whether it finds events itself.
    """

    def __init__(
        self, task: Task, integrator: Integrator, *, moving: bool = True, finds_events: bool = False
    ) -> None:
        self.integrator = integrator
        run = self.event_run = EventRun(task)
        self._integrated = 0.0
        if finds_events:
            integrator.find_events(run.model, run.rules.length, run.rules.time)
        scales = run.scales
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
                check_energy(self.event_run.t, energy, self.event_run.task.rtol)
        except ComputationError as error:
            error.recording = self._recording(False, str(error), clock)
            raise
        return self._recording(True, "reached the end of the run", clock)

    def _advance_to_end(self) -> None:
        run = self.event_run
        end = run.task.end
        for given in run.task.scene.motion.pieces():
            stop = min(given.end, end)
            if stop <= run.t:
                continue
            piece, moving = run.piece(given, stop), self.moving and given.family is Family.SAMPLES
            frame = moving_frame(given) if moving else NO_FRAME
            run.mark_located(*(np.zeros(1, np.bool_) for _ in range(3)))
            self._foresee(piece, frame)
            settle_instant(run, piece)
            while run.t < stop:
                if self._follow(piece, frame):
                    settle_instant(run, piece)
            if stop == end or run.state.resting[run.model.own_contacts :].any():
                # At a corner of the motion a stick may end: it has two sides.
                put_present_instant(run, piece)
            if stop == end:
                break

    def _foresee(self, piece: CurrentPiece, frame: Floats) -> None:
        """Have what comes after the first instant compiled meanwhile."""
        run, integrator = self.event_run, self.integrator
        foresee(short_step, run.arrays, run.mode.dynamics, piece)
        start = Start(run.mode, run.forcing(), frame, run.arrays.y, run.arrays.atol)
        e = run.examination(frame, finds_events=integrator.finds_events)
        integrator.foresee(start, e)

    def _follow(self, piece: CurrentPiece, frame: Floats) -> bool:
        """A segment, whose time is that of the integrator; whether something happened."""
        run, begun = self.event_run, self.event_run.t
        try:
            something = Segment(run, self.integrator, piece, frame).run()
        finally:
            self._integrated += run.t - begun
        run.check_held()
        return something

    def _energy(self) -> Energy | None:
        """The ledger of the present state, where it is kept."""
        run = self.event_run
        if not run.task.energy:
            return None
        state = run.state
        terms = impact_terms(run.model, run.task.scene.motion, run.events())
        return energy_ledger(run.model, run.scales, state.u, state.v, state.ledger, *terms)

    def _recording(self, success: bool, message: str, clock: Stopwatch) -> Recording:
        run, integrator = self.event_run, self.integrator
        events, state = run.events(), run.state
        ledger = state.ledger if run.task.energy else None
        recording = Recording(
            success,
            message,
            run.t,
            state.u.copy(),
            state.v.copy(),
            state.z.copy(),
            run.history(),
            tuple(events),
            unique_forces=run.unique_forces,
            work=Work(
                integrator.rhs_calls,
                integrator.jacobian_calls,
                run.steps,
                max(integrator.starts - 1, 0),
                clock.seconds,
                clock.compilation,
            ),
            energy=self._energy(),
            laws=run.law_recording(),
            integrated=self._integrated,
            friction=friction_of(run.model, run.table.rubbed, state.u, state.branch, ledger),
            **kept(run.record.extremes, events, run.t, run.model),
        )
        return own_recording(recording, run.model)
