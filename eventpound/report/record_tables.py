"""The records of a suite, to be read: what they are called, their sizes, what scales them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eventpound.results.cells import Cells, headed
from eventpound.results.trade import Trade
from eventpound.scene.periods import longest_period
from eventpound.scene.scene import Scene
from eventpound.study.records import FAILED
from eventpound.units import Dimension

if TYPE_CHECKING:
    import pandas as pd

    from eventpound.case.case import Case

_MOST_RECORDS, _IN_ONE_COLUMN = 44, 12
_LONGEST = 44
"""Letters of the name of a record."""
_SIZES = (("scale", "scale", ""), ("PGA", "PGA", "m/s^2"), ("T_m", "T_m", "s"))
"""Numbers of a record: columns of a suite, what they are called and units (SI)."""


def scaling_words(case: Case, trade: Trade) -> str:
    """What a case does to the size of every record of its suite; empty where that is nothing."""
    if case.suite is None:
        return ""
    size = case.suite.options.size
    return size.words(lambda value: trade.words(value, Dimension.ACCELERATION.unit))


def _word(value: object) -> str:
    """A text of a table; empty where it has none."""
    return "" if value != value else str(value)


def record_names(runs: pd.DataFrame) -> dict[str, str]:
    """What records are called, with their numbers: event, station and component, or their names."""
    names = {}
    for number, row in enumerate(runs.to_dict("records"), 1):
        said = [word for key in ("event", "station", "component") if (word := _word(row[key]))]
        name = ", ".join(said) or str(row["record"])
        short = name if len(name) <= _LONGEST else name[: _LONGEST - 1] + "…"
        names[str(row["record"])] = f"{number} {short}"
    return names


def record_cells(
    scene: Scene, runs: pd.DataFrame, trade: Trade, most: int = _MOST_RECORDS
) -> list[Cells]:
    """Name and size of each record, as one table, or two where they are many."""
    at = f"Sa({longest_period(scene) or np.nan:.3g} s)"
    sizes = (*_SIZES, ("Sa_T1", at, Dimension.ACCELERATION.unit))
    there = [size for size in sizes if size[0] in runs]
    heads = ("record", *(headed(called, trade.unit(unit)[0]) for _, called, unit in there))
    names, rows = record_names(runs), []
    for row in runs.to_dict("records"):
        values = ((float(row[key]), unit) for key, _, unit in there)
        cells = ("" if value != value else trade.number(value, unit) for value, unit in values)
        note = " (failed)" if row[FAILED] else ""
        rows.append((names[str(row["record"])] + note, *cells))
    words, shown = (True, *(False for _ in there)), rows[:most]
    half = len(shown) if len(shown) <= _IN_ONE_COLUMN else -(-len(shown) // 2)
    parts = [shown[low : low + half] for low in range(0, len(shown), half)]
    more = len(rows) - len(shown)
    last = len(parts) - 1
    return [Cells(heads, tuple(p), words, more * (i == last)) for i, p in enumerate(parts)]
