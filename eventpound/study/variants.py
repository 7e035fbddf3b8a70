"""From rows of a study to the numbers of its scenes.

Dotted keys come first, then Π-terms: a term is met at the amplitude and period
of its own row. In a case written in Π-terms all of them hold in every row; in
another, what no term on an axis describes keeps its number.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from eventpound.case.defaults import default_duration
from eventpound.case.table import suggestion
from eventpound.errors import InputError
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Floats
from eventpound.numerics.distinct import distinct
from eventpound.scene.check import check_scene
from eventpound.scene.parameters import places_of, with_values
from eventpound.scene.pi_columns import ScaleColumns, numbers_with_terms, scale_columns
from eventpound.scene.pi_terms import of_all
from eventpound.scene.scene import Scene
from eventpound.study.axes import PI, values_of_rows
from eventpound.study.plan import Base

_MOST_CHECKED = 1000


@dataclass(frozen=True)
class Rows:
    """Variants of one scene.

    Parameters
    ----------
    base : Base
        What they have in common.
    values : mapping of str to ndarray, shape (n,)
        Values of the axes.
    numbers : mapping of str to ndarray, shape (n,)
        Numbers of the scene that differ, by dotted keys; at least one.
    scales : ScaleColumns or None
        a_g and omega_g of the motions.
    durations : ndarray, shape (n,)
        Lengths of the runs (s).
    """

    base: Base
    values: Mapping[str, Floats]
    numbers: Mapping[str, Floats]
    scales: ScaleColumns | None
    durations: Floats

    @property
    def count(self) -> int:
        """Number of variants."""
        return self.durations.size


def rows_of(base: Base, low: int, high: int) -> Rows:
    """Variants in the rows `low` to `high` of a scene.

    Raises
    ------
    InputError
        Where the ground motion refuses a number.
    """
    return _rows(base, values_of_rows(base.axes, low, high), high - low)


def _rows(base: Base, values: Mapping[str, Floats], count: int) -> Rows:
    scene = base.case.scene
    direct = {key: column for key, column in values.items() if not key.startswith(PI)}
    terms = _terms(base, values, direct)
    found = numbers_with_terms(scene, terms, direct) if terms else {}
    numbers = dict(direct)
    for key, column in found.items():
        numbers[key] = np.broadcast_to(np.asarray(column, float), (count,)).copy()
    if not numbers:
        body = scene.bodies[0]
        numbers = {f"body.{body.name}.mass": np.full(count, body.mass)}
    scales = scale_columns(scene, direct)
    return Rows(base, values, numbers, scales, _durations(base, numbers, scales, count))


def _terms(
    base: Base, values: Mapping[str, Floats], direct: Mapping[str, Floats]
) -> dict[str, float | Floats]:
    """Π-terms to be met; of a case written in them only those that change anything."""
    varied = {key.removeprefix(PI): v for key, v in values.items() if key.startswith(PI)}
    pi = base.case.pi
    if pi is None:
        return of_all(base.case.scene, varied)
    resolved = pi.structure.resolved(base.case.scene, {**pi.terms, **varied})
    if direct:
        return resolved
    return {key: value for key, value in resolved.items() if isinstance(value, np.ndarray)}


def _durations(
    base: Base, numbers: Mapping[str, Floats], scales: ScaleColumns | None, count: int
) -> Floats:
    """Lengths of the runs (s)."""
    case, pi = base.case, base.case.pi
    if pi is not None and pi.periods is not None and scales is not None:
        lengths = np.asarray(pi.periods * (2.0 * np.pi / scales.omega_g))
        return np.broadcast_to(lengths, (count,)).copy()
    kinds: tuple[str, ...] = ("excitation",)
    if isinstance(case.scene.motion, Record):
        kinds = ("excitation", "body", "spring")
    places = places_of(case.scene)
    deciding = {places[key]: v for key, v in numbers.items() if places[key].kind in kinds}
    if base.own_duration or not deciding:
        return np.full(count, case.run.duration)
    first, which = distinct(list(deciding.values()), count)
    lengths = np.array(
        [
            default_duration(
                with_values(case.scene, {p: float(v[i]) for p, v in deciding.items()}),
                case.run.start_time,
            )
            for i in first.tolist()
        ]
    )
    return lengths[which]


def scene_of_row(rows: Rows, i: int) -> Scene:
    """Scene of one variant."""
    scene, places = rows.base.case.scene, places_of(rows.base.case.scene)
    return with_values(scene, {places[key]: float(v[i]) for key, v in rows.numbers.items()})


def check_axes(base: Base) -> Iterator[str]:
    """What is wrong with values of the axes, each by itself with the first ones of the others.

    Parameters
    ----------
    base : Base
        A scene and its axes; of a long axis only the ends are looked at.
    """
    places = places_of(base.case.scene)
    unknown = [a.key for a in base.axes if not a.key.startswith(PI) and a.key not in places]
    for key in unknown:
        yield f"[[study.axis]] ({key}): unknown key{suggestion(key, list(places))}"
    if unknown:
        return
    first = {axis.key: axis.values[:1] for axis in base.axes}
    for axis in base.axes:
        values = axis.values if axis.values.size <= _MOST_CHECKED else axis.values[[0, -1]]
        for value in values:
            try:
                # What is too large becomes a number that is not finite, which is refused.
                with np.errstate(all="ignore"):
                    rows = _rows(base, first | {axis.key: np.array([value])}, 1)
                check_scene(scene_of_row(rows, 0))
            except InputError as error:
                yield f"[[study.axis]] ({axis.key}): value {float(value)!r}: {error.problems[0]}"
                break
