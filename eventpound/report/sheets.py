"""Sheets of A4 from blocks, in two ways: HTML that prints so, and a PDF that needs no browser.

A sheet is a list of blocks: headings, texts, tables, pictures, and columns of these side by side.
Both ways have the same letters and widths; where a sheet is too full, its pictures shrink.
"""

from __future__ import annotations

import io
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from html import escape

from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.image import imread
from matplotlib.textpath import TextPath

from eventpound.report.html import Section, chapter, document, table_of
from eventpound.report.style import literal, png, styled, svg
from eventpound.results.tables import Cells

_MM = 72.0 / 25.4
"""Points."""
WIDTH = 186.0
"""Of what stands on a sheet (mm)."""
_PAGE, _MARGIN = (210.0, 297.0), 12.0
_TITLE, _HEAD, _TEXT, _TABLE, _SMALLEST = 14.0, 9.5, 7.5, 6.6, 4.0
"""Letters (points)."""
_LINE, _BELOW, _BETWEEN = 1.28, 4.0, 8.0
"""Of letters; below a block and between columns (points)."""
_DOTS = 250.0
"""An inch, of the pictures of a PDF."""
_LETTER, _BOLD = 0.53, 0.66
"""Width of a letter of a text and of a heading, of its size."""


@dataclass(frozen=True, slots=True)
class Head:
    """A heading; the first of a report is its title."""

    text: str
    title: bool = False

    @property
    def size(self) -> float:
        """Of its letters (points), so that it is one line."""
        fitting = WIDTH * _MM / (_BOLD * max(len(self.text), 1))
        return min(_TITLE if self.title else _HEAD, fitting)


@dataclass(frozen=True, slots=True)
class Words:
    """Paragraphs."""

    texts: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure, as wide as its column, or so high (mm)."""

    figure: Figure
    high: float


@dataclass(frozen=True, slots=True)
class Columns:
    """Blocks side by side, in columns of one width."""

    columns: tuple[tuple[Block, ...], ...]


Block = Head | Words | Cells | Picture | Columns
Sheet = Sequence[Block]


def as_html(title: str, sheets: Sequence[Sheet], appendix: Iterable[Section] = ()) -> bytes:
    """The sheets as one page in itself, which a browser prints on as many of A4, and what follows.

    Without sheets the appendix has the title.
    """
    body = []
    for sheet in sheets:
        share = share_of(sheet)
        blocks = "".join(_html(block, WIDTH, share) for block in sheet)
        body.append(f'<section class="sheet">\n{blocks}</section>\n')
    if sections := list(appendix):
        inner = chapter("Appendix" if sheets else title, sections)
        body.append(f'<section class="appendix">\n{inner}</section>\n')
    return document(title, ["page.css", "sheets.css"], body)


def _html(block: Block, width: float, share: float) -> str:
    """A block in a column of a width (mm), pictures of this part of their size."""
    match block:
        case Head():
            tag = "h1" if block.title else "h2"
            look = f"font-size: {block.size:.2f}pt"
            return f'<{tag} style="{look}">{escape(block.text)}</{tag}>\n'
        case Words():
            inner = "".join(f"<p>{escape(text)}</p>\n" for text in block.texts)
            return f'<div class="words">{inner}</div>\n'
        case Cells():
            size = _table_widths(block, width * _MM)[1]
            look = f"font-size: {size:.2f}pt"
            return f'<div class="words" style="{look}">{table_of(block)}</div>\n'
        case Picture():
            wide = share * _width_of(block, width)
            return f'<figure style="width: {wide:.1f}mm">{svg(block.figure)}</figure>\n'
        case Columns():
            own = _column(block, width)
            parts = ("".join(_html(each, own, share) for each in c) for c in block.columns)
            inner = "".join(f'<div style="width: {own:.1f}mm">{part}</div>' for part in parts)
            return f'<div class="columns">{inner}</div>\n'


@styled()
def as_pdf(title: str, sheets: Sequence[Sheet]) -> bytes:
    """The sheets as a PDF, a page each."""
    buffer = io.BytesIO()
    about = {"Title": title, "Creator": "eventpound", "Producer": None, "CreationDate": None}
    with PdfPages(buffer, metadata=about) as pages:
        for sheet in sheets:
            page = Figure(figsize=(_PAGE[0] / 25.4, _PAGE[1] / 25.4))
            pen = _Pen(page, share_of(sheet))
            top = (_PAGE[1] - _MARGIN) * _MM
            for block in sheet:
                top -= pen.draw(block, _MARGIN * _MM, top, WIDTH * _MM)
            pages.savefig(page)
    return buffer.getvalue()


@dataclass(frozen=True, slots=True)
class _Pen:
    """Draws blocks on a page; all lengths in points, y upwards."""

    page: Figure
    share: float

    def draw(self, block: Block, x: float, top: float, width: float) -> float:
        """Draw a block below a height; how much room it took."""
        match block:
            case Head():
                self._say(x, top, block.text, block.size, weight="bold")
            case Words():
                for i, line in enumerate(_wrapped(block, width)):
                    self._say(x, top - i * _TEXT * _LINE, line, _TEXT)
            case Cells():
                self._table(block, x, top, width)
            case Picture():
                wide = self.share * _width_of(block, width / _MM) * _MM
                high = wide * _aspect(block.figure)
                w, h = (length * _MM for length in _PAGE)
                axes = self.page.add_axes((x / w, (top - high) / h, wide / w, high / h))
                axes.imshow(imread(io.BytesIO(png(block.figure, _DOTS))), aspect="auto")
                axes.axis("off")
            case Columns():
                own = _column(block, width / _MM) * _MM
                for i, column in enumerate(block.columns):
                    below = top
                    for each in column:
                        below -= self.draw(each, x + i * (own + _BETWEEN), below, own)
        return _height(block, width / _MM, self.share)

    def _table(self, table: Cells, x: float, top: float, width: float) -> None:
        widths, size = _table_widths(table, width)
        rows = (table.headings, *table.rows)
        for i, row in enumerate(rows):
            left, y = x, top - i * size * _LINE
            for text, wide, word in zip(row, widths, table.words, strict=True):
                place = left if word else left + wide - _gap(size)
                look = {"ha": "left" if word else "right", "weight": "normal" if i else "bold"}
                self._say(place, y, text, size, **look)
                left += wide
        if table.more:
            self._say(x, top - len(rows) * size * _LINE, f"and {table.more} more", size)

    def _say(self, x: float, top: float, text: str, size: float, **look: str) -> None:
        w, h = (length * _MM for length in _PAGE)
        where = {"va": "top", "fontsize": size} | look
        self.page.text(x / w, top / h, literal(text), **where)  # type: ignore[arg-type]


def share_of(sheet: Sheet) -> float:
    """Part of their size that the pictures of a sheet have, so that all is on it, if it can be."""
    room = (_PAGE[1] - 2.0 * _MARGIN) * _MM
    whole, bare = (sum(_height(block, WIDTH, share) for block in sheet) for share in (1.0, 0.0))
    return min(1.0, max((room - bare) / (whole - bare), 0.3)) if whole > bare else 1.0


def _height(block: Block, width: float, share: float) -> float:
    """Room that a block takes in a column of a width (mm), in points."""
    match block:
        case Head():
            return block.size * _LINE + _BELOW
        case Words():
            return len(list(_wrapped(block, width * _MM))) * _TEXT * _LINE + _BELOW
        case Cells():
            size = _table_widths(block, width * _MM)[1]
            return (len(block.rows) + 1 + bool(block.more)) * size * _LINE + _BELOW
        case Picture():
            wide = share * _width_of(block, width)
            return wide * _aspect(block.figure) * _MM + _BELOW
        case Columns():
            own = _column(block, width)
            columns = (sum(_height(each, own, share) for each in c) for c in block.columns)
            return max(columns, default=0.0)


def _column(block: Columns, width: float) -> float:
    """Width of each of some columns (mm)."""
    count = len(block.columns)
    return (width - (count - 1) * _BETWEEN / _MM) / count


def _aspect(figure: Figure) -> float:
    wide, high = figure.get_size_inches()
    return float(high / wide)


def _width_of(picture: Picture, width: float) -> float:
    """Width of a picture (mm)."""
    return min(width, picture.high / _aspect(picture.figure))


def _wrapped(words: Words, width: float) -> Iterator[str]:
    """Lines of paragraphs in a width (points)."""
    for text in words.texts:
        yield from textwrap.wrap(text, int(width / (_LETTER * _TEXT))) or [""]


def _table_widths(table: Cells, width: float) -> tuple[list[float], float]:
    """Widths of the columns (points), and the size of letters with which they fit."""
    columns = list(zip(table.headings, *table.rows, strict=True))
    wide = [
        max(_length(text, i == 0) for i, text in enumerate(column)) + _gap(_TABLE)
        for column in columns
    ]
    part = min(1.0, width / sum(wide))
    size = max(_SMALLEST, _TABLE * part)
    return [each * part for each in wide], size


def _gap(size: float) -> float:
    """Between columns of a table (points)."""
    return 0.9 * size


@lru_cache(4096)
def _length(text: str, bold: bool) -> float:
    """Length of a text in a table (points)."""
    if not text.strip():
        return 0.0
    font = FontProperties(weight="bold" if bold else "normal")
    path = TextPath((0.0, 0.0), text.replace("$", "S"), size=_TABLE, prop=font)
    return float(path.get_extents().width)
