"""Baseline correction and filtering of a record, done only where they are asked for.

First a polynomial that fits the acceleration best in the least-squares sense is
taken away, then a Butterworth filter is run forwards and backwards (no phase;
its gain is squared, so that at its corners the amplitude is halved). For the
filter the record is continued with zeros over 1.5 n / f_c at either end, with
n the order of a pass and f_c the lowest corner, and cut to its length again. The
filtered motion has some velocity where it is cut, so a displacement counted from
rest may still drift.

Source of the padding: A. M. Converse and A. G. Brady, BAP: basic strong-motion
accelerogram processing software, USGS Open-File Report 92-296A (1992).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.readers.base import RecordData
from eventpound.numerics.arrays import Floats

HIGHEST_DEGREE = 6
HIGHEST_ORDER = 10
_WORDS = {
    "baseline": "baseline of degree {:g}",
    "highpass": "highpass {:g} Hz",
    "lowpass": "lowpass {:g} Hz",
    "order": "order {:g}",
}
_NOTHING = 1e-12
"""Share of the peak that is rounding."""


@dataclass(frozen=True)
class Processing:
    """What is done to a record before it is used.

    Parameters
    ----------
    baseline : int, optional
        Degree of the polynomial taken from the acceleration; 0 is the mean.
    highpass, lowpass : float, optional
        Corners of the filter (Hz).
    order : int
        Order of the Butterworth filter in one pass.

    Raises
    ------
    InputError
        For a number outside its range, or corners in the wrong order.
    """

    baseline: int | None = None
    highpass: float | None = None
    lowpass: float | None = None
    order: int = 4

    def __post_init__(self) -> None:
        if self.baseline is not None and not 0 <= self.baseline <= HIGHEST_DEGREE:
            raise InputError(
                f"baseline = {self.baseline!r}; accepted: a whole number from 0 to {HIGHEST_DEGREE}"
            )
        if not 1 <= self.order <= HIGHEST_ORDER:
            raise InputError(
                f"order = {self.order!r}; accepted: a whole number from 1 to {HIGHEST_ORDER}"
            )
        for name, corner in self._corners.items():
            if not 0.0 < corner < np.inf:
                raise InputError(f"{name} = {corner!r}; accepted: a positive frequency (Hz)")
        if (self.highpass or 0.0) >= (self.lowpass or np.inf):
            raise InputError(
                f"highpass = {self.highpass!r} Hz and lowpass = {self.lowpass!r} Hz; "
                "the lower corner is that of highpass"
            )

    @property
    def does_something(self) -> bool:
        """Whether anything is asked for."""
        return bool(self.described())

    @property
    def _corners(self) -> dict[str, float]:
        """Those of the filter that are asked for, by name (Hz)."""
        named = {"highpass": self.highpass, "lowpass": self.lowpass}
        return {name: corner for name, corner in named.items() if corner is not None}

    def described(self) -> dict[str, float]:
        """What is asked for, by name, as a case has it."""
        baseline = {} if self.baseline is None else {"baseline": self.baseline}
        return baseline | self._corners | ({"order": self.order} if self._corners else {})

    def apply(self, data: RecordData) -> RecordData:
        """A record with its samples processed, and a note that says how.

        Parameters
        ----------
        data : RecordData
            As it was read.

        Returns
        -------
        RecordData
            As it is used.

        Raises
        ------
        InputError
            For a corner at or above half the sampling frequency, or where
            nothing is left of the record.
        """
        if not self.does_something:
            return data
        acceleration = data.acceleration
        if self.baseline is not None:
            acceleration = _without_polynomial(acceleration, self.baseline)
        if self._corners:
            acceleration = self._filtered(acceleration, data)
        if np.max(np.abs(acceleration)) <= _NOTHING * np.max(np.abs(data.acceleration)):
            raise InputError(f"{data.file}: nothing is left of the record after processing")
        how = ", ".join(_WORDS[key].format(value) for key, value in self.described().items())
        return replace(data, acceleration=acceleration, notes=(*data.notes, f"processed: {how}"))

    def _filtered(self, acceleration: Floats, data: RecordData) -> Floats:
        """Forwards and backwards through the filter, padded with zeros."""
        from scipy.signal import butter, sosfiltfilt

        nyquist = 0.5 / data.time_step
        corners = list(self._corners.values())
        if max(corners) >= nyquist:
            raise InputError(
                f"{data.file}: a corner of {max(corners):g} Hz; with a time step of "
                f"{data.time_step:g} s it has to be below {nyquist:g} Hz"
            )
        kind = "bandpass" if len(corners) == 2 else "highpass" if self.highpass else "lowpass"
        sampling = 1.0 / data.time_step
        sections = butter(self.order, np.squeeze(corners), kind, fs=sampling, output="sos")
        pad = round(1.5 * self.order / min(corners) / data.time_step)
        filtered: Floats = sosfiltfilt(sections, np.pad(acceleration, pad), padtype=None)
        return filtered[pad : pad + acceleration.size]


def _without_polynomial(acceleration: Floats, degree: int) -> Floats:
    """The residual of the least-squares polynomial of a degree."""
    x = np.linspace(-1.0, 1.0, acceleration.size)
    # Legendre's are nearly orthogonal on even points, so the fit is well conditioned.
    coefficients = np.polynomial.legendre.legfit(x, acceleration, degree)
    residual: Floats = acceleration - np.polynomial.legendre.legval(x, coefficients)
    return residual
