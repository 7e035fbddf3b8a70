"""A linear viscous dashpot between two bodies, points between bodies, or one and the ground."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated

from eventpound.basics.given import (
    Accepted,
    Given,
    Number,
    checked,
    converting,
    number,
    read_fields,
)
from eventpound.errors import InputError
from eventpound.scene.ends import End, GivenEnd, Joining, read_ends
from eventpound.units import Dimension


@converting
class Dashpot(Joining):
    """Force ``c x'`` against the rate of the elongation ``x = u_second - u_first``.

    Parameters
    ----------
    between : tuple of str or Point
        Names of the first and the second end, or points between bodies, as of a `Spring`.
    coefficient : float
        c (N s/m), or a string with a unit, ``"1743 kN s/m"``. Negative only where all dashpots of
        the scene together never drive a motion, as those of `eventpound.modal_damping`.
    """

    between: Given[tuple[End, End], Sequence[GivenEnd]]
    coefficient: Annotated[Number, Dimension.DAMPING, Accepted("a coefficient (N s/m)")]

    def __post_init__(self) -> None:
        read_ends(self, "between")
        read_fields(self)

    @property
    def sides(self) -> tuple[End, End]:
        """Its first and its second end."""
        return self.between

    @classmethod
    @checked
    def from_ratio(
        cls,
        between: Sequence[GivenEnd],
        ratio: float | str,
        stiffness: float | str,
        mass: float | str,
    ) -> Dashpot:
        """Dashpot with ``c = 2 ratio sqrt(stiffness mass)``.

        Parameters
        ----------
        between : tuple of str or Point
            As of the class.
        ratio : float
            Of critical damping, 0.05 or ``"5 %"``.
        stiffness : float
            The ratio refers to this stiffness (N/m).
        mass : float
            And to this mass (kg).

        Raises
        ------
        InputError
            Where a string is no such number, or a product is negative.

        Examples
        --------
        >>> round(Dashpot.from_ratio(("ground", "deck"), "5 %", "100 MN/m", "1000 t").coefficient)
        1000000
        """
        k = number("stiffness", stiffness, Dimension.STIFFNESS)
        m = number("mass", mass, Dimension.MASS)
        if min(k, m) < 0.0:
            raise InputError(f"found stiffness {k!r} and mass {m!r}; accepted: neither negative")
        return cls(between, 2.0 * number("ratio", ratio, Dimension.NUMBER) * math.sqrt(k * m))
