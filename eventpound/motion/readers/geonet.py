"""GeoNet (New Zealand), corrected accelerograms (V2A): three components, one after the other.

Each has 16 lines of text and 10 of numbers, then acceleration, velocity and
displacement in numbers of eight characters, ten a line (mm/s^2, mm/s, mm).
"""

from __future__ import annotations

import re

from eventpound.motion.readers.base import Channel, Given, Reader, RecordData, Source
from eventpound.motion.readers.block import Stated, read_block
from eventpound.motion.readers.header import Header, Peak, record_data
from eventpound.motion.readers.numbers import NUMBER, to_count, to_float

_HEADER_LINES, _TEXT_LINES = 26, 16
_FIELD_WIDTH = 8
_FIRST = re.compile(r"Corrected accelerogram\b.*\bGNS\b", re.IGNORECASE)
_COUNT = re.compile(r"Number of points\s+(\d+)", re.IGNORECASE)
_STEP = re.compile(rf"data at\s+({NUMBER})\s+sec intervals", re.IGNORECASE)
_COMPONENT = re.compile(r"Component\s+(\S+)", re.IGNORECASE)
_PEAK = re.compile(rf"Acceleration:\s+peak\s+({NUMBER})\s+(mm/s/s)", re.IGNORECASE)
_SITE = re.compile(r"Site\s+(\S+)", re.IGNORECASE)


def _detect(source: Source) -> bool:
    """Whether the first line is that of a component."""
    return bool(_FIRST.match(source.line(1)))


def _channels(source: Source, given: Given) -> list[Channel]:
    """The components."""
    starts = [i for i, line in enumerate(source.lines, start=1) if _FIRST.match(line)]
    return [_channel(source, start, given) for start in starts]


READER = Reader("geonet", _detect, _channels)


def _channel(source: Source, start: int, given: Given) -> Channel:
    """The component whose header begins on a line; its azimuth is another name of it."""
    count_line, count = _find(source, start, _COUNT, "Number of points")
    step_line, step = _find(source, start, _STEP, "data at ... sec intervals")
    peak_line, peak = _find(source, start, _PEAK, "Acceleration: peak ... mm/s/s")
    _, component = _find(source, start, _COMPONENT, "Component")
    _, site = _find(source, start, _SITE, "Site")
    stated = Stated(to_count(count.group(1)), count_line, "Number of points")
    header = Header(
        units=peak.group(2),
        units_line=peak_line,
        time_step=to_float(step.group(1)),
        time_step_line=step_line,
        station=f"{site.group(1)} {source.line(start + 2).strip()}",
        component=component.group(1),
        date=" ".join(source.line(start + 7).split()) or None,
        peak=Peak(peak.group(1), peak.group(2), peak_line),
    )

    def read() -> RecordData:
        block = read_block(source, start + _HEADER_LINES, stated, _FIELD_WIDTH)
        return record_data(source, READER.name, header, block.values, given)

    return Channel(header.component, read, _azimuth(component.group(1)))


def _find(
    source: Source, start: int, pattern: re.Pattern[str], expected: str
) -> tuple[int, re.Match[str]]:
    """Line and match of what one of the lines of text says."""
    for number in range(start, start + _TEXT_LINES):
        if found := pattern.search(source.line(number)):
            return number, found
    raise source.error(start, f"'{expected}' is in none of the {_TEXT_LINES} lines from here")


def _azimuth(name: str) -> tuple[str, ...]:
    """The bearing N28W as degrees from north, 332."""
    bearing = re.fullmatch(r"([NS])(\d+)([EW])", name)
    if bearing is None:
        return ()
    angle = (
        to_count(bearing.group(2)) if bearing.group(1) == "N" else 180 - to_count(bearing.group(2))
    )
    return (str((angle if bearing.group(3) == "E" else -angle) % 360),)
