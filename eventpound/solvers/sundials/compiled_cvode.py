"""CVODE called from compiled code: no Python between two steps without events."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from eventpound.mechanics.ground_frame import to_frame
from eventpound.mechanics.observables import Bodies, Observed, observe
from eventpound.mechanics.reduced import Forcing, Reduced
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.borrowing import array_at, copy_numbers
from eventpound.numerics.compiled import in_python, kernel, loop_kernel
from eventpound.numerics.lending import on_loan
from eventpound.solvers.events.dense import Dense
from eventpound.solvers.events.integrator import Bounds, last_time
from eventpound.solvers.events.recorder import write_samples
from eventpound.solvers.events.reversals import take_directions
from eventpound.solvers.events.step_check import Examination, examine, rate_at
from eventpound.solvers.sundials.callback_data import Roots, address_of
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
    ROOT_RETURN,
    Numbers,
    carry_on,
    reversal_in,
    root_at,
    was_told,
)
from eventpound.solvers.sundials.memory import CvodeMemory, MemoryLayout, layout
from eventpound.solvers.sundials.root_values import cluster_roots

if library() is None:
    # What follows is linked when it is loaded, and a missing symbol would end the process.
    raise ImportError("the SUNDIALS library cannot be reached from compiled code")

REACHED, TURNED = 0, 1
"""Places of `CvodeHandles.reached`: where CVODE is, and where a link has reversed last (s)."""
NEVER = -1.0
"""No time: no link has."""


class CvodeData(NamedTuple):
    """What CVODE's callbacks are handed, on loan.

    calls (2,): of the right-hand side; Jacobians. system: of the mode, whose directions of
    links are the segment's own; it, `bodies` and `roots` are on loan themselves. frame: the
    moving frame.
    """

    calls: Ints
    system: Reduced
    bodies: Bodies
    forcing: Forcing
    frame: Floats
    roots: Roots


class CvodeHandles(NamedTuple):
    """Addresses of a CVODE object and its state vector, and where times are put; on loan.

    look: a vector for interpolated states. given: what its callbacks are handed. rtol: that of
    the motion. spent (1,): Jacobians since the last start or reversal that are counted.
    """

    memory: int
    vector: int
    reached: Floats
    look: int
    given: CvodeData
    rtol: float
    spent: Ints


def right_hand_side(tau: float, y: int, rate: int, given: CvodeData) -> int:
    """CVODE's callback, a `CVRhsFn`."""
    given.calls[0] += 1
    state = array_at(array_pointer(y), given.system.size, np.float64)
    result = array_at(array_pointer(rate), given.system.size, np.float64)
    rate_at(tau, state, result, given.system, given.forcing, given.frame)
    return 0


@loop_kernel
def advance(
    handles: CvodeHandles, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
) -> Numbers:
    """Steps from `tau` (s), each examined, as `Integrator.advance` says.

    CVODE's last flag, then the numbers of `StepsTaken`.
    """
    done = carry_on(_take, _check, _write, handles, tau, first, excess, bounds, e)
    _count_jacobians(handles)
    return done


@kernel
def _take(
    handles: CvodeHandles, start: float, first: int, bounds: Bounds, e: Examination
) -> tuple[int, float, bool]:
    """A step from `start` (s) up to where a link reverses; see `carry_on`."""
    system, direction = e.dynamics.system, handles.given.system.direction
    if handles.reached[TURNED] == start:
        _begin_anew(handles, start, first, e)
    take_directions(e.y[first], system, handles.rtol, direction)
    flag = 0
    if handles.reached[REACHED] <= start or not _stands_at_end(handles, start):
        stop = last_time(start, bounds.at_samples, bounds, e.forcing)
        set_stop_time(handles.memory, stop)
        flag = cvode(handles.memory, stop, handles.vector, handles.reached.ctypes.data, ONE_STEP)
    end = handles.reached[REACHED]
    if flag < 0 or end <= start:
        return flag, end, False
    copy_numbers(array_at(array_pointer(handles.vector), system.size, np.float64), e.y[1 - first])
    to_frame(e.frame, e.forcing.start + end, -1.0, system.iq, system.iv, e.y[1 - first])
    turned = reversal_in(_dense, handles, start, end, first, flag, handles.rtol, direction, e)
    if turned < np.inf:
        _put(handles, turned, e.y[1 - first])
        handles.reached[TURNED] = turned
        return 0, turned, True
    return flag, end, flag != ROOT_RETURN


@kernel
def _stands_at_end(handles: CvodeHandles, start: float) -> bool:
    """`was_told` of a step from `start` (s) in which CVODE has stopped."""
    whole = np.empty(1)
    current_time(handles.memory, whole.ctypes.data)
    return was_told(start, handles.reached[REACHED], whole[0])


@kernel
def _check(
    handles: CvodeHandles, start: float, end: float, first: int, allowed: float, e: Examination
) -> tuple[int, float]:
    """`examine`."""
    return examine(start, end, first, allowed, e)


@kernel
def _write(handles: CvodeHandles, start: float, end: float, e: Examination) -> None:
    """History at the output times of a step."""
    write_samples(_shown, (handles, e), e.forcing.start, start, end, e.record.journal)


@kernel
def _shown(of: tuple[CvodeHandles, Examination], tau: float) -> Observed:
    """The motion at `tau` (s) of the last step, as it is observed."""
    handles, e = of
    system = e.dynamics.system
    y = array_at(array_pointer(handles.look), system.size, np.float64)
    get_dky(handles.memory, tau, 0, handles.look)
    to_frame(e.frame, e.forcing.start + tau, -1.0, system.iq, system.iv, y)
    # Nothing in a line depends on rates: any will do.
    observe(tau, y, e.rate[0], system, e.dynamics.bodies, e.forcing, e.looks[4])
    return e.looks[4]


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
    """Coefficients of CVODE's own polynomial of its last step about `t` (s).

    Parameters
    ----------
    handles : CvodeHandles
        The CVODE object; the state that it interpolates is overwritten.
    t : float
        Local time (s).

    Returns
    -------
    ndarray, shape (order + 1, size)
        ``y^(k) / k!``.
    """
    memory, look, size = handles.memory, handles.look, handles.given.system.size
    order = np.zeros(1, np.int32)
    last_order(memory, order.ctypes.data)
    Y, factorial = np.empty((order[0] + 1, size)), 1.0
    y = array_at(array_pointer(look), size, np.float64)
    for k in range(order[0] + 1):
        get_dky(memory, t, k, look)
        factorial *= max(k, 1)
        for i in range(size):
            Y[k, i] = y[i] / factorial
    return Y


@kernel
def _roots_at(tau: float, y: Floats, given: CvodeData, out: Floats) -> None:
    system, forcing = given.system, given.forcing
    state = y.copy()
    to_frame(given.frame, forcing.start + tau, -1.0, system.iq, system.iv, state)
    cluster_roots(tau, state, system, given.bodies, forcing, given.roots, out)


def root_functions(tau: float, y: int, out: int, given: CvodeData) -> int:
    """CVODE's callback, a `CVRootFn`."""
    state = array_at(array_pointer(y), given.system.size, np.float64)
    _roots_at(tau, state, given, array_at(out, 2 * given.roots.noise.size, np.float64))
    return 0


@kernel
def _values(handles: CvodeHandles, tau: float) -> Roots:
    """Root functions at `tau` (s), where CVODE is."""
    given, roots = handles.given, handles.given.roots
    state = array_at(array_pointer(handles.vector), given.system.size, np.float64)
    _roots_at(tau, state, given, roots.pairs.reshape(2 * roots.noise.size))
    return roots


@kernel
def _whole_step(handles: CvodeHandles) -> tuple[float, Floats]:
    """End of CVODE's whole step (s), and every z there; zero for those that do not move."""
    whole, places = np.empty(1), handles.given.bodies.z_of
    current_time(handles.memory, whole.ctypes.data)
    get_dky(handles.memory, whole[0], 0, handles.look)
    last = array_at(array_pointer(handles.look), handles.given.system.size, np.float64)
    z = np.zeros(places.size)
    for h in range(places.size):
        if places[h] >= 0:
            z[h] = last[places[h]]
    return whole[0], z


@kernel
def _put(handles: CvodeHandles, tau: float, y: Floats) -> None:
    """Fill in the state at `tau` (s) of the last step, relative to the ground."""
    given, system = handles.given, handles.given.system
    get_dky(handles.memory, tau, 0, handles.look)
    copy_numbers(array_at(array_pointer(handles.look), system.size, np.float64), y)
    to_frame(given.frame, given.forcing.start + tau, -1.0, system.iq, system.iv, y)


@kernel
def at_root(
    handles: CvodeHandles, start: float, tau: float, bound: Floats, allowed: float, y: Floats
) -> tuple[int, float]:
    """`root_at` for CVODE."""
    return root_at(_values, _whole_step, _put, handles, start, tau, bound, allowed, y)


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
