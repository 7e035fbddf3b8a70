"""What concerns several bodies that go apart: distances, the base shear, rows of the history.

It follows from the steps that the bodies are taking, each a series good from where it began to
where it ends; what the boxes in which they stay exclude is passed over.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.monitored import update_extreme, update_turning_point
from eventpound.motion.forcing import CurrentPiece, ground_acceleration
from eventpound.numerics.arrays import Floats
from eventpound.numerics.polynomial import first_root
from eventpound.solvers.fast.compiled import compiled, compiled_noinline
from eventpound.solvers.fast.evaluate import observe_forces
from eventpound.solvers.fast.extremes import (
    flat_time,
    set_rate,
    shift,
    start_of,
    stays_within,
    take_turns,
    turning_times,
)
from eventpound.solvers.fast.links import gap_of
from eventpound.solvers.fast.record import is_due, write_row
from eventpound.solvers.fast.run import Contacts, FastRun
from eventpound.solvers.fast.sdof.record import acceleration_coefficient
from eventpound.solvers.fast.search import motion, stays_above

(U_LOW, U_HIGH, A_LOW, A_HIGH) = range(4)
"""Rows of `Each.box`."""
(COUNT, BEFORE, AFTER, STRAY) = range(4)
"""Places in `Each.outside`: how many bodies go by exact steps; their base shear at both ends of the
window, and how far it strays from between these at most (N)."""


@compiled
def bounds_of_distance(k: int, row: int, start: float, run: FastRun) -> tuple[float, float]:
    """Bounds of a distance (m), or of its second derivative (m/s²), by those of its bodies.

    They stand in `Each.box` from a row on. The distance is `start` at no displacement.
    """
    distances, box = run.plan.distances, run.series.each.box
    first, second = distances.first[k], distances.second[k]
    low = high = start
    if second >= 0:
        low, high = low + box[row, second], high + box[row + 1, second]
    if first >= 0:
        low, high = low - box[row + 1, first], high - box[row, first]
    return low, high


@compiled
def takes_part(k: int, run: FastRun) -> bool:
    """Whether no body of a distance goes by an exact step."""
    distances, until = run.plan.distances, run.series.each.until
    first, second = distances.first[k], distances.second[k]
    return (first < 0 or until[first] < np.inf) and (second < 0 or until[second] < np.inf)


@compiled
def distance_at(k: int, t: float, run: FastRun) -> tuple[float, float]:
    """A distance (m) and its rate (m/s) at a time (s) that the series of its bodies reach."""
    distances, each = run.plan.distances, run.series.each
    there, rate = start_of(k, run.plan.contacts), 0.0
    for b, side in ((distances.second[k], 1.0), (distances.first[k], -1.0)):
        if b >= 0:
            change, v, _ = motion(t - each.now[b].t, each.order[b], each.body[b].x[:])
            there, rate = there + side * (each.body[b].u + change), rate + side * v
    return there, rate


@compiled
def time_of_closing(j: int, now: float, run: FastRun) -> float:
    """When a gap closes, as far as both series reach (s)."""
    contacts, until, c = run.plan.contacts, run.series.each.until, run.series.c
    end = np.inf
    if bounds_of_distance(j, U_LOW, contacts.gap[j], run)[0] > 0.0:
        return np.inf
    for b in (contacts.left[j], contacts.right[j]):
        if b >= 0:
            end = min(end, until[b])
    h, (gap, rate) = end - now, distance_at(j, now, run)
    # What the ground does is the same for two bodies; a barrier goes with it.
    low, _ = bounds_of_distance(j, A_LOW, 0.0, run)
    two = min(contacts.left[j], contacts.right[j]) >= 0
    if two and stays_above(gap, rate, 0.5 * low, 0.0, h):
        return np.inf
    order, rest = set_distance(j, now, run), 0.0
    for k in range(order, 2, -1):
        rest = (rest + abs(c[k])) * h
    if c[0] <= 0.0:
        return now
    if stays_above(c[0], c[1], c[2], rest * h * h, h):
        return np.inf
    return now + float(first_root(c, order + 1, h, run.series.work))


@compiled
def set_distance(k: int, now: float, run: FastRun) -> int:
    """Coefficients of a distance about a time (s) into `series.c`; their highest power."""
    distances, c, order = run.plan.distances, run.series.c, 3
    c[:] = 0.0
    c[0] = start_of(k, run.plan.contacts)
    if distances.second[k] >= 0:
        order = max(order, _add_body(distances.second[k], 1.0, now, run))
    if distances.first[k] >= 0:
        order = max(order, _add_body(distances.first[k], -1.0, now, run))
    return order


@compiled
def _add_body(b: int, factor: float, now: float, run: FastRun) -> int:
    """Add a multiple of the displacement of a body about a time (s) to `series.c`; its order."""
    each, c, d = run.series.each, run.series.c, run.series.d
    body, order, since = each.body[b], each.order[b], now - each.now[b].t
    d[0] = body.u
    for k in range(1, order + 1):
        d[k] = body.x[k]
    return _add_later(int(order), factor, since, c, d)


@compiled
def _add_later(order: int, factor: float, since: float, c: Floats, d: Floats) -> int:
    """Add a multiple of the polynomial d about a later point to c; its order. d is overwritten."""
    if since > 0.0:
        shift(d, order + 1, since)
    for k in range(order + 1):
        c[k] += factor * d[k]
    return order


@compiled
def take_distances_of(who: int, now: float, run: FastRun) -> None:
    """Extremes of the distances of a body, or any for -1, from others, up to a time (s).

    That gaps are open is known, and all are whose bodies take part.
    """
    each, contacts, running = run.series.each, run.plan.contacts, run.running
    for k in range(each.since.size):
        first, second = run.plan.distances.first[k], run.plan.distances.second[k]
        if min(first, second) < 0 or (who >= 0 and who not in (first, second)):
            continue
        if not takes_part(k, run):
            continue
        low, high = bounds_of_distance(k, U_LOW, start_of(k, run.plan.contacts), run)
        low = max(low, least_of(k, 0.0, contacts))
        i = running.at.gap + k
        if each.since[k] < now and not stays_within(i, low, high, running):
            _take_distance(i, k, now, run)
        each.since[k] = now


@compiled
def least_of(k: int, least: float, contacts: Contacts) -> float:
    """What distance k is not to be less than (m): `least` for a gap."""
    return least if k < contacts.gap.size else -np.inf


@compiled
def _take_distance(i: int, k: int, now: float, run: FastRun) -> None:
    """Turning points of a distance since it was looked at last, and its value at a time (s)."""
    series, running, since = run.series, run.running, run.series.each.since[k]
    h, (_, rate), (low, high) = (
        now - since,
        distance_at(k, since, run),
        bounds_of_distance(k, A_LOW, 0.0, run),
    )
    if not (rate + min(low, 0.0) * h > 0.0 or rate + max(high, 0.0) * h < 0.0):
        order = set_distance(k, since, run)
        set_rate(series.c, order, series.d)
        take_turns(i, series.c, order, since, h, run)
    there = max(distance_at(k, now, run)[0], least_of(k, 0.0, run.plan.contacts))
    update_extreme(i, there, now, running)


@compiled
def shear_stays(run: FastRun) -> bool:
    """Whether the base shear stays within its extremes during the present steps."""
    mass, box, outside = run.plan.mass, run.series.each.box, run.series.each.outside
    low = min(outside[BEFORE], outside[AFTER]) - outside[STRAY]
    high = max(outside[BEFORE], outside[AFTER]) + outside[STRAY]
    for b in range(mass.size):
        low, high = low - mass[b] * box[A_HIGH, b], high - mass[b] * box[A_LOW, b]
    return stays_within(run.running.at.base_shear, low, high, run.running)


@compiled
def take_shear(now: float, then: float, piece: CurrentPiece, run: FastRun) -> None:
    """Turning points of the base shear between two times (s), and its value at the second."""
    place, (start, down, up) = run.running.at.base_shear, _shear_between(now, then, piece, run)
    if stays_within(place, start + down, start + up, run.running):
        return
    if down < 0.0 < up:
        _follow_shear(place, now, then, run)
    take_shear_at(then, run)


@compiled
def take_shear_at(t: float, run: FastRun) -> None:
    """Take the base shear at a time (s) that all series reach."""
    _observe_at(t, 0.0, run)
    update_extreme(run.running.at.base_shear, run.observed.base[1], t, run.running)


@compiled
def _shear_between(
    now: float, then: float, piece: CurrentPiece, run: FastRun
) -> tuple[float, float, float]:
    """Base shear at a time (s), and by how much it falls and grows at most until another (N).

    Between two turns the force of a spring goes one way; of a body that all but stands still it
    changes by less than its hysteresis is known. With dashpots its bounds are those of the whole
    step.
    """
    plan, each = run.plan, run.series.each
    start = down = up = 0.0
    before, after = ground_acceleration(piece, now), ground_acceleration(piece, then)
    for b in range(plan.mass.size):
        body, begun, m = each.body[b], each.now[b].t, plan.mass[b]
        a = motion(now - begun, each.order[b], body.x[:])[2] + before
        start -= m * a
        if body.damping > 0.0:
            down += m * min(a - each.box[A_HIGH, b], 0.0)
            up += m * max(a - each.box[A_LOW, b], 0.0)
            continue
        change = m * (a - after - motion(then - begun, each.order[b], body.x[:])[2])
        down, up = down + min(change, 0.0), up + max(change, 0.0)
    return start, down, up


@compiled
def _follow_shear(place: int, now: float, then: float, run: FastRun) -> None:
    """Turning points of the base shear by the series of the bodies.

    The forces of the links tell how much it is.
    """
    plan, series, observed, running = run.plan, run.series, run.observed, run.running
    c, d, order, near = series.c, series.d, 3, flat_time(run.plan)
    c[:] = 0.0
    for b in range(plan.mass.size):
        order = max(order, _add_acceleration(b, -plan.mass[b], now, run))
    set_rate(c, order, d)
    for m in range(turning_times(d, order, then - now, series.turns, series.work)):
        _observe_at(now + series.turns[m], 0.0, run)
        update_turning_point(place, observed.base[1], now + series.turns[m], near, running)


@compiled
def _add_acceleration(b: int, factor: float, now: float, run: FastRun) -> int:
    """As `_add_body` for the absolute acceleration."""
    each, c, d = run.series.each, run.series.c, run.series.d
    body, order, since = each.body[b], each.order[b] - 2, now - each.now[b].t
    for k in range(order + 1):
        d[k] = acceleration_coefficient(k, body)
    return _add_later(int(order), factor, since, c, d)


@compiled
def _observe_at(t: float, ground: float, run: FastRun) -> None:
    """Fill `observed` with motion and forces at a time (s) that all series reach."""
    plan, observed, each = run.plan, run.observed, run.series.each
    for b in range(plan.mass.size):
        body = each.body[b]
        change, observed.v[b], _ = motion(t - each.now[b].t, each.order[b], body.x[:])
        observed.u[b] = body.u + change
    observe_forces(ground, run)
    for b in range(plan.mass.size):
        observed.a[b] = observed.body_force[b] / plan.mass[b]


@compiled
def write_rows(now: float, then: float, piece: CurrentPiece, run: FastRun) -> None:
    """History at the output times between two times (s)."""
    times, progress = run.plan.output_times, run.state.progress[0]
    while is_due(then, times, progress):
        if times[progress.output] >= now:
            write_row_at(times[progress.output], piece, run)
        progress.output += 1


@compiled_noinline
def write_row_at(t: float, piece: CurrentPiece, run: FastRun) -> None:
    """A row of the history at a time (s) that all series reach."""
    contacts, observed, state = run.plan.contacts, run.observed, run.state
    _observe_at(t, ground_acceleration(piece, t), run)
    for j in range(contacts.gap.size):
        observed.gap[j], observed.gap_rate[j] = gap_of(j, contacts, observed.u, observed.v)
        if t == state.now[0].t:
            # Where they set out there is a row already, which is to be the same.
            observed.gap[j], observed.gap_rate[j] = state.gap[j], state.gap_rate[j]
        observed.contact_force[j] = 0.0
    write_row(t, run)
