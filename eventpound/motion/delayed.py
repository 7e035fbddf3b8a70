"""A motion that comes later, as where a wave passes; and how far motions have gone.

Displacements of supports are compared, so each is counted from rest: that of a Ricker
wavelet from -inf, where it has begun, and not from its `start`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from eventpound.motion.base import GroundMotion, Piece, Scales
from eventpound.motion.ricker import AntisymmetricRicker, Ricker
from eventpound.numerics.arrays import Floats


@dataclass(frozen=True)
class Delayed:
    """``a(t) = a_ref(t - delay)``, center and jumps with it.

    Parameters
    ----------
    motion : GroundMotion
        a_ref.
    delay : float
        How much later (s).
    """

    motion: GroundMotion
    delay: float

    @property
    def kind(self) -> str:
        """The word a case names the motion by."""
        return self.motion.kind

    @property
    def end(self) -> float:
        """Time after which the acceleration stays zero (s)."""
        return self.motion.end + self.delay

    def pieces(self) -> list[Piece]:
        """The pieces of the motion, later."""
        return [self._later(piece) for piece in self.motion.pieces()]

    def _later(self, piece: Piece) -> Piece:
        """Every formula counts its time from its first number."""
        numbers = piece.coefficients.copy()
        numbers[:1] += self.delay
        return replace(
            piece, start=piece.start + self.delay, end=piece.end + self.delay, coefficients=numbers
        )

    def acceleration(self, t: Floats) -> Floats:
        """Acceleration, shape of `t` (m/s^2)."""
        t = np.asarray(t, dtype=float)
        borders = np.array([piece.start for piece in self.motion.pieces()[1:]])
        place = np.searchsorted(borders + self.delay, t, "right")
        # t - delay rounds, perhaps to the other side of a jump.
        low = np.append(-np.inf, borders)[place]
        high = np.nextafter(np.append(borders, np.inf), -np.inf)[place]
        return self.motion.acceleration(np.clip(t - self.delay, low, high))

    def velocity(self, t: Floats) -> Floats:
        """Velocity, shape of `t` (m/s)."""
        return self.motion.velocity(np.asarray(t) - self.delay)

    def displacement(self, t: Floats) -> Floats:
        """Displacement, shape of `t` (m)."""
        return self.motion.displacement(np.asarray(t) - self.delay)

    def scales(self) -> Scales | None:
        """Those of the motion."""
        return self.motion.scales()


def travelled(motion: GroundMotion, t: Floats) -> tuple[Floats, Floats]:
    """Displacement (m) and velocity (m/s) of a motion that began at rest, shape of `t` (s)."""
    t = np.asarray(t, dtype=float)
    if isinstance(motion, Delayed):
        return travelled(motion.motion, t - motion.delay)
    if isinstance(motion, Ricker | AntisymmetricRicker):
        velocity, displacement = motion.integrals(t - motion.middle)
        return displacement, velocity
    return motion.displacement(t), motion.velocity(t)
