"""What the event loop asks of an integrator of smooth motion."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from eventpound.errors import ComputationError
from eventpound.mechanics.model import Model
from eventpound.mechanics.reduced import Forcing
from eventpound.motion.forcing import longest_safe_step, next_corner
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import scalar_kernel
from eventpound.solvers.events.dense import Dense
from eventpound.solvers.events.modes import Mode
from eventpound.solvers.events.step_check import Examination


class Start(NamedTuple):
    """Where an integrator begins.

    mode, forcing, frame: of the segment. y: the state vector. atol: absolute tolerances of it.
    tau: local time (s).
    """

    mode: Mode
    forcing: Forcing
    frame: Floats
    y: Floats
    atol: Floats
    tau: float = 0.0


class Bounds(NamedTuple):
    """Where a run of steps ends, if none of them is marked before.

    stop: no step goes beyond this local time (s). at_samples: nor beyond the
    next sample of a record. longest: none is longer (s). most: this step, counted from 1, is the
    last.
    """

    stop: float
    at_samples: bool
    longest: float
    most: int


@scalar_kernel
def last_time(start: float, bounds: Bounds, forcing: Forcing) -> float:
    """Local time (s) beyond which a step from `start` (s) may not go."""
    origin = forcing.start
    longest = min(bounds.longest, longest_safe_step(forcing, origin + start))
    stop = min(bounds.stop, start + longest)
    if not bounds.at_samples:
        return stop
    following = next_corner(forcing, origin + start, origin + stop)
    # Less the origin again the end may be another number: a step from there would have no length.
    return following - origin if following < origin + bounds.stop else bounds.stop


class StepsTaken(NamedTuple):
    """What a run of steps came to.

    first: row of `Examination` that holds the start of the last step. start, end:
    of the last step (s, local); the same where the integrator stands still.
    verdict, excess: of its examination. steps: how many were accepted.
    """

    first: int
    start: float
    end: float
    verdict: int
    excess: float
    steps: int


class StandstillError(ComputationError):
    """An integrator that cannot take a step.

    Parameters
    ----------
    message : str
        What happened.
    t : float
        Time it stands at (s).
    taken : StepsTaken
        The steps it took before, the last of them to nowhere.
    """

    def __init__(self, message: str, t: float, taken: StepsTaken) -> None:
        super().__init__(message, t)
        self.taken = taken


class Integrator(Protocol):
    """Duties of an integrator; times are local, from the start of the segment.

    1. `start(mode, forcing, frame, y, atol, tau)`: begin at the local time tau
       (s), anywhere in a segment; `frame` is a moving frame in which the
       motion is smoother (`eventpound.mechanics.ground_frame`), for inner use:
       states go in and out relative to the ground.
    2. `advance(tau, first, excess, bounds, e)`: accepted steps from tau (s),
       where the last one ended, each examined by `examine` before the next
       is taken, up to the first that is not clear or the bounds; at least one.
       `first` is the row of `e` with the state at tau, `excess` what the last
       examination said. Raises `StandstillError` where it cannot.
    3. `dense(start, end)`: the motion over the last step as a polynomial, in the frame.
    4. `rhs_calls`, `jacobian_calls`, `starts`: what was spent so far.
    5. `find_events(model, length, time)`: find events itself, for the whole run, in a scene of the
       own `length` (m); an InputError where it cannot. `finds_events`:
       whether it does. Then the examination of a step looks for extremes only, and where an
       event happens `advance` ends with the verdict EVENT_FOUND and the step at it. `located`:
       closing (K,), released (K,) and kinked (L,) there.
    6. `foresee(start, e)`: have the loop of `advance` compiled while other things are; nothing
       of the start counts but its mode, forcing and frame.
    """

    starts: int

    def find_events(self, model: Model, length: float, time: float) -> None:
        """Part of duty 5."""
        ...

    @property
    def finds_events(self) -> bool:
        """Part of duty 5."""
        ...

    @property
    def located(self) -> tuple[Bools, Bools, Bools] | None:
        """Part of duty 5."""
        ...

    @property
    def rhs_calls(self) -> int:
        """Part of duty 4."""
        ...

    @property
    def jacobian_calls(self) -> int:
        """Part of duty 4."""
        ...

    def foresee(self, start: Start, e: Examination) -> None:
        """Duty 6."""
        ...

    def start(self, start: Start) -> None:
        """Duty 1."""
        ...

    def advance(
        self, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
    ) -> StepsTaken:
        """Duty 2."""
        ...

    def dense(self, start: float, end: float) -> Dense:
        """Duty 3."""
        ...
