"""Figure of fragility: the fitted curves, and what they were fitted to."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eventpound.report.style import colors, legend_beside, literal, show_as_written, styled
from eventpound.report.symbols import axis_label, display_unit, value_label
from eventpound.study.fragility import Fragility

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

_BINS = 8
"""Of runs that all have an intensity of their own."""


def fragility_figure(
    curves: pd.DataFrame, table: pd.DataFrame, measure: str, demand: str, title: str = ""
) -> Figure:
    """Draw curves of fragility over an intensity, with the parts of the runs that exceed.

    Parameters
    ----------
    curves : DataFrame
        Of `eventpound.study.fragility.fragility_table`.
    table : DataFrame
        What they were fitted to.
    measure, demand : str
        Its columns.
    title : str
        Above it.
    """
    from matplotlib.figure import Figure

    there = table[[measure, demand]].dropna()
    x = np.linspace(0.0, 1.15 * float(there[measure].max()), 400)[1:]
    unit = display_unit(measure, x[-1])
    with styled():
        figure = Figure(figsize=(7.5, 4.2), layout="constrained")
        axes = figure.subplots()
        for (_, row), color in zip(curves.iterrows(), colors(len(curves)), strict=True):
            label = value_label(demand, float(row["limit"])).replace(" = ", " > ", 1)
            places, parts = _fractions(there[measure], there[demand] > row["limit"])
            axes.plot(
                np.array(places) / unit.size,
                parts,
                "o",
                color=color,
                markersize=4,
                fillstyle="none",
            )
            if row["note"]:
                axes.plot([], [], "o", color=color, fillstyle="none", label=f"{label}: no curve")
                continue
            fit = Fragility(row["theta"], row["beta"], row["error_ln_theta"], row["error_beta"])
            label += (
                "\n"
                + rf"$\theta$ = {fit.theta / unit.size:.4g} {unit.name}, $\beta$ = {fit.beta:.3g}"
            )
            axes.plot(x / unit.size, fit.probability(x), color=color, linewidth=1.5, label=label)
        axes.set_xlabel(axis_label(measure, unit))
        axes.set_ylabel("probability of exceedance")
        axes.set_xlim(0.0, x[-1] / unit.size)
        axes.set_ylim(-0.02, 1.02)
        legend_beside(
            axes, [line for line in axes.get_lines() if not str(line.get_label()).startswith("_")]
        )
        figure.suptitle(literal(title), fontsize=10.0)
        show_as_written(figure)
    return figure


def _fractions(
    intensity: pd.Series[float], over: pd.Series[bool]
) -> tuple[list[float], list[float]]:
    """Intensities, or middles of groups of them, and parts of the runs there that exceed."""
    import pandas as pd

    groups = over.groupby(intensity)
    if groups.ngroups > len(over) / 2:
        # Of runs that each have their own intensity, groups of equal numbers.
        place = pd.qcut(intensity, min(_BINS, len(over)), duplicates="drop")
        groups = over.groupby(intensity.groupby(place, observed=True).transform("median"))
    parts = groups.mean()
    return list(parts.index), list(parts)
