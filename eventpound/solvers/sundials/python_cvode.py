"""CVODE through scikit-sundae's own interface, one step a call.

For platforms where the library cannot be reached from compiled code: the same
steps, at some ten times the cost.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from eventpound.mechanics.ground_frame import to_frame
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import in_python
from eventpound.solvers.events.integrator import Bounds, last_time
from eventpound.solvers.events.reversals import take_directions
from eventpound.solvers.events.step_check import Examination, examine, rate_at
from eventpound.solvers.sundials.integrators import Wrapped
from eventpound.solvers.sundials.loop import put_state, reversal_in
from eventpound.solvers.sundials.memory import MOST_STEPS, layout
from eventpound.solvers.sundials.root_values import cluster_roots


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
        self._objects: dict[Any, Any] = {}
        self._arguments: tuple[Any, ...] = ()
        self._directions = np.empty(0)
        self._turned = False

    def _rhs(self, tau: float, y: Floats, rate: Floats) -> None:
        self.rhs_calls += 1
        rate_at(tau, y, rate, *self._arguments)

    def _object(self, atol: Floats) -> Any:
        from sksundae.cvode import CVODE

        def functions(tau: float, y: Floats, out: Floats) -> None:
            self._functions(tau, y, out)

        plan = layout(self._mode.system, self._frame, self.rtol, atol)
        if plan.key not in self._objects or self.finds_events:
            band = plan.band
            solver = {"linsolver": "band", "lband": band, "uband": band} if band else {}
            self._objects[plan.key] = CVODE(
                self._rhs,
                method=self.method,
                rtol=plan.rtol,
                atol=plan.atol,
                max_num_steps=MOST_STEPS,
                **solver,
                **self._root_options(functions),
            )
        return self._objects[plan.key]

    def _begin(self, tau: float, y: Floats, atol: Floats) -> None:
        system = self._mode.directed
        self._directions = system.direction
        self._directions[:] = 0.0
        self._arguments = system, self._forcing, self._frame
        self._present = self._object(atol)
        # The first step begins anew.
        self._turned = True

    def _begin_anew(self, tau: float, y: Floats) -> None:
        """Begin at the local time `tau` (s) without a past."""
        system, inner = self._mode.system, y.copy()
        to_frame(self._frame, self._forcing.start + tau, 1.0, system.iq, system.iv, inner)
        self._present.init_step(tau, inner)
        self._begun_at(tau)
        self._turned = False

    def _relative(self, tau: float, y: Floats) -> Floats:
        if self._frame.shape[1] > 0:
            system = self._mode.system
            to_frame(self._frame, self._forcing.start + tau, -1.0, system.iq, system.iv, y)
        return y

    def _values(self, tau: float, y: Floats, out: Floats) -> None:
        system, bodies = self._mode.directed, self._mode.bodies
        assert self._roots is not None
        self._relative(tau, y)
        cluster_roots(tau, y, system, bodies, self._forcing, self._roots.present, out)

    def _put_inner(self, tau: float, k: int, y: Floats) -> None:
        y[:] = self._interpolated(tau)

    def _take(self, start: float, first: int, bounds: Bounds, e: Examination) -> tuple[int, float]:
        """A step from `start` (s) up to where a link reverses."""
        before = e.y[first]
        if self._turned:
            self._begin_anew(start, before)
        take_directions(before, self._mode.system, self.rtol, self._directions)
        flag, end, after = self._step(last_time(start, bounds, self._forcing))
        if flag < 0 or end <= start:
            return flag, end
        e.y[1 - first] = after
        turned = in_python(reversal_in)(
            type(self).dense, self, start, end, first, flag, self.rtol, self._directions, e
        )
        if turned < np.inf:
            self._turned = True
            in_python(put_state)(type(self)._put_inner, self, turned, e, e.y[1 - first])
            return 0, turned
        return flag, end

    def _examine(
        self, start: float, end: float, first: int, allowed: float, e: Examination
    ) -> tuple[int, float]:
        return examine(start, end, first, allowed, e)
