"""PEER accelerograms (AT2): a header with NPTS and DT, then NPTS numbers.

Five headers are in use. Four of them end with ``NPTS= 4000, DT= .0100 SEC``
(NGA-West2, with and without filter poles after it; PEER 2000, also ``dt=``
without SEC; Pacific Engineering), NGA-West1 with ``4000 0.0100 NPTS, DT``. The
line before says ``... IN UNITS OF G``; the one before that names event, date,
station and component. Some files have more lines of free text instead.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

from eventpound.motion.readers.base import Channel, Given, Reader, Source
from eventpound.motion.readers.block import Stated, block_channel
from eventpound.motion.readers.header import Header
from eventpound.motion.readers.numbers import NUMBER, to_count, to_float

_LONGEST_HEADER = 30
_COUNT_AND_STEP = (
    re.compile(rf"NPTS\s*=\s*(\d+)\b.*\bDT\s*=\s*({NUMBER})", re.IGNORECASE),
    re.compile(rf"^\s*(\d+)[\s,]+({NUMBER})[\s,]+NPTS\s*,\s*DT", re.IGNORECASE),
)
_UNITS = re.compile(
    r"\bUNITS?\s*(?:OF|ARE|IN|:|=)\s*\(?\s*([A-Z]+(?:/[A-Z0-9/^*]+)?)", re.IGNORECASE
)
_DATE = re.compile(r"\d{1,2}/\d{1,2}/\d{2,4}")
_TIME_OF_DAY = re.compile(r"^[\s,]*\d{1,2}:?\d{2}\b")
_REMARK = re.compile(r"[\s,]*\([^()]*\)\s*$")


def _detect(source: Source) -> bool:
    """Whether one of the first lines states NPTS and DT."""
    return _count_line(source) is not None


def _channels(source: Source, given: Given) -> list[Channel]:
    """The one component; what the caller knows may confirm what the header says."""
    header, stated = _read_header(source)
    return [block_channel(source, READER.name, header, stated.line + 1, stated, given)]


READER = Reader("at2", _detect, _channels)


def _count_line(source: Source) -> tuple[int, re.Match[str]] | None:
    """Number (from 1) and match of the line that states NPTS and DT."""
    for number, line in enumerate(source.lines[:_LONGEST_HEADER], start=1):
        for pattern in _COUNT_AND_STEP:
            if found := pattern.search(line):
                return number, found
    return None


def _read_header(source: Source) -> tuple[Header, Stated]:
    """Read the lines up to the one with NPTS and DT.

    Raises
    ------
    InputError
        Without NPTS and DT, or for another kind of series.
    """
    found = _count_line(source)
    if found is None:
        raise source.error(
            None,
            f"not a PEER AT2 file: none of the first {_LONGEST_HEADER} lines states "
            "NPTS and DT; expected 'NPTS= 4000, DT= .0100 SEC' or '4000 0.0100 NPTS, DT'",
        )
    number, match = found
    units, units_line = None, None
    identity: dict[str, Any] = {}
    for i, line in enumerate(source.lines[: number - 1], start=1):
        if re.search(r"\b(VELOCITY|DISPLACEMENT)\s+TIME", line, re.IGNORECASE):
            raise source.error(i, f"found '{line.strip()}'; an acceleration time series is needed")
        if units is None and (stated := _UNITS.search(line)):
            units, units_line = stated.group(1), i
        if not identity and _DATE.search(line):
            identity = _identify(line)
    header = Header(units, units_line, to_float(match.group(2)), number)
    return replace(header, **identity), Stated(to_count(match.group(1)), number)


def _identify(line: str) -> dict[str, Any]:
    """Event, date, station and component: 'EVENT[,] DATE[[,] TIME], STATION, COMPONENT (...)'."""
    before, date, after = re.split(rf"({_DATE.pattern})", line, maxsplit=1)
    after = _REMARK.sub("", _TIME_OF_DAY.sub("", after))
    fields = [field.strip() for field in after.split(",") if field.strip()]
    return {
        "event": before.strip(" ,") or None,
        "date": date,
        "station": ", ".join(fields[:-1]) or None,
        "component": fields[-1] if fields else None,
    }
