"""Figure of an incremental dynamic analysis: a thin line a record, fractiles across them."""

from __future__ import annotations

from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from eventpound.report.notes import add_notes
from eventpound.report.style import PALETTE, new_figure, show_as_written, styled
from eventpound.report.symbols import axis_label, display_unit, symbol
from eventpound.study.intensity import IntensityPlan
from eventpound.study.plan import Plan
from eventpound.study.stated import measured_at, stated


@styled()
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
    figure = new_figure(6.0, 4.4, study.title)
    axes = figure.subplots()
    label = f"each of {table[plan.records].nunique()} records"
    for _, record in table.groupby(plan.records):
        line = record.sort_values(plan.measure)
        x, y = line[plan.demand] / demand.size, line[plan.measure] / measure.size
        axes.plot(x, y, color="#B5B5B5", linewidth=0.6, label=label)
        label = "_"
    for fractile, color in zip(curves.columns[2:], PALETTE, strict=False):
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
    show_as_written(figure)
    return figure
