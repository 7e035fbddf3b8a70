"""CVODE called from compiled code: no Python between two steps without events."""

from __future__ import annotations

from typing import Any

import numpy as np
from sksundae._cy_cvode import CVMESSAGES

from eventpound.errors import ComputationError
from eventpound.mechanics.ground_frame import NO_FRAME, to_frame
from eventpound.mechanics.reduced import Forcing
from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.examination import Examined
from eventpound.solvers.events.integrator import Bounds, Stretch
from eventpound.solvers.events.modes import Mode
from eventpound.solvers.sundials.layout import layout
from eventpound.solvers.sundials.memory import Memory
from eventpound.solvers.sundials.stepping import (
    DATA,
    Handles,
    advance,
    interpolate,
    look,
    right_hand_side,
)


class DirectCvode:
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

    def __init__(self, library: Any, rtol: float, method: str) -> None:
        self.library, self.rtol, self.method = library, rtol, method
        self.jacobian_calls = 0
        self.starts = 0
        self._memories: dict[Any, tuple[Memory, Handles]] = {}
        self._data = np.zeros(1, DATA)
        self._address = self._data.ctypes.data
        self._kept: tuple[Any, ...] = ()
        self._mode: Mode
        self._forcing: Forcing
        self._frame = NO_FRAME
        self._memory: Memory
        self._handles: Handles
        self._spent = 0

    @property
    def rhs_calls(self) -> int:
        """Calls of the right-hand side, those for Jacobians included."""
        return int(self._data["calls"][0])

    def start(
        self,
        mode: Mode,
        forcing: Forcing,
        frame: Floats,
        y: Floats,
        atol: Floats,
        tau: float = 0.0,
    ) -> None:
        """Begin at the local time `tau` (s) with state `y`."""
        self._mode, self._forcing, self._frame = mode, forcing, frame
        self._hand_over()
        plan = layout(mode.system, frame, self.rtol, atol)
        if plan.key not in self._memories:
            memory = Memory(
                self.library, self.method, *plan, right_hand_side.address, self._address
            )
            handles = Handles(memory.address, memory.vector, np.zeros(1))
            self._memories[plan.key] = memory, handles
        self._memory, self._handles = self._memories[plan.key]
        self._memory.state[:] = y
        to_frame(
            frame, forcing.start + tau, 1.0, mode.system.iq, mode.system.iv, self._memory.state
        )
        self._memory.start(tau)
        self.starts += 1
        self._spent = 0

    def _hand_over(self) -> None:
        """Tell the callback where the arrays of the mode and the forcing are."""
        mode, forcing, data = self._mode, self._forcing, self._data
        arrays = {
            "ints": mode.ints,
            "floats": mode.floats,
            "coefficients": np.ascontiguousarray(forcing.coefficients),
            "samples": np.ascontiguousarray(forcing.samples),
            "frame": self._frame,
        }
        for name, array in arrays.items():
            data[name], data[name + "_size"] = array.ctypes.data, array.shape[-1]
        data["size"], data["family"] = mode.system.size, forcing.family
        data["start"] = forcing.start
        self._kept = tuple(arrays.values())

    def advance(
        self, tau: float, first: int, excess: float, bounds: Bounds, e: Examined
    ) -> Stretch:
        """Accepted steps, up to the first that is not clear or the bounds."""
        flag, stretch = advance(self._handles, tau, first, excess, bounds, e)
        spent = self._memory.jacobian_calls()
        self.jacobian_calls += spent - self._spent
        self._spent = spent
        if flag < 0:
            raise ComputationError(
                f"CVODE could not continue ({CVMESSAGES[flag].rstrip('.')}); "
                "try a larger rtol, or look at the state written so far",
                self._forcing.start + stretch.start,
            )
        return stretch

    def interpolate(self, tau: float) -> Floats:
        """State at a time within the last step, from CVODE's own polynomial."""
        interpolate(self._memory.address, self._memory.look, tau)
        y, system = self._memory.looked.copy(), self._mode.system
        if self._frame.shape[1] > 0:
            to_frame(self._frame, self._forcing.start + tau, -1.0, system.iq, system.iv, y)
        return y

    def look(self, tau: float, looks: Floats) -> None:
        """Observe the state there."""
        look(self._memory.address, self._memory.look, self._address, tau, looks)
