"""``[[building]]``: storeys of a frame, written out as bodies, springs and damping.

    body            NAME1, NAME2, ... from the bottom
    spring          storey-NAME1, ... between what it stands on or the floor below and the floor
    [[rayleigh]]    C = a M + b K with one ratio at two of its modes, or
    [[modal_damping]]  a ratio in each mode

A value is one for all storeys or a list, the lowest first. A yield force ``"0.15 W"`` is a part
of the weight that its storey carries.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Sequence
from itertools import accumulate
from typing import NamedTuple

from eventpound.case.table import Table
from eventpound.errors import InputError
from eventpound.scene.spring import GROUND
from eventpound.units import STANDARD_GRAVITY, Dimension, quantity

MOST_STOREYS = 500
RAYLEIGH, MODAL = "rayleigh", "modal"
"""How the damping ratio of a building or a frame is meant."""
_WEIGHT = re.compile(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*W\s*")


class Levels(NamedTuple):
    """What a structure stands on, its floors from below, and how high each is (m), if known."""

    base: str
    floors: tuple[str, ...]
    heights: tuple[float, ...]


def weight_share(value: object) -> float | None:
    """The part of a weight that a value like ``"0.15 W"`` says; None of any other value."""
    match = _WEIGHT.fullmatch(value) if isinstance(value, str) else None
    return None if match is None else float(match[1])


def building_tables(
    table: Table, supports: Collection[str]
) -> tuple[dict[str, list[object]], Levels | None]:
    """Bodies, springs and damping of one building, and its levels; none where it has problems.

    Parameters
    ----------
    table : Table
        The building; problems are noted.
    supports : collection of str
        Names of the supports of the case.
    """
    name = table.text("name", "a name for the building")
    on = table.text("on", "what it stands on: a body or a support", GROUND)
    storeys = table.whole_number("storeys", 1, MOST_STOREYS)
    if storeys is None:
        return {}, None
    masses = _values(table, "mass", Dimension.MASS, storeys)
    weights = [STANDARD_GRAVITY * sum(masses[i:]) for i in range(storeys)]
    stiffnesses = _values(table, "stiffness", Dimension.STIFFNESS, storeys)
    heights, forces = list[float](), list[float]()
    if table.has("height"):
        heights = _values(table, "height", Dimension.LENGTH, storeys)
    carried = list[float]()
    if table.has("weight"):
        carried = _values(table, "weight", Dimension.FORCE, storeys, weights)
        if not heights:
            table.report_missing("height", "the heights of the storeys (m), beside their weights")
    if table.has("yield_force"):
        forces = _values(table, "yield_force", Dimension.FORCE, storeys, weights)
    hardening = table.quantity("hardening", Dimension.NUMBER, 0.05) if forces else None
    ends = [on, *(f"{name}{i}" for i in range(1, storeys + 1))]
    capacity = {"capacity": table.data["capacity"]} if table.has("capacity") else {}
    springs: list[object] = []
    for i, k in enumerate(stiffnesses):
        spring: dict[str, object] = {"between": ends[i : i + 2], "name": f"storey-{ends[i + 1]}"}
        if forces:
            spring |= {"law": "bouc-wen", "initial_stiffness": k, "yield_force": forces[i]}
            spring["hardening"] = hardening
        else:
            spring |= {"law": "linear", "stiffness": k}
        spring |= ({"height": heights[i]} if heights else {}) | capacity
        springs.append(spring | ({"weight": carried[i]} if carried else {}))
    bodies: list[object] = [
        {"name": end, "mass": mass} for end, mass in zip(ends[1:], masses, strict=True)
    ]
    damping = damping_tables(table, ends[1:], on, on in supports)
    table.close()
    levels = Levels(on, tuple(ends[1:]), tuple(accumulate(heights)))
    return {"body": bodies, "spring": springs, **damping}, levels


def damping_tables(
    table: Table, bodies: Sequence[str], on: str, on_support: bool
) -> dict[str, list[object]]:
    """``[[rayleigh]]`` or ``[[modal_damping]]`` of bodies that stand on the ground, or elsewhere.

    On a body, such as a slab on isolators, Rayleigh damping would damp what that moves by.
    """
    isolated = on != GROUND and not on_support
    words = (MODAL,) if isolated else (RAYLEIGH, MODAL)
    word = table.choice("damping", words) if table.has("damping") else words[0]
    if not table.has("ratio"):
        for key in ("damping", "modes"):
            if table.has(key):
                table.report_missing("ratio", "the ratio of its damping")
                break
        return {}
    found: dict[str, object] = {"bodies": [*bodies], "ratio": table.data["ratio"]}
    if word == MODAL:
        if table.has("modes"):
            table.reject("modes", 'none beside damping = "modal": its ratio holds in every mode')
        return {"modal_damping": [found | ({} if on == GROUND else {"base": on})]}
    found["modes"] = table.data["modes"] if table.has("modes") else [1, min(2, len(bodies))]
    return {"rayleigh": [found | ({"support": on} if on_support else {})]}


def _values(
    table: Table,
    key: str,
    dimension: Dimension,
    count: int,
    weights: Sequence[float] | None = None,
) -> list[float]:
    """A value for each storey, given as one or as a list; NaN where they are wrong."""
    if not table.has(key):
        table.report_missing(key, f"{dimension.accepted}; or a list of {count}")
        return [math.nan] * count
    given = table.data[key]
    listed = given if isinstance(given, list) else [given] * count
    if len(listed) != count:
        table.reject(key, f"one value, or a list of {count}, one a storey from the bottom")
        return [math.nan] * count
    found = []
    for i, value in enumerate(listed):
        share = None if weights is None else weight_share(value)
        try:
            weight = 0.0 if weights is None else weights[i]
            number = quantity(value, dimension) if share is None else share * weight
        except InputError as error:
            table.report(key, str(error))
            return [math.nan] * count
        if number <= 0.0:
            table.reject(key, "positive values")
            return [math.nan] * count
        found.append(number)
    return found
