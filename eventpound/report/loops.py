"""Figure of the loops: force against elongation of every spring that is not linear."""

from __future__ import annotations

import math

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from eventpound.report.style import PALETTE, largest_size, new_figure, styled, zero_lines
from eventpound.report.view import DrawnSpring, OtherRun, View, view_of
from eventpound.results import StoredResults
from eventpound.scene.spring import LawName

_COLUMNS = 4
_WIDTH, _HEIGHT = 3.4, 2.7
_BESIDE = "#9A9A9A"


def nonlinear_springs(results: StoredResults | View) -> list[DrawnSpring]:
    """Springs of a run whose force against elongation is not one straight line."""
    return [spring for spring in view_of(results).springs if spring.law is not LawName.LINEAR]


@styled()
def loop_figure(results: StoredResults | View, beside: OtherRun | None = None) -> Figure:
    """Draw the loops of a run, a panel for each spring that is not linear.

    Parameters
    ----------
    results : StoredResults or View
        Results of a run with at least one such spring.
    beside : OtherRun, optional
        Another run of the same springs, drawn in grey.
    """
    view = view_of(results)
    springs = nonlinear_springs(view)
    columns = min(_COLUMNS, math.ceil(math.sqrt(len(springs))))
    rows = math.ceil(len(springs) / columns)
    figure = new_figure(_WIDTH * columns + 0.4, _HEIGHT * rows)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes, spring in zip(panels, springs, strict=False):
        draw_loop(axes, view, spring, None if beside is None else beside.view)
    for axes in panels[len(springs) :]:
        axes.remove()
    if beside is not None:
        grey = Line2D([], [], color=_BESIDE, linewidth=0.8, label=beside.name)
        figure.legend(handles=[grey], loc="outside lower right")
    return figure


def draw_loop(axes: Axes, view: View, spring: DrawnSpring, beside: View | None = None) -> None:
    """Draw force against elongation of one spring.

    Parameters
    ----------
    axes : Axes
        Where.
    view : View
        Results of a run.
    spring : DrawnSpring
        Which one.
    beside : View, optional
        Another run, drawn below it in grey.
    """
    x, force = view.loop(spring)
    of_length = view.length_unit(largest_size(x))
    of_force = view.force_unit(largest_size(force))
    zero_lines(axes, upright=True)
    if beside is not None and spring.name in [each.name for each in beside.springs]:
        other_x, other = beside.loop(spring)
        axes.plot(other_x / of_length.size, other / of_force.size, color=_BESIDE, linewidth=0.8)
    axes.plot(x / of_length.size, force / of_force.size, color=PALETTE[0], linewidth=0.8)
    axes.set_title(f"{spring.name} ({spring.law.value})")
    axes.set(xlabel=f"elongation ({of_length.name})", ylabel=f"force ({of_force.name})")
