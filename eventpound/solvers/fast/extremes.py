"""Exact extremes within a step: roots of the rates of what is monitored.

What cannot exceed the extremes so far, by the bounds of travel and swing, is passed over. Of
accelerations, base shear and contact forces the series tell when they turn, the forces themselves
how much.
"""

from __future__ import annotations

from eventpound.mechanics.monitored import (
    Distances,
    Places,
    Running,
    update_all,
    update_extreme,
    update_turning_point,
)
from eventpound.mechanics.observables import difference
from eventpound.numerics.arrays import Floats
from eventpound.numerics.polynomial import first_root, only_root, value_and_slope
from eventpound.solvers.fast.compiled import compiled, compiled_noinline
from eventpound.solvers.fast.evaluate import observe_at_noinline
from eventpound.solvers.fast.links import CORE
from eventpound.solvers.fast.run import FastPlan, FastRun, FastSeries
from eventpound.solvers.fast.search import (
    bound_of_pair,
    distance_coefficient,
    set_distance,
    stays_above,
)
from eventpound.solvers.fast.sliding import add_stick_shear, any_rubbing, any_slider
from eventpound.tolerances import FLAT_WITHIN


@compiled
def take_instant(t: float, run: FastRun) -> None:
    """Take everything known at one time (s) into the extremes."""
    observed, running, at = run.observed, run.running, run.running.at
    for k in range(run.plan.distances.first.size):
        there = distance_now(k, observed.u, observed.gap, run.plan.distances)
        update_extreme(at.gap + k, there, t, running)
    update_all(at.acceleration, observed.a, t, running)
    update_extreme(at.base_shear, observed.base[1], t, running)
    update_all(at.contact_force, observed.contact_force, t, running)


@compiled
def distance_now(k: int, u: Floats, gap: Floats, distances: Distances) -> float:
    """Distance k by the displacements (m); gaps are variables of their own."""
    if k < gap.size:
        return float(gap[k])
    return difference(u, distances.first[k], distances.second[k])


@compiled
def _leader_of(k: int, at: Places, distances: Distances) -> int:
    """Distance with which distance k turns: the displacement of its only body, or itself."""
    first, second = distances.first[k], distances.second[k]
    return k if min(first, second) >= 0 else at.displacement - at.gap + max(first, second)


@compiled
def stays_within(i: int, low: float, high: float, running: Running) -> bool:
    """Whether quantity i, between `low` and `high`, stays within its extremes."""
    same = running.rounding[i]
    return high <= running.maximum[i] + same and low >= running.minimum[i] - same


@compiled_noinline
def turning_times(c: Floats, size: int, tau: float, turns: Floats, work: Floats) -> int:
    """Local times in (0, tau) at which a polynomial with the rate `c` turns, into `turns`.

    Their number is returned; `c` is overwritten.
    """
    spread = 0.0
    for k in range(size - 1, 0, -1):
        spread = (spread + abs(c[k])) * tau
    # So large a rate does not change its sign.
    if abs(c[0]) > spread:
        return 0
    steepens = 0.0
    for k in range(size - 1, 1, -1):
        steepens = (steepens + k * abs(c[k])) * tau
    # So large a slope of it does not either: there is one root at most.
    if abs(c[1]) > steepens:
        return _only_turning_time(c, size, tau, turns)
    found, past = 0, 0.0
    while found < turns.size:
        start = 0
        while start < size and c[start] == 0.0:
            start += 1
        if start == size:
            break
        # `first_root` looks for a fall.
        if c[start] < 0.0:
            for k in range(size):
                c[k] = -c[k]
        root = first_root(c, size, tau - past, work)
        if not root < tau - past:
            break
        past += root
        turns[found] = past
        found += 1
        shift(c, size, root)
        # At its root the rate is zero, whatever rounding left of it, or it would be found again.
        c[0] = 0.0
    return found


@compiled
def _only_turning_time(c: Floats, size: int, tau: float, turns: Floats) -> int:
    """As `turning_times` for a rate that itself only grows or only falls."""
    end, _ = value_and_slope(c[:size], tau)
    if not c[0] * end < 0.0:
        return 0
    if c[0] < 0.0:
        for k in range(size):
            c[k] = -c[k]
    turns[0] = only_root(c, size, tau)
    return 1 if turns[0] < tau else 0


@compiled
def shift(c: Floats, size: int, x: float) -> None:
    """Coefficients about x (Taylor shift), in place."""
    for i in range(size - 1):
        for k in range(size - 2, i - 1, -1):
            c[k] += x * c[k + 1]


@compiled
def inside_step(tau: float, order: int, run: FastRun) -> None:
    """Turning points of distances within a step of length tau (s)."""
    plan, state, of_body, at = run.plan, run.state, run.series.of_body, run.running.at
    distances = plan.distances
    for k in range(distances.first.size):
        first, second = distances.first[k], distances.second[k]
        # What turns with its only body is taken with that.
        if _leader_of(k, at, distances) != k:
            continue
        if first < 0:
            # A spring to the ground that yields or unloads ends the step where it reverses.
            h = plan.links.grounded[second]
            if h >= 0 and state.part[h] != CORE:
                continue
        head, tail = of_body[first] if first >= 0 else -1, of_body[second]
        value = distance_now(k, state.u, state.gap, distances)
        _pair(at.gap + k, head, tail, value, tau, order, run)


@compiled
def _pair(i: int, head: int, tail: int, value: float, tau: float, order: int, run: FastRun) -> None:
    """Turning points of the distance of two clusters."""
    series, running = run.series, run.running
    if head == tail:
        return
    reach, swing = bound_of_pair(head, tail, series.reach), bound_of_pair(head, tail, series.swing)
    if stays_within(i, value - reach, value + reach, running):
        return
    rate = distance_coefficient(head, tail, 1, series)
    slope = 2.0 * distance_coefficient(head, tail, 2, series)
    bend = 3.0 * distance_coefficient(head, tail, 3, series)
    # `stays_above` is about what starts above zero.
    if rate < 0.0:
        rate, slope, bend = -rate, -slope, -bend
    if not stays_above(rate, slope, bend, swing, tau):
        _locate(i, head, tail, value, tau, order, run)


@compiled
def _locate(
    i: int, head: int, tail: int, value: float, tau: float, order: int, run: FastRun
) -> None:
    set_distance(value, 1.0, head, tail, order, run.series)
    _set_rate(run.series.c, order, run.series.d)
    _take_turns(i, run.series.c, order, tau, run)


@compiled
def _set_rate(c: Floats, order: int, d: Floats) -> None:
    """Rate of a polynomial c of a degree into d."""
    for k in range(order):
        d[k] = (k + 1) * c[k + 1]


@compiled
def _take_turns(i: int, c: Floats, order: int, tau: float, run: FastRun) -> None:
    """Turning points within tau (s) of quantity i, a polynomial c with the rate `series.d`.

    `series.d` is overwritten.
    """
    series, t, near = run.series, run.state.now[0].t, _flat_time(run.plan)
    for m in range(turning_times(series.d, order, tau, series.turns, series.work)):
        there, _ = value_and_slope(c[: order + 1], series.turns[m])
        take_turn(i, there, t + series.turns[m], near, run.plan, run.running)


@compiled
def take_turn(
    i: int, value: float, t: float, near: float, plan: FastPlan, running: Running
) -> None:
    """Take a turning point of quantity i into the extremes, and of the distances it leads."""
    distances, at = plan.distances, running.at
    leader, b = i - at.gap, i - at.displacement
    update_turning_point(i, value, t, near, running)
    for k in range(at.acceleration - at.gap):
        if k != leader and _leader_of(k, at, distances) == leader:
            start = plan.contacts.gap[k] if k < plan.contacts.gap.size else 0.0
            # A gap on the left of its body opens as that moves on, one on the right closes.
            there = start + (value if distances.second[k] == b else -value)
            update_turning_point(at.gap + k, there, t, near, running)


@compiled
def _flat_time(plan: FastPlan) -> float:
    """Time over which a peak is flat to rounding (s): |u - peak| = a t²/2 with a = L/T²."""
    return float(FLAT_WITHIN * plan.limits.time)


@compiled
def forces_inside_step(tau: float, order: int, last: Floats, run: FastRun) -> bool:
    """Turning points within a step of length tau (s); whether `observed` was overwritten.

    `last` (N,) has the absolute accelerations at its end (m/s²). A quantity whose rate changes by
    no more than b all in all goes one way if its rate at the start is larger, and strays from the
    straight line between its values at both ends by no more than b τ / 4.
    """
    plan, state, series, running = run.plan, run.state, run.series, run.running
    bodies, at = plan.mass.size, running.at
    shear, end, rate, bend = 0.0, 0.0, 0.0, 0.0
    # Where nothing rests on a barrier or is pushed, all links to the ground together pull at all
    # bodies.
    pushed = state.progress[0].resting > 0 or series.load.shape[0] > 0
    overwritten = False
    for b in range(bodies):
        c, m = series.of_body[b], plan.mass[b]
        if c < 0:
            continue
        value, its_rate = _acceleration_term(c, 0, series), _acceleration_term(c, 1, series)
        # Links between bodies cancel in the sum, so those to the ground give all of Σ m a.
        shear, end = shear - m * value, end - m * last[b]
        rate, bend = rate - m * its_rate, bend + m * series.bend[c]
        if _may_turn(at.acceleration + b, value, last[b], its_rate, series.bend[c], tau, running):
            series.d[:] = 0.0
            _add_acceleration_rate(c, 1.0, order, series)
            overwritten = _turns(c, tau, order, run) or overwritten
    if pushed:
        value = _base_shear(order, plan, series)
        if any_slider(run):
            value += add_stick_shear(order, run)
        if not _settled(at.base_shear, value, tau, order, series, running):
            overwritten = _turns(-1, tau, order, run) or overwritten
    elif _may_turn(at.base_shear, shear, end, rate, bend, tau, running):
        series.d[:] = 0.0
        for b in range(bodies):
            _add_acceleration_rate(series.of_body[b], -plan.mass[b], order, series)
        overwritten = _turns(-1, tau, order, run) or overwritten
    if state.progress[0].resting > 0:
        _at_rest(tau, order, run)
    return overwritten


@compiled
def _may_turn(
    i: int, value: float, end: float, rate: float, bend: float, tau: float, running: Running
) -> bool:
    """Whether a quantity may turn within a step beyond its extremes, by the bound `bend`."""
    stray = 0.25 * bend * tau
    return not (
        abs(rate) > bend
        or stays_within(i, min(value, end) - stray, max(value, end) + stray, running)
    )


@compiled
def _settled(
    i: int, value: float, tau: float, order: int, series: FastSeries, running: Running
) -> bool:
    """Whether a quantity whose rate is `series.d` cannot exceed its extremes in the step."""
    d, spread = series.d, 0.0
    for k in range(order - 3, -1, -1):
        spread = (spread + abs(d[k]) / (k + 1)) * tau
    return stays_within(i, value - spread, value + spread, running)


@compiled
def _turns(c: int, tau: float, order: int, run: FastRun) -> bool:
    """Take the acceleration of cluster c, or for -1 the base shear, where its rate vanishes.

    The rate is `series.d`; returned is whether it vanishes within the step.
    """
    plan, series, observed, running = run.plan, run.series, run.observed, run.running
    turns = turning_times(series.d, order - 2, tau, series.turns, series.work)
    for m in range(turns):
        # No acceleration of the ground is needed there, but by what sticks to it.
        ground = 0.0
        if any_slider(run):
            ground, _ = value_and_slope(series.ground[: order + 1], series.turns[m])
        observe_at_noinline(series.turns[m], order, ground, run)
        t, near = run.state.now[0].t + series.turns[m], _flat_time(plan)
        if c < 0:
            update_turning_point(running.at.base_shear, observed.base[1], t, near, running)
            continue
        for b in range(plan.mass.size):
            if series.of_body[b] == c:
                update_turning_point(running.at.acceleration + b, observed.a[b], t, near, running)
    return turns > 0


@compiled
def _acceleration_term(c: int, k: int, series: FastSeries) -> float:
    """Coefficient k of the absolute acceleration of a cluster (m/s^(2+k))."""
    return (k + 1) * (k + 2) * series.X[c, k + 2] + series.ground[k]


@compiled
def _add_acceleration_rate(c: int, factor: float, order: int, series: FastSeries) -> None:
    """Add a multiple of the rate of the absolute acceleration of a cluster to `series.d`."""
    for k in range(1, order - 1):
        series.d[k - 1] += factor * k * _acceleration_term(c, k, series)


@compiled
def _base_shear(order: int, plan: FastPlan, series: FastSeries) -> float:
    """Sum of the forces of links to the ground (N); its rate goes into `series.d`."""
    F, d, on_ground = series.F, series.d, plan.links.on_ground
    value = 0.0
    for k in range(order - 2):
        d[k] = 0.0
    for a in range(on_ground.size):
        part = on_ground[a]
        value += part * F[a, 0]
        # The force of a link at rest does not change.
        if part != 0.0 and series.ends[a, 0] != series.ends[a, 1]:
            for k in range(order - 2):
                d[k] += part * (k + 1) * F[a, k + 1]
    return value


@compiled
def _at_rest(tau: float, order: int, run: FastRun) -> None:
    """Forces of resting contacts, and bodies that stand still and move with the ground."""
    state, series, at = run.state, run.series, run.running.at
    # Contacts that others keep closed have no force, unless all of them share it.
    shared, progress = any_rubbing(run), state.progress[0]
    for i in range(progress.resting if shared else progress.edges):
        j = series.resting[i] if shared else series.elimination[i, 1]
        _polynomial_turns(at.contact_force + j, series.contact_force[j], tau, order, run)
    for b in range(state.u.size):
        if series.of_body[b] < 0:
            _polynomial_turns(at.acceleration + b, series.ground, tau, order, run)


@compiled
def _polynomial_turns(i: int, c: Floats, tau: float, order: int, run: FastRun) -> None:
    """Turning points of a quantity known by its own series."""
    _set_rate(c, order - 2, run.series.d)
    if not _settled(i, c[0], tau, order, run.series, run.running):
        _take_turns(i, c, order - 2, tau, run)
