"""Work-precision diagrams: error against wall time, a line a solver, the reference as floor."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from eventpound.accuracy.compare import Comparison
from eventpound.accuracy.comparison_tables import floor_of
from eventpound.accuracy.errors import PEAKS, Errors
from eventpound.accuracy.work_precision import Judged
from eventpound.report.style import Color, colors, png, styled

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SIZE, _PANEL = (8.6, 4.2), (2.6, 2.2)
_COLUMNS = 4
_MARKERS = "osD^vP*X"
_MARKER_SIZE = 4.5
_DASHES = (0, (5, 2))
_DOTS: Literal[":"] = ":"
_LAWS: Literal["-."] = "-."
"""Of errors against the rigid law: of runs, and of contact laws alone."""
_GREY = "#444444"
_BELOW, _EDGE = 10.0, 2.0
"""How far the axis goes below the floor, smaller errors being drawn there; and its margin."""
_ROUNDING = 1e-16
_SHADE = "#DDDDDD"
_DECADE = 20.0
"""Least ratio of the ends of the axis of times."""


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
    known_by : str
        What is said of the floor.
    """

    label: str
    of: Callable[[Errors], float]
    floor: float
    known_by: str = "reference known to"


@dataclass(frozen=True)
class Look:
    """Colour and marker of a line."""

    color: Color
    marker: str


def peak_measure(comparison: Comparison) -> Measure:
    """The largest error of a peak."""
    certified = comparison.reference.stated is not None
    return Measure(
        "largest error of a peak / largest |u|",
        lambda errors: errors.largest(PEAKS),
        floor_of(comparison.reference, PEAKS),
        "certified to" if certified else "reference known to",
    )


def graph_measure(comparison: Comparison) -> Measure:
    """The graph distance of the whole motion."""
    check = comparison.reference.check
    return Measure(
        "graph distance of the motion",
        lambda errors: errors.distance.graph,
        check.distance.graph if check is not None else math.nan,
    )


def timed(comparison: Comparison) -> list[Judged]:
    """Runs that can be drawn as points: those with errors and a wall time."""
    return [run for run in comparison.runs if run.errors is not None and run.repeats > 0]


def work_precision_figure(comparison: Comparison) -> Figure:
    """Draw error of the peaks and of the motion against wall time.

    Parameters
    ----------
    comparison : Comparison
        With at least one timed run. Histories of other programs have no time and
        are drawn as horizontal lines.
    """
    from matplotlib.figure import Figure

    looks = _looks([comparison])
    with styled():
        figure = Figure(figsize=_SIZE, layout="constrained")
        panels = figure.subplots(1, 2, sharex=True)
        for axes, measure in zip(panels, (peak_measure, graph_measure), strict=True):
            _draw(axes, comparison, measure(comparison), looks)
            _name_ends(axes, comparison, measure(comparison), looks)
            _name_floor(axes, measure(comparison))
            axes.set(xlabel="wall time (ms)", ylabel=measure(comparison).label)
        handles = _legend([comparison], looks)
        # Rows of equal length, of four entries at most.
        columns = math.ceil(len(handles) / math.ceil(len(handles) / 4))
        figure.legend(handles=handles, loc="outside lower center", ncols=columns)
        figure.suptitle(comparison.case.title, fontsize=10.0, wrap=True)
    return figure


def work_precision_grid(
    comparisons: Sequence[Comparison], size: tuple[float, float] = _PANEL
) -> Figure:
    """Draw graph distance against wall time, a panel a case; shaded: below the reference.

    Parameters
    ----------
    comparisons : sequence of Comparison
        Each with at least one timed run.
    size : (float, float)
        Of a panel (inches).
    """
    from matplotlib.figure import Figure

    looks = _looks(comparisons)
    columns = min(_COLUMNS, len(comparisons))
    rows = math.ceil(len(comparisons) / columns)
    with styled():
        whole = (size[0] * columns, size[1] * rows + 0.6)
        figure = Figure(figsize=whole, layout="constrained")
        panels = figure.subplots(rows, columns, squeeze=False).ravel()
        for axes, comparison in zip(panels, comparisons, strict=False):
            _draw(axes, comparison, graph_measure(comparison), looks)
            axes.set_title(comparison.case.title)
        for axes in panels[len(comparisons) :]:
            axes.set_axis_off()
        figure.supxlabel("wall time (ms)", fontsize=9.0)
        figure.supylabel("graph distance of the motion", fontsize=9.0)
        handles = _legend(comparisons, looks)
        figure.legend(handles=handles, loc="outside upper center", ncols=max(2, columns))
    return figure


def work_precision_png(comparison: Comparison) -> bytes:
    """The diagram as a PNG file."""
    return png(work_precision_figure(comparison))


_Box = tuple[float, float, float, float]
"""Left, right, lower and upper end, as parts of the axes."""
_LETTER = (0.016, 0.035)
"""Width and height of a letter of a label, likewise."""


def _looks(comparisons: Sequence[Comparison]) -> dict[str, Look]:
    """A colour and a marker for each line, by its label."""
    labels = list(
        dict.fromkeys(r.label for c in comparisons for r in c.runs if r.errors is not None)
    )
    return {
        label: Look(color, _MARKERS[i % len(_MARKERS)])
        for i, (label, color) in enumerate(zip(labels, colors(len(labels)), strict=True))
    }


def _draw(axes: Axes, comparison: Comparison, measure: Measure, looks: dict[str, Look]) -> None:
    """Lines of all solvers and the floor, on logarithmic axes."""
    bottom = _bottom(comparison, measure)
    for label, look in looks.items():
        points = _points(comparison, measure, label)
        axes.plot([x for x, _, _ in points], [y for _, y, _ in points], color=look.color, zorder=3)
        for x, y, run in points:
            fill = "white" if _wrong(run) else look.color
            axes.plot(
                x, y, look.marker, color=look.color, markerfacecolor=fill,
                markersize=_MARKER_SIZE, zorder=4,
            )  # fmt: skip
        for run in comparison.runs:
            if run.label == label and run.entry is None and run.errors is not None:
                error = max(measure.of(run.errors), bottom)
                axes.axhline(error, color=look.color, linestyle=_DASHES)
    _draw_rigid(axes, comparison, measure, looks)
    axes.set(xscale="log", yscale="log")
    axes.margins(x=0.12)
    _at_least_a_decade(axes)
    top = max([*_positive(comparison, measure), bottom * _BELOW**2])
    axes.set_ylim(bottom / _EDGE, top * _EDGE)
    if measure.floor > 0.0:
        span = (bottom / _EDGE, measure.floor)
        axes.axhspan(*span, color=_SHADE, alpha=0.6, linewidth=0.0, zorder=1)


def _draw_rigid(
    axes: Axes, comparison: Comparison, measure: Measure, looks: dict[str, Look]
) -> None:
    """Errors against the rigid law, dotted, and that of the contact laws alone."""
    bottom = _bottom(comparison, measure)
    if comparison.laws is None:
        return
    alone = max(measure.of(comparison.laws), bottom)
    axes.axhline(alone, color=_GREY, linestyle=_LAWS, linewidth=1.0, zorder=2)
    for label, look in looks.items():
        points = _rigid_points(comparison, measure, label)
        times, errors = [x for x, _ in points], [y for _, y in points]
        axes.plot(
            times, errors, look.marker, color=look.color, markersize=0.6 * _MARKER_SIZE,
            linestyle=_DOTS, zorder=3,
        )  # fmt: skip


def _rigid_points(
    comparison: Comparison, measure: Measure, label: str
) -> list[tuple[float, float]]:
    """Wall time (ms) and error against the rigid law of the points of a line."""
    bottom = _bottom(comparison, measure)
    return [
        (1e3 * run.seconds, max(measure.of(run.rigid), bottom))
        for run in timed(comparison)
        if run.label == label and run.rigid is not None
    ]


def _at_least_a_decade(axes: Axes) -> None:
    """Widen an axis of times so short that numbers between decades would be written."""
    left, right = axes.get_xlim()
    wider = math.sqrt(max(1.0, _DECADE * left / right))
    axes.set_xlim(left / wider, right * wider)
    axes.xaxis.set_minor_formatter("")


def _points(
    comparison: Comparison, measure: Measure, label: str
) -> list[tuple[float, float, Judged]]:
    """Wall time (ms), error and run of the points of a line, in the order of its runs."""
    bottom = _bottom(comparison, measure)
    errors = [
        (run, measure.of(run.errors))
        for run in timed(comparison)
        if run.label == label and run.errors is not None
    ]
    return [
        (1e3 * run.seconds, max(error, bottom), run)
        for run, error in errors
        if not math.isnan(error)
    ]


def _name_ends(
    axes: Axes, comparison: Comparison, measure: Measure, looks: dict[str, Look]
) -> None:
    """Write tolerance or step beside the first and the last point of each line."""
    points = {label: _points(comparison, measure, label) for label in looks}
    taken = [_place(axes, x, y) for line in points.values() for x, y, _ in line]
    rigid = [_rigid_points(comparison, measure, label) for label in looks]
    taken += [_place(axes, x, y) for line in rigid for x, y in line]
    boxes = [(x, x, y, y) for x, y in taken]
    for label, look in looks.items():
        line = points[label]
        for x, y, run in (line[0], line[-1]) if len(line) > 1 else line:
            text = run.size.removeprefix("rtol ").removeprefix("step ")
            side, box = _free_side(_place(axes, x, y), len(text), boxes)
            boxes.append(box)
            axes.annotate(
                text,
                (x, y),
                xytext=(4 * side[0], 3 * side[1]),
                textcoords="offset points",
                ha="left" if side[0] > 0 else "right",
                va="bottom" if side[1] > 0 else "top",
                fontsize=7.0,
                color=look.color,
            )


def _place(axes: Axes, x: float, y: float) -> tuple[float, float]:
    """A point as parts of the width and the height of logarithmic axes."""
    ends = (axes.get_xlim(), axes.get_ylim())
    across, up = (
        math.log(value / low) / math.log(high / low)
        for value, (low, high) in zip((x, y), ends, strict=True)
    )
    return across, up


def _free_side(
    at: tuple[float, float], letters: int, boxes: Sequence[_Box]
) -> tuple[tuple[int, int], _Box]:
    """The side of a point on which a label hides least, and its box."""
    width, height = _LETTER[0] * letters, _LETTER[1]

    def box(side: tuple[int, int]) -> _Box:
        x, y = at[0] + 0.01 * side[0], at[1] + 0.008 * side[1]
        across, up = sorted((x, x + width * side[0])), sorted((y, y + height * side[1]))
        return across[0], across[1], up[0], up[1]

    def hidden(side: tuple[int, int]) -> int:
        left, right, low, high = box(side)
        outside = left < 0.0 or right > 1.0 + width or low < 0.0 or high > 1.0 + 2.0 * height
        return 10 * outside + sum(
            left < b[1] and right > b[0] and low < b[3] and high > b[2] for b in boxes
        )

    best = min(((1, 1), (1, -1), (-1, 1), (-1, -1)), key=hidden)
    return best, box(best)


def _wrong(run: Judged) -> bool:
    """Whether impacts are missed or extra."""
    return run.errors is not None and bool(run.errors.impacts.missed or run.errors.impacts.extra)


def _positive(comparison: Comparison, measure: Measure) -> list[float]:
    """Errors that have a logarithm."""
    known = [measure.of(run.errors) for run in comparison.runs if run.errors is not None]
    known += [measure.of(run.rigid) for run in comparison.runs if run.rigid is not None]
    return [error for error in known if error > 0.0]


def _bottom(comparison: Comparison, measure: Measure) -> float:
    """Smallest error drawn: below the floor, or below the smallest error without one."""
    if measure.floor > 0.0:
        return measure.floor / _BELOW
    return min(_positive(comparison, measure), default=_ROUNDING) / _BELOW


def _name_floor(axes: Axes, measure: Measure) -> None:
    """Say what the shading means, in its lower right corner."""
    if measure.floor > 0.0:
        axes.text(
            0.99,
            0.01,
            f"{measure.known_by} {measure.floor:.0e}",
            transform=axes.transAxes,
            ha="right",
            va="bottom",
            fontsize=7.0,
            color="#555555",
        )


def _legend(comparisons: Sequence[Comparison], looks: dict[str, Look]) -> list[Artist]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Artist] = []
    runs = [run for comparison in comparisons for run in comparison.runs]
    known = {run.label for comparison in comparisons for run in timed(comparison)}
    for label, look in looks.items():
        points = {"marker": look.marker, "markersize": _MARKER_SIZE}
        style = points if label in known else {"linestyle": _DASHES}
        handles.append(Line2D([], [], c=look.color, label=label, **style))
    if any(_wrong(run) for run in runs):
        handles.append(
            Line2D(
                [], [], c=_GREY, marker="o", markerfacecolor="white",
                markersize=_MARKER_SIZE, linestyle="none", label="impacts missed or extra",
            )
        )  # fmt: skip
    if any(comparison.laws is not None for comparison in comparisons):
        handles += [
            Line2D(
                [], [], c=_GREY, marker="o", markersize=0.6 * _MARKER_SIZE, linestyle=_DOTS,
                label="against the rigid law",
            ),
            Line2D([], [], c=_GREY, linestyle=_LAWS, linewidth=1.0, label="contact laws alone"),
        ]  # fmt: skip
    if any(graph_measure(comparison).floor > 0.0 for comparison in comparisons):
        handles.append(Patch(color=_SHADE, alpha=0.6, label="closer than the reference is known"))
    return handles
