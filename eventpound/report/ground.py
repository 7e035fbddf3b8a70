"""The ground acceleration over time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eventpound.report.view import View
from eventpound.units import STANDARD_GRAVITY

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_ground(axes: Axes, view: View) -> None:
    """Draw a_g(t) in g.

    Parameters
    ----------
    axes : Axes
        Where.
    view : View
        Results of a run.
    """
    axes.axhline(0.0, color="#BBBBBB", linewidth=0.6, zorder=1)
    axes.plot(view.t, view.column("a_g") / STANDARD_GRAVITY, color="#444444", linewidth=0.8)
    axes.set_ylabel("ground\nacceleration (g)")
