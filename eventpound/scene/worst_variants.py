"""Which of many variants of a scene tell whether all of them can be computed.

Every condition of `eventpound.scene.check` holds a number in a range, so the smallest and the
largest of each column tell of all others. Where numbers meet in one condition, the variants that
it may not hold of are found from whole columns. The conditions stand there alone.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.distinct import distinct
from eventpound.scene.check import WITHIN_BOUND, check_scene
from eventpound.scene.contact import BARRIER, opening
from eventpound.scene.parameters import Place, value_at, with_values
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND
from eventpound.scene.stability import may_soften


def worst_variants(scene: Scene, values: Mapping[Place, Floats], count: int) -> Ints:
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
    rows = [np.flatnonzero(_penetrated(scene, values, count))]
    rows += [np.array((np.argmin(each), np.argmax(each))) for each in values.values()]
    shapes: dict[int, list[Floats]] = {}
    for place, column in values.items():
        if place.kind == "spring" and place.field in WITHIN_BOUND:
            shapes.setdefault(place.index, []).append(column)
        elif place.kind == "spring" and (may_soften(scene) or column.min() < 0.0):
            shapes.setdefault(-2, []).append(column)
        elif place.kind == "dashpot" and (column.min() < 0.0 or _any_negative(scene)):
            shapes.setdefault(-1, []).append(column)
    rows += [distinct(columns, count)[0] for columns in shapes.values()]
    return np.unique(np.concatenate(rows))


def _any_negative(scene: Scene) -> bool:
    """Whether its dashpots are accepted only together."""
    return any(dashpot.coefficient < 0.0 for dashpot in scene.dashpots)


def _penetrated(scene: Scene, values: Mapping[Place, Floats], count: int) -> np.ndarray:
    """Where a contact is closed by more than nothing at the start, rounding included, (count,)."""

    def column(kind: str, index: int, field: str) -> Floats:
        place = Place(kind, index, field)
        given = values[place] if place in values else value_at(scene, place)
        return np.asarray(given, float)

    found = np.zeros(count, np.bool_)
    if any(place.field in ("gap", "displacement") for place in values):
        at: dict[str, Floats | float] = {BARRIER: 0.0, GROUND: 0.0}
        at |= {b.name: column("body", i, "displacement") for i, b in enumerate(scene.bodies)}
        for i, contact in enumerate(scene.contacts):
            found |= opening(contact, column("contact", i, "gap"), at) < 0.0
    return found


class KnownRanges:
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
        at = {b.name: b.displacement for b in scene.bodies} | {BARRIER: 0.0, GROUND: 0.0}
        self._openings = [float(opening(contact, 0.0, at)) for contact in scene.contacts]

    def check(self, values: Mapping[Place, float]) -> None:
        """Refuse the scene with other numbers, none of its motion, as `check_scene` does."""
        if all(map(self._is_known, values, values.values())):
            return
        check_scene(with_values(self._scene, values), self._start)
        for place, value in values.items():
            own = value_at(self._scene, place)
            if own is not None:
                self._widen(place, value, *self._ranges.get(place, (own, own)))

    def _widen(self, place: Place, value: float, low: float, high: float) -> None:
        """Take a value into a range, and one as far again beyond it, if that can be computed."""
        if not low <= value <= high:
            probe = 2.0 * value - (low if value > high else high)
            try:
                check_scene(with_values(self._scene, {place: probe}), self._start)
            except InputError:
                probe = value
            low, high = min(low, probe), max(high, probe)
        self._ranges[place] = low, high

    def _is_known(self, place: Place, value: float) -> bool:
        low, high = self._ranges.get(place, (math.inf, -math.inf))
        # Where numbers meet in one condition, only all of them say.
        if not low <= value <= high or self._scene.supports or place.field == "displacement":
            return False
        if place.field == "gap":
            return value + self._openings[place.index] >= 0.0
        if place.kind == "dashpot":
            return min(value, low) >= 0.0 and not _any_negative(self._scene)
        if place.kind == "spring" and (place.field in WITHIN_BOUND or may_soften(self._scene)):
            return False
        return place.field != "stiffness" or value >= 0.0
