"""Polynomials of a step that must not change sign: bounds of them, and their first fall.

What the bounds of travel and swing cannot exclude is decided by Bernstein
coefficients (`eventpound.numerics.polynomial`), so a dip between two crossings is not
missed. Below the levels of rounding of a step nothing has a sign.
"""

from __future__ import annotations

import numpy as np

from eventpound.contact.rest import is_none
from eventpound.contact.rounding import acceleration_noise
from eventpound.mechanics.followers import on_body
from eventpound.numerics.arrays import Floats
from eventpound.numerics.polynomial import first_root
from eventpound.solvers.fast.compiled import compiled, compiled_noinline
from eventpound.solvers.fast.run import FastRun, FastSeries, Limits
from eventpound.tolerances import ACCELERATION, FORCE, GAP_COEFFICIENT

OF_BODIES = 0.2
"""Part of the largest acceleration that sums of forces have for theirs."""


@compiled
def acceleration_level(c: int, limits: Limits, series: FastSeries) -> float:
    """Rounding of the acceleration of a cluster (m/s²), as the acceleration problem has it."""
    own = ACCELERATION * limits.length / limits.time**2
    return acceleration_noise(2.0 * series.X[c, 2] + series.ground[0], own)


@compiled
def force_level(count: int, limits: Limits, series: FastSeries) -> float:
    """Rounding of a contact force in a step of `count` clusters (N)."""
    largest = limits.length / limits.time**2
    for c in range(count):
        largest = max(largest, OF_BODIES * abs(2.0 * series.X[c, 2] + series.ground[0]))
    return FORCE * limits.mass * largest


@compiled
def set_travel(order: int, h: float, count: int, series: FastSeries) -> None:
    """Bounds of the motion of clusters over a step of length h (s).

    `reach`: of the change of displacement (m). `travel` and `swing`: of what
    the quadratics leave of the displacement (m) and of the velocity (m/s). `bend`: of the
    change of the rate of the absolute acceleration (m/s³).
    """
    X, ground = series.X, series.ground
    for c in range(count):
        travel, swing, bend = 0.0, 0.0, 0.0
        # What the quadratics do not hold, by Horner's rule: of u from τ^3 on, of v and of the rate
        # of the acceleration from τ^3 and τ on.
        for k in range(order, 3, -1):
            size = abs(X[c, k])
            travel = (travel + size) * h
            swing = (swing + k * size) * h
            bend = (bend + (k - 2) * abs(k * (k - 1) * X[c, k] + ground[k - 2])) * h
        series.bend[c] = bend
        series.swing[c] = swing * h * h
        travel = (travel + abs(X[c, 3])) * h * h * h
        series.travel[c] = travel
        series.reach[c] = travel + h * (abs(X[c, 1]) + h * abs(X[c, 2]))


@compiled
def motion(tau: float, order: int, x: Floats) -> tuple[float, float, float]:
    """What a series changes by after tau (s), its rate and the second one.

    Its first coefficient is not looked at.
    """
    change, rate, bend = x[order], 0.0, 0.0
    for k in range(order - 1, 0, -1):
        bend = bend * tau + rate
        rate = rate * tau + change
        change = change * tau + x[k]
    bend = bend * tau + rate
    rate = rate * tau + change
    # Horner's rule leaves half the second derivative.
    return change * tau, rate, 2.0 * bend


@compiled
def set_distance(
    start: float, factor: float, first: int, second: int, order: int, series: FastSeries
) -> None:
    """Put a polynomial into `series.c`: a start, and a multiple of how two clusters part."""
    series.c[0] = start
    for k in range(1, order + 1):
        series.c[k] = factor * distance_coefficient(first, second, k, series)


@compiled
def distance_stays_above(
    start: float, factor: float, first: int, second: int, h: float, series: FastSeries
) -> bool:
    """Whether that is sure to stay above zero on [0, h]."""
    slope = factor * distance_coefficient(first, second, 1, series)
    bend = factor * distance_coefficient(first, second, 2, series)
    rest = abs(factor) * bound_of_pair(first, second, series.travel)
    return stays_above(start, slope, bend, rest, h)


@compiled
def stays_above(c0: float, c1: float, c2: float, rest: float, h: float) -> bool:
    """Whether ``c0 + c1 x + c2 x²`` stays above `rest` on [0, h]."""
    low = min(c0, c0 + h * (c1 + h * c2))
    if c2 > 0.0 and c1 < 0.0 and -c1 < 2.0 * c2 * h:
        # Its vertex lies inside.
        low = c0 - c1 * c1 / (4.0 * c2)
    return low > rest


@compiled
def distance_coefficient(first: int, second: int, k: int, series: FastSeries) -> float:
    """Coefficient k of the displacement of one cluster to another."""
    value = 0.0
    if second >= 0:
        value = series.X[second, k]
    if first >= 0:
        value -= series.X[first, k]
    return value


@compiled
def bound_of_pair(first: int, second: int, bounds: Floats) -> float:
    """Bound of the distance of two clusters, -1 for the ground, from those of each."""
    total = 0.0
    if first >= 0:
        total = bounds[first]
    if second >= 0:
        total += bounds[second]
    return total


@compiled
def _with_rounding(level: float, k: int, c: int, limits: Limits, series: FastSeries) -> float:
    """The rounding `level` of coefficient k of a gap, with that of a cluster's own."""
    if c < 0:
        return level
    if k == 2:
        return max(level, 0.5 * acceleration_level(c, limits, series))
    return level + GAP_COEFFICIENT * abs(series.X[c, k])


@compiled
def gap_polynomial(j: int, order: int, run: FastRun) -> None:
    """Coefficients of a gap into `series.c`: the first two are its own variables.

    A gap that opens goes on with the first coefficient that differs from
    rounding. Bodies that the ground alone accelerates do so without any.
    """
    limits, state, series, c = run.plan.limits, run.state, run.series, run.series.c
    left, right = run.plan.contacts.left[j], run.plan.contacts.right[j]
    first = series.of_body[left] if left >= 0 else -1
    second = series.of_body[right] if right >= 0 else -1
    set_distance(max(state.gap[j], 0.0), 1.0, first, second, order, series)
    c[1] = state.gap_rate[j]
    opening = c[0] == 0.0 and c[1] == 0.0
    # Rounding can close only what is about to open.
    if not (opening or c[1] > 0.0 > c[2]):
        return
    for k in range(2, order + 1):
        level = 0.0
        for end in (first, second):
            level = _with_rounding(level, k, end, limits, series)
        if series.free.shape[0] > 0:
            level = _level_at_points(j, k, level, run)
        if not is_none(k, c[k], level, c[1], limits.time):
            break
        c[k] = 0.0


@compiled_noinline
def _level_at_points(j: int, k: int, level: float, run: FastRun) -> float:
    """`level` with the rounding of coefficient k of bodies that the points of a gap are sums of."""
    contacts, series = run.plan.contacts, run.series
    for end in (contacts.left[j], contacts.right[j]):
        for b in range(series.of_body.size):
            if on_body(end, b, contacts.weights):
                level = _with_rounding(level, k, series.of_body[b], run.plan.limits, series)
    return level


@compiled_noinline
def first_fall(
    c: Floats, size: int, limit: float, level: float, slope_level: float, work: Floats
) -> float:
    """First time up to `limit` (s) at which a polynomial falls below zero, or inf.

    A start within `level` of zero counts as zero, and then a slope within
    `slope_level`; if what follows falls, it falls at once.
    """
    if abs(c[0]) <= level:
        c[0] = 0.0
        if abs(c[1]) <= slope_level:
            c[1] = 0.0
    start = 0
    while start < size and c[start] == 0.0:
        start += 1
    if start == size:
        return np.inf
    if c[start] < 0.0:
        return 0.0
    return first_root(c, size, limit, work)


@compiled_noinline
def fall_beyond(c: Floats, size: int, limit: float, level: float, work: Floats) -> float:
    """When a polynomial has fallen past zero by more than rounding, or inf.

    It has twice `level` below zero: what has been found at zero, or is nothing at all, may
    be there by rounding.
    """
    start = c[0]
    c[0] = start + 2.0 * level
    tau = first_root(c, size, limit, work) if c[0] > 0.0 else 0.0
    # Who asked reads it again.
    c[0] = start
    return tau


@compiled_noinline
def release_time(
    c: Floats, size: int, h: float, limit: float, level: float, kept: bool, work: Floats
) -> float:
    """When a contact force that is a polynomial over h (s) vanishes, up to `limit` (s), or inf.

    One that falls no deeper than rounding, `level`, still holds: it may be one that dies away
    without a change of sign. Where the acceleration problem has just `kept` the contact, only
    rounding can let the force fall at once.
    """
    release = first_fall(c, size, limit, level, 0.0, work)
    if release < np.inf:
        beyond = fall_beyond(c, size, h, level, work)
        if beyond == np.inf or (kept and release == 0.0):
            return beyond
    return release
