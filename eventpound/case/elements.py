"""Bodies and contacts of a case."""

from __future__ import annotations

from collections.abc import Sequence

from eventpound.case.table import Table
from eventpound.scene.body import Body
from eventpound.scene.contact import Contact
from eventpound.units import Dimension


def read_body(table: Table) -> Body:
    """A body from its ``[[body]]`` table."""
    name = table.text("name", "a name for the body")
    mass = table.quantity("mass", Dimension.MASS)
    initial = table.table("initial")
    body = Body(
        name,
        mass,
        initial.quantity("displacement", Dimension.LENGTH, 0.0),
        initial.quantity("velocity", Dimension.VELOCITY, 0.0),
    )
    initial.close()
    table.close()
    return body


def read_contacts(tables: Sequence[Table]) -> tuple[Contact, ...]:
    """Contacts from the ``[[contact]]`` tables, those without a name named after their bodies."""
    ends = [
        table.pair("between", 'the left and the right body; "barrier" may be one of them')
        for table in tables
    ]
    names = read_names(tables, ends)
    contacts = []
    for table, (left, right), name in zip(tables, ends, names, strict=True):
        gap = table.quantity("gap", Dimension.LENGTH)
        restitution = table.quantity("restitution", Dimension.NUMBER)
        contacts.append(Contact(name, left, right, gap, restitution))
        table.close()
    return tuple(contacts)


def read_names(tables: Sequence[Table], ends: Sequence[tuple[str, str]]) -> list[str]:
    """Names of springs or contacts.

    Parameters
    ----------
    tables : sequence of Table
        May have the key ``name``.
    ends : sequence of tuple of str
        What each of them is between.

    Returns
    -------
    list of str
        The given name, or ``first-second``; with ``-2`` (``-3`` ...) after it
        where that name is taken.
    """
    given = [table.text("name", "some text") if table.has("name") else None for table in tables]
    taken = set(given)
    names = []
    for name, (first, second) in zip(given, ends, strict=True):
        if name is None:
            stem = f"{first}-{second}"
            number = 2
            name = stem
            while name in taken:
                name = f"{stem}-{number}"
                number += 1
            taken.add(name)
        names.append(name)
    return names
