"""From rows of a study to the numbers of its scenes.

Dotted keys come first, then Π-terms: a term is met at the amplitude and period
of its own row. In a case written in Π-terms all of them hold in every row; in
another, what no term on an axis describes keeps its number.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from eventpound.case.case import Case
from eventpound.case.defaults import default_duration
from eventpound.case.table import suggestion
from eventpound.errors import InputError
from eventpound.motion.base import GroundMotion
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Floats, Ints
from eventpound.scene.at_rest import at_rest
from eventpound.scene.check import check_scene
from eventpound.scene.parameters import number_places, told_of_variants, with_values
from eventpound.scene.periods import period_called
from eventpound.scene.pi_columns import ScaleColumns, numbers_with_terms, scale_columns
from eventpound.scene.pi_terms import of_all
from eventpound.scene.scene import Scene
from eventpound.study.axes import PI, values_of_rows
from eventpound.study.base import RECORD, Base

PSA_PERIOD = "excitation.psa_period"
"""Key of the period at which a record is scaled."""
_MOST_CHECKED = 1000
_MOST_SHOWN = 12
"""Keys that a message lists, at most."""


@dataclass(frozen=True)
class Rows:
    """Rows of a plan as numbers of their scenes.

    Parameters
    ----------
    base : Base
        What they have in common.
    values : mapping of str to ndarray, shape (n,)
        Values of the axes.
    at : range
        Their rows of the scene.
    numbers : mapping of str to ndarray, shape (n,)
        Numbers of the scene that differ, by their dotted keys.
    motions : sequence of GroundMotion
        Ground motions instead of the scene's, where they differ by more than numbers.
    motion_of : ndarray of int, shape (n,), optional
        Which of them each row has.
    lengths : ndarray, shape (n,), optional
        Lengths of the runs (s), once they are known.
    scales : ScaleColumns, optional
        Scales of the ground motions, where they have some.
    """

    base: Base
    values: Mapping[str, Floats]
    at: range
    numbers: Mapping[str, Floats]
    motions: Sequence[GroundMotion] = ()
    motion_of: Ints | None = None
    lengths: Floats | None = None
    scales: ScaleColumns | None = None

    @property
    def count(self) -> int:
        """How many."""
        return len(self.at)

    @property
    def case(self) -> Case:
        """How they are run."""
        return self.base.case

    @property
    def scene(self) -> Scene:
        """The scene that they vary."""
        return self.base.case.scene


def rows_of_base(base: Base, low: int, high: int) -> Rows:
    """Rows `low` to `high` of a scene.

    Raises
    ------
    InputError
        Where a record cannot be read, or the ground motion refuses a number.
    """
    values = axis_values(base, low, high)
    if not base.records:
        return complete(rows_with(base, values, range(low, high)))
    parts, size = [], base.size_of_record
    first, last = low // size, (high - 1) // size
    for number in range(first, last + 1):
        at = range(max(low, number * size), min(high, (number + 1) * size))
        own = slice(at.start - low, at.stop - low)
        under = base.under(base.records[number])
        part = rows_with(under, {key: column[own] for key, column in values.items()}, at)
        parts.append(complete(part))
    return _joined(base, values, parts)


def axis_values(base: Base, low: int, high: int) -> dict[str, Floats]:
    """Values of the axes in the rows `low` to `high` of a scene."""
    return values_of_rows(base.axes, np.arange(low, high) % base.size_of_record)


def axis_cells(base: Base, at: range) -> dict[str, Sequence[object]]:
    """The first columns of the table in some rows of a scene: words, record, axes."""
    cells: dict[str, Sequence[object]] = {
        name: [word] * len(at) for name, word in base.labels.items()
    }
    if base.records:
        cells[RECORD] = [base.records[row // base.size_of_record].name for row in at]
    values = axis_values(base, at.start, at.stop)
    return cells | {name: column.tolist() for name, column in values.items()}


def _joined(base: Base, values: Mapping[str, Floats], parts: Sequence[Rows]) -> Rows:
    """Rows under several records, one after the other."""
    counts = [part.count for part in parts]
    # A record may have no scales.
    scales = [part.scales or ScaleColumns(np.nan, np.nan) for part in parts]
    pairs = zip(scales, counts, strict=True)
    of_rows = [(np.broadcast_to(s.a_g, n), np.broadcast_to(s.omega_g, n)) for s, n in pairs]
    return replace(
        parts[0],
        base=replace(base, case=parts[0].case),
        values=values,
        at=range(parts[0].at.start, parts[-1].at.stop),
        numbers={k: np.concatenate([part.numbers[k] for part in parts]) for k in parts[0].numbers},
        motions=[part.scene.motion for part in parts],
        motion_of=np.repeat(np.arange(len(parts)), counts),
        lengths=np.concatenate([part.lengths for part in parts if part.lengths is not None]),
        scales=ScaleColumns(*(np.concatenate(columns) for columns in zip(*of_rows, strict=True))),
    )


def rows_with(base: Base, values: Mapping[str, Floats], at: range) -> Rows:
    """Rows with these values of the axes, under the motion of the scene."""
    scene = base.case.scene
    direct = {key: column for key, column in values.items() if not key.startswith(PI)}
    terms = _terms(base, values, direct)
    found = numbers_with_terms(scene, terms, direct) if terms else {}
    numbers = dict(direct)
    for key, column in found.items():
        numbers[key] = np.broadcast_to(np.asarray(column, float), (len(at),)).copy()
    return Rows(base, values, at, numbers | _own_periods(base.case, numbers, len(at)))


def _own_periods(case: Case, numbers: Mapping[str, Floats], count: int) -> dict[str, Floats]:
    """Periods (s) at which a record is scaled, where they are those of each variant itself."""
    scene, start = case.scene, case.run.start_time
    motion, places = scene.motion, number_places(scene)
    moving = {places[key]: column for key, column in numbers.items() if key in places}
    moving = {p: v for p, v in moving.items() if p.kind in kinds_that_set_periods(scene)}
    if not (isinstance(motion, Record) and moving) or PSA_PERIOD in numbers:
        return {}
    word = motion.psa_at

    def period(own: Scene) -> float:
        return period_called(at_rest(own, start), word)

    return {PSA_PERIOD: told_of_variants(scene, moving, count, period)}


def complete(rows: Rows) -> Rows:
    """Rows with what their motions decide: scales, and lengths that are not given.

    Raises
    ------
    InputError
        Where a motion refuses its numbers or sets no length.
    """
    known = rows.lengths is not None and rows.scales is not None
    if known or rows.motion_of is not None:
        return rows
    scales = scale_columns(rows.scene, rows.numbers)
    lengths = _lengths(rows, scales) if rows.lengths is None else rows.lengths
    return replace(rows, lengths=lengths, scales=scales)


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


def _lengths(rows: Rows, scales: ScaleColumns | None) -> Floats:
    """Lengths of the runs (s)."""
    case, count, pi = rows.case, rows.count, rows.case.pi
    if pi is not None and pi.periods is not None and scales is not None:
        periods = np.asarray(pi.periods * (2.0 * np.pi / scales.omega_g))
        return np.broadcast_to(periods, (count,)).copy()
    if rows.base.own_duration:
        return np.full(count, case.run.duration)
    scene, start, own = case.scene, case.run.start_time, case.run.duration
    if math.isnan(own):
        own = default_duration(scene, start)
    kinds = kinds_that_set_lengths(scene)
    places = number_places(scene) if rows.numbers else {}
    deciding = {places[key]: v for key, v in rows.numbers.items() if places[key].kind in kinds}
    if not deciding:
        return np.full(count, own)
    return told_of_variants(scene, deciding, count, lambda own: default_duration(own, start))


def kinds_that_set_lengths(scene: Scene) -> tuple[str, ...]:
    """Kinds of places whose numbers the default length of a run follows."""
    own = ("body", "spring") if any(isinstance(motion, Record) for motion in scene.motions) else ()
    return ("excitation", "across", "support", *own)


def kinds_that_set_periods(scene: Scene) -> tuple[str, ...]:
    """Kinds of places whose numbers the period follows at which a record is scaled."""
    named = isinstance(scene.motion, Record) and scene.motion.psa_at
    return ("body", "spring") if named else ()


def scene_of_row(rows: Rows, i: int) -> Scene:
    """Scene of one variant."""
    scene, places = rows.scene, number_places(rows.scene)
    if rows.motion_of is not None:
        scene = replace(scene, motion=rows.motions[rows.motion_of[i]])
    return with_values(scene, {places[key]: float(v[i]) for key, v in rows.numbers.items()})


def unknown_axes(base: Base) -> Iterator[tuple[str, str]]:
    """Keys of axes that the scene does not have, and what is said of them."""
    places = number_places(base.case.scene)
    for axis in base.axes:
        if not axis.key.startswith(PI) and axis.key not in places:
            shown = [*list(places)[:_MOST_SHOWN], *(["..."] if len(places) > _MOST_SHOWN else [])]
            meant = suggestion(axis.key, list(places)) or f"; accepted: {', '.join(shown)}"
            yield axis.key, f"unknown key{meant}"


def check_axes(base: Base) -> Iterator[str]:
    """What is wrong with values of the axes, each by itself with the first ones of the others.

    Parameters
    ----------
    base : Base
        A scene and its axes; of a long axis only the ends are looked at.
    """
    if unknown := [f"[[study.axis]] ({key}): {text}" for key, text in unknown_axes(base)]:
        yield from unknown
        return
    first = {axis.key: axis.values[:1] for axis in base.axes}
    for axis in base.axes:
        values = axis.values if axis.values.size <= _MOST_CHECKED else axis.values[[0, -1]]
        for value in values:
            try:
                # What is too large becomes a number that is not finite, which is refused.
                with np.errstate(all="ignore"):
                    own = first | {axis.key: np.array([value])}
                    rows = complete(rows_with(base, own, range(1)))
                check_scene(scene_of_row(rows, 0))
            except InputError as error:
                yield f"[[study.axis]] ({axis.key}): value {float(value)!r}: {error.problems[0]}"
                break
