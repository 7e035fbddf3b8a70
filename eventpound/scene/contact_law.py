"""Contact elements as laws: a force for an overlap d = -g > 0 of the bodies and its rate d'.

    linear        F = k d
    kelvin-voigt  F = k d + c d',  c = 2 ζ sqrt(k m)
    hertz         F = k d^(3/2)
    hertz-damp    F = k d^(3/2) [1 + a d'/d'_0]
    jankowski     F = k d^(3/2) + c d' while d' > 0,  c = 2 ξ sqrt(k sqrt(d) m);
                  F = k d^(3/2) while d' <= 0

m is the effective mass of the two bodies, at a barrier that of the body; d'_0 the rate at which
the contact closed. ζ, a and ξ are given, or follow from a coefficient of restitution e:

    ζ = -ln e / sqrt(π² + ln² e)
        S. A. Anagnostopoulos, Earthq. Eng. Struct. Dyn. 16, 1988, 443-456
    a = 3 (1 - e²) / 4
        S. Muthukumar, R. DesRoches, Earthq. Eng. Struct. Dyn. 35, 2006, 811-828
    ξ = (9 √5 / 2) (1 - e²) / (e (e (9 π - 16) + 16))
        R. Jankowski, Earthq. Eng. Struct. Dyn. 34, 2005, 595-611 (the element);
        35, 2006, 517-524 (ξ)
"""

from __future__ import annotations

import math
from enum import IntEnum
from typing import Annotated

from eventpound.basics.given import Number, OptionalNumber, converting, default, read_fields
from eventpound.units import Dimension

NEWTON = "newton"
"""What a case calls the law of impact that no element stands for."""
POISSON = "poisson"
"""What it calls the other one, of impacts with friction."""
IMPACT_LAWS = NEWTON, POISSON


class Element(IntEnum):
    """The contact elements."""

    LINEAR = 0
    KELVIN_VOIGT = 1
    HERTZ = 2
    HERTZ_DAMP = 3
    JANKOWSKI = 4

    @property
    def word(self) -> str:
        """What a case calls it."""
        return self.name.lower().replace("_", "-")

    @property
    def hertzian(self) -> bool:
        """Whether its stiffness is in N/m^(3/2)."""
        return self >= Element.HERTZ

    @property
    def damped(self) -> bool:
        """Whether it loses energy, by a constant that may follow from a restitution."""
        return self not in (Element.LINEAR, Element.HERTZ)

    @property
    def symbol(self) -> str:
        """Its constant of damping, empty where it has none."""
        return _SYMBOLS.get(self, "")

    @property
    def dimension(self) -> Dimension:
        """Of its stiffness."""
        return Dimension.HERTZ_STIFFNESS if self.hertzian else Dimension.STIFFNESS


_SYMBOLS = {Element.KELVIN_VOIGT: "ζ", Element.HERTZ_DAMP: "a", Element.JANKOWSKI: "ξ"}
BY_WORD = {element.word: element for element in Element}
"""The elements by what a case calls them."""


@converting
class ContactLaw:
    """The law of a contact that is an element.

    Parameters
    ----------
    kind : str
        ``"linear"``, ``"kelvin-voigt"``, ``"hertz"``, ``"hertz-damp"`` or ``"jankowski"``.
    stiffness : float
        k, positive (N/m; of the last three N/m^1.5); or a string with a unit.
    damping : float, optional
        ζ, a or ξ, not negative; in the place of the contact's restitution.
    tension : bool
        Whether a ``"kelvin-voigt"`` contact may pull; without, its force is cut at zero.
    """

    kind: str
    stiffness: Annotated[Number, Dimension.STIFFNESS]
    damping: Annotated[OptionalNumber, Dimension.NUMBER] = default(None)
    tension: bool = True

    def __post_init__(self) -> None:
        element = BY_WORD.get(self.kind) if isinstance(self.kind, str) else None
        if element is None:
            read_fields(self)
        else:
            read_fields(self, stiffness=element.dimension)

    @property
    def element(self) -> Element:
        """Which element it is."""
        return BY_WORD[self.kind]


def damping_constant(element: Element, restitution: float) -> float:
    """ζ, a or ξ for a coefficient of restitution, 0 for an element without.

    Parameters
    ----------
    element : Element
        Which.
    restitution : float
        e, from 0 to 1; ζ has its limit for 0, and ξ none.
    """
    if element is Element.KELVIN_VOIGT:
        return kelvin_voigt_ratio(restitution)
    if element is Element.HERTZ_DAMP:
        return 0.75 * (1.0 - restitution**2)
    if element is Element.JANKOWSKI:
        return jankowski_ratio(restitution)
    return 0.0


def kelvin_voigt_ratio(restitution: float) -> float:
    """ζ of Anagnostopoulos (1988); 1, its limit, for e = 0."""
    if restitution == 0.0:
        return 1.0
    logarithm = math.log(restitution)
    return -logarithm / math.hypot(math.pi, logarithm)


def jankowski_ratio(restitution: float) -> float:
    """ξ of Jankowski (2006) for a positive e."""
    e = restitution
    return 4.5 * math.sqrt(5.0) * (1.0 - e * e) / (e * (e * (9.0 * math.pi - 16.0) + 16.0))
