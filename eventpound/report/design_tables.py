"""Design numbers as tables to be read: a table a contact, of the springs, of the bodies."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from eventpound.quantities.lookup import find
from eventpound.results.cells import Cells
from eventpound.results.trade import Trade, trade_of
from eventpound.scene.contact import Contact, weights_of
from eventpound.scene.scene import Scene
from eventpound.study.design import FRACTILES

if TYPE_CHECKING:
    import pandas as pd

_NUMBERS = ("value", *(f"{p:g} %" for p in FRACTILES), "largest")
"""Columns of numbers, of a run or of many."""
_OTHERS = {"spring": "Springs", "body": "Bodies", "": "Whole"}


def design_cells(scene: Scene, table: pd.DataFrame) -> Iterator[tuple[str, Cells]]:
    """Headings and tables of the design numbers of a run or a suite.

    Parameters
    ----------
    scene : Scene
        Whose they are.
    table : DataFrame
        As `eventpound.design_numbers` gives it.
    """
    trade = trade_of(scene)
    kinds = table["quantity"].map(lambda name: _owner(scene, name))
    for contact in scene.contacts:
        rows = table[(kinds == "contact") & (table["of"] == contact.name)]
        yield _heading(contact, rows, trade), _cells(rows, trade, whose=False)
    for kind, heading in _OTHERS.items():
        rows = table[kinds == kind]
        if len(rows):
            yield heading, _cells(rows, trade, whose=bool(kind))


def _owner(scene: Scene, name: str) -> str:
    """Kind of the owner of a quantity, empty of the whole."""
    found = find(scene, name)
    return "" if found is None else found.quantity.owner


def _heading(contact: Contact, rows: pd.DataFrame, trade: Trade) -> str:
    """A contact, its ends and gap, and how many records strike it."""
    ends = [
        " + ".join(name for name, _ in weights_of(end)) for end in (contact.left, contact.right)
    ]
    text = f"Contact {contact.name}: {' | '.join(ends)}, gap {trade.words(contact.gap, 'm')}"
    if "pounding" not in rows or rows.empty:
        return text
    first = rows.iloc[0]
    return f"{text}, struck under {first['pounding']:.0f} of {rows['records'].max()} records"


def _cells(rows: pd.DataFrame, trade: Trade, whose: bool) -> Cells:
    """A table, a line a demand with its unit."""
    numbers = [name for name in _NUMBERS if name in rows]
    words = ["under"] if "under" in rows else []
    lines = []
    for _, row in rows.iterrows():
        name, unit = str(row["quantity"]), str(row["unit"])
        shown = trade.unit(unit, name)[0]
        called = f"{row['demand']}, {shown}" if shown else str(row["demand"])
        first = f"{row['of']}: {called}" if whose else called
        cells = (trade.number(float(row[number]), unit, name) for number in numbers)
        lines.append((first, *cells, *("" if row[w] != row[w] else str(row[w]) for w in words)))
    kinds = (True, *(False for _ in numbers), *(True for _ in words))
    return Cells(("", *numbers, *words), tuple(lines), kinds)
