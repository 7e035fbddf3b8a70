"""Steps of IDA and their examination in one compiled loop."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import types

from eventpound.mechanics.descriptor import Descriptor, unpack_descriptor
from eventpound.mechanics.descriptor_jacobian import jacobian
from eventpound.mechanics.descriptor_motion import (
    residual,
    solve_contact_forces,
    to_moving_frame,
)
from eventpound.mechanics.observables import Bodies
from eventpound.mechanics.packing import unpack_bodies, unpack_observed, unpack_system
from eventpound.mechanics.reduced import Reduced
from eventpound.motion.base import Family
from eventpound.motion.forcing import next_corner
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.borrowing import array_at, borrow, copy_numbers
from eventpound.numerics.compiled import callback, kernel, loop_kernel, tiered_kernel
from eventpound.numerics.lcp import EPS
from eventpound.numerics.lending import lend
from eventpound.solvers.events.dense import Dense
from eventpound.solvers.events.integrator import Bounds
from eventpound.solvers.events.journal import PASSED, is_due, write_row
from eventpound.solvers.events.run import observed_in
from eventpound.solvers.events.step_check import (
    BEYOND_BOUND,
    CLEAR,
    NOT_FINITE,
    Examination,
    Examined,
    opened,
)
from eventpound.solvers.sundials.callback_data import (
    BRACKET,
    DATA,
    ROOT_RETURN,
    at_bounds,
    handed_arrays,
)
from eventpound.solvers.sundials.descriptor_modes import first_kink, may_pass_kink
from eventpound.solvers.sundials.descriptor_steps import (
    Followed,
    Problem,
    Tolerances,
    begin_descriptor,
    examine_descriptor,
    from_clusters,
    look_at_descriptor,
    look_from_clusters,
    to_clusters,
)
from eventpound.solvers.sundials.library import (
    array_pointer,
    ida_get_dky,
    ida_last_order,
    ida_library,
    ida_set_stop_time,
    ida_solve,
    matrix_data,
)

if ida_library() is None:
    # What follows is linked when it is loaded, and a missing symbol would end the process.
    raise ImportError("the SUNDIALS library cannot be reached from compiled code")

ONE_STEP = 2
"""SUNDIALS' IDA_ONE_STEP."""
REACHED, TURNED = 0, 1
"""Places of `Handles.reached`: where IDA is, and where its last step ended at the kink of a contact
law, from which it must begin anew (s)."""
NEVER = -1.0
"""No time: it has not."""
_SAMPLES = int(Family.SAMPLES)


class Handles(NamedTuple):
    """Addresses of an IDA object, its vectors and its `DATA`; where times and drifts are put.

    look: a vector for interpolated unknowns. state, rate: values of the first two vectors.
    drift (2,), acceleration: of `Followed`. time: the scene's own T (s).
    """

    memory: int
    vector: int
    rate_vector: int
    look: int
    state: int
    rate: int
    data: int
    reached: Floats
    drift: Floats
    acceleration: float
    time: float


@kernel
def _problem(given: Any) -> Problem:
    """The mode, the forcing and the frame of a `DATA`."""
    ints, floats, forcing, frame = handed_arrays(given)
    return Problem(unpack_descriptor(ints, floats), forcing, frame)


def _residual(tau: float, y: int, rate: int, out: int, data: int) -> int:
    """IDA's callback, an `IDAResFn`."""
    given = array_at(data, 1, DATA)[0]
    given.calls += 1
    problem = _problem(given)
    residual(
        tau,
        array_at(array_pointer(y), given.size, np.float64),
        array_at(array_pointer(rate), given.size, np.float64),
        array_at(array_pointer(out), given.size, np.float64),
        problem.d,
        problem.forcing,
        problem.frame,
    )
    return 0


def _jacobian(
    tau: float,
    cj: float,
    y: int,
    rate: int,
    out: int,
    matrix: int,
    data: int,
    first: int,
    second: int,
    third: int,
) -> int:
    """IDA's callback, an `IDALsJacFn`; its matrix is stored column by column."""
    given = array_at(data, 1, DATA)[0]
    problem = _problem(given)
    columns = array_at(matrix_data(matrix), (given.size, given.size), np.float64)
    y_values = array_at(array_pointer(y), given.size, np.float64)
    jacobian(tau, y_values, cj, columns.T, problem.d, problem.forcing, problem.frame)
    return 0


_address, _real = types.intp, types.float64
residual_callback: Any = callback(
    _residual, types.intc(_real, _address, _address, _address, _address)
)
jacobian_callback: Any = callback(
    _jacobian,
    types.intc(
        _real, _real, _address, _address, _address, _address, _address,
        _address, _address, _address,
    ),
)  # fmt: skip


@loop_kernel
def advance(
    handles: Handles, tau: float, first: int, excess: float, bounds: Bounds, examined: Examined
) -> tuple[int, int, float, float, int, float, int]:
    """Steps from `tau` (s), each examined, as `Integrator.advance` says.

    IDA's last flag, then the numbers of the `Stretch`.

    No step goes beyond a sample of a record.
    """
    e = lend(opened(examined))
    ints, floats, _, _ = handed_arrays(array_at(handles.data, 1, DATA)[0])
    drift, acceleration = borrow(handles.drift), handles.acceleration
    followed = lend(Followed(unpack_descriptor(ints, floats), drift, acceleration))
    d, forcing = followed.d, e.forcing
    state = array_at(array_pointer(handles.vector), d.size, np.float64)
    y = np.empty(d.size)
    origin, start, steps = forcing.start, tau, 0
    while True:
        stop = bounds.stop
        if forcing.family >= _SAMPLES:
            stop = next_corner(forcing, origin + start, origin + stop) - origin
        ida_set_stop_time(handles.memory, stop)
        flag = ida_solve(
            handles.memory,
            stop,
            handles.reached.ctypes.data,
            handles.vector,
            handles.rate_vector,
            ONE_STEP,
        )
        end = handles.reached[REACHED]
        if flag < 0 or end <= start:
            return flag, first, start, end, CLEAR, excess, steps
        turned = np.inf
        if d.way.size > 0:
            last = end - BRACKET * EPS * (abs(end) + end - start) if flag == ROOT_RETURN else end
            turned = _to_kink(handles, start, end, last, first, e, d)
        if turned < np.inf:
            flag, end = 0, turned
        elif flag == ROOT_RETURN:
            return flag, first, start, end, CLEAR, excess, steps
        copy_numbers(state, y)
        to_moving_frame(d, e.frame, origin + end, -1.0, y)
        if turned < np.inf:
            solve_contact_forces(end, y, d, forcing)
        verdict, reached = examine_descriptor(
            start, end, first, max(e.z_allowed, excess), y, e, followed
        )
        if verdict in (NOT_FINITE, BEYOND_BOUND):
            return flag, first, start, end, verdict, reached, steps
        excess, steps = reached, steps + 1
        if verdict == CLEAR and is_due(origin + end, e.journal):
            _write_samples(handles, start, end, e, d)
        if verdict != CLEAR or turned < np.inf or at_bounds(end, steps, bounds):
            return flag, first, start, end, verdict, excess, steps
        start, first = end, 1 - first


@kernel
def _to_kink(
    handles: Handles,
    start: float,
    end: float,
    last: float,
    first: int,
    e: Examination,
    d: Descriptor,
) -> float:
    """Where in a step a contact law passes its kink (s); inf for nowhere up to `last` (s).

    Then the unknowns are those there, and the law keeps to the other side.
    """
    mode, origin = e.dynamics, e.forcing.start
    state = array_at(array_pointer(handles.vector), d.size, np.float64)
    y = state.copy()
    to_moving_frame(d, e.frame, origin + end, -1.0, y)
    if not may_pass_kink(observed_in(e.looks[first], mode), y, end - start, d):
        return np.inf
    order = np.zeros(1, np.int32)
    ida_last_order(handles.memory, order.ctypes.data)
    Y = _of_clusters(handles.memory, handles.look, d.size, end, order[0], mode.system, mode.bodies)
    dense = Dense(Y, end, start, end, e.frame, False, Y[:0])
    turned = first_kink(dense, last, origin, mode.system, d)
    if turned < np.inf:
        ida_get_dky(handles.memory, turned, 0, handles.vector)
        handles.reached[TURNED] = turned
    return turned


@kernel
def _write_samples(
    handles: Handles, start: float, end: float, e: Examination, d: Descriptor
) -> None:
    """History at the output times of a step, on IDA's own polynomial."""
    journal, forcing = e.journal, e.forcing
    origin = forcing.start
    y = array_at(array_pointer(handles.look), d.size, np.float64)
    seen = observed_in(e.looks[4], e.dynamics)
    while is_due(origin + end, journal):
        t = journal.times[journal.cursor[PASSED]]
        if t >= origin + start:
            tau = max(t - origin, start)
            ida_get_dky(handles.memory, tau, 0, handles.look)
            to_moving_frame(d, e.frame, origin + tau, -1.0, y)
            look_at_descriptor(tau, y, d, forcing, seen)
            write_row(t, seen, journal)
        journal.cursor[PASSED] += 1


# What follows takes numbers, flat arrays and small groups: numba takes several times as long
# to tell the type of a whole mode as these functions take.


@tiered_kernel(3.0)
def begin(
    handles: Handles,
    tau: float,
    clusters: Floats,
    ints: Ints,
    floats: Floats,
    tolerances: Tolerances,
    flat: Floats,
) -> float:
    """`begin_descriptor` of the state and the rates of `handles`, from the loop's state.

    `ints`, `floats`: the loop's mode (`eventpound.mechanics.packing`); `flat` is scratch for
    an `Observed`.
    """
    problem = lend(_problem(array_at(handles.data, 1, DATA)[0]))
    system = unpack_system(ints, floats)
    bodies = unpack_bodies(ints, floats, system)
    size = problem.d.size
    y = array_at(handles.state, size, np.float64)
    rate = array_at(handles.rate, size, np.float64)
    from_clusters(clusters, system, bodies, y)
    seen = unpack_observed(flat, ints[2], ints[3], ints[4], ints[5])
    return begin_descriptor(tau, y, rate, problem, tolerances, handles.time, seen)


@tiered_kernel(1.5)
def look_at_start(
    data: int, tau: float, clusters: Floats, ints: Ints, floats: Floats, flat: Floats
) -> None:
    """Observe the loop's state at the start of a segment into the flat array of an `Observed`."""
    problem = lend(_problem(array_at(data, 1, DATA)[0]))
    system = unpack_system(ints, floats)
    bodies = unpack_bodies(ints, floats, system)
    seen = unpack_observed(flat, ints[2], ints[3], ints[4], ints[5])
    look_from_clusters(tau, clusters, system, bodies, problem.d, problem.forcing, seen)


@kernel
def derivatives(
    memory: int, vector: int, data: int, t: float, order: int, ints: Ints, floats: Floats
) -> Floats:
    """Coefficients of IDA's own polynomial of its last step about `t` (s), as the loop knows it.

    Parameters
    ----------
    memory, vector, data : int
        Addresses of an IDA object, of a vector, which is overwritten, and of a `DATA`.
    t : float
        Local time (s).
    order : int
        Of the step.
    ints, floats : ndarray
        The loop's mode (`eventpound.mechanics.packing`).

    Returns
    -------
    ndarray, shape (order + 1, size)
        ``y^(k) / k!`` of the clusters, in the moving frame.
    """
    system = unpack_system(ints, floats)
    bodies = unpack_bodies(ints, floats, system)
    given = array_at(data, 1, DATA)[0]
    return _of_clusters(memory, vector, given.size, t, order, system, bodies)


@kernel
def _of_clusters(
    memory: int, vector: int, size: int, t: float, order: int, system: Reduced, bodies: Bodies
) -> Floats:
    """`derivatives` of `size` unknowns."""
    y = array_at(array_pointer(vector), size, np.float64)
    Y, factorial = np.empty((order + 1, system.size)), 1.0
    for k in range(order + 1):
        ida_get_dky(memory, t, k, vector)
        factorial *= max(k, 1)
        to_clusters(y, 1.0 if k == 0 else 0.0, system, bodies, Y[k])
        for i in range(system.size):
            Y[k, i] /= factorial
    return Y
