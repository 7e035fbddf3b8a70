"""Numbers of a scene in its arrays: which entry each of them is.

The arrays have a leading axis of variants. A spring in series and a sum of dashpots are made
anew for every value that they have, and so is all of a scene with a spring whose law is more than
Bouc-Wen's: the start of its memory follows from several numbers, those of bodies among them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from eventpound.mechanics.coordinates import numbered
from eventpound.mechanics.link_law import CONSTANTS, LinkLaw
from eventpound.mechanics.model import Model, assemble, with_sliders
from eventpound.numerics.arrays import Floats
from eventpound.scene.elastic_laws import ElasticLaws, reduced
from eventpound.scene.parameters import WEIGHT, Place, with_values
from eventpound.scene.scene import Scene
from eventpound.scene.spring import BoucWen, Linear, Series

OF_CONTACTS = ("gap", "restitution")
OF_MODEL = ("mass", "u0", "v0", "z0", *OF_CONTACTS)
"""Fields of a `Model` that are numbers of its scene, beside those of its laws."""


def numbers_of(model: Model) -> dict[str, Floats]:
    """Arrays of a model that hold numbers of its scene, by their names; `OF_CONTACTS` at last."""
    own = {key: getattr(model, key) for key in OF_MODEL}
    contacts = {key: own.pop(key) for key in OF_CONTACTS}
    return own | model.elastic._asdict() | model.law._asdict() | contacts


def with_numbers(model: Model, numbers: Mapping[str, Floats]) -> Model:
    """The model with such arrays in the place of its own."""
    own: dict[str, Any] = {key: numbers[key] for key in OF_MODEL}
    own["law"] = LinkLaw(*(numbers[key] for key in LinkLaw._fields))
    own["elastic"] = ElasticLaws(*(numbers[key] for key in ElasticLaws._fields))
    return replace(model, **own)


def put_numbers(
    scene: Scene, model: Model, values: Mapping[Place, Floats], rows: Mapping[str, Floats]
) -> None:
    """Put numbers of variants into arrays.

    Parameters
    ----------
    scene : Scene
        What the variants have in common.
    model : Model
        It, assembled.
    values : mapping of Place to ndarray, shape (n,)
        What differs; numbers of the motion are passed over.
    rows : mapping of str to ndarray, shape (n, ...)
        Those of `numbers_of`, with a leading axis.
    """
    if scene.branched_springs:
        _put_all(scene, values, rows)
        return
    for place, given in values.items():
        column = _softened(scene, place, given, values)
        for key in _keys(place):
            index = place.index
            if key == "z0":
                index = int(np.flatnonzero(model.hysteretic == index)[0])
            if key in CONSTANTS:
                rows["memory"][:, index, CONSTANTS.index(key)] = column
            else:
                rows[key][:, index] = column
    for key in ("u0", "v0"):
        rows[key][:] = model.with_points(rows[key])
    _put_series(scene, values, rows)
    _put_dashpots(scene, values, rows)


def _softened(scene: Scene, place: Place, column: Floats, values: Mapping[Place, Floats]) -> Floats:
    """Numbers as the arrays have them: of the stiffness of a storey with P-Delta what acts."""
    spring = scene.springs[place.index] if place.kind == "spring" else None
    if spring is None or spring.weight is None or place.field not in ("stiffness", WEIGHT):
        return column
    assert isinstance(spring.law, Linear | BoucWen)
    k = values.get(replace(place, field="stiffness"), spring.law.stiffness)
    weight = values.get(replace(place, field=WEIGHT), spring.weight)
    return np.asarray(k - weight / (spring.height or math.nan))


def _keys(place: Place) -> tuple[str, ...]:
    """Arrays that hold a number of the scene as it is."""
    match place.kind:
        case "body":
            return ({"displacement": "u0", "velocity": "v0"}.get(place.field, place.field),)
        case "contact":
            return (place.field,)
        case "spring" if place.part < 0:
            if place.field in ("stiffness", WEIGHT):
                return ("compression", "extension")
            return ("z0" if place.field == "initial_z" else place.field,)
    return ()


def _put_all(scene: Scene, values: Mapping[Place, Floats], rows: Mapping[str, Floats]) -> None:
    """All numbers of scenes, variant by variant."""
    own = {place: column for place, column in values.items() if place.kind != "excitation"}
    for i in range(rows["mass"].shape[0] if own else 0):
        variant = with_values(scene, {place: float(column[i]) for place, column in own.items()})
        for key, array in numbers_of(with_sliders(assemble(variant))).items():
            rows[key][i] = array


def _put_series(scene: Scene, values: Mapping[Place, Floats], rows: Mapping[str, Floats]) -> None:
    """Springs in series reduced anew, variant by variant."""
    for s in {place.index for place in values if place.part >= 0}:
        law = scene.springs[s].law
        assert isinstance(law, Series)
        own = {
            (p.part, p.field): column
            for p, column in values.items()
            if p.kind == "spring" and p.index == s
        }
        for i in range(rows["offset"].shape[0]):
            parts: list[Any] = list(law.parts)
            for (part, field), column in own.items():
                parts[part] = replace(parts[part], **{field: float(column[i])})
            whole = reduced(Series(tuple(parts)))
            for key in ElasticLaws._fields:
                rows[key][i, s] = getattr(whole, key)


def _put_dashpots(scene: Scene, values: Mapping[Place, Floats], rows: Mapping[str, Floats]) -> None:
    """Dampings of the links, summed in the order of `assemble`."""
    changed = {place.index: column for place, column in values.items() if place.kind == "dashpot"}
    if not changed:
        return
    links = numbered(scene).of_dashpot
    for link in {links[d] for d in changed}:
        rows["damping"][:, link] = 0.0
        for d, dashpot in enumerate(scene.dashpots):
            if links[d] == link:
                rows["damping"][:, link] += changed.get(d, dashpot.coefficient)
