"""Tables as CSV files; `eventpound.basics.input_files` reads them."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd


def rows_csv(rows: Iterable[Iterable[object]]) -> bytes:
    """Rows of cells as CSV, UTF-8; every number reads back as the same double, NaN is empty."""
    text = io.StringIO(newline="")
    cells = (["" if cell != cell else cell for cell in row] for row in rows)
    csv.writer(text, lineterminator="\n").writerows(cells)
    return text.getvalue().encode()


def table_csv(table: pd.DataFrame) -> bytes:
    """Table as CSV, UTF-8; every number reads back as the same double.

    Parameters
    ----------
    table : DataFrame
        Its index is left out.
    """
    text: str = table.to_csv(index=False, lineterminator="\n")
    return text.encode()
