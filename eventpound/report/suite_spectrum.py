"""Figure of a suite: the peak of every body against L_e, in groups of T_m (paper, Fig. 12)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from eventpound.numerics.arrays import Floats
from eventpound.report.style import PALETTE, literal, new_figure, plain_logarithms, styled
from eventpound.study.suite_statistics import Order, groups_of, order_of, peaks_of

_MARKERS = "os^DvPX*"
_WIDTH, _HEIGHT = 7.4, 3.1
_IN_A_COLUMN, _MOST_COLUMNS, _NARROW = 4, 3, 4.6
"""Panels one below the other, columns of them, and the width of one of several (in)."""


@styled()
def suite_spectrum_figure(
    table: pd.DataFrame, bodies: Mapping[str, str], groups: int, title: str
) -> Figure:
    """Draw the peaks of a suite.

    Parameters
    ----------
    table : DataFrame
        As `eventpound.simulate_suite` returns it; failed records are left out.
    bodies : mapping of str to str
        Bodies and what they are called: a panel each, row by row; a column for every four.
    groups : int
        Groups of T_m with the same number of records.
    title : str
        Above the figure.
    """
    columns = min(-(-len(bodies) // _IN_A_COLUMN), _MOST_COLUMNS)
    rows = -(-len(bodies) // columns)
    width = _WIDTH if columns == 1 else _NARROW * columns
    figure = new_figure(width, 0.5 + _HEIGHT * rows, title)
    panels = figure.subplots(rows, columns, squeeze=False, sharex=True).ravel()
    for axes, (body, name) in zip(panels, bodies.items(), strict=False):
        _draw(axes, table, body, groups, "; " if columns == 1 else "\n")
        axes.set_ylabel(rf"{literal(name)}: $u_{{\mathrm{{max}}}}$ (cm)")
    for axes in panels[len(bodies) :]:
        axes.set_visible(False)
    for axes in panels[: len(bodies)][-columns:]:
        axes.set_xlabel(r"energetic length scale $L_e = a_g/\omega_g^2$ (cm)")
        axes.tick_params(labelbottom=True)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _draw(axes: Axes, table: pd.DataFrame, body: str, groups: int, between: str) -> None:
    peaks, order = peaks_of(table, body), order_of(table, body)
    length, u = 100.0 * peaks["L_e"].to_numpy(), 100.0 * peaks["u"].to_numpy()
    periods = peaks["T_m"].to_numpy()
    group = groups_of(periods, groups)
    for number in range(groups):
        inside = group == number
        if not np.any(inside):
            continue
        own = periods[inside]
        look: Any = {"markersize": 4.5, "fillstyle": "none", "color": PALETTE[number]}
        look["label"] = rf"$T_m$ {own.min():.2f} to {own.max():.2f} s ({own.size})"
        axes.plot(length[inside], u[inside], _MARKERS[number], **look)
    if math.isfinite(order.scatter):
        _draw_line(axes, np.array([length.min(), length.max()]), order)
    plain_logarithms(axes)
    axes.set_title(between.join(_words(order)), loc="left")


def _draw_line(axes: Axes, ends: Floats, order: Order) -> None:
    """The line of least squares, and the band that holds two thirds of the records."""
    line = 100.0 * order.factor * (ends / 100.0) ** order.exponent
    axes.plot(ends, line, color="#444444", linewidth=0.9, label="line of least squares")
    spread = math.exp(order.scatter)
    look: Any = {"color": "#888888", "alpha": 0.15, "linewidth": 0.0, "zorder": 0}
    axes.fill_between(ends, line / spread, line * spread, label="one standard deviation", **look)


def _words(order: Order) -> list[str]:
    """Numbers of a panel; what is the same for all motions has no rank and no line."""
    ranks = {
        "$L_e$": order.rank_length,
        "PGA": order.rank_acceleration,
        "$T_m$": order.rank_period,
    }
    known = [f"{name} {rank:.2f}" for name, rank in ranks.items() if math.isfinite(rank)]
    words = [f"{order.records} motions"]
    if known:
        words.append(f"rank correlation with {', '.join(known)}")
    if math.isfinite(order.scatter):
        factor = math.exp(order.scatter)
        words.append(f"slope {order.exponent:.2f}, scatter a factor {factor:.2f}")
    return words
