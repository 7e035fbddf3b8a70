"""Figures of a study: curves of intensity, of fragility, and sensitivities."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from eventpound.report import style
from eventpound.report.notes import add_notes
from eventpound.report.symbols import axis_label, display_unit, symbol, value_label
from eventpound.study.fragility import Fragility
from eventpound.study.intensity import IntensityPlan
from eventpound.study.plan import Plan
from eventpound.study.stated import measured_at, stated


@style.styled()
def intensity_figure(
    study: Plan, plan: IntensityPlan, table: pd.DataFrame, curves: pd.DataFrame
) -> Figure:
    """Draw intensity over demand.

    Parameters
    ----------
    study : Plan
        For the title and what is stated below.
    plan : IntensityPlan
        Which columns.
    table : DataFrame
        Table of the study.
    curves : DataFrame
        Its fractiles, of `fractile_curves`.
    """
    demand, measure = (
        display_unit(key, float(table[key].abs().max())) for key in (plan.demand, plan.measure)
    )
    figure = style.new_figure(6.0, 4.4, study.title)
    axes = figure.subplots()
    label = f"each of {table[plan.records].nunique()} records"
    for _, record in table.groupby(plan.records):
        line = record.sort_values(plan.measure)
        x, y = line[plan.demand] / demand.size, line[plan.measure] / measure.size
        axes.plot(x, y, color="#B5B5B5", linewidth=0.6, label=label)
        label = "_"
    for fractile, color in zip(curves.columns[2:], style.PALETTE, strict=False):
        x, y = curves[fractile] / demand.size, curves[plan.measure] / measure.size
        look: Any = {
            "color": color,
            "linewidth": 1.8,
            "marker": ".",
            "label": f"{fractile} fractile",
        }
        axes.plot(x, y, **look)
    at = measured_at(study).get(plan.measure, "")
    axes.set(xlabel=axis_label(plan.demand, demand), ylabel=axis_label(plan.measure, measure, at))
    if not (table[plan.demand] < 0.0).any():
        axes.set_xlim(left=0.0)
    axes.set_ylim(bottom=0.0)
    axes.legend(loc="lower right")
    add_notes(figure, list(stated(study, symbol)))
    style.show_as_written(figure)
    return figure


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


_MOST = 12
"""Bars of a panel."""


@style.styled()
def tornado_figure(table: pd.DataFrame, title: str = "") -> Figure | None:
    """Draw elasticities as bars with their errors, and crosses where there is no derivative.

    Parameters
    ----------
    table : DataFrame
        Of `eventpound.sensitivities`.
    title : str
        Above it.

    Returns
    -------
    Figure or None
        None where no quantity has an elasticity.
    """
    drawn = table.dropna(subset="elasticity").groupby("quantity", sort=False)
    parts = [part.head(_MOST) for _, part in drawn]
    if not parts:
        return None
    heights = [1.5 + len(part) for part in parts]
    figure = style.new_figure(7.0, 0.5 + 0.24 * sum(heights), style.literal(title))
    panels = figure.subplots(len(parts), 1, squeeze=False, height_ratios=heights)[:, 0]
    for axes, part in zip(panels, parts, strict=True):
        _panel(axes, part)
    panels[-1].set_xlabel("change (%) for 1 % of the number")
    style.show_as_written(figure)
    return figure


def _panel(axes: Axes, part: pd.DataFrame) -> None:
    """The bars of one quantity."""
    noted = (part["note"] != "").to_numpy()
    sizes = part["elasticity"].mask(noted, 0.0).to_numpy(float)
    errors = (part["error"] * part["at"] / part["value"]).abs().mask(noted, 0.0).to_numpy(float)
    places = np.arange(len(part))
    colors = [style.PALETTE[1 if size < 0.0 else 0] for size in sizes]
    thin: Any = {"elinewidth": 0.8, "capsize": 2.0}
    axes.barh(places, sizes, 0.7, xerr=errors, color=colors, error_kw=thin, zorder=2)
    if noted.any():
        cross: Any = {"color": style.PALETTE[7], "markersize": 5.0, "label": "no derivative"}
        axes.plot(np.zeros(noted.sum()), places[noted], "x", **cross)
        axes.legend(loc="lower right")
    style.zero_lines(axes, upright=True, level=False)
    axes.set_yticks(places, [symbol(key) for key in part["to"]])
    axes.invert_yaxis()
    axes.grid(axis="y", visible=False)
    first = part.iloc[0]
    axes.set_title(value_label(str(first["quantity"]), float(first["value"])), loc="left")
