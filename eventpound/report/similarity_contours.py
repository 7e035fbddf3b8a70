"""Figure of Π_δ and Π_uy against gap, yield displacement and 1/L_e (paper, Fig. 3).

Π = length / L_e, so that a contour is 1/L_e = Π / length: a straight line of
slope -1 where both axes are logarithmic. Below the contour of complete
similarity the response no longer depends on the gap or the yield displacement, says the paper.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from eventpound.case.figure import Figure as Wanted
from eventpound.case.figure import LengthRange
from eventpound.numerics.arrays import Floats
from eventpound.report.style import PALETTE, new_figure, plain_logarithms, styled

_LINES_WITH_NAMES = 8
# What each axis shows beyond the lengths and records on it, as a factor.
_MARGIN = 2.0
_NAMED, _RECORDS = "#8B1A1A", "#00436B"
# Least distance of two names, as a part of the height of the axes.
_APART = 0.03
_WHITE: Any = {"facecolor": "white", "alpha": 0.8, "linewidth": 0.0, "pad": 0.8}


@styled()
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
    order = np.argsort(lengths)[::-1]
    heights = 1.0 / lengths[order]
    by_name = {name: 1.0 / length for name, length in (named or {}).items()}
    every = np.array([*heights, *by_name.values()])
    limits = every.min() / _MARGIN, every.max() * _MARGIN
    figure = new_figure(10.0, 6.2, title)
    left, right = figure.subplots(1, 2, sharey=True)
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
    few = heights.size <= _LINES_WITH_NAMES
    # Of many records the least, the middle and the largest.
    numbers = range(heights.size) if few else (0, heights.size // 2, heights.size - 1)
    of_suite = {names[order[i]]: float(heights[i]) for i in numbers}
    _name_lines(right, by_name or of_suite, _NAMED if by_name else _RECORDS)
    left.set_ylabel(r"inverse length scale $1/L_e = \omega_g^2/a_g$ (1/m)")
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=4)
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
    region: Any = {"color": "#BBBBBB", "alpha": 0.6, "linewidth": 0.0}
    region["label"] = f"complete similarity, $\\Pi$ < {wanted.similarity:g}"
    top = np.maximum(wanted.similarity / x, limits[0])
    axes.fill_between(100.0 * x, limits[0], top, **region)
    for value in wanted.contours:
        axes.plot(100.0 * x, value / x, color="#222222", linewidth=0.9)
        low, high = max(x[0], value / limits[1]), min(x[-1], value / limits[0])
        if low < high:
            _name_contour(axes, low**0.8 * high**0.2, value, f"$\\Pi_{symbol}$ = {value:g}")
    for kind, color in zip(kinds, PALETTE * (1 + len(kinds) // len(PALETTE)), strict=False):
        _draw_kind(axes, kind, color)


def _name_contour(axes: Axes, place: float, value: float, words: str) -> None:
    """The value of a contour, along it, where its length (m) is this."""
    falls = -float(np.degrees(np.arctan(value / (100.0 * place**2))))
    look: Any = {"ha": "center", "va": "bottom", "fontsize": 7.5, "bbox": _WHITE}
    turned: Any = {"rotation_mode": "anchor", "transform_rotates_text": True}
    axes.text(100.0 * place, value / place, words, rotation=falls, **turned, **look)


def _draw_kind(axes: Axes, kind: LengthRange, color: str) -> None:
    """A band from the smallest to the largest length of a kind, or a line."""
    ends = 100.0 * kind.low, 100.0 * kind.high
    if kind.high > kind.low:
        axes.axvspan(*ends, color=color, alpha=0.16, linewidth=0.0)
    else:
        axes.axvline(ends[0], color=color, linewidth=1.2)
    look: Any = {"ha": "center", "va": "bottom", "fontsize": 8.0, "bbox": _WHITE, "zorder": 6}
    place = float(np.sqrt(ends[0] * ends[1])), 0.02
    foot = axes.get_xaxis_transform()
    axes.text(*place, kind.name, rotation=90, color=color, transform=foot, **look)


def _draw_records(axes: Axes, heights: Floats) -> None:
    """A line for each record, paler where there are many."""
    width, alpha = (0.9, 1.0) if heights.size <= _LINES_WITH_NAMES else (0.5, 0.35)
    for number, height in enumerate(heights):
        label = "_" if number else "motions of the suite"
        axes.axhline(height, color=PALETTE[0], linewidth=width, alpha=alpha, label=label)


def _name_lines(axes: Axes, heights: Mapping[str, float], color: str) -> None:
    """Names beside the right end of lines; of lines that are close the lower ones lower."""
    low, high = np.log(axes.get_ylim())
    last = np.inf
    look: Any = {"va": "center", "fontsize": 7.0, "color": color}
    look |= {"xycoords": ("axes fraction", "data"), "textcoords": "axes fraction"}
    look["arrowprops"] = {"arrowstyle": "-", "color": color, "linewidth": 0.5}
    for name, height in sorted(heights.items(), key=lambda item: -item[1]):
        last = min((np.log(height) - low) / (high - low), last - _APART)
        axes.annotate(name, (1.0, height), (1.02, last), **look)
