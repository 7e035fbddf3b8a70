"""The first thing that happens within a step, on the Taylor polynomials themselves.

Each quantity that must not change sign (gaps, forces of resting contacts,
distances to kinks and to borders of the backbone, elongation rates) is a
polynomial. What the bounds of travel and swing cannot exclude is decided by
Bernstein coefficients (`eventpound.numerics.polynomial`), so a dip between
two crossings is not missed.
"""

from __future__ import annotations

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.numerics.polynomial import first_root
from eventpound.solvers.fast.backbone_parts import CORE, SATURATED, UNLOADING, UP, place
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.plan import (
    ACTIVE,
    RESTING,
    Contacts,
    Happened,
    Hysteresis,
    Limits,
    Links,
    Plan,
    Series,
    State,
)

SAME_INSTANT = 1e-11
"""Events whose local times differ relatively by less are one."""
ROUNDING = 1e-11
"""Gap coefficients below this part of the bodies' own are rounding, where lower ones vanish."""
ACCELERATION_NOISE = 1e-13
"""Accelerations of gaps below this part of L/T² have no meaningful sign."""
LENGTH_NOISE = 1e-15
"""Distances to a kink below this part of L have no meaningful sign."""
SPEED_NOISE = 1e-13
"""Elongation rates below this part of L/T have no meaningful sign."""
FORCE_NOISE = 1e-12
"""Contact forces below this part of m L/T² have no meaningful sign."""


@compiled
def set_travel(order: int, h: float, count: int, series: Series) -> None:
    """Bounds of the change of displacement (m) and velocity (m/s) of clusters over h (s)."""
    X = series.X
    for c in range(count):
        travel, swing = abs(X[c, order]) * h, 0.0
        for k in range(order - 1, 0, -1):
            swing = swing * h + (k + 1) * abs(X[c, k + 1])
            travel = (travel + abs(X[c, k])) * h
        series.travel[c], series.swing[c] = travel, swing * h


@compiled
def relative(first: int, second: int, order: int, series: Series, out: Floats) -> None:
    """Coefficients 1 ... order of the displacement of one cluster to another, into `out`."""
    X = series.X
    for k in range(1, order + 1):
        value = 0.0
        if second >= 0:
            value = X[second, k]
        if first >= 0:
            value -= X[first, k]
        out[k] = value


@compiled
def _bound(first: int, second: int, bounds: Floats) -> float:
    total = 0.0
    if first >= 0:
        total = bounds[first]
    if second >= 0:
        total += bounds[second]
    return total


@compiled
def gap_polynomial(
    j: int, order: int, contacts: Contacts, limits: Limits, state: State, series: Series
) -> None:
    """Coefficients of a gap into `series.c`: the first two are its own variables.

    A gap that opens from rest starts with the first coefficient that differs
    from rounding.
    """
    c = series.c
    left, right = contacts.left[j], contacts.right[j]
    first = series.of_body[left] if left >= 0 else -1
    second = series.of_body[right] if right >= 0 else -1
    relative(first, second, order, series, c)
    c[0], c[1] = state.gap[j], state.gap_rate[j]
    if c[0] != 0.0 or c[1] != 0.0:
        return
    for k in range(2, order + 1):
        level = ACCELERATION_NOISE * limits.length / limits.time**2 if k == 2 else 0.0
        for end in (first, second):
            if end >= 0:
                level += ROUNDING * abs(series.X[end, k])
        if c[k] > level:
            break
        c[k] = 0.0


@compiled_apart
def first_fall(
    c: Floats, size: int, limit: float, noise: float, slope_noise: float, work: Floats
) -> float:
    """First time up to `limit` (s) at which a polynomial falls below zero, or inf.

    A start within `noise` of zero counts as zero, and then a slope within
    `slope_noise`; if what follows falls, it falls at once.
    """
    if abs(c[0]) <= noise:
        c[0] = 0.0
        if abs(c[1]) <= slope_noise:
            c[1] = 0.0
    start = 0
    while start < size and c[start] == 0.0:
        start += 1
    if start == size:
        return np.inf
    if c[start] < 0.0:
        return 0.0
    return first_root(c, size, limit, work)


@compiled
def _take(tau: float, first: float, happened: Happened) -> tuple[bool, float]:
    """Whether an event at tau belongs to the first ones, and their time."""
    if not tau <= first * (1.0 + SAME_INSTANT):
        return False, first
    if tau < first * (1.0 - SAME_INSTANT):
        clear(happened)
    return True, min(tau, first)


@compiled
def clear(happened: Happened) -> None:
    """Nothing has happened."""
    happened.closing[:] = False
    happened.released[:] = False
    happened.kinked[:] = False
    happened.turned[:] = False
    happened.crossed[:] = False


@compiled
def first_happening(
    order: int, h: float, plan: Plan, state: State, series: Series, happened: Happened
) -> float:
    """Time of the first thing that happens within h (s), marked in `happened`; inf if none."""
    clear(happened)
    first = _closings(order, h, plan, state, series, happened)
    first = _hysteretic(order, min(h, first), first, plan, state, series, happened)
    first = _kinks(order, min(h, first), first, plan, state, series, happened)
    if state.count[RESTING] > 0:
        first = _releases(order, min(h, first), first, plan, state, series, happened)
    return first


@compiled
def _closings(
    order: int, h: float, plan: Plan, state: State, series: Series, happened: Happened
) -> float:
    first = np.inf
    contacts = plan.contacts
    for j in range(contacts.gap.size):
        if state.resting[j]:
            continue
        left, right = contacts.left[j], contacts.right[j]
        a = series.of_body[left] if left >= 0 else -1
        b = series.of_body[right] if right >= 0 else -1
        if state.gap[j] > _bound(a, b, series.travel):
            continue
        gap_polynomial(j, order, contacts, plan.limits, state, series)
        tau = first_root(series.c, order + 1, min(h, first), series.work)
        taken, first = _take(tau, first, happened)
        if taken and tau < np.inf:
            happened.closing[j] = True
    return first


@compiled
def _hysteretic(
    order: int,
    h: float,
    first: float,
    plan: Plan,
    state: State,
    series: Series,
    happened: Happened,
) -> float:
    hysteresis, limits = plan.hysteresis, plan.limits
    noise = SPEED_NOISE * limits.length / limits.time
    for i in range(hysteresis.link.size):
        a = hysteresis.link[i]
        head, tail = series.ends[a, 0], series.ends[a, 1]
        if head == tail:
            continue
        travel = _bound(head, tail, series.travel)
        part, sigma = state.part[i], state.sigma[i]
        # A link that all but stands still reverses at the level of rounding.
        if part != CORE and travel > limits.hysteresis * hysteresis.scale[i]:
            rate = sigma * series.x_rate[a]
            if rate <= _bound(head, tail, series.swing):
                tau = _reversal(order, h, sigma, head, tail, noise, limits.time, a, series)
                taken, first = _take(tau, first, happened)
                if taken and tau < np.inf:
                    happened.turned[i] = True
        if part == UP or part == SATURATED:
            continue
        xi = place(i, series.x[a], hysteresis, state)
        upper = hysteresis.core[i] if part <= UNLOADING else hysteresis.down[i]
        reach = travel / hysteresis.scale[i]
        tau = np.inf
        if xi + reach > upper:
            tau = _level(order, min(h, first), sigma, upper - xi, i, hysteresis, head, tail, series)
        if part == CORE and xi - reach < -hysteresis.core[i]:
            lower = hysteresis.core[i] + xi
            tau = min(
                tau, _level(order, min(h, first), -sigma, lower, i, hysteresis, head, tail, series)
            )
        taken, first = _take(tau, first, happened)
        if taken and tau < np.inf:
            happened.crossed[i] = True
    return first


@compiled_apart
def _reversal(
    order: int, h: float, sigma: float, head: int, tail: int, noise: float, time: float, a: int, series: Series
) -> float:
    """When σ x' falls below zero."""
    c = series.c
    relative(head, tail, order, series, c)
    for k in range(order):
        c[k] = sigma * (k + 1) * c[k + 1]
    c[0] = sigma * series.x_rate[a]
    return first_fall(c, order, h, noise, noise / time, series.work)


@compiled_apart
def _level(
    order: int,
    h: float,
    sigma: float,
    distance: float,
    i: int,
    hysteresis: Hysteresis,
    head: int,
    tail: int,
    series: Series,
) -> float:
    """When σ x has grown by a distance given in ξ."""
    c = series.c
    relative(head, tail, order, series, c)
    for k in range(1, order + 1):
        c[k] = -sigma * c[k] / hysteresis.scale[i]
    c[0] = distance
    return first_fall(c, order + 1, h, 1e-15, 0.0, series.work)


@compiled
def _kinks(
    order: int,
    h: float,
    first: float,
    plan: Plan,
    state: State,
    series: Series,
    happened: Happened,
) -> float:
    links: Links = plan.links
    for i in range(state.count[ACTIVE]):
        a = series.active[i]
        if state.branch[a] == 0:
            continue
        head, tail = series.ends[a, 0], series.ends[a, 1]
        away = state.branch[a] * (series.x[a] - links.offset[a])
        if away > _bound(head, tail, series.travel):
            continue
        c = series.c
        relative(head, tail, order, series, c)
        for k in range(1, order + 1):
            c[k] *= state.branch[a]
        c[0] = away
        tau = first_fall(
            c, order + 1, min(h, first), LENGTH_NOISE * plan.limits.length, 0.0, series.work
        )
        taken, first = _take(tau, first, happened)
        if taken and tau < np.inf:
            happened.kinked[a] = True
    return first


@compiled_apart
def _releases(
    order: int,
    h: float,
    first: float,
    plan: Plan,
    state: State,
    series: Series,
    happened: Happened,
) -> float:
    limits, forces = plan.limits, series.contact_force
    noise = FORCE_NOISE * limits.mass * limits.length / limits.time**2
    for j in range(state.resting.size):
        if not state.unlocked[j]:
            continue
        spread = 0.0
        for k in range(order - 2, 0, -1):
            spread = (spread + abs(forces[j, k])) * h
        if forces[j, 0] > spread:
            continue
        tau = first_fall(forces[j], order - 1, min(h, first), noise, 0.0, series.work)
        taken, first = _take(tau, first, happened)
        if taken and tau < np.inf:
            happened.released[j] = True
    return first
