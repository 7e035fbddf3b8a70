"""What the files of a problem hold besides where it has decks in plan, and friction.

Two components of the ground motion with what they push (``iota``, ``motion_across``), the shape
of the decks, where springs and contacts are, and of friction ``W_T`` and ``frictions``. A problem
on a line has nothing of it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from eventpound.mechanics.supported import influence
from eventpound.results.export import conventions_added
from eventpound.scene.deck import CORNERS, Deck
from eventpound.scene.ends import End
from eventpound.scene.plan_point import PlanPoint
from eventpound.scene.scene import Scene

OF_DECKS = "name", "mass", "length", "width", "skew", "centre", "radius"
"""Numbers of a deck; the skew in rad, its radius of gyration r."""
_AT_CORNER = 1e-9
"""Part of the length of a deck by which a place may be off its corner."""


def plan_conventions(scene: Scene) -> dict[str, str]:
    """What equations and files say in plan, and of friction; nothing of a scene on a line."""
    added, found = conventions_added(scene), dict[str, str]()
    if "in plan" in added:
        across = "; motion_across is a_across, told as motion is; W and B hold weights"
        found["plan"] = added["in plan"] + across
        found["places"] = "x and y from the centre of a deck, then the direction that counts"
    return found | {key: said for key, said in added.items() if key == "friction"}


def plan_numbers(scene: Scene) -> dict[str, object]:
    """What pushes bodies, decks, and the places of springs and contacts in words."""
    if not scene.in_plan:
        return {}
    return {
        "iota": [[part + 0.0 for part in influence(scene, b.direction)] for b in scene.bodies],
        "decks": [{key: getattr(deck, key) for key in OF_DECKS} for deck in scene.decks],
        "places": {
            "springs": [_places(scene, *spring.between) for spring in scene.springs],
            "contacts": [_places(scene, c.left, c.right) for c in scene.contacts],
        },
    }


def _places(scene: Scene, *ends: End) -> list[str]:
    return [_words(scene, end) for end in ends]


def _words(scene: Scene, end: End) -> str:
    if not isinstance(end, PlanPoint):
        return str(end)
    (x, y), (n_x, n_y) = end.at, end.normal
    deck = next(deck for deck in scene.decks if deck.name == end.deck)
    corner = _corner(deck, end.at)
    place = f"{corner} corner of {deck.name}" if corner else deck.name
    return f"{place} at ({x:.6g}, {y:.6g}) toward ({n_x:.6g}, {n_y:.6g})"


def _corner(deck: Deck, at: tuple[float, float]) -> str:
    """The corner of a deck at a place; empty where there is none."""
    off = np.abs(np.subtract(deck.corners, at)).max(axis=1)
    return CORNERS[int(off.argmin())] if off.min() <= _AT_CORNER * deck.length else ""


def plan_rows(content: Mapping[str, Any]) -> Iterator[str | list[float]]:
    """Further lines of ``problem.txt``, each section behind its word.

    ``plan``: iota, a line a body; ``friction``: a line a contact, its coefficient and its column
    of W_T.
    """
    if "iota" in content:
        yield "plan"
        yield from content["iota"]
    if "W_T" in content:
        yield "friction"
        columns = np.asarray(content["W_T"]).T
        for mu, column in zip(content["frictions"], columns, strict=True):
            yield [mu, *column]
