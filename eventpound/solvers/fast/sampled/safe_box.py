"""The safe box: distances of bodies within which nothing of note happens to them.

Between two events all that limits a linear motion – contacts, kinks, borders of the
backbone, the extremes so far – are bounds of the distances of two bodies, the ground among
them; hysteretic links that unload or yield without hardening also keep a direction. Taken
together for each pair, they make a step that stays inside cheap to recognise. It is sufficient
only: a step that leaves its box is judged piece by piece (`sampled.bounds`).
"""

from __future__ import annotations

import numpy as np

from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.extremes import start_of
from eventpound.solvers.fast.links import CORE, ends_of_line
from eventpound.solvers.fast.run import FastPlan, FastRun, FastState
from eventpound.solvers.fast.sampled.exact import SampleTables
from eventpound.tolerances import OWN_GAP


@compiled
def set_safe_box(tables: SampleTables, run: FastRun) -> None:
    """Bounds of all distances: those of the pair (b, c), b < c, of ``u_c - u_b``; (b, b): u_b."""
    plan, state, running = run.plan, run.state, run.running
    box, links, contacts, distances = tables.box, plan.links, plan.contacts, plan.distances
    n = plan.mass.size
    for b in range(n):
        for c in range(b, n):
            box.low[b, c], box.high[b, c], box.way[b, c] = -np.inf, np.inf, 0.0
    for k in range(distances.first.size):
        i, start = running.at.gap + k, start_of(k, contacts)
        low, high = running.minimum[i] - start, running.maximum[i] - start
        _narrow(distances.first[k], distances.second[k], low, high, 0.0, tables)
    for a in range(links.offset.size):
        low, high, way = _box_of_link(a, plan, state)
        _narrow(links.ends[a, 0], links.ends[a, 1], low, high, way, tables)
    least = OWN_GAP * plan.limits.length
    for j in range(contacts.gap.size):
        low = least - contacts.gap[j]
        _narrow(contacts.left[j], contacts.right[j], low, np.inf, 0.0, tables)


@compiled
def _box_of_link(a: int, plan: FastPlan, state: FastState) -> tuple[float, float, float]:
    """Elongations (m) between which a link keeps branch and part; the direction it must keep."""
    low, high, way = -np.inf, np.inf, 0.0
    if state.branch[a] > 0:
        low = plan.links.offset[a]
    elif state.branch[a] < 0:
        high = plan.links.offset[a]
    h = plan.links.z_of_link[a]
    if h < 0:
        return low, high, way
    part, sigma, hysteresis = state.part[h], state.sigma[h], plan.hysteresis
    if part != CORE:
        way = sigma
    middle = state.x_r[h] - sigma * state.xi_r[h] * hysteresis.scale[h]
    start, end = ends_of_line(part, sigma, middle, hysteresis.core[h] * hysteresis.scale[h])
    return max(low, start), min(high, end), way


@compiled
def _narrow(
    first: int, second: int, low: float, high: float, way: float, tables: SampleTables
) -> None:
    """Keep the distance from one body to another, -1 for the ground, between two values (m)."""
    b, c, turned = first, second, False
    if first < 0:
        b = second
    elif second < 0:
        c, turned = first, True
    elif second < first:
        b, c, turned = second, first, True
    if turned:
        low, high, way = -high, -low, -way
    box = tables.box
    box.low[b, c], box.high[b, c] = max(box.low[b, c], low), min(box.high[b, c], high)
    if way * box.way[b, c] < 0.0:
        box.low[b, c] = np.inf
    elif way != 0.0:
        box.way[b, c] = way


@compiled
def stays_in_safe_box(n: int, h: float, state: FastState, tables: SampleTables) -> bool:
    """Whether a step of length h (s) of n bodies stays inside, by the bounds of their motion."""
    bodies, box = tables.bodies, tables.box
    for b in range(n):
        for c in range(b, n):
            now, then = state.u[c], bodies.next_u[c]
            rate, next_rate = state.v[c], bodies.next_v[c]
            sag, fastest = bodies.sag[c], bodies.fastest[c]
            if c > b:
                now, then = now - state.u[b], then - bodies.next_u[b]
                rate, next_rate = rate - state.v[b], next_rate - bodies.next_v[b]
                sag, fastest = sag + bodies.sag[b], fastest + bodies.fastest[b]
            if not (
                max(now, then) + sag <= box.high[b, c] and min(now, then) - sag >= box.low[b, c]
            ):
                return False
            way = box.way[b, c]
            if way != 0.0 and not (
                way * rate > 0.0
                and way * next_rate > 0.0
                and abs(rate) + abs(next_rate) > h * fastest
            ):
                return False
    return True
