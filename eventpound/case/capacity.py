"""Capacities: numbers of a run that may not be exceeded, by the names of these quantities.

    capacity = { ductility = 6 }               in [[spring]], [[contact]], [[seat]] or [[building]]
    [capacity]
    fractile = 84                              of the demands that are held against them, per cent
    "contacts.joint.max_impulse" = "90 kN s"   any quantity, by its name

What stands in the tables of parts is taken from there to ``[capacity]`` before they are read.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from eventpound.case.table import CaseProblem, Table
from eventpound.errors import InputError
from eventpound.units import Dimension

D = Dimension
_OF_PARTS: Mapping[str, Mapping[str, tuple[str, Dimension]]] = {
    "spring": {
        "ductility": ("ductility", D.NUMBER),
        "drift": ("drift_ratio", D.NUMBER),
        "deformation": ("abs_max_elongation", D.LENGTH),
        "force": ("abs_max_force", D.FORCE),
        "depth": ("passive_depth", D.LENGTH),
    },
    "contact": {"gap": ("separation_needed", D.LENGTH), "opening": ("seat_used", D.LENGTH)},
    "seat": {"length": ("max_opening", D.LENGTH)},
}
"""Words of a capacity, each with the last word of its quantity and with its unit."""
_OTHERS = {"max_impulse": D.IMPULSE, "max_force": D.FORCE, "abs_max_base_shear": D.FORCE}
_DIMENSIONS = {word: of for words in _OF_PARTS.values() for word, of in words.values()} | _OTHERS
"""Of quantities, by their last words; of others a capacity is a plain number (SI)."""
_TABLE, _FRACTILE = "capacity", "fractile"


def with_capacities(document: Mapping[str, object], file: Path) -> Mapping[str, object]:
    """Tables of a case, with the capacities of their parts in ``[capacity]``.

    Parameters
    ----------
    document : mapping
        As tomllib gives it, buildings written out.
    file : Path
        For messages.

    Raises
    ------
    InputError
        With one line for every problem of a capacity.
    """
    problems: list[CaseProblem] = []
    whole: dict[str, Any] = dict(document)
    found = dict[str, object]()
    for kind, words in _OF_PARTS.items():
        given = document.get(kind)
        if not (isinstance(given, list) and any(_TABLE in t for t in given if isinstance(t, dict))):
            continue
        for table in Table({kind: given}, "", problems).tables(kind):
            found |= _of_part(kind, table, words) if table.has(_TABLE) else {}
    if problems:
        raise InputError([f"{file}: {problem}" for problem in problems])
    for kind in (word for word in _OF_PARTS if isinstance(whole.get(word), list)):
        whole[kind] = [_without(each) for each in whole[kind]]
    own = document.get(_TABLE, {})
    # What is no table is refused where it is read.
    return {**whole, _TABLE: {**own, **found}} if found and isinstance(own, dict) else whole


def _without(table: Any) -> Any:
    """A table without its capacities; what is no table is refused where it is read."""
    if not isinstance(table, dict) or _TABLE not in table:
        return table
    return {key: value for key, value in table.items() if key != _TABLE}


def _of_part(
    kind: str, table: Table, words: Mapping[str, tuple[str, Dimension]]
) -> dict[str, float]:
    """Capacities of a spring, contact or seat, by the names of their quantities."""
    name, own, found = table.data.get("name"), table.table(_TABLE), dict[str, float]()
    if not isinstance(name, str):
        table.report_missing("name", "a name, which a part with a capacity needs")
    for word, (last, dimension) in words.items():
        if own.has(word):
            found[f"{kind}s.{name}.{last}"] = _positive(own, word, dimension)
    own.close()
    return found


def _positive(table: Table, key: str, dimension: Dimension) -> float:
    value = table.quantity(key, dimension)
    table.require(key, not value <= 0.0, "a positive capacity")
    return value


def read_capacities(top: Table) -> tuple[tuple[tuple[str, float], ...], float | None]:
    """Capacities (SI) by the names of their quantities, and the fractile where it is given."""
    table, found = top.table(_TABLE), []
    fractile = table.quantity(_FRACTILE, D.NUMBER) if table.has(_FRACTILE) else None
    fits = fractile is None or math.isnan(fractile) or 1.0 <= fractile <= 100.0
    table.require(_FRACTILE, fits, "per cent of the records, 1 to 100")
    for name in table.data:
        if name != _FRACTILE and table.has(name):
            dimension = _DIMENSIONS.get(name.rpartition(".")[2], D.NUMBER)
            found.append((name, _positive(table, name, dimension)))
    table.require(_FRACTILE, fractile is None or bool(found), "a capacity beside it")
    return tuple(found), fractile
