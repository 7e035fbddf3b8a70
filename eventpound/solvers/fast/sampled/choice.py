"""How the next step under a record is taken: by a series, or until something happens.

The first way in which the step is good is taken. It is good only if bounds
(`eventpound.solvers.fast.sampled.bounds`) exclude every event but one that ends it. Extremes inside
that they do not exclude are located.

Of steps that something ends only what is simple is done here: where the series shows that one link
leaves its branch or its part, or one gap is below zero, the step ends at the root of that quantity,
and must then be clear of everything else. The root is the only one if the pair of bodies goes one
way until then: for a kink, a border or a closing by the bound of `pair_goes_one_way`, for a
reversal because the acceleration keeps its sign. All else (two events at a time, grazes, gaps that
are variables of their own) is left to `eventpound.solvers.fast.step`.
"""

from __future__ import annotations

from typing import NamedTuple

from eventpound.contact.cascade import is_fleeting
from eventpound.numerics.polynomial import only_root
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.evaluate import observe_at
from eventpound.solvers.fast.expansion import defect_error
from eventpound.solvers.fast.extremes import forces_inside_step, inside_step
from eventpound.solvers.fast.links import (
    CORE,
    DOWN,
    UP,
    cross_border,
    elongations,
    gap_of,
    reverse,
    xi_at,
)
from eventpound.solvers.fast.record import has_room, write_row
from eventpound.solvers.fast.run import FastRun
from eventpound.solvers.fast.sampled.bounds import (
    BORDER,
    CLOSING,
    KINK,
    NOTHING,
    REVERSAL,
    forces_covered,
    keeps_parts,
    places_unseen,
    stays_open,
)
from eventpound.solvers.fast.sampled.forces import GroundLine, accelerations
from eventpound.solvers.fast.sampled.series import (
    end_of_series,
    propose_by_series,
)
from eventpound.solvers.fast.search import set_distance, set_travel
from eventpound.tolerances import EVENTS_APART, OWN_GAP, SOONEST_EVENT


@compiled
def first_simple_event(order: int, h: float, run: FastRun) -> tuple[int, int, float]:
    """What happens first within a series of length h (s), to which link or contact, and when.

    NOTHING where none is beyond an event at the end, or the first is not a simple one.
    """
    plan, state, bodies = run.plan, run.state, run.series.tables.bodies
    what, which, first, second = NOTHING, -1, 2.0 * h, 2.0 * h
    for a in range(plan.links.offset.size):
        kind = _left(a, run)
        if kind == NOTHING:
            continue
        tau = _when(a, kind, order, h, run)
        if tau < first:
            what, which, first, second = kind, a, tau, first
        else:
            second = min(second, tau)
    for j in range(plan.contacts.gap.size):
        if not gap_of(j, plan.contacts, bodies.next_u, bodies.next_v)[0] < 0.0:
            continue
        tau = _when_closed(j, order, h, run)
        if tau < first:
            what, which, first, second = CLOSING, j, tau, first
        else:
            second = min(second, tau)
    fleeting = is_fleeting(first, state.now[0], plan.limits.time)
    if first < SOONEST_EVENT * h or second < first + EVENTS_APART * h or fleeting:
        return NOTHING, -1, h
    return what, which, first


@compiled
def _when_closed(j: int, order: int, h: float, run: FastRun) -> float:
    """Local time at which a contact closes (s); 0 for one that has all but closed by now."""
    plan, state, series = run.plan, run.state, run.series
    if state.gap[j] < OWN_GAP * plan.limits.length:
        return 0.0
    left, right = plan.contacts.left[j], plan.contacts.right[j]
    set_distance(state.gap[j], 1.0, left, right, order, series)
    return only_root(series.c, order + 1, h)


@compiled
def _left(a: int, run: FastRun) -> int:
    """What a link has left at the end of the step proposed."""
    plan, state, series = run.plan, run.state, run.series
    along, hysteresis = series.tables.along, plan.hysteresis
    x = along.next_x[a]
    if state.branch[a] != 0 and state.branch[a] * (x - plan.links.offset[a]) < 0.0:
        return KINK
    i = plan.links.z_of_link[a]
    if i < 0:
        return NOTHING
    part = state.part[i]
    if part != CORE and state.sigma[i] * along.next_x_rate[a] < 0.0:
        return REVERSAL
    if part >= UP:
        return NOTHING
    xi, core = xi_at(i, x, hysteresis, state), hysteresis.core[i]
    if xi > (hysteresis.down[i] if part == DOWN else core) or (part == CORE and xi < -core):
        return BORDER
    return NOTHING


@compiled
def _when(a: int, kind: int, order: int, h: float, run: FastRun) -> float:
    """Local time at which a link leaves its branch, its part or its direction (s)."""
    plan, state, series = run.plan, run.state, run.series
    c, along, hysteresis = series.c, series.tables.along, plan.hysteresis
    head, tail, i, x = series.ends[a, 0], series.ends[a, 1], plan.links.z_of_link[a], along.x[a]
    if kind == REVERSAL:
        set_distance(0.0, state.sigma[i], head, tail, order, series)
        for k in range(order):
            c[k] = (k + 1) * c[k + 1]
        c[0] = state.sigma[i] * along.x_rate[a]
        return only_root(c, order, h)
    if kind == KINK:
        factor = float(state.branch[a])
        start = factor * (x - plan.links.offset[a])
    else:
        xi, factor = xi_at(i, x, hysteresis, state), -state.sigma[i] / hysteresis.scale[i]
        start = (hysteresis.down[i] if state.part[i] == DOWN else hysteresis.core[i]) - xi
        if state.part[i] == CORE and xi_at(i, along.next_x[a], hysteresis, state) < 0.0:
            start, factor = hysteresis.core[i] + xi, -factor
    set_distance(start, factor, head, tail, order, series)
    return only_root(c, order + 1, h)


@compiled
def do_event(what: int, which: int, g: float, run: FastRun) -> None:
    """Do what happened to a link at the end of a step, which is the present; close a contact.

    `g` is the acceleration of the ground (m/s²). A kink demands nothing of contacts, none of
    which rests or closes, and nothing jumps there: both rows of the history are the same.
    What a closed contact demands is due next.
    """
    plan, state, series = run.plan, run.state, run.series
    if what in (REVERSAL, BORDER):
        h, x = plan.links.z_of_link[which], series.tables.along.x[which]
        if what == REVERSAL:
            reverse(h, x, plan.hysteresis, state)
        else:
            cross_border(h, x, plan.hysteresis, state)
        return
    observe_at(0.0, plan.limits.order, g, run)
    write_row(state.now[0].t, run)
    if what == KINK:
        write_row(state.now[0].t, run)
        state.branch[which] = -state.branch[which]
    else:
        state.progress[0].due = 1


class ProposedStep(NamedTuple):
    """A step proposed.

    table: of which tangents. order: of its series, 0 for no step. h: its length (s). what, which:
    what happens at its end, to which link or contact.
    """

    table: int
    order: int
    h: float
    what: int
    which: int


@compiled
def clear_step(i: int, line: GroundLine, run: FastRun) -> ProposedStep:
    """A step by series towards the next sample, or until something happens, if it is good."""
    step = _propose(i, line, run)
    if _is_clear(step, line, run):
        return step
    step = _until_event(step, run)
    if step.what == NOTHING or not (has_room(run) and _is_clear(step, line, run)):
        return ProposedStep(i, 0, 0.0, NOTHING, -1)
    return step


@compiled
def _propose(i: int, line: GroundLine, run: FastRun) -> ProposedStep:
    """A step by table i along the line."""
    state, bodies = run.state, run.series.tables.bodies
    n, longest = state.u.size, line.end - state.now[0].t
    for b in range(n):
        bodies.pulled[b] = bodies.acceleration[b] - line.g
    state.progress[0].expansions += 1
    if n == 2:
        # The compiler unrolls the loops over two bodies.
        order, h = propose_by_series(2, i, longest, line.slope, run)
    else:
        order, h = propose_by_series(n, i, longest, line.slope, run)
    return ProposedStep(i, order, h, NOTHING, -1)


@compiled
def _until_event(step: ProposedStep, run: FastRun) -> ProposedStep:
    """End a step where something happens."""
    state, series = run.state, run.series
    what, which, tau = NOTHING, -1, step.h
    if step.order > 0:
        what, which, tau = first_simple_event(step.order, step.h, run)
    if what != NOTHING:
        end_of_series(step.order, tau, state, series)
    return ProposedStep(step.table, step.order, tau, what, which)


@compiled
def _is_clear(step: ProposedStep, line: GroundLine, run: FastRun) -> bool:
    """Whether a step is good and nothing else happens in it; extremes inside it are taken then."""
    plan, state, series, running = run.plan, run.state, run.series, run.running
    tables, order, h, what, which = series.tables, step.order, step.h, step.what, step.which
    bodies, n = tables.bodies, state.u.size
    if order == 0:
        return False
    # What happens first within a step that is not clear is told by this, too.
    along = tables.along
    elongations(plan.links.ends, bodies.next_u, bodies.next_v, along.next_x, along.next_x_rate)
    if not (
        stays_open(h, what, which, plan, state, tables)
        and keeps_parts(h, what, which, plan, state, tables)
    ):
        return False
    u, v, a = bodies.next_u, bodies.next_v, bodies.next_acceleration
    accelerations(n, step.table, tables.along.next_x, u, v, a, run)
    if not defect_error(h, order, line.g + line.slope * h, a, series) <= 1.0:
        return False
    unseen, covered = places_unseen(h, tables, run), forces_covered(n, plan.mass, tables, running)
    if not (unseen and covered):
        series.ground[:order] = 0.0
        series.ground[0], series.ground[1] = line.g, line.slope
        set_travel(order, h, n, series)
    if not unseen:
        inside_step(h, order, run)
    if not covered:
        forces_inside_step(h, order, a, run)
    return True
