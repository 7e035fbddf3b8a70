"""Several bodies under a record, and after it, step by step as long as little happens.

From sample to sample the bodies go by exact steps (`eventpound.solvers.fast.sample_tables`)
where all their links are linear, by short series (`eventpound.solvers.fast.sample_series`)
where one is on a curved part, and from between two samples to the next. A step is
taken only where bounds (`eventpound.solvers.fast.sample_bounds`) exclude every event, and every
extreme that is not one of its ends; any other is left to `eventpound.solvers.fast.step`.
"""

from __future__ import annotations

import math

import numpy as np

from eventpound.motion.base import Family
from eventpound.motion.forcing import next_sample, sample_time
from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.inspection import Running, update_extreme
from eventpound.solvers.fast.backbone_parts import UNLOADING, saturate, set_variables
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.elongation import elongations
from eventpound.solvers.fast.extremes import inside_step
from eventpound.solvers.fast.force_extremes import forces_inside_step
from eventpound.solvers.fast.history import has_room, sample_step
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
    NOTHING,
    forces_covered,
    forces_go_one_way,
    keeps_parts,
    places_unseen,
    stays_open,
)
from eventpound.solvers.fast.sample_events import do_event, first_of_links
from eventpound.solvers.fast.sample_series import (
    end_of_series,
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
from eventpound.solvers.fast.search import set_travel
from eventpound.solvers.fast.seen import Seen

_ZERO, _SAMPLES = int(Family.ZERO), int(Family.SAMPLES)
LONGER = 2.0
"""Length that a step is tried with, where the ground stands still, in parts of the last one."""
MATRICES, SERIES, UNTIL_EVENT = 0, 1, 2
"""Ways of a step, tried one after the other: by matrices to the next sample, by series as far
towards it as they reach, by the same series until something happens to a link."""


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
    clock, count, tables = state.clock, state.count, series.tables
    dt = coefficients[1] if family == _SAMPLES else plan.limits.time
    shear, i = _start(dt, plan, state, series)
    until, last = piece_end - 1e-9 * dt, count[STEPS] + budget
    way, order, h, what, link, whole = MATRICES, 0, dt, NOTHING, -1, True
    segment = _first_segment(family, coefficients, clock[T], piece_end)
    while count[STEPS] < last:
        t = clock[T]
        following, since, g, slope = _line(segment, family, coefficients, samples, clock)
        if not (following < until and t + 1e-9 * dt < following):
            break
        if way == MATRICES and (
            saturate(tables.along[X], plan.hysteresis, state)
            or since != 0.0
            or tables.most_turn[i] > MOST_TURN
        ):
            way = SERIES
        if way != UNTIL_EVENT:
            order, h = _propose(way, i, following - t, g, slope, plan, state, series)
            whole = way == MATRICES or h == following - t
        clear, next_shear = _is_clear(
            way, i, order, h, g, slope, shear, what, link, plan, state, series, seen, running
        )
        if not clear:
            if way == SERIES:
                what, link, h = _until_event(order, h, plan, state, series)
                whole = False
            if (what == NOTHING and way != MATRICES) or way == UNTIL_EVENT:
                break
            if not has_room(plan, state, record):
                break
            way += 1
            continue
        t_end = following if whole else t + h
        _write_between(
            way, i, order, slope, t_end, family, coefficients, samples,
            plan, state, series, seen, record,
        )  # fmt: skip
        shear = next_shear
        _accept(t_end, h, shear, plan, state, tables, running)
        segment += 1 if whole else 0
        if what != NOTHING:
            do_event(what, link, g + slope * h, plan, state, series, seen, record)
            shear, i = _start(dt, plan, state, series)
        way, what, link = MATRICES, NOTHING, -1


@compiled
def _until_event(
    order: int, h: float, plan: Plan, state: State, series: Series
) -> tuple[int, int, float]:
    """End a step by series where something happens to a link: what, to which, and when (s)."""
    if order == 0:
        return NOTHING, -1, h
    what, link, tau = first_of_links(order, h, plan, state, series)
    if what != NOTHING:
        end_of_series(order, tau, state, series)
    return what, link, tau


@compiled
def _write_between(
    way: int,
    i: int,
    order: int,
    slope: float,
    t_end: float,
    family: int,
    coefficients: Floats,
    samples: Floats,
    plan: Plan,
    state: State,
    series: Series,
    seen: Seen,
    record: Record,
) -> None:
    """Rows of the history before the end of a step (s)."""
    count, times = state.count, plan.output_times
    if count[OUTPUT] < times.size and times[count[OUTPUT]] < t_end:
        if way == MATRICES:
            _expand(i, slope, order, state, series)
        sample_step(
            state.clock[T], t_end, order, family, coefficients, samples,
            plan, state, series, seen, record,
        )  # fmt: skip


@compiled
def _first_segment(family: int, coefficients: Floats, t: float, piece_end: float) -> int:
    """Number of the sample at which the line of a record begins that t (s) is on."""
    if family != _SAMPLES:
        return 0
    following = next_sample(coefficients, t, piece_end)
    return math.floor((following - coefficients[0]) / coefficients[1] + 0.5) - 1


@compiled
def _line(
    segment: int, family: int, coefficients: Floats, samples: Floats, clock: Floats
) -> tuple[float, float, float, float]:
    """The straight line that the ground acceleration follows.

    Returned are where the next step ends at the latest (s), the time since the line began
    (s), and the acceleration (m/s²) and its slope at present. The last line of a record,
    and whatever is not on a line, has no next step.
    """
    t = clock[T]
    if family == _ZERO:
        return t + LONGER * clock[GUESS], 1.0, 0.0, 0.0
    if family != _SAMPLES or segment + 2 >= samples.size:
        return np.inf, 0.0, 0.0, 0.0
    origin, dt = coefficients[0], coefficients[1]
    since = t - sample_time(origin, dt, segment)
    slope = (samples[segment + 1] - samples[segment]) / dt
    return sample_time(origin, dt, segment + 1), since, samples[segment] + slope * since, slope


@compiled
def _start(dt: float, plan: Plan, state: State, series: Series) -> tuple[float, int]:
    """Elongations and absolute accelerations where the bodies are.

    Returned are the base shear (N) and the number of the table for the tangents of the links.
    """
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
    i = table_of(dt, series.stiffness, links.ends, links.law.damping, plan.mass, series.tables)
    return shear, i


@compiled
def _propose(
    way: int,
    i: int,
    longest: float,
    g: float,
    slope: float,
    plan: Plan,
    state: State,
    series: Series,
) -> tuple[int, float]:
    """Where a step from g (m/s²) of the record ends: its order, 0 for none, and length (s)."""
    tables = series.tables
    for b in range(state.u.size):
        tables.bodies[PULLED, b] = tables.bodies[ACCELERATION, b] - g
    if way == MATRICES:
        propose_by_matrices(i, slope, state.u, state.v, tables)
        return plan.limits.order, tables.step[i]
    state.count[EXPANSIONS] += 1
    return propose_by_series(i, longest, slope, plan, state, series)


@compiled
def _is_clear(
    way: int,
    i: int,
    order: int,
    h: float,
    g: float,
    slope: float,
    shear: float,
    what: int,
    link: int,
    plan: Plan,
    state: State,
    series: Series,
    seen: Seen,
    running: Running,
) -> tuple[bool, float]:
    """Whether a step is good and nothing else happens in it; the base shear at its end (N).

    Extremes inside a step by series are taken; one by matrices may have none.
    """
    tables = series.tables
    if order == 0 or not (
        stays_open(plan, state, tables) and keeps_parts(h, what, link, plan, state, tables)
    ):
        return False, 0.0
    unseen = places_unseen(h, plan, state, tables, running)
    if way == MATRICES and not unseen:
        return False, 0.0
    next_shear = _forces(plan, state, series)
    if way != MATRICES and not series_error(order, h, g + slope * h, tables) <= 1.0:
        return False, 0.0
    if unseen and not forces_covered(shear, next_shear, plan, tables, running):
        if way == MATRICES:
            set_jerks(i, g + slope * h, state.v, tables)
        else:
            set_series_jerks(order, h, slope, series)
        unseen = forces_go_one_way(h, plan.mass, tables)
    if not unseen and way != MATRICES:
        _extremes_inside(order, h, g, slope, plan, state, series, seen, running)
        unseen = True
    return unseen, next_shear


@compiled
def _extremes_inside(
    order: int,
    h: float,
    g: float,
    slope: float,
    plan: Plan,
    state: State,
    series: Series,
    seen: Seen,
    running: Running,
) -> None:
    """Take the extremes inside a step by series."""
    for a in range(series.x.size):
        series.x[a] = series.tables.along[X, a]
    for k in range(order):
        series.ground[k] = 0.0
    series.ground[0], series.ground[1] = g, slope
    set_travel(order, h, state.u.size, series)
    inside_step(h, order, plan, state, series, running)
    forces_inside_step(h, order, plan, state, series, seen, running)


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
    links, law, z = plan.links, plan.links.law, series.z
    bodies, along = series.tables.bodies, series.tables.along
    set_variables(along[NEXT_X], plan.hysteresis, state, z)
    for b in range(plan.mass.size):
        bodies[NEXT_ACCELERATION, b] = 0.0
    shear = 0.0
    for a in range(links.offset.size):
        k = links.compression[a] if state.branch[a] < 0 else links.extension[a]
        force = k * (along[NEXT_X, a] - links.offset[a]) + law.damping[a] * along[NEXT_X_RATE, a]
        h = links.z_of_link[a]
        if h >= 0:
            force += law.strength[a] * z[h, 0]
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
        bodies[NEXT_ACCELERATION, b] *= series.inverse_mass[b]
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
