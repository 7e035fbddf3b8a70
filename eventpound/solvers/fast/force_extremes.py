"""Exact extremes of accelerations, base shear and contact forces within a step.

Their series tell when they turn, the forces themselves how much.
"""

from __future__ import annotations

from eventpound.numerics.arrays import Floats
from eventpound.numerics.polynomial import value_and_slope
from eventpound.solvers.events.inspection import Running, update_turning_point
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.extremes import flat_time, turning_times, within
from eventpound.solvers.fast.plan import ACTIVE, CLUSTERS, RESTING, Plan, Series, State, T
from eventpound.solvers.fast.seen import Seen, look_apart


@compiled
def forces_inside_step(
    tau: float,
    order: int,
    plan: Plan,
    state: State,
    series: Series,
    seen: Seen,
    running: Running,
) -> bool:
    """Turning points within a step of length tau (s); whether `seen` was overwritten."""
    bodies, contacts = plan.mass.size, plan.contacts.gap.size
    first = bodies + plan.links.springs + contacts
    shear = first + bodies
    looked = False
    for c in range(state.count[CLUSTERS]):
        value = _cluster_acceleration(c, order, state, series)
        for b in range(bodies):
            if series.of_body[b] != c:
                continue
            if not _settled(first + b, value, tau, order, series, running):
                turns = turning_times(series.d, order - 2, tau, series.turns, series.work)
                for m in range(turns):
                    _look_at(m, order, plan, state, series, seen)
                    _take(first, c, m, plan, state, series, seen, running)
                looked = looked or turns > 0
                break
    value = _base_shear(order, plan, state, series)
    if not _settled(shear, value, tau, order, series, running):
        turns = turning_times(series.d, order - 2, tau, series.turns, series.work)
        for m in range(turns):
            _look_at(m, order, plan, state, series, seen)
            t = state.clock[T] + series.turns[m]
            update_turning_point(shear, seen.base[1], t, flat_time(plan), running)
        looked = looked or turns > 0
    if state.count[RESTING] > 0:
        _at_rest(first, tau, order, plan, state, series, running)
    return looked


@compiled
def _settled(
    i: int, value: float, tau: float, order: int, series: Series, running: Running
) -> bool:
    """Whether a quantity whose rate is `series.d` cannot exceed its extremes in the step."""
    d, spread = series.d, 0.0
    for k in range(order - 3, -1, -1):
        spread = (spread + abs(d[k]) / (k + 1)) * tau
    return within(i, value, spread, running)


@compiled
def _look_at(m: int, order: int, plan: Plan, state: State, series: Series, seen: Seen) -> None:
    """Everything at a turning point; no acceleration of the ground is needed there."""
    look_apart(series.turns[m], order, 0.0, plan, state, series, seen)


@compiled
def _take(
    first: int,
    c: int,
    m: int,
    plan: Plan,
    state: State,
    series: Series,
    seen: Seen,
    running: Running,
) -> None:
    """Take the acceleration of a cluster's bodies at a turning point."""
    t = state.clock[T] + series.turns[m]
    for b in range(plan.mass.size):
        if series.of_body[b] == c:
            update_turning_point(first + b, seen.a[b], t, flat_time(plan), running)


@compiled
def _cluster_acceleration(c: int, order: int, state: State, series: Series) -> float:
    """Absolute acceleration of a cluster (m/s²); its rate goes into `series.d`."""
    F, d = series.F, series.d
    value = 0.0
    for k in range(order - 2):
        d[k] = 0.0
    for i in range(state.count[ACTIVE]):
        a = series.active[i]
        sign = 0.0
        if series.ends[a, 0] == c:
            sign += series.inverse_mass[c]
        if series.ends[a, 1] == c:
            sign -= series.inverse_mass[c]
        if sign != 0.0:
            value += sign * F[a, 0]
            for k in range(order - 2):
                d[k] += sign * (k + 1) * F[a, k + 1]
    return value


@compiled
def _base_shear(order: int, plan: Plan, state: State, series: Series) -> float:
    """Sum of the forces of links to the ground (N); its rate goes into `series.d`."""
    F, d, ends = series.F, series.d, plan.links.ends
    value = 0.0
    for k in range(order - 2):
        d[k] = 0.0
    for a in range(ends.shape[0]):
        sign = 0.0
        if ends[a, 0] < 0:
            sign += 1.0
        if ends[a, 1] < 0:
            sign -= 1.0
        value += sign * F[a, 0]
        # The force of a link at rest does not change.
        if sign != 0.0 and series.ends[a, 0] != series.ends[a, 1]:
            for k in range(order - 2):
                d[k] += sign * (k + 1) * F[a, k + 1]
    return value


@compiled
def _at_rest(
    first: int,
    tau: float,
    order: int,
    plan: Plan,
    state: State,
    series: Series,
    running: Running,
) -> None:
    """Forces of resting contacts, and bodies that stand still and move with the ground."""
    bodies = plan.mass.size
    for j in range(state.resting.size):
        if state.resting[j]:
            place = first + bodies + 1 + j
            _polynomial_turns(
                place, series.contact_force[j], tau, order, plan, state, series, running
            )
    for b in range(bodies):
        if series.of_body[b] < 0:
            _polynomial_turns(first + b, series.ground, tau, order, plan, state, series, running)


@compiled
def _polynomial_turns(
    i: int,
    c: Floats,
    tau: float,
    order: int,
    plan: Plan,
    state: State,
    series: Series,
    running: Running,
) -> None:
    """Turning points of a quantity known by its own series."""
    d = series.d
    for k in range(order - 2):
        d[k] = (k + 1) * c[k + 1]
    if _settled(i, c[0], tau, order, series, running):
        return
    for m in range(turning_times(d, order - 2, tau, series.turns, series.work)):
        there, _ = value_and_slope(c[: order - 1], series.turns[m])
        t = state.clock[T] + series.turns[m]
        update_turning_point(i, there, t, flat_time(plan), running)
