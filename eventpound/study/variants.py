"""From rows of a study to the numbers of its scenes.

Dotted keys come first, then Π-terms: a term is met at the amplitude and period
of its own row. In a case written in Π-terms all of them hold in every row; in
another, what no term on an axis describes keeps its number.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from eventpound.case.defaults import default_duration
from eventpound.case.table import suggestion
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.scene.check import check_scene
from eventpound.scene.parameters import places_of, with_values
from eventpound.scene.pi_columns import ScaleColumns, numbers_with_terms, scale_columns
from eventpound.scene.pi_terms import of_all
from eventpound.scene.scene import Scene
from eventpound.study.axes import PI, values_of_rows
from eventpound.study.plan import Base
from eventpound.sweep import Columns, default_lengths

_MOST_CHECKED = 1000


@dataclass(frozen=True)
class Rows(Columns):
    """Variants of one scene, which `numbers`, `lengths` and motions make.

    Parameters
    ----------
    base : Base
        What they have in common.
    values : mapping of str to ndarray, shape (n,)
        Values of the axes.
    at : range
        Their rows of the scene.
    """

    base: Base = field(kw_only=True)
    values: Mapping[str, Floats] = field(kw_only=True)
    at: range = field(kw_only=True)


def rows_of(base: Base, low: int, high: int) -> Rows:
    """Variants in the rows `low` to `high` of a scene.

    Raises
    ------
    InputError
        Where a record cannot be read, or the ground motion refuses a number.
    """
    values = axis_values(base, low, high)
    if not base.records:
        return _rows(base, values, range(low, high))
    parts, size = [], base.size_of_record
    first, last = low // size, (high - 1) // size
    for number in range(first, last + 1):
        at = range(max(low, number * size), min(high, (number + 1) * size))
        own = slice(at.start - low, at.stop - low)
        under = base.under(base.records[number])
        parts.append(_rows(under, {key: column[own] for key, column in values.items()}, at))
    return _joined(base, values, parts)


def axis_values(base: Base, low: int, high: int) -> dict[str, Floats]:
    """Values of the axes in the rows `low` to `high` of a scene."""
    return values_of_rows(base.axes, np.arange(low, high) % base.size_of_record)


def _joined(base: Base, values: Mapping[str, Floats], parts: Sequence[Rows]) -> Rows:
    """Rows under several records, one after the other."""
    first, counts = parts[0], [part.count for part in parts]
    # A record may have no scales.
    scales = [part.scales or ScaleColumns(np.nan, np.nan) for part in parts]
    pairs = zip(scales, counts, strict=True)
    of_rows = [(np.broadcast_to(s.a_g, n), np.broadcast_to(s.omega_g, n)) for s, n in pairs]
    return Rows(
        first.case,
        {key: np.concatenate([part.numbers[key] for part in parts]) for key in first.numbers},
        np.concatenate([part.lengths for part in parts if part.lengths is not None]),
        [part.scene.motion for part in parts],
        np.repeat(np.arange(len(parts)), counts),
        ScaleColumns(*(np.concatenate(columns) for columns in zip(*of_rows, strict=True))),
        base=base,
        values=values,
        at=range(first.at.start, parts[-1].at.stop),
    )


def _rows(base: Base, values: Mapping[str, Floats], at: range) -> Rows:
    scene, count = base.case.scene, len(at)
    direct = {key: column for key, column in values.items() if not key.startswith(PI)}
    terms = _terms(base, values, direct)
    found = numbers_with_terms(scene, terms, direct) if terms else {}
    numbers = dict(direct)
    for key, column in found.items():
        numbers[key] = np.broadcast_to(np.asarray(column, float), (count,)).copy()
    scales = scale_columns(scene, direct)
    lengths = _lengths(base, numbers, scales, count)
    return Rows(base.case, numbers, lengths, scales=scales, base=base, values=values, at=at)


def _terms(
    base: Base, values: Mapping[str, Floats], direct: Mapping[str, Floats]
) -> dict[str, float | Floats]:
    """Π-terms to be met; of a case written in them only those that change anything."""
    varied = {key.removeprefix(PI): v for key, v in values.items() if key.startswith(PI)}
    pi = base.case.pi
    if pi is None and not varied:
        return {}
    if pi is None:
        return of_all(base.case.scene, varied)
    resolved = pi.structure.resolved(base.case.scene, {**pi.terms, **varied})
    if direct:
        return resolved
    return {key: value for key, value in resolved.items() if isinstance(value, np.ndarray)}


def _lengths(
    base: Base, numbers: Mapping[str, Floats], scales: ScaleColumns | None, count: int
) -> Floats:
    """Lengths of the runs (s)."""
    case, pi = base.case, base.case.pi
    if pi is not None and pi.periods is not None and scales is not None:
        periods = np.asarray(pi.periods * (2.0 * np.pi / scales.omega_g))
        return np.broadcast_to(periods, (count,)).copy()
    if base.own_duration:
        return np.full(count, case.run.duration)
    start, own = case.run.start_time, case.run.duration
    if math.isnan(own):
        try:
            own = default_duration(case.scene, start)
        except InputError as error:
            raise InputError([f"duration: {problem}" for problem in error.problems]) from error
    return default_lengths(case.scene, start, numbers, np.full(count, own))


def scene_of_row(rows: Rows, i: int) -> Scene:
    """Scene of one variant."""
    scene, places = rows.scene, places_of(rows.scene)
    if rows.motion_of is not None:
        scene = replace(scene, motion=rows.motions[rows.motion_of[i]])
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
                    rows = _rows(base, first | {axis.key: np.array([value])}, range(1))
                check_scene(scene_of_row(rows, 0))
            except InputError as error:
                yield f"[[study.axis]] ({axis.key}): value {float(value)!r}: {error.problems[0]}"
                break
