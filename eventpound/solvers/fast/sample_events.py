"""A step under a record that ends where a link changes its law, or a contact closes.

Only what is simple is done here: where a series proposed for a longer step shows that one
link leaves its branch or its part, or one gap is below zero, the step ends at the root of that
quantity, and must then be clear of everything else by the bounds of
`eventpound.solvers.fast.sample_bounds`. The root is the only one if the pair of bodies goes one
way until then: for a kink, a border or a closing by the bound of `pair_goes_one_way`, for a
reversal because the acceleration keeps its sign. All else (two events at a time, grazes, gaps
that are variables of their own) is left to `eventpound.solvers.fast.step`.
"""

from __future__ import annotations

from eventpound.solvers.events.cascade import INTERVAL, SINCE_IMPACT, T
from eventpound.solvers.fast.backbone_parts import CORE, DOWN, UP, cross_border, place, reverse
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.evaluate import OWN_GAP, look
from eventpound.solvers.fast.exact_step import (
    NEXT_U,
    NEXT_X,
    NEXT_X_RATE,
    X_RATE,
    SampleTables,
    X,
)
from eventpound.solvers.fast.history import put_row
from eventpound.solvers.fast.run import DUE, Contacts, Run
from eventpound.solvers.fast.sample_bounds import BORDER, CLOSING, KINK, NOTHING, REVERSAL
from eventpound.solvers.fast.search import falling_root, relative
from eventpound.solvers.fast.transient_mode import is_fleeting

SOONEST = 1e-6
"""Part of the step proposed before which an event is left to the general step."""
APART = 1e-9
"""Part of the step proposed by which a second event must come later."""


@compiled
def first_simple_event(order: int, h: float, run: Run) -> tuple[int, int, float]:
    """What happens first within a series of length h (s), to which link or contact, and when.

    NOTHING where none is beyond an event at the end, or the first is not a simple one.
    """
    plan, state, series = run.plan, run.state, run.series
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
        if not _overlaps(j, plan.contacts, series.tables):
            continue
        tau = _when_closed(j, order, h, run)
        if tau < first:
            what, which, first, second = CLOSING, j, tau, first
        else:
            second = min(second, tau)
    if first < SOONEST * h or second < first + APART * h or is_fleeting(first, plan, state):
        return NOTHING, -1, h
    return what, which, first


@compiled
def _overlaps(j: int, contacts: Contacts, tables: SampleTables) -> bool:
    """Whether a gap is below zero at the end of the step proposed."""
    left, right, gap = contacts.left[j], contacts.right[j], contacts.gap[j]
    if right >= 0:
        gap += tables.bodies[NEXT_U, right]
    if left >= 0:
        gap -= tables.bodies[NEXT_U, left]
    return bool(gap < 0.0)


@compiled
def _when_closed(j: int, order: int, h: float, run: Run) -> float:
    """Local time at which a contact closes (s); 0 for one that has all but closed by now."""
    plan, state, series = run.plan, run.state, run.series
    if state.gap[j] < OWN_GAP * plan.limits.length:
        return 0.0
    relative(plan.contacts.left[j], plan.contacts.right[j], order, series, series.c)
    series.c[0] = state.gap[j]
    return falling_root(series.c, order + 1, h)


@compiled
def _left(a: int, run: Run) -> int:
    """What a link has left at the end of the step proposed."""
    plan, state, series = run.plan, run.state, run.series
    along, hysteresis = series.tables.along, plan.hysteresis
    x = along[NEXT_X, a]
    if state.branch[a] != 0 and state.branch[a] * (x - plan.links.offset[a]) < 0.0:
        return KINK
    i = plan.links.z_of_link[a]
    if i < 0:
        return NOTHING
    part = state.part[i]
    if part != CORE and state.sigma[i] * along[NEXT_X_RATE, a] < 0.0:
        return REVERSAL
    if part >= UP:
        return NOTHING
    xi, core = place(i, x, hysteresis, state), hysteresis.core[i]
    if xi > (hysteresis.down[i] if part == DOWN else core) or (part == CORE and xi < -core):
        return BORDER
    return NOTHING


@compiled
def _when(a: int, kind: int, order: int, h: float, run: Run) -> float:
    """Local time at which a link leaves its branch, its part or its direction (s)."""
    plan, state, series = run.plan, run.state, run.series
    c, along, hysteresis = series.c, series.tables.along, plan.hysteresis
    relative(series.ends[a, 0], series.ends[a, 1], order, series, c)
    i, scale, x = plan.links.z_of_link[a], 1.0, along[X, a]
    if kind == REVERSAL:
        c[0] = state.sigma[i] * along[X_RATE, a]
        for k in range(1, order):
            c[k] = state.sigma[i] * (k + 1) * c[k + 1]
        return falling_root(c, order, h)
    if kind == KINK:
        scale = float(state.branch[a])
        c[0] = scale * (x - plan.links.offset[a])
    else:
        xi = place(i, x, hysteresis, state)
        scale = -state.sigma[i] / hysteresis.scale[i]
        c[0] = (hysteresis.down[i] if state.part[i] == DOWN else hysteresis.core[i]) - xi
        if state.part[i] == CORE and place(i, along[NEXT_X, a], hysteresis, state) < 0.0:
            scale = -scale
            c[0] = hysteresis.core[i] + xi
    for k in range(1, order + 1):
        c[k] *= scale
    return falling_root(c, order + 1, h)


@compiled
def do_event(what: int, which: int, g: float, run: Run) -> None:
    """Do what happened to a link at the end of a step, which is the present; close a contact.

    `g` is the acceleration of the ground (m/s²). A kink demands nothing of contacts, none of
    which rests or closes, and nothing jumps there: both rows of the history are the same.
    What a closed contact demands is due next.
    """
    plan, state, series = run.plan, run.state, run.series
    if what in (REVERSAL, BORDER):
        h, x = plan.links.z_of_link[which], series.tables.along[X, which]
        if what == REVERSAL:
            reverse(h, x, plan.hysteresis, state)
        else:
            cross_border(h, x, plan.hysteresis, state)
        return
    clock = state.clock
    look(0.0, plan.limits.order, g, run)
    put_row(clock[T], run)
    if clock[SINCE_IMPACT] > 0.0:
        clock[INTERVAL] = clock[SINCE_IMPACT]
    if what == KINK:
        put_row(clock[T], run)
        state.branch[which] = -state.branch[which]
    else:
        state.count[DUE] = 1
