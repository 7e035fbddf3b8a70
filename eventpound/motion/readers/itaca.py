"""Reprocessed Italian records as RESORCE has them: ten labelled lines, five numbers a line.

``Time Increment (s)``, ``Number of Data`` and ``PGA (m/s/s)`` are labels; the
line before the numbers says ``Accelaration time series in m/s/s`` (so spelt).
The numbers touch where they are negative.
"""

from __future__ import annotations

import re

from eventpound.motion.readers.base import Channel, Given, Reader, RecordData, Source
from eventpound.motion.readers.block import Stated, after_last, read_block
from eventpound.motion.readers.header import Header, Peak, record_data
from eventpound.motion.readers.labelled import read_labelled

_LONGEST_HEADER = 20
_BEFORE_NUMBERS = re.compile(r"\s*Acc\w+ time series in\s+(\S+)", re.IGNORECASE)
_WIDTH = 14


def _detect(source: Source) -> bool:
    """Whether the header has its first label and the line before the numbers."""
    return source.line(1).startswith("Event Date & Time") and _start(source) is not None


def _channels(source: Source, given: Given) -> list[Channel]:
    """The one component."""
    start = _start(source)
    if start is None:
        raise source.error(None, "no line 'Acceleration time series in ...' before the numbers")
    line, units = start
    labels = read_labelled(source, line - 1)
    stated = Stated(*labels.count("Number of Data"), name="Number of Data")
    time_step, time_step_line = labels.number("Time Increment (s)")
    peak = labels.text("PGA (m/s/s)")
    header = Header(
        units=units,
        units_line=line,
        time_step=time_step,
        time_step_line=time_step_line,
        station=labels.text("Station Code / Name"),
        component=labels.text("Orientation"),
        date=labels.text("Event Date & Time"),
        peak=None if peak is None else Peak(peak, "m/s2", labels.lines["PGA (m/s/s)"]),
    )

    def read() -> RecordData:
        block = read_block(source, line + 1, stated, _WIDTH)
        notes = after_last(source, block, stated)
        return record_data(source, READER.name, header, block.values, given, notes)

    return [Channel(header.component, read)]


READER = Reader("itaca", _detect, _channels)


def _start(source: Source) -> tuple[int, str] | None:
    """The line before the numbers (from 1) and the unit it names."""
    for number, line in enumerate(source.lines[:_LONGEST_HEADER], start=1):
        if found := _BEFORE_NUMBERS.match(line):
            return number, found.group(1)
    return None
