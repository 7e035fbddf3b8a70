"""How the next step under a record is taken: by matrices, by a series, or until something happens.

The first way in which the step is good is taken. It is good only if bounds
(`eventpound.solvers.fast.sample_bounds`) exclude every event but one that ends it, and every
extreme inside that is not found.
"""

from __future__ import annotations

from typing import NamedTuple

from eventpound.solvers.events.cascade import T
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.exact_step import (
    ACCELERATION,
    NEXT_ACCELERATION,
    NEXT_U,
    NEXT_V,
    NEXT_X,
    PULLED,
    X,
    propose_by_matrices,
    set_jerks,
)
from eventpound.solvers.fast.extreme_bounds import (
    forces_covered,
    forces_go_one_way,
    places_unseen,
)
from eventpound.solvers.fast.extremes import inside_step
from eventpound.solvers.fast.force_extremes import forces_inside_step
from eventpound.solvers.fast.history import has_room
from eventpound.solvers.fast.run import EXPANSIONS, Run
from eventpound.solvers.fast.sample_bounds import NOTHING, keeps_parts, stays_open
from eventpound.solvers.fast.sample_events import first_simple_event
from eventpound.solvers.fast.sample_forces import accelerations
from eventpound.solvers.fast.sample_line import Line
from eventpound.solvers.fast.sample_series import (
    end_of_series,
    propose_by_series,
    series_error,
    set_series_jerks,
)
from eventpound.solvers.fast.search import set_travel

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
def clear_step(linear: bool, i: int, line: Line, run: Run) -> Step:
    """The first way in which a step is good, or `NO_WAY`."""
    none = Step(NO_WAY, i, 0, 0.0, NOTHING, -1)
    step, way = none, MATRICES if linear else SERIES
    while True:
        if way == UNTIL_EVENT:
            step = _until_event(step, run)
            if step.what == NOTHING:
                return none
        else:
            step = _propose(way, i, line, run)
        if _is_clear(step, line, run):
            return step
        if way == UNTIL_EVENT or not has_room(run):
            return none
        way += 1


@compiled
def _propose(way: int, i: int, line: Line, run: Run) -> Step:
    """A step by table i along the line: its order, 0 for none, and length."""
    plan, state, series = run.plan, run.state, run.series
    tables, n, longest = series.tables, state.u.size, line.end - state.clock[T]
    for b in range(n):
        tables.bodies[PULLED, b] = tables.bodies[ACCELERATION, b] - line.g
    if way == MATRICES:
        propose_by_matrices(n, i, line.slope, state.u, state.v, tables)
        return Step(way, i, plan.limits.order, tables.step[i], NOTHING, -1)
    state.count[EXPANSIONS] += 1
    if n == 2:
        # The compiler unrolls the loops over two bodies.
        order, h = propose_by_series(2, i, longest, line.slope, run)
    else:
        order, h = propose_by_series(n, i, longest, line.slope, run)
    return Step(way, i, order, h, NOTHING, -1)


@compiled
def _until_event(step: Step, run: Run) -> Step:
    """End a step by series where something happens."""
    state, series = run.state, run.series
    what, which, tau = NOTHING, -1, step.h
    if step.order > 0:
        what, which, tau = first_simple_event(step.order, step.h, run)
    if what != NOTHING:
        end_of_series(step.order, tau, state, series)
    return Step(UNTIL_EVENT, step.table, step.order, tau, what, which)


@compiled
def _is_clear(step: Step, line: Line, run: Run) -> bool:
    """Whether a step is good and nothing else happens in it.

    Extremes inside a step by series are taken; one by matrices may have none.
    """
    plan, state, series, running = run.plan, run.state, run.series, run.running
    tables, h, what, which = series.tables, step.h, step.what, step.which
    if step.order == 0 or not (
        stays_open(h, what, which, plan, state, tables)
        and keeps_parts(h, what, which, plan, state, tables)
    ):
        return False
    unseen = places_unseen(h, tables, run)
    if step.way == MATRICES and not unseen:
        return False
    bodies, n = tables.bodies, state.u.size
    accelerations(
        n,
        step.table,
        tables.along[NEXT_X],
        bodies[NEXT_U],
        bodies[NEXT_V],
        bodies[NEXT_ACCELERATION],
        run,
    )
    if step.way != MATRICES and not (
        series_error(step.order, h, line.g + line.slope * h, series) <= 1.0
    ):
        return False
    if unseen and not forces_covered(plan, tables, running):
        if step.way == MATRICES:
            set_jerks(step.table, line.g + line.slope * h, state.v, tables)
        else:
            set_series_jerks(step.order, h, line.slope, series)
        unseen = forces_go_one_way(h, plan.mass, tables)
    if not unseen and step.way != MATRICES:
        _extremes_inside(step, line, run)
        unseen = True
    return unseen


@compiled
def _extremes_inside(step: Step, line: Line, run: Run) -> None:
    """Take the extremes inside a step by series."""
    state, series = run.state, run.series
    order, h = step.order, step.h
    for a in range(series.x.size):
        series.x[a] = series.tables.along[X, a]
    for k in range(order):
        series.ground[k] = 0.0
    series.ground[0], series.ground[1] = line.g, line.slope
    set_travel(order, h, state.u.size, series)
    inside_step(h, order, run)
    forces_inside_step(h, order, run)
