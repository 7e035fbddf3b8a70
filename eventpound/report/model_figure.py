"""The scene as a picture: bodies, springs, dashpots, gaps and what stands still.

`eventpound.report.model_layout` says where bodies stand, `eventpound.report.model_links` how
springs run. Nothing is to scale but heights of storeys.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from eventpound.numerics.arrays import Floats
from eventpound.report.law_panel import draw_law, laws_shown
from eventpound.report.model_layout import (
    HIGH,
    LEVEL,
    WIDE,
    Box,
    Layout,
    face_of,
    layout_of,
    without_couplings,
)
from eventpound.report.model_links import WALL, LinkPath, links_drawn
from eventpound.report.plan_view import plan_figure
from eventpound.report.style import PALETTE, arrow, literal, new_figure, say, styled
from eventpound.results.shown_units import Units
from eventpound.scene.body import Body
from eventpound.scene.contact import BARRIER, Contact
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.ends import End
from eventpound.scene.grounded import grounded
from eventpound.scene.plan_point import PlanPoint
from eventpound.scene.point import Point
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, LawName, Slider, Spring
from eventpound.units import Dimension

_MARGIN = WALL + 0.85
"""Beside the bodies."""
_UP = 0.24
"""Of a contact above the spring between the same bodies."""
_TEETH, _SWAY = 5, 0.13
_INK = "#333333"
_KINKED = "bilinear-elastic or series"
_CALLED = {
    **dict.fromkeys((LawName.BILINEAR_ELASTIC, LawName.SERIES), _KINKED),
    LawName.DEGRADING_BOUC_WEN: "bouc-wen",
}
"""Laws that are drawn as others."""
_COLORS = _INK, PALETTE[1], PALETTE[0], PALETTE[4], PALETTE[3], *PALETTE[5:]
_LAWS = dict(
    zip(dict.fromkeys(_CALLED.get(law, law.value) for law in LawName), _COLORS, strict=False)
)
_MOST_NAMES = 40
"""Springs and contacts of a scene in which each is named."""


_LAW = 2.1
"""Inches of the picture of a law."""
_LETTERS, _LETTER_WIDTH = 6.5, 0.6
"""Points, of names of springs and contacts; a letter is so much of it wide."""
_SMALLEST, _LINE = 4.5, 1.2
"""Points, and from line to line in letters."""
_LARGEST = 14.0, 1e3
"""Inches of a figure that is looked at by itself: as high as it has to be."""
_USUAL = Units()


@dataclass(frozen=True)
class _Names:
    """What names have room: `points` of a unit of the picture, `floor` the least height of one.

    `shown`: whether parts are named; `units`: units of gaps.
    """

    points: float
    floor: float
    shown: bool
    units: Units

    def fitted(self, text: str, room: float) -> float:
        """Size of letters (points) with which a text has at most this length, if it can."""
        needed = max(map(len, text.split("\n"))) * _LETTER_WIDTH * _LETTERS
        return max(_SMALLEST, min(_LETTERS, _LETTERS * room * self.points / needed))

    def has_room(self, text: str, room: float) -> bool:
        """Whether a text is about this long with the smallest letters."""
        needed = max(map(len, text.split("\n"))) * _LETTER_WIDTH * _SMALLEST
        return needed < 1.2 * room * self.points

    def below(self, lines: int, room: float, letters: float = _LETTERS) -> float:
        """Size of letters (points), no larger, with which lines have at most this height."""
        return min(letters, room * self.points / (_LINE * lines))

    def high(self, text: str) -> float:
        """Height of lines of a text."""
        return _LINE * (text.count("\n") + 1) * _LETTERS / self.points


@styled()
def model_figure(
    scene: Scene,
    title: str = "",
    *,
    with_laws: bool = False,
    units: Units = _USUAL,
    within: tuple[float, float] = _LARGEST,
) -> Figure:
    """Draw a scene.

    Parameters
    ----------
    scene : Scene
        A checked scene.
    title : str
        Above it.
    with_laws : bool
        Whether the laws of its springs are drawn below it.
    units : Units
        Units of the gaps.
    within : tuple of float
        Width and height that the scene has at most (in).
    """
    if scene.decks:
        return plan_figure(scene, title, units=units, within=within)
    standing = without_couplings(grounded(scene))
    layout = layout_of(standing)
    routes = links_drawn(standing, layout)
    boxes = layout.boxes.values()
    left = min(box.left for box in boxes) - _MARGIN
    right = max(box.right for box in boxes) + _MARGIN
    top = max(box.top for box in boxes) + 1.0
    # As small as that, but so large that the name of a body fits into it.
    least = max(len(body.name) for body in scene.bodies) * _LETTER_WIDTH * _SMALLEST / 72.0 / WIDE
    scale = max(min(within[0] / (right - left), within[1] / top), least)
    scale = min(0.75, _LARGEST[0] / (right - left), scale)
    few = len(scene.springs) + len(scene.contacts) <= _MOST_NAMES
    names = _Names(72.0 * scale, _least_floor(layout), few, units)
    low = -0.8 if scene.supports else -0.5
    tops = [box.top + 0.3 for box in boxes]
    labels = [_label_of(layout, joint, names) for joint in _joints(standing)]
    tops += [bottom + _UP + names.high(text) for text, bottom in labels]
    tops += [y + 0.4 for route in routes for _, y in route.corners]
    laws = laws_shown(scene.springs) if with_laws else []
    wide, high = scale * (right - left), scale * (max(tops) - low) + 0.9
    heights = [high, _LAW] if laws else [high]
    figure = new_figure(max(min(4.5, within[0]), wide, _LAW * len(laws)), sum(heights))
    grid = figure.add_gridspec(len(heights), max(1, len(laws)), height_ratios=heights)
    axes = figure.add_subplot(grid[0, :])
    for i, (name, law) in enumerate(laws):
        draw_law(figure.add_subplot(grid[1, i]), law, name)
    _still(axes, (left, right), (0.0, 0.0))
    _draw(axes, standing, layout, routes, names)
    for foot in _feet(scene, standing, layout, routes):
        _name_below(axes, *foot)
    axes.set(xlim=(left, right), ylim=(low, max(tops)), aspect="equal", title=literal(title))
    axes.axis("off")
    hidden = len(routes) < len(scene.springs) + len(scene.dashpots)
    _legend(axes, scene, "dashpots that pass a floor are not drawn" if hidden else "")
    return figure


def _least_floor(layout: Layout) -> float:
    """Least height between bodies above each other."""
    levels = sorted({box.y for box in layout.boxes.values()})
    return min((b - a for a, b in pairwise(levels) if b - a > HIGH), default=LEVEL)


def _draw(
    axes: Axes, scene: Scene, layout: Layout, routes: Sequence[LinkPath], names: _Names
) -> None:
    """All parts of a scene on one ground."""
    for route in routes:
        _link(axes, route, names)
        for end, place in zip(route.link.sides, (route.corners[0], route.corners[-1]), strict=True):
            if not isinstance(end, str):
                _column_at(axes, layout, end, place)
    # A wall beside a body may have a spring and a contact.
    level = [route.link.sides for route in routes if not route.upright]
    joined = {frozenset(BARRIER if end == GROUND else end for end in ends) for ends in level}
    for joint in _joints(scene):
        _contact(axes, layout, joint, _UP * (frozenset(joint[0].sides) in joined), names)
    for body in scene.bodies:
        _body(axes, layout.boxes[body.name], body, names)
    for box in (layout.boxes[name] for name in {force.body for force in scene.forces}):
        y = box.top + 0.12
        ends = (box.x - 0.4, y), (box.x + 0.4, y)
        arrow(axes, *ends, arrowstyle="->", color=PALETTE[3], linewidth=1.2)


def _feet(
    scene: Scene, standing: Scene, layout: Layout, routes: Sequence[LinkPath]
) -> list[tuple[str, float, float]]:
    """Supports, each by its name at every place where something stands on it."""
    names = {support.name for support in scene.supports}
    given, on_ground = _parts(without_couplings(scene)), _parts(standing)
    support_of = {
        id(new): name
        for (_, ends), (new, _) in zip(given, on_ground, strict=True)
        for name in names.intersection(ends)
    }
    found: dict[tuple[str, float], float] = {}
    for route in routes:
        if id(route.link) in support_of:
            (x, y), first, second = route.corners[0], *route.link.sides
            if y == 0.0:
                x = face_of(layout, first if second == GROUND else second, 0.0)[0]
            found[support_of[id(route.link)], x] = y - (0.3 if route.upright else 0.35)
    for contact in standing.contacts:
        if id(contact) in support_of:
            x, y = _faces(layout, contact)[contact.right == BARRIER]
            found[support_of[id(contact)], x] = y - 0.5
    return [(name, x, y) for (name, x), y in found.items()]


def _parts(scene: Scene) -> list[tuple[object, tuple[End, ...]]]:
    """Springs, dashpots and contacts with their ends."""
    links: list[Spring | Dashpot] = [*scene.springs, *scene.dashpots]
    return [
        *((link, link.sides) for link in links),
        *((contact, contact.sides) for contact in scene.contacts),
    ]


def _name_below(axes: Axes, name: str, x: float, y: float) -> None:
    """The name of a support, with an arrow either way: it moves by itself."""
    ends = (x - 0.45, y - 0.08), (x + 0.45, y - 0.08)
    arrow(axes, *ends, arrowstyle="<->", color=PALETTE[3], linewidth=0.9)
    axes.text(x, y - 0.14, literal(name), ha="center", va="top", fontsize=6.5, color=PALETTE[3])


def _link(axes: Axes, route: LinkPath, names: _Names) -> None:
    """A spring or a dashpot, in the middle part of its way."""
    corners = np.array(route.corners)
    middle = len(corners) // 2
    a, b = corners[middle - 1 : middle + 1]
    color = _color(route.link)
    for part in (corners[:middle], corners[middle:]):
        axes.plot(*part.T, color=color, linewidth=1.2, zorder=2)
    if isinstance(route.link, Spring) and isinstance(route.link.law, Slider):
        _bearing(axes, a, b, route.upright)
    elif isinstance(route.link, Spring) and route.link.frame is not None:
        _columns(axes, a, b)
    elif isinstance(route.link, Spring):
        axes.plot(*_zigzag(a, b).T, color=color, linewidth=1.2, solid_joinstyle="miter", zorder=2)
    else:
        _dashpot(axes, a, b)
    if GROUND in route.link.sides and not route.upright:
        _still(axes, (a[0], a[0]), (a[1] - 0.35, a[1] + 0.55), away=np.sign(a[0] - b[0]))
    elif GROUND in route.link.sides and a[1] > 0.0:
        _still(axes, (a[0] - 0.4, a[0] + 0.4), (a[1], a[1]))
    room = float(np.hypot(*(b - a))) + (0.0 if route.upright else 0.6)
    if names.shown and route.label and names.has_room(route.label, room):
        beside = np.array([_SWAY, 0.0] if route.upright else [0.0, _SWAY])
        x, y = 0.5 * (a + b) - beside
        look = {"fontsize": names.fitted(route.label, room), "color": color}
        turn, away = (90, (-2, 0)) if route.upright else (0, (0, -2))
        say(axes, literal(route.label), (x, y), away, rotation=turn, **look)


def _color(link: Spring | Dashpot) -> str:
    """By the law of a spring."""
    if isinstance(link, Dashpot):
        return "#777777"
    return _LAWS[_CALLED.get(link.law.word, link.law.word)]


def _columns(axes: Axes, a: Floats, b: Floats) -> None:
    """Columns of a frame between two of its floors."""
    across = np.array([b[1] - a[1], a[0] - b[0]]) / np.hypot(*(b - a))
    for side in (-0.6, 0.6):
        axes.plot(*np.array([a + side * across, b + side * across]).T, color=_INK, linewidth=1.8)


def _zigzag(a: Floats, b: Floats) -> Floats:
    """Corners of a spring between two points, shape (n, 2)."""
    along = b - a
    across = np.array([-along[1], along[0]]) / np.hypot(*along)
    part = np.concatenate([[0.0, 0.2], np.linspace(0.2, 0.8, 2 * _TEETH + 1)[1:-1], [0.8, 1.0]])
    sway = np.zeros(part.size)
    sway[2:-2] = _SWAY * np.where(np.arange(part.size - 4) % 2 == 0, 1.0, -1.0)
    return np.asarray(a + np.outer(part, along) + np.outer(sway, across))


def _bearing(axes: Axes, a: Floats, b: Floats, upright: bool) -> None:
    """A plate that slides on a longer one, level wherever the bearing stands."""
    apart = np.array([0.0, -0.05 if a[1] > b[1] else 0.05])
    for end, half, side in ((a, _SWAY, -1.0), (b, 0.5 * _SWAY, 1.0)):
        plate = 0.5 * (a + b) + side * apart + np.outer([-half, 0.0, half], [1.0, 0.0])
        near = 1 if upright else 2 * int(end[0] > plate[1, 0])
        look: Any = {"color": _LAWS[LawName.SLIDER], "zorder": 2}
        axes.plot(*np.array([end, plate[near]]).T, linewidth=1.2, **look)
        axes.plot(*plate.T, linewidth=2.2, **look)


def _dashpot(axes: Axes, a: Floats, b: Floats) -> None:
    """A piston in a cylinder."""
    along = (b - a) / np.hypot(*(b - a))
    across = np.array([-along[1], along[0]])
    middle, half, side = 0.5 * (a + b), 0.17 * along, _SWAY * across
    cup = [middle + half + side, middle - half + side, middle - half - side, middle + half - side]
    for line in ([a, middle - half], cup, [middle + 0.7 * side, middle - 0.7 * side], [middle, b]):
        axes.plot(*np.array(line).T, color="#777777", linewidth=0.9, zorder=2)


def _joints(scene: Scene) -> list[list[Contact]]:
    """Contacts, those between the same ends together, such as the corners of a skew deck."""
    found: dict[object, list[Contact]] = {}
    for contact in scene.contacts:
        found.setdefault((contact.left, contact.right), []).append(contact)
    return list(found.values())


def _contact(
    axes: Axes, layout: Layout, joint: Sequence[Contact], up: float, names: _Names
) -> None:
    """Two faces with the gap between them."""
    contact = joint[0]
    (x_1, y_1), (x_2, y_2) = faces = [(x, y + up) for x, y in _faces(layout, contact)]
    for end, (x, y), side in zip(contact.sides, faces, (-1.0, 1.0), strict=True):
        if end == BARRIER:
            _still(axes, (x, x), (y - up - 0.5, y - up + 0.6), away=side)
        elif not isinstance(end, str):
            _column_at(axes, layout, end, (x, y))
    middle, level = 0.5 * (x_1 + x_2), 0.5 * (y_1 + y_2)
    for x, y, side in ((x_1, y_1, -1.0), (x_2, y_2, 1.0)):
        tip = middle + side * 0.12
        axes.plot([x, tip], [y, level], color=PALETTE[2], linewidth=1.2, zorder=2)
        axes.plot([tip, tip], [level - 0.14, level + 0.14], color=PALETTE[2], linewidth=2.2)
    text, bottom = _label_of(layout, joint, names)
    letters = min(
        names.below(text.count("\n") + 1, 0.8 * (names.floor - 0.3 - up)),
        names.fitted(text.replace("$", "").replace("\\epsilon", "e"), abs(x_2 - x_1) + WIDE),
    )
    look: Any = {"ha": "center", "va": "bottom", "fontsize": letters, "color": PALETTE[2]}
    axes.text(middle, bottom + up, text, **look)


def _label_of(layout: Layout, joint: Sequence[Contact], names: _Names) -> tuple[str, float]:
    """What is said of a joint, and how high: between its bodies where there is room for it."""
    lines, (unit, size) = list[str](), names.units.unit(Dimension.LENGTH.unit)
    for contact in joint:
        law = f"$\\epsilon$ = {contact.restitution:g}" if contact.law is None else contact.law.kind
        gap = f"{contact.gap / size:.4g} {unit}"
        lines += [literal(contact.name)] * names.shown
        lines += [gap, law] if len(joint) == 1 else [f"{gap}, {law}"]
    text, room = "\n".join(lines), 0.5 * HIGH - 0.2
    (x_1, y_1), (x_2, y_2) = _faces(layout, joint[0])
    fits = all(names.fitted(contact.name, abs(x_2 - x_1)) == _LETTERS for contact in joint)
    if fits and (len(joint) == 1 or names.high(text) < room + LEVEL - HIGH):
        return text, 0.5 * (y_1 + y_2) + 0.2
    return text, max(y_1, y_2) + 0.5 * HIGH + 0.05


def _faces(layout: Layout, contact: Contact) -> tuple[tuple[float, float], tuple[float, float]]:
    """Where the two sides of a contact are; a barrier stands beside the body that it meets."""
    if contact.left == BARRIER:
        x, y = face_of(layout, contact.right, -1.0)
        return (x - WALL, y), (x, y)
    first = face_of(layout, contact.left, 1.0)
    if contact.right == BARRIER:
        return first, (first[0] + WALL, first[1])
    return first, face_of(layout, contact.right, -1.0)


def _column_at(
    axes: Axes, layout: Layout, point: Point | PlanPoint, place: tuple[float, float]
) -> None:
    """The column that a point is on, along the side of its bodies, and the point."""
    heights = [layout.boxes[name].y for name, _ in point.parts if name in layout.boxes]
    lowest = min(heights) if len(heights) == len(point.parts) else 0.0
    axes.plot([place[0]] * 2, [lowest, max(heights)], color=_INK, linewidth=1.0, zorder=2)
    axes.plot(*place, "o", color=PALETTE[2], markersize=3.5, zorder=5)


def _still(axes: Axes, x: tuple[float, float], y: tuple[float, float], away: float = 0.0) -> None:
    """A line that stands still, hatched on the far side: the ground, or a wall (`away` -1 or 1)."""
    axes.plot(x, y, color=_INK, linewidth=1.4, zorder=3)
    hatched: Any = {"facecolor": "none", "edgecolor": "#888888", "hatch": "////", "linewidth": 0.0}
    if away:
        axes.fill_betweenx(y, x[0], x[0] + 0.28 * away, **hatched)
    else:
        axes.fill_between(x, y[0] - 0.28, y[0], **hatched)


def _body(axes: Axes, box: Box, body: Body, names: _Names) -> None:
    mass, corner = body.mass, (box.left, box.bottom)
    shape = Rectangle(corner, box.wide, HIGH, facecolor="#E8EEF4", edgecolor=_INK, zorder=4)
    axes.add_patch(shape)
    weight = f"{mass / 1e3:.4g} t" if mass >= 1e3 else f"{mass:.4g} kg"
    letters = names.fitted(f"{body.name}\n{weight}", 0.95 * box.wide)
    look: Any = {"ha": "center", "va": "center", "fontsize": names.below(2, HIGH, letters)}
    axes.text(box.x, box.y, f"{literal(body.name)}\n{weight}", zorder=5, **look)


def _legend(axes: Axes, scene: Scene, said: str) -> None:
    """What the colours of the springs say, below a note."""
    there = {_color(spring) for spring in scene.springs}
    handles = [
        Line2D([], [], color=color, label=name) for name, color in _LAWS.items() if color in there
    ]
    if handles:
        look: Any = {"loc": "upper center", "bbox_to_anchor": (0.5, 0.0), "ncols": 4}
        axes.legend(handles=handles, title=said, title_fontsize=_LETTERS, fontsize=_LETTERS, **look)
