"""Harmonic ground motion.

    a = a_p sin(omega_p s),    omega_p = 2 pi / T_p,    s = t - start >= 0

for `cycles` periods, or without end (a_p in m/s^2, T_p in s).
"""

from __future__ import annotations

import math
from typing import Annotated, ClassVar

from eventpound.basics.given import OptionalNumber, converting_base, default
from eventpound.motion.parametric import SinusoidMotion, require_positive
from eventpound.units import Dimension


@converting_base()
class Harmonic(SinusoidMotion):
    """A sine that goes on.

    Parameters
    ----------
    amplitude, period, reverse, start
        As for `Parametric`.
    cycles : float, optional
        Periods it lasts, positive and not necessarily whole; None: endless.

    Raises
    ------
    InputError
        Also for `cycles` that is not a positive number.
    """

    cycles: Annotated[OptionalNumber, Dimension.NUMBER, require_positive] = default(None)

    kind: ClassVar[str] = "harmonic"
    """The word a case names it by."""

    @property
    def duration(self) -> float:
        """The cycles times T_p (s), or inf."""
        return math.inf if self.cycles is None else self.cycles * self.period
