"""What a case says of a record beside its file: format and units, scale, direction and start."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from eventpound.case.table import Table
from eventpound.motion import Record, RecordData
from eventpound.units import Dimension


@dataclass(frozen=True, slots=True)
class RecordOptions:
    """Keys of ``[excitation]`` that a record has.

    Parameters
    ----------
    format, units : str or None
        Of the file, where it does not say.
    time_step : float or None
        Of the file, where it does not say (s).
    scale : float or None
        Factor on the samples.
    pga : float or None
        Peak that the samples are scaled to (m/s^2), instead of `scale`.
    start : float
        Time of the first sample (s).
    reverse : bool
        Whether the motion is turned round.
    """

    format: str | None = None
    units: str | None = None
    time_step: float | None = None
    scale: float | None = None
    pga: float | None = None
    start: float = 0.0
    reverse: bool = False

    def motion(self, data: RecordData) -> Record:
        """The ground motion of a file that was read."""
        scale = 1.0 if self.scale is None else self.scale
        return Record(
            data.acceleration, data.time_step, scale, self.pga, self.reverse, self.start, data
        )

    def understood(self) -> Mapping[str, object]:
        """Scale, start and direction in SI, with the defaults filled in."""
        size = {"scale": self.scale or 1.0} if self.pga is None else {"pga": self.pga}
        return {**size, "start": self.start, "reverse": self.reverse}


def read_record_options(table: Table) -> RecordOptions | None:
    """Read the keys of a record.

    Parameters
    ----------
    table : Table
        ``[excitation]``.

    Returns
    -------
    RecordOptions or None
        None where there are problems; they are noted.
    """
    pga = table.optional_quantity("pga", Dimension.ACCELERATION)
    scale = table.optional_quantity("scale", Dimension.NUMBER)
    time_step = table.optional_quantity("time_step", Dimension.TIME)
    start = table.quantity("start", Dimension.TIME, 0.0)
    reverse = table.flag("reverse")
    texts = {
        key: table.text(key, f"the {key} of the file") if table.has(key) else None
        for key in ("format", "units")
    }
    for key, value in (("pga", pga), ("scale", scale), ("time_step", time_step)):
        if value is not None:
            table.require(key, not value <= 0.0, "a positive number; reverse turns a motion round")
    if pga is not None and scale is not None:
        table.reject("scale", "one of scale and pga")
        return None
    numbers = [value for value in (pga, scale, time_step, start) if value is not None]
    if any(math.isnan(number) for number in numbers) or "" in texts.values():
        return None
    return RecordOptions(texts["format"], texts["units"], time_step, scale, pga, start, reverse)
