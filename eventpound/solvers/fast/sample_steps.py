"""Several bodies under a record, and after it, step by step as long as little happens.

From sample to sample the bodies go by exact steps (`eventpound.solvers.fast.sample_tables`)
where all their links are linear, several in a row where they stay in their room
(`eventpound.solvers.fast.sample_stretch`), and by short series
(`eventpound.solvers.fast.sample_series`) where a link is on a curved part, and from between
two samples to the next. A step is taken only where bounds
(`eventpound.solvers.fast.sample_bounds`) exclude every event but one that ends it, and every
extreme that is not one of its ends; any other is left to `eventpound.solvers.fast.step`.
"""

from __future__ import annotations

from typing import NamedTuple

from eventpound.motion.base import Family
from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.inspection import Running, update_extreme
from eventpound.solvers.fast.backbone_parts import saturate
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.event_rows import end_cascade
from eventpound.solvers.fast.extremes import inside_step
from eventpound.solvers.fast.force_extremes import forces_inside_step
from eventpound.solvers.fast.history import has_room, sample_step
from eventpound.solvers.fast.outcome import CASCADE_OVER
from eventpound.solvers.fast.plan import (
    DUE,
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
    CLOSING,
    NOTHING,
    forces_covered,
    forces_go_one_way,
    keeps_parts,
    places_unseen,
    stays_open,
)
from eventpound.solvers.fast.sample_events import do_event, first_event
from eventpound.solvers.fast.sample_forces import (
    accelerations,
    accelerations_now,
    base_shear,
    begin,
    end_is_now,
)
from eventpound.solvers.fast.sample_line import Line, first_segment, line_at
from eventpound.solvers.fast.sample_series import (
    end_of_series,
    propose_by_series,
    series_error,
    set_series_jerks,
)
from eventpound.solvers.fast.sample_stretch import set_gaps, stretch, write_line
from eventpound.solvers.fast.sample_tables import (
    ACCELERATION,
    MOST_TURN,
    NEXT_ACCELERATION,
    NEXT_U,
    NEXT_V,
    NEXT_X,
    PULLED,
    X,
    propose_by_matrices,
    set_jerks,
)
from eventpound.solvers.fast.search import set_travel
from eventpound.solvers.fast.seen import Seen

_SAMPLES = int(Family.SAMPLES)
MATRICES, SERIES, UNTIL_EVENT, NO_WAY = range(4)
"""Ways of a step, tried one after the other: by matrices to the next sample, by series as far
towards it as they reach, by the same series until something happens."""


class Step(NamedTuple):
    """A step proposed.

    way: above. table: of which tangents. order: of its series, 0 where there is none. h: its
    length (s). what, which: what happens at its end, to which link or contact.
    """

    way: int
    table: int
    order: int
    h: float
    what: int
    which: int


@compiled
def may_go_by_samples(plan: Plan, state: State, series: Series) -> bool:
    """Whether every body moves freely, and there are few enough of them."""
    if state.count[RESTING] > 0 or plan.limits.ledger or series.tables.turn.shape[1] == 0:
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
    """Steps, as far as nothing but what ends a step can happen, and no more than `budget`.

    Rows of the history that fall between samples are written on the way, so that
    the motion does not depend on them. A contact that has closed is due next.
    """
    clock, count = state.clock, state.count
    dt = coefficients[1] if family == _SAMPLES else plan.limits.time
    i, fresh = begin(dt, plan, state, series), True
    until, last = piece_end - 1e-9 * dt, count[STEPS] + budget
    segment = first_segment(family, coefficients, clock[T], piece_end)
    while count[STEPS] < last and count[DUE] == 0:
        line = line_at(segment, family, coefficients, samples, clock)
        if not (line.end < until and clock[T] + 1e-9 * dt < line.end):
            break
        linear = _starts_linear(i, line, plan, state, series)
        if linear and fresh and count[IN_A_ROW] == 0:
            fresh, started = False, segment
            segment = _stretch(
                i, segment, last - count[STEPS], until, coefficients, samples,
                plan, state, series, seen, record, running,
            )  # fmt: skip
            if segment > started:
                continue
        step = _clear_step(linear, i, line, plan, state, series, seen, record, running)
        if step.way == NO_WAY:
            break
        whole = step.way == MATRICES or step.h == line.end - clock[T]
        t_end = line.end if whole else clock[T] + step.h
        _write_between(
            step, line, t_end, family, coefficients, samples, plan, state, series, seen, record
        )
        _accept(step, t_end, plan, state, series, record, running)
        segment += 1 if whole else 0
        if step.what != NOTHING:
            g = line.g + line.slope * step.h
            do_event(step.what, step.which, g, plan, state, series, seen, record)
            i = begin(dt, plan, state, series)
        fresh = True


@compiled
def _starts_linear(i: int, line: Line, plan: Plan, state: State, series: Series) -> bool:
    """Whether a step by matrices may begin; saturates links that are due."""
    tables = series.tables
    curved, changed = saturate(tables.along[X], plan.hysteresis, state)
    if changed:
        accelerations_now(i, plan, state, series)
    return not curved and line.since == 0.0 and tables.most_turn[i] <= MOST_TURN


@compiled
def _stretch(
    i: int,
    segment: int,
    budget: int,
    until: float,
    coefficients: Floats,
    samples: Floats,
    plan: Plan,
    state: State,
    series: Series,
    seen: Seen,
    record: Record,
    running: Running,
) -> int:
    """As `stretch`, whose loops over bodies the compiler unrolls where there are two."""
    if state.u.size == 2:
        return stretch(
            2, i, segment, budget, until, coefficients, samples,
            plan, state, series, seen, record, running,
        )  # fmt: skip
    return stretch(
        state.u.size, i, segment, budget, until, coefficients, samples,
        plan, state, series, seen, record, running,
    )  # fmt: skip


@compiled
def _clear_step(
    linear: bool,
    i: int,
    line: Line,
    plan: Plan,
    state: State,
    series: Series,
    seen: Seen,
    record: Record,
    running: Running,
) -> Step:
    """The first way in which a step is good, or `NO_WAY`."""
    none = Step(NO_WAY, i, 0, 0.0, NOTHING, -1)
    step, way = none, MATRICES if linear else SERIES
    while True:
        if way == UNTIL_EVENT:
            step = _until_event(step, plan, state, series)
            if step.what == NOTHING:
                return none
        else:
            step = _propose(way, i, line, plan, state, series)
        if _is_clear(step, line, plan, state, series, seen, running):
            return step
        if way == UNTIL_EVENT or not has_room(plan, state, record):
            return none
        way += 1


@compiled
def _propose(way: int, i: int, line: Line, plan: Plan, state: State, series: Series) -> Step:
    """A step by table i along the line: its order, 0 for none, and length."""
    tables, n, longest = series.tables, state.u.size, line.end - state.clock[T]
    for b in range(n):
        tables.bodies[PULLED, b] = tables.bodies[ACCELERATION, b] - line.g
    if way == MATRICES:
        propose_by_matrices(n, i, line.slope, state.u, state.v, tables)
        return Step(way, i, plan.limits.order, tables.step[i], NOTHING, -1)
    state.count[EXPANSIONS] += 1
    if n == 2:
        order, h = propose_by_series(2, i, longest, line.slope, plan, state, series)
    else:
        order, h = propose_by_series(n, i, longest, line.slope, plan, state, series)
    return Step(way, i, order, h, NOTHING, -1)


@compiled
def _until_event(step: Step, plan: Plan, state: State, series: Series) -> Step:
    """End a step by series where something happens."""
    what, which, tau = NOTHING, -1, step.h
    if step.order > 0:
        what, which, tau = first_event(step.order, step.h, plan, state, series)
    if what != NOTHING:
        end_of_series(state.u.size, step.order, tau, state, series)
    return Step(UNTIL_EVENT, step.table, step.order, tau, what, which)


@compiled
def _is_clear(
    step: Step,
    line: Line,
    plan: Plan,
    state: State,
    series: Series,
    seen: Seen,
    running: Running,
) -> bool:
    """Whether a step is good and nothing else happens in it.

    Extremes inside a step by series are taken; one by matrices may have none.
    """
    tables, h, what, which = series.tables, step.h, step.what, step.which
    if step.order == 0 or not (
        stays_open(h, what, which, plan, state, tables)
        and keeps_parts(h, what, which, plan, state, tables)
    ):
        return False
    unseen = places_unseen(h, plan, state, tables, running)
    if step.way == MATRICES and not unseen:
        return False
    _accelerations_at_end(step.table, plan, state, series)
    if step.way != MATRICES and not (
        series_error(step.order, h, line.g + line.slope * h, tables) <= 1.0
    ):
        return False
    if unseen and not forces_covered(plan, tables, running):
        if step.way == MATRICES:
            set_jerks(step.table, line.g + line.slope * h, state.v, tables)
        else:
            set_series_jerks(step.order, h, line.slope, series)
        unseen = forces_go_one_way(h, plan.mass, tables)
    if not unseen and step.way != MATRICES:
        _extremes_inside(step, line, plan, state, series, seen, running)
        unseen = True
    return unseen


@compiled
def _accelerations_at_end(i: int, plan: Plan, state: State, series: Series) -> None:
    """Absolute accelerations at the end of the step proposed (m/s²)."""
    bodies, x = series.tables.bodies, series.tables.along[NEXT_X]
    u, v, a = bodies[NEXT_U], bodies[NEXT_V], bodies[NEXT_ACCELERATION]
    if state.u.size == 2:
        accelerations(2, i, x, u, v, plan, state, series, a)
    else:
        accelerations(state.u.size, i, x, u, v, plan, state, series, a)


@compiled
def _extremes_inside(
    step: Step,
    line: Line,
    plan: Plan,
    state: State,
    series: Series,
    seen: Seen,
    running: Running,
) -> None:
    """Take the extremes inside a step by series."""
    order, h = step.order, step.h
    for a in range(series.x.size):
        series.x[a] = series.tables.along[X, a]
    for k in range(order):
        series.ground[k] = 0.0
    series.ground[0], series.ground[1] = line.g, line.slope
    set_travel(order, h, state.u.size, series)
    inside_step(h, order, plan, state, series, running)
    forces_inside_step(h, order, plan, state, series, seen, running)


@compiled
def _write_between(
    step: Step,
    line: Line,
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
    if not (count[OUTPUT] < times.size and times[count[OUTPUT]] < t_end):
        return
    if step.way == MATRICES:
        write_line(
            step.table, line.slope, t_end, family, coefficients, samples,
            plan, state, series, seen, record,
        )  # fmt: skip
    else:
        sample_step(
            state.clock[T], t_end, step.order, family, coefficients, samples,
            plan, state, series, seen, record,
        )  # fmt: skip


@compiled
def _accept(
    step: Step,
    t: float,
    plan: Plan,
    state: State,
    series: Series,
    record: Record,
    running: Running,
) -> None:
    """Make the end of the step, at t (s), the present state, and take it into the extremes."""
    bodies, clock, count = series.tables.bodies, state.clock, state.count
    end_is_now(series.tables)
    clock[T], clock[GUESS] = t, step.h
    clock[SINCE_IMPACT] += step.h
    count[STEPS] += 1
    count[STALLED] = 0
    for b in range(state.u.size):
        state.u[b], state.v[b] = bodies[NEXT_U, b], bodies[NEXT_V, b]
    set_gaps(plan, state)
    if step.what == CLOSING:
        state.gap[step.which] = 0.0
    elif (
        step.what == NOTHING
        and count[IN_A_ROW] > 0
        and clock[SINCE_IMPACT] > CASCADE_OVER * plan.limits.time
    ):
        end_cascade(state, record.events)
        count[IN_A_ROW] = 0
    _take_extremes(t, plan, state, series, running)


@compiled
def _take_extremes(t: float, plan: Plan, state: State, series: Series, running: Running) -> None:
    """Take the present state, at t (s), into the extremes."""
    tables, springs = series.tables, plan.links.springs
    n, contacts = state.u.size, plan.contacts.gap.size
    for b in range(n):
        update_extreme(b, state.u[b], t, running)
        update_extreme(n + springs + contacts + b, tables.bodies[ACCELERATION, b], t, running)
    for a in range(springs):
        update_extreme(n + a, tables.along[X, a], t, running)
    for j in range(contacts):
        update_extreme(n + springs + j, state.gap[j], t, running)
    shear = base_shear(n, ACCELERATION, plan.mass, tables)
    update_extreme(2 * n + springs + contacts, shear, t, running)
