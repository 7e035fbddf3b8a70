"""Events that IDA's own root finder finds (``IDARootInit``)."""

from __future__ import annotations

import numpy as np
from numba import types

from eventpound.mechanics.descriptor import Descriptor
from eventpound.mechanics.descriptor_motion import dot, to_moving_frame
from eventpound.mechanics.observables import Observed
from eventpound.numerics.arrays import Floats
from eventpound.numerics.borrowing import array_at
from eventpound.numerics.compiled import kernel
from eventpound.solvers.events.roots import any_fell
from eventpound.solvers.events.run import Dynamics
from eventpound.solvers.events.step_check import BEYOND_BOUND, CLEAR, HAPPENED
from eventpound.solvers.sundials.callback_data import address_of, evaluate, first_zero
from eventpound.solvers.sundials.descriptor_steps import look_at_descriptor, to_clusters
from eventpound.solvers.sundials.ida_stepping import Given, Handles
from eventpound.solvers.sundials.library import array_pointer, ida_current_time, ida_get_dky


@kernel
def _observe_positions(y: Floats, d: Descriptor, out: Observed) -> None:
    """Fill u, v and the values and first rates of gaps and elongations from the unknowns."""
    N = d.mass.size
    u, v = y[:N], y[N : 2 * N]
    for link in range(d.stiffness.size):
        out.elongation[0, link] = dot(d.B[link], u)
        out.elongation[1, link] = dot(d.B[link], v)
    for j in range(d.all_openings.size):
        out.gap[0, j] = d.all_openings[j] + dot(d.all_gaps[j], u)
        out.gap[1, j] = dot(d.all_gaps[j], v)


@kernel
def _functions(tau: float, y: Floats, given: Given, out: Floats) -> None:
    """The functions of unknowns relative to the ground; their λ is overwritten."""
    problem, roots = given.problem, given.roots
    if roots.forces:
        look_at_descriptor(tau, y, problem.d, problem.forcing, roots.seen)
    else:
        _observe_positions(y, problem.d, roots.seen)
    evaluate(roots, out)


@kernel
def _relative(tau: float, y: Floats, given: Given) -> Floats:
    """Unknowns in the moving frame, relative to the ground."""
    problem, result = given.problem, y.copy()
    to_moving_frame(problem.d, problem.frame, problem.forcing.start + tau, -1.0, result)
    return result


def _root_functions(tau: float, y: int, rate: int, out: int, given: Given) -> int:
    """IDA's callback, an `IDARootFn`."""
    size, count = given.problem.d.size, given.roots.noise.size
    state = _relative(tau, array_at(array_pointer(y), size, np.float64), given)
    _functions(tau, state, given, array_at(out, 2 * count, np.float64))
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
    """`eventpound.solvers.sundials.root_stepping.at_root` for IDA.

    `clusters` (size,): a state of the loop's `mode`.
    """
    given, memory = handles.given, handles.memory
    roots, size = given.roots, given.problem.d.size
    y = _relative(tau, array_at(handles.state, size, np.float64), given)
    _functions(tau, y, given, roots.pairs.reshape(2 * roots.noise.size))
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
    to_clusters(_relative(end, last, given), 1.0, mode.system, mode.bodies, clusters)
    return HAPPENED, end
