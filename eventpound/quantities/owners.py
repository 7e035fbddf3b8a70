"""Parts of a scene that quantities are of, by the names that stand in those of quantities."""

from __future__ import annotations

from collections.abc import Sequence

from eventpound.scene.parameters import places_of
from eventpound.scene.scene import Scene
from eventpound.scene.structures import structures_of


def owners(scene: Scene, kind: str) -> Sequence[str]:
    """Names of the parts of a scene that are of a kind; one without a name for the run."""
    match kind:
        case "body":
            return [body.name for body in scene.bodies]
        case "spring":
            return [spring.name for spring in scene.springs]
        case "contact":
            return [contact.name for contact in scene.contacts]
        case "dashpot":
            return _dashpots(scene)
        case "structure":
            return [group[0] for group in structures_of(scene)]
        case "support":
            return [support.name for support in scene.supports]
    return [""]


def _dashpots(scene: Scene) -> list[str]:
    """Names of dashpots as the keys of their numbers have them, ``ground-deck``."""
    keys = [key for key, place in places_of(scene).items() if place.kind == "dashpot"]
    return [key.removeprefix("dashpot.").removesuffix(".coefficient") for key in keys]
