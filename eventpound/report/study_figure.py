"""Figures of a study: spectra in panels, a curve a value, the spectral regions marked; maps.

Where contact amplifies the peak the panel is tinted red, where it reduces it
blue, as `matters` says: the three regions of the founding paper's section 3.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from eventpound.numerics.arrays import Bools, Floats
from eventpound.report.notes import LETTER, LINE, letters, wrapped, write_below
from eventpound.report.style import colors, largest_size, plain_logarithms, show_as_written, styled
from eventpound.report.symbols import axis_label, display_unit, plain_value, symbol, value_label
from eventpound.report.view import stretches
from eventpound.results.shown_units import Unit
from eventpound.study.figure import FigurePlan
from eventpound.study.plan import Plan
from eventpound.study.reading import StudyCase
from eventpound.study.spectra import dimensional_name
from eventpound.study.stated import measured_at, stated

MATTERS = 0.05
"""Share of the peak by which contact has to change it to be said to matter."""
VISIBLE = 0.1
"""Change of a peak in Π-terms, in units of L_e, that is lost on the paper's axes, to 5 to 15."""
_AMPLIFIED, _REDUCED = "#F6D5C3", "#CFE3F2"
_WITHOUT = "#7A7A7A"
# Inches: a panel, the title above all panels.
_PANEL = (3.5, 2.4)
# Inches of a panel that has a strip with the gain below it, and of that; where its axis ends.
_ABOVE_STRIP, _STRIP, _MOST_GAIN = 2.0, 1.1, 2.0
_TITLE = 0.32
# Inches of the legend: an entry without its words, and a letter of them.
_ENTRY, _LETTER = 0.62, 0.068
# Inches that a letter of the title takes.
_TITLE_LETTER = 0.1


def matters(gain: Floats, pi_um: Floats | None = None) -> Bools:
    """Where contact changes a peak by more than `MATTERS` of it and, in Π-terms, `VISIBLE`.

    Parameters
    ----------
    gain : ndarray, shape (n,)
        Peak with contact over that without.
    pi_um : ndarray, shape (n,), optional
        The peak with contact, in Π-terms.
    """
    changed = np.abs(gain - 1.0) > MATTERS
    return changed if pi_um is None else changed & (np.abs(pi_um - pi_um / gain) > VISIBLE)


@dataclass(frozen=True)
class _Panel:
    """Rows of the table that one panel shows, what stands above it, and sizes of x and y (SI).

    Columns of the table are in the units of the axes.
    """

    row: int
    column: int
    x: str
    y: str
    labels: tuple[str, str]
    title: str
    table: pd.DataFrame
    units: tuple[float, float]


def study_figures(
    case: StudyCase, plan: FigurePlan, table: pd.DataFrame
) -> Iterator[tuple[str, Figure]]:
    """Figures of one plan by the names of their files, one a page.

    Parameters
    ----------
    case : StudyCase
        The study.
    plan : FigurePlan
        What is drawn.
    table : DataFrame
        The table of the study.
    """
    for value, page in _split(table, plan.pages):
        suffix = "" if value is None else f"-{plain_value(plan.pages, value)}"
        yield f"{plan.name}{suffix}.png", _figure(case, plan, page, value)


@styled()
def _figure(case: StudyCase, plan: FigurePlan, table: pd.DataFrame, page: object) -> Figure:
    panels = list(_panels(case.study, plan, table))
    rows, columns = (
        1 + max(place) for place in zip(*((p.row, p.column) for p in panels), strict=True)
    )
    heights = [_ABOVE_STRIP, _STRIP] if plan.gain else [_PANEL[1]]
    figure = Figure()
    axes: Any = figure.subplots(
        rows * len(heights), columns, squeeze=False, height_ratios=heights * rows
    )
    handles: dict[str, Artist] = {}
    for panel in panels:
        place = axes[len(heights) * panel.row, panel.column]
        # The first panel decides how the legend shows a curve.
        if plan.map:
            _draw_map(place, plan, panel, [p.table for p in panels if p.y == panel.y])
        else:
            handles = _draw_panel(place, case.study, plan, panel) | handles
        if plan.gain:
            _draw_gain(axes[2 * panel.row + 1, panel.column], place, plan, panel)
    for axis in axes.flat:
        axis.set_visible(bool(axis.has_data()))
    title = plan.title or case.study.title
    if page is not None:
        title += f", {value_label(plan.pages, page)}"
    said = (*stated(case.study, symbol), _shading(plan), plan.note)
    height = _arrange(figure, (_PANEL[0] * columns, sum(heights) * rows), title, handles, said)
    if plan.gain:
        for panel_axes, strip in zip(axes[::2].flat, axes[1::2].flat, strict=True):
            # A panel reaches down to the strip below it.
            box, low = panel_axes.get_position(), strip.get_position().y1 + 0.12 / height
            panel_axes.set_position((box.x0, low, box.width, box.y1 - low))
    return figure


def _arrange(
    figure: Figure,
    size: tuple[float, float],
    title: str,
    handles: dict[str, Artist],
    said: Sequence[str],
) -> float:
    """Put the title and the legend above all panels and what is said below; the height (in)."""
    width = size[0]
    heading = wrapped(title, width / _TITLE_LETTER)
    lines = [part for line in said if line for part in wrapped(line, width / LETTER)]
    widest = max((letters(label) for label in handles), default=1)
    in_a_row = max(1, min(len(handles), int(width / (_ENTRY + _LETTER * widest))))
    heads = _TITLE + LINE * (len(heading) - 1)
    above, below = heads + LINE * -(-len(handles) // in_a_row), LINE * (len(lines) + 0.5)
    height = size[1] + above + below
    figure.set_size_inches(width, height)
    text = figure.suptitle("\n".join(heading), fontsize=10.0, y=1.0 - 0.08 / height)
    text.set_in_layout(False)
    if handles:
        place: Any = {"loc": "upper center", "bbox_to_anchor": (0.5, 1.0 - (heads - 0.05) / height)}
        figure.legend(handles.values(), handles.keys(), ncols=in_a_row, **place)
    write_below(figure, lines)
    show_as_written(figure)
    figure.tight_layout(rect=(0.0, below / height, 1.0, 1.0 - above / height))
    return height


def _shading(plan: FigurePlan) -> str:
    """What the tint means."""
    if plan.regions is None:
        return ""
    visible = f" and by more than {VISIBLE:g} $L_e$" if "pi_um" in plan.y else ""
    said = f"Shaded: contact changes the peak by more than {MATTERS:.0%}{visible}."
    if plan.gain:
        said += f" Gain: the peak over that without contact, to {_MOST_GAIN:g}; grey: within "
        said += f"{MATTERS:.0%} of 1."
    return said


def _panels(study: Plan, plan: FigurePlan, table: pd.DataFrame) -> Iterator[_Panel]:
    for i, (row_value, of_row) in enumerate(_split(table, plan.rows)):
        for j, (column_value, of_panel) in enumerate(_split(of_row, plan.columns)):
            words = [] if row_value is None else [value_label(plan.rows, row_value)]
            if column_value is not None:
                words.append(value_label(plan.columns, column_value))
            if j < len(plan.column_titles):
                words[-1:] = [f"{plan.column_titles[j]} ({words[-1]})"]
            for k, (given, y) in enumerate(zip(plan.x, plan.y, strict=True)):
                x = given or _last_axis(study, of_panel)
                x = x if x in table.columns else dimensional_name(x)
                units = _unit(table, x, plan.x_labels), _unit(table, y, plan.y_labels)
                at = measured_at(study).get(x, "")
                labels = (
                    plan.x_labels[k] if plan.x_labels else axis_label(x, units[0], at),
                    plan.y_labels[k] if plan.y_labels else axis_label(y, units[1]),
                )
                sizes = {x: units[0].size, y: units[1].size}
                if plan.grey:
                    sizes.setdefault(plan.grey, units[1].size)
                shown = of_panel.assign(**{name: of_panel[name] / sizes[name] for name in sizes})
                column, title = j * len(plan.x) + k, ", ".join(words)
                yield _Panel(i, column, x, y, labels, title, shown, (sizes[x], sizes[y]))


def _unit(table: pd.DataFrame, key: str, said: Sequence[str]) -> Unit:
    """Unit of a column at an axis; that of SI where its label is said."""
    return Unit("", 1.0) if said else display_unit(key, largest_size(table[key].to_numpy(float)))


def _last_axis(study: Plan, table: pd.DataFrame) -> str:
    """The axis that varies fastest in the scene of the first row of a table."""
    first = table.iloc[0]
    for base in study.bases:
        if base.axes and all(str(first[key]) == str(v) for key, v in base.labels.items()):
            return base.axes[-1].key
    return study.columns[-1]


def _split(table: pd.DataFrame, key: str) -> Iterator[tuple[object, pd.DataFrame]]:
    """Parts of a table by the values of a column, in the order they come in."""
    if not key:
        yield None, table
        return
    for value in table[key].dropna().unique():
        yield value, table[table[key] == value]


def _draw_panel(axes: Axes, study: Plan, plan: FigurePlan, panel: _Panel) -> dict[str, Artist]:
    """Curves of one panel; what the legend says of them."""
    handles: dict[str, Artist] = {}
    curves = list(_split(panel.table, plan.curves))
    palette = colors(len(curves))
    for mark in plan.marks:
        axes.axvline(mark / panel.units[0], color=_WITHOUT, linewidth=0.8, linestyle=":")
    for level in plan.levels:
        axes.axhline(level / panel.units[1], color=_WITHOUT, linewidth=1.2)
    if plan.regions is not None:
        handles |= _mark_regions(axes, plan, panel)
    if plan.grey:
        _, first = curves[0]
        (line,) = axes.plot(first[panel.x], first[plan.grey], color=_WITHOUT, linewidth=2.0)
        handles["without contact"] = line
    for i, (value, curve) in enumerate(curves):
        width = 1.1 + (1.6 * (len(curves) - 1 - i) if plan.nested == panel.y else 0.0)
        (line,) = axes.plot(curve[panel.x], curve[panel.y], color=palette[i], linewidth=width)
        if value is not None:
            keys = (plan.curves, *_along(study, plan.curves))
            handles[", ".join(value_label(key, curve[key].iloc[0]) for key in keys)] = line
    if plan.largest is not None:
        said = f"largest from {value_label(panel.x, plan.largest)} on"
        handles[said] = _mark_largest(axes, plan.largest / panel.units[0])
    plain_logarithms(axes, plan.x_scale == "logarithmic", plan.y_scale == "logarithmic")
    axes.set(xlabel=panel.labels[0], ylabel=panel.labels[1], title=panel.title)
    axes.set_xlim(panel.table[panel.x].min(), panel.table[panel.x].max())
    if plan.y_scale == "linear":
        # From zero on, where nothing lies below: a least displacement does.
        above = not (panel.table[panel.y] < 0.0).any()
        most = None if plan.y_max is None else plan.y_max / panel.units[1]
        axes.set_ylim(0.0 if above else None, most)
    return handles


def _draw_map(axes: Axes, plan: FigurePlan, panel: _Panel, page: Sequence[pd.DataFrame]) -> None:
    """A quantity over the abscissa and the values of the curves, in the colours of its page."""
    unit = _unit(panel.table, plan.curves, ())
    plain_logarithms(axes, plan.x_scale == "logarithmic", plan.y_scale == "logarithmic")
    values = np.concatenate([table[panel.y].to_numpy(float) for table in page])
    most = None if plan.y_max is None else plan.y_max / panel.units[1]
    colours = _colours_of(values, most, panel.y.startswith("amplification"))
    grid = panel.table.pivot(index=plan.curves, columns=panel.x, values=panel.y).sort_index()
    grid = grid.set_axis(grid.index / unit.size, axis=0)
    levels = [level / panel.units[1] for level in plan.levels]
    _draw_grid(axes, grid, colours, levels)
    for mark in plan.marks:
        axes.axvline(mark / panel.units[0], color=_WITHOUT, linewidth=0.8, linestyle=":")
    if plan.line:
        x, y = np.transpose(plan.line)
        axes.autoscale(enable=False)
        axes.plot(x / panel.units[0], y / unit.size, color="black", linestyle="--")
    axes.set(xlabel=panel.labels[0], ylabel=axis_label(plan.curves, unit))
    axes.set_title("\n".join(filter(None, (panel.title, panel.labels[1]))))


def _draw_gain(axes: Axes, above: Axes, plan: FigurePlan, panel: _Panel) -> None:
    """The amplification of the marked curve below its panel, by the same abscissa.

    Where curves lie closer than a line is thick it shows on which side of 1 they are.
    """
    assert plan.regions is not None
    curves = [value for value, _ in _split(panel.table, plan.curves)]
    color = colors(len(curves))[curves.index(plan.regions)]
    curve = _marked_curve(plan, panel)
    axes.axhspan(1.0 - MATTERS, 1.0 + MATTERS, color="#DDDDDD", linewidth=0.0, zorder=1)
    _mark_regions(axes, plan, panel)
    axes.plot(curve[panel.x], curve["amplification"], color=color, linewidth=1.1)
    plain_logarithms(axes, plan.x_scale == "logarithmic", False)
    axes.set(xlim=above.get_xlim(), ylim=(0.0, _MOST_GAIN), yticks=[0.0, 1.0])
    axes.set(xlabel=above.get_xlabel(), ylabel="gain")
    above.set_xlabel("")
    above.tick_params(labelbottom=False)


def _marked_curve(plan: FigurePlan, panel: _Panel) -> pd.DataFrame:
    """Rows of the curve whose amplification is marked, in the order of the abscissa."""
    marked = panel.table[panel.table[plan.curves] == plan.regions]
    return marked.sort_values(panel.x)


def _along(study: Plan, key: str) -> list[str]:
    """Keys of the axes that go along with that of a key."""
    axes = study.bases[0].axes
    zips = {axis.together for axis in axes if axis.key == key} - {""}
    return [axis.key for axis in axes if axis.together in zips and axis.key != key]


def _mark_largest(axes: Axes, start: float) -> Artist:
    """A marker where each curve is largest from a value on, and on the axis below it."""
    for line in [line for line in axes.get_lines() if len(np.atleast_1d(line.get_xdata())) > 2]:
        x, y = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
        at = int(np.nanargmax(np.where(x >= start, y, -np.inf)))
        style: Any = {"color": line.get_color(), "markeredgecolor": "white", "clip_on": False}
        style["zorder"] = 5
        below = axes.get_xaxis_transform()
        axes.plot(x[at], y[at], marker="o", markersize=6.0, **style)
        axes.plot(x[at], 0.0, marker="^", markersize=7.0, transform=below, **style)
    return Line2D([], [], color="#444444", marker="o", linestyle="none")


def _mark_regions(axes: Axes, plan: FigurePlan, panel: _Panel) -> dict[str, Artist]:
    """Tint the stretches where contact amplifies or reduces the peak of one curve."""
    curve = _marked_curve(plan, panel)
    x, gain = curve[panel.x].to_numpy(), curve["amplification"].to_numpy()
    matter = matters(gain, curve[panel.y].to_numpy() if panel.y == "pi_um" else None)
    which = value_label(plan.curves, plan.regions)
    handles: dict[str, Artist] = {}
    for name, mask, color in (
        (f"amplified by contact ({which})", matter & (gain > 1.0), _AMPLIFIED),
        (f"reduced by contact ({which})", matter & (gain < 1.0), _REDUCED),
    ):
        # Half-way to the next point on either side.
        borders = np.concatenate((x[:1], 0.5 * (x[1:] + x[:-1]), x[-1:]))
        for low, high in stretches(borders, mask):
            axes.axvspan(low, high, color=color, linewidth=0.0, zorder=0)
        handles[name] = Patch(color=color)
    return handles


_MISSING, _CONTOUR = "#BBBBBB", "#222222"
"""Colours of where no run has a value, and of lines."""
_MOST_CONTOURS = 6


def _colours_of(values: Floats, high: float | None, around_one: bool) -> tuple[Normalize, str]:
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


def _draw_grid(
    axes: Axes, grid: pd.DataFrame, colours: tuple[Normalize, str], levels: Sequence[float]
) -> None:
    """Draw a quantity in colours with a bar beside them, and lines at levels or round values.

    The grid has the abscissa as its columns and the ordinate as its rows, both rising.
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
    wanted = levels or MaxNLocator(_MOST_CONTOURS).tick_values(low, high)
    if inside := sorted(level for level in wanted if low < level < high):
        lines = axes.contour(
            x, y, np.ma.masked_invalid(values), inside, colors=_CONTOUR, linewidths=0.7
        )
        axes.clabel(lines, fmt="%g", fontsize=7.0)


def _borders(middles: Floats, logarithmic: bool) -> Floats:
    """Borders of cells around n values, half-way between them as the axis has them, (n + 1,)."""
    m = np.log(middles) if logarithmic else middles
    half = np.diff(m) / 2.0 if m.size > 1 else np.array([0.5])
    found = np.concatenate((m[:1] - half[:1], m[:-1] + half[: m.size - 1], m[-1:] + half[-1:]))
    return np.exp(found) if logarithmic else found
