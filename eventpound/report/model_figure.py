"""The scene as a picture: bodies, springs, dashpots, gaps and what stands still.

A structure of one spring chain on the ground is drawn as a building, floor over floor;
all other bodies stand in a row, in the order in which they can touch. Nothing is to scale.
Springs with a kink, given between a body and the ground, stand beside it, on the side that
the order of their ends says; all others stand below.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.report.style import PALETTE, length_unit, literal, styled
from eventpound.scene.contact import BARRIER, Contact, End, weights_of
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.grounded import grounded
from eventpound.scene.point import Point
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, BilinearElastic, BoucWen, Series, Spring

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_APART, _ABOVE = 3.4, 2.0
"""Distances of columns and of floors; the sizes below are in the same unit."""
_WIDE, _HIGH = 1.7, 0.8
_WALL = 1.25
"""From the side of a body to a barrier."""
_TEETH, _SWAY = 5, 0.13
_INK = "#333333"
_LAWS = (
    ("linear", _INK),
    ("bouc-wen", PALETTE[0]),
    ("bilinear-elastic or series", PALETTE[1]),
)
_MOST_NAMES = 40
"""Springs and contacts of a scene in which each is named."""


@dataclass(frozen=True)
class Layout:
    """Where bodies stand.

    Parameters
    ----------
    place : mapping of str to tuple of float
        Centre of each body.
    columns : int
        How many columns there are.
    floors : int
        How high the highest is.
    """

    place: dict[str, tuple[float, float]]
    columns: int
    floors: int


def model_figure(scene: Scene, title: str = "") -> Figure:
    """Draw a scene.

    Parameters
    ----------
    scene : Scene
        A checked scene.
    title : str
        Above it.
    """
    from matplotlib.figure import Figure

    layout = layout_of(grounded(scene))
    width = _APART * layout.columns + 2.0 * _WALL
    height = _ABOVE * layout.floors + 1.4
    scale = min(0.75, 14.0 / width)
    with styled():
        figure = Figure((max(4.5, scale * width), scale * height + 0.9), layout="constrained")
        axes = figure.add_subplot()
        _draw(axes, scene, layout)
        axes.set_xlim(-0.5 * _APART - _WALL, (layout.columns - 0.5) * _APART + _WALL)
        axes.set_ylim(-0.8 if scene.supports else -0.5, _ABOVE * layout.floors + 0.9)
        axes.set_aspect("equal")
        axes.axis("off")
        axes.set_title(literal(title))
        _legend(axes, scene)
    return figure


def layout_of(scene: Scene) -> Layout:
    """Columns of bodies from the left, each from the ground up."""
    columns = _columns(scene)
    place = {
        name: (_APART * c, _ABOVE * (floor + 1))
        for c, column in enumerate(columns)
        for floor, name in enumerate(column)
    }
    return Layout(place, len(columns), max(map(len, columns), default=1))


def _columns(scene: Scene) -> list[list[str]]:
    """Chains that stand on the ground, and other bodies by themselves, in the order of contacts."""
    chains = [chain for body in scene.bodies if (chain := _chain(scene, body.name))]
    stacked = {name for chain in chains for name in chain}
    columns = chains + [[body.name] for body in scene.bodies if body.name not in stacked]
    order = {body.name: i for i, body in enumerate(scene.bodies)}
    columns.sort(key=lambda column: order[column[0]])
    at = {name: c for c, column in enumerate(columns) for name in column}
    before: list[set[int]] = [set() for _ in columns]
    for contact in scene.contacts:
        left, right = (
            {at[name] for name, _ in weights_of(end) if name in at}
            for end in (contact.left, contact.right)
        )
        for column in right - left:
            before[column] |= left
    placed: list[int] = []
    while len(placed) < len(columns):
        rest = [c for c in range(len(columns)) if c not in placed]
        free = [c for c in rest if not before[c] - set(placed)]
        # Bodies that stand in a ring have no first one.
        placed.append((free or rest)[0])
    return [columns[c] for c in placed]


def _chain(scene: Scene, base: str) -> list[str]:
    """Bodies above one another from a body on the ground, of two at least; empty without them."""
    neighbours: dict[str, set[str]] = {}
    for spring in scene.springs:
        for here, there in (spring.between, spring.between[::-1]):
            neighbours.setdefault(here, set()).add(there)
    chain, before = [base], GROUND
    if GROUND not in neighbours.get(base, ()):
        return []
    while True:
        above = neighbours[chain[-1]] - {before}
        if not above:
            return chain if len(chain) > 1 else []
        if len(above) > 1 or GROUND in above or above & set(chain):
            return []
        before = chain[-1]
        chain.append(above.pop())


def _draw(axes: Axes, scene: Scene, layout: Layout) -> None:
    named = len(scene.springs) + len(scene.contacts) <= _MOST_NAMES
    standing = grounded(scene)
    support_of, scene = _supports_of_parts(scene, standing), standing
    feet: dict[tuple[str, float], tuple[float, float]] = {}
    right = (layout.columns - 0.5) * _APART + _WALL
    _still(axes, (-0.5 * _APART - _WALL, right), (0.0, 0.0))
    links = _links(scene)
    undrawn = False
    for (first, second), members in links.items():
        for k, member in enumerate(members):
            shift = 0.42 * (k - 0.5 * (len(members) - 1))
            ends = _ends(layout, first, second, member, shift)
            undrawn |= ends is None
            if ends is not None:
                _link(axes, member, *ends, named)
                if id(member) in support_of and ends[0][1] == 0.0:
                    x = layout.place[first if second == GROUND else second][0]
                    feet[support_of[id(member)], x] = (x, -0.3)
    for contact in scene.contacts:
        _contact(
            axes, layout, contact, 0.24 if tuple(sorted(contact.ends)) in links else 0.0, named
        )
        if id(contact) in support_of:
            side = 1.0 if contact.right == BARRIER else -1.0
            x, y = layout.place[str(contact.left if side > 0.0 else contact.right)]
            feet[support_of[id(contact)], x] = (x + side * (0.5 * _WIDE + _WALL), y - 0.5)
    for (name, _), place in feet.items():
        _name_below(axes, name, place)
    for body in scene.bodies:
        _body(axes, layout.place[body.name], body.name, body.mass)
    for pushed in {force.body for force in scene.forces}:
        _force(axes, layout.place[pushed])
    if undrawn:
        said = "dashpots from upper floors to the ground are not drawn"
        axes.text(0.5, 0.0, said, transform=axes.transAxes, ha="center", va="bottom", fontsize=6.5)


def _supports_of_parts(scene: Scene, standing: Scene) -> dict[int, str]:
    """The support that each spring, dashpot and contact of the scene on one ground stands on."""
    names = {support.name for support in scene.supports}
    found: dict[int, str] = {}
    links: list[Spring | Dashpot] = [*scene.springs, *scene.dashpots]
    on_ground: list[Spring | Dashpot] = [*standing.springs, *standing.dashpots]
    for old, new in zip(links, on_ground, strict=True):
        found |= {id(new): name for name in names & set(old.between)}
    for contact, new_one in zip(scene.contacts, standing.contacts, strict=True):
        found |= {id(new_one): name for name in names & {contact.left, contact.right}}
    return found


def _name_below(axes: Axes, name: str, place: tuple[float, float]) -> None:
    """The name of a support, with an arrow either way: it moves by itself."""
    x, y = place
    axes.annotate(
        "",
        (x + 0.45, y - 0.08),
        (x - 0.45, y - 0.08),
        arrowprops={"arrowstyle": "<->", "color": PALETTE[3], "linewidth": 0.9},
    )
    axes.text(x, y - 0.14, literal(name), ha="center", va="top", fontsize=6.5, color=PALETTE[3])


def _force(axes: Axes, place: tuple[float, float]) -> None:
    """An arrow above a body on which a force acts."""
    x, y = place[0], place[1] + 0.5 * _HIGH + 0.12
    axes.annotate(
        "",
        (x + 0.4, y),
        (x - 0.4, y),
        arrowprops={"arrowstyle": "->", "color": PALETTE[3], "linewidth": 1.2},
    )


def _links(scene: Scene) -> dict[tuple[str, str], list[Any]]:
    """Springs and the dashpots beside them, by their ends in order of the alphabet."""
    found: dict[tuple[str, str], list[Any]] = {}
    members: list[Spring | Dashpot] = [*scene.springs, *scene.dashpots]
    for member in members:
        first, second = member.between
        found.setdefault((min(first, second), max(first, second)), []).append(member)
    return found


def _kinked(member: Any) -> bool:
    return isinstance(member, Spring) and isinstance(member.law, BilinearElastic | Series)


def _ends(
    layout: Layout, first: str, second: str, member: Any, shift: float
) -> tuple[tuple[float, float], tuple[float, float]] | None:
    """Where a link begins and ends; None for a dashpot from an upper floor to the ground."""
    place = layout.place
    if GROUND in (first, second):
        x, y = place[second if first == GROUND else first]
        if _kinked(member):
            side = -1.0 if member.between[0] == GROUND else 1.0
            wall = x + side * (0.5 * _WIDE + _WALL)
            return (wall, y + 0.22), (x + side * 0.5 * _WIDE, y + 0.22)
        if y > 1.5 * _ABOVE:
            return None
        return (x + shift, 0.0), (x + shift, y - 0.5 * _HIGH)
    (x_1, y_1), (x_2, y_2) = sorted((place[first], place[second]))
    if x_1 == x_2:
        return (x_1 + shift, y_1 + 0.5 * _HIGH), (x_1 + shift, y_2 - 0.5 * _HIGH)
    lower = -0.22 + 0.5 * shift
    return (x_1 + 0.5 * _WIDE, y_1 + lower), (x_2 - 0.5 * _WIDE, y_2 + lower)


def _link(
    axes: Axes, member: Any, start: tuple[float, float], end: tuple[float, float], named: bool
) -> None:
    """A spring or a dashpot from one point to another."""
    a, b = np.array(start), np.array(end)
    if not isinstance(member, Spring):
        _dashpot(axes, a, b)
        return
    law = member.law
    color = _LAWS[1 if isinstance(law, BoucWen) else 2 if _kinked(member) else 0][1]
    axes.plot(*_zigzag(a, b).T, color=color, linewidth=1.2, solid_joinstyle="miter", zorder=2)
    if _kinked(member) and GROUND in member.between:
        _still(axes, (a[0], a[0]), (a[1] - 0.55, a[1] + 0.35), away=np.sign(a[0] - b[0]))
    if named:
        upright = abs(b[0] - a[0]) < abs(b[1] - a[1])
        axes.annotate(
            literal(member.name),
            0.5 * (a + b),
            (-7, 0) if upright else (0, -9),
            textcoords="offset points",
            rotation=90 if upright else 0,
            ha="right" if upright else "center",
            va="center" if upright else "top",
            fontsize=6.5,
            color=color,
        )


def _zigzag(a: Floats, b: Floats) -> Floats:
    """Corners of a spring between two points, shape (n, 2)."""
    along = b - a
    across = np.array([-along[1], along[0]]) / np.hypot(*along)
    part = np.concatenate([[0.0, 0.2], np.linspace(0.2, 0.8, 2 * _TEETH + 1)[1:-1], [0.8, 1.0]])
    sway = np.zeros(part.size)
    sway[2:-2] = _SWAY * np.where(np.arange(part.size - 4) % 2 == 0, 1.0, -1.0)
    return np.asarray(a + np.outer(part, along) + np.outer(sway, across))


def _dashpot(axes: Axes, a: Floats, b: Floats) -> None:
    """A piston in a cylinder."""
    along = (b - a) / np.hypot(*(b - a))
    across = np.array([-along[1], along[0]])
    middle, half = 0.5 * (a + b), 0.17
    cup = middle - half * along
    lines = (
        (a, cup),
        (cup + _SWAY * across, cup - _SWAY * across),
        (cup + _SWAY * across, middle + half * along + _SWAY * across),
        (cup - _SWAY * across, middle + half * along - _SWAY * across),
        (middle + 0.7 * _SWAY * across, middle - 0.7 * _SWAY * across),
        (middle, b),
    )
    for start, end in lines:
        axes.plot(*np.array([start, end]).T, color="#777777", linewidth=0.9, zorder=2)


def _law_of(contact: Contact) -> str:
    """What a label says of the law of a contact."""
    if contact.law is not None:
        return contact.law.kind
    return f"$\\epsilon$ = {contact.restitution:g}"


def _contact(axes: Axes, layout: Layout, contact: Any, up: float, named: bool) -> None:
    """Two faces with the gap between them."""
    faces = []
    pairs = ((contact.left, contact.right, 1.0), (contact.right, contact.left, -1.0))
    for name, other, side in pairs:
        if name == BARRIER:
            x, y = _place_of(layout, other)
            x += -side * (0.5 * _WIDE + _WALL)
            _still(axes, (x, x), (y - 0.5, y + 0.6), away=-side)
        else:
            x, y = _place_of(layout, name)
            x += side * 0.5 * _WIDE
            if isinstance(name, Point):
                _column_at(axes, layout, name, (x, y))
        faces.append((x, y + up))
    (x_1, y_1), (x_2, y_2) = faces
    middle = 0.5 * (x_1 + x_2)
    for x, y, side in ((x_1, y_1, -1.0), (x_2, y_2, 1.0)):
        tip = middle + side * 0.12
        axes.plot([x, tip], [y, 0.5 * (y_1 + y_2)], color=PALETTE[2], linewidth=1.2, zorder=2)
        axes.plot(
            [tip, tip], 0.5 * (y_1 + y_2) + np.array([-0.14, 0.14]), color=PALETTE[2], linewidth=2.2
        )
    unit = length_unit(abs(contact.gap))
    said = f"{contact.gap / unit.size:.4g} {unit.name}\n{_law_of(contact)}"
    text = f"{literal(contact.name)}\n{said}" if named else said
    axes.text(
        middle,
        0.5 * (y_1 + y_2) + 0.2,
        text,
        ha="center",
        va="bottom",
        fontsize=6.5,
        color=PALETTE[2],
    )


def _place_of(layout: Layout, end: End) -> tuple[float, float]:
    """Centre of a body, or where a point is on the columns between its bodies."""
    if isinstance(end, str):
        return layout.place[end]
    places = [layout.place.get(name) for name, _ in end.weights]
    x = next(place[0] for place in places if place is not None)
    heights = [0.0 if place is None else place[1] for place in places]
    # Columns begin above a floor and end below the next; the ground has no depth.
    low, high = min(heights), max(heights)
    faces = [
        y + (0.5 * _HIGH if y == low else -0.5 * _HIGH if y == high else 0.0) if y > 0.0 else 0.0
        for y in heights
    ]
    return x, sum(w * y for (_, w), y in zip(weights_of(end), faces, strict=True))


def _column_at(axes: Axes, layout: Layout, point: Point, place: tuple[float, float]) -> None:
    """The column that a point is on, along the side of its bodies, and the point."""
    heights = [layout.place.get(name, (0.0, 0.0))[1] for name, _ in point.weights]
    x = [place[0]] * 2
    axes.plot(x, [min(heights), max(heights)], color=_INK, linewidth=1.0, zorder=2)
    axes.plot(*place, "o", color=PALETTE[2], markersize=3.5, zorder=5)


def _still(axes: Axes, x: tuple[float, float], y: tuple[float, float], away: float = 0.0) -> None:
    """A line that stands still, hatched on the far side: the ground, or a wall (`away` -1 or 1)."""
    axes.plot(x, y, color=_INK, linewidth=1.4, zorder=3)
    if away:
        axes.fill_betweenx(
            y,
            x[0],
            x[0] + 0.28 * away,
            facecolor="none",
            edgecolor="#888888",
            hatch="////",
            linewidth=0.0,
        )
    else:
        axes.fill_between(
            x, y[0] - 0.28, y[0], facecolor="none", edgecolor="#888888", hatch="////", linewidth=0.0
        )


def _body(axes: Axes, place: tuple[float, float], name: str, mass: float) -> None:
    from matplotlib.patches import Rectangle

    corner = (place[0] - 0.5 * _WIDE, place[1] - 0.5 * _HIGH)
    axes.add_patch(
        Rectangle(
            corner, _WIDE, _HIGH, facecolor="#E8EEF4", edgecolor=_INK, linewidth=1.0, zorder=4
        )
    )
    weight = f"{mass / 1e3:.4g} t" if mass >= 1e3 else f"{mass:.4g} kg"
    axes.text(
        *place, f"{literal(name)}\n{weight}", ha="center", va="center", fontsize=7.5, zorder=5
    )


def _legend(axes: Axes, scene: Scene) -> None:
    """What the colours of the springs say, where there are two of them at least."""
    from matplotlib.lines import Line2D

    kinds: Sequence[bool] = (
        any(not isinstance(s.law, BoucWen) and not _kinked(s) for s in scene.springs),
        any(isinstance(s.law, BoucWen) for s in scene.springs),
        any(_kinked(s) for s in scene.springs),
    )
    handles: list[Any] = [
        Line2D([], [], color=color, label=name)
        for there, (name, color) in zip(kinds, _LAWS, strict=True)
        if there
    ]
    if handles:
        axes.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=4)
