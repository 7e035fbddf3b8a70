"""A panel of a study over two axes: a quantity in colours, and lines where it is the same."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.ticker import MaxNLocator

from eventpound.numerics.arrays import Floats

_MISSING, _LINE = "#BBBBBB", "#222222"
"""Colours of where no run has a value, and of lines."""
_MOST_LINES = 6


def colours_of(values: Floats, high: float | None, around_one: bool) -> tuple[Normalize, str]:
    """Range and name of the colours of values, shape (n,), up to a given one where that is said.

    Of a ratio that is judged by 1, and of values of both signs, they have two sides.
    """
    known = values[np.isfinite(values)]
    least, most = (known.min(), known.max()) if known.size else (0.0, 1.0)
    most = float(most) if high is None else high
    if around_one:
        away = max(most - 1.0, 1.0 - float(least)) or 1.0
        return Normalize(1.0 - away, 1.0 + away), "RdBu_r"
    if least < 0.0 < most:
        away = max(most, -float(least))
        return Normalize(-away, away), "RdBu_r"
    return Normalize(float(least), most if most > least else float(least) + 1.0), "viridis"


def draw_map(
    axes: Axes, grid: pd.DataFrame, colours: tuple[Normalize, str], levels: Sequence[float]
) -> None:
    """Draw a quantity in colours, with a bar beside them.

    Parameters
    ----------
    axes : Axes
        Where; linear or logarithmic already.
    grid : DataFrame
        The quantity: its columns are the abscissa, its rows the ordinate, both rising.
    colours : tuple of Normalize and str
        Of `colours_of`.
    levels : sequence of float
        Where lines are drawn; at round values where none are given.
    """
    x, y, values = (np.asarray(v, float) for v in (grid.columns, grid.index, grid))
    axes.set_facecolor(_MISSING)
    axes.grid(visible=False)
    borders = _borders(x, axes.get_xscale() == "log"), _borders(y, axes.get_yscale() == "log")
    known = values[np.isfinite(values)]
    mesh = axes.pcolormesh(*borders, np.ma.masked_invalid(values), norm=colours[0], cmap=colours[1])
    axes.figure.colorbar(mesh, ax=axes)
    if min(values.shape) < 2 or not known.size:
        return
    low, high = float(known.min()), float(known.max())
    wanted = levels or MaxNLocator(_MOST_LINES).tick_values(low, high)
    if inside := sorted(level for level in wanted if low < level < high):
        lines = axes.contour(
            x, y, np.ma.masked_invalid(values), inside, colors=_LINE, linewidths=0.7
        )
        axes.clabel(lines, fmt="%g", fontsize=7.0)


def _borders(middles: Floats, logarithmic: bool) -> Floats:
    """Borders of cells around n values, half-way between them as the axis has them, (n + 1,)."""
    m = np.log(middles) if logarithmic else middles
    half = np.diff(m) / 2.0 if m.size > 1 else np.array([0.5])
    found = np.concatenate((m[:1] - half[:1], m[:-1] + half[: m.size - 1], m[-1:] + half[-1:]))
    return np.exp(found) if logarithmic else found
