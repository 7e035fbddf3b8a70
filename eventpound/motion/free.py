"""No ground motion: the bodies move from their initial state."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eventpound.motion.base import Family, Piece, Scales
from eventpound.numerics.arrays import Floats


@dataclass(frozen=True, slots=True)
class NoMotion:
    """No ground motion: bodies move from their initial state. It has no scales a_g and omega_g."""

    kind: ClassVar[str] = "none"
    """The word a case names it by."""

    @property
    def end(self) -> float:
        """Time after which the acceleration stays zero (s)."""
        return 0.0

    def pieces(self) -> list[Piece]:
        """One piece, zero throughout."""
        return [Piece(-math.inf, math.inf, Family.ZERO)]

    def acceleration(self, t: Floats) -> Floats:
        """Zero, shape of `t` (m/s^2)."""
        return np.zeros(np.shape(t))

    def velocity(self, t: Floats) -> Floats:
        """Zero, shape of `t` (m/s)."""
        return np.zeros(np.shape(t))

    def displacement(self, t: Floats) -> Floats:
        """Zero, shape of `t` (m)."""
        return np.zeros(np.shape(t))

    def scales(self) -> Scales | None:
        """None: there is nothing to scale by."""
        return None
