"""Which of many variants of a scene may be wrong, by whole columns.

The conditions are those of `eventpound.scene.check`, without its allowance for
rounding: a variant that is not in doubt has no problems, one that is has to be
looked at by itself.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from eventpound.numerics.arrays import Bools, Floats
from eventpound.scene.contact import BARRIER
from eventpound.scene.parameters import Place, value_at
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, BoucWen

_POSITIVE = ("mass", "yield_displacement")
_NOT_NEGATIVE = ("stiffness", "strength", "compression", "extension", "coefficient", "delay")


def doubtful(scene: Scene, values: Mapping[Place, Floats], count: int) -> Bools:
    """Variants that may have a problem.

    Parameters
    ----------
    scene : Scene
        A checked scene.
    values : mapping
        Columns of finite numbers, each of shape (count,).
    count : int
        Number of variants.

    Returns
    -------
    ndarray of bool, shape (count,)
        True where one has to look; ground motions check themselves.
    """
    doubt = np.zeros(count, np.bool_)
    for place, column in values.items():
        doubt |= ~_in_range(place.field, column)
        # What a law accepts hangs together; such variants are looked at one by one.
        doubt |= place.kind == "contact" and scene.contacts[place.index].law is not None

    def column_of(place: Place) -> Floats:
        return values[place] if place in values else np.asarray(value_at(scene, place), float)

    springs = {p.index for p in values if p.kind == "spring"}
    for i in sorted(springs):
        if isinstance(scene.springs[i].law, BoucWen):
            doubt |= _beyond_bound(i, column_of)
    if any(p.field in ("gap", "displacement") for p in values):
        for i, contact in enumerate(scene.contacts):
            opening = column_of(Place("contact", i, "gap"))
            # The right end first: its sum with the gap is the rounding of the scene's own check.
            for end, weight in contact.direction[::-1]:
                if end not in (BARRIER, GROUND):
                    body = next(j for j, b in enumerate(scene.bodies) if b.name == end)
                    opening = opening + weight * column_of(Place("body", body, "displacement"))
            doubt |= ~(opening >= 0.0)
    return doubt


def _in_range(field: str, column: Floats) -> Bools:
    """Where a number by itself is accepted."""
    if field in _POSITIVE:
        return column > 0.0
    if field in _NOT_NEGATIVE:
        return column >= 0.0
    if field == "exponent":
        return column >= 1.0
    if field == "restitution":
        return (column >= 0.0) & (column <= 1.0)
    return np.isfinite(column)


def _beyond_bound(i: int, column_of: Callable[[Place], Floats]) -> Bools:
    """Where a Bouc-Wen spring has no bound, or starts at it or beyond."""
    total = column_of(Place("spring", i, "beta")) + column_of(Place("spring", i, "gamma"))
    exponent = column_of(Place("spring", i, "exponent"))
    start = np.abs(column_of(Place("spring", i, "initial_z")))
    tiny = np.finfo(float).tiny
    with np.errstate(all="ignore"):
        # Less by more than the rounding of the power.
        bound = np.maximum(total, tiny) ** (-1.0 / exponent) * (1.0 - 1e-12)
    return np.asarray((total < tiny) | ~(start <= bound))
