"""Where the bodies of a scene stand in its picture.

    tower      one chain of springs from the ground: floor over floor, at the heights of its
               storeys where they are given
    row        bodies that can touch, in the order of their contacts, on one level
    carrier    a body that springs join to the ground and to bodies of a row, and that touches
               nothing, such as the cap of a pier: it stands below what it carries

Lengths are those of the picture; but for heights of storeys nothing is to scale.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from eventpound.report.towers import storey_heights
from eventpound.scene.ends import End, weights_of
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, Backfill, BilinearElastic, Linear, Series, Spring
from eventpound.scene.structures import distances, joined_groups, neighbours

WIDE, HIGH = 1.7, 0.8
"""Of a body."""
LEVEL = 2.0
"""From floor to floor."""
JOINT = 1.7
"""Between the faces of neighbours in a row."""
_SEAT = 0.8
"""Of a deck on the cap that it shares with its neighbour."""
_LONG = 3.0
"""Deck with such a seat at either end."""
_CAP = JOINT + 2.0 * _SEAT
"""Carrier of two neighbours."""
_LEAST = 1.4
"""Lowest storey; there a spring still has room."""
_BESIDE = 0.5
"""Between carriers."""
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Box:
    """A body: its centre and its width."""

    x: float
    y: float
    wide: float = WIDE

    @property
    def left(self) -> float:
        """Its left face."""
        return self.x - 0.5 * self.wide

    @property
    def right(self) -> float:
        """Its right face."""
        return self.x + 0.5 * self.wide

    @property
    def bottom(self) -> float:
        """Its lower face."""
        return self.y - 0.5 * HIGH

    @property
    def top(self) -> float:
        """Its upper face."""
        return self.y + 0.5 * HIGH


@dataclass(frozen=True)
class Layout:
    """Where bodies stand.

    Parameters
    ----------
    boxes : mapping of str to Box
        Of each body; the ground is at y = 0.
    lowest : frozenset of str
        Bodies with no other below them.
    """

    boxes: Mapping[str, Box]
    lowest: frozenset[str]


def face_of(layout: Layout, end: End, side: float) -> tuple[float, float]:
    """The face of a body, or a point on the columns between bodies and the ground."""
    found = [(layout.boxes.get(name), weight) for name, weight in weights_of(end)]
    x = next(box.x + 0.5 * side * box.wide for box, _ in found if box is not None)
    return x, sum(weight * box.y for box, weight in found if box is not None)


def kinked(member: object) -> bool:
    """Whether it is a spring with a kink, or soil: to the ground it stands beside its body."""
    law = member.law if isinstance(member, Spring) else None
    return isinstance(law, BilinearElastic | Series | Backfill)


def without_couplings(scene: Scene) -> Scene:
    """The scene with one link of a frame from floor to floor, in the place of its couplings."""
    frames: dict[str, list[Spring]] = {}
    for spring in scene.springs:
        if spring.frame is not None:
            frames.setdefault(spring.frame, []).append(spring)
    if not frames:
        return scene
    links, gone = list[Spring](), set[frozenset[str]]()
    for name, couplings in frames.items():
        gone |= {frozenset(spring.ends) for spring in couplings}
        heights = {spring.sides: spring.height for spring in couplings}
        # Couplings to what a frame stands on come first, and begin there.
        upper = {high for _, high in heights}
        base = dict.fromkeys(low for low, _ in heights if low not in upper)
        floors = [body.name for body in scene.bodies if body.name in upper]
        for ends in pairwise([*base, *floors]):
            called = "" if links and links[-1].frame == name else name
            links.append(Spring(called, ends, Linear(0.0), heights.get(ends), frame=name))
    return replace(
        scene,
        springs=(*(s for s in scene.springs if s.frame is None), *links),
        dashpots=tuple(d for d in scene.dashpots if d.at_point or frozenset(d.ends) not in gone),
    )


def layout_of(scene: Scene) -> Layout:
    """Columns of bodies from the left, each from the ground up; carriers below what they carry."""
    standing = [each for each in scene.springs if not (kinked(each) or each.at_point)]
    beside = neighbours(standing)
    meeting = [set(contact.ends) for contact in scene.contacts if not contact.at_point]
    chains = [_chain(beside, body.name) for body in scene.bodies]
    # Bodies that can touch stand side by side.
    towers = [c for c in chains if c and not any(pair <= set(c) for pair in meeting)]
    stacked = {name for chain in towers for name in chain}
    loose = [body.name for body in scene.bodies if body.name not in stacked]
    level = _levels(scene, loose, beside)
    carried = {
        name: [other for other in beside.get(name, ()) if level.get(other, 0) > level[name]]
        for name in loose
    }
    columns = _in_order(
        scene, towers + [[name] for name in loose if not carried[name]], level, carried
    )
    boxes: dict[str, Box] = {}
    unit, face = _unit_of_height(standing, towers), -0.5 * WIDE
    for column in columns:
        if column in towers:
            places = [Box(face + 0.5 * WIDE, y) for y in _elevations(standing, column, unit)]
        else:
            wide = _width(column[0], carried, beside)
            places = [Box(face + 0.5 * wide, LEVEL * level[column[0]], wide)]
        boxes |= zip(column, places, strict=True)
        face = max(box.right for box in places) + JOINT
    for height in sorted(set(level.values()), reverse=True):
        lower = [name for name in loose if carried[name] and level[name] == height]
        _place_below(lower, height, carried, boxes)
    lowest = {chain[0] for chain in towers} | {name for name in loose if level[name] == 1}
    return Layout(boxes, frozenset(lowest))


def _chain(beside: Mapping[str, Sequence[str]], base: str) -> list[str]:
    """Bodies above one another from a body on the ground, of two at least; empty without them."""
    chain, before = [base], GROUND
    if GROUND not in beside.get(base, ()):
        return []
    while True:
        above = [name for name in beside[chain[-1]] if name != before]
        if not above:
            return chain if len(chain) > 1 else []
        if len(above) > 1 or GROUND in above or above[0] in chain:
            return []
        before = chain[-1]
        chain.append(above[0])


def _levels(
    scene: Scene, loose: Sequence[str], beside: Mapping[str, Sequence[str]]
) -> dict[str, int]:
    """Level of each body that is in no tower, from 1; bodies that can touch have the same."""
    joints = [(str(c.left), str(c.right)) for c in scene.contacts if not c.at_point]
    touching = {end for contact in scene.contacts for end in contact.ends}
    rows = joined_groups(loose, joints)
    row_of = {name: i for i, row in enumerate(rows) for name in row}
    above = {
        i: {row_of[other] for name in row for other in beside.get(name, ()) if other in row_of}
        for i, row in enumerate(rows)
    }
    on_ground = [row_of[name] for name in beside.get(GROUND, ()) if name in row_of]
    free = {i for i, row in enumerate(rows) if not touching.intersection(row)}
    far = distances(on_ground, above)
    under = distances(free.intersection(on_ground), {i: above[i] & free for i in free})
    found: dict[int, int] = {}
    for i in sorted(range(len(rows)), key=lambda i: far.get(i, -1)):
        if i in under:
            found[i] = 1 + under[i]
        else:
            below = [1 + under[j] for j in above[i] if j in under]
            below += [found[j] for j in above[i] & found.keys() if i in free]
            found[i] = max([1 + far.get(i, 0), *(1 + height for height in below)])
    return {name: found[i] for name, i in row_of.items()}


def _in_order(
    scene: Scene,
    columns: list[list[str]],
    level: Mapping[str, int],
    carried: Mapping[str, Sequence[str]],
) -> list[list[str]]:
    """Columns in the order of their contacts, or where they have none in that of the scene."""
    order = {body.name: i for i, body in enumerate(scene.bodies)}
    columns = sorted(columns, key=lambda column: order[column[0]])
    at = {name: c for c, column in enumerate(columns) for name in column}
    for name in sorted(level.keys() - at.keys(), key=lambda name: -level[name]):
        at[name] = at[carried[name][0]]
    before: list[set[int]] = [set() for _ in columns]
    for contact in scene.contacts:
        left, right = (
            {at[name] for name, _ in weights_of(end) if name in at} for end in contact.sides
        )
        for column in right - left:
            before[column] |= left
    placed: list[int] = []
    while len(placed) < len(columns):
        rest = [c for c in range(len(columns)) if c not in placed]
        ready = [c for c in rest if not before[c] - set(placed)]
        # Bodies that stand in a ring have no first one.
        placed.append((ready or rest)[0])
    return [columns[c] for c in placed]


def _width(
    name: str, carried: Mapping[str, Sequence[str]], beside: Mapping[str, Sequence[str]]
) -> float:
    """Of a body that stands on others: so that they have room below it, and what is at its ends."""
    below = [tuple(others) for others in carried.values() if name in others]
    if not below:
        return WIDE
    alone, shared = below.count((name,)), [others for others in below if len(others) > 1]
    inside = alone * (WIDE + _BESIDE) - _BESIDE
    inside += (len(shared) - len(set(shared))) * (_CAP + _BESIDE)
    if shared or GROUND in beside[name]:
        return max(_LONG, inside + 2.0 * (_SEAT + _BESIDE))
    return max(WIDE, inside)


def _place_below(
    names: Sequence[str], height: int, carried: Mapping[str, Sequence[str]], boxes: dict[str, Box]
) -> None:
    """Carriers of one level, each below the middle of what it carries, or the next free place."""
    wanted: list[tuple[float, float, str]] = []
    for name in names:
        above = sorted((boxes[other] for other in carried[name]), key=lambda box: box.x)
        # Between the faces that look at each other; of a single body in its middle.
        middle = 0.5 * (above[0].right + above[-1].left)
        wide = WIDE if len(above) == 1 else _CAP
        same = [other for other in names if carried[other] == carried[name]]
        place = same.index(name) - 0.5 * (len(same) - 1)
        wanted.append((middle + place * (wide + _BESIDE), wide, name))
    y = LEVEL * height
    for x, wide, name in sorted(wanted):
        taken = sorted((box for box in boxes.values() if box.y == y), key=lambda box: box.x)
        for box in taken:
            if abs(box.x - x) < 0.5 * (box.wide + wide) + _BESIDE - _ROUNDING:
                x = box.right + _BESIDE + 0.5 * wide
        boxes[name] = Box(x, y, wide)


def _heights(springs: Sequence[Spring], tower: Sequence[str]) -> tuple[float, ...]:
    """Heights of the storeys of a tower (m), zero of isolators; empty where one is not given."""
    given = {frozenset(s.sides): s.height for s in springs if s.height is not None}
    return storey_heights([given.get(frozenset(ends)) for ends in pairwise([GROUND, *tower])])


def _unit_of_height(springs: Sequence[Spring], towers: Sequence[Sequence[str]]) -> float:
    """Height (m) that is drawn as one level: that of a usual storey, of a low one where it must."""
    known = [h for tower in towers for h in _heights(springs, tower) if h > 0.0]
    return min(sum(known) / len(known), min(known) * LEVEL / _LEAST) if known else 1.0


def _elevations(springs: Sequence[Spring], tower: Sequence[str], unit: float) -> list[float]:
    """Of the bodies of a tower."""
    heights = _heights(springs, tower) or (0.0,) * len(tower)
    found, y = [], 0.0
    for height in heights:
        y += LEVEL * height / unit if height > 0.0 else LEVEL
        found.append(y)
    return found
