"""Figure of a pounding pair in dimensionless terms (paper, Fig. 11).

Displacements and their distance over L_e against omega_g t, with the impacts as
open and the ends of continuous contact as filled circles, and below the loops of
the springs that hold the two bodies to the ground.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.report.loops import draw_loop
from eventpound.report.markers import circle_legend, draw_circles, draw_rests, marker_size
from eventpound.report.style import PALETTE, legend_above, styled
from eventpound.report.view import DrawnSpring, View, view_of
from eventpound.results import StoredResults
from eventpound.results.description import LawName
from eventpound.scene.contact import BARRIER, Contact, End
from eventpound.scene.spring import GROUND

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_WIDTH, _HEIGHT = 9.0, 8.4
# Periods 2 pi / omega_g that are shown before the first and after the last event.
_BEFORE, _AFTER = 4.0, 8.0


def bridge_response_figure(results: StoredResults | View, title: str) -> Figure:
    """Draw the response of two bodies that collide.

    Parameters
    ----------
    results : StoredResults or View
        Results of a run under a motion that has scales.
    title : str
        Above the figure.

    Raises
    ------
    InputError
        Where the scene has no contact between two bodies.
    """
    from matplotlib.figure import Figure

    view = view_of(results)
    pairs = [c for c in view.contacts if BARRIER not in (c.left, c.right)]
    if not pairs:
        raise InputError("[figure]: bridge-response needs a contact between two bodies")
    contact = pairs[0]
    with styled():
        figure = Figure(figsize=(_WIDTH, _HEIGHT), layout="constrained")
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
            draw_loop(panels[name], replace(view, pi=True), _holding(view, body))
        figure.align_ylabels([panels["u"], panels["g"]])
        figure.suptitle(title, fontsize=10.0, wrap=True)
    return figure


def _draw_displacements(axes: Axes, view: View, contact: Contact) -> None:
    """The left body, and the right one moved by the gap: where the lines meet they touch."""
    length, omega = _scales(view)
    t = omega * view.t
    left = view.displacement(contact.left) / length
    right = (view.displacement(contact.right) + contact.gap) / length
    axes.axhline(0.0, color="#BBBBBB", linewidth=0.6, zorder=1)
    axes.fill_between(t, left, right, color="#888888", alpha=0.18, linewidth=0.0)
    lines = axes.plot(t, left, color=PALETTE[0], label=f"$u$ of {contact.left}")
    lines += axes.plot(t, right, color=PALETTE[1], label=rf"$u$ of {contact.right} + $\delta$")
    axes.set_ylabel(r"displacement $u\,\omega_g^2/a_g$")
    _mark(axes, view, contact, lambda times: np.interp(times, view.t, left))
    legend_above(axes, [*lines])


def _draw_distance(axes: Axes, view: View, contact: Contact) -> None:
    length, omega = _scales(view)
    axes.axhline(contact.gap / length, color="#AAAAAA", linestyle=(0, (6, 3)), linewidth=0.8)
    axes.plot(
        omega * view.t, view.column(f"gap.{contact.name}") / length, color=PALETTE[2], zorder=3
    )
    rests = [(omega * a, omega * b) for a, b in view.rests(contact.name)]
    draw_rests(axes, rests, 0.0, PALETTE[2])
    _mark(axes, view, contact, np.zeros_like)
    axes.set_ylabel(r"distance $g_N\,\omega_g^2/a_g$")
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, -0.06 * high), high)
    axes.annotate(
        rf"$\Pi_\delta$ = {contact.gap / length:.2f}",
        (1.005, contact.gap / length),
        xycoords=("axes fraction", "data"),
        va="center",
    )
    openings = view.opening_times(contact.name).size > 0
    entries = circle_legend(view.impact_times(contact.name).size > 0, openings, bool(rests))
    if entries:
        legend_above(axes, entries)


def _mark(axes: Axes, view: View, contact: Contact, height_at: object) -> None:
    """Open circles at impacts, filled ones where a continuous contact ends."""
    assert callable(height_at)
    _, omega = _scales(view)
    impacts, openings = view.impact_times(contact.name), view.opening_times(contact.name)
    draw_circles(
        axes,
        (omega * impacts, height_at(impacts)),
        (omega * openings, height_at(openings)),
        "#222222",
        marker_size(impacts.size + openings.size),
    )


def _holding(view: View, body: End) -> DrawnSpring:
    """The hysteretic spring between a body and the ground, else any of its springs."""
    own = [spring for spring in view.springs if set(spring.between) == {GROUND, body}]
    hysteretic = [spring for spring in own if spring.law is LawName.BOUC_WEN]
    if not own:
        raise InputError(f"[figure]: bridge-response needs a spring from the ground to {body}")
    return (hysteretic or own)[0]


def _scales(view: View) -> tuple[float, float]:
    """L_e (m) and omega_g (rad/s) of the motion."""
    return view.scale("L_e"), view.scale("omega_g")


def _shown(view: View, contact: Contact) -> tuple[float, float]:
    """The dimensionless times around the events; all of them where there are none."""
    _, omega = _scales(view)
    t: Floats = omega * view.t
    events = omega * view.impact_times(contact.name)
    if not events.size:
        return float(t[0]), float(t[-1])
    period = 2.0 * np.pi
    return (
        max(float(t[0]), float(events.min()) - _BEFORE * period),
        min(float(t[-1]), float(events.max()) + _AFTER * period),
    )
