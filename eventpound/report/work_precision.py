"""Work-precision diagrams: error against wall time, a line a solver, the reference as floor."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import cycle
from typing import Any

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.transforms import Bbox

from eventpound.accuracy.compare import Comparison
from eventpound.accuracy.comparison_tables import floor_of
from eventpound.accuracy.quantities import PEAKS
from eventpound.accuracy.work_precision import Judged
from eventpound.report.style import Color, colors, new_figure, say, styled
from eventpound.score.difference import Difference

_MARKERS = "osD^vP*X"
_SIZE = 4.5
_DASHES = (0, (5, 2))
_RIGID: Any = {"linestyle": ":", "markersize": 0.6 * _SIZE}
_LAWS: Any = {"linestyle": "-.", "linewidth": 1.0}
"""Of errors against the rigid law: of runs, and of contact laws alone."""
_GREY = "#444444"
_BELOW, _EDGE = 10.0, 2.0
"""How far the axis goes below the floor, smaller errors being drawn there; and its margin."""
_ROUNDING = 1e-16
_SHADE: Any = {"color": "#DDDDDD", "alpha": 0.6}
_DECADE = 20.0
"""Least ratio of the ends of the axis of times."""
_SIDES = ((4, 3), (4, -3), (-4, 3), (-4, -3))
"""Where the name of a point may stand (points from it)."""


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
    of: Callable[[Difference], float]
    floor: float
    known_by: str = "reference known to"


_Looks = dict[str, tuple[Color, str]]
"""Colour and marker of each line, by its label."""


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


@styled()
def work_precision_figure(comparison: Comparison) -> Figure:
    """Draw error of the peaks and of the motion against wall time.

    Parameters
    ----------
    comparison : Comparison
        With at least one timed run. Histories of other programs have no time and
        are drawn as horizontal lines.
    """
    looks = _looks([comparison])
    figure = new_figure(8.6, 4.2, comparison.case.title)
    panels = figure.subplots(1, 2, sharex=True)
    measures = peak_measure(comparison), graph_measure(comparison)
    ends = [
        _draw(axes, comparison, measure, looks)
        for axes, measure in zip(panels, measures, strict=True)
    ]
    handles = _legend([comparison], looks)
    # Rows of equal length, of four entries at most.
    columns = math.ceil(len(handles) / math.ceil(len(handles) / 4))
    figure.legend(handles=handles, loc="outside lower center", ncols=columns)
    figure.draw_without_rendering()
    for axes, named in zip(panels, ends, strict=True):
        _name_ends(axes, named)
    return figure


def _looks(comparisons: Sequence[Comparison]) -> _Looks:
    """A colour and a marker for each line, by its label."""
    runs = [run for comparison in comparisons for run in comparison.runs]
    labels = dict.fromkeys(run.label for run in runs if run.errors is not None)
    return dict(zip(labels, zip(colors(len(labels)), cycle(_MARKERS), strict=False), strict=True))


_End = tuple[float, float, str, Color]
"""A point that is named: its place, name and colour."""


def _draw(axes: Axes, comparison: Comparison, measure: Measure, looks: _Looks) -> list[_End]:
    """Lines of all solvers and the floor, on logarithmic axes; the ends of the lines."""
    laws = comparison.laws
    of_runs = [errors for run in comparison.runs for errors in (run.errors, run.rigid)]
    every = [measure.of(errors) for errors in of_runs if errors is not None]
    positive = [error for error in every if error > 0.0]
    known = measure.floor > 0.0
    bottom = (measure.floor if known else min(positive, default=_ROUNDING)) / _BELOW

    def points(runs: Iterable[Judged], rigid: bool) -> list[tuple[float, float, Judged]]:
        """Wall time (ms), error as it is drawn, and run."""
        pairs = [(run, run.rigid if rigid else run.errors) for run in runs]
        found = [(run, measure.of(errors)) for run, errors in pairs if errors is not None]
        return [(1e3 * run.seconds, max(e, bottom), run) for run, e in found if not math.isnan(e)]

    ends: list[_End] = []
    for label, (color, marker) in looks.items():
        own = [run for run in timed(comparison) if run.label == label]
        line, rigid = points(own, False), points(own, True)
        axes.plot([x for x, _, _ in line], [y for _, y, _ in line], color=color, zorder=3)
        for x, y, run in line:
            fill = "white" if run.wrong else color
            mark: Any = {"markerfacecolor": fill, "markersize": _SIZE, "zorder": 4}
            axes.plot(x, y, marker, color=color, **mark)
        if rigid:
            dotted = [x for x, _, _ in rigid], [y for _, y, _ in rigid]
            axes.plot(*dotted, marker=marker, color=color, zorder=3, **_RIGID)
        others = [r for r in comparison.runs if r.label == label and r.entry is None]
        for _, y, _ in points(others, False):
            axes.axhline(y, color=color, linestyle=_DASHES)
        for x, y, run in [line[0], line[-1]][: len(line)] if line else []:
            size = run.size.removeprefix("rtol ").removeprefix("step ")
            ends.append((x, y, size, color))
    if laws is not None:
        axes.axhline(max(measure.of(laws), bottom), color=_GREY, zorder=2, **_LAWS)
    axes.set(xlabel="wall time (ms)", ylabel=measure.label, xscale="log", yscale="log")
    axes.margins(x=0.12)
    # Numbers between decades would be written along an axis that is shorter.
    left, right = axes.get_xlim()
    wider = math.sqrt(max(1.0, _DECADE * left / right))
    axes.set_xlim(left / wider, right * wider)
    axes.xaxis.set_minor_formatter("")
    axes.set_ylim(bottom / _EDGE, max([*positive, bottom * _BELOW**2]) * _EDGE)
    if known:
        axes.axhspan(bottom / _EDGE, measure.floor, linewidth=0.0, zorder=1, **_SHADE)
        said, corner = f"{measure.known_by} {measure.floor:.0e}", axes.transAxes
        look_of_text: Any = {"ha": "right", "fontsize": 7.0, "color": "#555555"}
        axes.text(0.99, 0.01, said, transform=corner, **look_of_text)
    return ends


def _name_ends(axes: Axes, ends: Sequence[_End]) -> None:
    """Name points, each on the side where its name hides least of lines' points and names."""
    marks = [xy for line in axes.get_lines() for xy in axes.transData.transform(line.get_xydata())]
    taken = [Bbox.from_bounds(x - 2.0, y - 2.0, 4.0, 4.0) for x, y in marks]
    for x, y, name, color in ends:
        tried = [say(axes, name, (x, y), side, fontsize=7.0, color=color) for side in _SIDES]
        boxes = [text.get_window_extent() for text in tried]
        hidden = [
            box.count_overlaps(taken) + 10 * (box.y0 < axes.bbox.y0 or box.x0 < axes.bbox.x0)
            for box in boxes
        ]
        best = hidden.index(min(hidden))
        taken.append(boxes[best])
        for other in (*tried[:best], *tried[best + 1 :]):
            other.remove()


def _legend(comparisons: Sequence[Comparison], looks: _Looks) -> list[Artist]:
    """Entries for lines, and for what is drawn beside them."""
    handles: list[Artist] = []
    drawn = {run.label for comparison in comparisons for run in timed(comparison)}
    for label, (color, marker) in looks.items():
        points: Any = {"marker": marker, "markersize": _SIZE}
        points = points if label in drawn else {"linestyle": _DASHES}
        handles.append(Line2D([], [], label=label, **points | {"color": color}))
    grey: Any = {"color": _GREY, "marker": "o"}
    if any(run.wrong for comparison in comparisons for run in comparison.runs):
        wrong: Any = {"markerfacecolor": "white", "markersize": _SIZE, "linestyle": "none"}
        handles.append(Line2D([], [], label="impacts missed or extra", **grey, **wrong))
    if any(comparison.laws is not None for comparison in comparisons):
        handles.append(Line2D([], [], label="against the rigid law", **grey, **_RIGID))
        handles.append(Line2D([], [], color=_GREY, label="contact laws alone", **_LAWS))
    if any(graph_measure(comparison).floor > 0.0 for comparison in comparisons):
        handles.append(Patch(label="closer than the reference is known", **_SHADE))
    return handles
