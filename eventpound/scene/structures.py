"""Which bodies belong together: those that springs and dashpots join, whatever may touch.

And which stand on isolators: on springs that yield before all that stands on them.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Hashable, Iterable, Mapping, Sequence
from itertools import pairwise, product
from typing import TypeVar

from eventpound.scene.ends import weights_of
from eventpound.scene.grounded import grounded
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, BoucWen, Spring

_Node = TypeVar("_Node", bound=Hashable)


def mass_on(scene: Scene, spring: Spring) -> float | None:
    """Mass that swings on a spring: of all bodies that it alone joins to the ground.

    Parameters
    ----------
    scene : Scene
        A checked scene.
    spring : Spring
        One of its springs; others between the same ends share what it carries.

    Returns
    -------
    float or None
        In kg. Where the ground holds them without it, too, the mass of the one body of a spring
        to the ground, and None of a spring between two bodies.
    """
    scene = grounded(scene)
    between = next(s.ends for s in scene.springs if s.name == spring.name)
    others = [s.ends for s in scene.springs if set(s.ends) != set(between)]
    held, *loose = joined_groups([GROUND, *(body.name for body in scene.bodies)], others)
    hanging = [group for group in loose if not set(between).isdisjoint(group)]
    # On one end a group that nothing else holds; or both ends are held, or neither.
    one_end = len(set(between).difference(held)) == 1
    carried = hanging[0] if one_end else between
    masses = [body.mass for body in scene.bodies if body.name in carried]
    return sum(masses) if one_end or len(masses) == 1 else None


def structures_of(scene: Scene) -> list[list[str]]:
    """Names of the bodies of each structure, in the order of the scene.

    Parameters
    ----------
    scene : Scene
        A checked scene.

    Returns
    -------
    list of list of str
        A group each.
    """
    joints = [spring.ends for spring in scene.springs]
    joints += [dashpot.ends for dashpot in scene.dashpots]
    joints += [tuple(body.name for body in deck.bodies()) for deck in scene.decks]
    return joined_groups([body.name for body in scene.bodies], joints)


def structure_names(scene: Scene) -> list[str]:
    """What structures are called: as one of their bodies says, else as the first of them.

    Where two would be called the same, each is called as its first body.
    """
    said = {body.name: body.structure for body in scene.bodies}
    groups = structures_of(scene)
    pairs = [(next(filter(None, map(said.get, group)), group[0]), group[0]) for group in groups]
    taken = Counter(name for pair in pairs for name in {*pair})
    return [first if taken[name] > 1 else name for name, first in pairs]


def joined_groups(bodies: Sequence[str], joints: Iterable[Sequence[str]]) -> list[list[str]]:
    """Groups of bodies that joints connect; those to the ground or a support connect none.

    Parameters
    ----------
    bodies : sequence of str
        Names; groups and their members keep the order.
    joints : iterable of sequence of str
        Ends of each, all that it has at its points.
    """
    beside: dict[str, list[str]] = {name: [] for name in bodies}
    for ends in joints:
        for first, second in pairwise(end for end in ends if end in beside):
            beside[first].append(second)
            beside[second].append(first)
    position = {name: i for i, name in enumerate(beside)}
    found: list[list[str]] = []
    placed: set[str] = set()
    for start in beside:
        if start not in placed:
            group = distances([start], beside)
            placed |= group.keys()
            found.append(sorted(group, key=position.__getitem__))
    return found


def is_storey(scene: Scene, i: int) -> bool:
    """Whether spring i has a height and is a storey: no pier, alone below what bearings carry.

    What has an end at a point is a brace or a damper, whatever its height.
    """
    spring, bodies = scene.springs[i], {body.name for body in scene.bodies}
    if spring.height is None or spring.at_point:
        return False
    if spring.frame is not None:
        return True
    own = bodies.intersection(spring.ends)
    beside = [s for k, s in enumerate(scene.springs) if k != i and own.intersection(s.ends)]
    carries = any(bodies.intersection(s.ends) - own for s in beside if s.frame is None)
    return any(s.height is not None for s in beside) or not carries


def of_frames(scene: Scene) -> set[str]:
    """Bodies of frames: how a floor swings while all others are held is no mode that matters."""
    return {end for spring in scene.springs if spring.frame is not None for end in spring.ends}


def neighbours(springs: Iterable[Spring]) -> dict[str, list[str]]:
    """What springs join to each end of one, each once and in their order."""
    found: dict[str, dict[str, None]] = {}
    for spring in springs:
        first, second = ([name for name, _ in weights_of(end)] for end in spring.sides)
        for here, there in (*product(first, second), *product(second, first)):
            found.setdefault(here, {})[there] = None
    return {name: list(others) for name, others in found.items()}


def distances(start: Iterable[_Node], beside: Mapping[_Node, Iterable[_Node]]) -> dict[_Node, int]:
    """How many links away the nearest start is, of all nodes that links lead to."""
    found: dict[_Node, int] = {}
    edge, distance = set(start), 0
    while edge:
        found |= dict.fromkeys(edge, distance)
        edge = {there for here in edge for there in beside.get(here, ())} - found.keys()
        distance += 1
    return found


def isolated(scene: Scene) -> set[str]:
    """Bodies that stand on springs which yield before all that stands on them.

    Parameters
    ----------
    scene : Scene
        A checked scene.

    Returns
    -------
    set of str
        The body on the isolators, and what hangs on it by springs that are elastic or stronger.
        The storeys of a frame grow weaker upwards: there it is the first floor alone.
    """
    scene = grounded(scene)
    yields: dict[frozenset[str], float] = {}
    for spring in scene.springs:
        law = spring.law
        if isinstance(law, BoucWen) and law.yields:
            ends = frozenset(spring.ends)
            force = law.yield_force
            yields[ends] = yields.get(ends, 0.0) + force
    names = [GROUND, *(body.name for body in scene.bodies)]
    joints = [spring.ends for spring in scene.springs]
    elastic = [ends for ends in joints if frozenset(ends) not in yields]
    # What the ground holds without a spring that yields: piers, abutments, footings.
    held = set(joined_groups(names, elastic)[0])
    below: dict[str, float] = {}
    for ends, force in yields.items():
        if len(ends - held) == 1:
            (above,) = ends - held
            below[above] = below.get(above, 0.0) + force
    others = [name for name in names if name not in held]
    found: set[str] = set()
    for body, force in below.items():
        stronger = [e for e in joints if yields.get(frozenset(e), math.inf) > force]
        found.update(*(group for group in joined_groups(others, stronger) if body in group))
    return found
