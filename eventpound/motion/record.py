"""A sampled record: linear between samples, zero before the first and after the last.

With t_i = start + i dt, h = t - t_i and the slope s_i = (a_{i+1} - a_i) / dt,
on t_i <= t < t_{i+1}:

    a = a_i + s_i h
    v = v_i + a_i h + s_i h^2 / 2
    d = d_i + v_i h + a_i h^2 / 2 + s_i h^3 / 6

(a in m/s^2, v in m/s, d in m; v_0 = d_0 = 0). The acceleration jumps at the
start and at the end where the first or last sample is not zero; its slope
jumps at every sample. Scales: a_g = PGA = max |a_i|, omega_g = 2 pi / T_m with
the mean period T_m of `eventpound.motion.scales`.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property
from pathlib import PurePath
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from eventpound.basics.given import (
    Given,
    Number,
    OptionalNumber,
    converting_base,
    default,
    read_fields,
)
from eventpound.errors import InputError
from eventpound.motion.base import Family, Piece, Scales
from eventpound.motion.parametric import require_accepted, require_finite, require_positive
from eventpound.motion.readers.base import RecordData
from eventpound.motion.scales import mean_period
from eventpound.numerics.arrays import Floats
from eventpound.units import Dimension


@converting_base(eq=False)
class Record:
    """A ground motion given by samples.

    Parameters
    ----------
    samples : ndarray, shape (n,)
        Accelerations as recorded (m/s^2), n >= 2, not all zero.
    time_step : float
        dt (s), positive.
    scale : float
        Factor on the samples, positive.
    pga : float, optional
        Scale the samples so that their peak is this (m/s^2), instead of `scale`.
    reverse : bool
        Whether the motion is turned round, a -> -a.
    start : float
        Time of the first sample (s).
    source : RecordData, optional
        The file the samples were read from.
    psa : float, optional
        Scale the samples so that the pseudo-acceleration of an oscillator is this (m/s^2),
        instead of `scale`.
    psa_period : float, optional
        Its period (s).
    psa_damping : float, optional
        Its ratio of critical damping; 5 % without it.
    psa_at : str
        What a case calls its period where that is the scene's own, ``"T1"``: a study takes that
        of each variant. Empty where `psa_period` is a number.

    Raises
    ------
    InputError
        For samples that are too few, not finite or all zero, a number that is
        not finite or not positive, or two of `scale`, `pga` and `psa`.
    """

    samples: Given[Floats, ArrayLike]
    time_step: Annotated[Number, Dimension.TIME, require_positive]
    scale: Annotated[Number, Dimension.NUMBER, require_positive] = default(1.0)
    pga: Annotated[OptionalNumber, Dimension.ACCELERATION, require_positive] = default(None)
    reverse: bool = False
    start: Annotated[Number, Dimension.TIME, require_finite] = default(0.0)
    source: RecordData | None = None
    psa: Annotated[OptionalNumber, Dimension.ACCELERATION, require_positive] = default(None)
    psa_period: Annotated[OptionalNumber, Dimension.TIME, require_positive] = default(None)
    psa_damping: Annotated[OptionalNumber, Dimension.NUMBER] = default(None)
    psa_at: str = ""

    def __post_init__(self) -> None:
        try:
            samples = np.array(self.samples, dtype=float)
        except (TypeError, ValueError):
            accepted = "an array of accelerations (m/s^2)"
            raise InputError(
                f"Record: samples: found {self.samples!r}; accepted: {accepted}"
            ) from None
        samples.flags.writeable = False
        object.__setattr__(self, "samples", samples)
        read_fields(self)
        if samples.ndim != 1 or samples.size < 2:
            raise InputError(f"excitation 'record': {samples.size} samples; at least 2 are needed")
        bad = np.flatnonzero(~np.isfinite(samples))
        if bad.size:
            raise InputError(
                f"excitation 'record': sample {bad[0] + 1} is {samples[bad[0]]}; "
                "finite numbers are needed"
            )
        if not np.any(samples):
            raise InputError("excitation 'record': every sample is zero; use kind = \"none\"")
        require_accepted(self)
        sizes = {"pga": self.pga, "psa": self.psa}
        given = [f"{name} = {value!r}" for name, value in sizes.items() if value is not None]
        if self.scale != 1.0:
            given.insert(0, f"scale = {self.scale!r}")
        if len(given) > 1:
            raise InputError(f"excitation 'record': {' and '.join(given)}; give one of them")
        if self.psa is not None and self.psa_period is None:
            raise InputError("excitation 'record': psa without psa_period; give its period (s)")
        if self.psa_damping is not None and not 0.0 <= self.psa_damping < 1.0:
            raise InputError(
                f"excitation 'record': psa_damping is {self.psa_damping!r}; "
                "a ratio from 0 to below 1 is needed"
            )

    kind: ClassVar[str] = "record"
    """The word a case names it by."""

    @property
    def end(self) -> float:
        """Time of the last sample, after which the acceleration stays zero (s)."""
        return self.start + (self.samples.size - 1) * self.time_step

    @cached_property
    def values(self) -> Floats:
        """The samples scaled and turned as asked, shape (n,) (m/s^2)."""
        return self.samples * self.factor

    @property
    def times(self) -> Floats:
        """Times of the samples, shape (n,) (s)."""
        return self.start + self.time_step * np.arange(self.samples.size, dtype=np.float64)

    @property
    def called(self) -> str:
        """The file it was read from, or the files of a sequence, without their folders."""
        return "the record" if self.source is None else PurePath(self.source.file).name

    @property
    def begins(self) -> Floats:
        """When the records of a sequence begin (s); of one record none."""
        begins = () if self.source is None else self.source.begins
        return self.start + self.time_step * np.array(begins, dtype=np.float64)

    @property
    def shocks(self) -> list[tuple[str, float]]:
        """What the records of a sequence are called, and the factor on each; of one record none."""
        if self.source is None or not self.source.shocks:
            return []
        names, each = self.source.shocks, self.source.factors or (1.0,) * len(self.source.shocks)
        return [(name, abs(f * self.factor)) for name, f in zip(names, each, strict=True)]

    @property
    def largest_factor(self) -> float:
        """The largest factor on any of its records, in size."""
        return max((factor for _, factor in self.shocks), default=abs(self.factor))

    @property
    def factor(self) -> float:
        """What the samples are multiplied by."""
        factor = self.scale
        if self.pga is not None:
            factor = self.pga / float(np.max(np.abs(self.samples)))
        elif self.psa is not None:
            factor = self.psa / self.recorded_psa
        return -factor if self.reverse else factor

    @cached_property
    def recorded_psa(self) -> float:
        """PSA of the samples as recorded at `psa_period` (m/s^2)."""
        from eventpound.motion.scaling import DAMPING, psa_of

        damping = DAMPING if self.psa_damping is None else self.psa_damping
        period = np.array([self.psa_period], dtype=np.float64)
        return float(psa_of(self.samples, self.time_step, period, damping)[0])

    @cached_property
    def mean_period(self) -> float:
        """T_m (s); NaN where it is not defined."""
        return mean_period(self.samples, self.time_step)

    def like(self, **changes: float) -> Record:
        """The same samples with other numbers.

        Parameters
        ----------
        **changes
            Numbers of the record by their names.

        Raises
        ------
        InputError
            As for a new record.
        """
        other = replace(self, **changes)  # type: ignore[arg-type]
        # Neither depends on the scale, and both take a while.
        if "mean_period" in vars(self) and other.time_step == self.time_step:
            vars(other)["mean_period"] = self.mean_period
        if "recorded_psa" in vars(self) and other._oscillator == self._oscillator:
            vars(other)["recorded_psa"] = self.recorded_psa
        return other

    @property
    def _oscillator(self) -> tuple[float | None, ...]:
        """What `recorded_psa` depends on, beside the samples."""
        return self.time_step, self.psa_period, self.psa_damping

    @property
    def peak(self) -> float:
        """PGA (m/s^2)."""
        return float(np.max(np.abs(self.values)))

    def scales(self) -> Scales | None:
        """a_g = PGA and omega_g = 2 pi / T_m; None where T_m is not defined."""
        return self._scales

    @cached_property
    def _scales(self) -> Scales | None:
        period = self.mean_period
        return None if math.isnan(period) else Scales.of_period(self.peak, period)

    def pieces(self) -> list[Piece]:
        """Zero, the samples, zero."""
        numbers = np.array([self.start, self.time_step])
        return [
            Piece(-math.inf, self.start, Family.ZERO),
            Piece(self.start, self.end, Family.SAMPLES, numbers, self.values),
            Piece(self.end, math.inf, Family.ZERO),
        ]

    def acceleration(self, t: Floats) -> Floats:
        """Ground acceleration, shape of `t` (m/s^2)."""
        t = np.asarray(t, dtype=float)
        i, h = self._interval(t)
        a = self.values[i] + self._slopes[i] * h
        return np.where((t >= self.start) & (t < self.end), a, 0.0)

    def velocity(self, t: Floats) -> Floats:
        """Ground velocity, shape of `t` (m/s); constant after the end."""
        t = np.clip(np.asarray(t, dtype=float), self.start, self.end)
        i, h = self._interval(t)
        v: Floats = self._integrals[0][i] + h * (self.values[i] + h / 2.0 * self._slopes[i])
        return v

    def displacement(self, t: Floats) -> Floats:
        """Ground displacement, shape of `t` (m)."""
        t = np.asarray(t, dtype=float)
        i, h = self._interval(np.clip(t, self.start, self.end))
        v, d = self._integrals
        mean_velocity = v[i] + h / 2.0 * (self.values[i] + h / 3.0 * self._slopes[i])
        past = np.maximum(t - self.end, 0.0)
        own: Floats = d[i] + h * mean_velocity
        return own + past * self.velocity(np.asarray(self.end))

    def _interval(self, t: Floats) -> tuple[np.ndarray, Floats]:
        """Number i of the interval that holds t, and h = t - t_i (s)."""
        dt = self.time_step
        i = np.clip(np.floor((t - self.start) / dt), 0, self.samples.size - 2).astype(int)
        # The division may round across a sample; t_i as rounded decides.
        i = np.where(t >= self.start + (i + 1) * dt, i + 1, i)
        i = np.where(t < self.start + i * dt, i - 1, i)
        i = np.clip(i, 0, self.samples.size - 2)
        return i, t - (self.start + i * dt)

    @cached_property
    def _slopes(self) -> Floats:
        """s_i, shape (n - 1,) (m/s^3)."""
        return np.diff(self.values) / self.time_step

    @cached_property
    def _integrals(self) -> tuple[Floats, Floats]:
        """v_i and d_i, shape (n,) each (m/s, m)."""
        return integrals(self.values, self.time_step)


def integrals(a: Floats, dt: float) -> tuple[Floats, Floats]:
    """Velocities (m/s) and displacements (m) at samples a (n,) (m/s^2) dt (s) apart, from rest."""
    v = np.concatenate(([0.0], np.cumsum(dt / 2.0 * (a[:-1] + a[1:]))))
    d = np.cumsum(dt * v[:-1] + dt**2 / 6.0 * (2.0 * a[:-1] + a[1:]))
    return v, np.concatenate(([0.0], d))
