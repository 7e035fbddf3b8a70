"""What a file says of one component, and the record it makes with its numbers."""

from __future__ import annotations

import re
from dataclasses import dataclass
from decimal import Decimal

import numpy as np

from eventpound.motion.readers.base import Given, RecordData, Source
from eventpound.motion.readers.checks import (
    agreed_time_step,
    agreed_units,
    ask_for_missing,
    samples_in_si,
    unit_factor,
)
from eventpound.motion.readers.numbers import NUMBER, to_float
from eventpound.numerics.arrays import Floats

_ROUNDING = 0.51
"""Half a unit of the last decimal, and a little for the binary numbers."""


@dataclass(frozen=True)
class Peak:
    """The largest absolute sample as a header prints it.

    Parameters
    ----------
    text : str
        The number as printed; its last decimal says how exact it is.
    units : str
        Its unit.
    line : int
        Where it stands (from 1).
    """

    text: str
    units: str
    line: int


@dataclass(frozen=True)
class Header:
    """What is known of a component besides its numbers.

    Parameters
    ----------
    units, units_line
        Unit of the numbers and the line that states it; None where nothing does.
    time_step, time_step_line
        Their distance (s) and the line that states it.
    event, station, component, date : str, optional
        As they are printed.
    peak : Peak, optional
        The peak that the file states.
    """

    units: str | None = None
    units_line: int | None = None
    time_step: float | None = None
    time_step_line: int | None = None
    event: str | None = None
    station: str | None = None
    component: str | None = None
    date: str | None = None
    peak: Peak | None = None


def record_data(
    source: Source,
    format: str,
    header: Header,
    values: Floats,
    given: Given,
    notes: tuple[str, ...] = (),
) -> RecordData:
    """The record that header, numbers in the file's unit and what the caller knows make.

    Parameters
    ----------
    source, format : Source, str
        The file and the name of its reader.
    header, values : Header, ndarray of shape (n,)
        What the file says, and its numbers.
    given : Given
        What the caller says.
    notes : tuple of str
        What was passed over.

    Raises
    ------
    InputError
        Where neither says units or time step, or they disagree, or the samples
        are no accelerogram.
    """
    ask_for_missing(
        source,
        units=header.units is None and given.units is None,
        time_step=header.time_step is None and given.time_step is None,
    )
    units, factor = agreed_units(source, header.units, header.units_line, given.units)
    step = header.time_step if header.time_step is not None else given.time_step
    assert step is not None
    acceleration = samples_in_si(source, values, factor)
    return RecordData(
        acceleration=acceleration,
        time_step=agreed_time_step(source, step, header.time_step_line, given.time_step),
        units=units,
        format=format,
        file=source.file,
        sha256=source.sha256,
        event=header.event,
        station=header.station,
        component=header.component,
        date=header.date,
        notes=notes + _other_peak(header.peak, acceleration),
    )


def _other_peak(peak: Peak | None, acceleration: Floats) -> tuple[str, ...]:
    """A note where the samples do not have the peak that the file states."""
    factor = None if peak is None else unit_factor(peak.units)
    if peak is None or factor is None or not re.fullmatch(NUMBER, peak.text):
        return ()
    exponent = int(Decimal(peak.text.replace("D", "E").replace("d", "e")).as_tuple().exponent)
    stated = abs(to_float(peak.text))
    found = float(np.max(np.abs(acceleration))) / factor
    if abs(found - stated) <= float(f"{_ROUNDING}e{exponent}") + 1e-12 * found:
        return ()
    return (
        f"line {peak.line} states a peak of {peak.text} {peak.units}, "
        f"the samples have {found:.6g} {peak.units}",
    )
