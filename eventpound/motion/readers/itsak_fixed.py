"""Older ITSAK files: two lines of header, then the numbers in a Fortran format.

    A299_T  ITSAK CHALANDRI STATION         5702 Values
    (8F15.0)             0.005

The second line has the format and the time step (s); units are not stated. The
last line of samples is filled up, and lines of zeros follow; both are dropped.
"""

from __future__ import annotations

import re

import numpy as np

from eventpound.motion.readers.base import Channel, Given, Reader, RecordData, Source
from eventpound.motion.readers.block import Block, Stated, after_last, read_block
from eventpound.motion.readers.header import Header, record_data
from eventpound.motion.readers.numbers import NUMBER, numbers_of_line, to_count, to_float
from eventpound.numerics.arrays import Floats

_FIRST = re.compile(r"\s*(\S+)\s+(.*?)\s+(\d+)\s+Values\s*$", re.IGNORECASE)
_SECOND = re.compile(rf"\s*\((\d+)[FEG](\d+)\.\d+\)\s+({NUMBER})\s*$", re.IGNORECASE)
_FIRST_ROW = 3


def _detect(source: Source) -> bool:
    """Whether the two lines of the header are there."""
    return bool(_FIRST.match(source.line(1)) and _SECOND.match(source.line(2)))


def _channels(source: Source, given: Given) -> list[Channel]:
    """The one component; its name ends the name of the record (A299_T)."""
    first, second = _FIRST.match(source.line(1)), _SECOND.match(source.line(2))
    if first is None or second is None:
        raise source.error(
            1, "not an ITSAK header; expected 'NAME STATION 5702 Values', then '(8F15.0) 0.005'"
        )
    name, station, count = first.groups()
    per_line, width, time_step = second.groups()
    stated = Stated(to_count(count), 1, "Values")
    if to_count(per_line) < 1:
        raise source.error(2, f"found '({per_line}F{width}...)'; at least one number a line")
    component = name.rpartition("_")[2] if "_" in name else None
    header = Header(
        time_step=to_float(time_step), time_step_line=2, station=station, component=component
    )

    def read() -> RecordData:
        values, notes = _read_filled(source, stated, to_count(per_line), to_count(width))
        return record_data(source, READER.name, header, values, given, notes)

    return [Channel(component, read)]


READER = Reader("itsak-fixed", _detect, _channels)


def _read_filled(
    source: Source, stated: Stated, per_line: int, width: int
) -> tuple[Floats, tuple[str, ...]]:
    """The stated number of numbers, and a note on what fills up the last lines."""
    lines = -(-stated.count // per_line)
    last = source.line(_FIRST_ROW + lines - 1)
    excess = len(numbers_of_line(last, width)[0]) + (lines - 1) * per_line - stated.count
    full = Stated(stated.count + max(excess, 0), stated.line, stated.name)
    block = read_block(source, _FIRST_ROW, full, width)
    values, fill = block.values[: stated.count], block.values[stated.count :]
    line = block.next_line
    while (row := numbers_of_line(source.line(line), width)[0]) and not any(row):
        fill = np.concatenate([fill, row])
        line += 1
    notes = after_last(source, Block(block.values, line), stated)
    if fill.size:
        notes += (
            f"{fill.size} numbers after the {stated.count} {stated.name} that line "
            f"{stated.line} states passed over; the largest is {np.max(np.abs(fill)):g}",
        )
    return values, notes
