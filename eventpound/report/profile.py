"""Figure of profiles: peak displacements and storey drifts over the height of a structure."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.report.style import (
    PALETTE,
    Unit,
    largest_size,
    legend_beside,
    literal,
    styled,
)
from eventpound.report.towers import Tower, towers_of
from eventpound.report.view import Beside, View

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_PERCENT = Unit("%", 0.01)


def profile_figure(view: View, beside: Beside | None = None) -> Figure:
    """Draw the profiles of a run, with both extremes of every number.

    Parameters
    ----------
    view : View
        Results of a run with `towers_of` it.
    beside : Beside, optional
        Another run of the same structures, drawn pale.
    """
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    towers = towers_of(view)
    in_percent = all(tower.heights for tower in towers)
    with styled():
        figure = Figure(figsize=(7.5, 4.0), layout="constrained")
        left, right = figure.subplots(1, 2, sharey=True)
        units = _units(view, towers, in_percent)
        runs = [(view, {"linewidth": 1.5})]
        if beside is not None:
            runs.append((beside.view, {"linewidth": 0.9, "alpha": 0.45}))
        for run, look in runs:
            for tower, color in zip(towers, PALETTE, strict=False):
                _draw_tower((left, right), run, tower, units, {"color": color, **look})
        for axes, name in ((left, "displacement"), (right, "drift")):
            unit = units[axes is right]
            axes.axvline(0.0, color="#BBBBBB", linewidth=0.6, zorder=1)
            axes.set_xlabel(f"{'drift ratio' if unit is _PERCENT else name} ({unit.name})")
        _name_levels(left, towers)
        handles = [
            Line2D([], [], color=color, label=f"{tower.bodies[0]} to {tower.bodies[-1]}")
            for tower, color in zip(towers, PALETTE, strict=False)
        ]
        if beside is not None:
            grey = "#444444"
            handles.append(Line2D([], [], color=grey, alpha=0.45, label=literal(beside.name)))
        legend_beside(right, [*handles])
    return figure


def _units(view: View, towers: Sequence[Tower], in_percent: bool) -> tuple[Unit, Unit]:
    """Of displacements and of drifts."""
    u = [np.array(_extremes(view, tower)[0]) for tower in towers]
    drifts = [np.array(_extremes(view, tower)[1]) for tower in towers]
    of_drift = _PERCENT if in_percent else view.length_unit(largest_size(*drifts))
    return view.length_unit(largest_size(*u)), of_drift


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
    for side in range(2):
        # From the ground, which does not move against itself.
        moved = np.concatenate([[0.0], u[side]]) / units[0].size
        panels[0].plot(moved, levels, marker=".", **look)
        panels[1].stairs(
            drift[side] / units[1].size, levels, orientation="horizontal", baseline=None, **look
        )


def _name_levels(axes: Axes, towers: Sequence[Tower]) -> None:
    """Heights, or storeys by the names of the bodies where there is one structure."""
    if all(tower.heights for tower in towers):
        axes.set_ylabel("height (m)")
    elif len(towers) == 1:
        axes.set_yticks(towers[0].levels, ["ground", *map(literal, towers[0].bodies)])
    else:
        axes.set_yticks(range(1 + max(len(tower.bodies) for tower in towers)))
        axes.set_ylabel("floor")
