"""A bridge from above: its decks at rest, or where they are at an instant, with every gap.

Also what the page that zooms needs to show it move.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from eventpound.numerics.arrays import Floats
from eventpound.report.style import PALETTE, literal, new_figure, styled
from eventpound.report.view import View
from eventpound.results.shown_units import Units
from eventpound.scene.contact import BARRIER, Contact
from eventpound.scene.deck import Deck
from eventpound.scene.plan_point import DIRECTIONS, PlanPoint, coordinate_of
from eventpound.scene.scene import Scene
from eventpound.units import Dimension

_INK = "#333333"
_SHOWN = 0.06
"""Part of the length of the bridge that the largest displacement is drawn as, at most."""
_MOST_TIMES = 100.0
"""Times that displacements are drawn larger, at most."""
_MARGIN = 0.09
"""Beside the bridge, as part of its length."""
_WALL = 0.02
_USUAL = Units()
_State = Mapping[str, float]
"""Displacements of the bodies (m), by their names."""


@styled()
def plan_figure(
    scene: Scene,
    title: str = "",
    *,
    units: Units = _USUAL,
    within: tuple[float, float] = (14.0, 8.0),
    state: _State | None = None,
) -> Figure:
    """Draw the decks of a scene from above.

    Parameters
    ----------
    scene : Scene
        With decks.
    title : str
        Above it.
    units : Units
        Units of the gaps.
    within : tuple of float
        Width and height at most (in).
    state : mapping of str to float, optional
        Displacements of the bodies (m): where the decks are drawn, larger than they are.
    """
    times = 1.0
    if state is not None:
        rows = {name: np.array([u]) for name, u in state.items()}
        times = _times(_largest(scene, rows), max(_bounds(scene)[2:]))
    scene = _with_gaps(scene, times)
    left, low, width, height = _bounds(scene)
    right, high, long = left + width, low + height, max(width, height)
    margin = _MARGIN * long
    wide, tall = right - left + 2.0 * margin, high - low + 2.0 * margin
    scale = min(within[0] / wide, within[1] / tall, 9.0 / wide)
    figure = new_figure(max(4.5, scale * wide), scale * tall + 0.4)
    axes = figure.add_subplot()
    for i, deck in enumerate(scene.decks):
        _draw_deck(axes, deck, PALETTE[i % 2], state, times)
    for contact in scene.contacts:
        if _places(contact):
            _draw_contact(axes, scene, contact, state, times, units)
    axes.set(xlim=(left - margin, right + margin), ylim=(low - margin, high + margin))
    said = f"displacements and gaps drawn {times:.3g} times larger" if times != 1.0 else ""
    axes.set_title(literal(", ".join(filter(None, (title, said)))))
    axes.set_aspect("equal")
    axes.axis("off")
    return figure


def worst_plan_figure(view: View) -> Figure | None:
    """The plan at the row of a history in which a joint is open the most; None without decks."""
    scene = view.scene
    if scene is None or not scene.decks or not scene.contacts:
        return None
    columns = view.results.history_columns
    opened = np.array([columns[f"gap.{c.name}"] - c.gap for c in scene.contacts])
    which, row = divmod(int(np.argmax(opened)), opened.shape[1])
    t = columns["t"][row]
    state = {body.name: float(columns[f"u.{body.name}"][row]) for body in scene.bodies}
    name = scene.contacts[which].name
    return plan_figure(scene, f"{name} widest open at {t:.4g} s", state=state)


def _bounds(scene: Scene) -> tuple[float, float, float, float]:
    """Least x and y of the decks, and how far they reach from there (m)."""
    corners = np.array([_placed(deck, at) for deck in scene.decks for at in deck.corners])
    (left, low), (right, high) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    return left, low, right - left, high - low


def _with_gaps(scene: Scene, times: float) -> Scene:
    """The scene with decks as far apart along x as their gaps, so many times larger, make them."""
    moved = dict.fromkeys((deck.name for deck in scene.decks), 0.0)
    for contact in scene.contacts:
        if isinstance(contact.left, PlanPoint) and isinstance(contact.right, PlanPoint):
            wider = (times - 1.0) * contact.gap / contact.left.normal[0]
            # Joints stand from the left to the right, each by the gap of its last corner.
            moved[contact.right.deck] = moved[contact.left.deck] + wider
    decks = [replace(d, centre=(d.centre[0] + moved[d.name], d.centre[1])) for d in scene.decks]
    return replace(scene, decks=decks)


def _placed(deck: Deck, at: tuple[float, float]) -> Floats:
    return np.add(deck.centre, at)


def _moved(deck: Deck, at: tuple[float, float], state: _State | None, times: float) -> Floats:
    """A place of a deck in the plan (m), its displacement `times` larger."""
    place = _placed(deck, at)
    if state is None:
        return place
    u, v, turn = (state[coordinate_of(deck.name, word)] for word in DIRECTIONS)
    angle = turn / deck.radius
    moved: Floats = place + times * np.array([u - angle * at[1], v + angle * at[0]])
    return moved


def _largest(scene: Scene, u: Mapping[str, Floats]) -> float:
    """Largest displacement of a corner (m), by rows of those of bodies."""
    found = 0.0
    for deck in scene.decks:
        x, y, turn = (u[coordinate_of(deck.name, word)] for word in DIRECTIONS)
        angle = turn / deck.radius
        sizes = (np.hypot(x - angle * b, y + angle * a).max() for a, b in deck.corners)
        found = max(found, *map(float, sizes))
    return found


def _times(largest: float, long: float) -> float:
    """How much larger displacements are drawn, a round number."""
    if largest == 0.0:
        return 1.0
    most = min(_MOST_TIMES, _SHOWN * long / largest)
    power = 10.0 ** math.floor(math.log10(most))
    return max(round_one for step in (1.0, 2.0, 5.0) if (round_one := step * power) <= most)


def _draw_deck(axes: Axes, deck: Deck, color: str, state: _State | None, times: float) -> None:
    """Outline at rest, pale where it is elsewhere, and its name."""
    rest = np.array([_placed(deck, at) for at in deck.corners])
    now = np.array([_moved(deck, at, state, times) for at in deck.corners])
    if state is not None:
        axes.fill(*rest.T, fill=False, edgecolor="#AAAAAA", linewidth=0.8, linestyle="--")
    axes.fill(*now.T, facecolor=color, alpha=0.15)
    axes.fill(*now.T, fill=False, edgecolor=color, linewidth=1.2)
    said = literal(deck.name)
    if state is not None:
        angle = state[coordinate_of(deck.name, DIRECTIONS[2])] / deck.radius
        # What rounding leaves of nothing is nothing.
        said += f"\n{round(1e3 * angle, 9):.2g} mrad"
    x, y = now.mean(axis=0)
    axes.text(x, y, said, ha="center", va="center", color=_INK)


def _places(contact: Contact) -> Sequence[PlanPoint]:
    """Ends of a contact that are places of decks."""
    return [end for end in (contact.left, contact.right) if isinstance(end, PlanPoint)]


def _draw_contact(
    axes: Axes, scene: Scene, contact: Contact, state: _State | None, times: float, units: Units
) -> None:
    """A contact: a mark at its place, the wall beside it, and how wide its gap is."""
    decks = {deck.name: deck for deck in scene.decks}
    ends = _places(contact)
    places = [_moved(decks[end.deck], end.at, state, times) for end in ends]
    now, (n_x, n_y) = np.mean(places, axis=0), ends[0].normal
    at = now
    if BARRIER in (contact.left, contact.right):
        deck = decks[ends[0].deck]
        at = _placed(deck, ends[0].at)
        front = _wall(contact, deck, times)
        axes.plot(*front.T, color=_INK)
        hatch: Any = {"fill": False, "hatch": "////", "edgecolor": "#888888", "linewidth": 0.0}
        way = 1.0 if contact.right == BARRIER else -1.0
        back = front[::-1] + way * _WALL * deck.length * np.array([n_x, n_y])
        axes.fill(*np.concatenate([front, back]).T, **hatch)
    axes.plot(*now, "o", color=PALETTE[2], markersize=3.0)
    unit, size = units.unit(Dimension.LENGTH.unit)
    opening = contact.gap
    if state is not None:
        opening += sum(part * state.get(name, 0.0) for name, part in contact.direction)
    up = 1.0 if ends[0].at[1] > 0.0 else -1.0
    label = axes.annotate(
        f"{literal(contact.name)}\n{opening / size:.3g} {unit}",
        (float(at[0]), float(at[1])),
        (0.0, 14.0 * up),
        textcoords="offset points",
        ha="center",
        va="bottom" if up > 0.0 else "top",
        fontsize=7.0,
        color=PALETTE[2],
    )
    # The margin has room for it.
    label.set_in_layout(False)


def _wall(contact: Contact, deck: Deck, times: float) -> Floats:
    """Ends of the front of an abutment at a contact (m), its gap drawn larger, shape (2, 2)."""
    (end,) = _places(contact)
    n_x, n_y = end.normal
    way, half = 1.0 if contact.right == BARRIER else -1.0, 0.2 * deck.width
    middle = _placed(deck, end.at) + way * times * contact.gap * np.array([n_x, n_y])
    edge = half * np.array([-n_y, n_x])
    return np.array([middle - edge, middle + edge])


def moving_plan(view: View) -> dict[str, Any] | None:
    """What moves in plan, for a page: shapes at rest with gaps as drawn; None without decks (m)."""
    scene = view.scene
    if scene is None or not scene.decks:
        return None
    u = {body.name: view.displacement(body.name) for body in scene.bodies}
    times = _times(_largest(scene, u), max(_bounds(scene)[2:]))
    scene = _with_gaps(scene, times)
    places = {deck.name: i for i, deck in enumerate(scene.decks)}
    contacts = []
    for contact in filter(_places, scene.contacts):
        ends = _places(contact)
        apart = BARRIER not in (contact.left, contact.right)
        wall = None if apart else _wall(contact, scene.decks[places[ends[0].deck]], times).tolist()
        at = [[places[end.deck], *end.at] for end in ends]
        contacts.append({"name": contact.name, "at": at, "wall": wall})
    left, low, wide, high = _bounds(scene)
    margin = _MARGIN * max(wide, high)
    return {
        "times": times,
        "box": [left - margin, low - margin, wide + 2.0 * margin, high + 2.0 * margin],
        "decks": [
            {"name": deck.name, "centre": deck.centre, "corners": deck.corners}
            for deck in scene.decks
        ],
        "contacts": contacts,
    }
