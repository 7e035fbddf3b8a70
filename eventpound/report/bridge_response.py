"""Figure of a pounding pair in dimensionless terms (paper, Fig. 11).

Displacements and their distance over L_e against omega_g t, with the impacts as
open and the ends of continuous contact as filled circles, and below the loops of
the springs that hold the two bodies to the ground.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from eventpound.errors import InputError
from eventpound.report.displacements import show_zero
from eventpound.report.loops import draw_loop
from eventpound.report.markers import draw_circles, draw_rests, event_legend
from eventpound.report.style import DASHED, PALETTE, legend_above, new_figure, styled, zero_lines
from eventpound.report.view import DrawnSpring, View
from eventpound.scene.contact import BARRIER, Contact
from eventpound.scene.ends import End
from eventpound.scene.spring import GROUND

# Periods 2 pi / omega_g that are shown before the first and after the last event.
_BEFORE, _AFTER = 4.0, 8.0
_EVENT = "#222222"


@styled()
def bridge_response_figure(view: View, title: str) -> Figure:
    """Draw the response of two bodies that collide.

    Parameters
    ----------
    view : View
        Results of a run under a motion that has scales.
    title : str
        Above the figure.

    Raises
    ------
    InputError
        Where the scene has no contact between two bodies.
    """
    pairs = [c for c in view.contacts if BARRIER not in (c.left, c.right)]
    if not pairs:
        raise InputError("[figure]: bridge-response needs a contact between two bodies")
    contact, view = pairs[0], replace(view, pi=True)
    figure = new_figure(9.0, 8.4, title)
    panels = figure.subplot_mosaic(
        [["u", "u"], ["g", "g"], ["left", "right"]], height_ratios=(1.2, 1.0, 1.3)
    )
    _draw_displacements(panels["u"], view, contact)
    _draw_distance(panels["g"], view, contact)
    panels["u"].sharex(panels["g"])
    panels["u"].tick_params(labelbottom=False)
    panels["g"].set_xlabel(r"dimensionless time $\omega_g t$")
    panels["g"].set_xlim(*_shown(view, contact))
    for name, body in (("left", contact.left), ("right", contact.right)):
        draw_loop(panels[name], view, _holding(view, body))
    figure.align_ylabels([panels["u"], panels["g"]])
    return figure


def _draw_displacements(axes: Axes, view: View, contact: Contact) -> None:
    """The left body, and the right one moved by the gap: where the lines meet they touch."""
    t, length = view.t, view.scale("L_e")
    left = view.displacement(contact.left) / length
    right = (view.displacement(contact.right) + contact.gap) / length
    zero_lines(axes)
    axes.fill_between(t, left, right, color="#888888", alpha=0.18, linewidth=0.0)
    lines = axes.plot(t, left, color=PALETTE[0], label=f"$u$ of {contact.left}")
    lines += axes.plot(t, right, color=PALETTE[1], label=rf"$u$ of {contact.right} + $\delta$")
    axes.set_ylabel(r"displacement $u\,\omega_g^2/a_g$")
    draw_circles(axes, view, contact.name, (t, left), _EVENT)
    legend_above(axes, lines)


def _draw_distance(axes: Axes, view: View, contact: Contact) -> None:
    """The distance of the bodies, with the events of their contact."""
    name, length = contact.name, view.scale("L_e")
    axes.axhline(contact.gap / length, color="#AAAAAA", **DASHED)
    axes.plot(view.t, view.column(f"gap.{name}") / length, color=PALETTE[2], zorder=3)
    draw_rests(axes, view, name, 0.0, PALETTE[2])
    draw_circles(axes, view, name, (view.t[:1], np.zeros(1)), _EVENT)
    axes.set_ylabel(r"distance $g_N\,\omega_g^2/a_g$")
    show_zero(axes)
    gap = contact.gap / length
    at: tuple[str, str] = ("axes fraction", "data")
    axes.annotate(rf"$\Pi_\delta$ = {gap:.2f}", (1.005, gap), xycoords=at, va="center")
    if entries := event_legend(view, [name]):
        legend_above(axes, entries)


def _holding(view: View, body: End) -> DrawnSpring:
    """The hysteretic spring between a body and the ground, else any of its springs."""
    own = [spring for spring in view.springs if set(spring.sides) == {GROUND, body}]
    hysteretic = [spring for spring in own if spring.law.hysteretic]
    if not own:
        raise InputError(f"[figure]: bridge-response needs a spring from the ground to {body}")
    return (hysteretic or own)[0]


def _shown(view: View, contact: Contact) -> tuple[float, float]:
    """The dimensionless times around the events; all of them where there are none."""
    t, events, period = view.t, view.impact_times(contact.name), 2.0 * np.pi
    if not events.size:
        return float(t[0]), float(t[-1])
    first, last = events.min() - _BEFORE * period, events.max() + _AFTER * period
    return max(float(t[0]), float(first)), min(float(t[-1]), float(last))
