"""USGS strong-motion CD format (SMC): 11 lines of text, 48 integers, 50 reals, comments, numbers.

The second real is the samples per second, the 16th integer the number of
comment lines, the 17th that of samples; eight numbers of ten characters a line,
which touch, in cm/s^2.
"""

from __future__ import annotations

import re

from eventpound.motion.readers.base import Channel, Given, Reader, Source
from eventpound.motion.readers.block import Stated, block_channel, read_block
from eventpound.motion.readers.header import Header, Peak
from eventpound.motion.readers.numbers import NUMBER

_TEXT_LINES = 11
_INTEGERS, _REALS = 48, 50
_COMMENTS_AT, _SAMPLES_AT, _RATE_AT = 15, 16, 1
_WIDTH = 10
_KIND = re.compile(r"\s*([0-9])\s+((?:UN)?CORRECTED ACCELEROGRAM|VELOCITY|DISPLACEMENT|.*SPECTR)")
_STATION = re.compile(r"station\s*=\s*(.*?)\s*component\s*=\s*(\S+)", re.IGNORECASE)
_EVENT = re.compile(r"\s*(\d+\s+\d+\s+\d+\s+\d+)\s+(.*?)\s*$")
_PEAK = re.compile(rf"pk(?:\s+acc)?\s*=\s*({NUMBER})")


def _detect(source: Source) -> bool:
    """Whether the first line has kind and number, and the integers are where they belong."""
    return bool(_KIND.match(source.line(1))) and source.line(2).startswith("*")


def _channels(source: Source, given: Given) -> list[Channel]:
    """The one component.

    Raises
    ------
    InputError
        Also for another kind of series.
    """
    if "ACCELEROGRAM" not in source.line(1):
        raise source.error(
            1, f"found '{source.line(1).strip()}'; an acceleration time series is needed"
        )
    integers = read_block(source, _TEXT_LINES + 1, Stated(_INTEGERS, 1, "integers"), _WIDTH)
    reals = read_block(source, integers.next_line, Stated(_REALS, 1, "reals"), 15)
    comments = int(integers.values[_COMMENTS_AT])
    stated = Stated(int(integers.values[_SAMPLES_AT]), integers.next_line - 4, "samples")
    first = reals.next_line + max(comments, 0)
    header = _header(source, float(reals.values[_RATE_AT]), integers.next_line)
    return [block_channel(source, READER.name, header, first, stated, given, width=_WIDTH)]


READER = Reader("smc", _detect, _channels)


def _header(source: Source, rate: float, rate_line: int) -> Header:
    """What the lines of text say."""
    if not rate > 0.0:
        raise source.error(rate_line, f"{rate!r} samples per second; a positive number is needed")
    station = _STATION.search(source.line(6))
    event = _EVENT.match(source.line(4))
    peak = _PEAK.search(source.line(7))
    return Header(
        units="cm/s2",
        time_step=1.0 / rate,
        time_step_line=rate_line,
        event=event.group(2) if event else None,
        date=" ".join(event.group(1).split()) if event else None,
        station=station.group(1) if station else None,
        component=station.group(2) if station else None,
        peak=Peak(peak.group(1), "cm/s2", 7) if peak else None,
    )
