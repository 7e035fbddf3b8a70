"""Sizes of records by their response spectra: one ordinate of it, or a whole target.

    PSA(T, xi) = w^2 max |q|,    w = 2 pi/T            (`eventpound.motion.swing`)

The factor that brings a record to a target is that of least squares of the logarithms,

    ln factor = mean of ln(target/PSA) over periods evenly spaced in ln T,

for which half and double are equally far off. Source: J. W. Baker, Conditional mean spectrum:
tool for ground-motion selection, Journal of Structural Engineering 137(3) (2011), 322-331 (the sum
of squared errors of ln Sa).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from eventpound.basics.given import number
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.units import STANDARD_GRAVITY, Dimension

DAMPING = 0.05
"""Of a spectrum that does not say."""
_PERIODS = 60
"""At which a spectrum is compared with a target."""


@dataclass(frozen=True)
class Target:
    """A spectrum that records are scaled to.

    Parameters
    ----------
    period, psa : tuple of float
        Its points, T rising (s) and PSA (m/s^2), between which logarithms are interpolated.
    low, high : float
        Periods between which it counts (s).
    damping : float
        Its ratio of critical damping.
    """

    period: tuple[float, ...]
    psa: tuple[float, ...]
    low: float
    high: float
    damping: float = DAMPING

    def log_psa(self, periods: float | Floats) -> Floats:
        """Logarithms of PSA (m/s^2) at periods (s), of their shape; level beyond the points."""
        return np.asarray(np.interp(np.log(periods), np.log(self.period), np.log(self.psa)))


def psa_of(samples: Floats, time_step: float, periods: Floats, damping: float) -> Floats:
    """Pseudo-accelerations of oscillators under a record, linear between its samples.

    Parameters
    ----------
    samples : ndarray, shape (n,)
        Accelerations (m/s^2).
    time_step : float
        Their distance (s).
    periods : ndarray, shape (k,)
        T (s).
    damping : float
        xi, below 1.

    Returns
    -------
    ndarray, shape (k,)
        PSA (m/s^2); the free vibration of a period after the record counts.
    """
    from eventpound.motion.swing import largest_swings

    found = np.zeros((periods.size, 2))
    omega = 2.0 * math.pi / read_periods(periods)
    h = np.full(samples.size, time_step)
    push = np.zeros((samples.size, 4))
    push[:-1, 0], push[:-1, 1] = samples[:-1], np.diff(samples)
    push *= time_step**2
    for k in range(periods.size):
        # The last cell is that after the record.
        h[-1] = periods[k]
        largest_swings(h, push, np.zeros_like(h), omega[k : k + 1], damping, found[k : k + 1])
    return np.asarray(omega**2 * found[:, 0])


def factor_to(target: Target, samples: Floats, time_step: float) -> float:
    """Factor that brings a record to a target.

    Parameters
    ----------
    target : Target
        The target.
    samples : ndarray, shape (n,)
        Accelerations (m/s^2).
    time_step : float
        Their distance (s).
    """
    periods = np.geomspace(target.low, target.high, _PERIODS)
    own = psa_of(samples, time_step, periods, target.damping)
    # Of a record of zeros the factor is none; it is refused for its samples.
    with np.errstate(all="ignore"):
        return float(np.exp(np.mean(target.log_psa(periods) - np.log(own))))


PERIODS = np.geomspace(0.05, 10.0, 200)
"""Where a spectrum is computed that does not say (s)."""


def read_damping(damping: float | str) -> float:
    """A ratio of critical damping, 0.05 or ``"5 %"``.

    Raises
    ------
    InputError
        Where it is none from 0 to below 1.
    """
    ratio = number("damping", damping, Dimension.NUMBER)
    if not 0.0 <= ratio < 1.0:
        raise InputError(f"damping: found {damping!r}; accepted: a ratio from 0 to below 1")
    return ratio


def read_periods(periods: Sequence[float] | Floats) -> Floats:
    """Periods of oscillators (s), shape (k,).

    Raises
    ------
    InputError
        Where one is not positive, or there is none.
    """
    found = np.asarray(periods, dtype=np.float64)
    if found.ndim != 1 or not found.size or not (np.isfinite(found) & (found > 0.0)).all():
        raise InputError("periods: accepted: positive times (s), one at least")
    return found


def spectrum_columns(period: Floats, largest: Floats) -> dict[str, Floats]:
    """Columns period (s), SD (m), PSV (m/s), PSA (m/s^2) and PSA_g (g) of largest elongations."""
    omega = 2.0 * np.pi / period
    acceleration = omega**2 * largest
    return {
        "period": period,
        "SD": largest,
        "PSV": omega * largest,
        "PSA": acceleration,
        "PSA_g": acceleration / STANDARD_GRAVITY,
    }
