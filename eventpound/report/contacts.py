"""The gaps of the contacts over time, and a row of events for each of many contacts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.report.markers import circle_legend, draw_circles, draw_rests, marker_size
from eventpound.report.style import (
    PALETTE,
    Color,
    colors,
    largest_size,
    legend_above,
    legend_beside,
    literal,
)
from eventpound.report.view import View
from eventpound.scene.contact import Contact

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

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
    unit = view.length_unit(largest_size(*gaps.values()))
    shades = _shades(view)
    axes.axhline(0.0, color="#888888", linewidth=0.6, zorder=1)
    handles: list[Artist] = []
    for contact in view.contacts:
        gap = gaps[contact.name] / unit.size
        handles += axes.plot(
            view.t, gap, color=shades[contact.name], label=_label(contact), zorder=3
        )
    if marked:
        for contact in view.contacts:
            _draw_events(axes, view, contact, 0.0, shades[contact.name])
    axes.set_ylabel(f"gap ({unit.name})")
    _show_zero(axes)
    if len(handles) > len(PALETTE):
        handles = []
    legend_beside(axes, handles + (_event_legend(view) if marked else []))


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
    for row, contact in enumerate(view.contacts):
        _draw_events(axes, view, contact, float(row), shades[contact.name])
    count = len(view.contacts)
    axes.set_ylim(count - 0.4, -0.6)
    step = -(-count // _ROWS_WITH_NAMES)
    rows = range(0, count, step)
    axes.set_yticks(rows, [literal(view.contacts[row].name) for row in rows])
    axes.set_ylabel("contact")
    legend_above(axes, _event_legend(view))


def _shades(view: View) -> dict[str, Color]:
    """Colours of the contacts; they go on in the palette where the bodies end."""
    names = [contact.name for contact in view.contacts]
    return dict(zip(names, colors(len(names), first=len(view.bodies)), strict=True))


def _label(contact: Contact) -> str:
    return f"{contact.name}: {contact.left} | {contact.right}"


def _draw_events(axes: Axes, view: View, contact: Contact, height: float, color: Color) -> None:
    def at_height(times: Floats) -> tuple[Floats, Floats]:
        return times, np.full(times.shape, height)

    size = marker_size(len(view.results.events))
    draw_rests(axes, view.rests(contact.name), height, color)
    impacts, openings = view.impact_times(contact.name), view.opening_times(contact.name)
    draw_circles(axes, at_height(impacts), at_height(openings), color, size)


def _event_legend(view: View) -> list[Artist]:
    names = [contact.name for contact in view.contacts]
    return circle_legend(
        impacts=any(view.impact_times(name).size for name in names),
        openings=any(view.opening_times(name).size for name in names),
        rests=any(view.rests(name) for name in names),
    )


def _show_zero(axes: Axes) -> None:
    """Let the circles at gap zero stand clear of the frame."""
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, -0.06 * high), high)
