"""PEER accelerograms (AT2): a header with NPTS and DT, then NPTS numbers.

Five headers are in use. Four of them end with ``NPTS= 4000, DT= .0100 SEC``
(NGA-West2, with and without filter poles after it; PEER 2000, also ``dt=``
without SEC; Pacific Engineering), NGA-West1 with ``4000 0.0100 NPTS, DT``. The
line before says ``... IN UNITS OF G``; the one before that names event, date,
station and component. Some files have more lines of free text instead.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from eventpound.errors import InputError
from eventpound.motion.readers.base import Reader, RecordData, Source
from eventpound.motion.readers.checks import (
    agreed_time_step,
    agreed_units,
    samples_in_si,
    unreadable,
)
from eventpound.motion.readers.numbers import NUMBER, split_token, to_float

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


@dataclass(frozen=True)
class _Header:
    """What stands before the numbers; `line` (from 1) is the line of NPTS and DT."""

    line: int
    count: int
    time_step: float
    units: str | None
    units_line: int | None
    event: str | None = None
    date: str | None = None
    station: str | None = None
    component: str | None = None


def _detect(source: Source) -> bool:
    """Whether one of the first lines states NPTS and DT."""
    return _count_line(source) is not None


def _read(source: Source, units: str | None, time_step: float | None) -> RecordData:
    """Read the record; the arguments may confirm what the header says.

    Raises
    ------
    InputError
        Without NPTS and DT or units, for another kind of series, a number that
        cannot be read, or a count other than NPTS.
    """
    header = _read_header(source)
    unit, factor = agreed_units(source, header.units, header.units_line, units)
    dt = agreed_time_step(source, header.time_step, header.line, time_step)
    values, notes = _read_values(source, header)
    return RecordData(
        acceleration=samples_in_si(source, values, factor),
        time_step=dt,
        units=unit,
        format=READER.name,
        file=source.file,
        sha256=source.sha256,
        event=header.event,
        station=header.station,
        component=header.component,
        date=header.date,
        notes=notes,
    )


READER = Reader("at2", _detect, _read)


def _count_line(source: Source) -> tuple[int, re.Match[str]] | None:
    """Number (from 1) and match of the line that states NPTS and DT."""
    for number, line in enumerate(source.lines[:_LONGEST_HEADER], start=1):
        for pattern in _COUNT_AND_STEP:
            if found := pattern.search(line):
                return number, found
    return None


def _read_header(source: Source) -> _Header:
    """Read the lines up to the one with NPTS and DT."""
    found = _count_line(source)
    if found is None:
        raise source.error(
            None,
            f"not a PEER AT2 file: none of the first {_LONGEST_HEADER} lines states "
            "NPTS and DT; expected 'NPTS= 4000, DT= .0100 SEC' or '4000 0.0100 NPTS, DT'",
        )
    number, match = found
    units, units_line = None, None
    identity: dict[str, str | None] = {}
    for i, line in enumerate(source.lines[: number - 1], start=1):
        if re.search(r"\b(VELOCITY|DISPLACEMENT)\s+TIME", line, re.IGNORECASE):
            raise source.error(i, f"found '{line.strip()}'; an acceleration time series is needed")
        if units is None and (stated := _UNITS.search(line)):
            units, units_line = stated.group(1), i
        if not identity and _DATE.search(line):
            identity = _identify(line)
    return _Header(
        number, int(match.group(1)), to_float(match.group(2)), units, units_line, **identity
    )


def _identify(line: str) -> dict[str, str | None]:
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


def _read_values(source: Source, header: _Header) -> tuple[list[float], tuple[str, ...]]:
    """Exactly NPTS numbers; text after the last of them is noted and passed over."""
    values: list[float] = []
    problems: list[tuple[int, str]] = []
    notes: tuple[str, ...] = ()
    for number, line in enumerate(source.lines[header.line :], start=header.line + 1):
        tokens = line.split()
        parts = [split_token(token) for token in tokens]
        if len(values) == header.count and tokens and all(part is None for part in parts):
            notes = (f"line {number}: text after the last sample passed over: '{line.strip()}'",)
            break
        for token, part in zip(tokens, parts, strict=True):
            if part is None:
                problems.append((number, token))
            else:
                values += [to_float(text) for text in part]
    messages = unreadable(source, problems)
    found = len(values) + len(problems)
    if found < header.count or (found > header.count and not problems):
        messages.append(
            f"{source.file}: {len(values)} numbers found up to line {_last_line(source)}; "
            f"line {header.line} states NPTS = {header.count}"
        )
    if messages:
        raise InputError(messages)
    return values, notes


def _last_line(source: Source) -> int:
    """Number (from 1) of the last line that is not blank."""
    return max(i for i, line in enumerate(source.lines, start=1) if line.strip())
