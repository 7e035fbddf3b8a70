"""A unilateral contact between two bodies, points between bodies, or one and a rigid barrier."""

from __future__ import annotations

from typing import Annotated

from eventpound.basics.given import (
    Accepted,
    Given,
    Number,
    OptionalNumber,
    converting,
    default,
    not_negative,
    read_fields,
)
from eventpound.scene.contact_law import ContactLaw, damping_constant
from eventpound.scene.ends import End, GivenEnd, Joining, read_ends
from eventpound.scene.plan_point import PlanPoint
from eventpound.units import Dimension

BARRIER = "barrier"


@converting
class Contact(Joining):
    """A gap that can close: ``g = gap + u_right - u_left``.

    A barrier moves with the ground, so its displacement is zero: with a
    barrier on the right ``g = gap - u_left``, on the left ``g = gap + u_right``.

    Parameters
    ----------
    name : str
        Unique among the contacts of the scene.
    left, right : str or Point
        Names of the bodies; one may be ``"barrier"``. Or points between bodies; a mapping of
        names to weights, ``{"B2": 0.4, "B3": 0.6}``, is one.
    gap : float
        Opening at zero displacements, delta (m); or a string with a unit, ``"1.27 cm"``.
    restitution : float, optional
        Newton's coefficient of restitution, 0 to 1; with a law what its constant of damping
        follows from.
    law : ContactLaw, optional
        A contact element in the place of Newton's law, under which the gap stays ``g >= 0``.
    friction : float, optional
        Coulomb's coefficient μ of what slides along it, between places of decks in plan.

    Examples
    --------
    >>> Contact("joint", "deck", "barrier", gap="1 cm", restitution=0.6).gap
    0.01
    """

    name: str
    left: Given[End, GivenEnd]
    right: Given[End, GivenEnd]
    gap: Annotated[Number, Dimension.LENGTH, Accepted("a length (m)")]
    restitution: Annotated[OptionalNumber, Dimension.NUMBER] = default(None)
    law: ContactLaw | None = None
    friction: Annotated[Number, Dimension.NUMBER, Accepted("a number >= 0", not_negative)] = (
        default(0.0)
    )

    def __post_init__(self) -> None:
        for side in ("left", "right"):
            read_ends(self, side)
        read_fields(self)

    @property
    def damping(self) -> float | None:
        """ζ, a or ξ of its law, as given or from its restitution; None for Newton's."""
        if self.law is None:
            return None
        if self.law.damping is not None:
            return self.law.damping
        return damping_constant(self.law.element, self.restitution or 0.0)

    @property
    def sides(self) -> tuple[End, End]:
        """Its left and its right end."""
        return self.left, self.right

    @property
    def tangent(self) -> tuple[End, End]:
        """Its ends as they move along it, a quarter turn to the left of how they close it."""
        left, right = (e.tangent if isinstance(e, PlanPoint) else e for e in self.sides)
        return left, right
