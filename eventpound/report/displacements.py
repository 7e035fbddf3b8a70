"""Figure of displacements: the ground above, then the bodies, the gaps and the contacts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eventpound.report.contacts import draw_contact_rows, draw_gaps
from eventpound.report.ground import draw_ground
from eventpound.report.markers import draw_circles, marker_size
from eventpound.report.style import (
    PALETTE,
    Color,
    Unit,
    colors,
    largest_size,
    legend_beside,
    literal,
    styled,
)
from eventpound.report.towers import storeys_of
from eventpound.report.view import Beside, DrawnSpring, View, view_of
from eventpound.results import StoredResults
from eventpound.scene.contact import BARRIER, Contact

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Circles of more contacts than this, all at gap zero, get a row each instead.
_CONTACTS_IN_ONE_PANEL = 4
# A barrier further away than this many times the largest displacement is not drawn.
_BARRIER_IN_SIGHT = 1.5
_DASHES = (0, (6, 3))
_WIDTH = 9.5
_MOST_IN_LEGEND, _A_COLUMN = 24, 12
"""Names of bodies in a legend, and in a column of it."""
_FAMILIES = ("Blues", "Oranges", "Greens", "Purples", "Greys")


def displacement_figure(results: StoredResults | View, beside: Beside | None = None) -> Figure:
    """Draw the motion of a run.

    Panels share the time: ground acceleration (where there is one), the
    displacements of the bodies, the drifts of storeys that stand on one another
    and the gaps of the contacts (where there are some), and with many contacts
    a row of events for each.

    Parameters
    ----------
    results : StoredResults or View
        Results of a run.
    beside : Beside, optional
        Another run, whose displacements are drawn pale.
    """
    from matplotlib.figure import Figure

    view = view_of(results)
    contacts = len(view.contacts)
    heights = {"displacements": 3.0}
    if largest_size(view.column("a_g")) > 0.0:
        heights = {"ground": 1.3} | heights
    if storeys_of(view):
        heights["drifts"] = 1.8
    if contacts:
        heights["gaps"] = 2.2
    if contacts > _CONTACTS_IN_ONE_PANEL:
        heights["events"] = 0.5 + 0.2 * min(contacts, 40)
    with styled():
        figure = Figure(figsize=(_WIDTH, 0.8 + sum(heights.values())), layout="constrained")
        panels = figure.subplot_mosaic(
            [[name] for name in heights], height_ratios=list(heights.values()), sharex=True
        )
        _draw_panels(panels, view, beside)
        _label(figure, panels, view)
    return figure


def _draw_panels(panels: dict[str, Axes], view: View, beside: Beside | None) -> None:
    if "ground" in panels:
        draw_ground(panels["ground"], view)
    draw_displacements(panels["displacements"], view, beside)
    if "drifts" in panels:
        _draw_drifts(panels["drifts"], view)
    if "gaps" in panels:
        draw_gaps(panels["gaps"], view, marked="events" not in panels)
    if "events" in panels:
        draw_contact_rows(panels["events"], view)


def _label(figure: Figure, panels: dict[str, Axes], view: View) -> None:
    """Time axis, the case's title, and that a run is incomplete where it is."""
    results = view.results
    *upper, lowest = panels.values()
    for axes in upper:
        axes.tick_params(labelbottom=False)
    lowest.set_xlabel(f"time ({view.time_unit.name})")
    t = view.t
    if t.size and t[-1] > t[0]:
        lowest.set_xlim(t[0], t[-1])
    # The names of many contacts are long; they would push the other labels far off their axes.
    figure.align_ylabels([axes for name, axes in panels.items() if name != "events"])
    case = results.manifest.get("case")
    title = str(case.get("title", "")) if isinstance(case, dict) else ""
    if not results.summary["success"]:
        title = f"{title} — incomplete: {results.summary['message']}".removeprefix(" — ")
    if title:
        figure.suptitle(title, fontsize=10.0, wrap=True)


def draw_displacements(axes: Axes, view: View, beside: Beside | None = None) -> None:
    """Draw u(t) of every body with its barriers and the events of its contacts.

    Parameters
    ----------
    axes : Axes
        Where.
    view : View
        Results of a run.
    beside : Beside, optional
        Another run.
    """
    bodies = view.bodies
    u = {name: view.displacement(name) for name in bodies}
    largest = largest_size(*u.values())
    unit = view.length_unit(largest)
    size = marker_size(len(view.results.events))
    shades = shades_of(view)
    axes.axhline(0.0, color="#BBBBBB", linewidth=0.6, zorder=1)
    for name in bodies:
        axes.plot(view.t, u[name] / unit.size, color=shades[name], label=name, zorder=3)
    if beside is not None:
        for name in [name for name in bodies if name in beside.view.bodies]:
            other = beside.view.displacement(name) / unit.size
            axes.plot(beside.view.t, other, color=shades[name], linewidth=0.7, alpha=0.45, zorder=2)
    barriers: list[str] = []
    for contact in view.contacts:
        ends = [end for end in (contact.left, contact.right) if end in u]
        for end in ends:
            circles = [
                (times, np.interp(times, view.t, u[end]) / unit.size)
                for times in (view.impact_times(contact.name), view.opening_times(contact.name))
            ]
            draw_circles(axes, circles[0], circles[1], shades[end], size)
        if len(ends) == 1 and not contact.at_point and contact.gap <= _BARRIER_IN_SIGHT * largest:
            _draw_barrier(axes, contact, view, unit, shades[ends[0]])
            barriers.append(str(contact.left if contact.right in u else contact.right))
    axes.set_ylabel(f"displacement ({unit.name})")
    _name_bodies(axes, bodies, barriers, "" if beside is None else beside.name)


def _draw_drifts(axes: Axes, view: View) -> None:
    """Draw the elongation of every storey above the lowest, in the colour of its upper body."""
    shades = shades_of(view)
    storeys = storeys_of(view)
    drifts = {spring.name: view.elongation(spring) for spring in storeys}
    unit = view.length_unit(largest_size(*drifts.values()))
    axes.axhline(0.0, color="#BBBBBB", linewidth=0.6, zorder=1)
    for spring in storeys:
        values = drifts[spring.name] / unit.size
        axes.plot(view.t, values, color=shades[_upper(view, spring)], label=spring.name, zorder=3)
    axes.set_ylabel(f"drift ({unit.name})")
    if len(drifts) <= _A_COLUMN:
        legend_beside(axes, [line for line in axes.get_lines() if line.get_label() in drifts])


def _upper(view: View, spring: DrawnSpring) -> str:
    """The body that a storey carries: of a structure it comes later."""
    return max(spring.between, key=view.bodies.index)


def _draw_barrier(axes: Axes, contact: Contact, view: View, unit: Unit, color: Color) -> None:
    """Draw the displacement at which a body touches the barrier or the support."""
    for end, side in ((contact.right, 1.0), (contact.left, -1.0)):
        if end == BARRIER:
            place = side * contact.gap / unit.size
            axes.axhline(place, color=color, linestyle=_DASHES, linewidth=1.0, zorder=2)
        elif end in view.supports:
            places = (side * contact.gap + view.displacement(end)) / unit.size
            axes.plot(view.t, places, color=color, linestyle=_DASHES, linewidth=1.0, zorder=2)


def _name_bodies(axes: Axes, bodies: list[str], barriers: list[str], beside: str) -> None:
    """Legend beside the axes, in columns, or the names along a colour bar where there are many."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize
    from matplotlib.lines import Line2D

    if len(bodies) <= _MOST_IN_LEGEND:
        handles: list[Artist] = [x for x in axes.get_lines() if x.get_label() in bodies]
        if barriers:
            names = ", ".join(literal(name) for name in dict.fromkeys(barriers))
            handles.append(Line2D([], [], color="#444444", linestyle=_DASHES, label=names))
        if beside:
            handles.append(Line2D([], [], color="#444444", linewidth=0.7, alpha=0.45, label=beside))
        legend_beside(axes, handles, columns=1 if len(handles) <= _A_COLUMN else 2)
        return
    scale = Normalize(0.5, len(bodies) + 0.5)
    ramp = ScalarMappable(scale, ListedColormap(colors(len(bodies))))
    bar = axes.figure.colorbar(ramp, ax=axes, pad=0.01, aspect=15)
    named = np.unique(np.linspace(0, len(bodies) - 1, _A_COLUMN).astype(int))
    bar.set_ticks([float(i + 1) for i in named], labels=[literal(bodies[i]) for i in named])


def shades_of(view: View) -> dict[str, Color]:
    """Colour of each body: of the palette, or, of many, a family of shades for each structure."""
    from matplotlib import colormaps

    bodies = view.bodies
    groups = view.structures
    if len(bodies) <= len(PALETTE) or not 1 < len(groups) <= len(_FAMILIES):
        return dict(zip(bodies, colors(len(bodies)), strict=True))
    found: dict[str, Color] = {}
    for group, family in zip(groups, _FAMILIES, strict=False):
        # Neither so pale that it is lost on white, nor black.
        places = np.linspace(0.95, 0.4, len(group))
        found |= dict(zip(group, map(tuple, colormaps[family](places)), strict=True))
    return found
