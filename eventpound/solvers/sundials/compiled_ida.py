"""IDA called from compiled code: the motion in descriptor form between events."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.descriptor_motion import DescriptorProblem, jacobian
from eventpound.mechanics.observables import Observed
from eventpound.numerics.arrays import Floats
from eventpound.numerics.borrowing import array_at
from eventpound.numerics.by_address import with_address
from eventpound.numerics.compiled import kernel
from eventpound.numerics.compiled.recipe import EVERY_STEP
from eventpound.solvers.events.integrator import Bounds, Start, last_time
from eventpound.solvers.events.run import Dynamics
from eventpound.solvers.events.step_check import Examination
from eventpound.solvers.sundials.callback_data import Roots, SegmentData, address_of, put_roots
from eventpound.solvers.sundials.descriptor_modes import DescriptorMode, DescriptorModes
from eventpound.solvers.sundials.descriptor_steps import (
    examine_descriptor,
    full_residual,
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
from eventpound.solvers.sundials.loop import Numbers, carry_on, polynomial, root_at, shown, step_to
from eventpound.solvers.sundials.memory import IdaMemory

if ida_library() is None:
    # What follows is linked when it is loaded, and a missing symbol would end the process.
    raise ImportError("the SUNDIALS library cannot be reached from compiled code")


class IdaData(NamedTuple):
    """What IDA's callbacks are handed, with an address, as `problem` and `mode` have."""

    segment: SegmentData
    problem: DescriptorProblem
    mode: Dynamics


class IdaHandles(NamedTuple):
    """Addresses of an IDA object and its vectors.

    interpolated: a vector for unknowns. given: what its callbacks are handed. reached (1,): where
    IDA is (s).
    """

    memory: int
    vector: int
    rate_vector: int
    interpolated: int
    given: IdaData
    reached: Floats


def residual_function(tau: float, y: int, rate: int, out: int, given: IdaData) -> int:
    """IDA's callback, an `IDAResFn`."""
    given.segment.calls[0] += 1
    problem, size = given.problem, given.problem.d.size
    full_residual(
        tau,
        array_at(array_pointer(y), size, np.float64),
        array_at(array_pointer(rate), size, np.float64),
        array_at(array_pointer(out), size, np.float64),
        problem,
        given.mode,
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
    given.segment.calls[1] += 1
    problem, size = given.problem, given.problem.d.size
    columns = array_at(matrix_data(matrix), (size, size), np.float64)
    y_values = array_at(array_pointer(y), size, np.float64)
    jacobian(tau, y_values, cj, columns.T, problem)
    return 0


@kernel.but(recipe=EVERY_STEP)
def advance(
    handles: IdaHandles, tau: float, first: int, excess: float, bounds: Bounds, e: Examination
) -> Numbers:
    """Steps from `tau` (s), each examined, as `Integrator.advance` says.

    IDA's last flag, then the numbers of `StepsTaken`.
    """
    return carry_on(_take, _check, _shown, handles, tau, first, excess, bounds, e)


@kernel
def _take(
    handles: IdaHandles, start: float, first: int, bounds: Bounds, e: Examination
) -> tuple[int, float]:
    """A step from `start` (s); see `carry_on`."""
    flag = step_to(_solve, _whole_end, handles, start, last_time(start, bounds, e.forcing))
    return flag, handles.reached[0]


@kernel
def _solve(handles: IdaHandles, stop: float) -> int:
    ida_set_stop_time(handles.memory, stop)
    reached, y, rate = handles.reached.ctypes.data, handles.vector, handles.rate_vector
    return ida_solve(handles.memory, stop, reached, y, rate, ONE_STEP)


@kernel
def _whole_end(handles: IdaHandles) -> float:
    """End of IDA's whole step (s)."""
    whole = np.empty(1)
    ida_current_time(handles.memory, whole.ctypes.data)
    return whole[0]


@kernel
def _check(
    handles: IdaHandles, start: float, end: float, first: int, allowed: float, e: Examination
) -> tuple[int, float]:
    """`examine_descriptor`."""
    problem, y = handles.given.problem, _unknowns(handles.vector, handles)
    return examine_descriptor(start, end, first, allowed, y, problem, e)


@kernel
def _shown(of: tuple[IdaHandles, Examination], tau: float) -> Observed:
    """`shown`."""
    return shown(_put_inner, of, tau)


@kernel
def derivatives(handles: IdaHandles, t: float) -> Floats:
    """`polynomial` of IDA; the state that it interpolates is overwritten."""
    order = np.zeros(1, np.int32)
    ida_last_order(handles.memory, order.ctypes.data)
    return polynomial(_put_inner, handles, order[0], t, handles.given.segment.system.size)


@kernel
def _put_inner(handles: IdaHandles, tau: float, k: int, clusters: Floats) -> None:
    ida_get_dky(handles.memory, tau, k, handles.interpolated)
    y, mode = _unknowns(handles.interpolated, handles), handles.given.mode
    # Offsets in clusters are constants, so a derivative has none.
    to_clusters(y, 1.0 if k == 0 else 0.0, mode.system, mode.bodies, clusters)


@kernel
def _unknowns(vector: int, handles: IdaHandles) -> Floats:
    """Values of a vector."""
    return array_at(array_pointer(vector), handles.given.problem.d.size, np.float64)


@kernel
def _put_roots(tau: float, y: Floats, given: IdaData, out: Floats) -> None:
    mode, state = given.mode, np.empty(given.mode.system.size)
    to_clusters(y, 1.0, mode.system, mode.bodies, state)
    put_roots(tau, state, given.segment, out)


def root_functions(tau: float, y: int, rate: int, out: int, given: IdaData) -> int:
    """IDA's callback, an `IDARootFn`."""
    functions = array_at(out, 2 * given.segment.roots.noise.size, np.float64)
    _put_roots(tau, array_at(array_pointer(y), given.problem.d.size, np.float64), given, functions)
    return 0


@kernel
def _values(handles: IdaHandles, tau: float) -> Roots:
    """Root functions at `tau` (s), where IDA is."""
    given, roots = handles.given, handles.given.segment.roots
    out = roots.pairs.reshape(2 * roots.noise.size)
    _put_roots(tau, _unknowns(handles.vector, handles), given, out)
    return roots


@kernel
def at_root(
    handles: IdaHandles, start: float, tau: float, first: int, excess: float, e: Examination
) -> tuple[int, float]:
    """`root_at` for IDA."""
    return root_at(_values, _whole_end, _put_inner, handles, start, tau, first, excess, e)


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
        self._hand(IdaData(self._segment, self._problem, self._mode.dynamics))
        memory = self._memory = self._memory_for(own)
        vectors = memory.vector, memory.rate_vector, memory.interpolated
        self._handles = _handles_with(self._given, memory.address, *vectors)
        memory.start(tau, self._first_step(tau, y, memory.unknowns, memory.rates))
        if self._roots is not None:
            callback = address_of(root_functions, self._given, 3)
            memory.find_roots(callback, self._roots.directions)

    def _handles_of(self, start: Start) -> IdaHandles:
        given = IdaData(self._segment_of(start), self._problem_of(start), start.mode.dynamics)
        return _handles_with(with_address(given))

    def _memory_for(self, own: DescriptorMode) -> IdaMemory:
        rtol, atol = own.local_tolerances(self._segment.frame)
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


def _handles_with(
    given: IdaData, memory: int = 0, vector: int = 0, rate_vector: int = 0, interpolated: int = 0
) -> IdaHandles:
    handles = IdaHandles(memory, vector, rate_vector, interpolated, given, np.zeros(1))
    return with_address(handles)
