"""How long a step may be, and whether it was good enough."""

from __future__ import annotations

import math

import numpy as np

from eventpound.motion.base import Family
from eventpound.numerics.arrays import Floats
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.expansion import acceleration_at
from eventpound.solvers.fast.run import GUESS, ORDER, RESTING, Run

LOCAL_SHARE = 0.1
"""Part of the tolerance given to one step."""
SMALLEST_ORDER = 5
GAUSSIAN_STEP = 0.5
"""Longest step under a Gaussian pulse, in its own time 1/sqrt(q)."""
SINUSOID_STEP = 1.5
"""Longest step under a sinusoid, in its radians."""
_SAMPLES, _GAUSSIAN, _SINUSOIDS = int(Family.SAMPLES), int(Family.GAUSSIAN), int(Family.SINUSOIDS)


@compiled
def step_error(h: float, order: int, run: Run) -> float:
    """Truncation error of a step of length h in units of its tolerance, from the last terms."""
    plan, state, series = run.plan, run.state, run.series
    limits = plan.limits
    power = h
    for _ in range(order - 3):
        power *= h
    worst = 0.0
    for b in range(plan.mass.size):
        c = series.of_body[b]
        if c < 0:
            continue
        X = series.X[c]
        of_u = LOCAL_SHARE * (limits.atol_u[b] + limits.rtol * abs(state.u[b]))
        of_v = LOCAL_SHARE * (limits.atol_v[b] + limits.rtol * abs(state.v[b]))
        last = max(abs(X[order]) * h, abs(X[order - 1])) * power * h
        worst = max(worst, last / of_u, order * last / (of_v * h))
    return worst


@compiled
def defect_error(tau: float, order: int, ground: float, run: Run) -> float:
    """Error of a step in units of its tolerance, from the defect of the equations at its end.

    A defect that grows like τ^(p-1) leaves τ/p of itself in v and τ²/p² in u.
    """
    plan, state, series, seen = run.plan, run.state, run.series, run.seen
    limits = plan.limits
    worst = 0.0
    for b in range(plan.mass.size):
        c = series.of_body[b]
        if c < 0:
            continue
        of_u = LOCAL_SHARE * (limits.atol_u[b] + limits.rtol * abs(state.u[b]))
        of_v = LOCAL_SHARE * (limits.atol_v[b] + limits.rtol * abs(state.v[b]))
        defect = abs(seen.a[b] - ground - acceleration_at(c, tau, order, series)) * tau / order
        worst = max(worst, defect / of_v, defect * tau / (order * of_u))
    return worst


@compiled
def choose_length(order: int, limit: float, family: int, coefficients: Floats, run: Run) -> float:
    """Length of the next step (s), and for a record the order of the one after it."""
    plan, state, series = run.plan, run.state, run.series
    clock, count = state.clock, state.count
    longest = limit
    if family == _GAUSSIAN:
        longest = min(longest, GAUSSIAN_STEP / math.sqrt(coefficients[1]))
    if family == _SINUSOIDS:
        for k in range(1, coefficients.size, 3):
            if coefficients[k + 1] > 0.0:
                longest = min(longest, SINUSOID_STEP / coefficients[k + 1])
    if not longest < np.inf:
        longest = plan.limits.time * 1e3
    guess = min(longest, 2.0 * clock[GUESS])
    if family == _SAMPLES:
        guess = longest
    error = step_error(guess, order, run)
    if state.count[RESTING] > 0:
        # Forces of resting contacts follow the ground motion itself.
        share = LOCAL_SHARE * plan.limits.rtol * plan.limits.length / plan.limits.time**2
        error = max(error, abs(series.ground[order - 1]) * guess ** (order - 1) / share)
        error = max(error, abs(series.ground[order - 2]) * guess ** (order - 2) / share)
    if family == _SAMPLES:
        highest = plan.limits.order
        if error > 1.0 and order < highest:
            count[ORDER] = order + 1
        elif error < 1e-3 and order > SMALLEST_ORDER:
            count[ORDER] = order - 1
    else:
        count[ORDER] = plan.limits.order
    if error <= 1.0:
        if guess < longest and error < 0.5:
            grown = guess * min(10.0, (0.5 / max(error, 1e-30)) ** (1.0 / (order - 1)))
            return min(longest, grown)
        return guess
    return guess * (0.5 / error) ** (1.0 / (order - 1)) if error < np.inf else 1e-3 * guess
