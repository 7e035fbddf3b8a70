"""Tables as texts, written as lines of text or as Markdown (`eventpound.report.html`: as HTML)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass


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


def markdown_of(headings: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """A table in Markdown."""
    lines = [headings, ["---"] * len(headings), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)
