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
    Problem,
    constraint_errors,
    jacobian,
    onto_constraints,
    residual,
    solve_contact_forces,
    to_moving_frame,
)
from eventpound.mechanics.ground_frame import NO_FRAME
from eventpound.mechanics.observables import blank
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import in_python
from eventpound.numerics.lending import on_loan
from eventpound.solvers.events.dense import NODES, Dense, from_values
from eventpound.solvers.events.integrator import Bounds, Start, Stretch, last_time
from eventpound.solvers.events.modes import Mode
from eventpound.solvers.events.step_check import BEYOND_BOUND, CLEAR, NOT_FINITE, Examination
from eventpound.solvers.sundials.callback_data import ROOT_RETURN, Numbers, steps_to_roots
from eventpound.solvers.sundials.descriptor_modes import DescriptorMode, DescriptorModes
from eventpound.solvers.sundials.descriptor_steps import (
    Followed,
    begin_descriptor,
    examine_descriptor,
    from_clusters,
    look_at_start,
    to_clusters,
)
from eventpound.solvers.sundials.integrators import Wrapped
from eventpound.solvers.sundials.memory import MOST_FAILURES, MOST_STEPS
from eventpound.solvers.sundials.root_values import descriptor_roots
from eventpound.tolerances import LEFT_OUT


class WrappedIda(Wrapped):
    """An `eventpound.solvers.events.integrator.Integrator`.

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
        model, self.scales = modes.model, modes.scales
        self.drift = np.zeros(2)
        self._modes = modes
        self._scratch = on_loan(blank(*model.counts))
        self._mode: Mode
        self._own: DescriptorMode
        self._problem: Problem
        self._frame = NO_FRAME
        self._begun: float | None = None

    def _residual(self, tau: float, y: Floats, rate: Floats, out: Floats) -> None:
        self.rhs_calls += 1
        residual(tau, y, rate, out, self._problem)

    def _jacobian(
        self, tau: float, y: Floats, rate: Floats, out: Floats, cj: float, J: Floats
    ) -> None:
        jacobian(tau, y, cj, J, self._problem)

    def start(self, start: Start) -> None:
        """Begin with the clusters in the state given; the tolerances are those of the run."""
        mode, forcing, frame, y, _, tau = start
        self._mode, self._forcing, self._frame = mode, forcing, frame
        self._own = self._modes.of(mode)
        if self._roots is not None:
            self._roots.point_to(mode)
        self._present = self._object(tau, y)
        self.starts += 1
        self._begun = tau
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
        problem = self._problem = on_loan(Problem(d, self._forcing, self._frame))
        step = begin_descriptor(tau, y, rate, problem, tolerances, self.scales.time, self._scratch)
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
        descriptor_roots(tau, y, self._problem, self._roots.loan, out)

    def _z_of(self, y: Floats) -> Floats:
        first = 2 * self._own.descriptor.mass.size
        return y[first : first + self.scales.z_bound.size]

    def _clusters(self, tau: float, y: Floats) -> Floats:
        mode = self._mode
        onto_constraints(self._own.descriptor, y)
        clusters = np.empty(mode.system.size)
        to_clusters(y, 1.0, mode.system, mode.bodies, clusters)
        return clusters

    def advance(
        self, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
    ) -> Stretch:
        """One accepted step and its examination; none goes beyond a sample of a record."""
        return Stretch(
            *steps_to_roots(self._advance, self._what_root, tau, first, excess, bounds, e)[1:]
        )

    def _advance(
        self, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
    ) -> Numbers:
        """The step, or its part up to a root."""
        mode, d = self._mode, self._own.descriptor
        if self._begun == tau:
            # The loop has looked at the start of the segment by the equations of its clusters.
            look_at_start(tau, e.y[first], mode.dynamics, self._problem, e.looks[first])
        self._begun = None
        stop = last_time(tau, True, bounds, self._forcing)
        end, y = self._step(stop, first)
        if end <= tau:
            return 0, first, tau, end, CLEAR, excess, 0
        if self._at_root:
            return ROOT_RETURN, first, tau, end, CLEAR, excess, 0
        np.maximum(self.drift, constraint_errors(d, y), out=self.drift)
        onto_constraints(d, y)
        solve_contact_forces(end, y, self._problem)
        followed = on_loan(Followed(self._problem, self.drift, self.scales.acceleration))
        allowed = max(e.z_allowed, excess)
        verdict, excess = examine_descriptor(tau, end, first, allowed, y, e, followed)
        accepted = verdict not in (NOT_FINITE, BEYOND_BOUND)
        return 0, first, tau, end, verdict, excess, int(accepted)

    def _relative(self, tau: float, y: Floats) -> Floats:
        to_moving_frame(self._problem, tau, -1.0, y)
        return y

    def dense(self, start: float, end: float) -> Dense:
        """The last step on IDA's own polynomial and its constraints, from its values."""
        mode, d = self._mode, self._own.descriptor
        times = end - (end - start) * NODES
        values = np.empty((times.size, mode.system.size))
        for value, tau in zip(values, times, strict=True):
            y = self._relative(tau, self._interpolated(tau))
            onto_constraints(d, y)
            to_moving_frame(self._problem, tau, 1.0, y)
            to_clusters(y, 1.0, mode.system, mode.bodies, value)
        return from_values(values, start, end, self._frame)
