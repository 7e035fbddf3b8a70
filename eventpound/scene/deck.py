"""Decks in plan: their shape, and the three bodies that one is.

A deck is a parallelogram: its length L along x, its width W across, its two end edges turned by
the skew angle α from the perpendicular (positive to the left, counter-clockwise):

    corners        x = ±L/2 - y tan α at y = ±W/2
    edges          run along (-sin α, cos α); the normal of the right one is (cos α, sin α)
    inertia        J = m (L² + W²/cos² α)/12, by integration over x = ξ - y tan α; that of a
                   rectangle where α = 0

It moves by u and v of its centre and a small turn θ, counter-clockwise, in coordinates NAME.x,
NAME.y and NAME.turn. The last is ``r θ``, a length, with ``r = sqrt(J/m)``: so all three have the
mass m, and one scale serves for lengths.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Literal, NamedTuple

from eventpound.basics.given import (
    Accepted,
    Number,
    OptionalNumber,
    above_zero,
    converting,
    default,
)
from eventpound.errors import InputError
from eventpound.scene.body import Body
from eventpound.scene.plan_point import ACROSS, ALONG, TURN, PlanPoint, coordinate_of
from eventpound.tolerances import MOST_SKEW
from eventpound.units import Dimension

Side = Literal["left", "right"]
SIDES: tuple[Side, Side] = "left", "right"
"""End edges of a deck."""
CORNERS = "left-lower", "right-lower", "right-upper", "left-upper"
"""Of a deck, counter-clockwise, lower being where y is less."""
_Length = Annotated[float | str, Dimension.LENGTH]
_Place = tuple[Annotated[float, Dimension.LENGTH], Annotated[float, Dimension.LENGTH]]
_POSITIVE = Accepted("a positive length (m)", above_zero)
_SKEW = Accepted(
    f"an angle within {math.degrees(MOST_SKEW):.0f} degrees of zero (rad)",
    lambda deck, angle: abs(angle) <= MOST_SKEW,
)


class DeckStart(NamedTuple):
    """State of a deck at the start: of its centre (m, m/s), and its turn (rad, rad/s)."""

    displacement: tuple[float, float] = (0.0, 0.0)
    velocity: tuple[float, float] = (0.0, 0.0)
    rotation: float = 0.0
    spin: float = 0.0


@converting
class Deck:
    """A rigid deck in plan: its shape and its mass.

    It moves nothing by itself: `bodies` are what a `Scene` has in its place.

    Parameters
    ----------
    name : str
        Unique among the decks.
    mass : float
        m (kg).
    length, width : float
        L along x and W across, between the edges and the sides (m).
    skew : float
        α (rad), or a string, ``"30 deg"``.
    centre : tuple of float
        Where its centre of mass is in the plan (m): the arms of what touches follow from it.
    inertia : float, optional
        J about its centre (kg m²); without it that of a parallelogram of even mass.

    Examples
    --------
    >>> Deck("span", "1200 t", "40 m", "12 m").inertia_about_centre
    174400000.0
    """

    name: str
    mass: Annotated[Number, Dimension.MASS, Accepted("a positive mass (kg)", above_zero)]
    length: Annotated[Number, Dimension.LENGTH, _POSITIVE]
    width: Annotated[Number, Dimension.LENGTH, _POSITIVE]
    skew: Annotated[Number, Dimension.ANGLE, _SKEW] = default(0.0)
    centre: _Place = (0.0, 0.0)
    inertia: Annotated[
        OptionalNumber, Dimension.INERTIA, Accepted("a positive moment (kg m²)", above_zero)
    ] = default(None)

    @property
    def inertia_about_centre(self) -> float:
        """J (kg m²), as given or from its shape."""
        if self.inertia is not None:
            return self.inertia
        return self.mass * (self.length**2 + (self.width / math.cos(self.skew)) ** 2) / 12.0

    @property
    def radius(self) -> float:
        """Radius of gyration r (m); 1 where a scene refuses the mass or the moment."""
        inertia = self.inertia_about_centre
        return math.sqrt(inertia / self.mass) if self.mass > 0.0 and inertia > 0.0 else 1.0

    def normal(self, side: Side) -> tuple[float, float]:
        """Of an end edge, outwards."""
        way = 1.0 if side == "right" else -1.0
        return way * math.cos(self.skew), way * math.sin(self.skew)

    def on_edge(self, side: Side, y: float) -> tuple[float, float]:
        """Place of an end edge, from the centre, that is so far across (m)."""
        half = 0.5 * self.length if side == "right" else -0.5 * self.length
        return half - y * math.tan(self.skew), y

    @property
    def corners(self) -> tuple[tuple[float, float], ...]:
        """Where its `CORNERS` are from the centre (m)."""
        low, high = -0.5 * self.width, 0.5 * self.width
        places: tuple[tuple[Side, float], ...]
        places = ("left", low), ("right", low), ("right", high), ("left", high)
        return tuple(self.on_edge(side, y) for side, y in places)

    def toward(self, at: tuple[float, float], normal: tuple[float, float]) -> PlanPoint:
        """What of its motion a place from its centre (m) has in a direction."""
        return PlanPoint(self.name, at, normal, self.radius)

    def bodies(self, start: DeckStart | None = None) -> tuple[Body, Body, Body]:
        """Its three coordinates, as bodies of a scene."""
        at, r = start or DeckStart(), self.radius
        states = (
            (ALONG, at.displacement[0], at.velocity[0]),
            (ACROSS, at.displacement[1], at.velocity[1]),
            (TURN, r * at.rotation, r * at.spin),
        )
        x, y, turn = (
            Body(coordinate_of(self.name, word), self.mass, u, v, self.name, word)
            for word, u, v in states
        )
        return x, y, turn


def place_in_a_row(decks: Sequence[Deck], gaps: Sequence[float]) -> list[tuple[float, float]]:
    """Centres (m) of decks end to end, the first at the origin.

    Parameters
    ----------
    decks : sequence of Deck
        From the left.
    gaps : sequence of float
        Between each two, at right angles to the edges (m).
    """
    found, x = list[tuple[float, float]](), 0.0
    for i, deck in enumerate(decks):
        if i > 0:
            # Along x an edge that is turned is further away.
            x += 0.5 * (decks[i - 1].length + deck.length) + gaps[i - 1] / math.cos(deck.skew)
        found.append((x, 0.0))
    return found


def facing(left: Deck, right: Deck) -> tuple[float, float]:
    """Lower and upper end (y in the plan, m) of the stretch over which two edges face each other.

    Raises
    ------
    InputError
        Where they do not.
    """
    low = max(deck.centre[1] - 0.5 * deck.width for deck in (left, right))
    high = min(deck.centre[1] + 0.5 * deck.width for deck in (left, right))
    if not high > low:
        raise InputError(
            f"found decks {left.name!r} and {right.name!r} side by side, whose edges do not face "
            "each other; accepted: centres less far apart across than half their widths"
        )
    return low, high
