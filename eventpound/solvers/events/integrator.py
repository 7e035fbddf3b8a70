"""What the event loop asks of an integrator of smooth motion."""

from __future__ import annotations

from typing import Protocol

from eventpound.mechanics.reduced import Forcing
from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.modes import Mode


class Integrator(Protocol):
    """Duties of an integrator; times are local, from the start of the segment.

    1. `start(mode, forcing, frame, y, atol, tau)`: begin at the local time tau
       (s), anywhere in a segment; `frame` is a moving frame in which the
       motion is smoother (`eventpound.mechanics.ground_frame`), for inner use:
       states go in and out relative to the ground.
    2. `step(stop)`: one accepted step, not beyond `stop` (s); returns the
       time reached and the state there. Raises `ComputationError` where it
       cannot.
    3. `interpolate(tau)`: the state at a time within the last step.
    4. `rhs_calls`, `jacobian_calls`, `starts`: what was spent so far.
    """

    rhs_calls: int
    jacobian_calls: int
    starts: int

    def start(
        self,
        mode: Mode,
        forcing: Forcing,
        frame: Floats,
        y: Floats,
        atol: Floats,
        tau: float = 0.0,
    ) -> None:
        """Duty 1."""
        ...

    def step(self, stop: float) -> tuple[float, Floats]:
        """Duty 2."""
        ...

    def interpolate(self, tau: float) -> Floats:
        """Duty 3."""
        ...
