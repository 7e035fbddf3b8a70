"""Answers of the program of `plan` as the oracle gives them: peaks, events, states at moments.

A run is made twice, in stretches of two lengths; what these differ by is the uncertainty. Within
a stretch a coordinate is the quintic through displacement, velocity and acceleration at both ends.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Sequence
from decimal import Decimal
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from eventpound.scene import Scene
from eventpound.scene.joint import Joint
from tests.oracle.pieces import Event, Floats, march
from tests.oracle.plan import STEPS, LeftAloneError, Plan, plan_of
from tests.oracle.program import Answer, NoAnswerError, Number, OracleEvent

STRETCHES = 1600, 2300
"""Parts of a run, of its two solutions."""
_CLOSED, _STILL, _OVERLAP = 1e-10, 1e-10, 1e-15
_KINDS = {"s": "stick", "+": "slip-forward", "-": "slip-backward"}


class Found(NamedTuple):
    """Numbers by name, and events: kind, contact, time, rate of the gap before."""

    values: dict[str, float]
    events: list[tuple[str, int, float, float]]


class Recorder:
    """A plan whose stretches and events are kept, with what makes its coordinates lengths."""

    def __init__(self, plan: Plan, unit: Floats, t: float, y: Floats) -> None:
        self.plan, self.unit = plan, unit
        self.events_found = list[tuple[str, int, float, float]]()
        self.stretches = list[tuple[float, Floats, Floats, float, Floats, Floats]]()
        self._begin(t, y)

    def _begin(self, t: float, y: Floats) -> None:
        self.began = t, y, self.rate(t, y)

    def rate(self, t: float, y: Floats) -> Floats:
        """y'."""
        return self.plan.rate(t, y)

    def events(self) -> list[Event]:
        """What ends a stretch."""
        return self.plan.events()

    def happened(self, t: float, y: Floats, owners: list[Any]) -> Floats:
        """The state after that."""
        self.stretches.append((*self.began, t, y, self.rate(t, y)))
        state = self.plan.state
        after = self.plan.happened(t, y, owners)
        q, v = np.split(y, 2)
        gaps, rates = self.plan.gap + self.plan.W @ q, self.plan.W @ v
        for j, (was, now) in enumerate(zip(state, self.plan.state, strict=True)):
            if owners and abs(gaps[j]) < _CLOSED and rates[j] < -_STILL:
                self.events_found.append(("impact", j, t, float(rates[j])))
            if was == now:
                continue
            if "o" in (was, now):
                self.events_found.append(("detachment" if now == "o" else "rest", j, t, 0.0))
            if now in _KINDS and self.plan.friction[j] > 0.0:
                self.events_found.append((_KINDS[now], j, t, 0.0))
        self._begin(t, after)
        return after


def joints_of(folder: Path) -> list[Joint]:
    """Joints of a case, as its file has them."""
    tables = tomllib.loads((folder / "case.toml").read_text(encoding="utf-8"))["joint"]
    return [
        Joint(
            t.get("name", "-".join(t["between"])),
            tuple(t["between"]),
            tuple(t["gap"]) if isinstance(t["gap"], list) else t["gap"],
            t["restitution"],
            t.get("friction", 0.0),
        )
        for t in tables
    ]


def ask_plan(
    scene: Scene, joints: list[Joint], span: tuple[float, float], moments: Sequence[float]
) -> Answer:
    """What the program says of a scene with decks that runs over a span (s).

    Raises
    ------
    NoAnswerError
        Where it leaves the scene alone, or finds other events in other stretches.
    """
    try:
        first, second = (_found(scene, joints, span, moments, parts) for parts in STRETCHES)
    except LeftAloneError:
        raise NoAnswerError("impacts follow each other too fast") from None
    if [e[:2] for e in first.events] != [e[:2] for e in second.events]:
        raise NoAnswerError("two settings find other events")

    def number(a: float, b: float) -> Number:
        return Number(Decimal(b), abs(a - b))

    return Answer(
        {key: number(first.values[key], value) for key, value in second.values.items()},
        tuple(
            OracleEvent(kind, j, {"t": number(e[2], t), "before": number(e[3], before)})
            for e, (kind, j, t, before) in zip(first.events, second.events, strict=True)
        ),
    )


def _found(
    scene: Scene,
    joints: list[Joint],
    span: tuple[float, float],
    moments: Sequence[float],
    parts: int,
) -> Found:
    model = recorded(scene, joints, span, moments, parts)
    rows = {t: y for _, _, _, t, y, _ in model.stretches}
    n, unit = model.unit.size, model.unit
    values: dict[str, float] = {}
    for i, body in enumerate(scene.bodies):
        for key, (value, t) in _peaks(model, i).items():
            values[f"peaks.{body.name}.{key}"] = unit[i] * value
            values[f"peaks.{body.name}.t_{key}"] = t
        values[f"final.{body.name}.u"] = unit[i] * rows[span[1]][i]
        values[f"final.{body.name}.v"] = unit[i] * rows[span[1]][n + i]
        for k, moment in enumerate(moments):
            values[f"history.{k}.{body.name}"] = unit[i] * rows[moment][i]
    return Found(values, model.events_found)


def recorded(
    scene: Scene,
    joints: list[Joint],
    span: tuple[float, float],
    moments: Sequence[float],
    parts: int,
) -> Recorder:
    """A run over a span (s) in so many stretches, others ending at moments and breaks."""
    plan = plan_of(scene, joints)
    plan.overlap = _OVERLAP
    unit = np.ones(plan.mass.size)
    unit[2::3] = [math.sqrt(J / m) for m, J in plan.mass.reshape(-1, 3)[:, 1:]]
    start = [b.displacement for b in scene.bodies] + [b.velocity for b in scene.bodies]
    y = np.array(start) / np.concatenate((unit, unit))
    plan.decide(span[0], y, set(), {})
    model = Recorder(plan, unit, span[0], y)
    borders = {
        border
        for motion in plan.motions
        for piece in motion.pieces()
        for border in (piece.start, piece.end)
        if span[0] < border < span[1]
    }
    stops = sorted({*np.linspace(*span, parts + 1).tolist(), *moments, *borders})
    march(model, y, stops, **STEPS)
    return model


def _peaks(model: Recorder, i: int) -> dict[str, tuple[float, float]]:
    """Largest and smallest value of a coordinate, and when, to the last bit the first."""
    n, found = model.plan.mass.size, list[tuple[float, float]]()
    for t_0, y_0, rate_0, t_1, y_1, rate_1 in model.stretches:
        found += [(y_0[i], t_0), (y_1[i], t_1)]
        if y_0[n + i] * y_1[n + i] < 0.0:
            h = t_1 - t_0
            quintic = _quintic(
                h, *((y[i], y[n + i], r[n + i]) for y, r in ((y_0, rate_0), (y_1, rate_1)))
            )
            roots = np.roots(np.polyder(quintic))
            inside = [x.real for x in roots if abs(x.imag) < 1e-12 and 0.0 < x.real < 1.0]
            found += [(float(np.polyval(quintic, s)), t_0 + s * h) for s in inside]
    return {
        "max": max(found, key=lambda pair: pair[0]),
        "min": min(found, key=lambda pair: pair[0]),
    }


def _quintic(
    h: float, begins: tuple[float, float, float], ends: tuple[float, float, float]
) -> Floats:
    """Coefficients, the highest first, over s = 0 to 1 with u, v and a at both ends."""
    (u, v, a), (u_1, v_1, a_1) = ((x, h * y, h * h * z) for x, y, z in (begins, ends))
    d, dv, da = u_1 - u - v - 0.5 * a, v_1 - v - a, a_1 - a
    return np.array([
        6.0 * d - 3.0 * dv + 0.5 * da, -15.0 * d + 7.0 * dv - da, 10.0 * d - 4.0 * dv + 0.5 * da,
        0.5 * a, v, u,
    ])  # fmt: skip
