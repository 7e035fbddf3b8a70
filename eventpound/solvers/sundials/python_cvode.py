"""CVODE through scikit-sundae's own interface, one step a call.

For platforms where the library cannot be reached from compiled code: the same
steps, at some ten times the cost.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from eventpound.mechanics.ground_frame import NO_FRAME, to_frame
from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.dense import NODES, Dense, from_values
from eventpound.solvers.events.integrator import Bounds, Start, Stretch, last_time
from eventpound.solvers.events.modes import Mode
from eventpound.solvers.events.reversals import (
    NEGLIGIBLE,
    first_reversal,
    may_reverse,
    take_directions,
)
from eventpound.solvers.events.step_check import (
    BEYOND_BOUND,
    CLEAR,
    NOT_FINITE,
    Examination,
    examine,
    rate_at,
)
from eventpound.solvers.sundials.integrators import Wrapped
from eventpound.solvers.sundials.memory import MOST_STEPS, layout


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
        self._mode: Mode
        self._frame = NO_FRAME
        self._arguments: tuple[Any, ...] = ()
        self._directions = np.empty(0)
        self._turned = False

    def _rhs(self, tau: float, y: Floats, rate: Floats) -> None:
        self.rhs_calls += 1
        rate_at(tau, y, rate, *self._arguments)

    def _object(self, atol: Floats) -> Any:
        from sksundae.cvode import CVODE

        plan = layout(self._mode.system, self._frame, self.rtol, atol)
        if plan.key not in self._objects:
            band = plan.band
            solver = {"linsolver": "band", "lband": band, "uband": band} if band else {}
            self._objects[plan.key] = CVODE(
                self._rhs,
                method=self.method,
                rtol=plan.rtol,
                atol=plan.atol,
                max_num_steps=MOST_STEPS,
                **solver,
            )
        return self._objects[plan.key]

    def start(self, start: Start) -> None:
        """Begin at the local time `tau` (s) with state `y`."""
        mode, forcing, frame, y, atol, tau = start
        self._mode, self._forcing, self._frame = mode, forcing, frame
        system = mode.directed
        self._directions = system.direction
        self._directions[:] = 0.0
        self._arguments = system, forcing, frame
        self._present = self._object(atol)
        self._begin(tau, y)
        self.starts += 1

    def _begin(self, tau: float, y: Floats) -> None:
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

    def advance(
        self, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
    ) -> Stretch:
        """One accepted step and its examination."""
        stop, origin = last_time(tau, bounds.at_samples, bounds, self._forcing), e.forcing.start
        system, before = self._mode.system, e.y[first]
        if self._turned:
            self._begin(tau, before)
        take_directions(before, system, self.rtol, self._directions)
        end, after = self._step(stop, first)
        if end <= tau:
            return Stretch(first, tau, end, CLEAR, excess, 0)
        given = system, self._directions
        if may_reverse(before, e.rate[first], after, end - tau, *given, NEGLIGIBLE * self.rtol):
            turned = first_reversal(self.dense(tau, end), end, origin, *given)
            if turned < np.inf:
                end, self._turned = turned, True
                after = self._relative(turned, self._present.step(turned, "normal").y)
        e.y[1 - first] = after
        verdict, excess = examine(tau, end, first, max(e.z_allowed, excess), e)
        accepted = verdict not in (NOT_FINITE, BEYOND_BOUND)
        return Stretch(first, tau, end, verdict, excess, int(accepted))

    def dense(self, start: float, end: float) -> Dense:
        """The last step on CVODE's own polynomial, from its values."""
        self._looked_back = True
        times = end - (end - start) * NODES
        values = np.array([self._present.step(tau, "normal").y for tau in times])
        return from_values(values, start, end, self._frame)
