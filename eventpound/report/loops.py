"""Figure of the loops: force against elongation of every spring that is not linear."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from eventpound.report.style import BESIDE, PALETTE, largest_size, styled
from eventpound.report.view import Beside, DrawnSpring, View, view_of
from eventpound.results import StoredResults
from eventpound.results.description import LawName

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_COLUMNS = 4
_WIDTH, _HEIGHT = 3.4, 2.7


def nonlinear_springs(results: StoredResults | View) -> list[DrawnSpring]:
    """Springs whose force against elongation is not one straight line.

    Parameters
    ----------
    results : StoredResults or View
        Results of a run.
    """
    return [spring for spring in view_of(results).springs if spring.law is not LawName.LINEAR]


def loop_figure(results: StoredResults | View, beside: Beside | None = None) -> Figure:
    """Draw the loops of a run, a panel for each spring that is not linear.

    Parameters
    ----------
    results : StoredResults or View
        Results of a run with at least one such spring.
    beside : Beside, optional
        Another run of the same springs, drawn in grey.
    """
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    view = view_of(results)
    springs = nonlinear_springs(view)
    columns = min(_COLUMNS, math.ceil(math.sqrt(len(springs))))
    rows = math.ceil(len(springs) / columns)
    with styled():
        figure = Figure(figsize=(_WIDTH * columns + 0.4, _HEIGHT * rows), layout="constrained")
        panels = figure.subplots(rows, columns, squeeze=False).ravel()
        for axes, spring in zip(panels, springs, strict=False):
            draw_loop(axes, view, spring, None if beside is None else beside.view)
        for axes in panels[len(springs) :]:
            axes.remove()
        if beside is not None:
            grey = Line2D([], [], color=BESIDE, linewidth=0.8, label=beside.name)
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
    axes.axhline(0.0, color="#BBBBBB", linewidth=0.6, zorder=1)
    axes.axvline(0.0, color="#BBBBBB", linewidth=0.6, zorder=1)
    if beside is not None and spring.name in [each.name for each in beside.springs]:
        other_x, other = beside.loop(spring)
        axes.plot(other_x / of_length.size, other / of_force.size, color=BESIDE, linewidth=0.8)
    axes.plot(x / of_length.size, force / of_force.size, color=PALETTE[0], linewidth=0.8)
    axes.set_title(f"{spring.name} ({spring.law.value})")
    axes.set_xlabel(f"elongation ({of_length.name})")
    axes.set_ylabel(f"force ({of_force.name})")
