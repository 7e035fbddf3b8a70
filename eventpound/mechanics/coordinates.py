"""Which coordinates of a scene its springs, dashpots and contacts are between.

The coordinates are the bodies, and behind them the points that an end of one of these is at
(`eventpound.scene.ends`), each once.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.scene.contact import BARRIER
from eventpound.scene.ends import End, weights_of
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND

_Pair = tuple[int, int]


class Numbered(NamedTuple):
    """Ends by the numbers of their coordinates, -1 for the ground and barriers.

    springs, contacts: first and second end of each. tangents: of each contact with friction the
    ends along which it slides. dashpots: links of dashpots that stand alone.
    of_dashpot: the link of each dashpot, springs numbered first. weights (D, N): parts of the
    coordinates in the points, the last of them. on_ground (D,): that of the ground.
    """

    springs: list[_Pair]
    dashpots: list[_Pair]
    contacts: list[_Pair]
    tangents: list[_Pair]
    of_dashpot: list[int]
    weights: Floats
    on_ground: Floats


def numbered(scene: Scene) -> Numbered:
    """Ends of a checked scene; a dashpot shares the link of a spring between the same ends.

    Its supports count as the ground.
    """
    index = {body.name: i for i, body in enumerate(scene.bodies)} | {GROUND: -1, BARRIER: -1}
    index |= {support.name: -1 for support in scene.supports}
    bodies = len(scene.bodies)
    points: dict[tuple[tuple[tuple[str, float], ...], str], int] = {}

    def coordinate(end: End, own: str = "") -> int:
        if isinstance(end, str):
            return index[end]
        if all(index[name] < 0 for name, _ in weights_of(end)):
            return -1
        return points.setdefault((weights_of(end), own), bodies + len(points))

    def pair(first: End, second: End, own: str = "") -> _Pair:
        return coordinate(first, own), coordinate(second, own)

    springs = [pair(*spring.between) for spring in scene.springs]
    links, of_dashpot = springs.copy(), list[int]()
    for ends in (pair(*dashpot.between) for dashpot in scene.dashpots):
        place = next((i for i, e in enumerate(links) if e in (ends, ends[::-1])), len(links))
        if place == len(links):
            links.append(ends)
        of_dashpot.append(place)
    # Friction asks for points of its own, at which nothing else acts.
    own = [contact.name if contact.friction else "" for contact in scene.contacts]
    contacts = [pair(c.left, c.right, name) for c, name in zip(scene.contacts, own, strict=True)]
    tangents = [
        pair(*contact.tangent, name) if name else (-1, -1)
        for contact, name in zip(scene.contacts, own, strict=True)
    ]
    weights, on_ground = np.zeros((len(points), bodies + len(points))), np.zeros(len(points))
    for d, (parts, _) in enumerate(points):
        for name, weight in parts:
            if index[name] < 0:
                on_ground[d] += weight
            else:
                weights[d, index[name]] += weight
    alone = links[len(springs) :]
    return Numbered(springs, alone, contacts, tangents, of_dashpot, weights, on_ground)


def parts_on_ground(ends: list[_Pair], bodies: int, on_ground: Floats) -> Floats:
    """What of the force of each link counts in the base shear, shape (L,).

    Parameters
    ----------
    ends : list of tuple of int
        Its coordinates.
    bodies : int
        How many of these are no points.
    on_ground : ndarray, shape (D,)
        As of `Numbered`.
    """
    # The last is the ground, which index -1 is.
    part = [*[0.0] * bodies, *on_ground.tolist(), 1.0]
    return np.array([part[first] - part[second] for first, second in ends])
