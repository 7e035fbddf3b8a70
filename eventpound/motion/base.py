"""What every ground motion offers: values, smooth pieces and scales.

A motion is a sequence of pieces on each of which the acceleration is smooth
(or, for a record, linear between samples). Solvers integrate piece by piece,
so a jump of the acceleration is never stepped over, and evaluate a piece a
little beyond its ends as the same formula continued.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Protocol, runtime_checkable

import numpy as np

from eventpound.numerics.arrays import Floats

SMALLEST, LARGEST = 1.0e-100, 1.0e100
"""Accelerations (m/s^2) and times (s) between which the products of three of them are doubles."""


class Family(IntEnum):
    """Formula of a piece; the coefficients are those of `Piece.coefficients`."""

    ZERO = 0
    """a = 0; no coefficients."""
    SINUSOIDS = 1
    """a = sum_k A_k cos(w_k (t - t_r) + p_k); [t_r, A_1, w_1, p_1, A_2, ...]."""
    GAUSSIAN = 2
    """a = (c_0 + c_1 s + c_2 s^2 + c_3 s^3) exp(-q s^2), s = t - t_c; [t_c, q, c_0 ... c_3]."""
    SAMPLES = 3
    """Linear between samples; [t_0, dt] and `Piece.samples`."""
    LOADED = 4
    """The ground and loads on bodies, each of a formula above; see `eventpound.motion.loaded`."""


QUIET = 8.0
"""Distance from its center, in its own time 1/sqrt(q), at which a Gaussian is nothing: 1.6e-28."""


@dataclass(frozen=True, slots=True)
class Piece:
    """One smooth stretch of a ground motion.

    Parameters
    ----------
    start, end : float
        The stretch (s); the first piece starts at -inf, the last ends at inf.
    family : Family
        Which formula.
    coefficients : ndarray
        Its numbers (SI).
    samples : ndarray
        Accelerations (m/s^2) of the family SAMPLES, else empty.
    """

    start: float
    end: float
    family: Family
    coefficients: Floats = field(default_factory=lambda: np.empty(0))
    samples: Floats = field(default_factory=lambda: np.empty(0))


@dataclass(frozen=True, slots=True)
class Scales:
    """Acceleration and time scale of a motion (founding paper, section 2).

    Parameters
    ----------
    a_g : float
        Amplitude of a pulse or PGA of a record (m/s^2), positive.
    omega_g : float
        2 pi / T_p of a pulse or 2 pi / T_m of a record (rad/s).
    """

    a_g: float
    omega_g: float

    @classmethod
    def of_period(cls, a_g: float, period: float) -> Scales:
        """Scales with omega_g = 2 pi / period (m/s^2, s)."""
        return cls(a_g, 2.0 * math.pi / period)

    @property
    def length(self) -> float:
        """The energetic length scale L_e = a_g / omega_g^2 (m)."""
        return self.a_g / self.omega_g**2

    @property
    def period(self) -> float:
        """2 pi / omega_g (s)."""
        return 2.0 * math.pi / self.omega_g


def moves(motion: GroundMotion) -> bool:
    """Whether a motion is anything but rest."""
    return any(piece.family is not Family.ZERO for piece in motion.pieces())


@runtime_checkable
class GroundMotion(Protocol):
    """Duties of a ground motion.

    1. `kind`: the word a case names it by.
    2. `pieces()`: the smooth stretches in order, without holes, from -inf to inf.
    3. `acceleration(t)`, `velocity(t)`, `displacement(t)`: exact, for an array
       of times (s); at a jump the acceleration is the one after it; velocity
       and displacement vanish at the start of the motion and before it.
    4. `scales()`: a_g and omega_g, or None where there is no motion, or no period of it.
    5. `end`: the time after which the acceleration stays zero (inf where it
       never does).
    """

    @property
    def kind(self) -> str:
        """Duty 1."""
        ...

    @property
    def end(self) -> float:
        """Duty 5 (s)."""
        ...

    def pieces(self) -> list[Piece]:
        """Duty 2."""
        ...

    def acceleration(self, t: Floats) -> Floats:
        """Duty 3 (m/s^2)."""
        ...

    def velocity(self, t: Floats) -> Floats:
        """Duty 3 (m/s)."""
        ...

    def displacement(self, t: Floats) -> Floats:
        """Duty 3 (m)."""
        ...

    def scales(self) -> Scales | None:
        """Duty 4."""
        ...
