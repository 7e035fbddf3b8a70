"""Figure of an incremental dynamic analysis: a thin line a record, fractiles across them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eventpound.report.style import PALETTE, show_as_written, styled
from eventpound.report.symbols import axis_label, display_unit, symbol
from eventpound.study.intensity import IntensityPlan
from eventpound.study.plan import Study
from eventpound.study.stated import stated

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

_SIZE = (6.0, 4.6)
_THIN = "#B5B5B5"


def intensity_figure(
    study: Study, plan: IntensityPlan, table: pd.DataFrame, curves: pd.DataFrame
) -> Figure:
    """Draw intensity over demand.

    Parameters
    ----------
    study : Study
        For the title and what is stated below.
    plan : IntensityPlan
        Which columns.
    table : DataFrame
        Table of the study.
    curves : DataFrame
        Its fractiles, of `fractile_curves`.
    """
    from matplotlib.figure import Figure

    demand, measure = (
        display_unit(key, float(table[key].abs().max())) for key in (plan.demand, plan.measure)
    )
    with styled():
        figure = Figure(figsize=_SIZE)
        axes = figure.subplots()
        label = f"each of {table[plan.records].nunique()} records"
        for _, record in table.groupby(plan.records):
            line = record.sort_values(plan.measure)
            x, y = line[plan.demand] / demand.size, line[plan.measure] / measure.size
            axes.plot(x, y, color=_THIN, linewidth=0.6, label=label)
            label = "_"
        for fractile, color in zip(curves.columns[2:], PALETTE, strict=False):
            axes.plot(
                curves[fractile] / demand.size,
                curves[plan.measure] / measure.size,
                color=color,
                linewidth=1.8,
                marker=".",
                label=f"{fractile} fractile",
            )
        axes.set_xlabel(axis_label(plan.demand, demand))
        axes.set_ylabel(axis_label(plan.measure, measure))
        if not (table[plan.demand] < 0.0).any():
            axes.set_xlim(left=0.0)
        axes.set_ylim(bottom=0.0)
        axes.set_title(study.title)
        axes.legend(loc="lower right")
        figure.text(0.02, 0.015, "\n".join(stated(study, symbol)), fontsize=7.5)
        show_as_written(figure)
        figure.tight_layout(rect=(0.0, 0.04, 1.0, 1.0))
    return figure
