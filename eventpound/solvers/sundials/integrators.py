"""Duties of an integrator that CVODE and IDA do alike.

Compiled code calls them (`Direct`), or scikit-sundae's Python interface where the library is
out of reach (`Wrapped`); what they ask in return is in `eventpound.solvers.events.integrator`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from eventpound.mechanics.descriptor_motion import DescriptorProblem
from eventpound.mechanics.ground_frame import NO_FRAME
from eventpound.mechanics.model import Model
from eventpound.mechanics.observables import blank_observed
from eventpound.mechanics.reduced import Forcing
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.by_address import change_group, with_address
from eventpound.numerics.compiled import in_python
from eventpound.solvers.events.dense import NO_GAPS, NODES, Dense, from_values
from eventpound.solvers.events.integrator import Bounds, StandstillError, Start, StepsTaken
from eventpound.solvers.events.modes import Mode
from eventpound.solvers.events.recorder import is_due
from eventpound.solvers.events.step_check import CLEAR, MARKED, Examination
from eventpound.solvers.sundials.callback_data import NO_ROOTS, RootFunctions, Roots
from eventpound.solvers.sundials.descriptor_modes import DescriptorMode, DescriptorModes
from eventpound.solvers.sundials.descriptor_steps import Followed
from eventpound.solvers.sundials.loop import (
    ROOT_RETURN,
    AtRoot,
    Numbers,
    Steps,
    carry_on,
    root_at,
    steps_to_roots,
)

_FAILED = -1


class _Duties:
    """An `eventpound.solvers.events.integrator.Integrator`, but for the calls of the library.

    Attributes
    ----------
    name : str
        What SUNDIALS calls the solver.
    _begin, _meaning, _steps, _at_root : callable
        `start` in the present mode; what a negative flag of the library means; `carry_on`;
        `root_at`.
    """

    name: str
    _begin: Callable[[float, Floats, Floats], None]
    _meaning: Callable[[int], str]
    _steps: Steps
    _at_root: AtRoot

    def __init__(self) -> None:
        self.starts = 0
        self._mode: Mode
        self._forcing: Forcing
        self._frame = NO_FRAME
        self._roots: RootFunctions | None = None

    @property
    def finds_events(self) -> bool:
        """Whether its own root finder does."""
        return self._roots is not None

    @property
    def located(self) -> tuple[Bools, Bools, Bools] | None:
        """What its root finder has found at the end of the last step."""
        return self._roots.located() if self._roots is not None else None

    def find_events(self, model: Model, length: float, time: float) -> None:
        """Let its own root finder find events, for the whole run."""
        self._roots = RootFunctions(model, length, time)

    def start(self, start: Start) -> None:
        """Begin at the local time `tau` (s) with state `y`."""
        mode, forcing, frame, y, atol, tau = start
        self._mode, self._forcing, self._frame = mode, forcing, frame
        if self._roots is not None:
            self._roots.point_to(mode)
        self._begin(tau, y, atol)
        self.starts += 1

    def advance(
        self, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
    ) -> StepsTaken:
        """Accepted steps, up to the first that is not clear or the bounds.

        Raises
        ------
        StandstillError
            Where the solver could not go on.
        """
        done = steps_to_roots(self._steps, self._at_root, tau, first, excess, bounds, e)
        flag, taken = done[0], StepsTaken(*done[1:])
        if flag < 0:
            raise StandstillError(
                f"{self.name} could not continue ({self._meaning(flag).rstrip('.')}); "
                "try a larger rtol, or look at the state written so far",
                self._forcing.start + taken.start,
                taken,
            )
        return taken


class Direct(_Duties):
    """What compiled calls of CVODE and IDA have in common.

    Attributes
    ----------
    _kernels : tuple of callable
        Of the handles: `carry_on`, `root_at`, and the coefficients of SUNDIALS' polynomial of the
        last step about a local time (s).
    """

    _kernels: tuple[Callable[..., Numbers], Callable[..., tuple[int, float]], Callable[..., Floats]]
    _handles: Any

    def __init__(self) -> None:
        super().__init__()
        self._calls = np.zeros(2, np.int64)
        self._given: Any = None
        self._memories: dict[Any, Any] = {}

    def _hand(self, given: Any) -> None:
        """Let the callbacks be handed this, always at the same address."""
        if self._given is None:
            self._given = with_address(given)
        else:
            change_group(self._given, given)

    @property
    def _present_roots(self) -> Roots:
        return NO_ROOTS if self._roots is None else self._roots.present

    @property
    def rhs_calls(self) -> int:
        """Calls of the right-hand side or residual, those for Jacobians included."""
        return int(self._calls[0])

    @property
    def jacobian_calls(self) -> int:
        """Jacobians, of which compiled steps keep count."""
        return int(self._calls[1])

    def dense(self, start: float, end: float) -> Dense:
        """The last step on SUNDIALS' own polynomial, as the loop knows it."""
        coefficients = self._kernels[2](self._handles, end)
        return Dense(coefficients, end, start, end, self._frame, False, NO_GAPS)

    def _steps(self, *of: Any) -> Numbers:
        return self._kernels[0](self._handles, *of)

    def _at_root(self, *of: Any) -> tuple[int, float]:
        return self._kernels[1](self._handles, *of)


class Wrapped(_Duties):
    """What CVODE and IDA have in common through scikit-sundae.

    Where its own root finder finds events, each start is one of a new object: scikit-sundae keeps
    the log of roots on the function that it is given, for good.

    Attributes
    ----------
    _values : callable
        Fills an array with the root functions of unknowns, which are overwritten.
    _relative : callable
        Unknowns at a local time (s), relative to the ground, in their place.
    _examine, _take, _put_inner : callable
        The examination of a step; of `carry_on` and of `root_at`.
    """

    _values: Callable[[float, Floats, Floats], None]
    _relative: Callable[[float, Floats], Floats]
    _examine: Callable[[float, float, int, float, Examination], tuple[int, float]]
    _take: Callable[..., tuple[int, float]]
    _put_inner: Callable[..., None]

    def __init__(self) -> None:
        super().__init__()
        self.rhs_calls = 0
        self.jacobian_calls = 0
        self._present: Any = None
        self._time = 0.0
        self._has_interpolated = False
        self._spent = 0
        # Functions where the last step was left, and the end of SUNDIALS' whole step.
        self._left = np.empty(0)
        self._whole = 0.0
        self._failure = ""

    def _meaning(self, flag: int) -> str:
        return self._failure

    def _begun_at(self, tau: float) -> None:
        """The present object has been started at the local time `tau` (s)."""
        self._time = tau
        self._has_interpolated = False
        self._spent = 0
        self._whole = -np.inf

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
        if self._has_interpolated:
            out[:] = self._left
            return
        self._values(tau, y.copy(), out)
        self._whole = max(self._whole, tau)

    def _interpolated(self, tau: float) -> Floats:
        """The unknowns at the local time `tau` (s) of the last step."""
        self._has_interpolated = True
        y: Floats = self._present.step(tau, "normal").y
        return y

    def _step(self, stop: float) -> tuple[int, float, Floats]:
        """One accepted step, not beyond `stop` (s): a flag, time reached and unknowns there."""
        repeats, self._has_interpolated = self._has_interpolated, False
        result = self._present.step(stop, "onestep", stop)
        if repeats and result.success and result.t == self._time:
            # After interpolating, SUNDIALS first hands out the end of its last step again.
            result = self._present.step(stop, "onestep", stop)
        if not result.success:
            self._failure = result.message
            return _FAILED, self._time, result.y
        self._time = result.t
        self.jacobian_calls += result.njev - self._spent
        self._spent = result.njev
        if self._left.size:
            self._values(result.t, result.y.copy(), self._left)
        flag = ROOT_RETURN if result.status == ROOT_RETURN else 0
        return flag, result.t, self._relative(result.t, result.y)

    def _steps(
        self, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
    ) -> Numbers:
        """One step."""
        own = type(self)
        one = bounds._replace(most=1)
        return in_python(carry_on)(own._take, own._check, None, self, tau, first, excess, one, e)

    def _check(
        self, start: float, end: float, first: int, allowed: float, e: Examination
    ) -> tuple[int, float]:
        """Of `carry_on`: a step with output times in it is left to a search."""
        verdict, excess = self._examine(start, end, first, allowed, e)
        due = in_python(is_due)(e.forcing.start + end, e.record.journal)
        return MARKED if verdict == CLEAR and due else verdict, excess

    def _at_root(
        self, start: float, tau: float, first: int, excess: float, e: Examination
    ) -> tuple[int, float]:
        """`root_at`, where the last step was left."""
        own = type(self)
        return in_python(root_at)(
            own._values_left, own._whole_end, own._put_inner, self, start, tau, first, excess, e
        )

    def _values_left(self, tau: float) -> Roots:
        """Of `root_at`."""
        assert self._roots is not None
        roots = self._roots.present
        roots.pairs[:] = self._left.reshape(-1, 2)
        return roots

    def _whole_end(self) -> float:
        """Of `root_at`."""
        return self._whole

    def dense(self, start: float, end: float) -> Dense:
        """The last step on SUNDIALS' own polynomial, from its values."""
        values = np.empty((NODES.size, self._mode.system.size))
        for node, y in zip(NODES, values, strict=True):
            self._put_inner(end - (end - start) * node, 0, y)
        return from_values(values, start, end, self._frame)


class InDescriptorForm(_Duties):
    """What IDA's two ways have in common.

    Parameters
    ----------
    modes : DescriptorModes
        The forms that the scene takes.

    Attributes
    ----------
    drift : ndarray, shape (2,)
        Largest gap (m) and gap rate (m/s) of a resting contact at the end of any step, as IDA
        left them.
    """

    name = "IDA"

    def __init__(self, modes: DescriptorModes) -> None:
        super().__init__()
        self.scales, self.drift = modes.scales, np.zeros(2)
        self._modes = modes
        self._scratch = with_address(blank_observed(*modes.model.counts))
        self._own: DescriptorMode
        self._problem: DescriptorProblem
        self._followed: Followed

    def start(self, start: Start) -> None:
        """Begin with the clusters in the state given; the tolerances are those of the run."""
        self._own = own = self._modes.of(start.mode)
        self._problem = with_address(DescriptorProblem(own.descriptor, start.forcing, start.frame))
        self._followed = with_address(Followed(self._problem, self.drift, self.scales.acceleration))
        super().start(start)

    def advance(
        self, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
    ) -> StepsTaken:
        """Accepted steps up to the first that is not clear or the bounds, none beyond a sample."""
        return super().advance(tau, first, excess, bounds._replace(at_samples=True), e)
