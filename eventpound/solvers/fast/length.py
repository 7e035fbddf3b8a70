"""How long a step may be, and whether it was good enough."""

from __future__ import annotations

import math

import numpy as np

from eventpound.motion.base import Family
from eventpound.motion.loads import LOADED, shortest_time
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.expansion import acceleration_at
from eventpound.solvers.fast.run import GUESS, Piece, Run

GAUSSIAN_STEP = 0.5
"""Longest step under a Gaussian pulse, in its own time 1/sqrt(q)."""
SINUSOID_STEP = 1.5
"""Longest step under a sinusoid, in its radians."""
_SAMPLES, _GAUSSIAN, _SINUSOIDS = int(Family.SAMPLES), int(Family.GAUSSIAN), int(Family.SINUSOIDS)


@compiled
def defect_error(tau: float, order: int, ground: float, run: Run) -> float:
    """Error of a step in units of its tolerance, from the defect of the equations at its end.

    A defect that grows like τ^(p-1) leaves τ/p of itself in v and τ²/p² in u.
    """
    plan, series, seen = run.plan, run.series, run.seen
    of_u, of_v = series.weights[0], series.weights[1]
    worst = 0.0
    for b in range(plan.mass.size):
        c = series.of_body[b]
        if c < 0:
            continue
        defect = abs(seen.a[b] - ground - acceleration_at(c, tau, order, series)) * tau / order
        worst = max(worst, defect * of_v[c], defect * tau / order * of_u[c])
    return worst


@compiled
def longest_try(limit: float, piece: Piece, run: Run) -> tuple[float, float]:
    """Longest step (s), `limit` at most, and the length that the series are made for."""
    family, coefficients, longest = piece.family, piece.coefficients, limit
    sampled = family == _SAMPLES
    if family == _GAUSSIAN:
        longest = min(longest, GAUSSIAN_STEP / math.sqrt(coefficients[1]))
    if family == _SINUSOIDS:
        for k in range(1, coefficients.size, 3):
            if coefficients[k + 1] > 0.0:
                longest = min(longest, SINUSOID_STEP / coefficients[k + 1])
    if family == LOADED:
        gaussian, sinusoid, sampled = shortest_time(coefficients)
        longest = min(longest, GAUSSIAN_STEP * gaussian, SINUSOID_STEP * sinusoid)
    if not longest < np.inf:
        longest = run.plan.limits.time * 1e3
    # To the next sample a further term costs less than a further step.
    return longest, longest if sampled else min(longest, 2.0 * run.state.clock[GUESS])


@compiled
def choose_length(tried: float, order: int, error: float, longest: float) -> float:
    """Length of a step (s), for which the series of this order were `tried` with this error."""
    if error > 1.0:
        shrunk = tried * (0.5 / error) ** (1.0 / (order - 1))
        return shrunk if error < np.inf else 1e-3 * tried
    if tried < longest and error < 0.5:
        grown = tried * min(10.0, (0.5 / max(error, 1e-30)) ** (1.0 / (order - 1)))
        return min(longest, grown)
    return tried
