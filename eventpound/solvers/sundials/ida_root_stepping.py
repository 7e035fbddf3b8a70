"""Events that IDA's own root finder finds (``IDARootInit``)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import types

from eventpound.mechanics.descriptor import Descriptor, unpack_descriptor
from eventpound.mechanics.descriptor_motion import dot, to_moving_frame
from eventpound.mechanics.observables import Observed
from eventpound.mechanics.packing import unpack_bodies, unpack_system
from eventpound.numerics.arrays import Floats
from eventpound.numerics.borrowing import array_at, borrow
from eventpound.numerics.compiled import callback, kernel
from eventpound.solvers.events.roots import any_fell
from eventpound.solvers.events.run import ModeArrays
from eventpound.solvers.events.step_check import BEYOND_BOUND, CLEAR, HAPPENED
from eventpound.solvers.sundials.callback_data import (
    DATA,
    ROOTS,
    evaluate,
    first_zero,
    handed_arrays,
    seen_of,
)
from eventpound.solvers.sundials.descriptor_steps import look_at_descriptor, to_clusters
from eventpound.solvers.sundials.ida_stepping import Handles
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
def _functions(tau: float, y: Floats, data: int, out: Floats) -> None:
    """The functions of unknowns relative to the ground; their λ is overwritten."""
    given = array_at(data, 1, DATA)[0]
    roots = array_at(given.roots, 1, ROOTS)[0]
    ints, floats, forcing, _ = handed_arrays(given)
    d = unpack_descriptor(ints, floats)
    if roots.forces == 0:
        _observe_positions(y, d, seen_of(roots))
    else:
        look_at_descriptor(tau, y, d, forcing, seen_of(roots))
    evaluate(roots, out)


@kernel
def _relative(tau: float, y: Floats, data: int) -> Floats:
    """Unknowns in the moving frame, relative to the ground."""
    given = array_at(data, 1, DATA)[0]
    ints, floats, _, frame = handed_arrays(given)
    result = y.copy()
    to_moving_frame(unpack_descriptor(ints, floats), frame, given.start + tau, -1.0, result)
    return result


def _root_functions(tau: float, y: int, rate: int, out: int, data: int) -> int:
    """IDA's callback, an `IDARootFn`."""
    given = array_at(data, 1, DATA)[0]
    roots = array_at(given.roots, 1, ROOTS)[0]
    state = _relative(tau, array_at(array_pointer(y), given.size, np.float64), data)
    _functions(tau, state, data, array_at(out, 2 * roots.count, np.float64))
    return 0


root_callback: Any = callback(
    _root_functions,
    types.intc(types.float64, types.intp, types.intp, types.intp, types.intp),
)


@kernel
def at_root(
    handles: Handles,
    mode: ModeArrays,
    start: float,
    tau: float,
    bound: Floats,
    allowed: float,
    clusters: Floats,
) -> tuple[int, float]:
    """`eventpound.solvers.sundials.root_stepping.at_root` for IDA.

    `clusters` (size,): a state of the loop's `mode`.
    """
    data, memory = handles.data, handles.memory
    given = array_at(data, 1, DATA)[0]
    roots = array_at(given.roots, 1, ROOTS)[0]
    pairs = array_at(roots.pairs, (roots.count, 2), np.float64)
    y = _relative(tau, array_at(handles.state, given.size, np.float64), data)
    _functions(tau, y, data, pairs.reshape(2 * roots.count))
    if not any_fell(pairs):
        return CLEAR, tau
    whole = np.empty(1)
    ida_current_time(memory, whole.ctypes.data)
    ida_get_dky(memory, whole[0], 0, handles.look)
    last = array_at(array_pointer(handles.look), given.size, np.float64)
    ints, floats = borrow(mode.ints), borrow(mode.floats)
    system = unpack_system(ints, floats)
    bodies = unpack_bodies(ints, floats, system)
    for h in range(bound.size):
        if abs(last[2 * bodies.mass.size + h]) - bound[h] > allowed:
            return BEYOND_BOUND, whole[0]
    end = first_zero(roots, pairs, start, tau, whole[0])
    ida_get_dky(memory, end, 0, handles.look)
    to_clusters(_relative(end, last, data), 1.0, system, bodies, clusters)
    return HAPPENED, end
