"""A linear viscous dashpot between two bodies or a body and the ground."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Dashpot:
    """Force ``c x'`` against the rate of the elongation ``x = u_second - u_first``.

    Parameters
    ----------
    between : tuple of str
        Names of the first and the second end; one may be ``"ground"``.
    coefficient : float
        c (N s/m), not negative.
    """

    between: tuple[str, str]
    coefficient: float
