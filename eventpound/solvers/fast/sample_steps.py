"""Several bodies from sample to sample of a record, where all their links are linear.

Steps are exact (`eventpound.solvers.fast.sample_tables`) and are taken only where
bounds (`eventpound.solvers.fast.sample_bounds`) exclude every event, and every
extreme that is not the end of a step.
"""

from __future__ import annotations

import math

from eventpound.motion.forcing import sample_time
from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.inspection import Running, update_extreme
from eventpound.solvers.fast.backbone_parts import SATURATED, UNLOADING, hysteretic_variable
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.history import sample_step
from eventpound.solvers.fast.plan import (
    GUESS,
    IN_A_ROW,
    OUTPUT,
    RESTING,
    SINCE_IMPACT,
    STALLED,
    STEPS,
    Plan,
    Record,
    Series,
    State,
    T,
)
from eventpound.solvers.fast.sample_bounds import (
    forces_unseen,
    places_unseen,
    stays_linear,
    stays_open,
)
from eventpound.solvers.fast.sample_tables import (
    ACCELERATION,
    FASTEST,
    MOST_TURN,
    NEXT_ACCELERATION,
    NEXT_U,
    NEXT_V,
    NEXT_X,
    NEXT_X_RATE,
    PULLED,
    SAG,
    X_RATE,
    SampleTables,
    X,
    table_of,
)
from eventpound.solvers.fast.seen import Seen


@compiled
def may_go_by_samples(plan: Plan, state: State, series: Series) -> bool:
    """Whether the bodies move freely, with every hysteretic link on a line."""
    count = state.count
    if (
        count[RESTING] > 0
        or count[IN_A_ROW] > 0
        or plan.limits.ledger
        or series.tables.turn.shape[1] == 0
    ):
        return False
    for h in range(state.part.size):
        if UNLOADING < state.part[h] < SATURATED:
            return False
    return True


@compiled
def sample_steps(
    budget: int,
    piece_end: float,
    family: int,
    coefficients: Floats,
    samples: Floats,
    plan: Plan,
    state: State,
    series: Series,
    seen: Seen,
    record: Record,
    running: Running,
) -> int:
    """Steps from the sample at which the bodies are, as far as nothing can happen; how many.

    Rows of the history that fall between samples are written on the way, so that
    the motion does not depend on them.
    """
    origin, dt, clock, count = coefficients[0], coefficients[1], state.clock, state.count
    times, tables = plan.output_times, series.tables
    first = math.floor((clock[T] - origin) / dt + 0.5)
    if clock[T] != sample_time(origin, dt, first):
        return 0
    shear = _start(plan, state, series)
    i = table_of(dt, series.stiffness, plan.links.ends, plan.links.law.damping, plan.mass, tables)
    if tables.most_turn[i] > MOST_TURN:
        return 0
    until, segment = piece_end - 1e-9 * dt, first
    while segment - first < budget and segment + 2 < samples.size:
        following = sample_time(origin, dt, segment + 1)
        if not following < until:
            break
        slope, g = (samples[segment + 1] - samples[segment]) / dt, samples[segment + 1]
        _propose(i, dt, samples[segment], slope, state, tables)
        if not (
            stays_open(plan, state, tables)
            and stays_linear(dt, plan, state, tables)
            and places_unseen(dt, plan, state, tables, running)
        ):
            break
        next_shear = _forces(plan, state, tables)
        if not forces_unseen(i, dt, g, shear, next_shear, plan, state, tables, running):
            break
        if count[OUTPUT] < times.size and times[count[OUTPUT]] < following:
            order = plan.limits.order
            _expand(i, slope, order, state, series)
            sample_step(
                clock[T], following, order, family, coefficients, samples,
                plan, state, series, seen, record,
            )  # fmt: skip
        shear = next_shear
        _accept(following, shear, plan, state, tables, running)
        segment += 1
    if segment > first:
        count[STEPS] += segment - first
        count[STALLED] = 0
        clock[SINCE_IMPACT] += (segment - first) * dt
        clock[GUESS] = dt
    return segment - first


@compiled
def _start(plan: Plan, state: State, series: Series) -> float:
    """Tangents, elongations and absolute accelerations where the bodies are; the base shear (N)."""
    links, tables = plan.links, series.tables
    along = tables.along
    for a in range(links.offset.size):
        first, second = links.ends[a, 0], links.ends[a, 1]
        x, rate = 0.0, 0.0
        if second >= 0:
            x, rate = state.u[second], state.v[second]
        if first >= 0:
            x, rate = x - state.u[first], rate - state.v[first]
        along[NEXT_X, a], along[NEXT_X_RATE, a] = x, rate
        k = links.compression[a] if state.branch[a] < 0 else links.extension[a]
        h = links.z_of_link[a]
        if h >= 0 and state.part[h] <= UNLOADING:
            k += links.law.strength[a] / links.law.yield_displacement[a]
        series.stiffness[a] = k
    shear = _forces(plan, state, tables)
    _next_is_now(tables)
    return shear


@compiled
def _next_is_now(tables: SampleTables) -> None:
    bodies, along = tables.bodies, tables.along
    for b in range(bodies.shape[1]):
        bodies[ACCELERATION, b] = bodies[NEXT_ACCELERATION, b]
    for a in range(along.shape[1]):
        along[X, a], along[X_RATE, a] = along[NEXT_X, a], along[NEXT_X_RATE, a]


@compiled
def _forces(plan: Plan, state: State, tables: SampleTables) -> float:
    """Absolute accelerations at the end of the step by the forces there; the base shear (N)."""
    links, law, bodies, along = plan.links, plan.links.law, tables.bodies, tables.along
    for b in range(plan.mass.size):
        bodies[NEXT_ACCELERATION, b] = 0.0
    shear = 0.0
    for a in range(links.offset.size):
        x = along[NEXT_X, a]
        k = links.compression[a] if state.branch[a] < 0 else links.extension[a]
        force = k * (x - links.offset[a]) + law.damping[a] * along[NEXT_X_RATE, a]
        h = links.z_of_link[a]
        if h >= 0:
            force += law.strength[a] * hysteretic_variable(h, x, plan.hysteresis, state)
        first, second = links.ends[a, 0], links.ends[a, 1]
        if first >= 0:
            bodies[NEXT_ACCELERATION, first] += force
        else:
            shear += force
        if second >= 0:
            bodies[NEXT_ACCELERATION, second] -= force
        else:
            shear -= force
    for b in range(plan.mass.size):
        bodies[NEXT_ACCELERATION, b] /= plan.mass[b]
    return shear


@compiled
def _propose(i: int, dt: float, g: float, slope: float, state: State, tables: SampleTables) -> None:
    """The motion at the end of a step from a sample g (m/s²) of the record, and its bounds."""
    bodies, n = tables.bodies, state.u.size
    for b in range(n):
        bodies[PULLED, b] = bodies[ACCELERATION, b] - g
    largest = 0.0
    for b in range(n):
        change, rate = tables.of_slope[i, b] * slope, tables.rate_of_slope[i, b] * slope
        jerk = abs(slope)
        for c in range(n):
            v, a = state.v[c], bodies[PULLED, c]
            change += tables.of_v[i, b, c] * v + tables.of_a[i, b, c] * a
            rate += tables.rate_of_v[i, b, c] * v + tables.rate_of_a[i, b, c] * a
            jerk += abs(tables.stiffness[i, b, c] * v)
        bodies[NEXT_U, b], bodies[NEXT_V, b] = state.u[b] + change, rate
        bodies[FASTEST, b] = abs(bodies[PULLED, b]) + dt * jerk
        largest = max(largest, bodies[FASTEST, b])
    # |a| <= |a_0| + dt (|K| (|v_0| + dt |a|) + |C| |a| + |s|)
    largest /= 1.0 - tables.most_turn[i]
    for b in range(n):
        bodies[FASTEST, b] += tables.turn[i, b] * largest
        bodies[SAG, b] = 0.125 * dt * dt * bodies[FASTEST, b]


@compiled
def _expand(i: int, slope: float, order: int, state: State, series: Series) -> None:
    """Taylor series of the step, which give rows between samples."""
    X_, tables, n = series.X, series.tables, state.u.size
    for b in range(n):
        c = series.of_body[b]
        X_[c, 1], X_[c, 2] = state.v[b], 0.5 * tables.bodies[PULLED, b]
    for k in range(1, order - 1):
        for b in range(n):
            total = -slope if k == 1 else 0.0
            for d in range(n):
                c = series.of_body[d]
                total -= tables.stiffness[i, b, d] * X_[c, k]
                total -= tables.damping[i, b, d] * (k + 1) * X_[c, k + 1]
            X_[series.of_body[b], k + 2] = total / ((k + 1) * (k + 2))


@compiled
def _accept(
    t: float, shear: float, plan: Plan, state: State, tables: SampleTables, running: Running
) -> None:
    """Make the end of the step, at t (s), the present state, and take it into the extremes."""
    bodies, contacts, springs = tables.bodies, plan.contacts, plan.links.springs
    n, k = state.u.size, contacts.gap.size
    _next_is_now(tables)
    state.clock[T] = t
    for b in range(n):
        state.u[b], state.v[b] = bodies[NEXT_U, b], bodies[NEXT_V, b]
        update_extreme(b, state.u[b], t, running)
        update_extreme(n + springs + k + b, bodies[ACCELERATION, b], t, running)
    for a in range(springs):
        update_extreme(n + a, tables.along[X, a], t, running)
    for j in range(k):
        left, right = contacts.left[j], contacts.right[j]
        gap, rate = contacts.gap[j], 0.0
        if right >= 0:
            gap, rate = gap + state.u[right], state.v[right]
        if left >= 0:
            gap, rate = gap - state.u[left], rate - state.v[left]
        state.gap[j], state.gap_rate[j] = gap, rate
        update_extreme(n + springs + j, gap, t, running)
    update_extreme(2 * n + springs + k, shear, t, running)
