"""Kinks of contact laws in the Taylor stepper: ends of approach, zeros of forces that are cut.

A law keeps to its side of the kink, so that its series is that of a smooth force, and the step ends
where it leaves it.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.contact_elements import APPROACH_CODE, CUT_CODE
from eventpound.mechanics.contact_laws import side_of_kink
from eventpound.solvers.events import noise
from eventpound.solvers.events.law_contacts import DRAG, WAY
from eventpound.solvers.fast.compiled import compiled, compiled_deferred
from eventpound.solvers.fast.elongation import elongation
from eventpound.solvers.fast.run import Run
from eventpound.solvers.fast.search import (
    bound_of_pair,
    distance_coefficient,
    first_fall,
    relative,
    stays_above,
)


@compiled
def _still(p: int, run: Run) -> float:
    """What of `side_of_kink` has no sign: of a rate (m/s), or of a force (N)."""
    links, limits = run.plan.links, run.plan.limits
    speed = noise.SPEED * limits.length / limits.time
    a = links.plain + p
    if int(links.law.exponent[a]) != CUT_CODE:
        return speed
    return links.compression[a] * noise.LENGTH * limits.length + run.series.drag[p] * speed


@compiled_deferred
def keep_side(p: int, run: Run) -> None:
    """Let the law of a closed element keep to the side of its kink on which it is."""
    links, touch, state = run.plan.links, run.plan.laws.touch, run.state
    a = links.plain + p
    code = int(links.law.exponent[a])
    if code != APPROACH_CODE and code != CUT_CODE:
        return
    run.series.drag[p] = touch[DRAG, p]
    x, x_rate = elongation(links.ends[a, 0], links.ends[a, 1], state.u, state.v)
    k = links.compression[a]
    side = side_of_kink(code, k, -k * links.offset[a], touch[DRAG, p], x, x_rate)
    if abs(side) > _still(p, run):
        touch[WAY, p] = 1.0 if side > 0.0 else -1.0


@compiled_deferred
def first_law_kink(order: int, limit: float, run: Run) -> tuple[float, float]:
    """When a law first leaves its side, up to `limit` (s), or inf; and which."""
    first, which = np.inf, 0
    for p in range(run.series.drag.size):
        a, way = run.plan.links.plain + p, run.series.way[p]
        head, tail = run.series.ends[a, 0], run.series.ends[a, 1]
        if run.state.branch[a] < 0 and way != 0.0 and head != tail:
            tau = _leaves_side(p, a, way, order, limit, run)
            if tau < first:
                first, which = tau, p
    return first, float(which)


@compiled
def _leaves_side(p: int, a: int, way: float, order: int, limit: float, run: Run) -> float:
    links, series = run.plan.links, run.series
    head, tail, c = series.ends[a, 0], series.ends[a, 1], series.c
    cut = int(links.law.exponent[a]) == CUT_CODE
    if not cut:
        slope = 2.0 * way * distance_coefficient(head, tail, 2, series)
        bend = 3.0 * way * distance_coefficient(head, tail, 3, series)
        rest = bound_of_pair(head, tail, series.swing)
        if stays_above(way * series.x_rate[a], slope, bend, rest, limit):
            return np.inf
    k, drag = links.compression[a], series.drag[p]
    relative(head, tail, order, series, c)
    c[0], c[1] = series.x[a] - links.offset[a], series.x_rate[a]
    for i in range(order):
        rate = (i + 1) * c[i + 1]
        c[i] = way * (k * c[i] + drag * rate if cut else rate)
    still = _still(p, run)
    return first_fall(c, order, limit, still, still / run.plan.limits.time, series.work)


@compiled_deferred
def switch_laws(run: Run) -> None:
    """Let laws that have left their sides keep to the others."""
    for p in range(run.series.drag.size):
        if run.happened.switched[p]:
            run.plan.laws.touch[WAY, p] = -run.plan.laws.touch[WAY, p]
