"""California Strong Motion Instrumentation Program (CSMIP, CDMG): V1 and V2.

For each channel some 45 lines of header, then the numbers after a line

    3251 POINTS OF ACCEL DATA EQUALLY SPACED AT  .020 SEC.  (UNITS: CM/SEC/SEC)     V2
    12000 points of accel data equally spaced at  .005 sec, in cm/sec2.
    13200 Accelerogram points at 200 pts/sec in units of g .  Format: (8f9.6)       V1

V2 goes on with velocity and displacement, which are passed over.
"""

from __future__ import annotations

import math
import re

from eventpound.motion.readers.base import Channel, Given, Reader, Source
from eventpound.motion.readers.block import Stated, block_channel
from eventpound.motion.readers.header import Header, Peak
from eventpound.motion.readers.numbers import NUMBER, to_count, to_float

_TITLE = re.compile(r"(UN)?CORRECTED ACCELEROGRAM\b", re.IGNORECASE)
_CHANNEL = re.compile(r"\s*CHAN\s+(\d+):\s*(.*?)\s*(?:DEG\w*)?\s*(?:FROM.*)?$", re.IGNORECASE)
_V2 = re.compile(
    rf"\s*(?P<count>\d+)\s+POINTS OF ACCEL\w* DATA EQUALLY SPACED AT\s+(?P<step>{NUMBER})\s+SEC\.?"
    r"(?:\s+\(UNITS:\s*|,\s*in\s+)(?P<units>[^)\s]+?)\s*(?:\)|\.?(?=\s|$))",
    re.IGNORECASE,
)
_V1 = re.compile(
    rf"\s*(?P<count>\d+)\s+Accelerogram points at\s+(?P<rate>{NUMBER})\s+pts/sec in units of\s+"
    r"(?P<units>\S+?)\s*\.?\s+Format:\s*\(\d+f(?P<width>\d+)",
    re.IGNORECASE,
)
_V2_WIDTH = "10"
_STATION = re.compile(r"\s*STATION NO", re.IGNORECASE)
_PEAKS = (
    re.compile(rf"PEAK ACCELERATION\s*=\s*({NUMBER})\s+(CM/SEC/SEC|G)\b", re.IGNORECASE),
    re.compile(rf"\bMax\s*=\s*({NUMBER})\s+(g)\b", re.IGNORECASE),
)


def _detect(source: Source) -> bool:
    """Whether the first line is the title and one soon after names a channel."""
    return bool(_TITLE.match(source.line(1))) and any(
        _CHANNEL.match(line) for line in source.lines[:12]
    )


def _channels(source: Source, given: Given) -> list[Channel]:
    """The channels of the file.

    Raises
    ------
    InputError
        Also where there is no line before evenly spaced accelerations.
    """
    channels: list[Channel] = []
    start = 1
    for number, line in enumerate(source.lines, start=1):
        if "points" in line.lower() and (numbers := _V2.match(line) or _V1.match(line)):
            channels.append(_channel(source, start, number, numbers, given))
            start = number + 1
        elif line.startswith("/&"):
            start = number + 1
    if not channels:
        raise source.error(
            None,
            "no line 'n POINTS OF ACCEL DATA EQUALLY SPACED AT ...' or "
            "'n Accelerogram points at ... pts/sec in units of ...'",
        )
    return channels


READER = Reader("csmip", _detect, _channels)


def _channel(
    source: Source, start: int, line: int, numbers: re.Match[str], given: Given
) -> Channel:
    """The channel whose header begins on one line and ends on another."""
    values = numbers.groupdict()
    rate = to_float(values.get("rate") or "1")
    step = to_float(values["step"]) if values.get("step") else 1.0 / rate if rate else math.nan
    header = _header(source, start, line, values["units"], step)
    stated = Stated(to_count(values["count"]), line, "points")
    width = to_count(values.get("width") or _V2_WIDTH)
    return block_channel(
        source, READER.name, header, line + 1, stated, given, width=width, ends_file=False
    )


def _header(source: Source, start: int, last: int, units: str, time_step: float) -> Header:
    """What the lines of text say."""
    component = station = event = date = None
    peak: Peak | None = None
    for number in range(start, last):
        line = source.line(number)
        if found := _CHANNEL.match(line):
            component = found.group(2) or None
            event, date, *_ = [*re.split(r"\s{3,}", source.line(number + 1).strip()), "", ""]
        if _STATION.match(line):
            station = re.split(r"\s{3,}", source.line(number + 1).strip())[0] or None
        for pattern in _PEAKS:
            if stated := pattern.search(line):
                peak = Peak(stated.group(1), stated.group(2), number)
    return Header(
        units=units,
        units_line=last,
        time_step=time_step,
        time_step_line=last,
        event=event or None,
        station=station,
        component=component,
        date=date or None,
        peak=peak,
    )
