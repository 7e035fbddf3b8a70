"""Steps of CVODE and their examination in one compiled loop."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import types

from eventpound.mechanics.ground_frame import to_frame
from eventpound.mechanics.observables import observe
from eventpound.mechanics.packing import unpack_system
from eventpound.mechanics.reduced import motion_rate
from eventpound.motion.forcing import next_corner
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.borrowing import array_at, copy_numbers
from eventpound.numerics.compiled import callback, kernel, loop_kernel
from eventpound.numerics.lcp import EPS
from eventpound.numerics.lending import lend
from eventpound.solvers.events.dense import Dense
from eventpound.solvers.events.integrator import Bounds
from eventpound.solvers.events.journal import PASSED, is_due, write_row
from eventpound.solvers.events.reversals import (
    NEGLIGIBLE,
    first_reversal,
    may_reverse,
    take_directions,
)
from eventpound.solvers.events.run import observed_in
from eventpound.solvers.events.step_check import (
    BEYOND_BOUND,
    CLEAR,
    NOT_FINITE,
    Examination,
    Examined,
    examine,
    opened,
    rate_at,
)
from eventpound.solvers.sundials.callback_data import (
    BRACKET,
    DATA,
    ROOT_RETURN,
    at_bounds,
    handed_arrays,
)
from eventpound.solvers.sundials.library import (
    array_pointer,
    cvode,
    get_dky,
    jacobians,
    last_order,
    library,
    reinit,
    set_stop_time,
)

if library() is None:
    # What follows is linked when it is loaded, and a missing symbol would end the process.
    raise ImportError("the SUNDIALS library cannot be reached from compiled code")

ONE_STEP = 2
"""SUNDIALS' CV_ONE_STEP."""
REACHED, TURNED = 0, 1
"""Places of `Handles.reached`: where CVODE is, and where a link has reversed last (s)."""
NEVER = -1.0
"""No time: no link has."""


class Handles(NamedTuple):
    """Addresses of a CVODE object and its state vector, and where times are put.

    look: a vector for interpolated states. data: the `DATA`. rtol: that of the motion.
    jacobians (1,): Jacobians before the last reversal.
    """

    memory: int
    vector: int
    reached: Floats
    look: int
    data: int
    rtol: float
    jacobians: Ints


def _right_hand_side(tau: float, y: int, rate: int, data: int) -> int:
    """CVODE's callback, a `CVRhsFn`."""
    given = array_at(data, 1, DATA)[0]
    given.calls += 1
    ints, floats, forcing, frame = handed_arrays(given)
    state = array_at(array_pointer(y), given.size, np.float64)
    result = array_at(array_pointer(rate), given.size, np.float64)
    rate_at(tau, state, result, lend(unpack_system(ints, floats)), lend(forcing), frame)
    return 0


right_hand_side: Any = callback(
    _right_hand_side, types.intc(types.float64, types.intp, types.intp, types.intp)
)


@loop_kernel
def advance(
    handles: Handles, tau: float, first: int, excess: float, bounds: Bounds, examined: Examined
) -> tuple[int, int, float, float, int, float, int]:
    """Steps from `tau` (s), each examined, as `Integrator.advance` says.

    CVODE's last flag, then the numbers of the `Stretch`.
    """
    e = lend(opened(examined))
    system, forcing = e.dynamics.system, e.forcing
    state = array_at(array_pointer(handles.vector), system.size, np.float64)
    given = handed_arrays(array_at(handles.data, 1, DATA)[0])
    direction = unpack_system(given[0], given[1]).direction
    origin, start, steps = forcing.start, tau, 0
    while True:
        if handles.reached[TURNED] == start:
            _begin_anew(handles, start, first, e)
        take_directions(e.y[first], system, handles.rtol, direction)
        stop = bounds.stop
        if bounds.at_samples:
            stop = next_corner(forcing, origin + start, origin + stop) - origin
        set_stop_time(handles.memory, stop)
        flag = cvode(handles.memory, stop, handles.vector, handles.reached.ctypes.data, ONE_STEP)
        end = handles.reached[REACHED]
        if flag < 0 or end <= start:
            return flag, first, start, end, CLEAR, excess, steps
        copy_numbers(state, e.y[1 - first])
        to_frame(e.frame, origin + end, -1.0, system.iq, system.iv, e.y[1 - first])
        turned = _to_reversal(handles, start, end, first, flag, e, direction)
        if turned < np.inf:
            flag, end = 0, turned
        elif flag == ROOT_RETURN:
            return flag, first, start, end, CLEAR, excess, steps
        verdict, reached = examine(start, end, first, max(e.z_allowed, excess), e)
        if verdict in (NOT_FINITE, BEYOND_BOUND):
            return flag, first, start, end, verdict, reached, steps
        excess, steps = reached, steps + 1
        if verdict == CLEAR and is_due(origin + end, e.journal):
            _write_samples(handles, start, end, e)
        if verdict != CLEAR or at_bounds(end, steps, bounds):
            return flag, first, start, end, verdict, excess, steps
        start, first = end, 1 - first


@kernel
def _begin_anew(handles: Handles, tau: float, first: int, e: Examination) -> None:
    """Begin at the local time tau (s) with the state of a row, without a past."""
    system = e.dynamics.system
    state = array_at(array_pointer(handles.vector), system.size, np.float64)
    copy_numbers(e.y[first], state)
    to_frame(e.frame, e.forcing.start + tau, 1.0, system.iq, system.iv, state)
    spent = np.zeros(1, np.int64)
    jacobians(handles.memory, spent.ctypes.data)
    handles.jacobians[0] += spent[0]
    reinit(handles.memory, tau, handles.vector)
    handles.reached[TURNED] = NEVER


@kernel
def _to_reversal(
    handles: Handles,
    start: float,
    end: float,
    first: int,
    flag: int,
    e: Examination,
    direction: Floats,
) -> float:
    """Where in a step a link reverses (s), whose state is then that at its end; inf for nowhere.

    `flag` is CVODE's. A root, if that says so, may be a reversal, and what it means is seen with
    the direction before it.
    """
    # Reversals after `last` are left alone; where one is, z may err by `allowed`.
    last, allowed = end, NEGLIGIBLE * handles.rtol
    if flag == ROOT_RETURN:
        last, allowed = end - BRACKET * EPS * (abs(end) + end - start), 0.0
    before, after, rate, system = e.y[first], e.y[1 - first], e.rate[first], e.dynamics.system
    if not may_reverse(before, rate, after, end - start, system, direction, allowed):
        return np.inf
    origin, order = e.forcing.start, np.zeros(1, np.int32)
    last_order(handles.memory, order.ctypes.data)
    Y = derivatives(handles.memory, handles.look, end, system.size, order[0])
    dense = Dense(Y, end, start, end, e.frame, False, Y[:0])
    turned = first_reversal(dense, last, origin, system, direction)
    if turned < np.inf:
        get_dky(handles.memory, turned, 0, handles.look)
        copy_numbers(array_at(array_pointer(handles.look), system.size, np.float64), after)
        to_frame(e.frame, origin + turned, -1.0, system.iq, system.iv, after)
        handles.reached[TURNED] = turned
    return turned


@kernel
def _write_samples(handles: Handles, start: float, end: float, e: Examination) -> None:
    """History at the output times of a step, on CVODE's own polynomial."""
    journal, forcing, mode = e.journal, e.forcing, e.dynamics
    system, origin = mode.system, forcing.start
    y = array_at(array_pointer(handles.look), system.size, np.float64)
    rate = np.empty(system.size)
    seen = observed_in(e.looks[4], mode)
    while is_due(origin + end, journal):
        t = journal.times[journal.cursor[PASSED]]
        if t >= origin + start:
            tau = max(t - origin, start)
            get_dky(handles.memory, tau, 0, handles.look)
            to_frame(e.frame, origin + tau, -1.0, system.iq, system.iv, y)
            motion_rate(tau, y, rate, system, forcing)
            observe(tau, y, rate, mode.bodies, forcing, seen)
            write_row(t, seen, journal)
        journal.cursor[PASSED] += 1


@kernel
def derivatives(memory: int, vector: int, t: float, size: int, order: int) -> Floats:
    """Coefficients of CVODE's own polynomial of its last step about `t` (s).

    Parameters
    ----------
    memory, vector : int
        Addresses of a CVODE object and of a vector, which is overwritten.
    t : float
        Local time (s).
    size, order : int
        Of the state; of the step.

    Returns
    -------
    ndarray, shape (order + 1, size)
        ``y^(k) / k!``.
    """
    Y, factorial = np.empty((order + 1, size)), 1.0
    y = array_at(array_pointer(vector), size, np.float64)
    for k in range(order + 1):
        get_dky(memory, t, k, vector)
        factorial *= max(k, 1)
        for i in range(size):
            Y[k, i] = y[i] / factorial
    return Y
