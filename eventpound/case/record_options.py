"""What a case says of a record beside its file: format and units, scale, direction and start."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from eventpound.case.keys import Bound, flag_key, number_key, read_keys, text_key
from eventpound.case.record_file import find_record
from eventpound.case.record_scaling import RecordScaling, read_scaling
from eventpound.case.table import Table
from eventpound.motion import Record, RecordData, read_record
from eventpound.motion.processing import Processing
from eventpound.units import Dimension


@dataclass(frozen=True, slots=True)
class RecordOptions:
    """Keys of ``[excitation]`` that a record has.

    Parameters
    ----------
    response_path : Path or None
        Where the file `response` is.
    processing : Processing
        What is done to the samples before they are scaled.
    size : RecordScaling
        How large they are made.
    follows : bool
        Whether that is by the factor on the first component instead.
    """

    time_step: float | None = number_key(
        "of the file, where it does not say (s)",
        Dimension.TIME,
        None,
        Bound("a positive number", lambda step: step > 0.0),
    )
    start: float = number_key("time of the first sample (s)", Dimension.TIME, 0.0)
    reverse: bool = flag_key("whether the motion is turned round")
    format: str | None = text_key("the format of the file", "where the file does not say", None)
    units: str | None = text_key("the units of the file", "where the file does not say", None)
    component: str | None = text_key("the component of the file", "which of several", None)
    response: str | None = text_key(
        "the response of the file", "file with the sensitivity of the instrument, for counts", None
    )
    response_path: Path | None = None
    processing: Processing = field(default_factory=Processing)
    size: RecordScaling = field(default_factory=RecordScaling)
    follows: bool = False

    def read(self, path: Path, as_needed: bool = False) -> RecordData:
        """Read a file and process its samples.

        Parameters
        ----------
        path : Path
            The file.
        as_needed : bool
            Whether units, time step and component are for files that do not
            say them, and not to be compared with what others say.

        Raises
        ------
        InputError
            Where it cannot be read.
        """
        beside: Any = {"component": self.component, "response": self.response_path}
        return self.processing.apply(
            read_record(path, **self.said(), **beside, as_needed=as_needed)
        )

    def motion(self, data: RecordData) -> Record:
        """The ground motion of a file that was read."""
        return self.size.of(data, self.reverse, self.start)

    def of_file(self, file: str, data: RecordData) -> dict[str, object]:
        """``[excitation]`` of one file that was read, in SI with the defaults filled in."""
        read = {"format": data.format, "units": data.units, "time_step": data.time_step}
        return {"kind": "record", "file": file, **read, **self.understood()}

    def said(self) -> Mapping[str, Any]:
        """Format, units and time step of the file, where they were given."""
        given = {"format": self.format, "units": self.units, "time_step": self.time_step}
        return {key: value for key, value in given.items() if value is not None}

    def understood(self) -> Mapping[str, object]:
        """Component, scale, start and direction in SI, with the defaults filled in."""
        chosen = {"component": self.component, "response": self.response}
        named: dict[str, object] = {key: text for key, text in chosen.items() if text is not None}
        if self.processing.does_something:
            named["processing"] = self.processing.described()
        size = {} if self.follows else self.size.understood()
        return {**named, **size, "start": self.start, "reverse": self.reverse}


def read_record_options(table: Table, directory: Path) -> RecordOptions | None:
    """Read the keys of a record.

    Parameters
    ----------
    table : Table
        ``[excitation]``.
    directory : Path
        Of the case.

    Returns
    -------
    RecordOptions or None
        None where there are problems; they are noted.
    """
    size = read_scaling(table, directory)
    found = read_keys(table, RecordOptions)
    if any(value == "" or value != value for value in found.values()):
        return None
    processing = _read_processing(table.table("processing"))
    if processing is None or size is None:
        return None
    response = found.get("response")
    path = None if response is None else find_record(response, directory)
    return RecordOptions(**found, response_path=path, processing=processing, size=size)


def _read_processing(table: Table) -> Processing | None:
    """Read ``processing = { baseline, highpass, lowpass, order }``.

    Parameters
    ----------
    table : Table
        The table; empty where it is not given.

    Returns
    -------
    Processing or None
        None where there are problems; they are noted.
    """
    read = {key: _whole_number(table, key) for key in ("baseline", "order")}
    for key in ("highpass", "lowpass"):
        read[key] = table.optional_quantity(key, Dimension.FREQUENCY)
    table.close()
    given: dict[str, Any] = {key: value for key, value in read.items() if value is not None}
    if any(map(math.isnan, given.values())):
        return None
    with table.noting(""):
        return Processing(**given)
    return None


def _whole_number(table: Table, key: str) -> float | None:
    """A whole number; None where it is not given, NaN where it is wrong."""
    if not table.has(key):
        return None
    value = table.data[key]
    if isinstance(value, bool) or not isinstance(value, int):
        table.reject(key, "a whole number")
        return math.nan
    return value
