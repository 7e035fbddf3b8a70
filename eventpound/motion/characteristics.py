"""What a record is called and how large it is: one row of a table of records."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from eventpound.motion.base import Scales
from eventpound.motion.intensity import Intensity, intensity
from eventpound.motion.readers.base import RecordData
from eventpound.motion.record import Record
from eventpound.motion.scales import CONVENTIONS, Convention, mean_period


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
