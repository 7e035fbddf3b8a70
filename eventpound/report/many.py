"""Parts of the pages of many runs: how many struck, how their numbers are distributed."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd

from eventpound.report.html import Part, folded, table_of
from eventpound.report.symbols import dimension_of
from eventpound.results.cells import Cells, cell_text, headed

_PARTS = (16.0, 50.0, 84.0)


def struck(done: pd.DataFrame) -> dict[str, str]:
    """In how many runs there were impacts; nothing where that is not known."""
    if "impacts" not in done or done.empty:
        return {}
    some, most = int((done["impacts"] > 0).sum()), int(done["impacts"].max())
    return {"impacts": f"in {some} of {len(done)} runs, {most} at most"}


def fractiles(
    table: pd.DataFrame, columns: Sequence[str], where: str, place: Callable[[int], str]
) -> Part:
    """A table of fractiles over the rows, folded up by a click; empty where nothing is known.

    Parameters
    ----------
    table : DataFrame
        A row a run.
    columns : sequence of str
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
        texts = [cell_text(float(part)) for part in parts]
        called = headed(name, dimension_of(name).unit)
        rows.append((called, *texts, place(int(values.idxmax()))))
    if not rows:
        return ""
    heads = ("quantity", "least", *(f"{p:g} %" for p in _PARTS), "greatest", where)
    words = (True, *(False for _ in heads[2:]), True)
    shown = table_of(Cells(heads, tuple(rows), words))
    return folded(f"{len(rows)} quantities", shown, opened=True)
