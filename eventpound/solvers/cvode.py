"""SUNDIALS CVODE, through scikit-sundae, between events.

The right-hand side is one compiled kernel behind one Python callback. Events
are found by the event loop on CVODE's own interpolant after each step, not by
CVODE's root finder: docs/method.md says why and what was measured.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from eventpound.errors import ComputationError, InputError
from eventpound.mechanics.ground_frame import NO_FRAME, to_frame
from eventpound.mechanics.reduced import Forcing, bandwidth
from eventpound.numerics.arrays import Floats
from eventpound.solvers.base import Recording, Task
from eventpound.solvers.events.examination import rate_at
from eventpound.solvers.events.loop import EventLoop
from eventpound.solvers.events.modes import Mode

METHODS = ("Adams", "BDF")
"""Multistep families, the default first."""
LOCAL_SHARE = 0.1
"""Part of the tolerance given to one step, since the errors of many steps add up."""
NO_RTOL = 1e-15
"""Relative tolerance where the absolute ones alone are to govern."""
BANDED_FROM = 48
"""Length of the state vector from which a banded Jacobian is used where it is narrow."""


class CvodeIntegrator:
    """One CVODE object for each layout of the state vector.

    Parameters
    ----------
    rtol : float
        Relative tolerance of a step.
    method : str
        ``"Adams"`` or ``"BDF"``.
    """

    def __init__(self, rtol: float, method: str) -> None:
        self.rtol = rtol
        self.method = method
        self.rhs_calls = 0
        self.jacobian_calls = 0
        self.starts = 0
        self._objects: dict[tuple[bytes, int, bool], Any] = {}
        self._present: Any = None
        self._mode: Mode
        self._forcing: Forcing
        self._frame = NO_FRAME
        self._arguments: tuple[Any, ...] = ()
        self._time = 0.0
        self._looked_back = False
        self._spent = 0

    def _rhs(self, tau: float, y: Floats, rate: Floats) -> None:
        self.rhs_calls += 1
        rate_at(tau, y, rate, *self._arguments)

    def _object(self, atol: Floats) -> Any:
        from sksundae.cvode import CVODE

        system = self._mode.system
        band = bandwidth(system) if system.size > BANDED_FROM else system.size
        banded = 3 * band < system.size
        framed = self._frame.shape[1] > 0
        key = (atol.tobytes(), band if banded else 0, framed)
        if key not in self._objects:
            layout = {"linsolver": "band", "lband": band, "uband": band} if banded else {}
            self._objects[key] = CVODE(
                self._rhs,
                method=self.method,
                # Positions in a moving frame are larger than what they stand for.
                rtol=NO_RTOL if framed else self.rtol,
                atol=(2.0 if framed else 1.0) * LOCAL_SHARE * atol,
                max_num_steps=100_000,
                **layout,
            )
        return self._objects[key]

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
        self._arguments = (mode.ints, mode.floats, *forcing, frame)
        self._present = self._object(atol)
        inner = y.copy()
        to_frame(frame, forcing.start + tau, 1.0, mode.system.iq, mode.system.iv, inner)
        self._present.init_step(tau, inner)
        self.starts += 1
        self._time = tau
        self._looked_back = False
        self._spent = 0

    def _relative(self, tau: float, y: Floats) -> Floats:
        if self._frame.shape[1] > 0:
            system = self._mode.system
            to_frame(self._frame, self._forcing.start + tau, -1.0, system.iq, system.iv, y)
        return y

    def step(self, stop: float) -> tuple[float, Floats]:
        """One accepted step, not beyond `stop` (s): time reached and state there."""
        result = self._present.step(stop, "onestep", stop)
        if self._looked_back and result.success and result.t == self._time:
            # After interpolating, CVODE first hands out the end of its last step again.
            result = self._present.step(stop, "onestep", stop)
        self._looked_back = False
        if not result.success:
            raise ComputationError(
                f"CVODE could not continue ({result.message.rstrip('.')}); "
                "try a larger rtol, or look at the state written so far",
                self._forcing.start + self._time,
            )
        self._time = result.t
        self.jacobian_calls += result.njev - self._spent
        self._spent = result.njev
        return result.t, self._relative(result.t, result.y)

    def interpolate(self, tau: float) -> Floats:
        """State at a time within the last step, from CVODE's own polynomial."""
        self._looked_back = True
        return self._relative(tau, self._present.step(tau, "normal").y)


class Cvode:
    """The reference solver."""

    name = "cvode"
    summary = "SUNDIALS CVODE between events: the reference"
    settings: Mapping[str, str] = {
        "method": 'multistep family, "Adams" (default) or "BDF"',
    }

    def solve(self, task: Task) -> Recording:
        """Carry the scene from start to end; see `eventpound.solvers.base.Solver`."""
        method = task.settings.get("method", METHODS[0])
        if method not in METHODS:
            raise InputError(f"[solver]: method = {method!r}; accepted: {' or '.join(METHODS)}")
        return EventLoop(task, CvodeIntegrator(LOCAL_SHARE * task.rtol, str(method))).run()
