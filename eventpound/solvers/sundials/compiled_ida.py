"""IDA called from compiled code: the motion in descriptor form between events."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.descriptor_motion import (
    DescriptorProblem,
    jacobian,
    relative_to_ground,
    residual,
    to_moving_frame,
)
from eventpound.mechanics.observables import Observed
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.borrowing import array_at
from eventpound.numerics.compiled import kernel, loop_kernel
from eventpound.numerics.lending import on_loan
from eventpound.solvers.events.integrator import Bounds, last_time
from eventpound.solvers.events.recorder import write_samples
from eventpound.solvers.events.run import Dynamics
from eventpound.solvers.events.step_check import Examination
from eventpound.solvers.sundials.callback_data import Roots, address_of
from eventpound.solvers.sundials.descriptor_modes import DescriptorMode, DescriptorModes
from eventpound.solvers.sundials.descriptor_steps import (
    Followed,
    Tolerances,
    begin_descriptor,
    examine_descriptor,
    from_clusters,
    look_at_descriptor,
    to_clusters,
)
from eventpound.solvers.sundials.integrators import Direct, InDescriptorForm
from eventpound.solvers.sundials.library import (
    ONE_STEP,
    IdaLibrary,
    array_pointer,
    ida_current_time,
    ida_get_dky,
    ida_last_order,
    ida_library,
    ida_set_stop_time,
    ida_solve,
    matrix_data,
)
from eventpound.solvers.sundials.loop import ROOT_RETURN, Numbers, carry_on, root_at, was_told
from eventpound.solvers.sundials.memory import IdaMemory
from eventpound.solvers.sundials.root_values import descriptor_roots

if ida_library() is None:
    # What follows is linked when it is loaded, and a missing symbol would end the process.
    raise ImportError("the SUNDIALS library cannot be reached from compiled code")


class IdaData(NamedTuple):
    """What IDA's callbacks are handed, on loan.

    calls (2,): of the residual and of its Jacobian. problem, roots: on loan themselves.
    """

    calls: Ints
    problem: DescriptorProblem
    roots: Roots


class IdaHandles(NamedTuple):
    """Addresses of an IDA object and its vectors; where times and drifts are put; on loan.

    look: a vector for interpolated unknowns. state, rate: values of the first two vectors.
    given: what its callbacks are handed. mode: the loop's. reached (1,): where IDA is (s).
    followed: whose steps. time: the scene's own T (s).
    """

    memory: int
    vector: int
    rate_vector: int
    look: int
    state: int
    rate: int
    given: IdaData
    mode: Dynamics
    reached: Floats
    followed: Followed
    time: float


def residual_function(tau: float, y: int, rate: int, out: int, given: IdaData) -> int:
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


def jacobian_function(
    tau: float,
    cj: float,
    y: int,
    rate: int,
    out: int,
    matrix: int,
    given: IdaData,
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


@loop_kernel
def advance(
    handles: IdaHandles, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
) -> Numbers:
    """Steps from `tau` (s), each examined, as `Integrator.advance` says.

    IDA's last flag, then the numbers of `StepsTaken`.
    """
    return carry_on(_take, _check, _write, handles, tau, first, excess, bounds, e)


@kernel
def _take(
    handles: IdaHandles, start: float, first: int, bounds: Bounds, e: Examination
) -> tuple[int, float, bool]:
    """A step from `start` (s), not beyond a sample of a record; see `carry_on`."""
    flag = 0
    if handles.reached[0] <= start or not _stands_at_end(handles, start):
        stop = last_time(start, True, bounds, e.forcing)
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
    return flag, end, not (flag < 0 or end <= start or flag == ROOT_RETURN)


@kernel
def _stands_at_end(handles: IdaHandles, start: float) -> bool:
    """`was_told` of a step from `start` (s) in which IDA has stopped."""
    whole = np.empty(1)
    ida_current_time(handles.memory, whole.ctypes.data)
    return was_told(start, handles.reached[0], whole[0])


@kernel
def _check(
    handles: IdaHandles, start: float, end: float, first: int, allowed: float, e: Examination
) -> tuple[int, float]:
    """`examine_descriptor`."""
    problem = handles.given.problem
    state = array_at(handles.state, problem.d.size, np.float64)
    y = relative_to_ground(end, state, problem)
    return examine_descriptor(start, end, first, allowed, y, e, handles.followed)


@kernel
def _write(handles: IdaHandles, start: float, end: float, e: Examination) -> None:
    """History at the output times of a step."""
    write_samples(_shown, (handles, e), e.forcing.start, start, end, e.record.journal)


@kernel
def _shown(of: tuple[IdaHandles, Examination], tau: float) -> Observed:
    """The motion at `tau` (s) of the last step, as it is observed."""
    handles, e = of
    problem = handles.given.problem
    y = array_at(array_pointer(handles.look), problem.d.size, np.float64)
    ida_get_dky(handles.memory, tau, 0, handles.look)
    to_moving_frame(problem, tau, -1.0, y)
    look_at_descriptor(tau, y, problem, e.looks[4])
    return e.looks[4]


@kernel
def begin(
    handles: IdaHandles, tau: float, clusters: Floats, tolerances: Tolerances, scratch: Observed
) -> float:
    """`begin_descriptor` of the state and the rates of `handles`, from the loop's state.

    `scratch` is overwritten.
    """
    problem, mode = handles.given.problem, handles.mode
    size = problem.d.size
    y = array_at(handles.state, size, np.float64)
    rate = array_at(handles.rate, size, np.float64)
    from_clusters(clusters, mode.system, mode.bodies, y)
    return begin_descriptor(tau, y, rate, problem, tolerances, handles.time, scratch)


@kernel
def derivatives(handles: IdaHandles, t: float) -> Floats:
    """Coefficients of IDA's own polynomial of its last step about `t` (s), as the loop knows it.

    Parameters
    ----------
    handles : IdaHandles
        The IDA object; the state that it interpolates is overwritten.
    t : float
        Local time (s).

    Returns
    -------
    ndarray, shape (order + 1, size)
        ``y^(k) / k!`` of the clusters, in the moving frame.
    """
    memory, look, mode = handles.memory, handles.look, handles.mode
    system = mode.system
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


def root_functions(tau: float, y: int, rate: int, out: int, given: IdaData) -> int:
    """IDA's callback, an `IDARootFn`."""
    size, count = given.problem.d.size, given.roots.noise.size
    state = relative_to_ground(tau, array_at(array_pointer(y), size, np.float64), given.problem)
    functions = array_at(out, 2 * count, np.float64)
    descriptor_roots(tau, state, given.problem, given.roots, functions)
    return 0


@kernel
def _values(handles: IdaHandles, tau: float) -> Roots:
    """Root functions at `tau` (s), where IDA is."""
    given, roots = handles.given, handles.given.roots
    state = array_at(handles.state, given.problem.d.size, np.float64)
    y = relative_to_ground(tau, state, given.problem)
    descriptor_roots(tau, y, given.problem, roots, roots.pairs.reshape(2 * roots.noise.size))
    return roots


@kernel
def _whole_step(handles: IdaHandles) -> tuple[float, Floats]:
    """End of IDA's whole step (s), and every z there."""
    whole, d = np.empty(1), handles.given.problem.d
    ida_current_time(handles.memory, whole.ctypes.data)
    ida_get_dky(handles.memory, whole[0], 0, handles.look)
    last = array_at(array_pointer(handles.look), d.size, np.float64)
    first = 2 * d.mass.size
    return whole[0], last[first : first + d.hysteretic].copy()


@kernel
def _put(handles: IdaHandles, tau: float, clusters: Floats) -> None:
    """Fill in the loop's state at `tau` (s) of the last step, relative to the ground."""
    problem, mode = handles.given.problem, handles.mode
    ida_get_dky(handles.memory, tau, 0, handles.look)
    look = array_at(array_pointer(handles.look), problem.d.size, np.float64)
    y = relative_to_ground(tau, look, problem)
    to_clusters(y, 1.0, mode.system, mode.bodies, clusters)


@kernel
def at_root(
    handles: IdaHandles, start: float, tau: float, bound: Floats, allowed: float, clusters: Floats
) -> tuple[int, float]:
    """`root_at` for IDA."""
    return root_at(_values, _whole_step, _put, handles, start, tau, bound, allowed, clusters)


class DirectIda(InDescriptorForm, Direct):
    """An `eventpound.solvers.events.integrator.Integrator`.

    Parameters
    ----------
    library : IdaLibrary
        See `eventpound.solvers.sundials.library.ida_library`.
    modes : DescriptorModes
        The forms that the scene takes.
    """

    _kernels = advance, at_root, derivatives

    def __init__(self, library: IdaLibrary, modes: DescriptorModes) -> None:
        super().__init__(modes)
        self.library = library

    def _meaning(self, flag: int) -> str:
        # Only a run that fails pays for scikit-sundae, which brings SciPy.
        from sksundae._cy_ida import IDAMESSAGES

        return IDAMESSAGES[flag]

    def _begin(self, tau: float, y: Floats, atol: Floats) -> None:
        own = self._own
        self._hand(IdaData(self._calls, self._problem, self._present_roots))
        memory = self._memory = self._memory_for(own)
        self._handles = on_loan(
            IdaHandles(
                memory.address,
                memory.vector,
                memory.rate_vector,
                memory.look,
                memory.state_address,
                memory.rate_address,
                self._given,
                self._mode.dynamics,
                np.zeros(1),
                self._followed,
                self.scales.time,
            )
        )
        tolerances = own.local_tolerances(self._frame)
        memory.start(tau, begin(self._handles, tau, y, tolerances, self._scratch))
        if self._roots is not None:
            callback = address_of(root_functions, self._given, 3)
            memory.find_roots(callback, self._roots.directions)

    def _memory_for(self, own: DescriptorMode) -> IdaMemory:
        rtol, atol = own.local_tolerances(self._frame)
        key = rtol, atol.tobytes(), own.algebraic.tobytes()
        if key not in self._memories:
            self._memories[key] = IdaMemory(
                self.library,
                rtol,
                atol,
                own.algebraic,
                address_of(residual_function, self._given, 3),
                address_of(jacobian_function, self._given, 4, reals=2, after=3),
                self._given.address,
            )
        found: IdaMemory = self._memories[key]
        return found
