"""Buildings, frames and joints of a case, written out as bodies, springs, dashpots and contacts.

``[[building]]``: storeys of a frame, written out as bodies, springs and damping.

    body            NAME1, NAME2, ... from the bottom
    spring          storey-NAME1, ... between what it stands on or the floor below and the floor
    [[rayleigh]]    C = a M + b K with one ratio at two of its modes, or
    [[modal_damping]]  a ratio in each mode

A value is one for all storeys or a list, the lowest first. A yield force ``"0.15 W"`` is a part
of the weight that its storey carries.

``[[frame]]``: a condensed frame of another program, written out as bodies, springs and damping.

    body            one a degree of freedom, by the names of the file, or NAME1, NAME2, ...
    spring          the couplings, marked by the frame's name (`eventpound.scene.frame`)
    dashpot         of a damping matrix; or [[rayleigh]] or [[modal_damping]] of a ratio

Numbers without a unit, in files and lists, are in SI, or in the ``units`` of the table.

A ``[[contact]]`` with ``between_buildings = ["A", "B"]`` stands for one at each floor of either
that is no higher than the other: floor against floor where both have one at that height, else
against the columns of the other, at a point between its floors by the heights.
"""

from __future__ import annotations

import math
import re
from bisect import bisect_left
from collections.abc import Collection, Mapping, Sequence
from itertools import accumulate
from pathlib import Path
from typing import NamedTuple

import numpy as np

from eventpound.basics.matrix_file import NamedMatrix, read_matrix
from eventpound.case.record_file import find_record
from eventpound.case.table import CaseProblem, Table
from eventpound.case.understood import parts_written
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.scene.frame import frame
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
        {"name": end, "mass": mass, "structure": name}
        for end, mass in zip(ends[1:], masses, strict=True)
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
    table: Table, key: str, dimension: Dimension, count: int, weights: Sequence[float] | None = None
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


_DIMENSIONS = {
    "stiffness": Dimension.STIFFNESS,
    "mass": Dimension.MASS,
    "damping": Dimension.DAMPING,
}
_MATRIX = "a file (.csv, .npy, .mtx), or a list of rows"


def frame_tables(
    table: Table, directory: Path, supports: Collection[str]
) -> tuple[dict[str, list[object]], Levels | None]:
    """Bodies, springs and damping of one ``[[frame]]``, and its levels; none of one with problems.

    Parameters
    ----------
    table : Table
        The frame; problems are noted.
    directory : Path
        Of the case, to which files are relative.
    supports : collection of str
        Names of the supports of the case.
    """
    name = table.text("name", "a name for the frame")
    on = table.text("on", "what it stands on: a body or a support", GROUND)
    matrices = _matrices(table, directory)
    own = table.texts("names", "a list of names") if table.has("names") else ()
    names = own or (matrices["stiffness"].names if matrices else ())
    heights = _heights(table)
    parts = None
    if matrices:
        with table.noting(""):
            values = {key: _in_order(key, each, names) for key, each in matrices.items()}
            parts = frame(name, **values, names=names or None, levels=heights or None, on=on)
    bodies = [body.name for body in parts.bodies] if parts else []
    damping = dict[str, list[object]]()
    if not _is_matrix(table):
        damping = damping_tables(table, bodies, on, on in supports)
    for key in ("ratio", "modes"):
        if table.has(key) and _is_matrix(table):
            table.reject(key, "none beside a damping matrix")
    table.close()
    if parts is None:
        return {}, None
    return {**parts_written(*parts), **damping}, Levels(on, tuple(bodies), heights)


def _matrices(table: Table, directory: Path) -> dict[str, NamedMatrix]:
    """Matrices by their keys; empty with problems noted where one is missing or wrong."""
    factors = _factors(table.table("units"))
    keys = [key for key in _DIMENSIONS if key != "damping" or _is_matrix(table)]
    read = {key: _read(table, key, directory, factors[key]) for key in keys}
    found = {key: each for key, each in read.items() if each is not None}
    return found if len(found) == len(keys) else {}


def _heights(table: Table) -> tuple[float, ...]:
    """Levels of the degrees of freedom (m), none where they are not given or wrong."""
    if not table.has("levels"):
        return ()
    given = table.data["levels"]
    with table.noting("levels"):
        listed = given if isinstance(given, list) else []
        found = [quantity(each, Dimension.LENGTH) for each in listed]
        if found:
            return tuple(found)
        table.reject("levels", "a list of heights above what it stands on (m)")
    return ()


def _is_matrix(table: Table) -> bool:
    """Whether damping is a matrix, and no word for how a ratio is meant."""
    return table.has("damping") and table.data["damping"] not in (RAYLEIGH, MODAL)


def _factors(table: Table) -> dict[str, float]:
    """Of the numbers in files, to SI."""
    found = dict.fromkeys(_DIMENSIONS, 1.0)
    for key, dimension in _DIMENSIONS.items():
        if table.has(key):
            accepted = f'a unit, such as "{dimension.unit}" or "kN/m", "t", "kN s/m"'
            unit = table.text(key, accepted)
            with table.noting(key):
                found[key] = quantity(f"1 {unit}", dimension) if unit else 1.0
    table.close()
    return found


def _read(table: Table, key: str, directory: Path, factor: float) -> NamedMatrix | None:
    """Numbers of a file or a list, in SI; None with a problem noted."""
    accepted = _MATRIX if key != "mass" else f"{_MATRIX} or of masses"
    if not table.has(key):
        table.report_missing(key, accepted)
        return None
    value = table.data[key]
    with table.noting(key):
        if isinstance(value, str):
            path = find_record(value, directory)
            values, names = read_matrix(path)
            return NamedMatrix(values * factor, names)
        if isinstance(value, list) and value:
            rows = value if all(isinstance(row, list) for row in value) else [value]
            numbers = [[_number(each, _DIMENSIONS[key], factor) for each in row] for row in rows]
            if len({len(row) for row in numbers}) == 1:
                return NamedMatrix(np.array(numbers), ())
        table.reject(key, accepted)
    return None


def _number(value: object, dimension: Dimension, factor: float) -> float:
    """In SI; a number without a unit of its own is in that of the table."""
    return quantity(value, dimension) * (1.0 if isinstance(value, str) else factor)


def _in_order(key: str, matrix: NamedMatrix, names: tuple[str, ...]) -> Floats:
    """Numbers in the order of names, of which a file may have another."""
    values, own = matrix
    if key == "mass" and 1 in values.shape:
        values = values.ravel()
    if not own or not names or own == names:
        return values
    if sorted(own) != sorted(names):
        raise InputError(
            f"{key}: found the names {', '.join(own[:8])}; accepted: {', '.join(names[:8])}"
        )
    order = [own.index(name) for name in names]
    return values[order] if values.ndim == 1 else values[np.ix_(order, order)]


BETWEEN, AT = "between_buildings", "at"
FLOORS, ROOF = "floors", "roof"
"""Where the contacts of a joint are: at all floors, or where the lower of two buildings ends."""
SAME_HEIGHT = 1e-3
"""Difference of two heights that are one (m)."""


def written_out(document: Mapping[str, object], file: Path) -> Mapping[str, object]:
    """Tables of a case, in the place of its buildings, frames and joints what they stand for.

    Parameters
    ----------
    document : mapping
        As tomllib gives it.
    file : Path
        For messages; files of frames are relative to its directory.

    Raises
    ------
    InputError
        With one line for every problem of a building, a frame or a joint.
    """
    problems: list[CaseProblem] = []
    top = Table(document, "", problems)
    given = [kind for kind in ("building", "frame") if top.has(kind)]
    joins = any(BETWEEN in table.data for table in Table(document, "", []).tables("contact"))
    if not (given or joins):
        return document
    names = (table.data.get("name") for table in Table(document, "", []).tables("support"))
    supports = [name for name in names if isinstance(name, str)]
    known: dict[str, Levels] = {}
    whole = {key: value for key, value in document.items() if key not in given}
    for kind in given:
        for table in top.tables(kind):
            if kind == "frame":
                parts, levels = frame_tables(table, file.parent, supports)
            else:
                parts, levels = building_tables(table, supports)
            known |= {str(table.data.get("name")): levels} if levels else {}
            for made, tables in parts.items():
                others = whole.get(made, [])
                # What is no list is refused where it is read.
                if tables and isinstance(others, list):
                    whole[made] = [*others, *tables]
    if joins and not problems:
        whole["contact"] = [
            made
            for table in top.tables("contact")
            for made in ([table.data] if BETWEEN not in table.data else _contacts(table, known))
        ]
    if problems:
        raise InputError([f"{file}: {problem}" for problem in problems])
    return whole


def _contacts(table: Table, known: Mapping[str, Levels]) -> list[dict[str, object]]:
    """Contacts of a joint; none with a problem noted."""
    high = [name for name, levels in known.items() if levels.heights]
    accepted = f"two buildings with heights, of {', '.join(high) or 'which there is none'}"
    first, second = table.pair(BETWEEN, accepted)
    word = table.choice(AT, (FLOORS, ROOF)) if table.has(AT) else FLOORS
    for key in filter(table.has, ("between", "name")):
        table.reject(key, f"none beside {BETWEEN}: it makes several contacts, each with its own")
    if not first:
        return []
    if first == second or not {first, second} <= {*high}:
        table.reject(BETWEEN, accepted)
        return []
    left, right = known[first], known[second]
    top = min(left.heights[-1], right.heights[-1]) + SAME_HEIGHT
    levels: list[float] = []
    for height in sorted(h for h in (*left.heights, *right.heights) if h <= top):
        if not levels or height - levels[-1] > SAME_HEIGHT:
            levels.append(height)
    keys = {key: value for key, value in table.data.items() if key not in (BETWEEN, AT)}
    made = []
    for height in levels[-1:] if word == ROOF else levels:
        ends = [_end(left, height), _end(right, height)]
        # As the contact would be called without a name, which a capacity needs.
        name = "-".join("+".join([end] if isinstance(end, str) else end) for end in ends)
        made.append({"between": ends, **keys, **({"name": name} if "capacity" in keys else {})})
    return made


def _end(levels: Levels, height: float) -> str | dict[str, float]:
    """A floor at a height (m), or a point of the columns between two."""
    heights = (0.0, *levels.heights)
    i = bisect_left(heights, height - SAME_HEIGHT)
    above = levels.floors[i - 1]
    if abs(heights[i] - height) <= SAME_HEIGHT:
        return above
    below = levels.base if i == 1 else levels.floors[i - 2]
    part = (height - heights[i - 1]) / (heights[i] - heights[i - 1])
    return {below: 1.0 - part, above: part}
