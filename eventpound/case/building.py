"""``[[building]]``: storeys of a frame, written out as bodies, springs and damping.

    body            NAME1, NAME2, ... from the bottom
    spring          storey-NAME1, ... between the ground or the floor below and the floor
    [[rayleigh]]    C = a M + b K with one ratio at two of its modes, or
    [[modal_damping]]  a ratio in each mode

A value is one for all storeys or a list, the lowest first. A yield force ``"0.15 W"`` is a part
of the weight that its storey carries.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from eventpound.case.table import CaseProblem, Table
from eventpound.errors import InputError
from eventpound.scene.spring import GROUND
from eventpound.units import STANDARD_GRAVITY, Dimension, quantity

MOST_STOREYS = 500
_WEIGHT = re.compile(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*W\s*")


def weight_share(value: object) -> float | None:
    """The part of a weight that a value like ``"0.15 W"`` says; None of any other value."""
    match = _WEIGHT.fullmatch(value) if isinstance(value, str) else None
    return None if match is None else float(match[1])


def with_buildings(document: Mapping[str, object], file: Path) -> Mapping[str, object]:
    """Tables of a case, with its buildings written out.

    Parameters
    ----------
    document : mapping
        As tomllib gives it.
    file : Path
        For messages.

    Raises
    ------
    InputError
        With one line for every problem of a building.
    """
    problems: list[CaseProblem] = []
    top = Table(document, "", problems)
    if not top.has("building"):
        return document
    kinds = ("body", "spring", "rayleigh", "modal_damping")
    parts: dict[str, list[object]] = {kind: [] for kind in kinds}
    for table in top.tables("building"):
        for kind, tables in _expanded(table).items():
            parts[kind] += tables
    if problems:
        raise InputError([f"{file}: {problem}" for problem in problems])
    whole = {key: value for key, value in document.items() if key != "building"}
    for kind, tables in parts.items():
        given = whole.get(kind, [])
        # What is no list is refused where it is read.
        if tables and isinstance(given, list):
            whole[kind] = [*given, *tables]
    return whole


def _expanded(table: Table) -> dict[str, list[object]]:
    """Bodies, springs and damping of one building; empty where it has problems."""
    name = table.text("name", "a name for the building")
    storeys = table.whole_number("storeys", 1, MOST_STOREYS)
    if storeys is None:
        return {}
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
    ends = [GROUND, *(f"{name}{i}" for i in range(1, storeys + 1))]
    springs: list[object] = []
    for i, k in enumerate(stiffnesses):
        spring: dict[str, object] = {"between": ends[i : i + 2], "name": f"storey-{ends[i + 1]}"}
        if forces:
            spring |= {"law": "bouc-wen", "initial_stiffness": k, "yield_force": forces[i]}
            spring["hardening"] = hardening
        else:
            spring |= {"law": "linear", "stiffness": k}
        spring |= {"height": heights[i]} if heights else {}
        springs.append(spring | ({"weight": carried[i]} if carried else {}))
    bodies: list[object] = [
        {"name": end, "mass": mass} for end, mass in zip(ends[1:], masses, strict=True)
    ]
    found: dict[str, list[object]] = {"body": bodies, "spring": springs}
    modal = table.has("damping") and table.choice("damping", ("rayleigh", "modal")) == "modal"
    if table.has("ratio"):
        damping: dict[str, object] = {"bodies": ends[1:], "ratio": table.data["ratio"]}
        if modal and table.has("modes"):
            table.reject("modes", 'none beside damping = "modal": its ratio holds in every mode')
        elif not modal:
            damping["modes"] = table.data["modes"] if table.has("modes") else [1, min(2, storeys)]
        found["modal_damping" if modal else "rayleigh"] = [damping]
    elif table.has("damping"):
        table.report_missing("ratio", "the ratio of its damping")
    table.close()
    return found


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
