"""Bodies that go apart under a record: from one sample to the next, each by steps of its own.

In a *window*, the time dt between two samples, the ground acceleration is a straight line. With the
acceleration a of a body relative to the ground, and its steepest stiffness K for each unit of mass,

    |a(τ)| <= (|a| + dt (K |v| + |slope|)) / (1 - C dt - K dt²/2),

which tells beforehand whose gap may close. A body of no such gap goes by one exact step
(`eventpound.solvers.fast.single.exact`) where it stays on a line of its backbone and exceeds no
extreme. All others go by series, in the order of what happens to them
(`eventpound.solvers.fast.apart.together`); so do all in a part of a window.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.monitored import places_of, running_of
from eventpound.motion.forcing import CurrentPiece, sample_time
from eventpound.numerics.lending import lend
from eventpound.solvers.fast.apart.between import A_HIGH, A_LOW, AFTER, BEFORE, COUNT, STRAY
from eventpound.solvers.fast.apart.own import Window
from eventpound.solvers.fast.apart.together import (
    ACCELERATION,
    NEXT_ACCELERATION,
    NEXT_U,
    NEXT_V,
    OWN_STRAY,
    go_together,
)
from eventpound.solvers.fast.compiled import compiled, compiled_apart, compiled_deferred
from eventpound.solvers.fast.extremes import stays_within
from eventpound.solvers.fast.links import CORE, SATURATED, UNLOADING, gap_of
from eventpound.solvers.fast.record import has_room
from eventpound.solvers.fast.run import Each, FastRun
from eventpound.solvers.fast.sampled.exact import MOST_TURN
from eventpound.solvers.fast.sampled.forces import slope_of
from eventpound.solvers.fast.single.body import (
    absolute_acceleration,
    place_of,
    set_constants,
    steepest,
    tangent,
)
from eventpound.solvers.fast.single.exact import fill_table
from eventpound.solvers.fast.single.series import sample_after
from eventpound.tolerances import OWN_GAP

_ANY = 2**62
"""Steps of bodies in a window, which has an end."""


@compiled_apart
def windows_fit(dt: float, run: FastRun) -> bool:
    """Whether bounds of the motion of all bodies in a time dt (s) are good."""
    each = run.series.each
    for b in range(each.body.size):
        body = each.body[b]
        if not body.known:
            set_constants(b, run.plan, body)
        if body.damping * dt + 0.5 * steepest(body) * dt * dt > MOST_TURN:
            return False
    return True


@compiled_deferred
def go_by_windows(budget: int, stop: float, piece: CurrentPiece, run: FastRun) -> None:
    """Go from sample to sample, to `stop` (s) at most and `budget` times in all."""
    state, each, coefficients = run.state, run.series.each, piece.coefficients
    dt, now, progress = coefficients[1], state.now[0], state.progress[0]
    end, last = now.t, progress.steps + budget
    for b in range(each.body.size):
        _set_bounds(b, dt, each)
        _set_line(b, dt, run)
    while progress.steps < last and end == now.t < stop and progress.due == 0 and has_room(run):
        end, segment = sample_after(now.t, stop, piece)
        window = Window(now.t, end, segment, piece)
        whole = now.t == sample_time(coefficients[0], dt, segment)
        whole = whole and end == sample_time(coefficients[0], dt, segment + 1)
        if not _choose(dt, whole, window, run):
            break
        go_together(_ANY, lend(window), run)
        for b in range(each.body.size):
            if each.until[b] < np.inf:
                _set_line(b, dt, run)
        progress.steps += 1


@compiled
def _set_bounds(b: int, dt: float, each: Each) -> None:
    """What bounds of the motion of a body need to know."""
    lines, body = each.lines, each.body[b]
    lines[ACCELERATION, b] = body.a
    lines[STEEPEST, b] = k = steepest(body)
    lines[INVERSE, b] = 1.0 / (1.0 - body.damping * dt - 0.5 * k * dt * dt)
    lines[DAMPING, b] = body.damping


(PULLED, SPREAD, STEEPEST, INVERSE, STIFFNESS, DAMPING, PULL, LOW, HIGH, WAY) = range(
    OWN_STRAY + 1, OWN_STRAY + 11
)
"""Behind the places of `eventpound.solvers.fast.apart.together` in `Each.lines`: a, and by how much
it may change; K and the inverse of what divides the bound above; of the line that a body is on its
stiffness and damping for each unit of mass, the absolute acceleration at u = v = 0, displacements
at which it ends (m), and the direction in which it has to be gone along, 0 for either."""
OF_V = WAY + 1
"""First of the six numbers α, β of an exact step."""
LINE_PLACES = OF_V + 6
"""Rows of `Each.lines`."""


@compiled
def _set_line(b: int, dt: float, run: FastRun) -> None:
    """What an exact step of a body needs to know of the line that it is on; none without one."""
    each = run.series.each
    lines, body = each.lines, each.body[b]
    part, sigma = body.part, body.sigma
    lines[LOW, b], lines[HIGH, b], lines[WAY, b] = np.inf, -np.inf, 0.0
    if UNLOADING < part < SATURATED:
        return
    saturated, k = part == SATURATED, tangent(body)
    table = body.saturated if saturated else body.on_line
    if table[0] != dt:
        fill_table(k, body.damping, dt, table)
    if table[7] == 0.0:
        return
    for i in range(6):
        lines[OF_V + i, b] = table[1 + i]
    lines[STIFFNESS, b] = k
    z = sigma if saturated else sigma * place_of(0.0, body)
    lines[PULL, b] = absolute_acceleration(0.0, 0.0, z, body)
    low, high = -np.inf, np.inf
    if body.hysteretic and not saturated:
        end = body.u_r + sigma * (body.core_end - body.xi_r) * body.scale
        start = body.u_r - sigma * (body.core_end + body.xi_r) * body.scale
        if part == CORE:
            low, high = min(start, end), max(start, end)
        elif sigma > 0.0:
            high = end
        else:
            low = end
    lines[LOW, b], lines[HIGH, b] = low, high
    lines[WAY, b] = 0.0 if part == CORE else sigma


@compiled
def _choose(dt: float, whole: bool, window: Window, run: FastRun) -> bool:
    """Let those bodies take part in a window that may meet, or do not go by an exact step.

    So do those whose gap may exceed its extremes, and all where the window is not `whole`. False:
    a gap is a variable of its own, and no body goes by itself.
    """
    contacts, state, each = run.plan.contacts, run.state, run.series.each
    lines, samples, least = each.lines, window.piece.samples, OWN_GAP * run.plan.limits.length
    g, slope = samples[window.segment], slope_of(window.segment, dt, samples)
    first, each.outside[:] = run.running.at.gap, 0.0
    for b in range(each.until.size):
        a = lines[ACCELERATION, b] - g
        jerk = lines[STEEPEST, b] * abs(state.v[b]) + abs(slope)
        lines[PULLED, b] = a
        lines[SPREAD, b] = (abs(a) + dt * jerk) * lines[INVERSE, b] - abs(a)
        each.until[b] = np.inf if whole else window.start
    for j in range(contacts.gap.size):
        left, right = contacts.left[j], contacts.right[j]
        gap, rate = gap_of(j, contacts, state.u, state.v)
        if gap < least:
            return False
        bend = spread = 0.0
        if right >= 0:
            bend, spread = lines[PULLED, right], lines[SPREAD, right]
        if left >= 0:
            bend, spread = bend - lines[PULLED, left], spread + lines[SPREAD, left]
        low = gap + dt * min(0.0, rate + 0.5 * dt * min(0.0, bend - spread))
        high = gap + dt * max(0.0, rate + 0.5 * dt * max(0.0, bend + spread))
        # Where a gap goes one way its extreme is yet to come.
        one_way = (
            rate + dt * min(bend - spread, 0.0) > 0.0 or rate + dt * max(bend + spread, 0.0) < 0.0
        )
        settled = min(left, right) < 0 or one_way
        if low >= least and (settled or stays_within(first + j, low, high, run.running)):
            continue
        for b in (left, right):
            if b >= 0:
                each.until[b] = window.start
    for b in range(each.until.size):
        each.box[A_LOW, b] = each.box[A_HIGH, b] = 0.0
        if each.until[b] == np.inf and not _exact_step(b, dt, slope, run):
            each.until[b] = window.start
    return True


@compiled
def _exact_step(b: int, dt: float, slope: float, run: FastRun) -> bool:
    """An exact step of a body, if it stays on a line of its backbone and exceeds no extreme."""
    state, each, mass = run.state, run.series.each, run.plan.mass[b]
    x, outside, u, v = each.lines, each.outside, state.u[b], state.v[b]
    a, k, damping, now = x[PULLED, b], x[STIFFNESS, b], x[DAMPING, b], x[ACCELERATION, b]
    fastest, way = abs(a) + x[SPREAD, b], x[WAY, b]
    one_way = abs(v) > dt * fastest
    if way != 0.0 and not (one_way and way * v > 0.0):
        return False
    u_1 = u + x[OF_V, b] * v + x[OF_V + 1, b] * a + x[OF_V + 2, b] * slope
    low, high, reach = min(u, u_1), max(u, u_1), dt * (abs(v) + dt * fastest)
    if not one_way:
        low, high = u - reach, u + reach
    if not (x[LOW, b] <= low and high <= x[HIGH, b]):
        return False
    if damping > 0.0 or not one_way:
        own = running_of(each.extremes[b], places_of(1, 0, 0))
        stray = k * reach + damping * dt * fastest
        if not stays_within(own.at.acceleration, now - stray, now + stray, own):
            return False
        if not (one_way or stays_within(own.at.displacement, low, high, own)):
            return False
    v_1 = x[OF_V + 3, b] * v + x[OF_V + 4, b] * a + x[OF_V + 5, b] * slope
    x[NEXT_U, b], x[NEXT_V, b] = u_1, v_1
    x[NEXT_ACCELERATION, b] = x[PULL, b] - k * u_1 - damping * v_1
    # Where a rate changes by b all in all, a quantity strays by b dt / 4 from a line at most.
    x[OWN_STRAY, b] = 0.25 * dt * (dt * k * fastest + damping * x[SPREAD, b])
    each.order[b] = 0
    outside[COUNT] += 1.0
    outside[BEFORE] -= mass * now
    outside[AFTER] -= mass * x[NEXT_ACCELERATION, b]
    outside[STRAY] += mass * x[OWN_STRAY, b]
    return True
