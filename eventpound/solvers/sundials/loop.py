"""The steps of CVODE and of IDA: one loop, and what a root of their own root finders means.

What differs comes as functions of `handles`: compiled ones of addresses, or methods of an
integrator in Python, which runs the same loop.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from eventpound.mechanics.ground_frame import to_frame
from eventpound.mechanics.observables import Observed, observe
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.solvers.events.dense import Dense
from eventpound.solvers.events.integrator import Bounds
from eventpound.solvers.events.recorder import is_due, write_samples
from eventpound.solvers.events.reversals import NEGLIGIBLE, first_reversal, may_reverse
from eventpound.solvers.events.roots import any_fell, on_the_root
from eventpound.solvers.events.step_check import (
    BEYOND_BOUND,
    CLEAR,
    EVENT_FOUND,
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
AtRoot = Callable[[float, float, int, float, Examination], tuple[int, float]]
"""`root_at` from its fifth argument on."""


@kernel
def carry_on(
    take: Callable[[Any, float, int, Bounds, Examination], tuple[int, float]],
    check: Callable[[Any, float, float, int, float, Examination], tuple[int, float]],
    show: Any,
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
        A step from the state in a row to the other row: SUNDIALS' flag, and where it ends (s).
    check : callable
        Its examination: `eventpound.solvers.events.step_check.examine`.
    show : callable
        `shown`; asked for where nothing happened in a step with an output time.
    handles
        What these are handed.
    tau, first, excess, bounds, e
        Of `Integrator.advance`.
    """
    start, steps = tau, 0
    while True:
        flag, end = take(handles, start, first, bounds, e)
        if flag < 0 or end <= start or flag == ROOT_RETURN:
            return flag, first, start, end, CLEAR, excess, steps
        # What |z| exceeds its bound by already is no fault of this step.
        verdict, reached = check(handles, start, end, first, max(e.z_allowed, excess), e)
        if verdict in (NOT_FINITE, BEYOND_BOUND):
            return flag, first, start, end, verdict, reached, steps
        excess, steps = reached, steps + 1
        if verdict == CLEAR and is_due(e.forcing.start + end, e.record.journal):
            write_samples(show, (handles, e), e.forcing.start, start, end, e.record.journal)
        if verdict != CLEAR or end >= bounds.stop or steps == bounds.most:
            return flag, first, start, end, verdict, excess, steps
        # The rows of both ends take turns.
        start, first = end, 1 - first


@kernel
def shown(
    put_inner: Callable[[Any, float, int, Floats], None], of: tuple[Any, Examination], tau: float
) -> Observed:
    """The motion at `tau` (s) of the last step, as it is observed; `of` are handles and `e`."""
    handles, e = of
    system, y = e.dynamics.system, np.empty(e.dynamics.system.size)
    put_state(put_inner, handles, tau, e, y)
    # Nothing in a line depends on rates: any will do.
    observe(tau, y, e.rate[0], system, e.dynamics.bodies, e.forcing, e.observations[4])
    return e.observations[4]


@scalar_kernel
def bracket_of(start: float, end: float) -> float:
    """Width that SUNDIALS leaves of the bracket of a root in a step from `start` to `end` (s)."""
    return BRACKET * EPS * (abs(end) + end - start)


@kernel
def step_to(
    solve: Callable[[Any, float], int],
    whole_end: Callable[[Any], float],
    handles: Any,
    start: float,
    stop: float,
) -> int:
    """SUNDIALS' flag of a step from `start`, not beyond `stop` (s).

    A root that it has told of, where it stands, may be the end of its whole step: it has no more of
    that to come back with, and would go on to another.

    Parameters
    ----------
    solve : callable
        Lets SUNDIALS take a step, not beyond a time (s); returns its flag.
    whole_end : callable
        End of its whole step (s).
    handles
        What these are handed; SUNDIALS stands at the first of their `reached` (s).
    start, stop : float
        As above.
    """
    reached = handles.reached[0]
    if reached > start:
        whole = whole_end(handles)
        if abs(whole - reached) <= bracket_of(start, whole):
            return 0
    return solve(handles, stop)


@kernel
def polynomial(
    put_inner: Callable[[Any, float, int, Floats], None],
    handles: Any,
    order: int,
    t: float,
    size: int,
) -> Floats:
    """Coefficients of SUNDIALS' own polynomial of its last step about `t` (s).

    Parameters
    ----------
    put_inner : callable
        Fills in a derivative at a time (s) of the loop's state (size,), in the moving frame.
    handles
        What that is handed.
    order, t, size
        Of the method; local time (s); of the loop's state.

    Returns
    -------
    ndarray, shape (order + 1, size)
        ``y^(k) / k!``.
    """
    Y, factorial = np.empty((order + 1, size)), 1.0
    for k in range(order + 1):
        factorial *= max(k, 1)
        put_inner(handles, t, k, Y[k])
        for i in range(size):
            Y[k, i] /= factorial
    return Y


@kernel
def put_state(
    put_inner: Callable[[Any, float, int, Floats], None],
    handles: Any,
    tau: float,
    e: Examination,
    y: Floats,
) -> None:
    """Fill in the loop's state at `tau` (s) of the last step, relative to the ground.

    put_inner, handles: as `polynomial` has them.
    """
    put_inner(handles, tau, 0, y)
    system = e.dynamics.system
    to_frame(e.frame, e.forcing.start + tau, -1.0, system.iq, system.iv, y)


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
        last, allowed = end - bracket_of(start, end), 0.0
    if not may_reverse(before, rate, after, end - start, system, direction, allowed):
        return np.inf
    return first_reversal(dense(handles, start, end), last, e.forcing.start, system, direction)


@kernel
def root_at(
    values: Callable[[Any, float], Roots],
    whole_end: Callable[[Any], float],
    put_inner: Callable[[Any, float, int, Floats], None],
    handles: Any,
    start: float,
    tau: float,
    first: int,
    excess: float,
    e: Examination,
) -> tuple[int, float]:
    """What SUNDIALS' return with a root at `tau` (s) means, and where its step ends (s).

    Parameters
    ----------
    values : callable
        Fills and returns the functions at the root.
    whole_end : callable
        End of SUNDIALS' whole step (s).
    put_inner : callable
        As `polynomial` has it.
    handles
        What these are handed.
    start, tau : float
        Start of the step, and the root (s).
    first, excess, e
        Of `Integrator.advance`; the row of the end becomes the state where a value that fell was
        zero.

    Returns
    -------
    verdict : int
        CLEAR at the bottom of a dip that stays above zero, EVENT_FOUND or BEYOND_BOUND.
    end : float
        Where the value was zero, or the end of a step that leapt over the knee of the hysteresis.
    """
    roots = values(handles, tau)
    if not any_fell(roots.pairs):
        return CLEAR, tau
    whole, y, places = whole_end(handles), e.y[1 - first], e.dynamics.bodies.z_of
    # SUNDIALS has gone on to there, and its root is one of the whole step's polynomial.
    put_inner(handles, whole, 0, y)
    for h in range(places.size):
        if places[h] >= 0 and abs(y[places[h]]) - e.z_bound[h] > max(e.z_allowed, excess):
            return BEYOND_BOUND, whole
    reach = bracket_of(start, whole)
    end = on_the_root(roots.pairs, roots.noise, start, tau, reach)
    put_inner(handles, end, 0, y)
    to_frame(e.frame, e.forcing.start + end, -1.0, e.dynamics.system.iq, e.dynamics.system.iv, y)
    return EVENT_FOUND, end


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
        verdict, end = at_root(start, end, row, excess, e)
        if verdict != CLEAR:
            return flag, row, start, end, verdict, excess, taken + int(verdict == EVENT_FOUND)
        again = again + 1 if end == last else 0
        if again > MOST_AGAIN:
            return SAME_ROOT, row, start, start, CLEAR, excess, taken
        # The bottom of a dip that stays above zero: the step goes on.
        tau, first, last = start, row, end
