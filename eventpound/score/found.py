"""Numbers of an answer: extremes, final values, stated moments, overlap, energy from nowhere."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from eventpound.score.answer import Motion, nearest_rows
from eventpound.score.levels import CLOSED, CREATED, LEVELS, Floats
from eventpound.score.pairing import Event
from eventpound.score.problem import Problem


def values_of(
    problem: Problem, history: Motion, crests: _Crests
) -> tuple[dict[str, float], list[str]]:
    """Numbers of a history by their names in the answer, and what it cannot say."""
    values: dict[str, float] = {}
    left_out = []
    scale = {row[0]: row[4] for row in problem.answer["quantities"]}
    coarse = []
    for i, body in enumerate(problem.bodies):
        size = scale.get(f"peaks.{body}.max", scale.get(f"peaks.{body}.min", problem.length))
        if crests.beyond[i] > LEVELS["engineering"] * size:
            coarse.append(body)
            continue
        extremes = crests.highest, crests.lowest, *crests.when
        for key, of_bodies in zip(("max", "min", "t_max", "t_min"), extremes, strict=True):
            values[f"peaks.{body}.{key}"] = float(of_bodies[i])
    if coarse:
        left_out.append(
            f"peaks of {', '.join(coarse[:5])}: the rows are too far apart to tell them; "
            "judged are the final values, the history at the stated moments and, with velocities, "
            "the impacts"
        )
    for i, body in enumerate(problem.bodies):
        values[f"final.{body}.u"] = float(history.u[-1, i])
        if history.v is not None:
            values[f"final.{body}.v"] = float(history.v[-1, i])
    if history.v is None:
        left_out.append("final velocities: there are no columns v.<body>")
    for k, column in enumerate(problem.z_columns):
        if history.z is not None:
            values[f"final.{column[2:]}.z"] = float(history.z[-1, k])
    if problem.z_columns and history.z is None:
        left_out.append(f"hysteretic variables: there are no columns {problem.z_columns[0]} ...")
    moments = np.array(problem.given["moments"])
    for k, row in enumerate(nearest_rows(history.t, moments)):
        for i, body in enumerate(problem.bodies):
            values[f"history.{k}.{body}"] = float(history.u[row, i])
    return values, left_out


@dataclass(frozen=True)
class _Crests:
    """Extremes of every body, shape (N,), and by how much rows alone miss them (m)."""

    highest: Floats
    lowest: Floats
    when: tuple[Floats, Floats]
    beyond: Floats


def crests_of(history: Motion, impacts: list[Event] | None) -> _Crests:
    """Extremes of the rows and of the cubics between them, but where an impact lies between."""
    t, u, v = history.t, history.u, history.v
    high, low = np.argmax(u, axis=0), np.argmin(u, axis=0)
    columns = np.arange(u.shape[1])
    highest, lowest = u[high, columns].copy(), u[low, columns].copy()
    when = (t[high].copy(), t[low].copy())
    beyond = np.zeros(u.shape[1])
    if v is None:
        for i in columns:
            beyond[i] = max(_sag(t, u[:, i], int(high[i])), _sag(t, u[:, i], int(low[i])))
        return _Crests(highest, lowest, when, beyond)
    h = np.diff(t)
    struck = _struck(t, impacts)
    for i in columns:
        turning = np.flatnonzero((h > 0.0) & ~struck & (v[:-1, i] * v[1:, i] < 0.0))
        for k in turning:
            s, value = _crest(h[k], u[k, i], u[k + 1, i], v[k, i], v[k + 1, i])
            up = v[k, i] > 0.0
            best = highest if up else lowest
            if value > best[i] if up else value < best[i]:
                beyond[i] = max(beyond[i], abs(value - u[[k, k + 1], i]).max())
                best[i], when[0 if up else 1][i] = value, t[k] + s * h[k]
    # A row lies below a crest by θ²/8 of it at least, on one side; the cubic errs by θ⁴/384.
    size = np.maximum(np.abs(highest), np.abs(lowest))
    beyond = beyond**2 / (6.0 * np.where(size > 0.0, size, 1.0))
    return _Crests(highest, lowest, when, beyond)


def _struck(t: Floats, impacts: list[Event] | None) -> Floats:
    """Intervals between rows, shape (n - 1,), in or beside which an impact lies."""
    struck = np.zeros(t.size - 1, dtype=bool)
    for impact in impacts or []:
        at = int(np.searchsorted(t, impact.t, side="right")) - 1
        struck[max(at - 1, 0) : at + 2] = True
    return struck


def _crest(h: float, u0: float, u1: float, v0: float, v1: float) -> tuple[float, float]:
    """Where, in parts of the step h, and how high the cubic turns whose ends move against."""
    d = (u1 - u0) / h
    c2, c3 = h * (3.0 * d - 2.0 * v0 - v1), h * (v0 + v1 - 2.0 * d)
    # h v0 + 2 c2 s + 3 c3 s^2 = 0, the root between 0 and 1, without cancellation
    root = math.sqrt(max(c2 * c2 - 3.0 * c3 * h * v0, 0.0))
    q = -(c2 + math.copysign(root, c2))
    roots = [q / (3.0 * c3) if c3 else math.inf, h * v0 / q if q else math.inf]
    s = min((r for r in roots if 0.0 <= r <= 1.0), default=0.5)
    return s, u0 + s * (h * v0 + s * (c2 + s * c3))


def _sag(t: Floats, u: Floats, k: int) -> float:
    """What a crest beside a row may exceed it by (m): θ²/8 of it, by how far its neighbours lie."""
    sides = [abs(u[k] - u[j]) for j in (k - 1, k + 1) if 0 <= j < u.size and t[j] != t[k]]
    return float(sum(sides)) / 8.0


def created_energy_of(
    problem: Problem, history: Motion, impacts: list[Event] | None
) -> tuple[float | None, str]:
    """The largest rise of kinetic and elastic energy less all work done, part of its largest.

    Rows with an overlap are left out, where a contact element may hold energy of its own, and
    those beside an impact, where a program may write a velocity between the two; and it is looked
    at anew where the ground does between two rows what they do not show.
    """
    t, u, v = history.t, history.u, history.v
    springs = problem.given["springs"]
    if v is None:
        return None, "there are no velocities"
    if any(springs["strength"]) and history.z is None:
        return None, "there are no hysteretic variables"
    x = u @ problem.directions - np.array(springs["offset"])
    k = np.where(x < 0.0, springs["compression"], springs["extension"])
    stored = 0.5 * (v * v) @ problem.array("M") + 0.5 * (k * x * x).sum(axis=1)
    done, unsure = _work(problem, history, v)
    apart = (problem.gaps(u) >= -CLOSED * problem.length).all(axis=1)
    struck = _struck(t, impacts)
    apart[:-1] &= ~struck
    apart[1:] &= ~struck
    most = float(stored.max()) or 1.0
    if not apart.any():
        return None, "impacts or overlaps in every row"
    if unsure[-1] > most:
        return None, "the rows are too far apart"
    kept = (stored + done - unsure)[apart]
    parts = np.split(kept, np.searchsorted(np.flatnonzero(apart), _unseen(problem, t)))
    rise = max(float(np.max(part - np.minimum.accumulate(part), initial=0.0)) for part in parts)
    return rise / most, ""


def _work(problem: Problem, history: Motion, v: Floats) -> tuple[Floats, Floats]:
    """Work against ground, dashpots and hysteresis up to every row, and what it may be off by (J).

    By Simpson's rule on the cubics between the rows; off by a tenth of what the trapezoid rule
    makes of it otherwise.
    """
    t, u, z = history.t, history.u, history.z
    yielding = problem.directions[:, problem.hysteretic]
    strength = np.array(problem.given["springs"]["strength"])[problem.hysteretic]

    def power(t: Floats, v: Floats, z: Floats | None) -> Floats:
        p = problem.power(t, v) + np.einsum("ni,ij,nj->n", v, problem.array("C"), v)
        return p if z is None else p + ((v @ yielding) * z) @ strength

    first = np.flatnonzero(np.diff(t) > 0.0)
    last = first + 1
    h = t[last] - t[first]
    v_mid = 1.5 * (u[last] - u[first]) / h[:, None] - 0.25 * (v[first] + v[last])
    z_mid = None if z is None else 0.5 * (z[first] + z[last])
    # A jump of the ground at a row belongs to the other side of it.
    begins, ends = (
        power(t[rows] + side * 1e-9 * h, v[rows], None if z is None else z[rows])
        for rows, side in ((first, 1.0), (last, -1.0))
    )
    middle = power(0.5 * (t[first] + t[last]), v_mid, z_mid)
    simpson = h * (begins + 4.0 * middle + ends) / 6.0
    sums = np.zeros((2, t.size))
    sums[0, last] = simpson
    sums[1, last] = 0.1 * np.abs(simpson - 0.5 * h * (begins + ends))
    return np.cumsum(sums[0]), np.cumsum(sums[1])


def _unseen(problem: Problem, t: Floats) -> Floats:
    """Rows before which the ground does what a parabola through three of its values misses."""
    parts = (1e-9, 0.25, 0.5, 0.75, 1.0 - 1e-9)
    unseen = np.zeros(t.size - 1, dtype=bool)
    at = [problem.ground(t[:-1] + part * np.diff(t)) for part in parts]
    for component in zip(*at, strict=True):
        first, near, middle, far, last = component
        off = np.maximum(
            np.abs(near - (3.0 * first + 6.0 * middle - last) / 8.0),
            np.abs(far - (3.0 * last + 6.0 * middle - first) / 8.0),
        )
        unseen |= off > CREATED * np.max(np.abs(component), initial=0.0)
    return np.flatnonzero(unseen) + 1
