"""Bearings and piers of decks in plan, as the bodies, springs and dashpots that they are.

``[[pier]]``: a mass that moves both ways, on a spring and a dashpot each way to the ground.

``[[bearing]]``: `count` linear bearings spread evenly along an end edge of a deck, or one at a
place of it, each with a spring and a dashpot along x and across.

A stiffness or a dashpot is one for both directions, or a list [along, across].
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from eventpound.case.decks import Decks, two_numbers
from eventpound.case.table import Table
from eventpound.scene.body import Body
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.deck import SIDES, Deck
from eventpound.scene.ends import End
from eventpound.scene.plan_point import ACROSS, ALONG, PlanPoint, coordinate_of
from eventpound.scene.spring import GROUND, Linear, Spring
from eventpound.units import Dimension

_MOST = 100
_WAYS = {ALONG: (1.0, 0.0), ACROSS: (0.0, 1.0)}
_PLACE = "a place [x, y] from the centre of the deck (m)"


@dataclass
class Bearings:
    """What ``[[pier]]`` and ``[[bearing]]`` stand for, each with the table that it is of."""

    bodies: list[tuple[Body, Table]] = field(default_factory=list)
    springs: list[tuple[Spring, Table]] = field(default_factory=list)
    dashpots: list[tuple[Dashpot, Table]] = field(default_factory=list)

    def link(self, name: str, ends: Mapping[str, tuple[End, End]], table: Table) -> None:
        """Add a spring and a dashpot each way, by the stiffness and the damping of a table."""
        accepted = "a stiffness (N/m), or [along, across]"
        stiffness = _both_ways(table, "stiffness", Dimension.STIFFNESS, accepted)
        accepted = "a dashpot (N s/m), or [along, across]"
        damping = _both_ways(table, "damping", Dimension.DAMPING, accepted, 0.0)
        for word, k, c in zip(_WAYS, stiffness, damping, strict=True):
            self.springs.append((Spring(f"{name}.{word}", ends[word], Linear(k)), table))
            if c != 0.0:
                self.dashpots.append((Dashpot(ends[word], c), table))


def read_bearings(piers: Sequence[Table], bearings: Sequence[Table], decks: Decks) -> Bearings:
    """Piers and bearings from their tables; problems are noted."""
    found, names = Bearings(), list[str]()
    for table in piers:
        name = table.text("name", "a name for the pier")
        mass = table.quantity("mass", Dimension.MASS)
        names.append(name)
        found.bodies += [
            (Body(coordinate_of(name, word), mass, direction=word), table) for word in _WAYS
        ]
        found.link(name, {word: (GROUND, coordinate_of(name, word)) for word in _WAYS}, table)
        table.close()
    known = {deck.name: deck for deck in decks.decks}
    for i, table in enumerate(bearings, 1):
        name = table.text("name", "some text", f"bearing {i}")
        on = table.choice("on", names) if table.has("on") and table.data["on"] != GROUND else GROUND
        deck = known.get(table.choice("deck", list(known)))
        places = [] if deck is None else _places(table, deck)
        for number, at in enumerate(places, 1):
            assert deck is not None
            ends: dict[str, tuple[End, End]] = {
                word: (
                    GROUND if on == GROUND else coordinate_of(on, word),
                    PlanPoint(deck.name, at, normal, deck.radius),
                )
                for word, normal in _WAYS.items()
            }
            found.link(name if len(places) == 1 else f"{name}.{number}", ends, table)
        table.close()
    return found


def _places(table: Table, deck: Deck) -> list[tuple[float, float]]:
    """Where bearings are, from the centre of their deck (m)."""
    if table.has("at"):
        if table.has("side"):
            table.reject("side", "one of side and at")
        return [two_numbers(table, "at", Dimension.LENGTH, _PLACE)]
    word = table.choice("side", SIDES)
    count = (table.whole_number("count", 1, _MOST) if table.has("count") else 2) or 0
    side = next((side for side in SIDES if side == word), None)
    if side is None:
        return []
    # Each in the middle of its part of the edge.
    return [deck.on_edge(side, deck.width * ((i + 0.5) / count - 0.5)) for i in range(count)]


def _both_ways(
    table: Table, key: str, dimension: Dimension, accepted: str, usual: float | None = None
) -> tuple[float, float]:
    """Numbers along and across, positive; NaN where they are wrong."""
    if isinstance(table.data.get(key), list):
        both = two_numbers(table, key, dimension, accepted)
    else:
        both = (table.quantity(key, dimension, usual),) * 2
    if min(both) < 0.0:
        table.reject(key, "numbers that are not negative")
        return math.nan, math.nan
    return both
