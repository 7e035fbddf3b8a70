"""Design numbers as tables to be read, in units of the trade: all, or those of two pages."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from eventpound.quantities.base import least_governs
from eventpound.results.shown_units import Units
from eventpound.results.tables import Cells, cell_text, headed
from eventpound.scene.contact import Contact
from eventpound.scene.ends import weights_of
from eventpound.scene.joints import joints_of
from eventpound.scene.plan_point import PlanPoint
from eventpound.scene.scene import Scene
from eventpound.study.demands import NEEDED
from eventpound.study.design import FRACTILES

if TYPE_CHECKING:
    import pandas as pd


_Row: TypeAlias = "Mapping[Any, Any]"
NUMBERS = ("value", *(f"{p:g} %" for p in FRACTILES), "largest")
"""Columns of numbers, of a run or of many."""
_HELD = ("capacity", "demand/capacity", "passes")
"""Columns of a demand that has a capacity."""
_WORDS = ("under", "at", "passes")
"""Columns of words."""
_JOINTS, _CONTACTS = "Joints", "Contacts"
_MOST_JOINTS, _MOST_OF_CONTACTS = 6, 3
"""Joints in a report, and contacts with their numbers."""
_NOT_IN_PAGES = ("dissipated_energy", "largest_gap", ".impacts")
"""Ends of quantities that the two pages have no room for."""
_SAME = 5e-3
"""Part by which two separations may differ and be told as one."""
_AVOIDING = "contacts.<contact>.avoiding_gap"
_GAPS = (".avoiding_gap", ".avoiding_gap_alone")
"""Ends of the names of gaps of one contact, which may be those of its joint."""


def kind_tables(
    scene: Scene, table: pd.DataFrame, names: Mapping[str, str], units: Units
) -> Iterator[Cells]:
    """All design numbers, a table for each kind of elements, which its first heading names.

    Parameters
    ----------
    scene : Scene
        Whose they are.
    table : DataFrame
        As `eventpound.design_numbers` gives it.
    names : mapping of str to str
        What records are called, by their names in the table.
    units : Units
        Units.
    """
    rows = _by_name(table)
    for kind, part in table.groupby("kind", sort=False):
        own = [rows[name] for name in part["quantity"]]
        own = _of_joints(scene, rows) if kind == _JOINTS else own
        yield _kind_table(str(kind), own, names, units)


def _kind_table(kind: str, rows: Sequence[_Row], names: Mapping[str, str], units: Units) -> Cells:
    """A row an element, with the numbers of each demand side by side."""
    demands = dict.fromkeys(str(row["demand"]) for row in rows)
    by_place = {(row["of"], row["demand"]): row for row in rows}
    elements = list(dict.fromkeys(str(row["of"]) for row in rows))
    headings, words = [kind], [True]
    texts, exact = [elements], list[Sequence[str | float]]([elements])
    for demand in demands:
        own = [by_place.get((of, demand), {}) for of in elements]
        unit, size = units.of_row(next(row for row in own if row))
        for key in _columns(own):
            number = key in (*NUMBERS, "capacity")
            named = headed(demand, unit) if number else demand
            headings.append(named if key == "value" else f"{named}: {key}")
            words.append(key in _WORDS)
            texts.append([_text(row, key, names, units) for row in own])
            values = (row.get(key, np.nan) for row in own)
            scaled = [] if words[-1] else [float(x) / (size if number else 1.0) for x in values]
            exact.append(texts[-1] if words[-1] else scaled)
    read, known = (tuple(zip(*columns, strict=True)) for columns in (texts, exact))
    return Cells(tuple(headings), read, tuple(words), exact=known)


def _columns(rows: Sequence[_Row]) -> list[str]:
    """Columns that some rows of a demand have."""
    keys = (*NUMBERS, "under", "at", *_HELD)
    return [key for key in keys if any(cell_text(row.get(key, "")) for row in rows)]


def _text(row: _Row, key: str, names: Mapping[str, str], units: Units) -> str:
    """A cell as it is read."""
    if key == "under":
        return _under(row, names)
    value = row.get(key, "")
    if key in (*NUMBERS, "capacity") and row:
        name = str(row["quantity"])
        if key == "capacity":
            if value != value:
                return ""
            # What may be held is no gap to be built.
            name = "drift_ratio" * name.endswith("drift_ratio")
        return units.number(float(value), str(row["unit"]), name)
    return f"{value:.2f}" if isinstance(value, float) and value == value else cell_text(value)


def _under(row: _Row, names: Mapping[str, str]) -> str:
    """The record that governs, with its factor."""
    record = cell_text(row.get("under", ""))
    scale = row.get("scale", np.nan)
    factor = f" ×{scale:.3g}" if record and scale == scale and scale != 1.0 else ""
    return names.get(record, record) + factor


def contact_words(contact: Contact, rows: pd.DataFrame, units: Units) -> str:
    """A contact, its ends and gap, and how often it is struck, by the table of its numbers."""
    names = " | ".join(
        end.label if isinstance(end, PlanPoint) else " + ".join(name for name, _ in weights_of(end))
        for end in contact.sides
    )
    text = f"{contact.name}: {names}, gap {units.words(contact.gap, 'm')}"
    rows = rows[(rows["kind"] == _CONTACTS) & (rows["of"] == contact.name)]
    if rows.empty:
        return text
    if "pounding" in rows:
        return f"{text}, struck under {rows['pounding'].iloc[0]} of {rows['records'].max()} records"
    name = f"contacts.{contact.name}.impacts"
    count = float(rows.loc[rows["quantity"] == name, "value"].iloc[0])
    return f"{text}, struck {units.number(count, '', name)} times"


def screen_tables(
    scene: Scene, table: pd.DataFrame, names: Mapping[str, str], units: Units
) -> Iterator[tuple[str, Cells]]:
    """Headings and tables of the design numbers of a run or a suite, a line a demand.

    Parameters
    ----------
    scene : Scene
        Whose they are.
    table : DataFrame
        As `eventpound.design_numbers` gives it.
    names : mapping of str to str
        What records are called, by their names in the table.
    units : Units
        Units.
    """
    for kind, part in table.groupby("kind", sort=False):
        if kind == _JOINTS:
            yield (
                "Joints, opened until nothing touches anywhere",
                _lines(_of_joints(scene, _by_name(table)), names, units),
            )
        elif kind == _CONTACTS:
            for contact in scene.contacts:
                rows = part[part["of"] == contact.name]
                yield (
                    f"Contact {contact_words(contact, table, units)}",
                    _lines(rows.to_dict("records"), names, units, whose=False),
                )
        else:
            yield str(kind), _lines(part.to_dict("records"), names, units)


def _lines(
    rows: Sequence[_Row], names: Mapping[str, str], units: Units, whose: bool = True
) -> Cells:
    """A table, a line a demand with its unit."""
    keys = _columns(rows)
    lines = []
    for row in rows:
        shown = units.of_row(row).name
        called = f"{row['demand']}, {shown}" if shown else str(row["demand"])
        first = f"{row['of']}: {called}" if whose and row["of"] else called
        lines.append((first, *(_text(row, key, names, units) for key in keys)))
    words = (True, *(key in _WORDS for key in keys))
    return Cells(("", *keys), tuple(lines), words)


def page_cells(
    scene: Scene, table: pd.DataFrame, names: Mapping[str, str], units: Units, most: int
) -> list[Cells]:
    """The design numbers that two pages have room for: at joints, and what governs of each kind.

    Parameters
    ----------
    scene : Scene
        Whose they are.
    table : DataFrame
        As `eventpound.design_numbers` gives it.
    names : mapping of str to str
        What records are called, by their names in the table.
    units : Units
        Units.
    most : int
        Elements of one kind that are shown.
    """
    rows = _by_name(table)
    at_joints = _at_joints(scene, table, rows)
    others: list[_Row] = []
    for kind, part in table.groupby("kind", sort=False):
        if kind not in (_JOINTS, _CONTACTS):
            shown = [r for r in part.to_dict("records") if not _left_out(str(r["quantity"]))]
            others += _governing(str(kind), shown, most)
    groups = ((_JOINTS, at_joints), ("Elements that govern", others))
    return [_page_table(name, group, names, units) for name, group in groups if group]


def _left_out(quantity: str) -> bool:
    return quantity.endswith(_NOT_IN_PAGES)


def _governing(kind: str, rows: Sequence[_Row], most: int) -> list[_Row]:
    """Of each demand the largest rows, the one nearest to its capacity, and all that exceed it."""
    count = len({row["of"] for row in rows})
    heading = kind if count == 1 else f"{kind} ({count})"
    found: list[_Row] = []
    for demand in dict.fromkeys(row["demand"] for row in rows):
        own = sorted((r for r in rows if r["demand"] == demand), key=_size, reverse=True)
        held = sorted(own, key=_ratio, reverse=True)
        first = [*held[:1], *(row for row in held if _ratio(row) > 1.0)]
        first = [row for row in first if _ratio(row) > 0.0]
        found += list({row["of"]: row for row in (*own[:most], *first)}.values())
    return [{**row, "kind": heading} for row in found]


def _at_joints(scene: Scene, table: pd.DataFrame, rows: Mapping[str, _Row]) -> list[_Row]:
    """What joints need, then rows of each contact, of that first which lacks most of its gap."""
    if not scene.contacts:
        return []
    worst = lacking_contacts(scene, table)
    # Of each joint one first, however many floors strike at one of them.
    firsts = [next(i for i in worst if i in joint) for joint in joints_of(scene)]
    order = [scene.contacts[i] for i in sorted(worst, key=lambda i: i not in firsts)]
    needed = [_of(NEEDED, contact) for contact in order]
    joints = sorted(_of_joints(scene, rows), key=lambda row: needed.index(row["quantity"]))
    found = joints[:_MOST_JOINTS]
    contacts = table[table["kind"] == _CONTACTS]
    for contact, joint in list(zip(order, needed, strict=True))[:_MOST_OF_CONTACTS]:
        for row in contacts[contacts["of"] == contact.name].to_dict("records"):
            name = str(row["quantity"])
            if not (_left_out(name) or _is_told(name, row, rows[joint])):
                found.append({**row, "kind": f"Contact {contact.name}"})
    return found


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
    """What each joint needs, a row for each gap that it has today, with its least capacity."""
    found: list[_Row] = []
    for i, name in joint_names(scene).items():
        (joint,) = (each for each in joints_of(scene) if i in each)
        alike = (scene.contacts[k] for k in joint if scene.contacts[k].gap == scene.contacts[i].gap)
        own = max((rows[_of(NEEDED, contact)] for contact in alike), key=_ratio)
        found.append({**own, "of": name})
    return found


def _of(path: str, contact: Contact) -> str:
    """The name of a quantity of a contact."""
    return path.replace("<contact>", contact.name)


def _ratio(row: _Row) -> float:
    """Demand over capacity, zero of a row that has none."""
    return float(np.nan_to_num(row.get("demand/capacity", 0.0)))


def _size(row: _Row) -> float:
    """The largest value of a row; of what is to be left the least counts most."""
    size = float(np.nan_to_num(row.get(NUMBERS[-1], row.get(NUMBERS[0])), nan=-np.inf))
    return -size if least_governs(str(row["quantity"])) else size


def _is_told(name: str, row: _Row, joint: _Row) -> bool:
    """Whether a gap of one contact is that of its joint."""
    keys = [key for key in NUMBERS if key in joint]
    close = np.allclose([row[k] for k in keys], [joint[k] for k in keys], rtol=_SAME)
    return name.endswith(_GAPS) and bool(close)


def _page_table(
    heading: str, rows: Sequence[_Row], names: Mapping[str, str], units: Units
) -> Cells:
    """A table of rows of several kinds."""
    keys, lines = _columns(rows), list[tuple[str, ...]]()
    last = ("", "")
    for row in rows:
        kind, of = str(row["kind"]), str(row["of"]) or "whole"
        firsts = kind if kind != last[0] else "", of if (kind, of) != last else ""
        cells = (_text(row, key, names, units) for key in keys)
        lines.append((*firsts, str(row["demand"]), units.of_row(row).name, *cells))
        last = kind, of
    words = (True, True, True, True, *(key in _WORDS for key in keys))
    return Cells((heading, "of", "demand", "unit", *keys), tuple(lines), words)


def shock_cells(
    shocks: Sequence[Mapping[str, Any]], table: pd.DataFrame, units: Units, most: int | None = None
) -> Cells:
    """Demands of each shock of a sequence by itself, all of them or the largest of each kind.

    Parameters
    ----------
    shocks : sequence of mapping
        Rows of `eventpound.Response.shocks`.
    table : DataFrame
        As `eventpound.design_numbers` gives it.
    units : Units
        Units.
    most : int, optional
        Rows that there is room for, the largest of each demand.
    """
    known = [row for row in table.to_dict("records") if any(row["quantity"] in s for s in shocks)]
    if most is not None:
        groups: dict[tuple[str, str], list[_Row]] = {}
        for row in known:
            if not _left_out(str(row["quantity"])):
                groups.setdefault((row["kind"], row["demand"]), []).append(row)
        known = [max(rows, key=_size) for rows in groups.values()]
    shown = known[:most]
    lines = []
    for row in shown:
        name, unit = str(row["quantity"]), str(row["unit"])
        values = (_or_nothing(shock.get(name)) for shock in shocks)
        cells = (units.number(abs(value), unit, name) for value in values)
        lines.append((str(row["of"]), str(row["demand"]), units.of_row(row).name, *cells))
    heads = [
        f"{s['shock']} {s['record']} ×{s['scale']:.3g}" + (" (failed)" if s["failed"] else "")
        for s in shocks
    ]
    words = (True, True, True, *(False for _ in shocks))
    return Cells(("of", "demand", "unit", *heads), tuple(lines), words, len(known) - len(shown))


def _or_nothing(value: float | None) -> float:
    return np.nan if value is None else float(value)


def capacity_words(table: pd.DataFrame, fractile: float) -> list[str]:
    """Whether capacities hold, and which do not; nothing where none is stated."""
    if "capacity" not in table:
        return []
    held = table[table["capacity"].notna()]
    over = held[held["passes"] == "no"].sort_values("demand/capacity", ascending=False)
    where = f" at {fractile:g} % of the records" if "records" in table else ""
    unknown = int((held["passes"] == "not known").sum())
    passed = len(held) - len(over) - unknown
    text = f"Capacities{where}: {passed} of {len(held)} hold"
    if unknown:
        text += f", of {unknown} it is not known, as runs failed"
    each = (
        f"{row['of']}, {row['demand']} (demand/capacity {row['demand/capacity']:.2f})"
        for row in over.to_dict("records")
    )
    return [f"{text}{'; exceeded: ' * (len(over) > 0)}{'; '.join(each)}."]


def lacking_contacts(scene: Scene, table: pd.DataFrame) -> list[int]:
    """Numbers of the contacts, those first whose joint lacks most; of one joint, who needs most."""
    largest = table.set_index("quantity")[NUMBERS[-1] if NUMBERS[-1] in table else NUMBERS[0]]

    def lack(i: int) -> list[float]:
        contact = scene.contacts[i]
        sizes = (float(largest[_of(path, contact)]) for path in (NEEDED, _AVOIDING))
        return [-np.nan_to_num(size - contact.gap, nan=-np.inf) for size in sizes]

    return sorted(range(len(scene.contacts)), key=lack)
