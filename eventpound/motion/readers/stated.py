"""What words before plain numbers state: their unit, time step, number, and what they are.

``# dt = 0.01 s``, ``Sampling rate: 100 Hz``, ``UNITS OF G``, ``NPTS= 2000``. Where lines state two
different values, as of a record before and after processing, neither counts.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

from eventpound.errors import InputError
from eventpound.motion.readers.base import Source
from eventpound.motion.readers.block import StatedCount, miscounted
from eventpound.motion.readers.extents import word_pattern
from eventpound.motion.readers.header import Header
from eventpound.motion.readers.numbers import NUMBER, to_count, to_float
from eventpound.motion.readers.titles import Content, Title, title_of

_COUNT = word_pattern(
    r"(?:\bNPTS?|\b(?:NUMBER|NO\.?) OF (?:\w+ )?(?:POINTS|SAMPLES|DATA|VALUES))\W*(\d+)"
)
_STEP = word_pattern(
    r"(?:\bDT|\bTIME[ _-]?STEP|\bTSTEP|\bDELTA[ _-]?T|\bSAMPLING (?:INTERVAL|PERIOD))\b"
    rf"([^\d.\n]{{0,20}}?)({NUMBER})(\s*ms)?"
)
_RATE = word_pattern(
    rf"(?:\bsampl\w*\W+(?:rate|freq\w*)[^\d.\n]{{0,20}}?|\b(?:fs|rate)\s*[=:]\s*|\A\W*)({NUMBER})"
    r"(?=\W*(?:Hz|sps|samples\W*(?:per|/))|\W*$)"
)
_HERTZ = word_pattern(r"\b(?:Hz|sps|rate|freq\w*|fs|samples\W*(?:per|/))")
_UNIT = word_pattern(
    r"\bUNITS? *(?:OF|ARE|IN|:|=) *[(\[]? *([%A-Z]+(?:/[A-Z0-9/^*]+)?)|"
    r"(?<![\d.])(?<![\d.] )(?<![\w/])((?:[cm]?m|ft|in)/s(?:ec)?(?:\W{0,2}2|²|/s(?:ec)?)|gals?)\b"
)
LARGEST_STEP = 1.0
"""What is longer (s) is no time step, whatever words or places say."""


def step_in(text: str) -> float | None:
    """The time step (s) that words state, or their sampling rate does; None where none does."""
    if found := _STEP.search(text):
        between, number, milli = found.groups()
        step = to_float(number) * (1e-3 if milli or "ms" in between.lower() else 1.0)
    elif (found := _RATE.search(text)) and _HERTZ.search(text):
        rate = to_float(found.group(1))
        step = 1.0 / rate if rate > 0.0 else 0.0
    else:
        return None
    return step if 0.0 < step <= LARGEST_STEP else None


def count_in(text: str) -> str | None:
    """The number of samples that words state."""
    found = _COUNT.search(text)
    return found.group(1) if found else None


def _unit_in(text: str) -> Title | None:
    """The title that words are, or the unit that they state."""
    title = title_of(text)
    if title.unit is not None:
        # "PGV = 12 cm/s" is a value.
        return None if re.search(r"\d\W*$", title.name) else title
    found = _UNIT.search(text)
    title = title_of(f"[{found.group(1) or found.group(2)}]") if found else Title()
    return title if title.unit is not None else None


def stated_before(
    source: Source, end: int, numbers: Header | None = None
) -> tuple[Header, StatedCount | None]:
    """What the lines before one (from 1) state.

    Parameters
    ----------
    source : Source
        The file.
    end : int
        The line.
    numbers : Header, optional
        With the step that numbers among them state.

    Raises
    ------
    InputError
        Where they state a unit of another quantity than acceleration, and none of one, or
        another step than the numbers do.
    """
    lines = [(i, x.strip(" \t#%!/*\"'")) for i, x in enumerate(source.lines[: end - 1], start=1)]
    steps = [(step, i) for i, text in lines if (step := step_in(text)) is not None]
    counts = [(count, i) for i, text in lines if (count := count_in(text)) is not None]
    titles = [(title, i) for i, text in lines if (title := _unit_in(text)) is not None]
    units = [(one, i) for one, i in titles if one.kind is Content.ACCELERATION]
    other = [(one, i) for one, i in titles if one.kind in (Content.VELOCITY, Content.DISPLACEMENT)]
    if other and not units:
        title, line = other[0]
        assert title.kind is not None
        raise source.error(
            line,
            f"states '{title.unit}', the unit of {title.kind.value}; an acceleration is needed",
        )
    header = numbers or Header()
    if _are_one(one.factor for one, _ in units):
        header = replace(header, units=units[0][0].units, units_line=units[0][1])
    if _are_one(step for step, _ in steps):
        step, line = steps[0]
        if header.time_step not in (None, step):
            raise source.error(
                line, f"states {step!r} s, line {header.time_step_line} {header.time_step!r} s"
            )
        header = replace(header, time_step=step, time_step_line=line)
    one = _are_one(count for count, _ in counts)
    return header, StatedCount(to_count(counts[0][0]), counts[0][1]) if one else None


def _are_one(values: Iterable[object]) -> bool:
    return len(set(values)) == 1


def refuse_other_count(source: Source, stated: StatedCount | None, found: int, last: int) -> None:
    """Stop where there are not so many samples, up to a line (from 1), as are stated."""
    if stated is not None and stated.count != found:
        raise InputError(miscounted(source, stated, found, last, "samples"))
