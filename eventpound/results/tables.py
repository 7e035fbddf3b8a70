"""Tables as texts, written as lines, as Markdown or as CSV (`eventpound.report.html`: as HTML)."""

from __future__ import annotations

import csv
import io
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
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
    """

    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    words: tuple[bool, ...]
    more: int = 0


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
