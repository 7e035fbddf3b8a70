"""Displacements and gaps over time."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from eventpound.report import style
from eventpound.report.markers import (
    draw_circles,
    draw_ground,
    draw_rests,
    draw_shocks,
    event_legend,
)
from eventpound.report.towers import storeys_of
from eventpound.report.view import OtherRun, Traces, View, traces_of, view_of
from eventpound.results import StoredResults
from eventpound.results.shown_units import Unit
from eventpound.scene.contact import BARRIER, Contact
from eventpound.scene.ends import End
from eventpound.scene.plan_point import PlanPoint
from eventpound.scene.spring import GROUND

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
        label = f"{name}: {' | '.join(map(_end_words, contact.sides))}"
        axes.plot(view.t, gaps[name] / unit.size, color=shades[name], label=label, zorder=3)
    handles = axes.get_lines()[1:] if len(gaps) <= len(style.PALETTE) else []
    if marked:
        for name in gaps:
            _draw_events(axes, view, name, 0.0, shades[name])
    axes.set_ylabel(f"gap ({unit.name})")
    show_zero(axes)
    style.legend_beside(axes, [*handles, *(event_legend(view, [*gaps]) if marked else [])])


def _end_words(end: End) -> str:
    """An end, of a place of a deck the deck."""
    return end.label if isinstance(end, PlanPoint) else str(end)


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


# Circles of more contacts than this, all at gap zero, get a row each instead.
_CONTACTS_IN_ONE_PANEL = 4
# A barrier further away than this many times the largest displacement is not drawn.
_BARRIER_IN_SIGHT = 1.5
_MOST_IN_LEGEND, _A_COLUMN = 24, 12
"""Names of bodies in a legend, and in a column of it."""
_FAMILIES = ("Blues", "Oranges", "Greens", "Purples", "Greys")
_INK = "#444444"
_PALE: Any = {"linewidth": 0.7, "alpha": 0.45}
_LEVEL: Any = style.DASHED | {"linewidth": 1.0}
_MRAD = Unit("mrad", 1e-3)


@style.styled()
def displacement_figure(results: StoredResults | View, beside: OtherRun | None = None) -> Figure:
    """Draw the motion of a run.

    Panels share the time: ground acceleration (where there is one), the
    displacements of the bodies (of decks in plan those along, those across, and rotations),
    the drifts of storeys that stand on one another
    and the gaps of the contacts (where there are some), and with many contacts
    a row of events for each.

    Parameters
    ----------
    results : StoredResults or View
        Results of a run.
    beside : OtherRun, optional
        Another run, whose displacements are drawn pale.
    """
    view = view_of(results)
    contacts = len(view.contacts)
    many = contacts > _CONTACTS_IN_ONE_PANEL
    traces = {each.name: each for each in traces_of(view)}
    parts = {
        "ground": (style.largest_size(*view.ground.values()) > 0.0, 1.3),
        **dict.fromkeys(traces, (True, 3.0 if len(traces) == 1 else 2.0)),
        "drifts": (bool(storeys_of(view)), 1.8),
        "gaps": (contacts > 0, 2.2),
        "events": (many, 0.5 + 0.2 * min(contacts, 40)),
    }
    heights = {name: height for name, (there, height) in parts.items() if there}
    figure = style.new_figure(9.5, 0.8 + sum(heights.values()), _title(view))
    ratios = list(heights.values())
    panels = figure.subplot_mosaic([[name] for name in heights], height_ratios=ratios, sharex=True)
    draw: dict[str, Callable[[Axes, View], None]] = {
        "ground": _draw_ground,
        **{n: partial(_draw_displacements, own=own, beside=beside) for n, own in traces.items()},
        "drifts": _draw_drifts,
        "gaps": lambda axes, view: draw_gaps(axes, view, marked=not many),
        "events": draw_contact_rows,
    }
    for name, axes in panels.items():
        draw[name](axes, view)
        axes.tick_params(labelbottom=False)
    axes.tick_params(labelbottom=True)
    axes.set_xlabel(f"time ({view.time_unit.name})")
    t = view.t
    if t.size and t[-1] > t[0]:
        axes.set_xlim(t[0], t[-1])
    # The names of many contacts are long; they would push the other labels far off their axes.
    figure.align_ylabels([axes for name, axes in panels.items() if name != "events"])
    return figure


def _title(view: View) -> str:
    """The case's title, and that a run is incomplete where it is."""
    case = view.results.manifest.get("case")
    title = str(case.get("title", "")) if isinstance(case, dict) else ""
    if not view.results.summary["success"]:
        title = f"{title} — incomplete: {view.results.summary['message']}".removeprefix(" — ")
    return title


def _draw_ground(axes: Axes, view: View) -> None:
    """Draw a_g(t), in g or in a_g."""
    style.zero_lines(axes)
    unit = view.acceleration_unit
    draw_ground(axes, view, unit.size)
    draw_shocks(axes, view)
    axes.set_ylabel(f"ground\nacceleration ({unit.name})")


def _draw_displacements(axes: Axes, view: View, own: Traces, beside: OtherRun | None) -> None:
    """Draw u(t) of bodies with their barriers and the events of their contacts."""
    u = {name: values for name, (_, values) in own.curves.items()}
    largest = style.largest_size(*u.values())
    unit = _MRAD if own.turned else view.length_unit(largest)
    shades = shades_of(view)
    style.zero_lines(axes)
    for name, (label, values) in own.curves.items():
        axes.plot(view.t, values / unit.size, color=shades[name], label=label, zorder=3)
    if beside is not None:
        others = {k: v for each in traces_of(beside.view) for k, v in each.curves.items()}
        for name in [name for name in u if name in others]:
            other = others[name][1] / unit.size
            axes.plot(beside.view.t, other, color=shades[name], zorder=2, **_PALE)
    barriers: list[str] = []
    for contact in view.contacts:
        ends = [end for end in (contact.left, contact.right) if end in u]
        for end in ends:
            line = view.t, u[end] / unit.size
            draw_circles(axes, view, contact.name, line, shades[end])
        if len(ends) == 1 and not contact.at_point and contact.gap <= _BARRIER_IN_SIGHT * largest:
            _draw_barrier(axes, contact, view, unit, shades[ends[0]])
            barriers.append(str(contact.left if contact.right in u else contact.right))
    axes.set_ylabel(f"{own.name} ({unit.name})")
    called = [name for name, _ in own.curves.values()]
    _name_bodies(axes, called, barriers, "" if beside is None else beside.name)


def _draw_drifts(axes: Axes, view: View) -> None:
    """Draw the elongation of every storey, in the colour of its upper body."""
    shades = shades_of(view)
    storeys = storeys_of(view)
    drifts = {spring.name: view.elongation(spring) for spring in storeys}
    unit = view.length_unit(style.largest_size(*drifts.values()))
    style.zero_lines(axes)
    for spring in storeys:
        # The body that a storey carries: of a structure it comes later.
        upper = max(set(spring.ends) - {GROUND}, key=view.bodies.index)
        values = drifts[spring.name] / unit.size
        axes.plot(view.t, values, color=shades[upper], label=spring.name, zorder=3)
    axes.set_ylabel(f"drift ({unit.name})")
    if len(drifts) <= _A_COLUMN:
        style.legend_beside(axes, axes.get_lines()[1:])


def _draw_barrier(axes: Axes, contact: Contact, view: View, unit: Unit, color: style.Color) -> None:
    """Draw the displacement at which a body touches the barrier or the support."""
    for end, side in ((contact.right, 1.0), (contact.left, -1.0)):
        if end == BARRIER:
            axes.axhline(side * contact.gap / unit.size, color=color, zorder=2, **_LEVEL)
        elif end in view.supports:
            places = (side * contact.gap + view.displacement(end)) / unit.size
            axes.plot(view.t, places, color=color, zorder=2, **_LEVEL)


def _name_bodies(axes: Axes, bodies: list[str], barriers: list[str], beside: str) -> None:
    """Legend beside the axes, in columns, or the names along a colour bar where there are many."""
    if len(bodies) <= _MOST_IN_LEGEND:
        handles: list[Artist] = [x for x in axes.get_lines() if x.get_label() in bodies]
        if barriers:
            names = ", ".join(style.literal(name) for name in dict.fromkeys(barriers))
            handles.append(Line2D([], [], color=_INK, label=names, **_LEVEL))
        if beside:
            handles.append(Line2D([], [], color=_INK, label=beside, **_PALE))
        style.legend_beside(axes, handles, columns=1 if len(handles) <= _A_COLUMN else 2)
        return
    scale = Normalize(0.5, len(bodies) + 0.5)
    ramp = ScalarMappable(scale, ListedColormap(style.colors(len(bodies))))
    bar = axes.figure.colorbar(ramp, ax=axes, pad=0.01, aspect=15)
    named = np.unique(np.linspace(0, len(bodies) - 1, _A_COLUMN).astype(int))
    bar.set_ticks([float(i + 1) for i in named], labels=[style.literal(bodies[i]) for i in named])


def shades_of(view: View) -> dict[str, style.Color]:
    """Colour of each body: of the palette, or, of many, a family of shades for each structure."""
    if view.scene is not None and view.scene.decks:
        # What moves along, across and turns is one deck or pier, in one colour.
        owners = [name.rpartition(".")[0] or name for name in view.bodies]
        named = list(dict.fromkeys(owners))
        shades = dict(zip(named, style.colors(len(named)), strict=True))
        return {b: shades[owner] for b, owner in zip(view.bodies, owners, strict=True)}
    bodies = view.bodies
    groups = view.structures
    if len(bodies) <= len(style.PALETTE) or not 1 < len(groups) <= len(_FAMILIES):
        return dict(zip(bodies, style.colors(len(bodies)), strict=True))
    found: dict[str, style.Color] = {}
    for group, family in zip(groups, _FAMILIES, strict=False):
        # Neither so pale that it is lost on white, nor black.
        places = np.linspace(0.95, 0.4, len(group))
        found |= dict(zip(group, map(tuple, colormaps[family](places)), strict=True))
    return found
