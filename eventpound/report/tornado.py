"""Figure of sensitivities: a tornado for each quantity, the largest elasticity at its top."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from eventpound.report import style
from eventpound.report.symbols import symbol, value_label

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
