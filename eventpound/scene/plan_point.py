"""A place of a deck in plan, in a direction: an end of what pushes or pulls there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from eventpound.basics.given import converting
from eventpound.scene.point import Weights
from eventpound.units import Dimension

ALONG, ACROSS, TURN = "x", "y", "turn"
DIRECTIONS = ALONG, ACROSS, TURN
"""What a body does: it moves along the first axis, along the second, or turns in plan."""
_Length = Annotated[float, Dimension.LENGTH]
_Part = Annotated[float, Dimension.NUMBER]


def coordinate_of(deck: str, direction: str) -> str:
    """Name of the body that one of the three coordinates of a deck is."""
    return f"{deck}.{direction}"


@converting
class PlanPoint:
    """By how much a place of a deck moves in a direction: ``n_x u + n_y v + (x n_y - y n_x) θ``.

    Displacements are small: the place at (x, y) moves by (u - θ y, v + θ x).

    Parameters
    ----------
    deck : str
        Name of the deck.
    at : tuple of float
        x and y from its centre (m).
    normal : tuple of float
        n_x and n_y, of length one.
    radius : float
        Length r (m) by which the turn of the deck is a displacement, ``r θ`` (`Deck.radius`).
    """

    deck: str
    at: tuple[_Length, _Length]
    normal: tuple[_Part, _Part]
    radius: _Length

    @property
    def parts(self) -> Weights:
        """The bodies of the deck that move it in that direction, and by which part."""
        (x, y), (n_x, n_y) = self.at, self.normal
        parts = (ALONG, n_x), (ACROSS, n_y), (TURN, (x * n_y - y * n_x) / self.radius)
        return tuple((coordinate_of(self.deck, word), part) for word, part in parts if part != 0.0)

    @property
    def label(self) -> str:
        """Its deck, as a name of what it is an end of has it."""
        return self.deck

    @property
    def written(self) -> dict[str, object]:
        """Itself as a case writes it."""
        at, normal = list(self.at), list(self.normal)
        return {"deck": self.deck, "at": at, "normal": normal, "radius": self.radius}

    def renamed(self, names: Mapping[str, str]) -> PlanPoint:
        """Itself: what it is of is no end by itself."""
        return self

    @property
    def tangent(self) -> PlanPoint:
        """The same place in the direction that is a quarter turn to the left."""
        n_x, n_y = self.normal
        return PlanPoint(self.deck, self.at, (-n_y, n_x), self.radius)

    def __str__(self) -> str:
        return " + ".join(f"{weight:.6g} {name}" for name, weight in self.parts)
