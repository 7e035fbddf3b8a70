"""What is wrong with decks in plan, and with places of them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from eventpound.motion.free import NoMotion
from eventpound.scene.plan_point import ACROSS, DIRECTIONS, PlanPoint, coordinate_of
from eventpound.scene.point import WHOLE
from eventpound.scene.scene import Scene


class Wrong(NamedTuple):
    """Something that is wrong: which element (from 1), its name, the key, what it has and may."""

    kind: str
    position: int
    name: str
    key: str
    found: object
    accepted: str


def plan_problems(scene: Scene) -> Iterator[Wrong]:
    """Directions of bodies, decks without their bodies, and what there is not in plan."""
    for i, body in enumerate(scene.bodies, 1):
        if body.direction not in DIRECTIONS:
            accepted = f"one of {', '.join(DIRECTIONS)}"
            yield Wrong("body", i, body.name, "direction", body.direction, accepted)
    bodies = {body.name: body for body in scene.bodies}
    for i, deck in enumerate(scene.decks, 1):
        for word in DIRECTIONS:
            name = coordinate_of(deck.name, word)
            own = bodies.get(name)
            if own is None or own.direction != word or own.mass != deck.mass:
                accepted = f"{name} among the bodies, as Deck.bodies has it"
                yield Wrong("deck", i, deck.name, "name", deck.name, accepted)
    if scene.in_plan and scene.supports:
        support = scene.supports[0].name
        yield Wrong("support", 1, support, "name", support, "none in a scene in plan")
    second = not isinstance(scene.across, NoMotion)
    if second and all(body.direction != ACROSS for body in scene.bodies):
        accepted = "no second component where no body moves across: a scene with decks"
        yield Wrong("excitation", 1, "", "across", scene.across.kind, accepted)


def place_problems(end: PlanPoint, scene: Scene) -> Iterator[tuple[object, str]]:
    """What is wrong with a place of a deck in a direction: what was found, and is accepted."""
    deck = next((deck for deck in scene.decks if deck.name == end.deck), None)
    if deck is None:
        yield end.deck, f"a deck, of {', '.join(d.name for d in scene.decks) or 'which are none'}"
    elif not abs(end.radius - deck.radius) <= WHOLE * deck.radius:
        yield end.radius, f"the radius of {deck.name}, {deck.radius!r}"
    if not abs(math.hypot(*end.normal) - 1.0) <= WHOLE:
        yield list(end.normal), "a normal of length one"
    if not all(math.isfinite(each) for each in end.at):
        yield list(end.at), "a place with finite numbers"
