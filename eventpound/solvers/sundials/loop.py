"""The steps of CVODE and of IDA: one loop, and what a root of their own root finders means.

What differs comes as functions of `handles`: compiled ones of addresses, or methods of an
integrator in Python, which runs the same loop.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.solvers.events.dense import Dense
from eventpound.solvers.events.integrator import Bounds
from eventpound.solvers.events.reversals import NEGLIGIBLE, first_reversal, may_reverse
from eventpound.solvers.events.roots import any_fell, on_the_root
from eventpound.solvers.events.step_check import (
    BEYOND_BOUND,
    CLEAR,
    HAPPENED,
    NOT_FINITE,
    Examination,
)
from eventpound.solvers.sundials.callback_data import Roots
from eventpound.tolerances import EPS

ROOT_RETURN = 2
"""Flag of CVODE and IDA where one of their root functions, if they have any, has a root."""
SAME_ROOT = -22
"""Flag of theirs (ILL_INPUT) where roots are too near each other to be told apart."""
MOST_AGAIN = 1000
"""Roots at one time after which they are; several functions may well have theirs together."""
BRACKET = 100.0
"""Width of the bracket that SUNDIALS leaves of a root, in roundings of ``|t| + |h|``."""

Numbers = tuple[int, int, float, float, int, float, int]
"""A flag of SUNDIALS, then those of `StepsTaken`."""
Steps = Callable[[float, int, float, Bounds, Examination], Numbers]
"""`carry_on` from its fifth argument on."""
AtRoot = Callable[[float, float, Floats, float, Floats], tuple[int, float]]
"""`root_at` from its fifth argument on."""


@kernel
def carry_on(
    take: Callable[[Any, float, int, Bounds, Examination], tuple[int, float, bool]],
    check: Callable[[Any, float, float, int, float, Examination], tuple[int, float]],
    write: Callable[[Any, float, float, Examination], None],
    handles: Any,
    tau: float,
    first: int,
    excess: float,
    bounds: Bounds,
    e: Examination,
) -> Numbers:
    """Steps from `tau` (s), each examined, as `Integrator.advance` says.

    Parameters
    ----------
    take : callable
        A step from the state in a row to the other row: SUNDIALS' flag, where it ends (s), and
        whether it is to be examined.
    check : callable
        Its examination: `eventpound.solvers.events.step_check.examine`.
    write : callable
        Writes the history of a step in which nothing happened.
    handles
        What these are handed.
    tau, first, excess, bounds, e
        Of `Integrator.advance`.
    """
    start, steps = tau, 0
    while True:
        flag, end, going = take(handles, start, first, bounds, e)
        if not going:
            return flag, first, start, end, CLEAR, excess, steps
        verdict, reached = check(handles, start, end, first, max(e.z_allowed, excess), e)
        if verdict in (NOT_FINITE, BEYOND_BOUND):
            return flag, first, start, end, verdict, reached, steps
        excess, steps = reached, steps + 1
        if verdict == CLEAR:
            write(handles, start, end, e)
        if verdict != CLEAR or end >= bounds.stop or steps == bounds.most:
            return flag, first, start, end, verdict, excess, steps
        start, first = end, 1 - first


@scalar_kernel
def was_told(start: float, reached: float, whole: float) -> bool:
    """Whether a root that SUNDIALS told of, at `reached`, is the end of its whole step (s).

    It has no more of that step to come back with, and would go on to another.
    """
    return abs(whole - reached) <= BRACKET * EPS * (abs(whole) + whole - start)


@scalar_kernel
def before_root(start: float, tau: float) -> float:
    """Start of the bracket of a root at `tau` (s) of a step from `start` (s)."""
    return tau - BRACKET * EPS * (abs(tau) + tau - start)


@kernel
def reversal_in(
    dense: Callable[[Any, float, float], Dense],
    handles: Any,
    start: float,
    end: float,
    first: int,
    flag: int,
    rtol: float,
    direction: Floats,
    e: Examination,
) -> float:
    """When in a step from `start` to `end` a link reverses (s, local); inf where none does.

    A root at its end may be a reversal, and what it means is seen with the direction before it.

    Parameters
    ----------
    dense : callable
        The step on the integrator's own polynomial.
    handles
        What that is handed.
    start, end : float
        Of the step (s, local).
    first, flag : int
        Row of the state at its start, and SUNDIALS' flag at its end.
    rtol : float
        Of the motion: by a part of it z may err at a reversal that is left alone.
    direction : ndarray, shape (A,)
        Of each link; updated.
    e : Examination
        The segment, with the states at both ends.
    """
    before, after, rate, system = e.y[first], e.y[1 - first], e.rate[first], e.dynamics.system
    # Reversals after `last` are left alone.
    last, allowed = end, NEGLIGIBLE * rtol
    if flag == ROOT_RETURN:
        last, allowed = before_root(start, end), 0.0
    if not may_reverse(before, rate, after, end - start, system, direction, allowed):
        return np.inf
    return first_reversal(dense(handles, start, end), last, e.forcing.start, system, direction)


@kernel
def first_zero(roots: Roots, start: float, tau: float, whole: float) -> float:
    """`on_the_root` for a root at `tau` (s) of a step from `start` to `whole` (s)."""
    reach = BRACKET * EPS * (abs(whole) + whole - start)
    return on_the_root(roots.pairs, roots.noise, start, tau, reach)


@kernel
def root_at(
    values: Callable[[Any, float], Roots],
    whole_step: Callable[[Any], tuple[float, Floats]],
    put: Callable[[Any, float, Floats], None],
    handles: Any,
    start: float,
    tau: float,
    bound: Floats,
    allowed: float,
    y: Floats,
) -> tuple[int, float]:
    """What SUNDIALS' return with a root at `tau` (s) means, and where its step ends (s).

    Parameters
    ----------
    values : callable
        Fills and returns the functions at the root.
    whole_step : callable
        End of SUNDIALS' whole step (s), and every z there, (H,).
    put : callable
        Fills in the loop's state at a time of the step (s).
    handles
        What these are handed.
    start, tau : float
        Start of the step, and the root (s).
    bound, allowed : ndarray, shape (H,), and float
        Of every |z|, and by how much it may be exceeded at the end of the whole step.
    y : ndarray, shape (size,)
        State where the value was zero, relative to the ground; overwritten where one fell.

    Returns
    -------
    verdict : int
        CLEAR at the bottom of a dip that stays above zero, HAPPENED or BEYOND_BOUND.
    end : float
        Where the value was zero, or the end of a step that leapt over the knee of the hysteresis.
    """
    roots = values(handles, tau)
    if not any_fell(roots.pairs):
        return CLEAR, tau
    whole, z = whole_step(handles)
    for h in range(bound.size):
        if abs(z[h]) - bound[h] > allowed:
            return BEYOND_BOUND, whole
    end = first_zero(roots, start, tau, whole)
    put(handles, end, y)
    return HAPPENED, end


def steps_to_roots(
    steps: Steps,
    at_root: AtRoot,
    tau: float,
    first: int,
    excess: float,
    bounds: Bounds,
    e: Examination,
) -> Numbers:
    """Steps as of `eventpound.solvers.events.integrator.Integrator.advance`, and up to an event.

    Parameters
    ----------
    steps : callable
        The loop of an integrator.
    at_root : callable
        What one of its roots means.
    tau, first, excess, bounds, e
        Of `Integrator.advance`.
    """
    taken, last, again = 0, -np.inf, 0
    while True:
        rest = bounds._replace(most=bounds.most - taken)
        flag, row, start, end, verdict, excess, done = steps(tau, first, excess, rest, e)
        taken += done
        if flag != ROOT_RETURN:
            return flag, row, start, end, verdict, excess, taken
        verdict, end = at_root(start, end, e.z_bound, max(e.z_allowed, excess), e.y[1 - row])
        if verdict != CLEAR:
            return flag, row, start, end, verdict, excess, taken + int(verdict == HAPPENED)
        again = again + 1 if end == last else 0
        if again > MOST_AGAIN:
            return SAME_ROOT, row, start, start, CLEAR, excess, taken
        # The bottom of a dip that stays above zero: the step goes on.
        tau, first, last = start, row, end
