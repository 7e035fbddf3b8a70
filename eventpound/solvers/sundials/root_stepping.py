"""Events that CVODE's own root finder finds (``CVodeRootInit``).

Of a state in which no contact rests it is asked for gaps and elongations alone, a fraction of
all that `eventpound.mechanics.observables` has of it.
"""

from __future__ import annotations

import numpy as np
from numba import types

from eventpound.mechanics.ground_frame import to_frame
from eventpound.mechanics.observables import (
    Bodies,
    Observed,
    bodies_motion,
    difference,
    observe_gaps,
    observe_motion,
)
from eventpound.numerics.arrays import Floats
from eventpound.numerics.borrowing import array_at
from eventpound.numerics.compiled import kernel
from eventpound.solvers.events.roots import any_fell
from eventpound.solvers.events.step_check import BEYOND_BOUND, CLEAR, HAPPENED
from eventpound.solvers.sundials.callback_data import address_of, evaluate, first_zero
from eventpound.solvers.sundials.library import array_pointer, current_time, get_dky
from eventpound.solvers.sundials.stepping import Given, Handles


@kernel
def _observe_positions(y: Floats, bodies: Bodies, out: Observed) -> None:
    """Fill u, v and the values and first rates of gaps and elongations from the state.

    `y` (size,): that of the clusters, relative to the ground.
    """
    bodies_motion(y, bodies, out.u, out.v)
    for link in range(bodies.stiffness.size):
        first, second = bodies.link_ends[link, 0], bodies.link_ends[link, 1]
        out.elongation[0, link] = difference(out.u, first, second)
        out.elongation[1, link] = difference(out.v, first, second)
    observe_gaps(bodies, out)


@kernel
def _functions(tau: float, y: Floats, given: Given, out: Floats) -> None:
    system, bodies, forcing, roots = given.system, given.bodies, given.forcing, given.roots
    state = y.copy()
    to_frame(given.frame, forcing.start + tau, -1.0, system.iq, system.iv, state)
    if roots.forces:
        rate = np.empty(state.size)
        observe_motion(tau, state, rate, system, bodies, forcing, roots.seen)
    else:
        _observe_positions(state, bodies, roots.seen)
    evaluate(roots, out)


def _root_functions(tau: float, y: int, out: int, given: Given) -> int:
    """CVODE's callback, a `CVRootFn`."""
    state = array_at(array_pointer(y), given.system.size, np.float64)
    _functions(tau, state, given, array_at(out, 2 * given.roots.noise.size, np.float64))
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
    _functions(tau, state, given, roots.pairs.reshape(2 * roots.noise.size))
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
