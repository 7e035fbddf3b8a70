"""How numbers of many runs are distributed, as a table of a page."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from eventpound.quantities import LISTED
from eventpound.quantities.base import parts_of
from eventpound.report.html import table_of, text_of
from eventpound.report.symbols import dimension_of
from eventpound.results.input_tables import Cells

if TYPE_CHECKING:
    import pandas as pd

_PARTS = (16.0, 50.0, 84.0)


def quantities_among(table: pd.DataFrame) -> list[str]:
    """Columns of numbers that are quantities of a run, times of extremes apart."""
    listed = {parts_of(q.path)[0].partition(".")[0] for q in LISTED}
    return [
        name
        for name in table.select_dtypes("number").columns
        if name.partition(".")[0] in listed and not name.rpartition(".")[2].startswith("t_")
    ]


def fractiles(
    table: pd.DataFrame, columns: list[str], where: str, place: Callable[[int], str]
) -> str:
    """A table of fractiles over the rows, folded up by a click; empty where nothing is known.

    Parameters
    ----------
    table : DataFrame
        A row a run.
    columns : list of str
        Of numbers.
    where : str
        Heading of the last column.
    place : callable
        What stands there for the row of the greatest.

    Returns
    -------
    str
        HTML.
    """
    rows = []
    for name in columns:
        values = table[name].dropna()
        if values.empty:
            continue
        parts = [values.min(), *np.percentile(values, _PARTS), values.max()]
        unit = dimension_of(name).unit
        called = f"{name} ({unit})" if unit else name
        greatest = place(int(values.idxmax()))
        rows.append((called, *(text_of(float(part)) for part in parts), greatest))
    if not rows:
        return ""
    heads = ("quantity", "least", *(f"{p:g} %" for p in _PARTS), "greatest", where)
    words = (True, *(False for _ in range(len(_PARTS) + 2)), True)
    shown = table_of(Cells(heads, tuple(rows), words))
    return f"<details open><summary>{len(rows)} quantities</summary>\n{shown}</details>\n"
