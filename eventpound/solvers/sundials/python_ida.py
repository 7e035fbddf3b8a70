"""IDA through scikit-sundae's own interface, one step a call.

For platforms where the library cannot be reached from compiled code: the same
equations and tolerances, at some ten times the cost. Not everything that
`eventpound.solvers.sundials.memory` tells IDA can be told it here:

* contact forces are left out of the error test by tolerances that they meet anyhow; the dependent
  bodies stay in it, as Newton's iteration must not leave them out;
* without a matrix for each leading coefficient that iteration leaves gaps and gap rates
  open by a part of a step's tolerance, and every state is put on its constraints before
  anyone sees it;
* the length of a first step belongs to an object: each start makes a new one;
* a step may be shortened ten times, not forty.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from eventpound.mechanics.descriptor_motion import (
    constraint_errors,
    jacobian,
    onto_constraints,
    residual,
    solve_contact_forces,
    to_moving_frame,
)
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import in_python
from eventpound.solvers.events.integrator import Bounds, last_time
from eventpound.solvers.events.step_check import Examination
from eventpound.solvers.sundials.descriptor_steps import (
    begin_descriptor,
    examine_descriptor,
    from_clusters,
    to_clusters,
)
from eventpound.solvers.sundials.integrators import InDescriptorForm, Wrapped
from eventpound.solvers.sundials.memory import MOST_FAILURES, MOST_STEPS
from eventpound.solvers.sundials.root_values import descriptor_roots
from eventpound.tolerances import LEFT_OUT


class WrappedIda(InDescriptorForm, Wrapped):
    """An `eventpound.solvers.events.integrator.Integrator`."""

    def _residual(self, tau: float, y: Floats, rate: Floats, out: Floats) -> None:
        self.rhs_calls += 1
        residual(tau, y, rate, out, self._problem)

    def _jacobian(
        self, tau: float, y: Floats, rate: Floats, out: Floats, cj: float, J: Floats
    ) -> None:
        jacobian(tau, y, cj, J, self._problem)

    def _begin(self, tau: float, y: Floats, atol: Floats) -> None:
        self._present = self._object(tau, y)
        self._begun_at(tau)

    def _object(self, tau: float, clusters: Floats) -> Any:
        """IDA with the clusters in that state at the local time `tau` (s)."""
        from sksundae.ida import IDA

        def functions(tau: float, y: Floats, rate: Floats, out: Floats) -> None:
            self._functions(tau, y, out)

        own, mode = self._own, self._mode
        d = own.descriptor
        tolerances = own.local_tolerances(self._frame)
        y, rate = np.zeros(d.size), np.zeros(d.size)
        in_python(from_clusters)(clusters, mode.system, mode.bodies, y)
        given = tolerances, self.scales.time, self._scratch
        step = begin_descriptor(tau, y, rate, self._problem, *given)
        first = 2 * d.mass.size + d.hysteretic
        loose = tolerances.atol.copy()
        loose[first : first + d.opening.size] *= LEFT_OUT
        made = IDA(
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
        made.init_step(tau, y, rate)
        return made

    def _values(self, tau: float, y: Floats, out: Floats) -> None:
        assert self._roots is not None
        self._relative(tau, y)
        onto_constraints(self._own.descriptor, y)
        descriptor_roots(tau, y, self._problem, self._roots.present, out)

    def _take(self, start: float, first: int, bounds: Bounds, e: Examination) -> tuple[int, float]:
        """A step from `start` (s)."""
        flag, end, self._reached = self._step(last_time(start, bounds, self._forcing))
        return flag, end

    def _examine(
        self, start: float, end: float, first: int, allowed: float, e: Examination
    ) -> tuple[int, float]:
        d, y = self._own.descriptor, self._reached
        np.maximum(self.drift, constraint_errors(d, y), out=self.drift)
        onto_constraints(d, y)
        solve_contact_forces(end, y, self._problem)
        return examine_descriptor(start, end, first, allowed, y, e, self._followed)

    def _relative(self, tau: float, y: Floats) -> Floats:
        to_moving_frame(self._problem, tau, -1.0, y)
        return y

    def _put_inner(self, tau: float, k: int, clusters: Floats) -> None:
        mode, y = self._mode, self._relative(tau, self._interpolated(tau))
        onto_constraints(self._own.descriptor, y)
        to_moving_frame(self._problem, tau, 1.0, y)
        to_clusters(y, 1.0, mode.system, mode.bodies, clusters)
