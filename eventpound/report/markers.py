"""Marks of contact events: open circles for impacts, filled for detachments, bars for rests."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from eventpound.numerics.arrays import Floats
from eventpound.report.style import Color, literal
from eventpound.report.view import View

_INK = "#444444"
_CIRCLE: Any = {"linestyle": "none", "marker": "o"}
_BAR: Any = {"linewidth": 4.0, "alpha": 0.35}


def draw_circles(
    axes: Axes, view: View, contact: str, along: tuple[Floats, Floats], color: Color
) -> None:
    """Draw the impacts and the openings of a contact.

    Parameters
    ----------
    axes : Axes
        Where.
    view : View
        Results of a run.
    contact : str
        Which.
    along : tuple of ndarray
        Times and heights of a line on which the circles lie.
    color : Color
        Of the circles; they are smaller, the more events there are.
    """
    events = len(view.results.event_columns["t"])
    size = 5.5 if events <= 40 else 4.0 if events <= 200 else 2.6
    impacts, openings = view.impact_times(contact), view.opening_times(contact)
    for times, fill, order in ((impacts, "white", 4), (openings, color, 5)):
        # An empty line outside the clip would count in the layout as a point of the figure.
        if times.size:
            look: Any = {"markerfacecolor": fill, "markeredgecolor": color, "markeredgewidth": 0.9}
            look |= {"markersize": size, "clip_on": False, "zorder": order}
            axes.plot(times, np.interp(times, *along), **_CIRCLE, **look)


def draw_rests(axes: Axes, view: View, contact: str, height: float, color: Color) -> None:
    """Draw the stretches over which a contact stayed closed as bars."""
    for start, end in view.rests(contact):
        axes.hlines(height, start, end, color=color, capstyle="butt", zorder=2, **_BAR)


def draw_ground(axes: Axes, view: View, size: float) -> None:
    """Draw the acceleration of the ground over one of `size` (m/s²), in plan both components."""
    for (name, values), color in zip(view.ground.items(), ("#444444", "#aaaaaa"), strict=False):
        label = "along" if name == "a_g" else "across"
        axes.plot(view.t, values / size, color=color, linewidth=0.8, label=label)
    if len(view.ground) > 1:
        axes.legend(loc="upper right", ncols=2)


def draw_shocks(axes: Axes, view: View) -> None:
    """Draw where the records of a sequence begin, with their names, as far as that is in sight."""
    low, high = float(view.t[0]), float(view.t[-1])
    for number, (t, name) in enumerate(view.shocks, 1):
        at = max(t / view.time_unit.size, low)
        if at > high:
            continue
        axes.axvline(at, color=_INK, linestyle=":", linewidth=0.8)
        axes.annotate(
            literal(f"{number} {name}"),
            (at, 1.0),
            xycoords=axes.get_xaxis_transform(),
            # Names of short shocks stand below those before them.
            xytext=(2.0, -2.0 - 7.0 * ((number - 1) % 2)),
            textcoords="offset points",
            va="top",
            fontsize=6,
        )


def event_legend(view: View, contacts: list[str]) -> list[Artist]:
    """Legend entries of those kinds of event that occur."""
    entries: list[Artist] = []
    for times_of, fill, label in (
        (view.impact_times, "white", "impact"),
        (view.opening_times, _INK, "detachment"),
    ):
        if any(times_of(name).size for name in contacts):
            look: Any = {"color": _INK, "markersize": 5.5, "markerfacecolor": fill, "label": label}
            entries.append(Line2D([], [], **_CIRCLE, **look))
    if any(view.rests(name) for name in contacts):
        bar: Any = {"color": _INK, "solid_capstyle": "butt", "label": "in contact"}
        entries.append(Line2D([], [], **bar, **_BAR))
    return entries
