"""IDA called from compiled code: the motion in descriptor form between events."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from sksundae._cy_ida import IDAMESSAGES

from eventpound.mechanics.descriptor_motion import Problem
from eventpound.mechanics.ground_frame import NO_FRAME
from eventpound.mechanics.observables import blank
from eventpound.numerics.lending import on_loan
from eventpound.solvers.events.dense import NO_GAPS, Dense
from eventpound.solvers.events.integrator import Bounds, Start, Stretch
from eventpound.solvers.events.modes import Mode
from eventpound.solvers.events.step_check import Examination
from eventpound.solvers.sundials.callback_data import RootFunctions
from eventpound.solvers.sundials.descriptor_modes import DescriptorMode, DescriptorModes
from eventpound.solvers.sundials.descriptor_steps import look_at_start
from eventpound.solvers.sundials.ida_stepping import (
    Given,
    Handles,
    advance,
    at_root,
    begin,
    derivatives,
    jacobian_callback,
    residual_callback,
    root_callback,
)
from eventpound.solvers.sundials.integrators import Direct
from eventpound.solvers.sundials.library import IdaLibrary
from eventpound.solvers.sundials.memory import IdaMemory


class DirectIda(Direct):
    """An `eventpound.solvers.events.integrator.Integrator`.

    Parameters
    ----------
    library : IdaLibrary
        See `eventpound.solvers.sundials.library.ida_library`.
    modes : DescriptorModes
        The forms that the scene takes.

    Attributes
    ----------
    drift : ndarray, shape (2,)
        Largest gap (m) and gap rate (m/s) of a resting contact at the end of any step.
    """

    name, messages = "IDA", IDAMESSAGES

    def __init__(self, library: IdaLibrary, modes: DescriptorModes) -> None:
        super().__init__()
        model = modes.model
        self.library, self.scales = library, modes.scales
        self.drift = np.zeros(2)
        self._modes = modes
        self._memories: dict[Any, IdaMemory] = {}
        self._scratch = on_loan(blank(*model.counts))
        self._mode: Mode
        self._own: DescriptorMode
        self._frame = NO_FRAME
        self._memory: IdaMemory
        self._handles: Handles
        self._begun: float | None = None

    def start(self, start: Start) -> None:
        """Begin with the clusters in the state given; the tolerances are those of the run."""
        mode, forcing, frame, y, _, tau = start
        self._mode, self._forcing, self._frame = mode, forcing, frame
        own = self._own = self._modes.of(mode)
        if self._roots is not None:
            self._roots.point_to(mode)
        problem = on_loan(Problem(own.descriptor, forcing, frame))
        self._hand(Given(self._calls, problem, self._present_roots))
        memory = self._memory = self._memory_for(own)
        self._handles = on_loan(
            Handles(
                memory.address,
                memory.vector,
                memory.rate_vector,
                memory.look,
                memory.state_address,
                memory.rate_address,
                self._given,
                np.zeros(1),
                self.drift,
                self.scales.acceleration,
                self.scales.time,
            )
        )
        tolerances = own.local_tolerances(frame)
        step = begin(self._handles, tau, y, mode.dynamics, tolerances, self._scratch)
        memory.start(tau, step)
        if self._roots is not None:
            self._look_for_roots(self._roots)
        self.starts += 1
        self._begun = tau

    def _look_for_roots(self, roots: RootFunctions) -> None:
        ida, address, callback = self.library.ida, self._memory.address, root_callback(self._given)
        roots.set_up(ida.IDARootInit, ida.IDASetRootDirection, address, callback)

    def _memory_for(self, own: DescriptorMode) -> IdaMemory:
        rtol, atol = own.local_tolerances(self._frame)
        key = rtol, atol.tobytes(), own.algebraic.tobytes()
        if key not in self._memories:
            self._memories[key] = IdaMemory(
                self.library,
                rtol,
                atol,
                own.algebraic,
                residual_callback(self._given),
                jacobian_callback(self._given),
                self._given.address,
            )
        return self._memories[key]

    def advance(
        self, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
    ) -> Stretch:
        """Accepted steps, up to the first that is not clear or the bounds."""
        if self._begun == tau:
            # The loop has looked at the start of the segment by the equations of its clusters.
            look_at_start(tau, e.y[first], self._mode.dynamics, self._given.problem, e.looks[first])
        self._begun = None
        steps = partial(advance, self._handles)
        root = partial(at_root, self._handles, self._mode.dynamics)
        return self._stretch_of(steps, root, tau, first, excess, bounds, e)

    def dense(self, start: float, end: float) -> Dense:
        """The last step on IDA's own polynomial, as the loop knows it."""
        Y = derivatives(self._handles, end, self._mode.dynamics)
        return Dense(Y, end, start, end, self._frame, False, NO_GAPS)
