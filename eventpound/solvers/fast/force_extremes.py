"""Exact extremes of accelerations, base shear and contact forces within a step.

Their series tell when they turn, the forces themselves how much.
"""

from __future__ import annotations

from eventpound.numerics.arrays import Floats
from eventpound.numerics.polynomial import value_and_slope
from eventpound.solvers.events.cascade import T
from eventpound.solvers.events.event_bounds import Running, update_turning_point
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.evaluate import look_apart
from eventpound.solvers.fast.extremes import flat_time, turning_times, within
from eventpound.solvers.fast.run import RESTING, Plan, Run, Series


@compiled
def forces_inside_step(tau: float, order: int, run: Run) -> bool:
    """Turning points within a step of length tau (s); whether `seen` was overwritten."""
    plan, state, series, running = run.plan, run.state, run.series, run.running
    bodies, contacts = plan.mass.size, plan.contacts.gap.size
    first = bodies + plan.links.springs + contacts
    shear, spread = 0.0, 0.0
    looked = False
    for b in range(bodies):
        c = series.of_body[b]
        if c < 0:
            continue
        value, change = _acceleration(c, tau, order, series)
        shear -= plan.mass[b] * value
        spread += plan.mass[b] * change
        if not within(first + b, value, change, running):
            _set_acceleration_rate(c, order, series)
            looked = _turns(c, tau, order, run) or looked
    # Where nothing rests on a barrier, is pushed or presses on it by a law of its own, all links
    # to the ground together pull at all bodies.
    place = first + bodies
    held = state.count[RESTING] > 0 or series.load.shape[0] > 0 or series.drag.size > 0
    if held or not within(place, shear, spread, running):
        value = shear
        if held:
            value = _base_shear(order, plan, series)
        else:
            _shear_rate_of_bodies(order, plan.mass, series)
        if not _settled(place, value, tau, order, series, running):
            looked = _turns(-1, tau, order, run) or looked
    if state.count[RESTING] > 0:
        _at_rest(first, tau, order, run)
    if series.drag.size > 0:
        _of_laws(first + bodies + 1, tau, order, run)
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
def _turns(c: int, tau: float, order: int, run: Run) -> bool:
    """Take the acceleration of cluster c, or for -1 the base shear, where its rate vanishes.

    The rate is `series.d`; returned is whether it vanishes within the step.
    """
    plan, state, series, seen, running = run.plan, run.state, run.series, run.seen, run.running
    bodies = plan.mass.size
    first = bodies + plan.links.springs + plan.contacts.gap.size
    turns = turning_times(series.d, order - 2, tau, series.turns, series.work)
    for m in range(turns):
        # No acceleration of the ground is needed there.
        look_apart(series.turns[m], order, 0.0, run)
        t, near = state.clock[T] + series.turns[m], flat_time(plan)
        if c < 0:
            update_turning_point(first + bodies, seen.base[1], t, near, running)
            continue
        for b in range(bodies):
            if series.of_body[b] == c:
                update_turning_point(first + b, seen.a[b], t, near, running)
    return turns > 0


@compiled
def _acceleration(c: int, tau: float, order: int, series: Series) -> tuple[float, float]:
    """Absolute acceleration of a cluster (m/s²), and how much it may change within the step."""
    X, ground, spread = series.X, series.ground, 0.0
    for k in range(order - 2, 0, -1):
        spread = (spread + abs((k + 1) * (k + 2) * X[c, k + 2] + ground[k])) * tau
    return 2.0 * X[c, 2] + ground[0], spread


@compiled
def _set_acceleration_rate(c: int, order: int, series: Series) -> None:
    """Rate of the absolute acceleration of a cluster into `series.d`."""
    X, ground = series.X, series.ground
    for k in range(1, order - 1):
        series.d[k - 1] = k * ((k + 1) * (k + 2) * X[c, k + 2] + ground[k])


@compiled
def _shear_rate_of_bodies(order: int, mass: Floats, series: Series) -> None:
    """Rate of the base shear into `series.d`, where no body is held but by links."""
    X, d, ground = series.X, series.d, series.ground
    for k in range(1, order - 1):
        d[k - 1] = 0.0
        for b in range(mass.size):
            c = series.of_body[b]
            d[k - 1] -= mass[b] * k * ((k + 1) * (k + 2) * X[c, k + 2] + ground[k])


@compiled
def _base_shear(order: int, plan: Plan, series: Series) -> float:
    """Sum of the forces of links to the ground (N); its rate goes into `series.d`."""
    F, d, ends = series.F, series.d, plan.links.ends
    value = 0.0
    for k in range(order - 2):
        d[k] = 0.0
    for a in range(plan.links.plain):
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
def _at_rest(first: int, tau: float, order: int, run: Run) -> None:
    """Forces of resting contacts, and bodies that stand still and move with the ground."""
    plan, state, series = run.plan, run.state, run.series
    bodies = plan.mass.size
    for j in range(state.resting.size):
        if state.resting[j]:
            place = first + bodies + 1 + j
            _polynomial_turns(place, series.contact_force[j], tau, order, run)
    for b in range(bodies):
        if series.of_body[b] < 0:
            _polynomial_turns(first + b, series.ground, tau, order, run)


@compiled_apart
def _of_laws(first: int, tau: float, order: int, run: Run) -> None:
    """Forces of closed contact elements."""
    plan, state, series = run.plan, run.state, run.series
    for p in range(plan.laws.contact.size):
        a, j = plan.links.plain + p, plan.laws.contact[p]
        if state.branch[a] < 0:
            for k in range(order - 1):
                series.contact_force[j, k] = -series.F[a, k]
            _polynomial_turns(first + j, series.contact_force[j], tau, order, run)


@compiled
def _polynomial_turns(i: int, c: Floats, tau: float, order: int, run: Run) -> None:
    """Turning points of a quantity known by its own series."""
    plan, state, series, running = run.plan, run.state, run.series, run.running
    d = series.d
    for k in range(order - 2):
        d[k] = (k + 1) * c[k + 1]
    if _settled(i, c[0], tau, order, series, running):
        return
    for m in range(turning_times(d, order - 2, tau, series.turns, series.work)):
        there, _ = value_and_slope(c[: order - 1], series.turns[m])
        t = state.clock[T] + series.turns[m]
        update_turning_point(i, there, t, flat_time(plan), running)
