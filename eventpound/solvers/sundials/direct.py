"""What CVODE and IDA have in common where compiled code calls them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from eventpound.mechanics.model import Model
from eventpound.mechanics.reduced import Forcing
from eventpound.numerics.arrays import Bools
from eventpound.solvers.events.integrator import Stretch
from eventpound.solvers.sundials.callback_data import Handed
from eventpound.solvers.sundials.failure import could_not_continue
from eventpound.solvers.sundials.root_functions import Numbers, RootFunctions


class _Counted(Protocol):
    """A SUNDIALS object that counts its Jacobians."""

    def jacobian_calls(self) -> int:
        """How many there were since it was started."""
        ...


class Direct:
    """Duties of an `eventpound.solvers.events.integrator.Integrator` that both do alike.

    Attributes
    ----------
    name : str
        What SUNDIALS calls the solver.
    messages : mapping of int to str
        What its flags mean.
    """

    name: str
    messages: Mapping[int, str]

    def __init__(self) -> None:
        self.jacobian_calls = 0
        self.starts = 0
        self._handed = Handed()
        self._forcing: Forcing
        self._memory: _Counted
        self._spent = 0
        self._roots: RootFunctions | None = None

    @property
    def finds_events(self) -> bool:
        """Whether its own root finder does."""
        return self._roots is not None

    @property
    def happened(self) -> tuple[Bools, Bools, Bools] | None:
        """What its root finder has found at the end of the last step."""
        return self._roots.marks() if self._roots is not None else None

    def find_events(self, model: Model, length: float, force: float) -> None:
        """Let its own root finder find events, for the whole run."""
        self._roots = RootFunctions(model, length, force)

    @property
    def rhs_calls(self) -> int:
        """Calls of the right-hand side or residual, those for Jacobians included."""
        return self._handed.calls

    def _jacobians(self) -> int:
        """Jacobians since the present start."""
        return self._memory.jacobian_calls()

    def _stretch(self, done: Numbers) -> Stretch:
        """What compiled steps came to, their Jacobians counted.

        Raises
        ------
        StandstillError
            Where the solver could not go on.
        """
        flag, row, start, end, verdict, reached, steps = done
        stretch = Stretch(row, start, end, verdict, reached, steps)
        spent = self._jacobians()
        self.jacobian_calls += spent - self._spent
        self._spent = spent
        if flag < 0:
            raise could_not_continue(self.name, self.messages[flag], self._forcing.start, stretch)
        return stretch
