"""A joint in plan: two end edges that face each other, and the contacts that part them.

Edges of one skew are parallel, so the gap between them is linear along the stretch over which
they face each other: it closes at an end of that first, and what does not close at either end is
open. So a joint is two contacts, ``lower`` and ``upper``, at its ends. There a corner of one deck
strikes the edge of the other, or, where both decks are as wide, the other's corner; a third
contact would have a gap between those of the two.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated

from eventpound.basics.given import Given, Number, converting, default, number, read_fields
from eventpound.errors import InputError
from eventpound.scene.contact import BARRIER, Contact
from eventpound.scene.deck import Deck, Side, facing
from eventpound.scene.ends import End
from eventpound.tolerances import OUT_OF_PLACE, PARALLEL
from eventpound.units import Dimension

ENDS = "lower", "upper"
"""Of a joint, as y grows: what its contacts are called after its own name."""
_Gap = float | str
_Gaps = tuple[Annotated[float, Dimension.LENGTH], Annotated[float, Dimension.LENGTH]]


@converting
class Joint:
    """Two edges that face each other, or one and a barrier such as an abutment's wall.

    Parameters
    ----------
    name : str
        Its contacts are ``NAME.lower`` and ``NAME.upper``.
    between : tuple of str
        The left and the right deck; ``"barrier"`` may be one of them.
    gap : float, or tuple of two
        At right angles to the edges (m); two are those at the lower and at the upper end.
    restitution : float
        Newton's coefficient, 0 to 1.
    friction : float, optional
        Coulomb's coefficient μ of what slides along the edges.
    """

    name: str
    between: tuple[str, str]
    gap: Given[_Gaps, _Gap | tuple[_Gap, _Gap]]
    restitution: Annotated[Number, Dimension.NUMBER]
    friction: Annotated[Number, Dimension.NUMBER] = default(0.0)

    def __post_init__(self) -> None:
        given: object = self.gap
        if not isinstance(given, list | tuple):
            width = number("Joint: gap", given, Dimension.LENGTH)
            object.__setattr__(self, "gap", (width, width))
        read_fields(self)

    def contacts(self, decks: Mapping[str, Deck]) -> tuple[Contact, Contact]:
        """Its contacts, of decks by their names.

        Raises
        ------
        InputError
            Where it is between no decks, or between edges that do not face each other.
        """
        left, right = (self._deck(name, decks) for name in self.between)
        if left is None and right is None:
            raise InputError(f"between: found {list(self.between)}; accepted: a deck at one end")
        if left is not None and right is not None:
            self._check_facing(left, right)
            low, high = facing(left, right)
        else:
            own = left or right
            assert own is not None
            low, high = (own.centre[1] + part * own.width for part in (-0.5, 0.5))
        lower, upper = (
            Contact(
                f"{self.name}.{word}",
                _end(left, "right", 1.0, y),
                _end(right, "left", -1.0, y),
                gap,
                self.restitution,
                friction=self.friction,
            )
            for word, y, gap in zip(ENDS, (low, high), self.gap, strict=True)
        )
        return lower, upper

    def _deck(self, name: str, decks: Mapping[str, Deck]) -> Deck | None:
        if name != BARRIER and name not in decks:
            accepted = ", ".join([*decks, BARRIER])
            raise InputError(f"between: found {name!r}; accepted: two different ones of {accepted}")
        return decks.get(name)

    def _check_facing(self, left: Deck, right: Deck) -> None:
        """Refuse edges that are not parallel, or not where the gap says."""
        if left is right:
            raise InputError(f"between: found {left.name!r} twice; accepted: two different decks")
        if abs(left.skew - right.skew) > PARALLEL:
            raise InputError(
                f"between: found skews of {math.degrees(left.skew):.6g} and "
                f"{math.degrees(right.skew):.6g} degrees; accepted: decks of one skew, whose edges "
                "are parallel"
            )
        along = right.centre[0] - left.centre[0] - 0.5 * (left.length + right.length)
        along += (right.centre[1] - left.centre[1]) * math.tan(left.skew)
        apart, gap = along * math.cos(left.skew), 0.5 * sum(self.gap)
        if abs(apart - gap) > OUT_OF_PLACE * min(left.length, right.length):
            raise InputError(
                f"gap: found {gap:.6g} m, but the centres of {left.name!r} and {right.name!r} part "
                f"their edges by {apart:.6g} m; accepted: centres with that gap between the edges"
            )


def _end(deck: Deck | None, side: Side, way: float, y: float) -> End:
    """End of a contact at an edge, so far across in the plan (m); both look to the right."""
    if deck is None:
        return BARRIER
    n_x, n_y = deck.normal(side)
    return deck.toward(deck.on_edge(side, y - deck.centre[1]), (way * n_x, way * n_y))
