"""Quantities of decks in plan that a run keeps: how far they turn."""

from __future__ import annotations

from eventpound.numerics.arrays import Floats
from eventpound.quantities.runs import Runs
from eventpound.quantities.values import stands_apart
from eventpound.scene.plan_point import TURN, coordinate_of
from eventpound.scene.scene import Scene
from eventpound.solvers.base import Extremes
from eventpound.tolerances import TURNED


def on_a_line(scene: Scene, _i: int) -> bool:
    """Whether nothing moves across the line of the ground motion."""
    return not scene.in_plan


def in_plan(scene: Scene, _i: int) -> bool:
    """Whether something does."""
    return scene.in_plan


def translates(scene: Scene, i: int) -> bool:
    """Whether what body i does is no turn of a deck: of that `rotation_of` tells."""
    return scene.bodies[i].direction != TURN


def translates_in_plan(scene: Scene, i: int) -> bool:
    """Whether it is no turn, in a scene in plan."""
    return scene.in_plan and translates(scene, i)


def stands_apart_in_plan(scene: Scene, i: int) -> bool:
    """Whether structure i has a base shear of its own, across too."""
    return scene.in_plan and stands_apart(scene, i)


def rotation_of(many: Runs, i: int) -> Extremes:
    """Rotation of deck i (rad), from the displacement that stands for it."""
    deck = many.scene.decks[i]
    b = [body.name for body in many.scene.bodies].index(coordinate_of(deck.name, TURN))
    u, r = many.displacement.at((slice(None), slice(b, b + 1))), deck.radius
    return Extremes(u.maximum / r, u.time_of_maximum, u.minimum / r, u.time_of_minimum)


def residual_rotation(many: Runs, i: int) -> Floats:
    """Rotation of deck i when the run ends (rad), shape (n,)."""
    deck = many.scene.decks[i]
    b = [body.name for body in many.scene.bodies].index(coordinate_of(deck.name, TURN))
    last: Floats = many.u[:, b] / deck.radius
    return last


def turned_far(many: Runs) -> list[str]:
    """Sentences on decks that have turned further than is small."""
    found = []
    for i, deck in enumerate(many.scene.decks):
        x = rotation_of(many, i)
        most = float(max(x.maximum.max(), -x.minimum.min()))
        if most > TURNED:
            found.append(
                f"deck {deck.name!r} turns by {most:.3g} rad, more than {TURNED}: places and "
                "directions are those at rest, and are no longer small parts off"
            )
    return found
