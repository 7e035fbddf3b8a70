"""Figure of fragility: the fitted curves, and what they were fitted to."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from eventpound.report import style
from eventpound.report.symbols import axis_label, display_unit, value_label
from eventpound.study.fragility import Fragility

_BINS = 8
"""Of runs that all have an intensity of their own."""


@style.styled()
def fragility_figure(
    curves: pd.DataFrame, table: pd.DataFrame, of: tuple[str, str], at: str = "", by: str = ""
) -> Figure:
    """Draw curves of fragility over an intensity, with the parts of the runs that exceed.

    Parameters
    ----------
    curves : DataFrame
        Of `eventpound.study.fragility.fragility_table`.
    table : DataFrame
        What they were fitted to.
    of : tuple of str
        Its columns of the intensity and of the demand.
    at : str
        At what the intensity is measured, a period and a damping.
    by : str
        Column of which each value has curves of its own; empty for none.
    """
    measure, demand = of
    whole = table.dropna(subset=[measure, demand])
    there = whole
    x = np.linspace(0.0, 1.15 * float(there[measure].max()), 400)[1:]
    unit = display_unit(measure, x[-1])
    figure = style.new_figure(7.5, 4.2, "")
    axes = figure.subplots()
    for (_, row), color in zip(curves.iterrows(), style.colors(len(curves)), strict=True):
        label = value_label(demand, float(row["limit"])).replace(" = ", " > ", 1)
        if by:
            there = whole[whole[by] == row[by]]
            label = f"{value_label(by, row[by])}, {label}"
        parts = _fractions(there[measure], there[demand] > row["limit"])
        circle: Any = {"color": color, "markersize": 4.0, "fillstyle": "none"}
        circles = axes.plot(parts.index / unit.size, parts, "o", **circle)
        if row["note"]:
            circles[0].set_label(f"{label}: no curve")
            continue
        fit = Fragility(row["theta"], row["beta"], row["error_ln_theta"], row["error_beta"])
        theta = rf"$\theta$ = {fit.theta / unit.size:.4g} {unit.name}"
        label += f"\n{theta}, $\\beta$ = {fit.beta:.3g}"
        axes.plot(x / unit.size, fit.probability(x), color=color, linewidth=1.5, label=label)
    axes.set(xlabel=axis_label(measure, unit, at), ylabel="probability of exceedance")
    axes.set(xlim=(0.0, x[-1] / unit.size), ylim=(-0.02, 1.02))
    style.legend_beside(axes, axes.get_legend_handles_labels()[0])
    style.show_as_written(figure)
    return figure


def _fractions(intensity: pd.Series[float], over: pd.Series[bool]) -> pd.Series[float]:
    """Parts of the runs that exceed, by intensities or middles of groups of them."""
    groups = over.groupby(intensity)
    if groups.ngroups > len(over) / 2:
        # Of runs that each have their own intensity, groups of equal numbers.
        place = pd.qcut(intensity, min(_BINS, len(over)), duplicates="drop")
        groups = over.groupby(intensity.groupby(place, observed=True).transform("median"))
    return groups.mean()
