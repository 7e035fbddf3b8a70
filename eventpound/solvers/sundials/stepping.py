"""Steps of CVODE and their examination in one compiled loop."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import types

from eventpound.mechanics.ground_frame import to_frame
from eventpound.mechanics.observables import Bodies, observe
from eventpound.mechanics.reduced import Forcing, Reduced
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.borrowing import array_at, copy_numbers
from eventpound.numerics.compiled import kernel, loop_kernel
from eventpound.solvers.events.dense import Dense
from eventpound.solvers.events.integrator import Bounds, last_time
from eventpound.solvers.events.recorder import PASSED, is_due, write_row
from eventpound.solvers.events.reversals import (
    NEGLIGIBLE,
    first_reversal,
    may_reverse,
    take_directions,
)
from eventpound.solvers.events.roots import any_fell
from eventpound.solvers.events.step_check import (
    BEYOND_BOUND,
    CLEAR,
    HAPPENED,
    NOT_FINITE,
    Examination,
    examine,
    rate_at,
)
from eventpound.solvers.sundials.callback_data import (
    ROOT_RETURN,
    Roots,
    address_of,
    at_bounds,
    before_root,
    first_zero,
)
from eventpound.solvers.sundials.library import (
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
from eventpound.solvers.sundials.root_values import cluster_roots

if library() is None:
    # What follows is linked when it is loaded, and a missing symbol would end the process.
    raise ImportError("the SUNDIALS library cannot be reached from compiled code")

ONE_STEP = 2
"""SUNDIALS' CV_ONE_STEP."""
REACHED, TURNED = 0, 1
"""Places of `Handles.reached`: where CVODE is, and where a link has reversed last (s)."""
NEVER = -1.0
"""No time: no link has."""


class Given(NamedTuple):
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


class Handles(NamedTuple):
    """Addresses of a CVODE object and its state vector, and where times are put; on loan.

    look: a vector for interpolated states. given: what its callbacks are handed. rtol: that of
    the motion. spent (1,): Jacobians since the last start or reversal that are counted.
    """

    memory: int
    vector: int
    reached: Floats
    look: int
    given: Given
    rtol: float
    spent: Ints


def _right_hand_side(tau: float, y: int, rate: int, given: Given) -> int:
    """CVODE's callback, a `CVRhsFn`."""
    given.calls[0] += 1
    state = array_at(array_pointer(y), given.system.size, np.float64)
    result = array_at(array_pointer(rate), given.system.size, np.float64)
    rate_at(tau, state, result, given.system, given.forcing, given.frame)
    return 0


def right_hand_side(given: Given) -> int:
    """Address of the right-hand side."""
    two = types.intp, types.intp
    return address_of(_right_hand_side, given, lambda kind: types.intc(types.float64, *two, kind))


@loop_kernel
def advance(
    handles: Handles, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
) -> tuple[int, int, float, float, int, float, int]:
    """Steps from `tau` (s), each examined, as `Integrator.advance` says.

    CVODE's last flag, then the numbers of the `Stretch`.
    """
    done = _steps(handles, tau, first, excess, bounds, e)
    _count_jacobians(handles)
    return done


@kernel
def _steps(
    handles: Handles, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
) -> tuple[int, int, float, float, int, float, int]:
    """`advance`, its Jacobians not counted."""
    system, forcing = e.dynamics.system, e.forcing
    state = array_at(array_pointer(handles.vector), system.size, np.float64)
    direction = handles.given.system.direction
    origin, start, steps = forcing.start, tau, 0
    while True:
        if handles.reached[TURNED] == start:
            _begin_anew(handles, start, first, e)
        take_directions(e.y[first], system, handles.rtol, direction)
        stop = last_time(start, bounds.at_samples, bounds, forcing)
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
        if verdict == CLEAR and is_due(origin + end, e.record.journal):
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
    _count_jacobians(handles)
    reinit(handles.memory, tau, handles.vector)
    handles.spent[0] = 0
    handles.reached[TURNED] = NEVER


@kernel
def _count_jacobians(handles: Handles) -> None:
    """Count Jacobians since the last time: those of a start are known once it has made a step."""
    known = handles.spent[0]
    jacobians(handles.memory, handles.spent.ctypes.data)
    handles.given.calls[1] += handles.spent[0] - known


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
        last, allowed = before_root(start, end), 0.0
    before, after, rate, system = e.y[first], e.y[1 - first], e.rate[first], e.dynamics.system
    if not may_reverse(before, rate, after, end - start, system, direction, allowed):
        return np.inf
    origin = e.forcing.start
    Y = derivatives(handles.memory, handles.look, end, system.size)
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
    journal, forcing, mode = e.record.journal, e.forcing, e.dynamics
    system, origin = mode.system, forcing.start
    y = array_at(array_pointer(handles.look), system.size, np.float64)
    seen = e.looks[4]
    while is_due(origin + end, journal):
        t = journal.times[journal.cursor[PASSED]]
        if t >= origin + start:
            tau = max(t - origin, start)
            get_dky(handles.memory, tau, 0, handles.look)
            to_frame(e.frame, origin + tau, -1.0, system.iq, system.iv, y)
            # Nothing in a line depends on rates: any will do.
            observe(tau, y, e.rate[0], system, mode.bodies, forcing, seen)
            write_row(t, seen, journal)
        journal.cursor[PASSED] += 1


@kernel
def derivatives(memory: int, vector: int, t: float, size: int) -> Floats:
    """Coefficients of CVODE's own polynomial of its last step about `t` (s).

    Parameters
    ----------
    memory, vector : int
        Addresses of a CVODE object and of a vector, which is overwritten.
    t : float
        Local time (s).
    size : int
        Of the state.

    Returns
    -------
    ndarray, shape (order + 1, size)
        ``y^(k) / k!``.
    """
    order = np.zeros(1, np.int32)
    last_order(memory, order.ctypes.data)
    Y, factorial = np.empty((order[0] + 1, size)), 1.0
    y = array_at(array_pointer(vector), size, np.float64)
    for k in range(order[0] + 1):
        get_dky(memory, t, k, vector)
        factorial *= max(k, 1)
        for i in range(size):
            Y[k, i] = y[i] / factorial
    return Y


@kernel
def _roots_at(tau: float, y: Floats, given: Given, out: Floats) -> None:
    system, forcing = given.system, given.forcing
    state = y.copy()
    to_frame(given.frame, forcing.start + tau, -1.0, system.iq, system.iv, state)
    cluster_roots(tau, state, system, given.bodies, forcing, given.roots, out)


def _root_functions(tau: float, y: int, out: int, given: Given) -> int:
    """CVODE's callback, a `CVRootFn`."""
    state = array_at(array_pointer(y), given.system.size, np.float64)
    _roots_at(tau, state, given, array_at(out, 2 * given.roots.noise.size, np.float64))
    return 0


def root_callback(given: Given) -> int:
    """Address of the root functions."""
    two = types.intp, types.intp
    return address_of(_root_functions, given, lambda kind: types.intc(types.float64, *two, kind))


@kernel
def _leapt(y: Floats, bodies: Bodies, bound: Floats, allowed: float) -> bool:
    """Whether a |z| exceeds its bound by more than is allowed."""
    leapt = False
    for h in range(bound.size):
        place = bodies.z_of[h]
        leapt = leapt or (place >= 0 and abs(y[place]) - bound[h] > allowed)
    return leapt


@kernel
def at_root(
    handles: Handles, start: float, tau: float, bound: Floats, allowed: float, y: Floats
) -> tuple[int, float]:
    """What CVODE's return with a root at `tau` (s) means, and where its step ends (s).

    Parameters
    ----------
    handles : Handles
        The CVODE object; the state that it interpolates is overwritten.
    start, tau : float
        Start of the step, and the root (s).
    bound, allowed : ndarray, shape (H,), and float
        Of every |z|, and by how much it may be exceeded at the end of CVODE's whole step.
    y : ndarray, shape (size,)
        State where the value was zero, relative to the ground; overwritten where one fell.

    Returns
    -------
    verdict : int
        CLEAR at the bottom of a dip that stays above zero, HAPPENED or BEYOND_BOUND.
    end : float
        Where the value was zero, or the end of a step that leapt over the knee of the hysteresis.
    """
    given, memory, look = handles.given, handles.memory, handles.look
    system, roots = given.system, given.roots
    state = array_at(array_pointer(handles.vector), system.size, np.float64)
    _roots_at(tau, state, given, roots.pairs.reshape(2 * roots.noise.size))
    if not any_fell(roots.pairs):
        return CLEAR, tau
    whole = np.empty(1)
    current_time(memory, whole.ctypes.data)
    get_dky(memory, whole[0], 0, look)
    last = array_at(array_pointer(look), system.size, np.float64)
    if _leapt(last, given.bodies, bound, allowed):
        return BEYOND_BOUND, whole[0]
    end = first_zero(roots, start, tau, whole[0])
    get_dky(memory, end, 0, look)
    y[:] = last
    to_frame(given.frame, given.forcing.start + end, -1.0, system.iq, system.iv, y)
    return HAPPENED, end
