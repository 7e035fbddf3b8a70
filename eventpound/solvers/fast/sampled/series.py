"""A step of several bodies under a record by series, where matrices are none: its end, its bounds.

That is where a link is on a curved part of its backbone, and between two samples. With
stiffness K and damping C for each unit of mass of what is linear at present, the slope s of
the record and Q z of the links on curved parts (`eventpound.solvers.fast.expansion`),

    (k + 1) (k + 2) X_{k+2} = -K X_k - (k + 1) C X_{k+1} - s [k = 1] ± Q z_k / m.

Terms are added until the last two no longer count; where the highest order is not enough
the step is shortened. The sums of ``k (k - 1) |X_k| h^(k-2)`` and of
``(k - 3) (k - 2) (k - 1) k |X_k| h^(k-4)`` bound the relative acceleration over the step
and, since the ground moves on a straight line, the second derivative of the absolute one.
"""

from __future__ import annotations

from eventpound.mechanics.elements import INVERSE, pull_per_z
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.expansion import (
    CONVERGED,
    curve_begins,
    curve_coefficient,
    last_terms,
    on_curve,
    set_weights,
)
from eventpound.solvers.fast.run import FastRun, FastSeries, FastState
from eventpound.solvers.fast.search import distance_coefficient

FEWEST = 8
"""Order of the series, at least."""
SHORTEST = 0.05
"""Part of what is left to the next sample below which a step is not worth while."""


@compiled
def propose_by_series(
    n: int, i: int, longest: float, slope: float, run: FastRun
) -> tuple[int, float]:
    """Series for a step of n bodies of at most `longest` (s), its end and its bounds.

    `i` is the table that holds K and C. Returned are the order of the series, 0 where
    the step would be too short, and its length (s).
    """
    plan, state, series = run.plan, run.state, run.series
    h, order, error = longest, plan.limits.order, 0.0
    curved = _start(n, run)
    power, over = h * h, 1.0 / h
    for k in range(1, order - 1):
        _linear_part(n, i, k, slope, series)
        if curved:
            _curved_part(k, run)
        _add_term(n, k, series)
        power *= h
        if k + 2 < FEWEST:
            continue
        error = last_terms(k + 2, power, over, n, series)
        if error <= CONVERGED:
            order = k + 2
            break
    if not error <= CONVERGED:
        h *= (0.5 * CONVERGED / error) ** (1.0 / (order - 1))
        if not h >= SHORTEST * longest:
            return 0, h
    end_of_series(order, h, state, series)
    return order, h


@compiled
def end_of_series(order: int, h: float, state: FastState, series: FastSeries) -> None:
    """The motion h (s) after the start of a series, and its bounds until then."""
    X, bodies = series.X, series.tables.bodies
    for b in range(state.u.size):
        change, rate, acceleration, fastest, bend = 0.0, 0.0, 0.0, 0.0, 0.0
        for k in range(order, 3, -1):
            x, weight = X[b, k], float(k * (k - 1))
            size = weight * abs(x)
            change = change * h + x
            rate = rate * h + k * x
            acceleration = acceleration * h + weight * x
            fastest = fastest * h + size
            bend = bend * h + float((k - 2) * (k - 3)) * size
        for k in range(3, 1, -1):
            x, weight = X[b, k], float(k * (k - 1))
            change = change * h + x
            rate = rate * h + k * x
            acceleration = acceleration * h + weight * x
            fastest = fastest * h + weight * abs(x)
        bodies.next_u[b] = state.u[b] + h * (state.v[b] + h * change)
        bodies.next_v[b] = state.v[b] + h * rate
        series.expected[b], bodies.fastest[b] = acceleration, fastest
        bodies.sag[b], bodies.bend[b] = 0.125 * h * h * fastest, 0.125 * h * h * bend


@compiled
def expand_linear(i: int, order: int, slope: float, run: FastRun) -> None:
    """Series of a step by matrices, whose table is i, for rows between samples."""
    state, series = run.state, run.series
    n = state.u.size
    _start(n, run)
    for k in range(1, order - 1):
        _linear_part(n, i, k, slope, series)
        _add_term(n, k, series)


@compiled
def _start(n: int, run: FastRun) -> bool:
    """First terms, and what errors of u and v of each body are to be multiplied by.

    Returned is whether a link is on a curved part of its backbone.
    """
    plan, state, series = run.plan, run.state, run.series
    X, tables = series.X, series.tables
    set_weights(run)
    for b in range(n):
        X[b, 1], X[b, 2] = state.v[b], 0.5 * tables.bodies.pulled[b]
    hysteresis, curved = plan.hysteresis, False
    for j in range(hysteresis.link.size):
        if on_curve(j, state.part):
            curve_begins(hysteresis.link[j], j, run)
            curved = True
    return curved


@compiled
def _linear_part(n: int, i: int, k: int, slope: float, series: FastSeries) -> None:
    """What the linear links and the ground add to coefficient k of the relative accelerations."""
    X, tables, first = series.X, series.tables, -slope if k == 1 else 0.0
    for b in range(n):
        total = first
        for d in range(n):
            total -= tables.stiffness[i, b, d] * X[d, k]
            total -= tables.damping[i, b, d] * ((k + 1) * X[d, k + 1])
        tables.work[0, b] = total


@compiled
def _curved_part(k: int, run: FastRun) -> None:
    """What the links on curved parts add to it."""
    plan, state, series = run.plan, run.state, run.series
    links, acceleration = plan.links, series.tables.work[0]
    for j in range(plan.hysteresis.link.size):
        if on_curve(j, state.part):
            a = plan.hysteresis.link[j]
            first, second = links.ends[a, 0], links.ends[a, 1]
            x = distance_coefficient(first, second, k, series)
            force = pull_per_z(a, links.law.memory) * curve_coefficient(j, k, x, series)
            if first >= 0:
                acceleration[first] += force * series.inverse_mass[first]
            if second >= 0:
                acceleration[second] -= force * series.inverse_mass[second]


@compiled
def _add_term(n: int, k: int, series: FastSeries) -> None:
    """Coefficient k + 2 of the displacements, by that of the accelerations."""
    scale = INVERSE[k + 1] * INVERSE[k + 2]
    for b in range(n):
        series.X[b, k + 2] = series.tables.work[0, b] * scale
