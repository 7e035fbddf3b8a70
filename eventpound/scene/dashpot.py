"""A linear viscous dashpot between two bodies or a body and the ground."""

from __future__ import annotations

import math
from dataclasses import dataclass

from eventpound.errors import InputError
from eventpound.units import Dimension, quantity, read_fields


@dataclass(frozen=True, slots=True)
class Dashpot:
    """Force ``c x'`` against the rate of the elongation ``x = u_second - u_first``.

    Parameters
    ----------
    between : tuple of str
        Names of the first and the second end; one may be ``"ground"``.
    coefficient : float
        c (N s/m), not negative; or a string with a unit, ``"1743 kN s/m"``.
    """

    between: tuple[str, str]
    coefficient: float

    def __post_init__(self) -> None:
        read_fields(self, coefficient=Dimension.DAMPING)

    @classmethod
    def from_ratio(
        cls, between: tuple[str, str], ratio: float | str, stiffness: float | str, mass: float | str
    ) -> Dashpot:
        """Dashpot with ``c = 2 ratio sqrt(stiffness mass)``.

        Parameters
        ----------
        between : tuple of str
            Names of the first and the second end; one may be ``"ground"``.
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
        """
        k, m = quantity(stiffness, Dimension.STIFFNESS), quantity(mass, Dimension.MASS)
        if min(k, m) < 0.0:
            raise InputError(f"found stiffness {k!r} and mass {m!r}; accepted: neither negative")
        return cls(between, 2.0 * quantity(ratio, Dimension.NUMBER) * math.sqrt(k * m))
