"""A segment: the smooth motion from one event to the next, step by step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from eventpound.errors import ComputationError
from eventpound.mechanics.ground_frame import NO_FRAME, moving_frame
from eventpound.mechanics.observables import Observed, observe
from eventpound.mechanics.packing import observed_size, unpack_observed
from eventpound.mechanics.reduced import motion_rate
from eventpound.motion.base import Family, Piece
from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.examination import Examined, Verdict, examine_step
from eventpound.solvers.events.modes import Mode
from eventpound.solvers.events.scales import state_tolerances

if TYPE_CHECKING:
    from eventpound.solvers.events.loop import EventLoop

# Plain integers: looking up a member of an enumeration costs as much as a step's bookkeeping.
NOT_FINITE, BEYOND_BOUND = int(Verdict.NOT_FINITE), int(Verdict.BEYOND_BOUND)
MARKED = int(Verdict.MARKED)
Z_EXCESS = 10.0
"""Multiples of rtol by which |z| may exceed its bound at the end of a step."""
MOST_HALVINGS = 40
"""Times a step is halved before the run gives up."""
STOP_AT_SAMPLES = 1e-8
"""Tolerance below which the integrator stops at every sample of a record."""


def copy_observed(source: Observed, target: Observed) -> None:
    """Copy everything observed at one instant."""
    for value, place in zip(source, target, strict=True):
        place[...] = value


class Segment:
    """A run of the integrator in one mode; see `eventpound.solvers.events.location.Step`.

    Times are local, from `origin`; `start` and `end` are those of the last
    step, `y` the state at its end.

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
        self.start = self.end = 0.0
        self.frame = self._frame()
        self.atol = state_tolerances(mode.system, loop.atol)
        self.y = mode.pack(loop.state)
        self._scratch_rate = np.empty(self.y.size)
        model = loop.model
        self._counts = (model.bodies, model.links, model.contacts, model.hysteretic.size)
        looks = np.zeros((4, observed_size(*self._counts)))
        self._looks = [unpack_observed(row, *self._counts) for row in looks]
        self._first = 0
        self._examined = self._examination(looks)
        self._excess = -1.0
        self._allowed = Z_EXCESS * loop.task.rtol
        self._length = stop - self.origin
        self._stops = piece.family is Family.SAMPLES and loop.task.rtol < STOP_AT_SAMPLES
        loop.integrator.start(mode, self.forcing, self.frame, self.y, self.atol)
        motion_rate(0.0, self.y, self._examined.rate[0], mode.system, self.forcing)
        self._examined.y[0] = self.y

    def _frame(self) -> Floats:
        """The moving frame of the piece, made once a run."""
        if self.piece.family is not Family.SAMPLES:
            return NO_FRAME
        if self.piece.start not in self.loop.frames:
            self.loop.frames[self.piece.start] = moving_frame(self.piece)
        return self.loop.frames[self.piece.start]

    def _examination(self, looks: Floats) -> Examined:
        loop, mode = self.loop, self.mode
        watched = mode.watched
        return Examined(
            mode.ints,
            mode.floats,
            *self.forcing,
            self.frame,
            np.vstack((watched.open_contacts, watched.unlocked)),
            np.vstack((watched.kink_low, watched.kink_high)),
            loop.noise.force,
            watched.springs,
            looks,
            np.zeros((2, self.y.size)),
            np.zeros((2, self.y.size)),
            loop.recorder.table,
            loop.marks,
            loop.scales.z_bound,
        )

    @property
    def before(self) -> Observed:
        """Everything observed at the start of the last step."""
        return self._looks[self._first]

    def advance(self) -> bool:
        """One more step that passes the audit; true where something may have happened in it.

        A step may leap over the knee of the hysteresis, which |z|^n hides until
        it is reached; z then ends beyond its bound, and the step is taken anew
        with half the length.

        Raises
        ------
        ComputationError
            Where the integrator stands still or no step passes.
        """
        loop, e = self.loop, self._examined
        if self.end > 0.0:
            self._first = 1 - self._first
        self.start = self.end
        stop = self._next_stop() if self._stops else self._length
        allowed = max(self._allowed, self._excess)
        for _ in range(MOST_HALVINGS):
            self.end, y = loop.integrator.step(stop)
            if self.end <= self.start:
                raise ComputationError(
                    "the integrator makes no progress; try a larger rtol", self.origin + self.end
                )
            e.y[1 - self._first] = y
            verdict, excess = examine_step(self.start, self.end, self._first, allowed, e)
            if verdict == NOT_FINITE:
                raise ComputationError(
                    "the state is not a number any more; try a smaller rtol",
                    self.origin + self.end,
                )
            if verdict != BEYOND_BOUND:
                self.y, self._excess = y, excess
                loop.steps += 1
                return bool(verdict == MARKED)
            stop = self.start + 0.5 * (self.end - self.start)
            loop.integrator.start(
                self.mode, self.forcing, self.frame, self.y, self.atol, self.start
            )
        raise ComputationError(
            f"z exceeds its bound by {excess:.3g}; try a smaller rtol", self.origin + self.end
        )

    def _next_stop(self) -> float:
        t = self.origin + self.start
        return self.loop.next_stop(self.piece, t, self.stop) - self.origin

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
        y, rate = self.state(tau), self._scratch_rate
        motion_rate(tau, y, rate, self.mode.system, self.forcing)
        observe(tau, y, rate, self.mode.bodies, self.forcing, self._looks[3])
        return self._looks[3]


@dataclass(frozen=True)
class Part:
    """A part of a segment's last step, between two samples of a record."""

    segment: Segment
    start: float
    end: float

    def look(self, tau: float) -> Observed:
        """Everything observed at `tau` (s); valid until the next look."""
        return self.segment.look(tau)
