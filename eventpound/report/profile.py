"""Figure of profiles: peak displacements and storey drifts over the height of a structure."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from eventpound.numerics.arrays import Floats
from eventpound.report import style
from eventpound.report.towers import Tower, towers_of
from eventpound.report.view import Beside, View
from eventpound.results.trade import Unit

_PERCENT = Unit("%", 0.01)


@style.styled()
def profile_figure(view: View, beside: Beside | None = None) -> Figure:
    """Draw the profiles of a run, with both extremes of every number.

    Parameters
    ----------
    view : View
        Results of a run with `towers_of` it.
    beside : Beside, optional
        Another run of the same structures, drawn pale.
    """
    towers = towers_of(view)
    figure = style.new_figure(7.5, 4.0)
    left, right = figure.subplots(1, 2, sharey=True)
    units = _units(view, towers)
    handles = []
    for tower, color in zip(towers, style.PALETTE, strict=False):
        name = f"{tower.bodies[0]} to {tower.bodies[-1]}"
        handles.append(Line2D([], [], color=color, label=style.literal(name)))
        _draw_tower((left, right), view, tower, units, {"color": color, "linewidth": 1.5})
        if beside is not None:
            pale = {"color": color, "linewidth": 0.9, "alpha": 0.45}
            _draw_tower((left, right), beside.view, tower, units, pale)
    if beside is not None:
        handles.append(
            Line2D([], [], color="#444444", alpha=0.45, label=style.literal(beside.name))
        )
    drift = "drift ratio" if units[1] is _PERCENT else "drift"
    for axes, name, unit in zip((left, right), ("displacement", drift), units, strict=True):
        style.zero_lines(axes, upright=True, level=False)
        axes.set_xlabel(f"{name} ({unit.name})")
    _name_levels(left, towers)
    style.legend_beside(right, handles)
    return figure


def _units(view: View, towers: Sequence[Tower]) -> tuple[Unit, Unit]:
    """Of displacements and of drifts, which are ratios where all heights are known."""
    u, drifts = zip(*(_extremes(view, tower) for tower in towers), strict=True)
    in_percent = all(tower.heights for tower in towers)
    of_drift = _PERCENT if in_percent else view.length_unit(style.largest_size(*drifts))
    return view.length_unit(style.largest_size(*u)), of_drift


def _extremes(view: View, tower: Tower) -> tuple[Floats, Floats]:
    """Least and greatest displacement of each body, and drift of each storey, shape (2, n) (m)."""
    summary = view.results.summary
    peaks = [summary["peaks"][name] for name in tower.bodies]
    drifts = [summary["springs"][spring.name] for spring in tower.storeys]
    return (
        np.array([[peak[word] for peak in peaks] for word in ("min", "max")]),
        np.array([[drift[f"{word}_elongation"] for drift in drifts] for word in ("min", "max")]),
    )


def _draw_tower(
    panels: tuple[Axes, Axes],
    view: View,
    tower: Tower,
    units: tuple[Unit, Unit],
    look: dict[str, Any],
) -> None:
    """Both profiles of one structure."""
    u, drift = _extremes(view, tower)
    levels = np.array(tower.levels)
    if units[1] is _PERCENT:
        # Isolators have no height, and no drift ratio.
        heights = np.array(tower.heights)
        drift = np.divide(drift, heights, out=np.full(drift.shape, np.nan), where=heights > 0.0)
    look_of_steps: Any = {"orientation": "horizontal", "baseline": None, "zorder": 2, **look}
    for side in range(2):
        # From the ground, which does not move against itself.
        moved = np.concatenate([[0.0], u[side]]) / units[0].size
        panels[0].plot(moved, levels, marker=".", **look)
        panels[1].stairs(drift[side] / units[1].size, levels, **look_of_steps)


def _name_levels(axes: Axes, towers: Sequence[Tower]) -> None:
    """Heights, or storeys by the names of the bodies where there is one structure."""
    if all(tower.heights for tower in towers):
        axes.set_ylabel("height (m)")
    elif len(towers) == 1:
        axes.set_yticks(towers[0].levels, ["ground", *map(style.literal, towers[0].bodies)])
    else:
        axes.set_yticks(range(1 + max(len(tower.bodies) for tower in towers)))
        axes.set_ylabel("floor")
