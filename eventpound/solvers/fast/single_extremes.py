"""Extremes of a single body.

Displacement, spring elongations and gaps have theirs where the body turns and
where a stretch ends; without dashpots so have acceleration and base shear, for
the spring forces grow with the displacement. Only with dashpots the acceleration is
looked at within each step.
"""

from __future__ import annotations

from eventpound.numerics.arrays import Floats, Ints
from eventpound.solvers.events.inspection import (
    Running,
    update_extreme,
    update_turning_point,
)
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.extremes import flat_time, turning_times
from eventpound.solvers.fast.plan import Contacts, Plan, Series, State
from eventpound.solvers.fast.single import absolute_acceleration, spring_state
from eventpound.solvers.fast.single_series import motion


@compiled
def exceeds(i: int, low: float, high: float, running: Running) -> bool:
    """Whether a quantity that may reach `low` and `high` may leave its extremes."""
    same = running.rounding[i]
    return high > running.maximum[i] + same or low < running.minimum[i] - same


@compiled
def force_exceeds(low: float, high: float, plan: Plan, running: Running) -> bool:
    """Whether the absolute acceleration (m/s²), or the base shear it makes, may leave its extremes.

    The two are apart once the body has rested on a barrier.
    """
    a, mass = running.maximum.size - 2 - plan.contacts.gap.size, plan.mass[0]
    return exceeds(a, low, high, running) or exceeds(a + 1, -mass * high, -mass * low, running)


@compiled_apart
def take_turn(
    t: float,
    u: float,
    acceleration: float,
    near: float,
    shear: float,
    springs: int,
    ends: Ints,
    contacts: Contacts,
    running: Running,
) -> None:
    """Take a turning point, or the end of a stretch, at t (s) into the extremes."""
    update_turning_point(0, u, t, near, running)
    for a in range(springs):
        x = u if ends[a, 1] >= 0 else -u
        update_turning_point(1 + a, x, t, near, running)
    place = 1 + springs
    for j in range(contacts.gap.size):
        gap = contacts.gap[j] + (u if contacts.right[j] >= 0 else -u)
        update_turning_point(place + j, gap, t, near, running)
    place += contacts.gap.size
    update_extreme(place, acceleration, t, running)
    update_extreme(place + 1, shear, t, running)


@compiled
def take_if_new(t: float, u: float, acceleration: float, plan: Plan, running: Running) -> None:
    """The same where it is beyond, or just at, the extremes so far."""
    same = 2.0 * running.rounding[0]
    if (
        u > running.maximum[0] - same
        or u < running.minimum[0] + same
        or force_exceeds(acceleration, acceleration, plan, running)
    ):
        take_turn(
            t,
            u,
            acceleration,
            flat_time(plan),
            -plan.mass[0] * acceleration,
            plan.links.springs,
            plan.links.ends,
            plan.contacts,
            running,
        )


@compiled
def damped_acceleration(
    t: float,
    tau: float,
    order: int,
    acceleration: float,
    even: float,
    odd: float,
    g: Floats,
    x: Floats,
    plan: Plan,
    state: State,
    series: Series,
    running: Running,
) -> None:
    """Turning points of acceleration and base shear within a step, and their values at its end."""
    d, spread = series.single_rate, 0.0
    for k in range(order - 2, 0, -1):
        term = (k + 1) * (k + 2) * x[k + 2] + g[k] * (odd if k & 1 else even)
        d[k - 1] = k * term
        spread = (spread + abs(term)) * tau
    if force_exceeds(acceleration - spread, acceleration + spread, plan, running):
        _locate(t, tau, order, x, plan, state, series, running)


@compiled_apart
def _locate(
    t: float,
    tau: float,
    order: int,
    x: Floats,
    plan: Plan,
    state: State,
    series: Series,
    running: Running,
) -> None:
    i = running.maximum.size - 2 - plan.contacts.gap.size
    near = flat_time(plan)
    found = turning_times(series.single_rate, order - 2, tau, series.turns, series.work)
    for m in range(found + 1):
        at = series.turns[m] if m < found else tau
        change, v, _ = motion(at, order, x)
        u = state.u[0] + change
        z = spring_state(u, plan.oscillator, plan.hysteresis, state)
        a = absolute_acceleration(u, v, z, plan.oscillator)
        update_turning_point(i, a, t + at, near, running)
        update_turning_point(i + 1, -plan.mass[0] * a, t + at, near, running)
