"""Duties of an integrator that CVODE and IDA do alike.

Compiled code calls them (`Direct`), or scikit-sundae's Python interface where the library is
out of reach (`Wrapped`); what they ask in return is in `eventpound.solvers.events.integrator`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from eventpound.mechanics.model import Model
from eventpound.mechanics.reduced import Forcing
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.lending import change_loan, on_loan
from eventpound.solvers.events.integrator import StandstillError, Stretch
from eventpound.solvers.events.roots import any_fell
from eventpound.solvers.events.step_check import BEYOND_BOUND, CLEAR, HAPPENED
from eventpound.solvers.sundials.callback_data import (
    NO_ROOTS,
    ROOT_RETURN,
    AtRoot,
    RootFunctions,
    Roots,
    Steps,
    first_zero,
    steps_to_roots,
)


def _could_not_continue(
    name: str, message: str, origin: float, stretch: Stretch
) -> StandstillError:
    """The error of an integrator that stands still.

    Parameters
    ----------
    name : str
        Of the integrator.
    message : str
        SUNDIALS' own.
    origin : float
        Time from which the local ones count (s).
    stretch : Stretch
        Its steps.
    """
    return StandstillError(
        f"{name} could not continue ({message.rstrip('.')}); "
        "try a larger rtol, or look at the state written so far",
        origin + stretch.start,
        stretch,
    )


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
        self.starts = 0
        self._calls = np.zeros(2, np.int64)
        self._given: Any = None
        self._forcing: Forcing
        self._roots: RootFunctions | None = None

    def _hand(self, given: Any) -> None:
        """Let the callbacks be handed this, always at the same address."""
        if self._given is None:
            self._given = on_loan(given)
        else:
            change_loan(self._given, given)

    @property
    def _present_roots(self) -> Roots:
        return NO_ROOTS if self._roots is None else self._roots.loan

    @property
    def finds_events(self) -> bool:
        """Whether its own root finder does."""
        return self._roots is not None

    @property
    def happened(self) -> tuple[Bools, Bools, Bools] | None:
        """What its root finder has found at the end of the last step."""
        return self._roots.marks() if self._roots is not None else None

    def find_events(self, model: Model, length: float) -> None:
        """Let its own root finder find events, for the whole run."""
        self._roots = RootFunctions(model, length)

    @property
    def rhs_calls(self) -> int:
        """Calls of the right-hand side or residual, those for Jacobians included."""
        return int(self._calls[0])

    @property
    def jacobian_calls(self) -> int:
        """Jacobians, of which compiled steps keep count."""
        return int(self._calls[1])

    def _stretch_of(self, steps: Steps, at_root: AtRoot, *given: Any) -> Stretch:
        """What compiled steps came to, up to an event where its own root finder finds them.

        `given` are the arguments of `Integrator.advance`; `steps_to_roots` has the others.

        Raises
        ------
        StandstillError
            Where the solver could not go on.
        """
        done = steps(*given) if self._roots is None else steps_to_roots(steps, at_root, *given)
        flag, stretch = done[0], Stretch(*done[1:])
        if flag < 0:
            raise _could_not_continue(self.name, self.messages[flag], self._forcing.start, stretch)
        return stretch


class Wrapped:
    """Duties of an `eventpound.solvers.events.integrator.Integrator` that both do alike.

    Where its own root finder finds events, each start is one of a new object: scikit-sundae keeps
    the log of roots on the function that it is given, for good.

    Attributes
    ----------
    name : str
        What SUNDIALS calls the solver.
    """

    name: str

    def __init__(self) -> None:
        self.rhs_calls = 0
        self.jacobian_calls = 0
        self.starts = 0
        self._forcing: Forcing
        self._present: Any = None
        self._time = 0.0
        self._looked_back = False
        self._spent = 0
        self._roots: RootFunctions | None = None
        self._at_root = False
        # Functions where the last step was left, and the end of SUNDIALS' whole step.
        self._left = np.empty(0)
        self._whole: tuple[float, Floats] = 0.0, self._left

    @property
    def finds_events(self) -> bool:
        """Whether its own root finder does."""
        return self._roots is not None

    @property
    def happened(self) -> tuple[Bools, Bools, Bools] | None:
        """What its root finder has found at the end of the last step."""
        return self._roots.marks() if self._roots is not None else None

    def find_events(self, model: Model, length: float) -> None:
        """Let its own root finder find events, for the whole run."""
        self._roots = RootFunctions(model, length)

    def _begun_at(self, tau: float) -> None:
        """The present object has been started at the local time `tau` (s)."""
        self._time = tau
        self._looked_back = self._at_root = False
        self._spent = 0
        self._whole = -np.inf, self._left

    def _root_options(self, functions: Any) -> dict[str, Any]:
        """What an object is made with to look for roots; `functions` are its own."""
        self._left = np.empty(0)
        if self._roots is None or self._roots.count == 0:
            return {}
        functions.direction = self._roots.directions
        functions.terminal = [True] * len(functions.direction)
        self._left = np.ones(len(functions.direction))
        return {"eventsfn": functions, "num_events": len(functions.direction)}

    def _functions(self, tau: float, y: Floats, out: Floats) -> None:
        """What SUNDIALS is told of its unknowns, which it asks for first at the end of a step.

        While it interpolates within its last step it would look for roots there, too: nothing has
        changed then.
        """
        if self._looked_back:
            out[:] = self._left
            return
        self._values(tau, y.copy(), out)
        if tau > self._whole[0]:
            self._whole = tau, y.copy()

    def _values(self, tau: float, y: Floats, out: Floats) -> None:
        """Fill `out` with the root functions of unknowns, which are overwritten."""
        raise NotImplementedError

    def _relative(self, tau: float, y: Floats) -> Floats:
        """The unknowns relative to the ground, in their place."""
        raise NotImplementedError

    def _interpolated(self, tau: float) -> Floats:
        """The unknowns at the local time `tau` (s) of the last step."""
        self._looked_back = True
        y: Floats = self._present.step(tau, "normal").y
        return y

    def _step(self, stop: float, first: int) -> tuple[float, Floats]:
        """One accepted step, not beyond `stop` (s): time reached and unknowns there.

        `first` is the row of the state it starts from.
        """
        repeats, self._looked_back = self._looked_back, False
        result = self._present.step(stop, "onestep", stop)
        if repeats and result.success and result.t == self._time:
            # After interpolating, SUNDIALS first hands out the end of its last step again.
            result = self._present.step(stop, "onestep", stop)
        if not result.success:
            stretch = Stretch(first, self._time, self._time, CLEAR, 0.0, 0)
            raise _could_not_continue(self.name, result.message, self._forcing.start, stretch)
        self._time = result.t
        self._at_root = result.status == ROOT_RETURN
        self.jacobian_calls += result.njev - self._spent
        self._spent = result.njev
        if self._left.size:
            self._values(result.t, result.y.copy(), self._left)
        return result.t, self._relative(result.t, result.y)

    def _what_root(
        self, start: float, tau: float, bound: Floats, allowed: float, clusters: Floats
    ) -> tuple[int, float]:
        """`eventpound.solvers.sundials.stepping.at_root`, where the last step was left."""
        assert self._roots is not None
        roots = self._roots.loan
        roots.pairs[:] = self._left.reshape(-1, 2)
        if not any_fell(roots.pairs):
            return CLEAR, tau
        whole, last = self._whole
        if (np.abs(self._z_of(last)) - bound > allowed).any():
            return BEYOND_BOUND, whole
        end = first_zero(roots, start, tau, whole)
        clusters[:] = self._clusters(end, self._relative(end, self._interpolated(end)))
        return HAPPENED, end

    def _z_of(self, y: Floats) -> Floats:
        """Every z, (H,), of unknowns; zero for those that they leave out."""
        raise NotImplementedError

    def _clusters(self, tau: float, y: Floats) -> Floats:
        """The state of the clusters of unknowns, both relative to the ground."""
        raise NotImplementedError
