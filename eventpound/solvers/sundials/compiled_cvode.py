"""CVODE called from compiled code: no Python between two steps without events."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from sksundae._cy_cvode import CVMESSAGES

from eventpound.mechanics.ground_frame import NO_FRAME, to_frame
from eventpound.numerics.compiled import in_python
from eventpound.numerics.lending import on_loan
from eventpound.solvers.events.dense import NO_GAPS, Dense
from eventpound.solvers.events.integrator import Bounds, Start, Stretch
from eventpound.solvers.events.modes import Mode
from eventpound.solvers.events.step_check import Examination
from eventpound.solvers.sundials.callback_data import (
    RootFunctions,
)
from eventpound.solvers.sundials.integrators import Direct
from eventpound.solvers.sundials.memory import CvodeMemory, Layout, layout
from eventpound.solvers.sundials.stepping import (
    NEVER,
    TURNED,
    Given,
    Handles,
    advance,
    at_root,
    derivatives,
    right_hand_side,
    root_callback,
)


class DirectCvode(Direct):
    """An `eventpound.solvers.events.integrator.Integrator`.

    Parameters
    ----------
    library : ctypes.CDLL
        See `eventpound.solvers.sundials.library.library`.
    rtol : float
        Relative tolerance of the motion.
    method : str
        ``"Adams"`` or ``"BDF"``.
    """

    name, messages = "CVODE", CVMESSAGES

    def __init__(self, library: Any, rtol: float, method: str) -> None:
        super().__init__()
        self.library, self.rtol, self.method = library, rtol, method
        self._memories: dict[Any, tuple[CvodeMemory, Handles]] = {}
        self._mode: Mode
        self._frame = NO_FRAME
        self._memory: CvodeMemory
        self._handles: Handles

    def start(self, start: Start) -> None:
        """Begin at the local time `tau` (s) with state `y`."""
        mode, forcing, frame, y, atol, tau = start
        self._mode, self._forcing, self._frame = mode, forcing, frame
        if self._roots is not None:
            self._roots.point_to(mode)
        system, roots = mode.directed, self._present_roots
        system.direction[:] = 0.0
        self._hand(Given(self._calls, system, mode.bodies, forcing, frame, roots))
        self._memory, self._handles = self._memory_for(layout(system, frame, self.rtol, atol))
        state = self._memory.state
        state[:] = y
        in_python(to_frame)(frame, forcing.start + tau, 1.0, system.iq, system.iv, state)
        self._memory.start(tau)
        self._handles.reached[TURNED], self._handles.spent[0] = NEVER, 0
        if self._roots is not None:
            self._look_for_roots(self._roots)
        self.starts += 1

    def _memory_for(self, plan: Layout) -> tuple[CvodeMemory, Handles]:
        given = self._given
        if plan.key not in self._memories:
            callback, data = right_hand_side(given), given.address
            memory = CvodeMemory(self.library, self.method, plan, callback, data)
            numbers = np.zeros(2), memory.look, given, self.rtol, np.zeros(1, np.int64)
            handles = on_loan(Handles(memory.address, memory.vector, *numbers))
            self._memories[plan.key] = memory, handles
        return self._memories[plan.key]

    def _look_for_roots(self, roots: RootFunctions) -> None:
        roots.set_up(
            self.library.CVodeRootInit,
            self.library.CVodeSetRootDirection,
            self._memory.address,
            root_callback(self._given),
        )

    def advance(
        self, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
    ) -> Stretch:
        """Accepted steps, up to the first that is not clear or the bounds."""
        steps, root = partial(advance, self._handles), partial(at_root, self._handles)
        return self._stretch_of(steps, root, tau, first, excess, bounds, e)

    def dense(self, start: float, end: float) -> Dense:
        """The last step on CVODE's own polynomial."""
        memory = self._memory
        Y = derivatives(memory.address, memory.look, end, self._mode.system.size)
        return Dense(Y, end, start, end, self._frame, False, NO_GAPS)
