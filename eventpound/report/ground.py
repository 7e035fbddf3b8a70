"""The ground acceleration over time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eventpound.report.view import View

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_ground(axes: Axes, view: View) -> None:
    """Draw a_g(t), in g or in a_g.

    Parameters
    ----------
    axes : Axes
        Where.
    view : View
        Results of a run.
    """
    axes.axhline(0.0, color="#BBBBBB", linewidth=0.6, zorder=1)
    unit = view.acceleration_unit
    axes.plot(view.t, view.column("a_g") / unit.size, color="#444444", linewidth=0.8)
    axes.set_ylabel(f"ground\nacceleration ({unit.name})")
