"""Steps of IDA and their examination in one compiled loop."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import types

from eventpound.mechanics.descriptor_motion import (
    Problem,
    jacobian,
    relative_to_ground,
    residual,
    to_moving_frame,
)
from eventpound.mechanics.observables import Observed
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.borrowing import array_at
from eventpound.numerics.compiled import kernel, loop_kernel
from eventpound.numerics.lending import lend
from eventpound.solvers.events.integrator import Bounds, last_time
from eventpound.solvers.events.recorder import PASSED, is_due, write_row
from eventpound.solvers.events.roots import any_fell
from eventpound.solvers.events.run import Dynamics
from eventpound.solvers.events.step_check import (
    BEYOND_BOUND,
    CLEAR,
    HAPPENED,
    NOT_FINITE,
    Examination,
)
from eventpound.solvers.sundials.callback_data import (
    ROOT_RETURN,
    Roots,
    address_of,
    at_bounds,
    first_zero,
)
from eventpound.solvers.sundials.descriptor_steps import (
    Followed,
    Tolerances,
    begin_descriptor,
    examine_descriptor,
    from_clusters,
    look_at_descriptor,
    to_clusters,
)
from eventpound.solvers.sundials.library import (
    array_pointer,
    ida_current_time,
    ida_get_dky,
    ida_last_order,
    ida_library,
    ida_set_stop_time,
    ida_solve,
    matrix_data,
)
from eventpound.solvers.sundials.root_values import descriptor_roots

if ida_library() is None:
    # What follows is linked when it is loaded, and a missing symbol would end the process.
    raise ImportError("the SUNDIALS library cannot be reached from compiled code")

ONE_STEP = 2
"""SUNDIALS' IDA_ONE_STEP."""


class Given(NamedTuple):
    """What IDA's callbacks are handed, on loan.

    calls (2,): of the residual and of its Jacobian. problem, roots: on loan themselves.
    """

    calls: Ints
    problem: Problem
    roots: Roots


class Handles(NamedTuple):
    """Addresses of an IDA object and its vectors; where times and drifts are put; on loan.

    look: a vector for interpolated unknowns. state, rate: values of the first two vectors.
    given: what its callbacks are handed. reached (1,): where IDA is (s). drift (2,), acceleration:
    of `Followed`. time: the scene's own T (s).
    """

    memory: int
    vector: int
    rate_vector: int
    look: int
    state: int
    rate: int
    given: Given
    reached: Floats
    drift: Floats
    acceleration: float
    time: float


def _residual(tau: float, y: int, rate: int, out: int, given: Given) -> int:
    """IDA's callback, an `IDAResFn`."""
    given.calls[0] += 1
    problem, size = given.problem, given.problem.d.size
    residual(
        tau,
        array_at(array_pointer(y), size, np.float64),
        array_at(array_pointer(rate), size, np.float64),
        array_at(array_pointer(out), size, np.float64),
        problem,
    )
    return 0


def _jacobian(
    tau: float,
    cj: float,
    y: int,
    rate: int,
    out: int,
    matrix: int,
    given: Given,
    first: int,
    second: int,
    third: int,
) -> int:
    """IDA's callback, an `IDALsJacFn`; its matrix is stored column by column."""
    given.calls[1] += 1
    problem, size = given.problem, given.problem.d.size
    columns = array_at(matrix_data(matrix), (size, size), np.float64)
    y_values = array_at(array_pointer(y), size, np.float64)
    jacobian(tau, y_values, cj, columns.T, problem)
    return 0


_address, _real = types.intp, types.float64


def residual_callback(given: Given) -> int:
    """Address of the residual."""
    three = _address, _address, _address
    return address_of(_residual, given, lambda kind: types.intc(_real, *three, kind))


def jacobian_callback(given: Given) -> int:
    """Address of the Jacobian."""
    three, four = (_address,) * 3, (_address,) * 4
    return address_of(_jacobian, given, lambda kind: types.intc(_real, _real, *four, kind, *three))


@loop_kernel
def advance(
    handles: Handles, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
) -> tuple[int, int, float, float, int, float, int]:
    """Steps from `tau` (s), each examined, as `Integrator.advance` says.

    IDA's last flag, then the numbers of the `Stretch`.

    No step goes beyond a sample of a record.
    """
    problem, forcing = handles.given.problem, e.forcing
    followed = lend(Followed(problem, handles.drift, handles.acceleration))
    state = array_at(array_pointer(handles.vector), problem.d.size, np.float64)
    origin, start, steps = forcing.start, tau, 0
    while True:
        stop = last_time(start, True, bounds, forcing)
        ida_set_stop_time(handles.memory, stop)
        flag = ida_solve(
            handles.memory,
            stop,
            handles.reached.ctypes.data,
            handles.vector,
            handles.rate_vector,
            ONE_STEP,
        )
        end = handles.reached[0]
        if flag < 0 or end <= start:
            return flag, first, start, end, CLEAR, excess, steps
        if flag == ROOT_RETURN:
            return flag, first, start, end, CLEAR, excess, steps
        y = relative_to_ground(end, state, problem)
        verdict, reached = examine_descriptor(
            start, end, first, max(e.z_allowed, excess), y, e, followed
        )
        if verdict in (NOT_FINITE, BEYOND_BOUND):
            return flag, first, start, end, verdict, reached, steps
        excess, steps = reached, steps + 1
        if verdict == CLEAR and is_due(origin + end, e.record.journal):
            _write_samples(handles, start, end, e)
        if verdict != CLEAR or at_bounds(end, steps, bounds):
            return flag, first, start, end, verdict, excess, steps
        start, first = end, 1 - first


@kernel
def _write_samples(handles: Handles, start: float, end: float, e: Examination) -> None:
    """History at the output times of a step, on IDA's own polynomial."""
    journal, problem, seen = e.record.journal, handles.given.problem, e.looks[4]
    origin = e.forcing.start
    y = array_at(array_pointer(handles.look), problem.d.size, np.float64)
    while is_due(origin + end, journal):
        t = journal.times[journal.cursor[PASSED]]
        if t >= origin + start:
            tau = max(t - origin, start)
            ida_get_dky(handles.memory, tau, 0, handles.look)
            to_moving_frame(problem, tau, -1.0, y)
            look_at_descriptor(tau, y, problem, seen)
            write_row(t, seen, journal)
        journal.cursor[PASSED] += 1


@kernel
def begin(
    handles: Handles,
    tau: float,
    clusters: Floats,
    mode: Dynamics,
    tolerances: Tolerances,
    scratch: Observed,
) -> float:
    """`begin_descriptor` of the state and the rates of `handles`, from the loop's state.

    `mode`: the loop's; `scratch` is overwritten.
    """
    problem = handles.given.problem
    size = problem.d.size
    y = array_at(handles.state, size, np.float64)
    rate = array_at(handles.rate, size, np.float64)
    from_clusters(clusters, mode.system, mode.bodies, y)
    return begin_descriptor(tau, y, rate, problem, tolerances, handles.time, scratch)


@kernel
def derivatives(handles: Handles, t: float, mode: Dynamics) -> Floats:
    """Coefficients of IDA's own polynomial of its last step about `t` (s), as the loop knows it.

    Parameters
    ----------
    handles : Handles
        The IDA object; the state that it interpolates is overwritten.
    t : float
        Local time (s).
    mode : Dynamics
        The loop's.

    Returns
    -------
    ndarray, shape (order + 1, size)
        ``y^(k) / k!`` of the clusters, in the moving frame.
    """
    memory, look, system = handles.memory, handles.look, mode.system
    order = np.zeros(1, np.int32)
    ida_last_order(memory, order.ctypes.data)
    y = array_at(array_pointer(look), handles.given.problem.d.size, np.float64)
    Y, factorial = np.empty((order[0] + 1, system.size)), 1.0
    for k in range(order[0] + 1):
        ida_get_dky(memory, t, k, look)
        factorial *= max(k, 1)
        to_clusters(y, 1.0 if k == 0 else 0.0, system, mode.bodies, Y[k])
        for i in range(system.size):
            Y[k, i] /= factorial
    return Y


def _root_functions(tau: float, y: int, rate: int, out: int, given: Given) -> int:
    """IDA's callback, an `IDARootFn`."""
    size, count = given.problem.d.size, given.roots.noise.size
    state = relative_to_ground(tau, array_at(array_pointer(y), size, np.float64), given.problem)
    functions = array_at(out, 2 * count, np.float64)
    descriptor_roots(tau, state, given.problem, given.roots, functions)
    return 0


def root_callback(given: Given) -> int:
    """Address of the root functions."""
    three = types.intp, types.intp, types.intp
    return address_of(_root_functions, given, lambda kind: types.intc(types.float64, *three, kind))


@kernel
def at_root(
    handles: Handles,
    mode: Dynamics,
    start: float,
    tau: float,
    bound: Floats,
    allowed: float,
    clusters: Floats,
) -> tuple[int, float]:
    """`eventpound.solvers.sundials.stepping.at_root` for IDA.

    `clusters` (size,): a state of the loop's `mode`.
    """
    given, memory = handles.given, handles.memory
    roots, size = given.roots, given.problem.d.size
    y = relative_to_ground(tau, array_at(handles.state, size, np.float64), given.problem)
    functions = roots.pairs.reshape(2 * roots.noise.size)
    descriptor_roots(tau, y, given.problem, roots, functions)
    if not any_fell(roots.pairs):
        return CLEAR, tau
    whole = np.empty(1)
    ida_current_time(memory, whole.ctypes.data)
    ida_get_dky(memory, whole[0], 0, handles.look)
    last = array_at(array_pointer(handles.look), size, np.float64)
    for h in range(bound.size):
        if abs(last[2 * mode.bodies.mass.size + h]) - bound[h] > allowed:
            return BEYOND_BOUND, whole[0]
    end = first_zero(roots, start, tau, whole[0])
    ida_get_dky(memory, end, 0, handles.look)
    y = relative_to_ground(end, last, given.problem)
    to_clusters(y, 1.0, mode.system, mode.bodies, clusters)
    return HAPPENED, end
