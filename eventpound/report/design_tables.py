"""Design numbers as tables to be read, in units of the trade: all of them, or those of a report."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from eventpound.quantities.lookup import Named, find
from eventpound.results.cells import Cells, headed
from eventpound.results.trade import Trade
from eventpound.scene.contact import Contact, weights_of
from eventpound.scene.joints import joints_of
from eventpound.scene.periods import longest_period
from eventpound.scene.scene import Scene
from eventpound.scene.spring import Hysteretic, Slider
from eventpound.study.design import FRACTILES
from eventpound.study.records import FAILED
from eventpound.units import Dimension

if TYPE_CHECKING:
    import pandas as pd

    from eventpound.case.case import Case

_Row: TypeAlias = "Mapping[Any, Any]"
_NUMBERS = ("value", *(f"{p:g} %" for p in FRACTILES), "largest")
"""Columns of numbers, of a run or of many."""
_OTHERS = {"spring": "Springs", "body": "Bodies", "": "Whole"}
_CONTACT, _SPRING = "contacts.<contact>.", "springs.<spring>."
NEEDED = _CONTACT + "separation_needed"
"""The gap with which nothing touches, of a joint."""
_OF_ONE = tuple(_CONTACT + word for word in ("avoiding_gap", "avoiding_gap_alone"))
"""Gaps of one contact, which may be the same."""
_PEAK, _RESIDUAL = _SPRING + "abs_max_elongation", _SPRING + "residual_elongation"
_OWN: dict[str, type] = {_PEAK: Slider, _RESIDUAL: Hysteretic}
"""Laws of which a demand is told: others have ductility, drift, or none that stays."""
_OF_CONTACTS = (
    *_OF_ONE,
    *(_CONTACT + word for word in ("absolute_sum", "srss", "cqc", "seat_used")),
    *(_CONTACT + word for word in ("impacts_faster", "fastest_closing", "max_impulse")),
    *(_CONTACT + word for word in ("estimated_force", "max_force")),
)
_OF_OTHERS = (
    *(_SPRING + "ductility", _PEAK, _RESIDUAL, _SPRING + "slip_path"),
    *(_SPRING + word for word in ("passive_force", "passive_depth", "residual_gap")),
    *(_SPRING + word for word in ("strength_lost", "stiffness_lost", "drift_ratio")),
    *(_SPRING + "stability_coefficient", "max_drift"),
    *("acceleration.<body>.abs_max", "peaks.<body>.abs_max", "base_shear.abs_max"),
)
"""Demands that stand in a report."""
_MOST_JOINTS, _MOST_OF_CONTACTS = 6, 3
"""Joints in a report, and contacts with the rest of their numbers."""
_MOST_RECORDS, _IN_ONE_COLUMN = 44, 12
_LONGEST = 44
"""Letters of the name of a record."""
_SAME = 5e-3
"""Part by which two separations may differ and be told as one."""
_SIZES = (("scale", "scale", ""), ("PGA", "PGA", "m/s^2"), ("T_m", "T_m", "s"))
"""Numbers of a record: columns of a suite, what they are called and units (SI)."""


def design_cells(scene: Scene, table: pd.DataFrame, trade: Trade) -> Iterator[tuple[str, Cells]]:
    """Headings and tables of the design numbers of a run or a suite.

    Parameters
    ----------
    scene : Scene
        Whose they are.
    table : DataFrame
        As `eventpound.design_numbers` gives it.
    trade : Trade
        Units.
    """
    kinds = table["quantity"].map(lambda name: _found(scene, name).quantity.owner)
    if scene.contacts:
        joints = type(table)(_of_joints(scene, _by_name(table)))
        yield "Joints, opened until nothing touches anywhere", _cells(joints, trade, whose=True)
    for contact in scene.contacts:
        rows = table[(kinds == "contact") & (table["of"] == contact.name)]
        shown = rows[rows["quantity"] != _of(NEEDED, contact)]
        yield f"Contact {contact_words(contact, rows, trade)}", _cells(shown, trade, whose=False)
    for kind, heading in _OTHERS.items():
        rows = table[kinds == kind]
        if len(rows):
            yield heading, _cells(rows, trade, whose=bool(kind))


def _found(scene: Scene, name: str) -> Named:
    """A quantity of a table of the scene."""
    found = find(scene, name)
    assert found is not None, name
    return found


def contact_words(contact: Contact, rows: pd.DataFrame, trade: Trade) -> str:
    """A contact, its ends and gap, and how often it is struck, by the rows of its numbers."""
    ends = (contact.left, contact.right)
    names = " | ".join(" + ".join(name for name, _ in weights_of(end)) for end in ends)
    text = f"{contact.name}: {names}, gap {trade.words(contact.gap, 'm')}"
    if rows.empty:
        return text
    if "pounding" in rows:
        return f"{text}, struck under {rows['pounding'].iloc[0]} of {rows['records'].max()} records"
    name = f"contacts.{contact.name}.impacts"
    count = float(rows.loc[rows["quantity"] == name, "value"].iloc[0])
    return f"{text}, struck {trade.number(count, '', name)} times"


def _cells(rows: pd.DataFrame, trade: Trade, whose: bool) -> Cells:
    """A table, a line a demand with its unit."""
    numbers = [name for name in _NUMBERS if name in rows]
    words = ["under"] if "under" in rows else []
    lines = []
    for row in rows.to_dict("records"):
        name, unit = str(row["quantity"]), str(row["unit"])
        shown = trade.unit(unit, name)[0]
        called = f"{row['demand']}, {shown}" if shown else str(row["demand"])
        first = f"{row['of']}: {called}" if whose else called
        cells = (trade.number(float(row[number]), unit, name) for number in numbers)
        lines.append((first, *cells, *(_word(row[key]) for key in words)))
    kinds = (True, *(False for _ in numbers), *(True for _ in words))
    return Cells(("", *numbers, *words), tuple(lines), kinds)


def _word(value: object) -> str:
    """A text of a table; empty where it has none."""
    return "" if value != value else str(value)


def report_cells(
    scene: Scene, table: pd.DataFrame, names: Mapping[str, str], trade: Trade, most: int
) -> list[Cells]:
    """The design numbers that a report has room for: at contacts, and of all others.

    Parameters
    ----------
    scene : Scene
        Whose they are.
    table : DataFrame
        As `eventpound.design_numbers` gives it.
    names : mapping of str to str
        What records are called, by their names in the table.
    trade : Trade
        Units.
    most : int
        Springs or bodies of one demand, those with the largest.
    """
    rows = _by_name(table)
    parts = (_at_contacts(scene, table, rows), _of_others(scene, rows))
    return [_reported(list(part), names, trade, most) for part in parts if part]


def _by_name(table: pd.DataFrame) -> dict[str, _Row]:
    """Rows of a table by their quantities."""
    return {str(row["quantity"]): row for row in table.to_dict("records")}


def joint_names(scene: Scene) -> dict[int, str]:
    """What each joint is called, by its first contact; one of several gaps has several names."""
    found = {}
    for joint in joints_of(scene):
        for gap in dict.fromkeys(scene.contacts[i].gap for i in joint):
            first, *others = (i for i in joint if scene.contacts[i].gap == gap)
            last = f" … {scene.contacts[others[-1]].name}" if others else ""
            found[first] = scene.contacts[first].name + last
    return found


def _of_joints(scene: Scene, rows: Mapping[str, _Row]) -> list[_Row]:
    """What each joint needs, a row for each gap that it has today."""
    names = joint_names(scene).items()
    return [{**rows[_of(NEEDED, scene.contacts[i])], "of": name} for i, name in names]


def _of(path: str, contact: Contact) -> str:
    """The name of a quantity of a contact."""
    return path.replace("<contact>", contact.name)


def _at_contacts(
    scene: Scene, table: pd.DataFrame, rows: Mapping[str, _Row]
) -> list[tuple[_Row, ...]]:
    """What joints need, then rows of each contact, of that first which lacks most of its gap."""
    if not scene.contacts:
        return []
    order = [scene.contacts[i] for i in lacking_contacts(scene, table)]
    needed = [_of(NEEDED, contact) for contact in order]
    joints = sorted(_of_joints(scene, rows), key=lambda row: needed.index(row["quantity"]))
    found = [tuple(joints[:_MOST_JOINTS])]
    for contact, joint in zip(order, needed, strict=True):
        own = (name for path in _OF_CONTACTS if (name := _of(path, contact)) in rows)
        found.append(tuple(rows[name] for name in own if not _is_told(name, rows, rows[joint])))
    return found


def _of_others(scene: Scene, rows: Mapping[str, _Row]) -> list[tuple[_Row, ...]]:
    """Rows of each other demand, the largest first."""
    groups: dict[str, list[_Row]] = {path: [] for path in _OF_OTHERS}
    for name, row in rows.items():
        named = _found(scene, name)
        path = named.quantity.path
        own = path not in _OWN or isinstance(scene.springs[named.i].law, _OWN[path])
        if own and path in groups:
            groups[path].append(row)
    return [tuple(sorted(group, key=_size, reverse=True)) for group in groups.values() if group]


def _size(row: _Row) -> float:
    """The largest value of a row."""
    return float(np.nan_to_num(row.get(_NUMBERS[-1], row.get(_NUMBERS[0])), nan=-np.inf))


def _is_told(name: str, rows: Mapping[str, _Row], joint: _Row) -> bool:
    """Whether a gap of one contact is that of its joint."""
    keys = [key for key in _NUMBERS if key in joint]
    close = np.allclose([rows[name][k] for k in keys], [joint[k] for k in keys], rtol=_SAME)
    return name.endswith(tuple(path.rpartition(".")[2] for path in _OF_ONE)) and bool(close)


def _reported(
    groups: list[tuple[_Row, ...]], names: Mapping[str, str], trade: Trade, most: int
) -> Cells:
    """A table of some groups of rows; those that there is no room for are counted."""
    of_contacts = str(groups[0][0]["quantity"]).startswith("contacts.")
    shown = groups[: 1 + _MOST_OF_CONTACTS] if of_contacts else [g[:most] for g in groups]
    kept = [row for group in shown for row in group]
    numbers = [key for key in _NUMBERS if key in kept[0]]
    under = ["under"] if "under" in kept[0] else []
    lines, last = [], ""
    for row in kept:
        name, unit, of = str(row["quantity"]), str(row["unit"]), str(row["of"]) or "whole"
        values = (trade.number(float(row[key]), unit, name) for key in numbers)
        record = (names.get(word := _word(row[key]), word) for key in under)
        first = of if of != last else ""
        lines.append((first, str(row["demand"]), trade.unit(unit, name)[0], *values, *record))
        last = of
    words = (True, True, True, *(False for _ in numbers), *(True for _ in under))
    more = sum(map(len, groups)) - len(kept)
    return Cells(("of", "demand", "unit", *numbers, *under), tuple(lines), words, more)


def scaling_words(case: Case, trade: Trade) -> str:
    """What a case does to the size of every record of its suite; empty where that is nothing."""
    if case.suite is None:
        return ""
    size = case.suite.options.size
    return size.words(lambda value: trade.words(value, Dimension.ACCELERATION.unit))


def lacking_contacts(scene: Scene, table: pd.DataFrame) -> list[int]:
    """Numbers of the contacts, those first whose joint lacks most; of one joint, who needs most."""
    largest = table.set_index("quantity")[_NUMBERS[-1] if _NUMBERS[-1] in table else _NUMBERS[0]]

    def lack(i: int) -> list[float]:
        contact = scene.contacts[i]
        sizes = (float(largest[_of(path, contact)]) for path in (NEEDED, _OF_ONE[0]))
        return [-np.nan_to_num(size - contact.gap, nan=-np.inf) for size in sizes]

    return sorted(range(len(scene.contacts)), key=lack)


def record_names(runs: pd.DataFrame) -> dict[str, str]:
    """What records are called, with their numbers: event, station and component, or their names."""
    names = {}
    for number, row in enumerate(runs.to_dict("records"), 1):
        said = [word for key in ("event", "station", "component") if (word := _word(row[key]))]
        name = ", ".join(said) or str(row["record"])
        short = name if len(name) <= _LONGEST else name[: _LONGEST - 1] + "…"
        names[str(row["record"])] = f"{number} {short}"
    return names


def record_cells(scene: Scene, runs: pd.DataFrame, trade: Trade) -> list[Cells]:
    """Name and size of each record, as one table, or two where they are many."""
    at = f"Sa({longest_period(scene) or np.nan:.3g} s)"
    sizes = (*_SIZES, ("Sa_T1", at, Dimension.ACCELERATION.unit))
    there = [size for size in sizes if size[0] in runs]
    heads = ("record", *(headed(called, trade.unit(unit)[0]) for _, called, unit in there))
    names, rows = record_names(runs), []
    for row in runs.to_dict("records"):
        values = ((float(row[key]), unit) for key, _, unit in there)
        cells = ("" if value != value else trade.number(value, unit) for value, unit in values)
        note = " (failed)" if row[FAILED] else ""
        rows.append((names[str(row["record"])] + note, *cells))
    words, shown = (True, *(False for _ in there)), rows[:_MOST_RECORDS]
    half = len(shown) if len(shown) <= _IN_ONE_COLUMN else -(-len(shown) // 2)
    parts = [shown[low : low + half] for low in range(0, len(shown), half)]
    more = len(rows) - len(shown)
    last = len(parts) - 1
    return [Cells(heads, tuple(p), words, more * (i == last)) for i, p in enumerate(parts)]
