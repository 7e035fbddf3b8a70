"""``[[frame]]``: a condensed frame of another program, written out as bodies, springs and damping.

    body            one a degree of freedom, by the names of the file, or NAME1, NAME2, ...
    spring          the couplings, marked by the frame's name (`eventpound.scene.frame`)
    dashpot         of a damping matrix; or [[rayleigh]] or [[modal_damping]] of a ratio

Numbers without a unit, in files and lists, are in SI, or in the ``units`` of the table.
"""

from __future__ import annotations

from collections.abc import Collection
from itertools import pairwise
from pathlib import Path

import numpy as np

from eventpound.basics.matrix_file import NamedMatrix, read_matrix
from eventpound.case.building import MODAL, RAYLEIGH, Levels, damping_tables
from eventpound.case.record_file import find_record
from eventpound.case.table import Table
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.scene.frame import Frame, frame
from eventpound.scene.spring import GROUND, law_keys, storey_keys
from eventpound.units import Dimension, quantity

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
            parts = frame(name, **values, names=names or None, on=on)
    bodies = [body.name for body in parts.bodies] if parts else []
    if heights and len(heights) != len(bodies) and parts:
        table.reject("levels", f"a list of {len(bodies)}, one a degree of freedom")
    damping = dict[str, list[object]]()
    if not _is_matrix(table):
        damping = damping_tables(table, bodies, on, on in supports)
    for key in ("ratio", "modes"):
        if table.has(key) and _is_matrix(table):
            table.reject(key, "none beside a damping matrix")
    table.close()
    if parts is None:
        return {}, None
    return _tables(parts) | damping, Levels(on, tuple(bodies), heights)


def _tables(parts: Frame) -> dict[str, list[object]]:
    """Tables of the parts, in SI."""
    return {
        "body": [{"name": body.name, "mass": body.mass} for body in parts.bodies],
        "spring": [
            {"between": list(s.between), "name": s.name, **storey_keys(s), **law_keys(s.law)}
            for s in parts.springs
        ],
        "dashpot": [
            {"between": list(d.between), "coefficient": d.coefficient} for d in parts.dashpots
        ],
    }


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
        if found and all(low < high for low, high in pairwise([0.0, *found])):
            return tuple(found)
        table.reject("levels", "a list of heights above the ground (m) that grow")
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
