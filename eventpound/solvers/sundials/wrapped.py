"""What CVODE and IDA have in common where scikit-sundae's Python interface calls them."""

from __future__ import annotations

from typing import Any

from eventpound.mechanics.model import Model
from eventpound.mechanics.reduced import Forcing
from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.integrator import Stretch
from eventpound.solvers.events.step_check import CLEAR
from eventpound.solvers.sundials.failure import could_not_continue
from eventpound.solvers.sundials.settings import out_of_reach


class Wrapped:
    """Duties of an `eventpound.solvers.events.integrator.Integrator` that both do alike.

    Attributes
    ----------
    name : str
        What SUNDIALS calls the solver.
    """

    name: str
    finds_events = False
    happened = None

    def __init__(self) -> None:
        self.rhs_calls = 0
        self.jacobian_calls = 0
        self.starts = 0
        self._forcing: Forcing
        self._present: Any = None
        self._time = 0.0
        self._looked_back = False
        self._spent = 0

    def find_events(self, model: Model, length: float, force: float) -> None:
        """Not to be had in this way.

        Raises
        ------
        InputError
            Always.
        """
        raise out_of_reach()

    def _begun_at(self, tau: float) -> None:
        """The present object has been started at the local time `tau` (s)."""
        self._time = tau
        self._looked_back = False
        self._spent = 0

    def _relative(self, tau: float, y: Floats) -> Floats:
        """The unknowns relative to the ground, in their place."""
        raise NotImplementedError

    def _step(self, stop: float, first: int) -> tuple[float, Floats]:
        """One accepted step, not beyond `stop` (s): time reached and unknowns there.

        `first` is the row of the state it starts from.
        """
        result = self._present.step(stop, "onestep", stop)
        if self._looked_back and result.success and result.t == self._time:
            # After interpolating, SUNDIALS first hands out the end of its last step again.
            result = self._present.step(stop, "onestep", stop)
        self._looked_back = False
        if not result.success:
            stretch = Stretch(first, self._time, self._time, CLEAR, 0.0, 0)
            raise could_not_continue(self.name, result.message, self._forcing.start, stretch)
        self._time = result.t
        self.jacobian_calls += result.njev - self._spent
        self._spent = result.njev
        return result.t, self._relative(result.t, result.y)
