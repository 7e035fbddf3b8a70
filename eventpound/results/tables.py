"""Tables written as lines, Markdown, CSV or a workbook (`eventpound.report.html`: as HTML).

A workbook is an XLSX file, which spreadsheets open, with a sheet a table; by XlsxWriter.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
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


@dataclass(frozen=True, slots=True)
class Cells:
    """A table as texts.

    Parameters
    ----------
    headings : tuple of str
        With units.
    rows : tuple of tuple of str
        As many cells each.
    words : tuple of bool
        Whether a column holds words, which stand to the left.
    more : int
        Rows that are left out.
    exact : tuple of tuple of str or float
        The same rows for a workbook, where their numbers have more digits than are read.
    """

    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    words: tuple[bool, ...]
    more: int = 0
    exact: tuple[tuple[str | float, ...], ...] = ()


def headed(name: str, unit: str) -> str:
    """A heading with its unit, where it has one."""
    return f"{name} ({unit})" if unit else name


def cell_text(value: object) -> str:
    """A cell of a table; empty without a value."""
    if value is None or value != value:
        return ""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def lines_of(table: Cells) -> Iterator[str]:
    """A table in columns as wide as they need."""
    widths = [max(map(len, column)) for column in zip(table.headings, *table.rows, strict=True)]
    for line in (table.headings, *table.rows):
        parts = [
            text.ljust(width) if word else text.rjust(width)
            for text, width, word in zip(line, widths, table.words, strict=True)
        ]
        yield "  ".join(parts).rstrip()
    if table.more:
        yield f"and {table.more} more"


def aligned(headings: Sequence[str], rows: Iterable[Sequence[str]], words: Collection[int]) -> str:
    """A table in columns, those of these numbers of words, as one text."""
    left = tuple(i in words for i in range(len(headings)))
    return "\n".join(lines_of(Cells(tuple(headings), tuple(map(tuple, rows)), left)))


def markdown_of(headings: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """A table in Markdown."""
    lines = [headings, ["---"] * len(headings), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


Row = Sequence[str | float]


def sheet_of(table: Cells) -> list[Row]:
    """A table as a sheet of a workbook: exact where it is known, else the numbers that are read."""
    read = (
        [text if word else _number(text) for text, word in zip(row, table.words, strict=True)]
        for row in table.rows
    )
    return [table.headings, *(table.exact or read)]


def _number(text: str) -> str | float:
    """A cell as a number, where it is one."""
    try:
        return float(text)
    except ValueError:
        return text


_LONGEST_NAME = 31
_FORBIDDEN = re.compile(r"[\[\]:*?/\\']")
_WIDEST = 200
"""Of a column, in pixels."""
_ANY_DAY = datetime(1980, 1, 1)
"""Of every workbook: the same tables make the same bytes."""


def workbook(sheets: Mapping[str, Sequence[Row]]) -> bytes:
    """A workbook, XLSX: headings in bold, in sight however far one scrolls.

    Parameters
    ----------
    sheets : mapping of str to sequence of rows
        Cells by the names of the sheets, the first row of each its headings; NaN is empty.
    """
    # Only who writes one imports it.
    from xlsxwriter import Workbook

    made, names = io.BytesIO(), set[str]()
    with Workbook(made, {"in_memory": True}) as book:
        book.set_properties({"created": _ANY_DAY})
        heading = book.add_format({"bold": True, "text_wrap": True})
        for wanted, rows in sheets.items():
            sheet = book.add_worksheet(_sheet_name(wanted, names))
            sheet.freeze_panes(1, 0)
            for i, row in enumerate(rows):
                style = heading if i == 0 else None
                for k, cell in enumerate(row):
                    if isinstance(cell, str):
                        sheet.write_string(i, k, cell, style)
                    elif cell == cell:
                        sheet.write_number(i, k, cell, style)
            sheet.autofit(_WIDEST)
    return made.getvalue()


def _sheet_name(wanted: str, names: set[str]) -> str:
    """A name that a workbook may have, which is noted among those that it has."""
    stem = (_FORBIDDEN.sub(" ", wanted).strip() or "table")[:_LONGEST_NAME]
    name, number = stem, 2
    while name.lower() in names:
        tail = f" {number}"
        name, number = stem[: _LONGEST_NAME - len(tail)] + tail, number + 1
    names.add(name.lower())
    return name
