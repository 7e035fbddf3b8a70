"""The near-fault pulse of Mavroeidis and Papageorgiou.

A harmonic of frequency f_p = 1/T_p under a raised-cosine envelope of gamma
periods; with tau = t - t_0 and t_0 = start + gamma T_p / 2 its velocity is

    v = A/2 [1 + cos(2 pi f_p tau / gamma)] cos(2 pi f_p tau + nu),   |tau| <= gamma T_p / 2

and zero outside; gamma > 1. The acceleration a = dv/dt is, with w = 2 pi f_p,
w_+ = (1 + 1/gamma) w, w_- = (1 - 1/gamma) w and s = t - start, three sinusoids:

    a = A/4 [2 w cos(w s + p) - w_+ cos(w_+ s + p) - w_- cos(w_- s + p)],
    p = nu + pi/2 - pi gamma

A (m/s) is chosen so that the peak of |a| is the amplitude a_p (m/s^2).

Source: G. P. Mavroeidis and A. S. Papageorgiou, A mathematical representation
of near-fault ground motions, Bulletin of the Seismological Society of America
93(3) (2003), 1099-1131.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Annotated, ClassVar

import numpy as np

from eventpound.basics.given import Number, converting_base, default
from eventpound.errors import InputError
from eventpound.motion.parametric import Sinusoid, SinusoidMotion
from eventpound.units import Dimension

_MOST_CYCLES = 1000.0
"""Largest gamma; that of a fault's pulse is 1 to 4, and the peak takes a time in proportion."""
_LARGEST_PHASE = 100.0
"""Of the carrier (rad); many turns more have no digits left beside pi gamma."""


@converting_base()
class MavroeidisPapageorgiou(SinusoidMotion):
    """Velocity pulse of a harmonic under a raised-cosine envelope.

    Parameters
    ----------
    amplitude, period, reverse, start
        As for `Parametric`; the period is 1/f_p and the amplitude the peak of
        the absolute acceleration.
    gamma : float
        Length of the pulse in periods, above 1. The default 2 is ours: it is
        the shortest whole one, for which (nu = 0) the ground ends where it began.
    phase : float
        nu (rad).

    Raises
    ------
    InputError
        Also for `gamma` not above 1, or in the thousands, or a `phase` of many turns.
    """

    gamma: Annotated[Number, Dimension.NUMBER] = default(2.0)
    phase: Annotated[Number, Dimension.ANGLE] = default(0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 1.0 < self.gamma <= _MOST_CYCLES:
            raise InputError(
                f"excitation '{self.kind}': gamma = {self.gamma!r}; a number above 1 is needed, "
                f"of at most {_MOST_CYCLES:g}"
            )
        if not abs(self.phase) <= _LARGEST_PHASE:
            raise InputError(
                f"excitation '{self.kind}': phase = {self.phase!r}; a number from "
                f"-{_LARGEST_PHASE:g} to {_LARGEST_PHASE:g} is needed"
            )

    kind: ClassVar[str] = "mavroeidis-papageorgiou"
    """The word a case names it by."""

    @property
    def duration(self) -> float:
        """The length of the envelope, gamma T_p (s)."""
        return self.gamma * self.period

    @property
    def velocity_amplitude(self) -> float:
        """A (m/s), positive."""
        return self.amplitude / (self.omega * _unit_peak(self.gamma, self.phase))

    def sinusoids(self) -> tuple[Sinusoid, ...]:
        """The carrier and its two sidebands."""
        sign = -1.0 if self.reverse else 1.0
        scale = sign * self.velocity_amplitude * self.omega
        return tuple(
            Sinusoid(scale * weight, ratio * self.omega, phase)
            for weight, ratio, phase in _unit_terms(self.gamma, self.phase)
        )


def _unit_terms(gamma: float, nu: float) -> tuple[tuple[float, float, float], ...]:
    """Weight, frequency ratio and phase of the terms of a for A = w = 1."""
    p = nu + 0.5 * math.pi - math.pi * gamma
    upper, lower = 1.0 + 1.0 / gamma, 1.0 - 1.0 / gamma
    return ((0.5, 1.0, p), (-0.25 * upper, upper, p), (-0.25 * lower, lower, p))


@lru_cache
def _unit_peak(gamma: float, nu: float) -> float:
    """Peak of |a| over the pulse for A = w = 1, to rounding.

    The acceleration vanishes at both ends, so the peak is at a zero of its
    derivative; these are bracketed on a grid much finer than the shortest of
    the three periods.
    """
    from scipy.optimize import brentq

    terms = _unit_terms(gamma, nu)

    def acceleration(x: float) -> float:
        return sum(weight * math.cos(ratio * x + p) for weight, ratio, p in terms)

    def slope(x: float) -> float:
        return -sum(weight * ratio * math.sin(ratio * x + p) for weight, ratio, p in terms)

    grid = np.linspace(0.0, 2.0 * math.pi * gamma, 64 * math.ceil(gamma) + 1)
    slopes = [slope(x) for x in grid]
    peak = 0.0
    for left, right, before, after in zip(
        grid[:-1], grid[1:], slopes[:-1], slopes[1:], strict=True
    ):
        if before * after <= 0.0:
            peak = max(peak, abs(acceleration(brentq(slope, left, right, xtol=1e-14))))
    return peak
