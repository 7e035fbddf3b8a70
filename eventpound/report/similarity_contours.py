"""Figure of Π_δ and Π_uy against gap, yield displacement and 1/L_e (paper, Fig. 3).

Π = length / L_e, so that a contour is 1/L_e = Π / length: a straight line of
slope -1 where both axes are logarithmic. Below the contour of complete
similarity the response no longer depends on the gap or the yield displacement.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from eventpound.case.figure import Figure as Wanted
from eventpound.case.figure import LengthRange
from eventpound.numerics.arrays import Floats
from eventpound.report.style import PALETTE, plain_logarithms, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_WIDTH, _HEIGHT = 10.0, 6.2
_LINES_WITH_NAMES = 8
# What each axis shows beyond the lengths and records on it, as a factor.
_MARGIN = 2.0
_NAMED = "#8B1A1A"
# Least distance of two names, as a part of the height of the axes.
_APART = 0.03


def similarity_contours_figure(
    lengths: Floats,
    names: Sequence[str],
    wanted: Wanted,
    title: str,
    named: Mapping[str, float] | None = None,
) -> Figure:
    """Draw both diagrams.

    Parameters
    ----------
    lengths : ndarray, shape (n,)
        L_e of the records (m).
    names : sequence of str
        What they are called.
    wanted : Figure of a case
        Contours, kinds of joint and of isolator.
    title : str
        Above the figure.
    named : mapping of str to float, optional
        L_e (m) of motions that are named, in the place of those of the suite.
    """
    from matplotlib.figure import Figure

    heights = 1.0 / np.sort(lengths)[::-1]
    ordered = [names[i] for i in np.argsort(lengths)[::-1]]
    by_name = {name: 1.0 / length for name, length in (named or {}).items()}
    every = np.array([*heights, *by_name.values()])
    with styled():
        figure = Figure(figsize=(_WIDTH, _HEIGHT), layout="constrained")
        left, right = figure.subplots(1, 2, sharey=True)
        limits = every.min() / _MARGIN, every.max() * _MARGIN
        for axes, kinds, symbol, word in (
            (left, wanted.joints, r"\delta", r"gap $\delta$ (cm)"),
            (right, wanted.isolators, "{uy}", r"yield displacement $u_y$ (cm)"),
        ):
            _draw(axes, kinds, wanted, symbol, limits)
            _draw_records(axes, heights)
            for height in by_name.values():
                axes.axhline(height, color=_NAMED, linewidth=1.3)
            axes.set_xlabel(word)
            axes.set_ylim(*limits)
        if by_name:
            _name_lines(right, by_name, _NAMED)
        else:
            _name_records(right, heights, ordered)
        left.set_ylabel(r"inverse length scale $1/L_e = \omega_g^2/a_g$ (1/m)")
        handles, labels = left.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4)
        figure.suptitle(title, fontsize=10.0, wrap=True)
    return figure


def _draw(
    axes: Axes,
    kinds: Sequence[LengthRange],
    wanted: Wanted,
    symbol: str,
    limits: tuple[float, float],
) -> None:
    """Contours, the region of complete similarity, and a band for each kind."""
    lows, highs = [kind.low for kind in kinds] or [1e-3], [kind.high for kind in kinds] or [1e-1]
    x = np.geomspace(min(lows) / _MARGIN, max(highs) * _MARGIN, 200)
    plain_logarithms(axes)
    axes.set_xlim(100.0 * x[0], 100.0 * x[-1])
    axes.fill_between(
        100.0 * x,
        limits[0],
        np.maximum(wanted.similarity / x, limits[0]),
        color="#BBBBBB",
        alpha=0.6,
        linewidth=0.0,
        label=f"complete similarity, $\\Pi$ < {wanted.similarity:g}",
    )
    for value in wanted.contours:
        axes.plot(100.0 * x, value / x, color="#222222", linewidth=0.9)
        _name_contour(axes, x, value, f"$\\Pi_{symbol}$ = {value:g}", limits)
    for number, kind in enumerate(kinds):
        _draw_kind(axes, kind, PALETTE[number % len(PALETTE)], number)


def _name_contour(
    axes: Axes, x: Floats, value: float, words: str, limits: tuple[float, float]
) -> None:
    """The value of a contour, along it, near its upper left end."""
    low = max(x[0], value / limits[1])
    high = min(x[-1], value / limits[0])
    if low >= high:
        return
    place = low**0.8 * high**0.2
    axes.text(
        100.0 * place,
        value / place,
        words,
        fontsize=7.5,
        rotation=_falling_angle(axes, limits),
        rotation_mode="anchor",
        ha="center",
        va="bottom",
        bbox={"facecolor": "white", "alpha": 0.75, "linewidth": 0.0, "pad": 0.6},
    )


def _falling_angle(axes: Axes, limits: tuple[float, float]) -> float:
    """Angle at which a line of slope -1 is seen (degrees)."""
    low, high = axes.get_xlim()
    width = _WIDTH * 0.43 / np.log10(high / low)
    height = _HEIGHT * 0.80 / np.log10(limits[1] / limits[0])
    return -float(np.degrees(np.arctan2(height, width)))


def _draw_kind(axes: Axes, kind: LengthRange, color: str, number: int) -> None:
    """A band from the smallest to the largest length of a kind, or a line."""
    ends = 100.0 * kind.low, 100.0 * kind.high
    if kind.high > kind.low:
        axes.axvspan(*ends, color=color, alpha=0.16, linewidth=0.0)
    else:
        axes.axvline(ends[0], color=color, linewidth=1.2)
    axes.annotate(
        kind.name,
        (float(np.sqrt(ends[0] * ends[1])), 0.02),
        xycoords=("data", "axes fraction"),
        rotation=90,
        ha="center",
        va="bottom",
        fontsize=8.0,
        color=color,
        bbox={"facecolor": "white", "alpha": 0.8, "linewidth": 0.0, "pad": 1.0},
        zorder=6,
    )


def _draw_records(axes: Axes, heights: Floats) -> None:
    """A line for each record."""
    few = heights.size <= _LINES_WITH_NAMES
    for number, height in enumerate(heights):
        axes.axhline(
            height,
            color="#0072B2",
            linewidth=0.9 if few else 0.5,
            alpha=1.0 if few else 0.35,
            label="motions of the suite" if number == 0 else None,
        )


def _name_records(axes: Axes, heights: Floats, names: Sequence[str]) -> None:
    """Names of the lines beside the axes: of many the least, the middle and the largest."""
    few = heights.size <= _LINES_WITH_NAMES
    numbers = range(heights.size) if few else (0, heights.size // 2, heights.size - 1)
    _name_lines(axes, {names[i]: float(heights[i]) for i in numbers}, "#00436B")


def _name_lines(axes: Axes, heights: Mapping[str, float], color: str) -> None:
    """Names beside the right end of lines; of lines that are close the lower ones lower."""
    low, high = np.log(axes.get_ylim())
    last = np.inf
    for name, height in sorted(heights.items(), key=lambda item: -item[1]):
        place = min((np.log(height) - low) / (high - low), last - _APART)
        last = place
        axes.annotate(
            name,
            (1.0, height),
            (1.02, place),
            xycoords=("axes fraction", "data"),
            textcoords="axes fraction",
            va="center",
            fontsize=7.0,
            color=color,
            arrowprops={"arrowstyle": "-", "color": color, "linewidth": 0.5},
        )
