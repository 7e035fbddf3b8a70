"""The records of a suite, to be read: what they are called, their sizes, what scales them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from eventpound.results.shown_units import Units
from eventpound.results.tables import Cells, cell_text, headed
from eventpound.scene.plan_point import TURN
from eventpound.study.records import FAILED, SA, sa_of_suite
from eventpound.units import Dimension

if TYPE_CHECKING:
    import pandas as pd

    from eventpound.case.case import Case

_MOST_RECORDS, _IN_ONE_COLUMN = 44, 12
_LONGEST = 44
"""Letters of the name of a record."""
_MOST_BODIES = 6
"""Whose peaks stand beside all records."""
_SIZES = (
    *(("scale", "scale", ""), ("PGA", "PGA", "m/s^2"), ("T_m", "T_m", "s")),
    (SA, "Sa", Dimension.ACCELERATION.unit),
)
"""Numbers of a record: columns of a suite, what they are called and units (SI)."""


def scaling_words(case: Case, units: Units) -> str:
    """What a case does to the size of every record of its suite; empty where that is nothing."""
    return case.size.words(lambda value: units.words(value, Dimension.ACCELERATION.unit))


def record_names(runs: pd.DataFrame) -> dict[str, str]:
    """What records are called, with their numbers: event, station and component, or their names."""
    names = {}
    for number, row in enumerate(runs.to_dict("records"), 1):
        said = [word for key in ("event", "station", "component") if (word := cell_text(row[key]))]
        name = ", ".join(said) or str(row["record"])
        short = name if len(name) <= _LONGEST else name[: _LONGEST - 1] + "…"
        names[str(row["record"])] = f"{number} {short}"
    return names


def record_cells(
    case: Case, runs: pd.DataFrame, units: Units, most: int = _MOST_RECORDS
) -> list[Cells]:
    """Name and size of each record, as one table, or two where they are many."""
    heads, rows = _sizes_of(case, runs, units, _SIZES)
    failed = runs[FAILED].astype(bool)
    named = [
        (f"{row[0]} (failed)", *row[1:]) if not_done else row
        for row, not_done in zip(rows, failed, strict=True)
    ]
    words, shown = (True, *(False for _ in heads[1:])), named[:most]
    half = len(shown) if len(shown) <= _IN_ONE_COLUMN else -(-len(shown) // 2)
    parts = [shown[low : low + half] for low in range(0, len(shown), half)]
    more = len(rows) - len(shown)
    last = len(parts) - 1
    return [Cells(heads, tuple(p), words, more * (i == last)) for i, p in enumerate(parts)]


def all_records(case: Case, runs: pd.DataFrame, units: Units) -> Cells:
    """A line a record: its size, the peaks of the first bodies, or why it has none; its file."""
    peaks = [
        (f"peaks.{body.name}.abs_max", f"|u| of {body.name}", Dimension.LENGTH.unit)
        for body in case.scene.bodies[:_MOST_BODIES]
        if body.direction != TURN
    ]
    length = "L_e", "L_e", Dimension.LENGTH.unit
    heads, rows = _sizes_of(
        case, runs, units, (*_SIZES, length, *peaks, ("impacts", "impacts", ""))
    )
    ends = zip(runs["file"].astype(str), runs[FAILED].astype(str), strict=True)
    lines = tuple((*row, *end) for row, end in zip(rows, ends, strict=True))
    words = (True, *(False for _ in heads[1:]), True, True)
    return Cells((*heads, "file", "failed"), lines, words)


def _sizes_of(
    case: Case, runs: pd.DataFrame, units: Units, columns: Sequence[tuple[str, str, str]]
) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Headings and a line a record, of those columns that the table has."""
    called = {SA: f"Sa({sa_of_suite(case)[0]:.3g} s)"}
    there = [column for column in columns if column[0] in runs]
    heads = (headed(called.get(key, name), units.unit(unit)[0]) for key, name, unit in there)
    names, rows = record_names(runs), []
    for row in runs.to_dict("records"):
        values = ((float(row[key]), unit) for key, _, unit in there)
        cells = ("" if value != value else units.number(value, unit) for value, unit in values)
        rows.append((names[str(row["record"])], *cells))
    return ("record", *heads), rows
