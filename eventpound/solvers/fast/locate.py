"""The first event within a step: a closing, a release, a kink, a reversal or a border.

Each quantity that must not change sign is a polynomial; what its bounds
(`eventpound.solvers.fast.search`) cannot exclude is located, and what happens in the
same instant is marked together.
"""

from __future__ import annotations

import numpy as np

from eventpound.contact.kinks import still_rate
from eventpound.contact.modes import force_vanishes
from eventpound.contact.rest import closing_time
from eventpound.mechanics.elements import (
    branch_ends,
    has_branches,
    number_beside,
    reversal_jump,
    slides,
)
from eventpound.mechanics.link_law import YIELDING
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.polynomial import value_and_slope
from eventpound.numerics.power_series import sign_after
from eventpound.solvers.fast.compiled import compiled, compiled_deferred, compiled_noinline
from eventpound.solvers.fast.followed import follows
from eventpound.solvers.fast.links import CORE, UNLOADING, UP, xi_at
from eventpound.solvers.fast.run import FastLocated, FastPlan, FastRun, FastSeries, Limits, Links
from eventpound.solvers.fast.search import (
    bound_of_pair,
    distance_coefficient,
    distance_stays_above,
    fall_beyond,
    first_fall,
    force_level,
    gap_polynomial,
    release_time,
    set_distance,
    stays_above,
)
from eventpound.solvers.fast.sliding import (
    any_rubbing,
    end_of_slip,
    holds_slider,
    holds_stick,
    set_margin,
)
from eventpound.tolerances import GAP_COEFFICIENT, LENGTH, NO_Z, OF_BACKBONE, SAME_INSTANT


@compiled
def _note(tau: float, first: float, which: int, flags: Bools, located: FastLocated) -> float:
    """Mark an event at tau (s) that belongs to the first ones, unless `which` is -1; their time."""
    if not tau <= first * (1.0 + SAME_INSTANT):
        return first
    if tau < first * (1.0 - SAME_INSTANT):
        clear_located(located)
    if which >= 0 and tau < np.inf:
        flags[which] = True
    return min(tau, first)


@compiled
def clear_located(located: FastLocated) -> None:
    """Nothing is located."""
    located.block[:] = 0


@compiled
def first_event(order: int, h: float, run: FastRun) -> float:
    """Time of the first event within h (s), marked in `located`; inf if there is none."""
    state = run.state
    clear_located(run.located)
    first = _closings(order, h, run)
    # Each search ends at the first event so far: nothing later belongs to this step.
    first = _hysteretic(order, min(h, first), first, run)
    first = _kinks(order, min(h, first), first, run)
    if follows(run):
        first = _of_followed(order, h, first, run)
    if any_rubbing(run):
        first = _slips(order, h, first, run)
    if state.progress[0].resting > 0:
        first = _releases(order, min(h, first), first, run)
    return first


@compiled
def _closings(order: int, h: float, run: FastRun) -> float:
    plan, state, series, located = run.plan, run.state, run.series, run.located
    first = np.inf
    contacts = plan.contacts
    for j in range(contacts.gap.size):
        if state.resting[j]:
            continue
        left, right = contacts.left[j], contacts.right[j]
        a = series.of_body[left] if left >= 0 else -1
        b = series.of_body[right] if right >= 0 else -1
        # Mostly bounds exclude a closing; of a gap that starts from zero they tell nothing.
        if state.gap[j] > 0.0 and distance_stays_above(state.gap[j], 1.0, a, b, h, series):
            continue
        gap_polynomial(j, order, run)
        tau = closing_time(series.c, order + 1, min(h, first), series.work)
        first = _note(tau, first, j, located.closing, located)
    return first


@compiled
def _hysteretic(order: int, h: float, first: float, run: FastRun) -> float:
    plan, state, series, located = run.plan, run.state, run.series, run.located
    hysteresis = plan.hysteresis
    for i in range(hysteresis.link.size):
        a = hysteresis.link[i]
        head, tail = series.ends[a, 0], series.ends[a, 1]
        if head == tail:
            continue
        travel = bound_of_pair(head, tail, series.reach)
        # A link that all but stands still reverses at the level of rounding.
        if state.part[i] != CORE and travel > plan.limits.hysteresis * hysteresis.scale[i]:
            tau = _reversal(order, h, a, state.sigma[i], run)
            first = _note(tau, first, i, located.turned, located)
        # Saturation, which ends UP, changes nothing by more than the tolerance: no event.
        if state.part[i] < UP:
            tau = _border(order, h, first, i, run)
            first = _note(tau, first, i, located.crossed, located)
    return first


@compiled
def _reversal(order: int, h: float, a: int, sigma: float, run: FastRun) -> float:
    """When σ x' of a link falls below zero, or inf."""
    plan, series = run.plan, run.series
    head, tail = series.ends[a, 0], series.ends[a, 1]
    rate = sigma * series.x_rate[a]
    slope = 2.0 * sigma * distance_coefficient(head, tail, 2, series)
    bend = 3.0 * sigma * distance_coefficient(head, tail, 3, series)
    if stays_above(rate, slope, bend, bound_of_pair(head, tail, series.swing), h):
        return np.inf
    c, limits = series.c, plan.limits
    still = still_rate(limits.length, limits.time)
    set_distance(0.0, sigma, head, tail, order, series)
    for k in range(order):
        c[k] = (k + 1) * c[k + 1]
    c[0] = rate
    return first_fall(c, order, h, still, still / limits.time, series.work)


@compiled
def _border(order: int, h: float, first: float, i: int, run: FastRun) -> float:
    """When a hysteretic link leaves its part of the backbone, or inf."""
    hysteresis, state, series = run.plan.hysteresis, run.state, run.series
    a, part = hysteresis.link[i], state.part[i]
    head, tail = series.ends[a, 0], series.ends[a, 1]
    xi, factor = xi_at(i, series.x[a], hysteresis, state), state.sigma[i] / hysteresis.scale[i]
    # ξ grows by σ/(u_y b) with x: what is above becomes less by that, what is below more.
    above = (hysteresis.core[i] if part <= UNLOADING else hysteresis.down[i]) - xi
    below, limit, tau = hysteresis.core[i] + xi, min(h, first), np.inf
    if not distance_stays_above(above, -factor, head, tail, h, series):
        set_distance(above, -factor, head, tail, order, series)
        tau = first_fall(series.c, order + 1, limit, OF_BACKBONE, 0.0, series.work)
    # Other parts end downwards by a reversal.
    if part == CORE and not distance_stays_above(below, factor, head, tail, h, series):
        set_distance(below, factor, head, tail, order, series)
        tau = min(tau, first_fall(series.c, order + 1, limit, OF_BACKBONE, 0.0, series.work))
    return tau


@compiled
def _kinks(order: int, h: float, first: float, run: FastRun) -> float:
    plan, state, series, located = run.plan, run.state, run.series, run.located
    links: Links = plan.links
    for i in range(state.progress[0].active):
        a = series.active[i]
        if links.compression[a] == links.extension[a]:
            continue
        side = float(state.branch[a])
        away = side * (series.x[a] - links.offset[a])
        tau = _leaves_branch(order, h, min(h, first), a, side, away, run)
        first = _note(tau, first, a, located.kinked, located)
    return first


@compiled
def _leaves_branch(
    order: int, h: float, limit: float, a: int, side: float, away: float, run: FastRun
) -> float:
    """When a link has gone a distance `away` against a side (m) within h, up to `limit` (s)."""
    series, head, tail = run.series, run.series.ends[a, 0], run.series.ends[a, 1]
    if distance_stays_above(away, side, head, tail, h, series):
        return np.inf
    set_distance(away, side, head, tail, order, series)
    kept = run.state.progress[0].stalled > 0
    return _passes_end(order, limit, kept, head, tail, run.plan.limits, series)


@compiled_noinline
def _passes_end(
    order: int, limit: float, kept: bool, head: int, tail: int, limits: Limits, series: FastSeries
) -> float:
    """When the distance to a kink, in `series.c`, falls below zero, or inf.

    Of a link that stands still on its kink the first coefficient beyond rounding tells
    which way it goes. Where it is `kept`, having just changed its branch, that may be
    rounding still: its force differs by no more than rounding until it has moved.
    """
    c, length = series.c, LENGTH * limits.length
    still = still_rate(limits.length, limits.time)
    if kept and abs(c[0]) <= length and abs(c[1]) <= still:
        return fall_beyond(c, order + 1, limit, length, series.work)
    level = length
    for k in range(order + 1):
        beside = 0.0
        for end in (head, tail):
            if end >= 0 and k > 1:
                beside += GAP_COEFFICIENT * abs(series.X[end, k])
        if abs(c[k]) > level + beside:
            break
        c[k] = 0.0
        level = still if k == 0 else level / (k * limits.time)
    return first_fall(c, order + 1, limit, 0.0, 0.0, series.work)


@compiled_deferred
def _of_followed(order: int, h: float, first: float, run: FastRun) -> float:
    """The first of these: a link leaves its branch, or the formula of a z that is followed."""
    plan, state, series, located = run.plan, run.state, run.series, run.located
    for i in range(plan.hysteresis.followed.size):
        z = plan.hysteresis.followed[i]
        a = plan.hysteresis.link[z]
        # Within a cluster neither x nor z moves.
        if series.ends[a, 0] == series.ends[a, 1]:
            continue
        if has_branches(a, plan.links.law.memory) and state.branch[a] != 0:
            tau = _end_of_branch(order, h, min(h, first), a, z, run)
            first = _note(tau, first, a, located.kinked, located)
        if _bends(h, a, z, order, run):
            # Nothing is to be done there but to begin another series.
            tau = _reversal(order, min(h, first), a, series.followed.sigma[i], run)
            first = _note(tau, first, -1, located.turned, located)
            tau = _zero_of_z(order, min(h, first), z, run)
            first = _note(tau, first, z, located.crossed, located)
    return first


@compiled_deferred
def _slips(order: int, h: float, first: float, run: FastRun) -> float:
    """The first of these: a contact with friction stops to slip."""
    may_stop, branch, located = run.series.may_stop, run.state.branch, run.located
    for f in range(may_stop.size):
        if may_stop[f]:
            a = branch.size - may_stop.size + f
            tau = end_of_slip(order, h, min(h, first), a, float(branch[a]), run)
            first = _note(tau, first, a, located.kinked, located)
    return first


@compiled_noinline
def _end_of_branch(order: int, h: float, limit: float, a: int, z: int, run: FastRun) -> float:
    """When a link comes to an end of its branch within h, up to `limit` (s), or inf."""
    links, series, branch = run.plan.links, run.series, run.state.branch[a]
    x, memory = series.x[a], links.law.memory
    if slides(a, memory):
        if holds_slider(a, run):
            return np.inf
        return end_of_slip(order, h, limit, a, float(branch), run)
    if branch == YIELDING:
        return _reversal(order, limit, a, -1.0, run)
    low, high = branch_ends(a, memory, branch, links.offset[a], x, series.z[z, 0])
    first = np.inf
    if low > -np.inf:
        first = _leaves_branch(order, h, limit, a, 1.0, x - low, run)
    if high < np.inf:
        first = min(first, _leaves_branch(order, h, limit, a, -1.0, high - x, run))
    return first


@compiled
def _bends(h: float, a: int, z: int, order: int, run: FastRun) -> bool:
    """Whether the rate of a z may have another formula within h (s), so that it matters.

    It has where x' or z changes its sign. By then z errs, with the rate it had before, by no more
    than the jump of dz/dx for the largest z times all of the travel.
    """
    plan, series, size = run.plan, run.series, 0.0
    for k in range(order - 1, -1, -1):
        size = size * h + abs(series.z[z, k])
    memory, ends = series.memory, series.ends
    beside = series.z[plan.links.z_of_link[number_beside(a, memory)], 0]
    travel = bound_of_pair(ends[a, 0], ends[a, 1], series.reach)
    return bool(reversal_jump(a, memory, size, beside) * travel > plan.limits.hysteresis)


@compiled_noinline
def _zero_of_z(order: int, limit: float, z: int, run: FastRun) -> float:
    """When a z passes zero up to `limit` (s), or inf."""
    c, sign = run.series.c, sign_after(run.series.z[z], order, NO_Z)
    for k in range(order):
        c[k] = sign * run.series.z[z, k]
    return first_fall(c, order, limit, NO_Z, 0.0, run.series.work)


@compiled
def _releases(order: int, h: float, first: float, run: FastRun) -> float:
    plan, state, series, located = run.plan, run.state, run.series, run.located
    limits, forces = plan.limits, series.contact_force
    level = force_level(state.progress[0].clusters, limits, series)
    for end in range(2 * state.resting.size):
        j = end // 2
        if not state.unlocked[j] or not _has_end(end, order, run):
            continue
        force = series.d if holds_stick(j, run) else forces[j]
        spread = 0.0
        for k in range(order - 2, 0, -1):
            spread = (spread + abs(force[k])) * h
        # Larger than all by which it can change within h.
        if force[0] > spread:
            continue
        # Where the acceleration problem has just kept it, only rounding can let it fall at once.
        kept = abs(force[0]) <= level and state.progress[0].stalled > 0
        if kept:
            _drop_rounding(force, order, level, plan, series)
        tau = release_time(force, order - 1, h, min(h, first), level, kept, series.work)
        first = _note(tau, first, j, located.released, located)
    slowest = np.inf
    # `_has_end` makes the margin that `_margin_and_slope` reads: one right after the other.
    for end in range(2 * state.resting.size):
        if located.released[end // 2] and _has_end(end, order, run):
            _, slope = _margin_and_slope(end, first, order, run)
            slowest = min(slowest, abs(slope))
    if slowest < np.inf:
        for end in range(2 * state.resting.size):
            j = end // 2
            if state.unlocked[j] and _has_end(end, order, run):
                value, slope = _margin_and_slope(end, first, order, run)
                vanishes = force_vanishes(value, slope, level, slowest, limits.time)
                located.released[j] = located.released[j] or vanishes
    return first


@compiled
def _margin_and_slope(end: int, tau: float, order: int, run: FastRun) -> tuple[float, float]:
    """The contact force at tau (s), or what `_has_end` has set of a stick's, and its rate."""
    j, series = end // 2, run.series
    force = series.d if holds_stick(j, run) else series.contact_force[j]
    return value_and_slope(force[: order - 1], tau)


@compiled
def _has_end(end: int, order: int, run: FastRun) -> bool:
    """Whether the rest of contact end // 2 can end there: at a second one what sticks alone."""
    sticks = holds_stick(end // 2, run)
    if sticks:
        set_margin(end // 2, end % 2, order, run)
    return sticks or end % 2 == 0


@compiled_noinline
def _drop_rounding(
    force: Floats, order: int, level: float, plan: FastPlan, series: FastSeries
) -> None:
    """Clear the first coefficients of a contact force that are no more than rounding.

    `level` (N) is that of the force itself; those of higher order err like the
    accelerations they are differences of.
    """
    scale, mass = level, plan.limits.mass
    for k in range(order - 1):
        largest = 0.0
        for c in range(plan.mass.size):
            largest = max(largest, abs(series.X[c, k + 2]))
        rounding = GAP_COEFFICIENT * mass * (k + 1) * (k + 2) * largest if k > 0 else 0.0
        if abs(force[k]) > scale + rounding:
            return
        force[k] = 0.0
        # As a derivative in the scene's own time goes.
        scale /= plan.limits.time
