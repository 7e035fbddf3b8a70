"""The gaps of the contacts over time, and a row of events for each of many contacts."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from eventpound.report import style
from eventpound.report.markers import draw_circles, draw_rests, event_legend
from eventpound.report.view import View

_ROWS_WITH_NAMES = 40


def draw_gaps(axes: Axes, view: View, marked: bool) -> None:
    """Draw g(t) of every contact.

    Parameters
    ----------
    axes : Axes
        Where.
    view : View
        Results of a run.
    marked : bool
        Whether to mark the events and rests at gap zero.
    """
    gaps = {contact.name: view.column(f"gap.{contact.name}") for contact in view.contacts}
    unit = view.length_unit(style.largest_size(*gaps.values()))
    shades = _shades(view)
    style.zero_lines(axes)
    for contact in view.contacts:
        name = contact.name
        label = f"{name}: {contact.left} | {contact.right}"
        axes.plot(view.t, gaps[name] / unit.size, color=shades[name], label=label, zorder=3)
    handles = axes.get_lines()[1:] if len(gaps) <= len(style.PALETTE) else []
    if marked:
        for name in gaps:
            _draw_events(axes, view, name, 0.0, shades[name])
    axes.set_ylabel(f"gap ({unit.name})")
    show_zero(axes)
    style.legend_beside(axes, [*handles, *(event_legend(view, [*gaps]) if marked else [])])


def draw_contact_rows(axes: Axes, view: View) -> None:
    """Draw the events and rests of every contact in a row of its own, the first on top.

    Parameters
    ----------
    axes : Axes
        Where.
    view : View
        Results of a run.
    """
    shades = _shades(view)
    names = [*shades]
    for row, name in enumerate(names):
        _draw_events(axes, view, name, float(row), shades[name])
    axes.set_ylim(len(names) - 0.4, -0.6)
    rows = range(0, len(names), -(-len(names) // _ROWS_WITH_NAMES))
    axes.set_yticks(rows, [style.literal(names[row]) for row in rows])
    axes.set_ylabel("contact")
    style.legend_above(axes, event_legend(view, names))


def _shades(view: View) -> dict[str, style.Color]:
    """Colours of the contacts; they go on in the palette where the bodies end."""
    names = [contact.name for contact in view.contacts]
    return dict(zip(names, style.colors(len(names), first=len(view.bodies)), strict=True))


def _draw_events(axes: Axes, view: View, contact: str, height: float, color: style.Color) -> None:
    draw_rests(axes, view, contact, height, color)
    draw_circles(axes, view, contact, (view.t[:1], np.array([height])), color)


def show_zero(axes: Axes) -> None:
    """Let the circles at gap zero stand clear of the frame."""
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, -0.06 * high), high)
