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
from dataclasses import replace
from pathlib import Path
from typing import Any

from eventpound.case.run_options import DEFAULTS, RunOptions
from eventpound.case.table import CaseProblem, Table
from eventpound.errors import InputError
from eventpound.units import Dimension, any_quantity

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
            value = found[f"{kind}s.{name}.{last}"] = own.quantity(word, dimension)
            own.require(word, not value <= 0.0, "a positive capacity")
    own.close()
    return found


def read_capacities(top: Table, options: RunOptions | None) -> RunOptions | None:
    """Options with capacities (SI), and the fractile where it is given; problems are noted.

    Whether a unit is one of its quantity is known where quantities are.
    """
    table = top.table(_TABLE)
    fractile = table.quantity(_FRACTILE, D.NUMBER, DEFAULTS.fractile)
    fits = math.isnan(fractile) or 1.0 <= fractile <= 100.0
    table.require(_FRACTILE, fits, "per cent of the records, 1 to 100")
    found, dimensions = list[tuple[str, float]](), list[tuple[str, Dimension]]()
    for name in (key for key in table.data if key != _FRACTILE and table.has(key)):
        with table.noting(name):
            value, dimension = any_quantity(table.data[name])
            found.append((name, value))
            dimensions += [] if dimension is None else [(name, dimension)]
            table.require(name, value > 0.0, "a positive capacity")
    table.require(_FRACTILE, not table.has(_FRACTILE) or bool(found), "a capacity beside it")
    if options is None:
        return None
    held, of = tuple(found), tuple(dimensions)
    stated = replace(options.stated, capacities=held, capacity_dimensions=of, fractile=fractile)
    return replace(options, stated=stated)
