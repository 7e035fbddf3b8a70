"""Bodies and contacts of a case."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType

from eventpound.case.decks import PLACE_OF_DECK, place_of_deck
from eventpound.case.table import Table
from eventpound.errors import InputError
from eventpound.scene.body import Body
from eventpound.scene.contact import Contact
from eventpound.scene.contact_law import BY_WORD, NEWTON, ContactLaw
from eventpound.scene.deck import Deck
from eventpound.scene.ends import End, label_of, point_of
from eventpound.scene.plan_point import ALONG, DIRECTIONS
from eventpound.scene.seat import Seat
from eventpound.units import Dimension

_POINT = f"a point between bodies, {{ B2 = 0.4, B3 = 0.6 }}, or of a deck, {PLACE_OF_DECK}"
_OF_CONTACT = f'the left and the right body; "barrier" may be one of them, or {_POINT}'
"""What a contact is between."""
OF_LINK = f'two bodies, or a body and "ground"; or {_POINT}'
"""What a spring or dashpot is between."""
_LAW_KEYS = ("stiffness", "damping", "tension")
"""Keys of a contact with a law."""


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
        table.text("structure", "what its structure is called", ""),
        table.choice("direction", DIRECTIONS) if table.has("direction") else ALONG,
    )
    initial.close()
    table.close()
    return body


def read_contacts(tables: Sequence[Table], decks: Sequence[Deck] = ()) -> tuple[Contact, ...]:
    """Contacts from the ``[[contact]]`` tables, those without a name named after their bodies."""
    known = {deck.name: deck for deck in decks}
    ends = [ends_of(table, _OF_CONTACT, known) for table in tables]
    names = read_names(tables, ends)
    contacts = []
    for table, (left, right), name in zip(tables, ends, names, strict=True):
        gap = table.quantity("gap", Dimension.LENGTH)
        law = _read_law(table)
        friction = table.quantity("friction", Dimension.NUMBER, 0.0)
        contacts.append(Contact(name, left, right, gap, *law, friction))
        table.close()
    return tuple(contacts)


def read_seats(tables: Sequence[Table]) -> tuple[Seat, ...]:
    """Seats from the ``[[seat]]`` tables, those without a name named after their ends."""
    accepted = 'two ends, the left one first: bodies, supports or "ground"'
    ends = [table.pair("between", accepted) for table in tables]
    names = read_names(tables, ends)
    for table in tables:
        table.close()
    return tuple(map(Seat, names, ends))


def ends_of(
    table: Table, accepted: str, decks: Mapping[str, Deck] = MappingProxyType({})
) -> tuple[End, End]:
    """Both ends of what is between them; empty names where they are missing or wrong."""
    given = table.data["between"] if table.has("between") else None
    if not (isinstance(given, list) and any(isinstance(end, dict) for end in given)):
        return table.pair("between", accepted)
    ends: list[End] = []
    for end in given:
        try:
            if isinstance(end, dict) and "deck" in end:
                ends.append(place_of_deck(end, decks))
            else:
                ends.append(point_of(end) if isinstance(end, dict) else str(end))
        except InputError as error:
            table.report("between", str(error))
            return "", ""
    if len(ends) != 2 or not all(isinstance(end, str | dict) for end in given):
        table.reject("between", accepted)
        return "", ""
    return ends[0], ends[1]


def _read_law(table: Table) -> tuple[float | None, ContactLaw | None]:
    """Restitution and law of a contact; NaN where the former is missing or wrong."""
    word = table.choice("law", (NEWTON, *BY_WORD)) if table.has("law") else NEWTON
    element = BY_WORD.get(word)
    given = [key for key in ("restitution", *_LAW_KEYS) if table.has(key)]
    if not word:
        # What the other keys mean is not known.
        return math.nan, None
    if element is None:
        for key in given:
            if key in _LAW_KEYS:
                table.reject(key, f"none: a key of contact laws, law = {', '.join(BY_WORD)}")
        return table.quantity("restitution", Dimension.NUMBER), None
    stiffness = table.quantity("stiffness", element.dimension)
    restitution = table.optional_quantity("restitution", Dimension.NUMBER)
    damping = table.optional_quantity("damping", Dimension.NUMBER)
    tension = table.flag("tension") if table.has("tension") else True
    if element.damped and restitution is None and damping is None:
        table.report_missing("restitution", f"{Dimension.NUMBER.accepted}; or damping")
        restitution = math.nan
    return restitution, ContactLaw(word, stiffness, damping, tension)


def read_names(tables: Sequence[Table], ends: Sequence[tuple[End, End]]) -> list[str]:
    """Names of springs or contacts.

    Parameters
    ----------
    tables : sequence of Table
        May have the key ``name``.
    ends : sequence of tuple
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
            stem = f"{label_of(first)}-{label_of(second)}"
            number = 2
            name = stem
            while name in taken:
                name = f"{stem}-{number}"
                number += 1
            taken.add(name)
        names.append(name)
    return names
