"""Which of many numbers of a scene have to be checked, so that all of them are.

Every condition of `eventpound.scene.check` holds a number in a range, so the smallest and the
largest of a column tell of all others, and what lies between two that were accepted is. Numbers
that meet in one condition are checked together. The conditions stand there alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.distinct import distinct
from eventpound.scene.check import TOGETHER, check_scene
from eventpound.scene.contact import BARRIER
from eventpound.scene.ends import opening
from eventpound.scene.parameters import Place, value_at, with_values
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND
from eventpound.scene.stability import may_soften


def variants_to_check(scene: Scene, values: Mapping[Place, Floats], count: int) -> Ints:
    """Variants of which one is wrong where any is, in their order.

    Parameters
    ----------
    scene : Scene
        A checked scene.
    values : mapping
        Columns of finite numbers, each of shape (count,).
    count : int
        Number of variants.
    """
    if scene.supports:
        # Where these are as a run begins, only the whole variant says.
        return np.arange(count)
    rows = [np.zeros(0, np.int64)]
    rows += [np.array((np.argmin(each), np.argmax(each))) for each in values.values()]
    meeting: dict[str | int, list[Floats]] = {}
    for place, column in values.items():
        if (what := _meets(scene, place, float(column.min()))) is not None:
            meeting.setdefault(what, []).append(column)
    rows += [distinct(columns, count)[0] for columns in meeting.values()]
    if any(place.kind in ("body", "contact") for place in values):
        rows += [np.flatnonzero(gap < 0.0) for gap in _openings(scene, values, count)]
    return np.unique(np.concatenate(rows))


def _meets(scene: Scene, place: Place, least: float) -> str | int | None:
    """With which others a number of at least this meets in a condition; None where with none."""
    if place.kind == "dashpot":
        driving = least < 0.0 or any(dashpot.coefficient < 0.0 for dashpot in scene.dashpots)
        return "dashpots" if driving else None
    if place.kind != "spring":
        return None
    if may_soften(scene) or (least < 0.0 and place.field == "stiffness"):
        return "springs"
    return place.index if place.field in TOGETHER else None


def _openings(scene: Scene, values: Mapping[Place, Floats], count: int) -> Iterator[Floats]:
    """Openings of each contact at the start (m), shape (count,)."""

    def column(kind: str, index: int, field: str) -> Floats:
        place = Place(kind, index, field)
        given = values[place] if place in values else value_at(scene, place)
        return np.broadcast_to(np.asarray(given, float), count)

    at: dict[str, Floats | float] = {BARRIER: 0.0, GROUND: 0.0}
    at |= {b.name: column("body", i, "displacement") for i, b in enumerate(scene.bodies)}
    for i, contact in enumerate(scene.contacts):
        yield np.asarray(opening(contact, column("contact", i, "gap"), at))


class CheckedRanges:
    """Numbers of a scene one by one, between values with which it can be computed.

    Parameters
    ----------
    scene : Scene
        A checked scene.
    start : float
        When its runs start (s).
    """

    def __init__(self, scene: Scene, start: float) -> None:
        self._scene, self._start = scene, start
        self._ranges: dict[Place, tuple[float, float]] = {}
        shut = enumerate(zip(scene.contacts, _openings(scene, {}, 1), strict=True))
        self._least = {
            Place("contact", i, "gap"): contact.gap - float(gap[0]) for i, (contact, gap) in shut
        }

    def check(self, values: Mapping[Place, float]) -> None:
        """Refuse the scene with other numbers, none of its motion, as `check_scene` does."""
        if all(map(self._is_known, values, values.values())):
            return
        check_scene(with_values(self._scene, values), self._start)
        for place, value in values.items():
            if (own := value_at(self._scene, place)) is not None:
                low, high = self._ranges.get(place, (own, own))
                reach = value if low <= value <= high else self._reach(place, value, low, high)
                self._ranges[place] = min(low, reach), max(high, reach)

    def _reach(self, place: Place, value: float, low: float, high: float) -> float:
        """A value as far again beyond a range, where it can be, so that sweeps ask rarely."""
        reach = 2.0 * value - (low if value > high else high)
        try:
            check_scene(with_values(self._scene, {place: reach}), self._start)
        except InputError:
            return value
        return reach

    def _is_known(self, place: Place, value: float) -> bool:
        low, high = self._ranges.get(place, (math.inf, -math.inf))
        # Where numbers meet in one condition, only all of them say.
        if not low <= value <= high or self._scene.supports or place.field == "displacement":
            return False
        return value >= self._least.get(place, low) and _meets(self._scene, place, low) is None
