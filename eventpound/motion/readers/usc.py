"""University of Southern California, uncorrected accelerograms (Volume I), of all times.

13 lines of text, 100 integers, 50 reals, then pairs (t, a), digitised where the
film has its turns, so unevenly: straight lines between them are sampled at a
time step that has to be given. ``UNITS ARE SEC AND G/10``.
"""

from __future__ import annotations

import re

import numpy as np

from eventpound.motion.readers.base import Channel, Given, Reader, RecordData, Source, UnstatedError
from eventpound.motion.readers.block import Stated, after_last, read_block
from eventpound.motion.readers.header import Header, record_data
from eventpound.motion.readers.numbers import NUMBER, to_count, to_float
from eventpound.numerics.arrays import Floats

_FIRST = re.compile(r"FILE\s+\d+ OF UNCORRECTED ACCELEROGRAM DATA OF VOLUME I\b")
_TEXT_LINES = 13
_INTEGERS, _INTEGER_WIDTH = 100, 5
_REALS, _REAL_WIDTH = 50, 10
_COUNT = re.compile(r"NO\. OF POINTS\s*=\s*(\d+)")
_UNITS = re.compile(rf"UNITS ARE SEC AND\s+(\S+?)(?:/({NUMBER}))?\s+\d*\s*$")
_MOST_OF_EACH = 1000
"""Even samples for each uneven one, at most."""
_TRAILING_COUNT = re.compile(r"\s{3,}\d+\s*$")
"""Each line of text ends with the number of its characters."""


def _detect(source: Source) -> bool:
    """Whether the first line is that of a Volume I file."""
    return bool(_FIRST.match(source.line(1)))


def _channels(source: Source, given: Given) -> list[Channel]:
    """The one component."""
    text = {i: source.line(i) for i in range(1, _TEXT_LINES + 1)}
    count_line, count = _find(source, _COUNT, "NO. OF POINTS =")
    units_line, units = _find(source, _UNITS, "UNITS ARE SEC AND")
    divisor = to_float(units.group(2) or "1")
    if not divisor > 0.0:
        raise source.error(units_line, f"units {units.group(0)!r}; a positive divisor is expected")
    component = _TRAILING_COUNT.sub("", text[7]).removeprefix("COMP").strip() or None
    header = Header(
        units=f"{1.0 / divisor:g} {units.group(1)}",
        units_line=units_line,
        event=_TRAILING_COUNT.sub("", text[2]).strip() or None,
        station=_TRAILING_COUNT.sub("", text[6]).strip() or None,
        component=component,
        date=_TRAILING_COUNT.sub("", text[3]).strip() or None,
    )
    pairs = Stated(2 * to_count(count.group(1)), count_line, "twice the NO. OF POINTS")

    def read() -> RecordData:
        integers = read_block(
            source, _TEXT_LINES + 1, Stated(_INTEGERS, 1, "integers"), _INTEGER_WIDTH
        )
        reals = read_block(source, integers.next_line, Stated(_REALS, 1, "reals"), _REAL_WIDTH)
        block = read_block(source, reals.next_line, pairs)
        notes = after_last(source, block, pairs)
        t, a = block.values[0::2], block.values[1::2]
        values, note = _sampled(source, reals.next_line, t, a, given.time_step)
        return record_data(source, READER.name, header, values, given, (*notes, note))

    return [Channel(component, read)]


READER = Reader("usc", _detect, _channels)


def _find(source: Source, pattern: re.Pattern[str], expected: str) -> tuple[int, re.Match[str]]:
    """Line and match of what one of the lines of text says."""
    for number in range(1, _TEXT_LINES + 1):
        if found := pattern.search(source.line(number)):
            return number, found
    raise source.error(None, f"'{expected}' is in none of the first {_TEXT_LINES} lines")


def _sampled(
    source: Source, first_line: int, t: Floats, a: Floats, time_step: float | None
) -> tuple[Floats, str]:
    """Values at even times of the straight lines between uneven ones, and a note on it."""
    steps = np.diff(t)
    if np.any(steps <= 0.0):
        i = int(np.argmax(steps <= 0.0))
        raise source.error(
            None,
            f"time goes from {t[i]:g} to {t[i + 1]:g} s at pair {i + 2} from line {first_line}",
        )
    if time_step is None:
        raise UnstatedError(
            f"{source.file}: its {t.size} samples are {steps.min():.3g} to {steps.max():.3g} s "
            'apart; give time_step = "... s" to have straight lines between them sampled evenly',
            ["time_step"],
        )
    count = (t[-1] - t[0]) / time_step + 1e-9
    if not 1.0 <= count < _MOST_OF_EACH * t.size:
        raise source.error(
            None, f"{t[-1] - t[0]:g} s of {t.size} samples cannot be sampled every {time_step:g} s"
        )
    even = t[0] + time_step * np.arange(int(count) + 1)
    values = np.interp(even, t, a)
    note = (
        f"{t.size} samples at uneven times, straight lines between them taken every "
        f"{time_step:g} s; peak {np.max(np.abs(a)):g}, of those taken {np.max(np.abs(values)):.6g}"
    )
    return values, note
