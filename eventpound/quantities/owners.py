"""Parts of a scene that quantities are of, by the names that stand in those of quantities."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from eventpound.scene.deck import CORNERS
from eventpound.scene.parameters import number_places
from eventpound.scene.scene import Scene
from eventpound.scene.structures import structure_names


def owners_of(scene: Scene, kind: str) -> Sequence[str]:
    """Names of the parts of a scene that are of a kind; one without a name for the run."""
    parts = {
        "body": scene.bodies,
        "spring": scene.springs,
        "contact": scene.contacts,
        "seat": scene.seats,
        "deck": scene.decks,
    }
    named: Sequence[Any] | None = (parts | {"support": scene.supports}).get(kind)
    if named is not None:
        return [part.name for part in named]
    if kind == "corner":
        return [f"{deck.name}.{corner}" for deck in scene.decks for corner in CORNERS]
    if kind == "dashpot":
        return _dashpots(scene)
    return structure_names(scene) if kind == "structure" else [""]


def is_told(scene: Scene, kind: str, i: int) -> bool:
    """Whether tables tell of it: a coupling of a frame means nothing, but as a storey."""
    spring = scene.springs[i] if kind == "spring" else None
    return spring is None or spring.frame is None or spring.height is not None


def _dashpots(scene: Scene) -> list[str]:
    """Names of dashpots as the keys of their numbers have them, ``ground-deck``."""
    keys = [key for key, place in number_places(scene).items() if place.kind == "dashpot"]
    return [key.removeprefix("dashpot.").removesuffix(".coefficient") for key in keys]
