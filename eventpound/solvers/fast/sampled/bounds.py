"""Whether anything happens to bodies within a step of a record (`sample_steps`).

With the largest acceleration A in a step of length h,

* a quantity strays from the straight line between its values at both ends by no more
  than ``A h²/8``, which bounds gaps, distances to kinks and borders of the backbone;
* one whose rates at both ends have one sign goes one way, so it has no extreme but at
  the ends, if the rates are together larger than ``A h``, or if its acceleration a at the
  start is larger than it can change in the step: then the rate itself goes one way;
* the same holds where the rate starts from zero, to rounding, and a drives it on, and where
  it ends there.

A step has no extreme inside that is larger than those so far where the quantity stays within its
extremes or goes one way.
"""

from __future__ import annotations

from eventpound.contact.kinks import still_rate
from eventpound.mechanics.backbone import Hysteresis
from eventpound.mechanics.monitored import Running
from eventpound.numerics.arrays import Floats
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.extremes import leader_of, start_of, stays_within
from eventpound.solvers.fast.links import CORE, DOWN, UP, elongation, gap_of, xi_at
from eventpound.solvers.fast.run import FastPlan, FastRun, FastState
from eventpound.solvers.fast.sampled.exact import SampleTables
from eventpound.solvers.fast.search import bound_of_pair
from eventpound.tolerances import LENGTH, OWN_GAP

NOTHING, KINK, BORDER, REVERSAL, CLOSING = range(5)
"""What happens at the end of a step: the first three to a link, the last to a contact."""


@compiled
def pair_goes_one_way(
    h: float,
    first: int,
    second: int,
    rate: float,
    next_rate: float,
    plan: FastPlan,
    tables: SampleTables,
) -> bool:
    """Whether the distance of two bodies, the ground among them, only grows or only shrinks."""
    fastest = bound_of_pair(first, second, tables.bodies.fastest)
    if rate * next_rate > 0.0 and abs(rate) + abs(next_rate) > h * fastest:
        return True
    a, spread = 0.0, fastest
    if first >= 0:
        a, spread = -tables.bodies.pulled[first], spread - abs(tables.bodies.pulled[first])
    if second >= 0:
        a, spread = a + tables.bodies.pulled[second], spread - abs(tables.bodies.pulled[second])
    if not abs(a) > spread:
        return False
    still = still_rate(plan.limits.length, plan.limits.time)
    if abs(rate) <= still:
        return a * next_rate > 0.0
    if abs(next_rate) <= still:
        return a * rate < 0.0
    return rate * next_rate > 0.0


@compiled
def stays_open(
    h: float, what: int, which: int, plan: FastPlan, state: FastState, tables: SampleTables
) -> bool:
    """Whether every gap stays one that is a difference of displacements.

    But for the contact `which` if `what` is CLOSING, and for one that has just hit: those may
    go one way from such a gap to none, and from none to such a gap.
    """
    contacts, bodies = plan.contacts, tables.bodies
    least = OWN_GAP * plan.limits.length
    for j in range(contacts.gap.size):
        left, right = contacts.left[j], contacts.right[j]
        now, rate = gap_of(j, contacts, state.u, state.v)
        then, next_rate = gap_of(j, contacts, bodies.next_u, bodies.next_v)
        if min(now, then) - bound_of_pair(left, right, tables.bodies.sag) >= least:
            continue
        still = still_rate(plan.limits.length, plan.limits.time)
        closes = what == CLOSING and j == which and now >= least and next_rate < -still
        opens = state.gap[j] == 0.0 and state.gap_rate[j] > still and then >= least and rate > 0.0
        if not (closes or opens):
            return False
        if not pair_goes_one_way(h, left, right, rate, next_rate, plan, tables):
            return False
    return True


@compiled
def keeps_parts(
    h: float, what: int, which: int, plan: FastPlan, state: FastState, tables: SampleTables
) -> bool:
    """Whether every link keeps its branch and its part; elongations at the end stand.

    `what` happens to the link `which` at the end of the step, nothing to the others.
    """
    links, along = plan.links, tables.along
    for a in range(links.offset.size):
        i = links.z_of_link[a]
        if i < 0 and state.branch[a] == 0:
            continue
        first, second = links.ends[a, 0], links.ends[a, 1]
        sag, rate, rate_1 = (
            bound_of_pair(first, second, tables.bodies.sag),
            along.x_rate[a],
            along.next_x_rate[a],
        )
        one_way = pair_goes_one_way(h, first, second, rate, rate_1, plan, tables)
        happens = what if a == which and what != CLOSING else NOTHING
        if happens != NOTHING and not one_way:
            return False
        if (
            state.branch[a] != 0
            and happens != KINK
            and not _keeps_branch(a, sag, one_way, plan, state, tables)
        ):
            return False
        if i >= 0 and not _keeps_part(i, happens, sag, one_way, plan.hysteresis, state, tables):
            return False
    return True


@compiled
def _keeps_part(
    i: int,
    happens: int,
    sag: float,
    one_way: bool,
    hysteresis: Hysteresis,
    state: FastState,
    tables: SampleTables,
) -> bool:
    """Whether a hysteretic link stays between the borders of its part and does not turn."""
    a, along, part = hysteresis.link[i], tables.along, state.part[i]
    # A reversal leaves or leads to a rate of zero, to rounding.
    rate = along.x_rate[a] if happens == REVERSAL else along.next_x_rate[a]
    if part != CORE and not (one_way and state.sigma[i] * rate > 0.0):
        return False
    if part >= UP or happens == BORDER:
        return True
    high = low = xi_at(i, along.next_x[a], hysteresis, state)
    if not one_way:
        at, beyond = xi_at(i, along.x[a], hysteresis, state), sag / hysteresis.scale[i]
        high, low = max(at, high) + beyond, min(at, low) - beyond
    core = hysteresis.core[i]
    upper = hysteresis.down[i] if part == DOWN else core
    return high <= upper and (part != CORE or low >= -core)


@compiled
def _keeps_branch(
    a: int, sag: float, one_way: bool, plan: FastPlan, state: FastState, tables: SampleTables
) -> bool:
    """Whether a link stays on its side of the kink, on which it may have been put just now."""
    side, offset = float(state.branch[a]), plan.links.offset[a]
    away = side * (tables.along.x[a] - offset)
    next_away = side * (tables.along.next_x[a] - offset)
    if min(away, next_away) > sag:
        return True
    return one_way and next_away > 0.0 and away >= -LENGTH * plan.limits.length


@compiled
def _covered(k: int, now: float, then: float, spread: float, running: Running) -> bool:
    """Whether a quantity that strays by `spread` from a line stays within its extremes."""
    return stays_within(k, min(now, then) - spread, max(now, then) + spread, running)


@compiled
def places_unseen(h: float, tables: SampleTables, run: FastRun) -> bool:
    """Whether no distance can exceed its extremes inside the step; some turn with others."""
    plan, state, bodies, at = run.plan, run.state, tables.bodies, run.running.at
    for k in range(plan.distances.first.size):
        if leader_of(k, at, plan.distances) != k:
            continue
        first, second = plan.distances.first[k], plan.distances.second[k]
        start, sag = start_of(k, plan.contacts), bound_of_pair(first, second, bodies.sag)
        x, rate = elongation(first, second, state.u, state.v)
        x_1, rate_1 = elongation(first, second, bodies.next_u, bodies.next_v)
        if not (
            _covered(at.gap + k, start + x, start + x_1, sag, run.running)
            or pair_goes_one_way(h, first, second, rate, rate_1, plan, tables)
        ):
            return False
    return True


@compiled
def forces_covered(n: int, mass: Floats, tables: SampleTables, running: Running) -> bool:
    """Whether absolute accelerations of n bodies and the base shear stay within their extremes.

    The base shear strays from a straight line by no more than the accelerations of the
    bodies, times their masses, do.
    """
    bodies, at = tables.bodies, running.at
    shear, next_shear, spread = 0.0, 0.0, 0.0
    for b in range(n):
        now, then, bend = bodies.acceleration[b], bodies.next_acceleration[b], bodies.bend[b]
        if not _covered(at.acceleration + b, now, then, bend, running):
            return False
        shear -= mass[b] * now
        next_shear -= mass[b] * then
        spread += mass[b] * bend
    return _covered(at.base_shear, shear, next_shear, spread, running)
