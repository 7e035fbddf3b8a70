"""A case with its buildings, frames and joints written out as bodies, springs and contacts.

A ``[[contact]]`` with ``between_buildings = ["A", "B"]`` stands for one at each floor of either
that is no higher than the other: floor against floor where both have one at that height, else
against the columns of the other, at a point between its floors by the heights.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Mapping
from pathlib import Path

from eventpound.case.building import Levels, building_tables
from eventpound.case.frame import frame_tables
from eventpound.case.table import CaseProblem, Table
from eventpound.errors import InputError

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
    return [
        {"between": [_end(left, height), _end(right, height)], **keys}
        for height in (levels[-1:] if word == ROOF else levels)
    ]


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
