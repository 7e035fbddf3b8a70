"""How large a record is: its intensity measures, and its row in a table of records.

With a (m/s^2), v and d (m/s, m; from rest at the first sample), over the record:

    PGA = max |a|,  PGV = max |v|,  PGD = max |d|
    Arias intensity    I_A = pi / (2 g) int a^2 dt                       (m/s)
    CAV                int |a| dt                                        (m/s)
    D_5-95             time from 5 to 95 % of int a^2 dt                 (s)

Velocity and displacement are those of straight lines between the samples, with
extremes where a (for v) or v (for d) is zero; those of a record that is not
corrected drift, and its PGV and PGD say so. The integrals of a^2 and |a| are
trapezium sums over the samples, as published tables have them: of a record
without content above the Nyquist frequency the first is exact, where that of the
straight lines, which cut the peaks, is up to 6 % less.

Sources: A. Arias, A measure of earthquake intensity, in R. J. Hansen (ed.),
Seismic Design for Nuclear Power Plants, MIT Press (1970), 438-483; M. D. Trifunac
and A. G. Brady, A study on the duration of strong earthquake ground motion,
Bulletin of the Seismological Society of America 65(3) (1975), 581-626; EPRI, A
criterion for determining exceedance of the operating basis earthquake, NP-5930 (1988).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from eventpound.motion.base import Scales
from eventpound.motion.readers.base import RecordData
from eventpound.motion.record import Record
from eventpound.motion.scales import CONVENTIONS, Convention, mean_period
from eventpound.numerics.arrays import Floats
from eventpound.units import STANDARD_GRAVITY

_FROM, _TO = 0.05, 0.95


@dataclass(frozen=True, slots=True)
class Intensity:
    """Measures of one record (SI).

    Parameters
    ----------
    pga, pgv, pgd : float
        Peaks of |a|, |v| and |d| (m/s^2, m/s, m).
    time_of_pga : float
        Time of the peak from the first sample (s).
    arias : float
        Arias intensity (m/s), a trapezoid sum over the samples.
    duration_from, duration_to : float
        Times from the first sample at which 5 and 95 % of the Arias intensity
        are reached (s), by the same sum.
    cav : float
        Cumulative absolute velocity (m/s), a trapezoid sum over the samples.
    """

    pga: float
    pgv: float
    pgd: float
    time_of_pga: float
    arias: float
    duration_from: float
    duration_to: float
    cav: float

    @property
    def significant_duration(self) -> float:
        """D_5-95 (s)."""
        return self.duration_to - self.duration_from


def intensity(record: Record) -> Intensity:
    """Measures of a record as it is scaled.

    Parameters
    ----------
    record : Record
        The motion.

    Returns
    -------
    Intensity
        Its measures.
    """
    a, dt, t = record.values, record.time_step, record.times
    peak = int(np.argmax(np.abs(a)))
    husid = np.concatenate(([0.0], np.cumsum(0.5 * dt * (a[:-1] ** 2 + a[1:] ** 2))))
    at_from, at_to = np.interp(np.array([_FROM, _TO]) * husid[-1], husid, t - record.start)
    return Intensity(
        pga=float(abs(a[peak])),
        pgv=peak_velocity(record),
        pgd=peak_displacement(record),
        time_of_pga=peak * dt,
        arias=0.5 * math.pi / STANDARD_GRAVITY * float(husid[-1]),
        duration_from=float(at_from),
        duration_to=float(at_to),
        cav=float(np.trapezoid(np.abs(a), dx=dt)),
    )


def peak_velocity(record: Record) -> float:
    """PGV of a record as it is scaled (m/s)."""
    a, dt, t = record.values, record.time_step, record.times
    return _largest(record.velocity(np.concatenate([t, t[:-1] + _zeros_of_acceleration(a, dt)])))


def peak_displacement(record: Record) -> float:
    """PGD of a record as it is scaled (m)."""
    t = record.times
    return _largest(record.displacement(np.concatenate([t, _turns(record, t)])))


def _largest(values: Floats) -> float:
    return float(np.max(np.abs(values)))


def _zeros_of_acceleration(a: Floats, dt: float) -> Floats:
    """Time into each interval at which a changes sign, zero where it does not, shape (n - 1,)."""
    before, after = a[:-1], a[1:]
    changes = before * after < 0.0
    h = np.zeros(before.size)
    h[changes] = dt * before[changes] / (before[changes] - after[changes])
    return h


def _turns(record: Record, t: Floats) -> Floats:
    """Times within the intervals at which the velocity is zero, shape (m,)."""
    a, dt = record.values, record.time_step
    v = record.velocity(t[:-1])
    slope = np.diff(a) / dt
    # slope/2 h^2 + a h + v = 0 by the form that does not cancel.
    root = a[:-1] ** 2 - 2.0 * slope * v
    q = -(a[:-1] + np.copysign(np.sqrt(np.maximum(root, 0.0)), a[:-1]))
    with np.errstate(divide="ignore", invalid="ignore"):
        candidates = (q / slope, 2.0 * v / q)
    times = [
        (t[:-1] + h)[(root >= 0.0) & np.isfinite(h) & (h > 0.0) & (h < dt)] for h in candidates
    ]
    return np.concatenate(times)


@dataclass(frozen=True, eq=False)
class Characteristics:
    """Scales and intensity measures of one component of a record.

    Parameters
    ----------
    data : RecordData
        The record, processed where that was asked for.
    convention : {"padded", "literal", "slammer"}
        Of the mean period that the scales are made with.
    """

    data: RecordData
    convention: Convention = "padded"

    @cached_property
    def record(self) -> Record:
        """The motion."""
        return Record(self.data.acceleration, self.data.time_step, source=self.data)

    @cached_property
    def intensity(self) -> Intensity:
        """PGA, PGV, PGD, Arias intensity, duration and CAV."""
        return intensity(self.record)

    @cached_property
    def mean_periods(self) -> dict[Convention, float]:
        """T_m by every convention (s); NaN where it is not defined."""
        return {
            convention: mean_period(self.data.acceleration, self.data.time_step, convention)
            for convention in CONVENTIONS
        }

    @property
    def mean_period(self) -> float:
        """T_m by the convention chosen (s)."""
        return self.mean_periods[self.convention]

    @property
    def scales(self) -> Scales | None:
        """PGA and 2 pi / T_m; None where that is not defined."""
        period = self.mean_period
        return None if math.isnan(period) else Scales.of_period(self.intensity.pga, period)

    def row(self) -> dict[str, object]:
        """Name and value of every column of a table of records (SI)."""
        data, measures, scales = self.data, self.intensity, self.scales
        return {
            "file": data.file,
            "component": data.component or "",
            "event": data.event or "",
            "date": data.date or "",
            "station": data.station or "",
            "format": data.format,
            "units": data.units,
            "npts": data.acceleration.size,
            "dt_s": data.time_step,
            "duration_s": self.record.end,
            "pga_m_s2": measures.pga,
            "t_pga_s": measures.time_of_pga,
            "tm_s": self.mean_period,
            "omega_g_rad_s": math.nan if scales is None else scales.omega_g,
            "le_m": math.nan if scales is None else scales.length,
            "pgv_m_s": measures.pgv,
            "pgd_m": measures.pgd,
            "arias_m_s": measures.arias,
            "d5_95_s": measures.significant_duration,
            "cav_m_s": measures.cav,
            **{f"tm_{name}_s": period for name, period in self.mean_periods.items()},
            "notes": "; ".join(data.notes),
        }
