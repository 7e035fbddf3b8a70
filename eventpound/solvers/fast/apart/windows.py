"""Bodies that go apart under a record: from one sample to the next, each by steps of its own.

In a *window*, the time dt between two samples, bounds of the accelerations
(`eventpound.solvers.fast.sdof.exact`) tell beforehand whose gap may close. A body of no such gap
goes by one exact step where it stays on a line of its backbone and exceeds no extreme. All others
go by series, in the order of what happens to them (`eventpound.solvers.fast.apart.together`); so do
all in a part of a window.
"""

from __future__ import annotations

import numpy as np

from eventpound.motion.forcing import CurrentPiece, sample_time
from eventpound.numerics.by_address import by_address
from eventpound.solvers.fast.apart.between import (
    A_HIGH,
    A_LOW,
    AFTER,
    BEFORE,
    COUNT,
    STRAY,
    bounds_of_distance,
    least_of,
)
from eventpound.solvers.fast.apart.own import Window, running_of_own
from eventpound.solvers.fast.apart.together import go_together
from eventpound.solvers.fast.compiled import compiled, compiled_deferred, compiled_noinline
from eventpound.solvers.fast.extremes import start_of, stays_within
from eventpound.solvers.fast.links import elongation
from eventpound.solvers.fast.record import has_room
from eventpound.solvers.fast.run import FastRun
from eventpound.solvers.fast.sampled.exact import MOST_TURN
from eventpound.solvers.fast.sampled.forces import GroundLine, slope_of
from eventpound.solvers.fast.sdof.body import set_constants, tangent
from eventpound.solvers.fast.sdof.exact import exact_step, fastest_ahead, set_line, turn_in
from eventpound.solvers.fast.sdof.series import sample_after
from eventpound.tolerances import OWN_GAP

_ANY = 2**62
"""Steps of bodies in a window, which has an end."""


@compiled_noinline
def windows_fit(dt: float, run: FastRun) -> bool:
    """Whether bounds of the motion of all bodies in a time dt (s) are good."""
    each = run.series.each
    for b in range(each.body.size):
        body = each.body[b]
        if not body.known:
            set_constants(b, run.plan, body)
        if turn_in(dt, body) > MOST_TURN:
            return False
    return True


@compiled_deferred
def go_by_windows(budget: int, stop: float, piece: CurrentPiece, run: FastRun) -> None:
    """Go from sample to sample, to `stop` (s) at most and `budget` times in all."""
    state, each, coefficients = run.state, run.series.each, piece.coefficients
    dt, now, progress = coefficients[1], state.now[0], state.progress[0]
    end, last = now.t, progress.steps + budget
    for b in range(each.body.size):
        set_line(dt, each.body[b])
    while progress.steps < last and end == now.t < stop and progress.due == 0 and has_room(run):
        end, segment = sample_after(now.t, stop, piece)
        window = Window(now.t, end, segment, piece)
        whole = now.t == sample_time(coefficients[0], dt, segment)
        whole = whole and end == sample_time(coefficients[0], dt, segment + 1)
        if not _choose(dt, whole, window, run):
            break
        go_together(_ANY, by_address(window), run)
        for b in range(each.body.size):
            if each.until[b] < np.inf:
                set_line(dt, each.body[b])
        progress.steps += 1


@compiled
def _choose(dt: float, whole: bool, window: Window, run: FastRun) -> bool:
    """Let those bodies take part in a window that may meet, or do not go by an exact step.

    So do those whose distance may exceed its extremes, and all where the window is not `whole`.
    False: a gap is a variable of its own, and no body goes by itself.
    """
    contacts, state, each = run.plan.contacts, run.state, run.series.each
    samples, least = window.piece.samples, OWN_GAP * run.plan.limits.length
    slope, box = slope_of(window.segment, dt, samples), each.box
    ground = GroundLine(window.end, 0.0, samples[window.segment], slope)
    each.outside[:] = 0.0
    for b in range(each.until.size):
        body = each.body[b]
        a = body.a - ground.g
        # Here it is relative to the ground.
        spread = fastest_ahead(a, body.v, slope, dt, body) - abs(a)
        box[A_LOW, b], box[A_HIGH, b] = a - spread, a + spread
        each.until[b] = np.inf if whole else window.start
    for k in range(each.since.size):
        first, second = run.plan.distances.first[k], run.plan.distances.second[k]
        x, rate = elongation(first, second, state.u, state.v)
        x, allowed = x + start_of(k, contacts), least_of(k, least, contacts)
        if x < allowed:
            return False
        down, up = bounds_of_distance(k, A_LOW, 0.0, run)
        down, up = dt * min(0.0, down), dt * max(0.0, up)
        low, high = x + dt * min(0.0, rate + 0.5 * down), x + dt * max(0.0, rate + 0.5 * up)
        # Where a distance goes one way its extreme is yet to come.
        settled = min(first, second) < 0 or rate + down > 0.0 or rate + up < 0.0
        i = run.running.at.gap + k
        if low >= allowed and (settled or stays_within(i, low, high, run.running)):
            continue
        for b in (first, second):
            if b >= 0:
                each.until[b] = window.start
    for b in range(each.until.size):
        box[A_LOW, b] = box[A_HIGH, b] = 0.0
        if each.until[b] == np.inf and not _go_exactly(b, dt, ground, run):
            each.until[b] = window.start
    return True


@compiled
def _go_exactly(b: int, dt: float, ground: GroundLine, run: FastRun) -> bool:
    """An exact step of a body, if it holds."""
    each, mass, body = run.series.each, run.plan.mass[b], run.series.each.body[b]
    outside, own = each.outside, running_of_own(b, each)
    step = exact_step(body.u, body.v, body.a, ground, dt, body, own)
    if step.holds:
        body.change, body.rate, body.next_a = step.change, step.v, step.a
        # Where a rate changes by b all in all, a quantity strays by b dt / 4 from a line at most.
        spread = step.fastest - abs(body.a - ground.g)
        body.stray = 0.25 * dt * (dt * tangent(body) * step.fastest + body.damping * spread)
        each.order[b] = 0
        outside[COUNT] += 1.0
        outside[BEFORE] -= mass * body.a
        outside[AFTER] -= mass * step.a
        outside[STRAY] += mass * body.stray
    return step.holds
