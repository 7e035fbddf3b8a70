"""Mean period of a record.

    T_m = sum_i C_i^2 / f_i / sum_i C_i^2,    0.25 Hz <= f_i <= 20 Hz,

with C_i the moduli of the discrete Fourier transform of the acceleration at
the frequencies f_i (Hz). Three conventions of the transform are in use:

    padded    of the record as it is, with as many zeros as a frequency step of
              0.05 Hz takes: none behind a record of 20 s (the default)
    literal   of the record as it is
    slammer   with its mean removed and a cosine taper over 5 % at either end,
              padded to the next power of two, 0.25 Hz < f_i < 20 Hz: gives the
              mean periods published with SLAMMER

Sources: E. M. Rathje, N. A. Abrahamson and J. D. Bray, Simplified frequency
content estimates of earthquake ground motions, Journal of Geotechnical and
Geoenvironmental Engineering 124(2) (1998), 150-159, which leaves the transform
open; R. W. Jibson, E. M. Rathje, M. W. Jibson and Y. W. Lee, SLAMMER, USGS
Techniques and Methods 12-B1 (2013).
"""

from __future__ import annotations

import math
from typing import Literal, get_args

import numpy as np

from eventpound.numerics.arrays import Floats

Convention = Literal["padded", "literal", "slammer"]
CONVENTIONS: tuple[Convention, ...] = get_args(Convention)

LOWEST_FREQUENCY = 0.25
HIGHEST_FREQUENCY = 20.0
LARGEST_FREQUENCY_STEP = 0.05
ROUNDING = 1e-13
"""Amplitudes below this part of the largest that samples of their size can have are none."""
_TAPERED = 0.05


def mean_period(acceleration: Floats, time_step: float, convention: Convention = "padded") -> float:
    """Mean period of sampled acceleration.

    Parameters
    ----------
    acceleration : ndarray, shape (n,)
        Samples, in any unit.
    time_step : float
        Their distance (s).
    convention : {"padded", "literal", "slammer"}
        Of the transform.

    Returns
    -------
    float
        T_m (s); NaN of a record that has nothing between 0.25 and 20 Hz.
    """
    frequency, amplitude = fourier_amplitudes(acceleration, time_step, convention)
    inside = _inside(frequency, convention)
    power = amplitude[inside] ** 2
    total = float(np.sum(power))
    if total <= (ROUNDING * time_step * float(np.sum(np.abs(acceleration)))) ** 2:
        return math.nan
    return float(np.sum(power / frequency[inside])) / total


def fourier_amplitudes(
    acceleration: Floats, time_step: float, convention: Convention = "padded"
) -> tuple[Floats, Floats]:
    """Frequencies and moduli of the transform that the mean period is taken of.

    Parameters
    ----------
    acceleration, time_step, convention
        As for `mean_period`.

    Returns
    -------
    tuple of ndarray, shape (m,)
        f_i (Hz) and C_i = dt |sum_k a_k exp(-2 pi i f_i t_k)| (unit of the
        acceleration times s).
    """
    size = acceleration.size
    length = size
    if convention == "padded":
        length = transform_length(size, time_step)
    elif convention == "slammer":
        length = 1 << (size - 1).bit_length()
        acceleration = (acceleration - np.mean(acceleration)) * _taper(size)
    amplitude: Floats = time_step * np.abs(np.fft.rfft(acceleration, length))
    frequency: Floats = np.arange(amplitude.size) / (length * time_step)
    return frequency, amplitude


def _inside(frequency: Floats, convention: Convention) -> np.ndarray:
    """Which frequencies count."""
    if convention == "slammer":
        return (frequency > LOWEST_FREQUENCY) & (frequency < HIGHEST_FREQUENCY)
    return (frequency >= LOWEST_FREQUENCY) & (frequency <= HIGHEST_FREQUENCY)


def _taper(size: int) -> Floats:
    """Half cosines over the first and the last 5 % of the samples, one between."""
    ends = round(_TAPERED * size)
    taper = np.ones(size)
    if ends:
        rise = 0.5 * (1.0 - np.cos(np.pi * np.arange(ends) / ends))
        taper[:ends] = rise
        taper[-ends:] = rise[::-1]
    return taper


def transform_length(size: int, time_step: float) -> int:
    """Fewest samples that hold the record and resolve 0.05 Hz.

    Parameters
    ----------
    size : int
        Samples of the record.
    time_step : float
        Their distance (s).

    Returns
    -------
    int
        Length of the padded record.
    """
    length = max(size, int(1.0 / (LARGEST_FREQUENCY_STEP * time_step)))
    # Where the quotient is a whole number its rounding must not cost a sample.
    while 1.0 / (length * time_step) > LARGEST_FREQUENCY_STEP:
        length += 1
    return length
