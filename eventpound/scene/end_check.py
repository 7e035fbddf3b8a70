"""What is wrong with ends of springs, dashpots, contacts and seats, and with decks in plan."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from eventpound.motion.free import NoMotion
from eventpound.scene.ends import End, weights_of
from eventpound.scene.plan_point import ACROSS, DIRECTIONS, PlanPoint, coordinate_of
from eventpound.scene.point import WHOLE
from eventpound.scene.problem import Part, Problem, some_of
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND


def end_problems(
    element: Part, sides: tuple[End, End], scene: Scene, fixed: str
) -> Iterator[Problem]:
    """What is wrong with two ends; `fixed` is what the ground is called there."""
    if all(isinstance(end, str) for end in sides):
        yield from _name_end_problems(element, tuple(map(str, sides)), scene, fixed)
    else:
        yield from _point_problems(element, sides, scene, fixed)


def _name_end_problems(
    element: Part, between: Sequence[str], scene: Scene, fixed: str
) -> Iterator[Problem]:
    """Two different ends, each a body or one that is fixed, not both of those."""
    names = [body.name for body in scene.bodies]
    held = [fixed, *(support.name for support in scene.supports)]
    choices = some_of(names, held)
    for end in between:
        if end not in held and end not in names:
            yield element.problem("between", end, f"two different ones of {choices}")
    if between[0] == between[1]:
        yield element.problem("between", list(between), f"two different ones of {choices}")
    elif set(between) <= set(held):
        yield element.problem("between", list(between), "a body at one end at least")


def _point_problems(
    element: Part, sides: tuple[End, End], scene: Scene, fixed: str
) -> Iterator[Problem]:
    """Ends of which one is a point between bodies."""
    known, held = {b.name for b in scene.bodies}, [support.name for support in scene.supports]
    names = [body.name for body in scene.bodies]
    for end in sides:
        if isinstance(end, str):
            if end not in (known | {fixed, *held}):
                some = some_of(names, [fixed, *held])
                yield element.problem("between", end, f"one of {some}, or a point")
            continue
        if isinstance(end, PlanPoint):
            for found, accepted in _place_problems(end, scene):
                yield element.problem("between", found, accepted)
            continue
        for name, weight in end.weights:
            if name not in (known | {GROUND, *held}):
                some = some_of(names, [GROUND, *held])
                accepted = f"points between bodies and the ground: {some}"
                yield element.problem("between", name, accepted)
            elif not 0.0 < weight <= 1.0 + WHOLE:
                accepted = "positive weights, 1 in sum"
                yield element.problem("between", f"{name} = {weight!r}", accepted)
        if not abs(end.total - 1.0) <= WHOLE:
            yield element.problem("between", end.total, "weights of a point that are 1 in sum")
    ends = [name for end in sides for name, _ in weights_of(end)]
    twice = sorted(name for name in known if ends.count(name) > 1)
    if twice:
        yield element.problem("between", twice[0], "no body at both ends, or twice at one")
    elif not known & {*ends}:
        yield element.problem("between", ends, "a body at one end at least")


def plan_problems(scene: Scene) -> Iterator[Problem]:
    """Directions of bodies, decks without their bodies, and what there is not in plan."""
    for i, body in enumerate(scene.bodies, 1):
        if body.direction not in DIRECTIONS:
            accepted = f"one of {', '.join(DIRECTIONS)}"
            yield Problem("body", i, body.name, "direction", body.direction, accepted)
    bodies = {body.name: body for body in scene.bodies}
    for i, deck in enumerate(scene.decks, 1):
        for word in DIRECTIONS:
            name = coordinate_of(deck.name, word)
            own = bodies.get(name)
            if own is None or own.direction != word or own.mass != deck.mass:
                accepted = f"{name} among the bodies, as Deck.bodies has it"
                yield Problem("deck", i, deck.name, "name", deck.name, accepted)
    if scene.in_plan and scene.supports:
        support = scene.supports[0].name
        yield Problem("support", 1, support, "name", support, "none in a scene in plan")
    second = not isinstance(scene.across, NoMotion)
    if second and all(body.direction != ACROSS for body in scene.bodies):
        accepted = "no second component where no body moves across: a scene with decks"
        yield Problem("excitation", 1, "", "across", scene.across.kind, accepted)


def _place_problems(end: PlanPoint, scene: Scene) -> Iterator[tuple[object, str]]:
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
