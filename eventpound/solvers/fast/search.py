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
from eventpound.numerics.polynomial import first_root, value_and_slope
from eventpound.solvers.fast import noise
from eventpound.solvers.fast.backbone_parts import CORE, UNLOADING, UP, place
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.plan import (
    ACTIVE,
    RESTING,
    STALLED,
    Contacts,
    Happened,
    Hysteresis,
    Limits,
    Links,
    Plan,
    Series,
    State,
)


@compiled
def set_travel(order: int, h: float, count: int, series: Series) -> None:
    """Bounds of the motion of clusters over a step of length h (s).

    `reach`: of the change of displacement (m). `travel` and `swing`: of what
    the quadratics leave of the displacement (m) and of the velocity (m/s).
    """
    X = series.X
    for c in range(count):
        travel, swing = 0.0, 0.0
        for k in range(order, 3, -1):
            travel = (travel + abs(X[c, k])) * h
            swing = (swing + k * abs(X[c, k])) * h
        series.swing[c] = swing * h * h
        travel = (travel + abs(X[c, 3])) * h * h * h
        series.travel[c] = travel
        series.reach[c] = travel + h * (abs(X[c, 1]) + h * abs(X[c, 2]))


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
def stays_above(c0: float, c1: float, c2: float, rest: float, h: float) -> bool:
    """Whether ``c0 + c1 x + c2 x²`` stays above `rest` on [0, h]."""
    low = min(c0, c0 + h * (c1 + h * c2))
    if c2 > 0.0 and c1 < 0.0 and -c1 < 2.0 * c2 * h:
        low = c0 - c1 * c1 / (4.0 * c2)
    return low > rest


@compiled
def _distance(first: int, second: int, k: int, series: Series) -> float:
    """Coefficient k of the displacement of one cluster to another."""
    value = 0.0
    if second >= 0:
        value = series.X[second, k]
    if first >= 0:
        value -= series.X[first, k]
    return value


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
        level = noise.ACCELERATION * limits.length / limits.time**2 if k == 2 else 0.0
        for end in (first, second):
            if end >= 0:
                level += noise.ROUNDING * abs(series.X[end, k])
        if c[k] > level:
            break
        c[k] = 0.0


@compiled_apart
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


@compiled_apart
def fall_beyond(c: Floats, size: int, limit: float, level: float, work: Floats) -> float:
    """When a polynomial that starts at zero, to rounding, has fallen past it, or inf.

    What says that it does not fall at once (the acceleration problem) may be
    wrong by rounding only: twice `level` below zero it has fallen.
    """
    start = c[0]
    c[0] = start + 2.0 * level
    tau = first_root(c, size, limit, work)
    c[0] = start
    return tau


@compiled
def _take(tau: float, first: float, happened: Happened) -> tuple[bool, float]:
    """Whether an event at tau belongs to the first ones, and their time."""
    if not tau <= first * (1.0 + noise.SAME_INSTANT):
        return False, first
    if tau < first * (1.0 - noise.SAME_INSTANT):
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
        slope, bend = _distance(a, b, 1, series), _distance(a, b, 2, series)
        rest = _bound(a, b, series.travel)
        if state.gap[j] > 0.0 and stays_above(state.gap[j], slope, bend, rest, h):
            continue
        gap_polynomial(j, order, contacts, plan.limits, state, series)
        tau = 0.0
        # A gap that closes with the end of a stretch may be found closed and still closing.
        if not (series.c[0] <= 0.0 and series.c[1] < 0.0):
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
    still = noise.SPEED * limits.length / limits.time
    for i in range(hysteresis.link.size):
        a = hysteresis.link[i]
        head, tail = series.ends[a, 0], series.ends[a, 1]
        if head == tail:
            continue
        travel = _bound(head, tail, series.reach)
        part, sigma = state.part[i], state.sigma[i]
        # A link that all but stands still reverses at the level of rounding.
        if part != CORE and travel > limits.hysteresis * hysteresis.scale[i]:
            rate = sigma * series.x_rate[a]
            slope = 2.0 * sigma * _distance(head, tail, 2, series)
            bend = 3.0 * sigma * _distance(head, tail, 3, series)
            if not stays_above(rate, slope, bend, _bound(head, tail, series.swing), h):
                tau = _reversal(order, h, sigma, head, tail, still, limits.time, a, series)
                taken, first = _take(tau, first, happened)
                if taken and tau < np.inf:
                    happened.turned[i] = True
        if part >= UP:
            continue
        xi = place(i, series.x[a], hysteresis, state)
        upper = hysteresis.core[i] if part <= UNLOADING else hysteresis.down[i]
        scale = 1.0 / hysteresis.scale[i]
        slope = sigma * scale * _distance(head, tail, 1, series)
        bend = sigma * scale * _distance(head, tail, 2, series)
        rest = scale * _bound(head, tail, series.travel)
        tau = np.inf
        if not stays_above(upper - xi, -slope, -bend, rest, h):
            tau = _level(order, min(h, first), sigma, upper - xi, i, hysteresis, head, tail, series)
        lower = hysteresis.core[i] + xi
        if part == CORE and not stays_above(lower, slope, bend, rest, h):
            tau = min(
                tau, _level(order, min(h, first), -sigma, lower, i, hysteresis, head, tail, series)
            )
        taken, first = _take(tau, first, happened)
        if taken and tau < np.inf:
            happened.crossed[i] = True
    return first


@compiled
def _reversal(
    order: int,
    h: float,
    sigma: float,
    head: int,
    tail: int,
    still: float,
    time: float,
    a: int,
    series: Series,
) -> float:
    """When σ x' falls below zero."""
    c = series.c
    relative(head, tail, order, series, c)
    for k in range(order):
        c[k] = sigma * (k + 1) * c[k + 1]
    c[0] = sigma * series.x_rate[a]
    return first_fall(c, order, h, still, still / time, series.work)


@compiled
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
        side = float(state.branch[a])
        slope, bend = (
            side * _distance(head, tail, 1, series),
            side * _distance(head, tail, 2, series),
        )
        if stays_above(away, slope, bend, _bound(head, tail, series.travel), h):
            continue
        c = series.c
        relative(head, tail, order, series, c)
        for k in range(1, order + 1):
            c[k] *= state.branch[a]
        c[0] = away
        _clear_rounding(head, tail, plan.limits, series)
        tau = first_fall(c, order + 1, min(h, first), 0.0, 0.0, series.work)
        taken, first = _take(tau, first, happened)
        if taken and tau < np.inf:
            happened.kinked[a] = True
    return first


@compiled_apart
def _clear_rounding(head: int, tail: int, limits: Limits, series: Series) -> None:
    """Clear the first coefficients of a distance to a kink, in `series.c`, that are rounding."""
    c = series.c
    level = noise.LENGTH * limits.length
    for k in range(3):
        if k == 2:
            level = noise.ACCELERATION * limits.length / limits.time**2
            for end in (head, tail):
                if end >= 0:
                    level += noise.ROUNDING * abs(series.X[end, 2])
        if abs(c[k]) > level:
            return
        c[k] = 0.0
        level = noise.SPEED * limits.length / limits.time


@compiled
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
    any_released = False
    level = noise.FORCE * limits.mass * limits.length / limits.time**2
    for j in range(state.resting.size):
        if not state.unlocked[j]:
            continue
        spread = 0.0
        for k in range(order - 2, 0, -1):
            spread = (spread + abs(forces[j, k])) * h
        if forces[j, 0] > spread:
            continue
        # Where the acceleration problem has just kept it, only rounding can let it fall at once.
        kept = abs(forces[j, 0]) <= level and state.count[STALLED] > 0
        if kept:
            _drop_rounding(j, order, level, plan, series)
        tau = first_fall(forces[j], order - 1, min(h, first), level, 0.0, series.work)
        if kept and tau == 0.0:
            tau = fall_beyond(forces[j], order - 1, min(h, first), level, series.work)
        taken, first = _take(tau, first, happened)
        if taken and tau < np.inf:
            happened.released[j] = True
            any_released = True
    if any_released:
        # Forces that vanish together do so within rounding of each other, on the same series.
        for j in range(state.resting.size):
            if state.unlocked[j]:
                value, _ = value_and_slope(forces[j, : order - 1], first)
                happened.released[j] = happened.released[j] or abs(value) <= level
    return first


@compiled_apart
def _drop_rounding(j: int, order: int, level: float, plan: Plan, series: Series) -> None:
    """Clear the first coefficients of a contact force that are no more than rounding.

    `level` (N) is that of the force itself; those of higher order err like the
    accelerations they are differences of.
    """
    force, scale = series.contact_force[j], level
    mass = plan.limits.mass
    for k in range(order - 1):
        largest = 0.0
        for c in range(plan.mass.size):
            largest = max(largest, abs(series.X[c, k + 2]))
        rounding = noise.ROUNDING * mass * (k + 1) * (k + 2) * largest if k > 0 else 0.0
        if abs(force[k]) > scale + rounding:
            return
        force[k] = 0.0
        scale /= plan.limits.time
