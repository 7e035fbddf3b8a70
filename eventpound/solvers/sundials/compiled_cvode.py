"""CVODE called from compiled code: no Python between two steps without events."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from eventpound.mechanics.ground_frame import to_frame
from eventpound.mechanics.observables import Observed
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.borrowing import array_at, copy_numbers
from eventpound.numerics.by_address import with_address
from eventpound.numerics.compiled import kernel
from eventpound.numerics.compiled.recipe import EVERY_STEP
from eventpound.solvers.events.dense import Dense
from eventpound.solvers.events.integrator import Bounds, Start, last_time
from eventpound.solvers.events.reversals import take_directions
from eventpound.solvers.events.step_check import Examination, examine, rate_at
from eventpound.solvers.sundials.callback_data import Roots, SegmentData, address_of, put_roots
from eventpound.solvers.sundials.integrators import Direct
from eventpound.solvers.sundials.library import (
    ONE_STEP,
    array_pointer,
    current_time,
    cvode,
    get_dky,
    jacobians,
    last_order,
    library,
    reinit,
    set_stop_time,
)
from eventpound.solvers.sundials.loop import (
    Numbers,
    carry_on,
    polynomial,
    put_state,
    reversal_in,
    root_at,
    shown,
    step_to,
)
from eventpound.solvers.sundials.memory import CvodeMemory, MemoryLayout, layout

if library() is None:
    # What follows is linked when it is loaded, and a missing symbol would end the process.
    raise ImportError("the SUNDIALS library cannot be reached from compiled code")

REACHED, TURNED = 0, 1
"""Places of `CvodeHandles.reached`: where CVODE is, and where a link has reversed last (s)."""
NEVER = -1.0
"""No time: no link has."""


class CvodeHandles(NamedTuple):
    """Addresses of a CVODE object and its state vector, and where times are put.

    interpolated: a vector for states. given: what its callbacks are handed. rtol: that of
    the motion. spent (1,): Jacobians since the last start or reversal that are counted.
    """

    memory: int
    vector: int
    reached: Floats
    interpolated: int
    given: SegmentData
    rtol: float
    spent: Ints


def right_hand_side(tau: float, y: int, rate: int, given: SegmentData) -> int:
    """CVODE's callback, a `CVRhsFn`."""
    given.calls[0] += 1
    state = array_at(array_pointer(y), given.system.size, np.float64)
    result = array_at(array_pointer(rate), given.system.size, np.float64)
    rate_at(tau, state, result, given.system, given.forcing, given.frame)
    return 0


@kernel.but(recipe=EVERY_STEP)
def advance(
    handles: CvodeHandles, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
) -> Numbers:
    """Steps from `tau` (s), each examined, as `Integrator.advance` says.

    CVODE's last flag, then the numbers of `StepsTaken`.
    """
    done = carry_on(_take, _check, _shown, handles, tau, first, excess, bounds, e)
    _count_jacobians(handles)
    return done


@kernel
def _take(
    handles: CvodeHandles, start: float, first: int, bounds: Bounds, e: Examination
) -> tuple[int, float]:
    """A step from `start` (s) up to where a link reverses; see `carry_on`."""
    system, direction = e.dynamics.system, handles.given.system.direction
    # A link has reversed here, and z' has a kink: nothing before it may be in the formulas.
    if handles.reached[TURNED] == start:
        _begin_anew(handles, start, first, e)
    take_directions(e.y[first], system, handles.rtol, direction)
    flag = step_to(_solve, _whole_end, handles, start, last_time(start, bounds, e.forcing))
    end = handles.reached[REACHED]
    if flag < 0 or end <= start:
        return flag, end
    put_state(_put_reached, handles, end, e, e.y[1 - first])
    turned = reversal_in(_dense, handles, start, end, first, flag, handles.rtol, direction, e)
    if turned < np.inf:
        # The step ends at the reversal, on its own polynomial.
        put_state(_put_inner, handles, turned, e, e.y[1 - first])
        handles.reached[TURNED] = turned
        return 0, turned
    return flag, end


@kernel
def _solve(handles: CvodeHandles, stop: float) -> int:
    # CVODE forgets a stop time that it has come to.
    set_stop_time(handles.memory, stop)
    return cvode(handles.memory, stop, handles.vector, handles.reached.ctypes.data, ONE_STEP)


@kernel
def _whole_end(handles: CvodeHandles) -> float:
    """End of CVODE's whole step (s)."""
    whole = np.empty(1)
    current_time(handles.memory, whole.ctypes.data)
    return whole[0]


@kernel
def _check(
    handles: CvodeHandles, start: float, end: float, first: int, allowed: float, e: Examination
) -> tuple[int, float]:
    """`examine`."""
    return examine(start, end, first, allowed, e)


@kernel
def _shown(of: tuple[CvodeHandles, Examination], tau: float) -> Observed:
    """`shown`."""
    return shown(_put_inner, of, tau)


@kernel
def _begin_anew(handles: CvodeHandles, tau: float, first: int, e: Examination) -> None:
    """Begin at the local time tau (s) with the state of a row, without a past."""
    system = e.dynamics.system
    state = array_at(array_pointer(handles.vector), system.size, np.float64)
    copy_numbers(e.y[first], state)
    to_frame(e.frame, e.forcing.start + tau, 1.0, system.iq, system.iv, state)
    _count_jacobians(handles)
    reinit(handles.memory, tau, handles.vector)
    handles.spent[0] = 0
    handles.reached[REACHED], handles.reached[TURNED] = tau, NEVER


@kernel
def _count_jacobians(handles: CvodeHandles) -> None:
    """Count Jacobians since the last time: those of a start are known once it has made a step."""
    known = handles.spent[0]
    jacobians(handles.memory, handles.spent.ctypes.data)
    handles.given.calls[1] += handles.spent[0] - known


@kernel
def _dense(handles: CvodeHandles, start: float, end: float) -> Dense:
    """The last step on CVODE's own polynomial."""
    Y = derivatives(handles, end)
    return Dense(Y, end, start, end, handles.given.frame, False, Y[:0])


@kernel
def derivatives(handles: CvodeHandles, t: float) -> Floats:
    """`polynomial` of CVODE; the state that it interpolates is overwritten."""
    order = np.zeros(1, np.int32)
    last_order(handles.memory, order.ctypes.data)
    return polynomial(_put_inner, handles, order[0], t, handles.given.system.size)


@kernel
def _put_inner(handles: CvodeHandles, tau: float, k: int, y: Floats) -> None:
    get_dky(handles.memory, tau, k, handles.interpolated)
    copy_numbers(array_at(array_pointer(handles.interpolated), y.size, np.float64), y)


@kernel
def _put_reached(handles: CvodeHandles, tau: float, k: int, y: Floats) -> None:
    """The same where CVODE is."""
    copy_numbers(array_at(array_pointer(handles.vector), y.size, np.float64), y)


def root_functions(tau: float, y: int, out: int, given: SegmentData) -> int:
    """CVODE's callback, a `CVRootFn`."""
    state = array_at(array_pointer(y), given.system.size, np.float64)
    put_roots(tau, state.copy(), given, array_at(out, 2 * given.roots.noise.size, np.float64))
    return 0


@kernel
def _values(handles: CvodeHandles, tau: float) -> Roots:
    """Root functions at `tau` (s), where CVODE is."""
    given, roots = handles.given, handles.given.roots
    state = array_at(array_pointer(handles.vector), given.system.size, np.float64)
    put_roots(tau, state.copy(), given, roots.pairs.reshape(2 * roots.noise.size))
    return roots


@kernel
def at_root(
    handles: CvodeHandles, start: float, tau: float, first: int, excess: float, e: Examination
) -> tuple[int, float]:
    """`root_at` for CVODE."""
    return root_at(_values, _whole_end, _put_inner, handles, start, tau, first, excess, e)


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
    _kernels = advance, at_root, derivatives

    def __init__(self, library: Any, rtol: float, method: str) -> None:
        super().__init__()
        self.library, self.rtol, self.method = library, rtol, method
        # What a mode and a frame are integrated in, told sooner than by its layout.
        self._served: dict[tuple[int, bool], tuple[CvodeMemory, CvodeHandles]] = {}

    def _meaning(self, flag: int) -> str:
        # Only a run that fails pays for scikit-sundae, which brings SciPy.
        from sksundae._cy_cvode import CVMESSAGES

        return CVMESSAGES[flag]

    def _begin(self, tau: float, y: Floats, atol: Floats) -> None:
        segment = self._segment
        self._hand(segment)
        served = id(self._mode), segment.frame.shape[1] > 0
        if served not in self._served:
            plan = layout(segment.system, segment.frame, self.rtol, atol)
            self._served[served] = self._memory_for(plan)
        memory, self._handles = self._served[served]
        # The first step begins anew.
        self._handles.reached[TURNED] = tau
        if self._roots is not None:
            callback = address_of(root_functions, self._given, 2)
            memory.find_roots(callback, self._roots.directions)

    def _handles_of(self, start: Start) -> CvodeHandles:
        return self._handles_with(with_address(self._segment_of(start)))

    def _handles_with(
        self, given: SegmentData, memory: int = 0, vector: int = 0, interpolated: int = 0
    ) -> CvodeHandles:
        reached, spent = np.zeros(2), np.zeros(1, np.int64)
        handles = CvodeHandles(memory, vector, reached, interpolated, given, self.rtol, spent)
        return with_address(handles)

    def _memory_for(self, plan: MemoryLayout) -> tuple[CvodeMemory, CvodeHandles]:
        given = self._given
        if plan.key not in self._memories:
            callback, data = address_of(right_hand_side, given, 2), given.address
            memory = CvodeMemory(self.library, self.method, plan, callback, data)
            addresses = memory.address, memory.vector, memory.interpolated
            self._memories[plan.key] = memory, self._handles_with(given, *addresses)
        found: tuple[CvodeMemory, CvodeHandles] = self._memories[plan.key]
        return found
