"""CVODE and IDA through scikit-sundae's own interface, one step a call.

For platforms where the library cannot be reached from compiled code: the same equations,
tolerances and loop, at some ten times the cost.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from eventpound.mechanics.descriptor_motion import jacobian
from eventpound.mechanics.ground_frame import to_frame
from eventpound.numerics.arrays import Floats
from eventpound.numerics.by_address import with_address
from eventpound.numerics.compiled import in_python
from eventpound.solvers.events.dense import NODES, Dense, from_values
from eventpound.solvers.events.integrator import Bounds, last_time
from eventpound.solvers.events.recorder import is_due
from eventpound.solvers.events.reversals import take_directions
from eventpound.solvers.events.step_check import CLEAR, MARKED, Examination, examine, rate_at
from eventpound.solvers.sundials.callback_data import Roots, put_roots
from eventpound.solvers.sundials.descriptor_steps import (
    examine_descriptor,
    full_residual,
    to_clusters,
)
from eventpound.solvers.sundials.integrators import Duties, InDescriptorForm
from eventpound.solvers.sundials.loop import (
    ROOT_RETURN,
    Numbers,
    carry_on,
    put_state,
    reversal_in,
    root_at,
)
from eventpound.solvers.sundials.memory import MOST_FAILURES, MOST_STEPS, layout
from eventpound.tolerances import LEFT_OUT

_FAILED = -1


class Wrapped(Duties):
    """What CVODE and IDA have in common through scikit-sundae.

    Each start is one of a new object: scikit-sundae keeps the log of roots on the function that it
    is given, for good, and the length of a first step belongs to an object.

    Attributes
    ----------
    _state_of : callable
        The loop's state, in the frame, of SUNDIALS' unknowns.
    _examine, _take : callable
        The examination of a step; of `carry_on`.
    """

    _state_of: Callable[[Floats], Floats]
    _examine: Callable[[float, float, int, float, Examination], tuple[int, float]]
    _take: Callable[..., tuple[int, float]]

    def __init__(self) -> None:
        super().__init__()
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
        return {"eventsfn": functions, "num_events": self._left.size}

    def _functions(self, tau: float, y: Floats, out: Floats) -> None:
        """What SUNDIALS is told of its unknowns, which it asks for first at the end of a step.

        While it interpolates within its last step it would look for roots there, too: nothing has
        changed then.
        """
        if self._has_interpolated:
            out[:] = self._left
            return
        self._values(tau, y, out)
        self._whole = max(self._whole, tau)

    def _values(self, tau: float, y: Floats, out: Floats) -> None:
        """The root functions of SUNDIALS' unknowns."""
        put_roots(tau, self._state_of(y), with_address(self._segment), out)

    def _interpolated(self, tau: float) -> Floats:
        """The unknowns at the local time `tau` (s) of the last step."""
        self._has_interpolated = True
        y: Floats = self._present.step(tau, "normal").y
        return y

    def _step(self, stop: float) -> tuple[int, float, Floats]:
        """One accepted step, not beyond `stop` (s): a flag, time reached, and unknowns there."""
        repeats, self._has_interpolated = self._has_interpolated, False
        result = self._present.step(stop, "onestep", stop)
        if repeats and result.success and result.t == self._time:
            # After interpolating, SUNDIALS first hands out the end of its last step again.
            result = self._present.step(stop, "onestep", stop)
        if not result.success:
            self._failure = result.message
            return _FAILED, self._time, result.y
        self._time = result.t
        self._calls[1] += result.njev - self._spent
        self._spent = result.njev
        if self._left.size:
            self._values(result.t, result.y, self._left)
        flag = ROOT_RETURN if result.status == ROOT_RETURN else 0
        return flag, result.t, result.y

    def _put_inner(self, tau: float, k: int, y: Floats) -> None:
        """Of `carry_on` and of `root_at`."""
        y[:] = self._state_of(self._interpolated(tau))

    def _steps(
        self, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
    ) -> Numbers:
        """One step."""
        own = type(self)
        one, steps = bounds._replace(most=1), (own._take, own._check, None)
        return in_python(carry_on)(*steps, self, tau, first, excess, one, e)

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
        return from_values(values, start, end, self._segment.frame)


class WrappedCvode(Wrapped):
    """An `eventpound.solvers.events.integrator.Integrator`.

    Parameters
    ----------
    rtol : float
        Relative tolerance of the motion.
    method : str
        ``"Adams"`` or ``"BDF"``.
    """

    name = "CVODE"

    def __init__(self, rtol: float, method: str) -> None:
        super().__init__()
        self.rtol = rtol
        self.method = method
        self._turned = False

    def _state_of(self, y: Floats) -> Floats:
        return y.copy()

    def _rhs(self, tau: float, y: Floats, rate: Floats) -> None:
        self._calls[0] += 1
        rate_at(tau, y, rate, self._segment.system, self._segment.forcing, self._segment.frame)

    def _begin(self, tau: float, y: Floats, atol: Floats) -> None:
        from sksundae.cvode import CVODE

        def functions(tau: float, y: Floats, out: Floats) -> None:
            self._functions(tau, y, out)

        plan = layout(self._mode.system, self._segment.frame, self.rtol, atol)
        band = {"linsolver": "band", "lband": plan.band, "uband": plan.band} if plan.band else {}
        self._present = CVODE(
            self._rhs,
            method=self.method,
            rtol=plan.rtol,
            atol=plan.atol,
            max_num_steps=MOST_STEPS,
            **band,
            **self._root_options(functions),
        )
        # The first step begins anew.
        self._turned = True

    def _begin_anew(self, tau: float, y: Floats) -> None:
        """Begin at the local time `tau` (s) without a past."""
        system, segment, inner = self._mode.system, self._segment, y.copy()
        to_frame(segment.frame, segment.forcing.start + tau, 1.0, system.iq, system.iv, inner)
        self._present.init_step(tau, inner)
        self._begun_at(tau)
        self._turned = False

    def _put_reached(self, tau: float, k: int, y: Floats) -> None:
        y[:] = self._reached

    def _take(self, start: float, first: int, bounds: Bounds, e: Examination) -> tuple[int, float]:
        """A step from `start` (s) up to where a link reverses."""
        before = e.y[first]
        if self._turned:
            self._begin_anew(start, before)
        own, direction, after = type(self), self._segment.system.direction, e.y[1 - first]
        take_directions(before, self._mode.system, self.rtol, direction)
        flag, end, self._reached = self._step(last_time(start, bounds, e.forcing))
        if flag < 0 or end <= start:
            return flag, end
        in_python(put_state)(own._put_reached, self, end, e, after)
        turned = in_python(reversal_in)(
            own.dense, self, start, end, first, flag, self.rtol, direction, e
        )
        if turned < np.inf:
            self._turned = True
            in_python(put_state)(own._put_inner, self, turned, e, after)
            return 0, turned
        return flag, end

    def _examine(
        self, start: float, end: float, first: int, allowed: float, e: Examination
    ) -> tuple[int, float]:
        return examine(start, end, first, allowed, e)


class WrappedIda(InDescriptorForm, Wrapped):
    """An `eventpound.solvers.events.integrator.Integrator`.

    Not everything that `eventpound.solvers.sundials.memory` tells IDA can be told it here:

    * contact forces are left out of the error test by tolerances that they meet anyhow; the
      dependent bodies stay in it, as Newton's iteration must not leave them out;
    * without a matrix for each leading coefficient that iteration leaves gaps and gap rates
      open by a part of a step's tolerance;
    * a step may be shortened ten times, not forty.
    """

    def _state_of(self, y: Floats) -> Floats:
        state = np.empty(self._mode.system.size)
        to_clusters(y, 1.0, self._mode.system, self._mode.bodies, state)
        return state

    def _residual(self, tau: float, y: Floats, rate: Floats, out: Floats) -> None:
        self._calls[0] += 1
        full_residual(tau, y, rate, out, self._problem, self._mode.dynamics)

    def _jacobian(
        self, tau: float, y: Floats, rate: Floats, out: Floats, cj: float, J: Floats
    ) -> None:
        jacobian(tau, y, cj, J, self._problem)

    def _begin(self, tau: float, state: Floats, atol: Floats) -> None:
        from sksundae.ida import IDA

        def functions(tau: float, y: Floats, rate: Floats, out: Floats) -> None:
            self._functions(tau, y, out)

        own, d = self._own, self._own.descriptor
        tolerances = own.local_tolerances(self._segment.frame)
        y, rate = np.zeros(d.size), np.zeros(d.size)
        step = self._first_step(tau, state, y, rate)
        first = 2 * d.mass.size + d.hysteretic
        loose = tolerances.atol.copy()
        loose[first : first + d.opening.size] *= LEFT_OUT
        self._present = IDA(
            self._residual,
            jacfn=self._jacobian,
            rtol=tolerances.rtol,
            atol=loose,
            algebraic_idx=np.flatnonzero(own.algebraic),
            first_step=step,
            max_num_steps=MOST_STEPS,
            max_conv_fails=MOST_FAILURES,
            **self._root_options(functions),
        )
        self._present.init_step(tau, y, rate)
        self._begun_at(tau)

    def _take(self, start: float, first: int, bounds: Bounds, e: Examination) -> tuple[int, float]:
        """A step from `start` (s)."""
        flag, end, self._reached = self._step(last_time(start, bounds, e.forcing))
        return flag, end

    def _examine(
        self, start: float, end: float, first: int, allowed: float, e: Examination
    ) -> tuple[int, float]:
        return examine_descriptor(start, end, first, allowed, self._reached, self._problem, e)
