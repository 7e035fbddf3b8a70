"""CVODE called from compiled code: no Python between two steps without events."""

from __future__ import annotations

from typing import Any

import numpy as np

from eventpound.mechanics.ground_frame import to_frame
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import in_python
from eventpound.numerics.lending import on_loan
from eventpound.solvers.events.integrator import Bounds
from eventpound.solvers.events.step_check import Examination
from eventpound.solvers.sundials.callback_data import address_of
from eventpound.solvers.sundials.integrators import Direct
from eventpound.solvers.sundials.loop import Numbers
from eventpound.solvers.sundials.memory import CvodeMemory, MemoryLayout, layout
from eventpound.solvers.sundials.stepping import (
    NEVER,
    TURNED,
    CvodeData,
    CvodeHandles,
    advance,
    at_root,
    derivatives,
    right_hand_side,
    root_functions,
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

    name = "CVODE"

    def __init__(self, library: Any, rtol: float, method: str) -> None:
        super().__init__()
        self.library, self.rtol, self.method = library, rtol, method
        self._handles: CvodeHandles

    def _meaning(self, flag: int) -> str:
        # Only a run that fails pays for scikit-sundae, which brings SciPy.
        from sksundae._cy_cvode import CVMESSAGES

        return CVMESSAGES[flag]

    def _begin(self, tau: float, y: Floats, atol: Floats) -> None:
        mode, forcing, frame, roots = self._mode, self._forcing, self._frame, self._present_roots
        system = mode.directed
        system.direction[:] = 0.0
        self._hand(CvodeData(self._calls, system, mode.bodies, forcing, frame, roots))
        memory, self._handles = self._memory_for(layout(system, frame, self.rtol, atol))
        memory.state[:] = y
        in_python(to_frame)(frame, forcing.start + tau, 1.0, system.iq, system.iv, memory.state)
        memory.start(tau)
        self._handles.reached[TURNED], self._handles.spent[0] = NEVER, 0
        if self._roots is not None:
            callback = address_of(root_functions, self._given, 2)
            memory.find_roots(callback, self._roots.directions)

    def _memory_for(self, plan: MemoryLayout) -> tuple[CvodeMemory, CvodeHandles]:
        given = self._given
        if plan.key not in self._memories:
            callback, data = address_of(right_hand_side, given, 2), given.address
            memory = CvodeMemory(self.library, self.method, plan, callback, data)
            numbers = np.zeros(2), memory.look, given, self.rtol, np.zeros(1, np.int64)
            handles = on_loan(CvodeHandles(memory.address, memory.vector, *numbers))
            self._memories[plan.key] = memory, handles
        found: tuple[CvodeMemory, CvodeHandles] = self._memories[plan.key]
        return found

    def _steps(
        self, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
    ) -> Numbers:
        return advance(self._handles, tau, first, excess, bounds, e)

    def _at_root(
        self, start: float, tau: float, bound: Floats, allowed: float, y: Floats
    ) -> tuple[int, float]:
        return at_root(self._handles, start, tau, bound, allowed, y)

    def _derivatives(self, t: float) -> Floats:
        return derivatives(self._handles, t)
