"""The numbers of a scene by dotted keys, as a case names them, and scenes with other ones.

body.<name>.mass, .displacement, .velocity
spring.<name>.<number of its law>; of a series spring .parts.<1, 2, ...>.<number>; .weight
dashpot.<first>-<second>.coefficient; .2 ahead of the last dot for the second of a pair
contact.<name>.gap, .restitution, .friction of one with some; with a law .stiffness, .damping
support.<name>.delay, of one that has a delay
excitation.<number of the motion>: amplitude, period, start, scale, ...; in plan .attack
excitation.across.<number>: of the second component; the factor on a record is one for both
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, is_dataclass, replace
from typing import Any, get_args

import numpy as np

from eventpound.basics.given import numbers_of
from eventpound.motion.base import GroundMotion
from eventpound.motion.mavroeidis_papageorgiou import MavroeidisPapageorgiou
from eventpound.motion.pulses import TypeC
from eventpound.motion.record import Record
from eventpound.motion.ricker import Ricker
from eventpound.numerics.arrays import Floats
from eventpound.numerics.distinct import distinct
from eventpound.scene.body import Body
from eventpound.scene.contact import Contact
from eventpound.scene.contact_law import ContactLaw
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.scene import Scene
from eventpound.scene.spring import Law, Series, Spring
from eventpound.scene.support import Support
from eventpound.units import Dimension

WEIGHT = "weight"
"""The number of a spring that does not stand in its law."""
OF_CONTACT_LAWS = ("stiffness", "damping")
"""Numbers of a contact that stand in its law."""

_MADE: Mapping[str, tuple[type, ...]] = {
    "body": (Body,),
    "spring": (Spring, *get_args(Law)),
    "dashpot": (Dashpot,),
    "contact": (Contact, ContactLaw),
    "support": (Support,),
    "excitation": (Record, TypeC, MavroeidisPapageorgiou, Ricker),
}
_DIMENSIONS = {
    (kind, name): dimension
    for kind, classes in _MADE.items()
    for made in classes
    for name, dimension in numbers_of(made).items()
} | {("excitation", "attack"): Dimension.ANGLE}


def dimension_of_number(key: str) -> Dimension | None:
    """Dimension of a number by its dotted key, of whatever scene; None where there is none."""
    kind, _, rest = key.partition(".")
    return _DIMENSIONS.get((kind, rest.rpartition(".")[2]))


@dataclass(frozen=True, slots=True)
class Place:
    """Where a number stands in a scene.

    Parameters
    ----------
    kind : str
        ``"body"``, ``"spring"``, ``"dashpot"``, ``"contact"``, ``"support"``,
        ``"excitation"``, ``"across"`` or, of the scene itself, ``"plan"``.
    index : int
        Position among its kind, from 0.
    field : str
        Name of the number.
    part : int
        Part of a series spring, from 0; -1 elsewhere.
    """

    kind: str
    index: int
    field: str
    part: int = -1


def number_places(scene: Scene) -> dict[str, Place]:
    """Every number of a scene, by its key.

    Parameters
    ----------
    scene : Scene
        A checked scene.
    """
    places: dict[str, Place] = {}

    def add(key: str, kind: str, index: int, owner: object, part: int = -1) -> None:
        for name in numbers_of(type(owner)) if is_dataclass(owner) else ():
            # Without friction a contact has none along which it could slide.
            if name != "friction" or getattr(owner, name):
                places[f"{key}.{name}"] = Place(kind, index, name, part)

    for i, body in enumerate(scene.bodies):
        add(f"body.{body.name}", "body", i, body)
    for i, spring in enumerate(scene.springs):
        key = f"spring.{spring.name}"
        add(key, "spring", i, spring.law)
        if spring.weight is not None:
            places[f"{key}.{WEIGHT}"] = Place("spring", i, WEIGHT)
        if isinstance(spring.law, Series):
            for number, part in enumerate(spring.law.parts):
                add(f"{key}.parts.{number + 1}", "spring", i, part, number)
    labels = [dashpot.label for dashpot in scene.dashpots]
    for i, dashpot in enumerate(scene.dashpots):
        earlier = labels[:i].count(dashpot.label)
        which = f".{earlier + 1}" if earlier else ""
        add(f"dashpot.{dashpot.label}{which}", "dashpot", i, dashpot)
    for i, contact in enumerate(scene.contacts):
        add(f"contact.{contact.name}", "contact", i, contact)
        add(f"contact.{contact.name}", "contact", i, contact.law)
    for i, support in enumerate(scene.supports):
        if support.delay is not None:
            add(f"support.{support.name}", "support", i, support)
    add("excitation", "excitation", 0, scene.motion)
    if scene.in_plan:
        places["excitation.attack"] = Place("plan", 0, "attack")
        add("excitation.across", "across", 0, scene.across)
    return places


def value_at(scene: Scene, place: Place) -> Any:
    """The number at a place."""
    if place.kind in _ALONE:
        return getattr(_ALONE[place.kind](scene), place.field)
    owner: Any = getattr(scene, _COLLECTION[place.kind])[place.index]
    if place.kind == "spring" and place.field != WEIGHT:
        owner = owner.law if place.part < 0 else owner.law.parts[place.part]
    elif place.kind == "contact" and place.field in OF_CONTACT_LAWS:
        owner = owner.law
    return getattr(owner, place.field)


_ALONE: Mapping[str, Callable[[Scene], Any]] = {
    "excitation": lambda scene: scene.motion,
    "across": lambda scene: scene.across,
    "plan": lambda scene: scene,
}
"""What has numbers and is one in a scene."""
_COLLECTION = {
    "body": "bodies",
    "spring": "springs",
    "dashpot": "dashpots",
    "contact": "contacts",
    "support": "supports",
}


def with_values(scene: Scene, values: Mapping[Place, float]) -> Scene:
    """The scene with other numbers.

    Parameters
    ----------
    scene : Scene
        Stays as it is.
    values : mapping
        New numbers (SI).

    Raises
    ------
    InputError
        Where a ground motion refuses its numbers; nothing else is checked.
    """
    changes: dict[str, Any] = {}
    for place, value in values.items():
        if place.kind == "plan":
            changes[place.field] = float(value)
        if place.kind in _ALONE:
            continue
        collection = _COLLECTION[place.kind]
        owners = changes.setdefault(collection, list(getattr(scene, collection)))
        owners[place.index] = _changed(owners[place.index], place, float(value))
    motion = motion_with(scene.motion, values)
    if scene.in_plan:
        changes["across"] = _across_with(scene, motion, values)
    return replace(scene, motion=motion, **changes)


def _across_with(scene: Scene, motion: GroundMotion, values: Mapping[Place, float]) -> GroundMotion:
    """The second component beside the first as it has become; of records the factors keep pace."""
    own, before = scene.across, scene.motion
    if isinstance(own, Record) and isinstance(before, Record) and isinstance(motion, Record):
        ratio = motion.factor / before.factor
        if ratio != 1.0:
            sized: dict[str, Any] = {"scale": abs(own.factor * ratio), "pga": None, "psa": None}
            own = own.like(**sized)
    return motion_with(own, values, "across")


def told_of_variants(
    scene: Scene, values: Mapping[Place, Floats], count: int, tell: Callable[[Scene], float]
) -> Floats:
    """What is told of each variant of a scene, once of those with the same numbers, (count,)."""
    first, which = distinct(list(values.values()), count)
    at = ({place: float(column[i]) for place, column in values.items()} for i in first.tolist())
    return np.array([tell(with_values(scene, each)) for each in at])[which]


def motion_with(
    motion: GroundMotion, values: Mapping[Place, float], kind: str = "excitation"
) -> GroundMotion:
    """The motion with other numbers; what is no number of it is passed over.

    Raises
    ------
    InputError
        Where the motion refuses them.
    """
    changes: dict[str, Any] = {
        place.field: float(value) for place, value in values.items() if place.kind == kind
    }
    if not changes:
        return motion
    if isinstance(motion, Record):
        return motion.like(**changes)
    changed: GroundMotion = replace(motion, **changes)  # type: ignore[type-var]
    return changed


def _changed(owner: Any, place: Place, value: float) -> Any:
    if place.kind == "contact" and place.field in OF_CONTACT_LAWS:
        return replace(owner, law=replace(owner.law, **{place.field: value}))
    if place.kind != "spring" or place.field == WEIGHT:
        return replace(owner, **{place.field: value})
    if place.part < 0:
        return replace(owner, law=replace(owner.law, **{place.field: value}))
    parts = list(owner.law.parts)
    parts[place.part] = replace(parts[place.part], **{place.field: value})
    return replace(owner, law=replace(owner.law, parts=tuple(parts)))
