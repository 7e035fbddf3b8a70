"""Several bodies under a record, step by step as long as nothing happens.

From sample to sample the bodies go by exact steps (`eventpound.solvers.fast.sample_tables`)
where all their links are linear, by short series (`eventpound.solvers.fast.sample_series`)
where one is on a curved part, and from between two samples to the next. A step is
taken only where bounds (`eventpound.solvers.fast.sample_bounds`) exclude every event, and every
extreme that is not one of its ends; any other is left to `eventpound.solvers.fast.step`.
"""

from __future__ import annotations

import math

from eventpound.motion.forcing import next_sample, sample_time
from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.inspection import Running, update_extreme
from eventpound.solvers.fast.backbone_parts import UNLOADING, hysteretic_variable, saturate
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.elongation import elongations
from eventpound.solvers.fast.history import sample_step
from eventpound.solvers.fast.plan import (
    EXPANSIONS,
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
    forces_covered,
    forces_go_one_way,
    keeps_parts,
    places_unseen,
    stays_open,
)
from eventpound.solvers.fast.sample_series import (
    propose_by_series,
    series_error,
    set_series_jerks,
)
from eventpound.solvers.fast.sample_tables import (
    ACCELERATION,
    MOST_TURN,
    NEXT_ACCELERATION,
    NEXT_U,
    NEXT_V,
    NEXT_X,
    NEXT_X_RATE,
    PULLED,
    X_RATE,
    SampleTables,
    X,
    propose_by_matrices,
    set_jerks,
    table_of,
)
from eventpound.solvers.fast.seen import Seen


@compiled
def may_go_by_samples(plan: Plan, state: State, series: Series) -> bool:
    """Whether every body moves freely, and there are few enough of them."""
    count = state.count
    if (
        count[RESTING] > 0
        or count[IN_A_ROW] > 0
        or plan.limits.ledger
        or series.tables.turn.shape[1] == 0
    ):
        return False
    for b in range(state.u.size):
        if series.of_body[b] != b:
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
) -> None:
    """Steps, as far as nothing can happen and no more than `budget`.

    Rows of the history that fall between samples are written on the way, so that
    the motion does not depend on them.
    """
    origin, dt, clock, count = coefficients[0], coefficients[1], state.clock, state.count
    times, tables = plan.output_times, series.tables
    segment = math.floor((next_sample(coefficients, clock[T], piece_end) - origin) / dt + 0.5) - 1
    shear = _start(plan, state, series)
    i = table_of(dt, series.stiffness, plan.links.ends, plan.links.law.damping, plan.mass, tables)
    until, last = piece_end - 1e-9 * dt, count[STEPS] + budget
    while count[STEPS] < last and segment + 2 < samples.size:
        t, following = clock[T], sample_time(origin, dt, segment + 1)
        if not (following < until and t + 1e-9 * dt < following):
            break
        since = t - sample_time(origin, dt, segment)
        slope = (samples[segment + 1] - samples[segment]) / dt
        g = samples[segment] + slope * since
        curved = saturate(tables.along[X], plan.hysteresis, state)
        matrices = since == 0.0 and not curved and tables.most_turn[i] <= MOST_TURN
        order, h, whole = _propose(i, matrices, following - t, g, slope, plan, state, series)
        clear, next_shear = _nothing_happens(
            i, matrices, order, h, g, slope, shear, plan, state, series, running
        )
        if not clear:
            break
        t_end = following if whole else t + h
        if count[OUTPUT] < times.size and times[count[OUTPUT]] < t_end:
            if matrices:
                _expand(i, slope, order, state, series)
            sample_step(
                t, t_end, order, family, coefficients, samples,
                plan, state, series, seen, record,
            )  # fmt: skip
        shear = next_shear
        _accept(t_end, h, matrices, shear, plan, state, tables, running)
        segment += 1 if whole else 0


@compiled
def _start(plan: Plan, state: State, series: Series) -> float:
    """Tangents, elongations and absolute accelerations where the bodies are; the base shear (N)."""
    links, along = plan.links, series.tables.along
    elongations(links.ends, state.u, state.v, along[NEXT_X], along[NEXT_X_RATE])
    for a in range(links.offset.size):
        k = links.compression[a] if state.branch[a] < 0 else links.extension[a]
        h = links.z_of_link[a]
        if h >= 0 and state.part[h] <= UNLOADING:
            k += links.law.strength[a] / links.law.yield_displacement[a]
        series.stiffness[a] = k
    shear = _forces(plan, state, series)
    _next_is_now(series.tables)
    return shear


@compiled
def _propose(
    i: int,
    matrices: bool,
    longest: float,
    g: float,
    slope: float,
    plan: Plan,
    state: State,
    series: Series,
) -> tuple[int, float, bool]:
    """Where a step from g (m/s²) of the record ends: its order, its length (s), if it is whole.

    The order is 0 where there is no step.
    """
    tables = series.tables
    for b in range(state.u.size):
        tables.bodies[PULLED, b] = tables.bodies[ACCELERATION, b] - g
    if matrices:
        propose_by_matrices(i, slope, state.u, state.v, tables)
        return plan.limits.order, tables.step[i], True
    order, h = propose_by_series(i, longest, slope, plan, state, series)
    return order, h, h == longest


@compiled
def _nothing_happens(
    i: int,
    matrices: bool,
    order: int,
    h: float,
    g: float,
    slope: float,
    shear: float,
    plan: Plan,
    state: State,
    series: Series,
    running: Running,
) -> tuple[bool, float]:
    """Whether a step is good and nothing happens in it; the base shear at its end (N)."""
    tables = series.tables
    if order == 0 or not (
        stays_open(plan, state, tables)
        and keeps_parts(h, plan, state, tables)
        and places_unseen(h, plan, state, tables, running)
    ):
        return False, 0.0
    next_shear = _forces(plan, state, series)
    if not matrices and not series_error(order, h, g + slope * h, tables) <= 1.0:
        return False, 0.0
    if not forces_covered(shear, next_shear, plan, tables, running):
        if matrices:
            set_jerks(i, g + slope * h, state.v, tables)
        else:
            set_series_jerks(order, h, slope, series)
        if not forces_go_one_way(h, plan.mass, tables):
            return False, 0.0
    return True, next_shear


@compiled
def _next_is_now(tables: SampleTables) -> None:
    bodies, along = tables.bodies, tables.along
    for b in range(bodies.shape[1]):
        bodies[ACCELERATION, b] = bodies[NEXT_ACCELERATION, b]
    for a in range(along.shape[1]):
        along[X, a], along[X_RATE, a] = along[NEXT_X, a], along[NEXT_X_RATE, a]


@compiled
def _forces(plan: Plan, state: State, series: Series) -> float:
    """Absolute accelerations at the end of the step by the forces there; the base shear (N).

    The hysteretic variables there are left where the series of the next step begin.
    """
    links, law = plan.links, plan.links.law
    bodies, along = series.tables.bodies, series.tables.along
    for b in range(plan.mass.size):
        bodies[NEXT_ACCELERATION, b] = 0.0
    shear = 0.0
    for a in range(links.offset.size):
        x = along[NEXT_X, a]
        k = links.compression[a] if state.branch[a] < 0 else links.extension[a]
        force = k * (x - links.offset[a]) + law.damping[a] * along[NEXT_X_RATE, a]
        h = links.z_of_link[a]
        if h >= 0:
            series.z[h, 0] = hysteretic_variable(h, x, plan.hysteresis, state)
            force += law.strength[a] * series.z[h, 0]
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
    t: float,
    h: float,
    matrices: bool,
    shear: float,
    plan: Plan,
    state: State,
    tables: SampleTables,
    running: Running,
) -> None:
    """Make the end of the step, at t (s), the present state, and take it into the extremes."""
    bodies, contacts, springs = tables.bodies, plan.contacts, plan.links.springs
    n, k = state.u.size, contacts.gap.size
    _next_is_now(tables)
    clock, count = state.clock, state.count
    clock[T], clock[GUESS] = t, h
    clock[SINCE_IMPACT] += h
    count[STEPS] += 1
    count[STALLED] = 0
    if not matrices:
        count[EXPANSIONS] += 1
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
