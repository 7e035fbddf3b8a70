"""The oscillators of a spectrum: their periods, their damping, and the columns of its table."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from eventpound.basics.given import number
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.units import STANDARD_GRAVITY, Dimension

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
