"""Work-precision diagram: error against wall time, a line a solver, the reference as floor."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from eventpound.accuracy.compare import Comparison
from eventpound.accuracy.comparison_tables import floor_of
from eventpound.accuracy.errors import PEAKS, Errors
from eventpound.accuracy.work_precision import Judged
from eventpound.report.style import Color, colors, png, styled

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SIZE = (8.6, 4.2)
_MARKERS = "osD^vP*X"
_BELOW = 10.0
"""How far the axis goes below the floor; smaller errors are drawn on its edge."""
_EDGE = 2.0
_ROUNDING = 1e-16


@dataclass(frozen=True)
class Measure:
    """What a panel shows.

    Parameters
    ----------
    label : str
        Its axis.
    of : callable
        Its error, from the errors of a run.
    floor : float
        What the reference may be off by; NaN where not known.
    """

    label: str
    of: Callable[[Errors], float]
    floor: float


def measures(comparison: Comparison) -> tuple[Measure, Measure]:
    """The two panels: peaks, and the whole motion."""
    check = comparison.reference.check
    return (
        Measure(
            "largest error of a peak / largest |u| of its body",
            lambda errors: errors.largest(PEAKS),
            floor_of(comparison, PEAKS),
        ),
        Measure(
            "graph distance of the motion",
            lambda errors: errors.distance.graph,
            check.distance.graph if check is not None else math.nan,
        ),
    )


def timed(comparison: Comparison) -> list[Judged]:
    """Runs that can be drawn as points: those with errors and a wall time."""
    return [run for run in comparison.runs if run.errors is not None and run.repeats > 0]


def work_precision_figure(comparison: Comparison) -> Figure:
    """Draw error against wall time.

    Parameters
    ----------
    comparison : Comparison
        With at least one timed run. Histories of other programs have no time and
        are drawn as horizontal lines.
    """
    from matplotlib.figure import Figure

    with styled():
        figure = Figure(figsize=_SIZE, layout="constrained")
        panels = figure.subplots(1, 2, sharex=True)
        for axes, measure in zip(panels, measures(comparison), strict=True):
            _draw(axes, comparison, measure)
        figure.legend(handles=_legend(comparison), loc="outside lower center", ncols=4)
        figure.suptitle(comparison.case.title, fontsize=10.0, wrap=True)
    return figure


def work_precision_png(comparison: Comparison) -> bytes:
    """The diagram as a PNG file."""
    return png(work_precision_figure(comparison))


def _lines(comparison: Comparison) -> dict[str, Color]:
    """A colour for each line, by its label; those of other programs come last."""
    labels = list(dict.fromkeys(run.label for run in comparison.runs if run.errors is not None))
    return dict(zip(labels, colors(len(labels)), strict=True))


def _draw(axes: Axes, comparison: Comparison, measure: Measure) -> None:
    shades = _lines(comparison)
    bottom = _bottom(comparison, measure)
    for number, (label, color) in enumerate(shades.items()):
        points = [run for run in timed(comparison) if run.label == label]
        drawn = [
            (1e3 * run.seconds, max(measure.of(run.errors), bottom), run)
            for run in points
            if run.errors is not None and not math.isnan(measure.of(run.errors))
        ]
        _draw_line(axes, drawn, color, _MARKERS[number % len(_MARKERS)])
        for run in comparison.runs:
            if run.label == label and run.entry is None and run.errors is not None:
                error = max(measure.of(run.errors), bottom)
                axes.axhline(error, color=color, linestyle=(0, (5, 2)))
    axes.set(xscale="log", yscale="log", xlabel="wall time (ms)", ylabel=measure.label)
    axes.margins(x=0.12)
    axes.set_ylim(bottom / _EDGE, _top(comparison, measure, bottom) * _EDGE)
    _draw_floor(axes, measure.floor, bottom)


def _draw_line(
    axes: Axes, points: list[tuple[float, float, Judged]], color: Color, marker: str
) -> None:
    """Points joined in the order of their tolerance; open where impacts are wrong."""
    axes.plot([x for x, _, _ in points], [y for _, y, _ in points], color=color, zorder=3)
    for x, y, run in points:
        right = run.errors is not None and not (
            run.errors.impacts.missed or run.errors.impacts.extra
        )
        fill = color if right else "white"
        axes.plot(x, y, marker, color=color, markerfacecolor=fill, markersize=5.0, zorder=4)
    for x, y, run in {id(p[2]): p for p in (points[:1] + points[-1:])}.values():
        axes.annotate(
            run.size.removeprefix("rtol ").removeprefix("step "),
            (x, y),
            xytext=(4, 3),
            textcoords="offset points",
            fontsize=7.0,
            color=color,
        )


def _positive(comparison: Comparison, measure: Measure) -> list[float]:
    """Errors that have a logarithm."""
    known = [measure.of(run.errors) for run in comparison.runs if run.errors is not None]
    return [error for error in known if error > 0.0]


def _bottom(comparison: Comparison, measure: Measure) -> float:
    """Smallest error drawn: below the floor, or below the smallest error without one."""
    if measure.floor > 0.0:
        return measure.floor / _BELOW
    return min(_positive(comparison, measure), default=_ROUNDING) / _BELOW


def _top(comparison: Comparison, measure: Measure, bottom: float) -> float:
    """Largest error drawn; well above the floor where there is little to show."""
    return max([*_positive(comparison, measure), bottom * _BELOW**2])


def _draw_floor(axes: Axes, floor: float, bottom: float) -> None:
    """Shade errors that the reference itself may have."""
    if not floor > 0.0:
        return
    axes.axhspan(bottom / _EDGE, floor, color="#DDDDDD", alpha=0.6, linewidth=0.0, zorder=1)
    axes.text(
        0.99,
        floor,
        f"the reference is known to {floor:.0e}",
        transform=axes.get_yaxis_transform(),
        ha="right",
        va="top",
        fontsize=7.0,
        color="#555555",
    )


def _legend(comparison: Comparison) -> list[Artist]:
    from matplotlib.lines import Line2D

    handles: list[Artist] = []
    known = {run.label for run in timed(comparison)}
    for number, (label, color) in enumerate(_lines(comparison).items()):
        marker = _MARKERS[number % len(_MARKERS)]
        style = (
            Line2D([], [], c=color, marker=marker, markersize=5.0, label=label)
            if label in known
            else Line2D([], [], c=color, linestyle=(0, (5, 2)), label=label)
        )
        handles.append(style)
    if any(
        r.errors and (r.errors.impacts.missed or r.errors.impacts.extra) for r in comparison.runs
    ):
        handles.append(
            Line2D(
                [], [], color="#444444", marker="o", markerfacecolor="white", markersize=5.0,
                linestyle="none", label="impacts missed or extra",
            )
        )  # fmt: skip
    return handles
