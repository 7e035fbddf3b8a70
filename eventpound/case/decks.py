"""Decks in plan of a case, with their joints: the bodies and contacts that they are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from eventpound.case.table import Table, read_numbers
from eventpound.errors import InputError
from eventpound.scene.body import Body
from eventpound.scene.contact import Contact
from eventpound.scene.deck import Deck, DeckStart, place_in_a_row
from eventpound.scene.joint import Joint
from eventpound.scene.plan_point import DIRECTIONS, PlanPoint, coordinate_of
from eventpound.units import Dimension, quantity

_PLACE = "two lengths [x, y] (m), or strings with units"
_SPEEDS = "two velocities [x, y] (m/s), or strings with units"
_ENDS = 'the left and the right deck, or a deck and "barrier"'
PLACE_OF_DECK = '{ deck = "D1", at = [20.0, 6.0], normal = [1.0, 0.0] }'
"""An end that is a place of a deck, as a case writes it."""


@dataclass(frozen=True, slots=True)
class Decks:
    """What ``[[deck]]`` and ``[[joint]]`` stand for.

    Parameters
    ----------
    decks : tuple of Deck
        Their shapes.
    bodies : tuple of Body
        Three of each deck.
    contacts : tuple of Contact
        Two of each joint.
    """

    decks: tuple[Deck, ...] = ()
    bodies: tuple[Body, ...] = ()
    contacts: tuple[Contact, ...] = ()


def read_decks(decks: Sequence[Table], joints: Sequence[Table]) -> Decks:
    """Decks and joints from their tables; what has problems is left out, and they are noted."""
    read = [(_read_deck(table), _read_start(table)) for table in decks]
    for table in decks:
        table.close()
    joined = [_read_joint(table) for table in joints]
    placed = _placed([deck for deck, _ in read], decks, [j for j in joined if j is not None])
    known = {deck.name: deck for deck in placed}
    contacts = list[Contact]()
    for table, joint in zip(joints, joined, strict=True):
        table.close()
        if joint is None:
            continue
        try:
            contacts += joint.contacts(known)
        except InputError as error:
            key, _, text = str(error).partition(": ")
            if not any(other.noted("name") for other in decks):
                table.report(key, text)
    bodies = (d.bodies(start) for d, (_, start) in zip(placed, read, strict=True))
    return Decks(placed, tuple(body for three in bodies for body in three), tuple(contacts))


def _read_deck(table: Table) -> Deck:
    """A deck, its centre at the origin where none is given."""
    name = table.text("name", "a name for the deck")
    centre = two_numbers(table, "centre", Dimension.LENGTH, _PLACE)
    numbers: Mapping[str, Any] = read_numbers(table, Deck)
    return Deck(name, centre=centre, **numbers)


def _read_start(table: Table) -> DeckStart:
    own = table.table("initial")
    found = DeckStart(
        two_numbers(own, "displacement", Dimension.LENGTH, _PLACE),
        two_numbers(own, "velocity", Dimension.VELOCITY, _SPEEDS),
        own.quantity("rotation", Dimension.ANGLE, 0.0),
        own.quantity("spin", Dimension.ANGULAR_FREQUENCY, 0.0),
    )
    own.close()
    return found


def _read_joint(table: Table) -> Joint | None:
    """A joint; None with problems noted."""
    first, second = table.pair("between", _ENDS)
    name = table.text("name", "some text", f"{first}-{second}")
    if isinstance(table.data.get("gap"), list):
        gap = two_numbers(
            table, "gap", Dimension.LENGTH, "a gap, or those at the [lower, upper] end (m)"
        )
    else:
        gap = (table.quantity("gap", Dimension.LENGTH),) * 2
    restitution = table.quantity("restitution", Dimension.NUMBER)
    friction = table.quantity("friction", Dimension.NUMBER, 0.0)
    if not (first and second and gap[0] == gap[0]):
        return None
    return Joint(name, (first, second), gap, restitution, friction)


def two_numbers(table: Table, key: str, dimension: Dimension, accepted: str) -> tuple[float, float]:
    """Two numbers, zero where they are not given or wrong."""
    if not table.has(key):
        return 0.0, 0.0
    given = table.data[key]
    if not isinstance(given, list) or len(given) != 2:
        table.reject(key, accepted)
        return 0.0, 0.0
    with table.noting(key):
        first, second = (quantity(each, dimension) for each in given)
        return first, second
    return 0.0, 0.0


def _placed(
    decks: Sequence[Deck], tables: Sequence[Table], joints: Sequence[Joint]
) -> tuple[Deck, ...]:
    """Decks where they are: end to end, where no table has a centre."""
    if any(table.has("centre") for table in tables):
        for table in tables:
            if not table.has("centre"):
                table.report_missing("centre", f"{_PLACE}, as other decks have one; or none of any")
        return tuple(decks)
    between = {joint.between: joint.gap for joint in joints}
    pairs = ((one.name, other.name) for one, other in pairwise(decks))
    gaps = [0.5 * sum(between.get(pair, (0.0, 0.0))) for pair in pairs]
    places = place_in_a_row(decks, gaps)
    return tuple(replace(deck, centre=at) for deck, at in zip(decks, places, strict=True))


def place_of_deck(given: Mapping[str, Any], decks: Mapping[str, Deck]) -> PlanPoint:
    """An end that is a place of a deck.

    Raises
    ------
    InputError
        Where it is none.
    """
    deck = decks.get(str(given.get("deck")))
    pairs = [given.get("at"), given.get("normal")]
    good = all(isinstance(p, list) and len(p) == 2 for p in pairs)
    if deck is None or not good or not given.keys() <= {"deck", "at", "normal", "radius"}:
        known = ", ".join(decks) or "none"
        raise InputError(f"found {dict(given)!r}; accepted: {PLACE_OF_DECK}, of the decks {known}")
    radius = given.get("radius", deck.radius)
    return PlanPoint(deck.name, tuple(given["at"]), tuple(given["normal"]), radius)


def deck_tables(decks: Sequence[Deck], bodies: Mapping[str, Body]) -> list[dict[str, object]]:
    """Tables of decks in SI, with the states of their bodies, which are by name."""
    found = list[dict[str, object]]()
    for deck in decks:
        x, y, turn = (bodies[coordinate_of(deck.name, word)] for word in DIRECTIONS)
        shape = {"inertia": deck.inertia} if deck.inertia is not None else {}
        found.append(
            {
                "name": deck.name,
                "mass": deck.mass,
                "length": deck.length,
                "width": deck.width,
                "skew": deck.skew,
                "centre": list(deck.centre),
                **shape,
                "initial": {
                    "displacement": [x.displacement, y.displacement],
                    "velocity": [x.velocity, y.velocity],
                    "rotation": turn.displacement / deck.radius,
                    "spin": turn.velocity / deck.radius,
                },
            }
        )
    return found


def is_of_deck(name: str, decks: Sequence[Deck]) -> bool:
    """Whether a body is a coordinate of a deck."""
    return any(name == coordinate_of(deck.name, word) for deck in decks for word in DIRECTIONS)
