"""How springs and dashpots run between the bodies of a picture: through none of them.

A link to the ground stands below its body; where other bodies stand there, on a seat below a
free end of it, else at a wall beside it. Links with a kink stand beside their body, on the side
that the order of their ends says. Links between bodies are straight, and go round what is between.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from eventpound.report.model_layout import HIGH, LEVEL, Box, Layout, face_of, kinked
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.ends import End
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, Spring
from eventpound.scene.structures import joined_groups

WALL = 1.25
"""From the side of a body to a wall."""
_STEP = 0.42
"""Between links of the same ends."""
_BELOW = -0.22
"""Of level links, so that a contact between the same bodies is above them."""
_INSIDE = 0.5
"""From the end of a body to the link that stands there."""
_ROUND = 1.1
"""From a body to a link that goes round it: above the label of a contact."""

_TOUCH = 1e-9
"""Rounding."""

Corner = tuple[float, float]
Link = Spring | Dashpot


@dataclass(frozen=True)
class LinkPath:
    """A link in the picture.

    Parameters
    ----------
    link : Spring or Dashpot
        Which.
    corners : tuple of (x, y)
        Two, or four where it goes round something; one to the ground begins there.
    label : str
        Names of all springs between its ends; empty beside another that says them.
    """

    link: Link
    corners: tuple[Corner, ...]
    label: str

    @property
    def upright(self) -> bool:
        """Whether its middle goes up rather than across."""
        (x_1, y_1), (x_2, y_2) = self.corners[len(self.corners) // 2 - 1 :][:2]
        return abs(x_2 - x_1) < abs(y_2 - y_1)


def links_drawn(scene: Scene, layout: Layout) -> list[LinkPath]:
    """Springs and dashpots of a scene on one ground, but for dashpots without a place.

    Those are from a body above others to the ground, where no spring of it goes, and between two
    bodies of many that are all joined so (modal damping).
    """
    found = []
    for members in _bundles(scene, layout):
        label = "\n".join(link.name for link in members if isinstance(link, Spring))
        for k, link in enumerate(members):
            corners = _corners(layout, link, _STEP * (k - 0.5 * (len(members) - 1)))
            found.append(LinkPath(link, corners, label if k == 0 else ""))
    return found


def _bundles(scene: Scene, layout: Layout) -> Iterator[Sequence[Link]]:
    """Links beside each other, springs first."""
    found: dict[object, list[Link]] = {}
    all_joined = _all_joined(scene)
    links: list[Link] = [*scene.springs, *scene.dashpots]
    for link in links:
        ends = frozenset(link.sides)
        low = GROUND in ends and ends - {GROUND} <= layout.lowest
        if isinstance(link, Dashpot) and ends in all_joined and ends not in found:
            continue
        if GROUND not in ends or link.at_point or (low and not kinked(link)):
            key: object = ends
        elif isinstance(link, Spring):
            key = (link.sides, kinked(link))
        else:
            sides = [(b, False) for b in (link.sides, link.sides[::-1]) if (b, False) in found]
            if not sides:
                continue
            key = sides[0]
        found.setdefault(key, []).append(link)
    yield from found.values()


def _all_joined(scene: Scene) -> set[frozenset[str]]:
    """Pairs of bodies in structures of three or more of which dashpots join every two."""
    names = [body.name for body in scene.bodies]
    beside = [d for d in scene.dashpots if not d.at_point and GROUND not in d.ends]
    ends = [dashpot.ends for dashpot in beside]
    pairs, found = set(map(frozenset, ends)), set[frozenset[str]]()
    for group in joined_groups(names, ends):
        own = {pair for pair in pairs if pair <= set(group)}
        if len(group) >= 3 and 2 * len(own) == len(group) * (len(group) - 1):
            found |= own
    return found


def _corners(layout: Layout, link: Link, shift: float) -> tuple[Corner, ...]:
    first, second = link.sides
    if not (isinstance(first, str) and isinstance(second, str)):
        return _at_points(layout, first, second, shift)
    if GROUND in link.sides:
        name = second if first == GROUND else first
        side = -1.0 if first == GROUND else 1.0
        return _to_ground(layout, name, link, side, shift)
    low, high = sorted((layout.boxes[first], layout.boxes[second]), key=lambda box: (box.y, box.x))
    near, far = sorted((low, high), key=lambda box: box.x)
    if low.top < high.bottom:
        left, right = max(low.left, high.left), min(low.right, high.right)
        x = 0.5 * (left + right) + shift
        straight = (x, low.top), (x, high.bottom)
        if left >= right:
            inner = ((near.right - _INSIDE + shift), (far.left + _INSIDE + shift))
            x_1, x_2 = inner if low is near else inner[::-1]
            straight = (x_1, low.top), (x_2, high.bottom)
    else:
        y = _BELOW + 0.5 * shift
        straight = (near.right, near.y + y), (far.left, far.y + y)
    # It may begin and end at a body.
    if not any(crosses(box, *straight) for box in layout.boxes.values()):
        return straight
    if low.x == high.x:
        x = min(low.left, high.left) - _INSIDE + shift
        return (low.left, low.y), (x, low.y), (x, high.y), (high.left, high.y)
    y = max(box.top for box in layout.boxes.values() if near.x <= box.x <= far.x) + _ROUND + shift
    return (near.x, near.top), (near.x, y), (far.x, y), (far.x, far.top)


def _at_points(layout: Layout, first: End, second: End, shift: float) -> tuple[Corner, Corner]:
    """Between the faces of columns and bodies, or from one of them to a wall."""
    below = _BELOW + 0.5 * shift
    if GROUND in (first, second):
        x, y = face_of(layout, second if first == GROUND else first, 1.0)
        return (x + WALL, y + below), (x, y + below)
    middles = [face_of(layout, end, 0.0)[0] for end in (first, second)]
    way = 1.0 if middles[0] <= middles[1] else -1.0
    (x_1, y_1), (x_2, y_2) = face_of(layout, first, way), face_of(layout, second, -way)
    return (x_1, y_1 + below), (x_2, y_2 + below)


def _to_ground(
    layout: Layout, name: str, link: Link, side: float, shift: float
) -> tuple[Corner, Corner]:
    """From the ground to a body, `side` -1 or 1 the one that the order of its ends says."""
    box = layout.boxes[name]
    if not kinked(link):
        if name in layout.lowest:
            return (box.x + shift, 0.0), (box.x + shift, box.bottom)
        end = 0.5 * box.wide - _INSIDE
        for x in (box.x + side * end, box.x - side * end, box.x):
            seat = Box(x, box.y - LEVEL, 2.0 * _INSIDE)
            if not any(_overlap(seat, other) for other in layout.boxes.values()):
                return (x + shift, seat.top), (x + shift, box.bottom)
    y = box.y + _BELOW + 0.5 * shift
    face = box.x + side * 0.5 * box.wide
    return (face + side * WALL, y), (face, y)


def _overlap(one: Box, other: Box) -> bool:
    return abs(one.x - other.x) < 0.5 * (one.wide + other.wide) and abs(one.y - other.y) < HIGH


def crosses(box: Box, start: Corner, end: Corner) -> bool:
    """Whether a straight line passes through the inside of a body."""
    enter, leave = 0.0, 1.0
    sides = ((box.left, box.right), (box.bottom, box.top))
    for a, b, (low, high) in zip(start, end, sides, strict=True):
        if a == b:
            if not low + _TOUCH < a < high - _TOUCH:
                return False
            continue
        first, last = sorted(((low - a) / (b - a), (high - a) / (b - a)))
        enter, leave = max(enter, first), min(leave, last)
    return leave - enter > _TOUCH
