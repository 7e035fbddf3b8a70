"""Mean period of a record.

    T_m = sum_i C_i^2 / f_i / sum_i C_i^2,    0.25 Hz <= f_i <= 20 Hz,

with C_i the moduli of the discrete Fourier transform of the acceleration at
the frequencies f_i (Hz). The transform is taken of the record as it is (no
taper, no removal of the mean), padded with zeros to the power of two that is
not shorter than the record and gives a frequency step of at most 0.05 Hz.

Source: E. M. Rathje, N. A. Abrahamson and J. D. Bray, Simplified frequency
content estimates of earthquake ground motions, Journal of Geotechnical and
Geoenvironmental Engineering 124(2) (1998), 150-159. The padding is our
convention.
"""

from __future__ import annotations

import numpy as np

from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats

LOWEST_FREQUENCY = 0.25
HIGHEST_FREQUENCY = 20.0
LARGEST_FREQUENCY_STEP = 0.05


def mean_period(acceleration: Floats, time_step: float) -> float:
    """Mean period of sampled acceleration.

    Parameters
    ----------
    acceleration : ndarray, shape (n,)
        Samples, in any unit.
    time_step : float
        Their distance (s).

    Returns
    -------
    float
        T_m (s).

    Raises
    ------
    InputError
        Where the record has nothing between 0.25 and 20 Hz.
    """
    length = transform_length(acceleration.size, time_step)
    frequency = np.fft.rfftfreq(length, time_step)
    inside = (frequency >= LOWEST_FREQUENCY) & (frequency <= HIGHEST_FREQUENCY)
    power = np.abs(np.fft.rfft(acceleration, length)[inside]) ** 2
    total = float(np.sum(power))
    if not total > 0.0:
        raise InputError(
            f"the record has no motion between {LOWEST_FREQUENCY} and {HIGHEST_FREQUENCY:g} Hz, "
            "so its mean period is not defined"
        )
    return float(np.sum(power / frequency[inside])) / total


def transform_length(size: int, time_step: float) -> int:
    """Smallest power of two that holds the record and resolves 0.05 Hz.

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
    length = 1
    while length < size or 1.0 / (length * time_step) > LARGEST_FREQUENCY_STEP:
        length *= 2
    return length
