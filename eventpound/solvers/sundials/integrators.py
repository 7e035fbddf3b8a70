"""Duties of an integrator that CVODE and IDA do alike.

Compiled code calls them (`Direct`), or scikit-sundae's Python interface where the library is
out of reach (`eventpound.solvers.sundials.wrapped`); what they ask in return is in
`eventpound.solvers.events.integrator`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from eventpound.mechanics.descriptor_motion import DescriptorProblem
from eventpound.mechanics.model import Model
from eventpound.mechanics.observables import blank_observed
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.by_address import change_group, with_address
from eventpound.numerics.compiled import foresee
from eventpound.solvers.events.dense import NO_GAPS, Dense
from eventpound.solvers.events.integrator import Bounds, StandstillError, Start, StepsTaken
from eventpound.solvers.events.modes import Mode
from eventpound.solvers.events.step_check import Examination
from eventpound.solvers.sundials.callback_data import NO_ROOTS, RootFunctions, SegmentData
from eventpound.solvers.sundials.descriptor_modes import DescriptorMode, DescriptorModes
from eventpound.solvers.sundials.descriptor_steps import begin_descriptor
from eventpound.solvers.sundials.loop import AtRoot, Numbers, Steps, steps_to_roots


class Duties:
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
        self._calls = np.zeros(2, np.int64)
        self._mode: Mode
        self._segment: SegmentData
        self._roots: RootFunctions | None = None

    @property
    def rhs_calls(self) -> int:
        """Calls of the right-hand side or residual, those for Jacobians included."""
        return int(self._calls[0])

    @property
    def jacobian_calls(self) -> int:
        """Jacobians, of which compiled steps keep count."""
        return int(self._calls[1])

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
        mode = self._mode = start.mode
        mode.directed.direction[:] = 0.0
        if self._roots is not None:
            self._roots.point_to(mode)
        self._segment = self._segment_of(start)
        self._begin(start.tau, start.y, start.atol)
        self.starts += 1

    def _segment_of(self, start: Start) -> SegmentData:
        mode, forcing, frame, *_ = start
        roots = NO_ROOTS if self._roots is None else self._roots.present
        return SegmentData(self._calls, mode.directed, mode.bodies, forcing, frame, roots)

    def foresee(self, start: Start, e: Examination) -> None:
        """Have the loop of `advance` compiled meanwhile, where it is to be."""

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
                self._segment.forcing.start + taken.start,
                taken,
            )
        return taken


class Direct(Duties):
    """What compiled calls of CVODE and IDA have in common.

    Attributes
    ----------
    _kernels : tuple of callable
        Of the handles: `carry_on`, `root_at`, and the coefficients of SUNDIALS' polynomial of the
        last step about a local time (s).
    _handles_of : callable
        Handles of a start, without a SUNDIALS object.
    """

    _kernels: tuple[Callable[..., Numbers], Callable[..., tuple[int, float]], Callable[..., Floats]]
    _handles: Any
    _handles_of: Callable[[Start], Any]

    def __init__(self) -> None:
        super().__init__()
        self._given: Any = None
        self._memories: dict[Any, Any] = {}

    def _hand(self, given: Any) -> None:
        """Let the callbacks be handed this, always at the same address."""
        if self._given is None:
            self._given = with_address(given)
        else:
            change_group(self._given, given)

    def foresee(self, start: Start, e: Examination) -> None:
        """Have the loop of `advance` compiled meanwhile."""
        bounds = Bounds(0.0, False, 0.0, 0)
        foresee(self._kernels[0], self._handles_of(start), 0.0, 0, 0.0, bounds, e)

    def dense(self, start: float, end: float) -> Dense:
        """The last step on SUNDIALS' own polynomial, as the loop knows it."""
        coefficients = self._kernels[2](self._handles, end)
        return Dense(coefficients, end, start, end, self._segment.frame, False, NO_GAPS)

    def _steps(self, *of: Any) -> Numbers:
        return self._kernels[0](self._handles, *of)

    def _at_root(self, *of: Any) -> tuple[int, float]:
        return self._kernels[1](self._handles, *of)


class InDescriptorForm(Duties):
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

    def start(self, start: Start) -> None:
        """Begin with the clusters in the state given; the tolerances are those of the run."""
        self._own, self._problem = self._modes.of(start.mode), self._problem_of(start)
        super().start(start)

    def _problem_of(self, start: Start) -> DescriptorProblem:
        form = self._modes.of(start.mode).descriptor
        return with_address(DescriptorProblem(form, start.forcing, start.frame, self.drift))

    def _first_step(self, tau: float, state: Floats, y: Floats, rate: Floats) -> float:
        """Fill in unknowns and rates of a start, from the loop's state; how long to step (s)."""
        tolerances = self._own.local_tolerances(self._segment.frame)
        given = self._problem, self._mode.dynamics, tolerances, self.scales.time, self._scratch
        return begin_descriptor(tau, state, y, rate, *given)

    def advance(
        self, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
    ) -> StepsTaken:
        """Accepted steps up to the first that is not clear or the bounds, none beyond a sample."""
        return super().advance(tau, first, excess, bounds._replace(at_samples=True), e)
