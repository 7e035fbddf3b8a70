"""What all figures share: colours, units by range, sizes, and how they are saved.

The eight colours are those of Okabe and Ito (Color Universal Design, 2008),
which colour-blind readers tell apart, without their yellow, which is lost on
white, and with a grey instead.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib import colormaps, rc_context
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.mathtext import MathTextParser
from matplotlib.text import Annotation, Text
from matplotlib.ticker import Formatter, LogLocator

from eventpound.numerics.arrays import Floats

Color = str | tuple[float, ...]

PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#8C8C8C")
DASHED: Any = {"linestyle": (0, (6, 3)), "linewidth": 0.8}
"""A line that marks a level."""

_STYLE: Any = {
    "font.size": 9.0,
    "axes.titlesize": 9.0,
    "axes.linewidth": 0.6,
    "axes.grid": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.0,
    "legend.frameon": False,
    "legend.fontsize": 8.0,
    # Paths of a hundred thousand points overflow the renderer's cells in one piece.
    "agg.path.chunksize": 20_000,
}
_LONG_WORD = re.compile(r"(?<![^\s])([^\s$]{18})[^\s$]{5,}([^\s$]{17})(?![^\s])")
"""A word that has no room in a figure, and its two ends that are shown; no formula is one."""
_DOTS_PER_INCH = 150
_MM = 1.0 / 25.4
_FEW_DECADES = 100.0
"""Ends of a logarithmic axis up to this far apart have numbers between decades."""
_SMALLEST_LETTERS = 0.72
"""Part of their size that letters keep in a narrow figure: 9 points become 6.5."""


@dataclass(frozen=True, slots=True)
class Paper:
    """How figures are written.

    Parameters
    ----------
    formats : tuple of str
        Some of ``"png"``, ``"pdf"``, ``"svg"``.
    width : float, optional
        Of a figure (mm); its height and its letters follow.
    dpi : float
        Dots an inch of a PNG.
    """

    formats: tuple[str, ...] = ("png",)
    width: float | None = None
    dpi: float = _DOTS_PER_INCH


def largest_size(*values: Floats) -> float:
    """Largest finite absolute value of some arrays of any shape; zero without one."""
    sizes = [np.abs(array[np.isfinite(array)]).max(initial=0.0) for array in values]
    return float(max(sizes, default=0.0))


def colors(count: int, first: int = 0) -> list[Color]:
    """Colours of a family of lines: the palette, or a ramp where it is too short.

    Parameters
    ----------
    count : int
        How many.
    first : int
        Where in the palette to begin, so that two families differ.
    """
    if first + count <= len(PALETTE):
        return list(PALETTE[first : first + count])
    # The pale end of the map is hard to see on white.
    return [colormaps["viridis"](0.92 * i / max(1, count - 1)) for i in range(count)]


@contextmanager
def styled() -> Iterator[None]:
    """Settings under which figures are drawn and saved; ``@styled()`` for a function that draws."""
    with rc_context(_STYLE):
        yield


def new_figure(width: float, height: float, title: str = "") -> Figure:
    """An empty figure of a size (in), its title broken into lines where it is long."""
    figure = Figure(figsize=(width, height), layout="constrained")
    if title:
        figure.suptitle(title, fontsize=10.0, wrap=True)
    return figure


class _Plain(Formatter):
    """0.5 where matplotlib shows 5e-01; nothing where decades are narrow."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        low, high = (1.0, 10.0) if self.axis is None else self.axis.get_view_interval()
        return f"{x:g}" if high < _FEW_DECADES * low else ""


def plain_logarithms(axes: Axes, x: bool = True, y: bool = True) -> None:
    """Axes logarithmic, with numbers as one writes them; between decades where few show."""
    for axis, wanted, scale in ((axes.xaxis, x, axes.set_xscale), (axes.yaxis, y, axes.set_yscale)):
        if not wanted:
            continue
        scale("log")
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(_Plain())
        # Of the numbers between decades only these have room beside one another.
        axis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))


def zero_lines(axes: Axes, *, upright: bool = False, level: bool = True) -> None:
    """Thin lines where both numbers of axes, or one of them, are zero."""
    thin: Any = {"color": "#BBBBBB", "linewidth": 0.6, "zorder": 1}
    if level:
        axes.axhline(0.0, **thin)
    if upright:
        axes.axvline(0.0, **thin)


def say(
    axes: Axes, text: str, place: tuple[float, float], away: tuple[float, float], **look: Any
) -> Annotation:
    """Write beside a point, so many points to its right and above it: away from it."""
    look.setdefault("ha", {-1: "right", 0: "center", 1: "left"}[(away[0] > 0) - (away[0] < 0)])
    look.setdefault("va", {-1: "top", 0: "center", 1: "bottom"}[(away[1] > 0) - (away[1] < 0)])
    return axes.annotate(text, place, away, textcoords="offset points", **look)


def arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], **look: Any) -> None:
    """An arrow between two points; `arrowstyle` says which way it points."""
    axes.annotate("", end, start, arrowprops={"shrinkA": 0.0, "shrinkB": 0.0, **look})


def legend_beside(axes: Axes, handles: Sequence[Artist], columns: int = 1) -> None:
    """Legend to the right of the axes, where it hides nothing."""
    place: Any = {"loc": "upper left", "bbox_to_anchor": (1.005, 1.02), "borderaxespad": 0.0}
    axes.legend(handles=handles, ncols=columns, **place)


def legend_above(axes: Axes, handles: Sequence[Artist] | None = None, **look: Any) -> None:
    """Legend above the axes, in one line where nothing else is said; of all lines by default."""
    place: Any = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "ncols": 4}
    axes.legend(handles=handles, **place | look)


def literal(text: str) -> str:
    """A text in which matplotlib sees no formula."""
    return text.replace("$", r"\$")


def show_as_written(figure: Figure) -> None:
    """Texts of a case's title or names as they stand, but for words too long to have room.

    Those with dollar signs may be no formula. Labels of ticks are made anew when a figure is
    drawn: `literal` is for them.
    """
    parser = MathTextParser("path")
    for text in figure.findobj(Text):
        text.set_text(_LONG_WORD.sub(r"\1…\2", text.get_text()))
        if "$" not in text.get_text():
            continue
        try:
            parser.parse(text.get_text().replace("\n", " "))
        except ValueError:
            text.set_text(literal(text.get_text()))


def svg(figure: Figure) -> str:
    """Figure as an SVG element of a page.

    Parameters
    ----------
    figure : Figure
        What `eventpound.report` drew.
    """
    text = _written(figure, "svg", _DOTS_PER_INCH).decode()
    return text[text.index("<svg") :]


def png(figure: Figure, dpi: float = _DOTS_PER_INCH) -> bytes:
    """Figure as a PNG file.

    Parameters
    ----------
    figure : Figure
        What `eventpound.report` drew.
    dpi : float
        Dots an inch.
    """
    return _written(figure, "png", dpi)


def on_paper(figures: Mapping[str, Figure], paper: Paper) -> dict[str, bytes]:
    """Figures as files.

    Parameters
    ----------
    figures : mapping of str to Figure
        By the names of their PNG files.
    paper : Paper
        How they are written.
    """
    files = {}
    for name, figure in figures.items():
        if paper.width is not None:
            _resize(figure, paper.width * _MM)
        for kind in paper.formats:
            files[f"{name.removesuffix('.png')}.{kind}"] = _written(figure, kind, paper.dpi)
    return files


def _resize(figure: Figure, wanted: float) -> None:
    """Give a figure another width (in): its height and its letters follow more slowly."""
    width, height = figure.get_size_inches()
    scale = wanted / width
    figure.set_size_inches(wanted, height * scale**0.5)
    letters = min(max(scale, _SMALLEST_LETTERS), 1.0)
    for text in figure.findobj(Text):
        text.set_fontsize(letters * text.get_fontsize())


def _written(figure: Figure, kind: str, dpi: float) -> bytes:
    """A file of the figure, the same for the same figure."""
    buffer = io.BytesIO()
    # The date of a file is none of its content.
    metadata = {"pdf": {"CreationDate": None}, "svg": {"Date": None}}.get(kind)
    with styled(), rc_context({"svg.hashsalt": "eventpound", "pdf.fonttype": 42}):
        show_as_written(figure)
        figure.savefig(buffer, format=kind, dpi=dpi, metadata=metadata)
    return buffer.getvalue()
