"""What all figures share: colours, units by range, sizes, and how they are saved.

The eight colours are those of Okabe and Ito (Color Universal Design, 2008),
which colour-blind readers tell apart, without their yellow, which is lost on
white, and with a grey instead.
"""

from __future__ import annotations

import io
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from eventpound.numerics.arrays import Floats

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Color = str | tuple[float, ...]

PALETTE = (
    "#0072B2",
    "#D55E00",
    "#009E73",
    "#CC79A7",
    "#E69F00",
    "#56B4E9",
    "#000000",
    "#8C8C8C",
)

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
_DOTS_PER_INCH = 150


@dataclass(frozen=True, slots=True)
class Unit:
    """Unit of an axis.

    Parameters
    ----------
    name : str
        As printed.
    size : float
        In SI units.
    """

    name: str
    size: float


def length_unit(largest: float) -> Unit:
    """Metres, centimetres or millimetres, by the largest length (m) to show."""
    if largest >= 1.0:
        return Unit("m", 1.0)
    return Unit("cm", 1e-2) if largest >= 5e-3 else Unit("mm", 1e-3)


def force_unit(largest: float) -> Unit:
    """Kilonewtons, or newtons for forces (N) below one of them."""
    return Unit("kN", 1e3) if largest >= 1e3 else Unit("N", 1.0)


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
    if count <= len(PALETTE):
        return [PALETTE[(first + i) % len(PALETTE)] for i in range(count)]
    from matplotlib import colormaps

    # The pale end of the map is hard to see on white.
    return [colormaps["viridis"](0.92 * i / (count - 1)) for i in range(count)]


def styled() -> AbstractContextManager[None]:
    """Settings of matplotlib under which figures are made and saved."""
    from matplotlib import rc_context

    return rc_context(_STYLE)


def plain_logarithms(axes: Axes) -> None:
    """Both axes logarithmic, with numbers as one writes them; between decades where few show."""
    from matplotlib.ticker import LogFormatter

    class Plain(LogFormatter):
        """0.6 where `LogFormatter` shows 6e-01."""

        def __call__(self, x: float, pos: int | None = None) -> str:
            return f"{x:g}" if super().__call__(x, pos) else ""

    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(Plain(minor_thresholds=(1.1, 0.6)))


def legend_beside(axes: Axes, handles: list[Artist]) -> None:
    """Legend to the right of the axes, where it hides nothing."""
    axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.005, 1.02), borderaxespad=0.0)


def legend_above(axes: Axes, handles: list[Artist]) -> None:
    """Legend in one line above the axes."""
    axes.legend(handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4)


def literal(text: str) -> str:
    """A text in which matplotlib sees no formula."""
    return text.replace("$", r"\$")


def show_as_written(figure: Figure) -> None:
    """Texts with dollar signs that are no formula, of a case's title or names, as they stand.

    Labels of ticks are made anew when a figure is drawn: `literal` is for them.
    """
    from matplotlib.mathtext import MathTextParser
    from matplotlib.text import Text

    parser = MathTextParser("path")
    for text in figure.findobj(Text):
        if "$" not in text.get_text():
            continue
        try:
            parser.parse(text.get_text().replace("\n", " "))
        except ValueError:
            text.set_text(literal(text.get_text()))


def svg(figure: Figure) -> str:
    """Figure as an SVG element, the same for the same figure.

    Parameters
    ----------
    figure : Figure
        What `eventpound.report` drew.
    """
    from matplotlib import rc_context

    buffer = io.StringIO()
    with styled(), rc_context({"svg.hashsalt": "eventpound"}):
        show_as_written(figure)
        figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    text = buffer.getvalue()
    return text[text.index("<svg") :]


def png(figure: Figure) -> bytes:
    """Figure as a PNG file.

    Parameters
    ----------
    figure : Figure
        What `eventpound.report` drew.
    """
    buffer = io.BytesIO()
    with styled():
        show_as_written(figure)
        figure.savefig(buffer, format="png", dpi=_DOTS_PER_INCH)
    return buffer.getvalue()
