"""A segment: the smooth motion from one event to the next, step by step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from eventpound.errors import ComputationError
from eventpound.mechanics.ground_frame import NO_FRAME, moving_frame
from eventpound.mechanics.observables import Observed
from eventpound.mechanics.packing import observed_size, unpack_observed
from eventpound.mechanics.reduced import motion_rate
from eventpound.motion.base import Family, Piece
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import in_python
from eventpound.solvers.events.examination import (
    BEYOND_BOUND,
    HAPPENED,
    MARKED,
    NOT_FINITE,
    Examined,
)
from eventpound.solvers.events.happening import Happening, happening_with
from eventpound.solvers.events.inspection import nothing_watched
from eventpound.solvers.events.integrator import Bounds, StandstillError
from eventpound.solvers.events.modes import Mode
from eventpound.solvers.events.scales import state_tolerances

if TYPE_CHECKING:
    from eventpound.solvers.events.loop import EventLoop

Z_EXCESS = 10.0
"""Multiples of rtol by which |z| may exceed its bound at the end of a step."""
MOST_HALVINGS = 40
"""Times a step is halved before the run gives up."""
STEPS_AT_ONCE = 256
"""Steps after which the integrator comes back although nothing was marked: a run can be stopped."""
STOP_AT_SAMPLES = 1e-8
"""Tolerance below which the integrator stops at every sample of a record."""


def copy_observed(source: Observed, target: Observed) -> None:
    """Copy everything observed at one instant."""
    for value, place in zip(source, target, strict=True):
        place[...] = value


class Segment:
    """A run of the integrator in one mode; see `eventpound.solvers.events.location.Step`.

    Times are local, from `origin`; `start` and `end` are those of the last
    step.

    Parameters
    ----------
    loop : EventLoop
        The run, at the instant the segment begins.
    mode : Mode
        Its mode.
    piece : Piece
        The ground motion.
    stop : float
        Do not pass this time (s).
    """

    def __init__(self, loop: EventLoop, mode: Mode, piece: Piece, stop: float) -> None:
        self.loop, self.mode, self.piece = loop, mode, piece
        self.origin = loop.state.t
        self.stop = stop
        self.forcing = loop.forcing(piece)
        self.start = self.end = self.reached = 0.0
        self.frame = self._frame()
        self.watched = mode.watched
        if loop.integrator.finds_events:
            self.watched = nothing_watched(mode.watched)
        self.atol = state_tolerances(mode.system, mode.clusters.of_body, loop.atol)
        y = mode.pack(loop.state)
        model = loop.model
        self._counts = (model.bodies, model.links, model.contacts, model.hysteretic.size)
        looks = np.zeros((5, observed_size(*self._counts)))
        self._views: dict[int, Observed] = {}
        self._first = self._reached_row = 0
        self._examined = self._examination(looks, y.size)
        self._excess = -1.0
        self.happening: Happening | None = None
        self._length = stop - self.origin
        self._stops = piece.family is Family.SAMPLES and loop.task.rtol < STOP_AT_SAMPLES
        loop.integrator.start(mode, self.forcing, self.frame, y, self.atol)
        motion_rate(0.0, y, self._examined.rate[0], mode.system, self.forcing)
        self._examined.y[0] = y

    def _frame(self) -> Floats:
        """The moving frame of the piece, made once a run; none where none is wanted."""
        if not self.loop.moving or self.piece.family is not Family.SAMPLES:
            return NO_FRAME
        if self.piece.start not in self.loop.frames:
            self.loop.frames[self.piece.start] = moving_frame(self.piece)
        return self.loop.frames[self.piece.start]

    def _examination(self, looks: Floats, size: int) -> Examined:
        loop, mode, watched = self.loop, self.mode, self.watched
        own = watched is mode.watched
        return Examined(
            mode.ints,
            mode.floats,
            *self.forcing,
            self.frame,
            mode.contacts if own else np.vstack(watched[:2]),
            mode.kinks if own else np.vstack(watched[2:4]),
            loop.noise.force,
            watched.springs,
            looks,
            np.zeros((2, size)),
            np.zeros((2, size)),
            loop.recorder.table,
            loop.marks,
            loop.scales.z_bound,
            Z_EXCESS * loop.task.rtol,
        )

    @property
    def before(self) -> Observed:
        """Everything observed at the start of the last step."""
        return self._seen(self._first)

    def advance(self) -> bool:
        """Steps that pass the audit; true where something may have happened in the last of them.

        A step may leap over the knee of the hysteresis, which |z|^n hides until
        it is reached; z then ends beyond its bound, and the step is taken anew
        with half the length.

        Raises
        ------
        ComputationError
            Where the integrator stands still or no step passes.
        """
        loop, integrator = self.loop, self.loop.integrator
        most = loop.task.max_steps
        at_once = STEPS_AT_ONCE if most is None else min(STEPS_AT_ONCE, most - loop.steps)
        bounds = Bounds(self._length, self._stops, loop.recorder.next_due, at_once)
        tau, first = self.end, 1 - self._first if self.end > 0.0 else self._first
        for _ in range(MOST_HALVINGS):
            try:
                done = integrator.advance(tau, first, self._excess, bounds, self._examined)
            except StandstillError as error:
                self.reached, self._reached_row = error.stretch.start, error.stretch.first
                raise
            self._first, self.start, self.end = done.first, done.start, done.end
            self.reached, self._reached_row = done.start, done.first
            loop.steps += done.steps
            if done.end <= done.start:
                raise ComputationError(
                    "the integrator makes no progress; try a larger rtol", self.origin + self.end
                )
            if done.verdict == NOT_FINITE:
                raise ComputationError(
                    "the state is not a number any more; try a smaller rtol",
                    self.origin + self.end,
                )
            if done.verdict != BEYOND_BOUND:
                self._excess = done.excess
                if done.verdict == HAPPENED and integrator.happened is not None:
                    found = (self.mode.watched, loop.noise, *integrator.happened)
                    self.happening = happening_with(self.end, self, *found)
                return done.verdict in (MARKED, HAPPENED)
            tau, first = done.start, done.first
            bounds = bounds._replace(stop=tau + 0.5 * (done.end - tau), most=1)
            y = self._examined.y[first]
            integrator.start(self.mode, self.forcing, self.frame, y, self.atol, tau)
        raise ComputationError(
            f"z exceeds its bound by {done.excess:.3g}; try a smaller rtol",
            self.origin + self.end,
        )

    def accept(self) -> None:
        """Count the last step as completed: a run that fails later goes back to its end."""
        self.reached, self._reached_row = self.end, 1 - self._first

    @property
    def reached_state(self) -> Floats:
        """State vector at `reached`, the end of the last step that passed (s, local)."""
        return self._examined.y[self._reached_row]

    @property
    def y(self) -> Floats:
        """State vector at the end of the last step."""
        return self._examined.y[1 - self._first]

    def _seen(self, row: int) -> Observed:
        """A row of `looks` as what it holds."""
        if row not in self._views:
            self._views[row] = in_python(unpack_observed)(self._examined.looks[row], *self._counts)
        return self._views[row]

    def nodes(self) -> list[float]:
        """Ends of the last step and the samples of a record between them (s, local)."""
        nodes = [self.start]
        end = self.origin + self.end
        while True:
            following = self.loop.next_stop(self.piece, self.origin + nodes[-1], end)
            if following >= end:
                return [*nodes, self.end]
            nodes.append(following - self.origin)

    def state(self, tau: float) -> Floats:
        """State vector at `tau` (s)."""
        return self.loop.integrator.interpolate(tau)

    def look(self, tau: float) -> Observed:
        """Everything observed at `tau` (s); valid until the next look."""
        self.loop.integrator.look(tau, self._examined.looks)
        return self._seen(4)


@dataclass(frozen=True)
class Part:
    """A part of a segment's last step, between two samples of a record."""

    segment: Segment
    start: float
    end: float

    def look(self, tau: float) -> Observed:
        """Everything observed at `tau` (s); valid until the next look."""
        return self.segment.look(tau)
