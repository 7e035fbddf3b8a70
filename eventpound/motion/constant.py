"""Histories that only forces have: a constant, and a sine with a phase, as half of one."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar

import numpy as np

from eventpound.basics.given import Number, converting_base, default, read_fields
from eventpound.motion.base import Family, Piece, Scales
from eventpound.motion.harmonic import Harmonic
from eventpound.motion.parametric import Sinusoid, require_finite
from eventpound.numerics.arrays import Floats
from eventpound.units import Dimension


@converting_base()
class Constant:
    """The same value at all times.

    Parameters
    ----------
    value : float
        In N for a force, in m/s² for one of each unit of mass.

    Raises
    ------
    InputError
        For a value that is not finite.
    """

    value: float

    def __post_init__(self) -> None:
        read_fields(self)
        require_finite(self.kind, "value", self.value)

    kind: ClassVar[str] = "constant"
    """The word for it."""

    @property
    def end(self) -> float:
        """It has no end, and nothing to wait for (s)."""
        return -math.inf

    def pieces(self) -> list[Piece]:
        """One piece: a cubic of the first coefficient alone, without decay."""
        numbers = np.array([0.0, 0.0, self.value, 0.0, 0.0, 0.0])
        return [Piece(-math.inf, math.inf, Family.GAUSSIAN, numbers)]

    def acceleration(self, t: Floats) -> Floats:
        """The value, shape of `t`."""
        return np.full(np.shape(t), self.value)

    def velocity(self, t: Floats) -> Floats:
        """Its integral from t = 0, shape of `t`."""
        return self.value * np.asarray(t, dtype=float)

    def displacement(self, t: Floats) -> Floats:
        """Its second integral from t = 0, shape of `t`."""
        return 0.5 * self.value * np.asarray(t, dtype=float) ** 2

    def scales(self) -> Scales | None:
        """None: it has no period."""
        return None


@converting_base()
class PhasedSine(Harmonic):
    """``a_p sin(w_p s + phase)`` from `start` on, for some periods or without end.

    Parameters
    ----------
    amplitude, period, reverse, start, cycles
        As for `Harmonic`; a force has its amplitude in N, and half a sine 0.5 cycles.
    phase : float
        At the start (rad).
    """

    phase: Annotated[Number, Dimension.ANGLE, require_finite] = default(0.0)

    def sinusoids(self) -> tuple[Sinusoid, ...]:
        """The sine as a cosine: sin x = cos(x - pi/2)."""
        return (Sinusoid(self.signed_amplitude, self.omega, self.phase - 0.5 * math.pi),)
