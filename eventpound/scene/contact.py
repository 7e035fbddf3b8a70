"""A unilateral contact between two bodies, points between bodies, or one and a rigid barrier."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated

from eventpound.basics.given import (
    Accepted,
    Given,
    Number,
    OptionalNumber,
    converting,
    default,
    read_fields,
)
from eventpound.errors import told_of
from eventpound.numerics.arrays import Floats
from eventpound.scene.contact_law import ContactLaw, damping_constant
from eventpound.scene.point import Point
from eventpound.units import Dimension

BARRIER = "barrier"
End = str | Point
"""An end of a contact: the name of a body, ``"barrier"``, or a point between bodies."""


@converting
class Contact:
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

    Examples
    --------
    >>> Contact("joint", "deck", "barrier", gap="1 cm", restitution=0.6).gap
    0.01
    """

    name: str
    left: Given[End, End | Mapping[str, float | str]]
    right: Given[End, End | Mapping[str, float | str]]
    gap: Annotated[Number, Dimension.LENGTH, Accepted("a length (m)")]
    restitution: Annotated[OptionalNumber, Dimension.NUMBER] = default(None)
    law: ContactLaw | None = None

    def __post_init__(self) -> None:
        for side in ("left", "right"):
            end = getattr(self, side)
            if isinstance(end, Mapping):
                with told_of(f"Contact: {side}: "):
                    object.__setattr__(self, side, Point(end))
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
    def at_point(self) -> bool:
        """Whether an end of it is a point between bodies."""
        return isinstance(self.left, Point) or isinstance(self.right, Point)

    @property
    def ends(self) -> tuple[str, ...]:
        """Names of all that it is between, those of the left end first."""
        return tuple(name for end in (self.left, self.right) for name, _ in weights_of(end))

    @property
    def direction(self) -> tuple[tuple[str, float], ...]:
        """By how much each of its `ends` opens it: a column of W, as pairs."""
        return tuple(
            (name, sign * weight)
            for end, sign in ((self.left, -1.0), (self.right, 1.0))
            for name, weight in weights_of(end)
        )


def written(end: End) -> str | dict[str, float]:
    """An end as a case writes it."""
    return dict(end.weights) if isinstance(end, Point) else end


def weights_of(end: End) -> tuple[tuple[str, float], ...]:
    """Names and weights, 1 in sum, of an end of a contact; of a body or barrier the one it is."""
    if isinstance(end, str):
        return ((end, 1.0),)
    # One to rounding, so that a motion of all bodies together leaves the gap as it is.
    return tuple((name, weight / (end.total or 1.0)) for name, weight in end.weights)


def opening(
    contact: Contact, gap: Floats | float, displacements: Mapping[str, Floats | float]
) -> Floats | float:
    """Opening of a contact (m), numbers or columns; NaN at ends that have no displacement.

    Parameters
    ----------
    contact : Contact
        What is between which ends.
    gap : float or ndarray
        Its opening at zero displacements (m).
    displacements : mapping
        Of its ends, by their names (m).
    """
    # The right end first, as everywhere: rounding is the same.
    for end, weight in contact.direction[::-1]:
        gap = gap + weight * displacements.get(end, math.nan)
    return gap
