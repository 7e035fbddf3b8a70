"""What a scene in plan has at every row of a history beside what others have."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.scene.deck import CORNERS, Deck
from eventpound.scene.ends import Joining, opening
from eventpound.scene.plan_point import ACROSS, ALONG, TURN, PlanPoint
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND
from eventpound.scene.structures import structure_names, structures_of
from eventpound.solvers.base import History

WAYS = {"along": (1.0, 0.0), "across": (0.0, 1.0)}
"""Directions of the displacements of corners, by what quantities call them."""


def corners_of(scene: Scene) -> list[tuple[str, Deck, tuple[float, float]]]:
    """Name of every corner, its deck, and where it is from the centre (m)."""
    return [
        (f"{deck.name}.{word}", deck, at)
        for deck in scene.decks
        for word, at in zip(CORNERS, deck.corners, strict=True)
    ]


def displacement_at(end: PlanPoint, scene: Scene, u: Floats) -> Floats:
    """Displacement of a place of a deck in a direction (m), (n,), by those of all bodies (n, N)."""
    place = {body.name: b for b, body in enumerate(scene.bodies)}
    total: Floats = sum(weight * u[:, place[name]] for name, weight in end.parts)  # type: ignore[assignment]
    return total


def part_on_ground(link: Joining, direction: str, scene: Scene) -> float:
    """What the ground takes of the pull of a link in a direction; none of one to something else."""
    if GROUND not in link.sides:
        return 0.0
    other = link.sides[1 - link.sides.index(GROUND)]
    # What pulls the first end to the right pulls the second to the left.
    way = 1.0 if link.sides[0] == GROUND else -1.0
    if isinstance(other, PlanPoint):
        return way * dict(zip((ALONG, ACROSS), other.normal, strict=True))[direction]
    own = next((body.direction for body in scene.bodies if body.name == other), "")
    return way if own == direction else 0.0


def signals_in_plan(
    scene: Scene, h: History, rate: Mapping[str, Floats]
) -> Iterator[tuple[str, Floats]]:
    """What a scene in plan has at every row beside what others have (SI), by names.

    Parameters
    ----------
    scene : Scene
        With decks.
    h : History
        Of its run, n rows.
    rate : mapping of str to ndarray, shape (n,)
        Velocities of all ends (m/s).
    """
    for b, body in enumerate(scene.bodies):
        if body.direction != TURN:
            yield f"acceleration.{body.name}.*", h.a[:, b]
    pulls = [h.force[:, i] for i in range(len(scene.springs))]
    pulls += [np.asarray(d.coefficient * opening(d, 0.0, rate)) for d in scene.dashpots]
    structures = zip(structure_names(scene), structures_of(scene), strict=True)
    groups: list[tuple[str, set[str] | None]] = [("base_shear{}.*", None)]
    groups += [(f"structures.{name}.*_base_shear{{}}", {GROUND, *own}) for name, own in structures]
    for name, among in groups:
        for word, direction in (("", ALONG), ("_across", ACROSS)):
            total = np.zeros(h.t.size)
            for link, pull in zip((*scene.springs, *scene.dashpots), pulls, strict=True):
                if among is None or among.issuperset(link.ends):
                    total += part_on_ground(link, direction, scene) * pull
            yield name.format(word), total
    for corner, deck, at in corners_of(scene):
        for word, direction_of in WAYS.items():
            signal = displacement_at(deck.toward(at, direction_of), scene, h.u)
            yield f"corners.{corner}.*_{word}", signal
