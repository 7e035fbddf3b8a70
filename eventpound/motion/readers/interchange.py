"""Formats by which programs hand on a series: SLIST and TSPAIR, SAC as text, a count and a step."""

from __future__ import annotations

import re
from collections.abc import Iterator
from datetime import datetime
from itertools import islice, takewhile

from eventpound.motion.readers.base import Given, Source
from eventpound.motion.readers.block import StatedCount, numbers_of_block
from eventpound.motion.readers.header import Extent, Header, named_groups, word_pattern
from eventpound.motion.readers.labelled import Dialect, Labelled, Trace, refuse_other_times
from eventpound.motion.readers.numbers import NUMBER, numbers_of_line, split_token, to_float
from eventpound.motion.readers.rows import SEPARATOR
from eventpound.motion.readers.titles import LARGEST_STEP, count_in, stated_before, step_in

# EarthScope and ObsPy, described in obspy.io.ascii: a line "TIMESERIES NET_STA_LOC_CHAN_Q,
# 12 samples, 40 sps, 2003-05-29T02:13:22.043400, SLIST, INTEGER, Counts" before each series, whose
# samples run along lines (SLIST) or stand one a line behind their times (TSPAIR).

_TIMESERIES = word_pattern(
    r"\s*TIMESERIES\s+(?P<station>[^_,]*_[^_,]*)_[^_,]*_(?P<component>[^_,\s]*)[^,]*,"
    rf"\s*(?P<samples>\d+)\s*samples?\s*,\s*(?P<rate>{NUMBER})\s*sps\s*,\s*(?P<date>[^,\s]+)\s*,"
    r"\s*(?P<layout>SLIST|TSPAIR)\b\s*,?[^,]*(?:,\s*(?P<units>\S+)\s*)?$"
)


def _timeseries_extents(source: Source) -> Iterator[Extent]:
    """The series; none twice, as a channel with gaps would be."""
    names = set()
    for number, line in enumerate(source.lines, start=1):
        if found := _TIMESERIES.match(line):
            name = line.split(",")[0].split()[-1].casefold()
            if name in names:
                raise source.error(number, f"channel {name} begins again, after a gap")
            names.add(name)
            known = named_groups(found, number)
            if "units" in known and known["units"][0].casefold() in ("count", "counts"):
                del known["units"]
            yield Extent(number, number, number, known)


def _timeseries_numbers(
    dialect: Dialect, head: Labelled, stated: StatedCount, given: Given
) -> Trace:
    """Samples up to the line that begins the next series, which must be as many as stated."""
    source, first = head.source, head.extent.end + 1
    rest = enumerate(source.lines[first - 1 :], start=first)
    end = next((i for i, x in rest if _TIMESERIES.match(x)), len(source.lines) + 1)
    own = Source(source.file, "\n".join(source.lines[: end - 1]).encode())
    if (head.text("layout") or "").upper() == "TSPAIR":
        rate, _ = head.number("rate", positive=True)
        own = _without_times(own, first, rate)
    return Trace(*numbers_of_block(own, first, stated))


def _without_times(source: Source, first: int, rate: float) -> Source:
    """The file with the times left out, which must be those of the rate (Hz)."""
    lines = source.lines[: first - 1]
    times: list[datetime] = []
    for number, line in enumerate(source.lines[first - 1 :], start=first):
        time, *sample = line.split(maxsplit=1)[:2] or [""]
        if time:
            try:
                times.append(datetime.fromisoformat(time).replace(tzinfo=None))
            except ValueError as error:
                raise source.error(number, f"found {time!r}; a time is expected") from error
            off = (times[-1] - times[0]).total_seconds() - (len(times) - 1) / rate
            if abs(off) > _OFF / rate:
                raise source.error(number, f"its time is {off:g} s off those of {rate:g} Hz")
        lines.append("".join(sample))
    return Source(source.file, "\n".join(lines).encode())


_OFF = 0.1
"""How far a time may be from that of the rate, in steps; it may be rounded to milliseconds."""
TIMESERIES = Dialect(
    name="timeseries",
    begins=(_TIMESERIES.pattern,),
    extents=_timeseries_extents,
    count="samples",
    rate="rate",
    numbers=_timeseries_numbers,
)

# SAC as text ("alphanumeric"), described in the manual of SAC: 14 lines of five reals, 8 of five
# integers, 8 of names, then the samples. The first real is the time step, the tenth integer the
# number of samples, the 17th what they are (7 velocities, 6 displacements), the 36th whether their
# times are even. -12345 is what is not known. As in the other SAC, there is no unit.

_REALS, _INTEGERS, _SAC_HEAD = 14, 8, 30
_VERSION_AT, _COUNT_AT, _KIND_AT, _EVEN_AT = 6, 9, 16, 35
_KINDS = {6: "displacements", 7: "velocities"}


def _sac_head(source: Source) -> list[float] | None:
    """All reals and integers of a head; None unless it is one."""
    lines = source.lines[: _REALS + _INTEGERS]
    rows = [numbers_of_line(line, 15 if i < _REALS else 10)[0] for i, line in enumerate(lines)]
    if [len(row) for row in rows] != [5] * (_REALS + _INTEGERS):
        return None
    head = [number for row in rows for number in row]
    return head if head[5 * _REALS + _VERSION_AT] in (6.0, 7.0) and -12345.0 in head else None


def _sac_extent(source: Source) -> list[Extent]:
    head = _sac_head(source)
    if head is None:
        raise source.error(1, "not a SAC file of text: 14 lines of five reals, 8 of five integers")
    integers = [int(number) for number in head[5 * _REALS :]]
    if kind := _KINDS.get(integers[_KIND_AT]):
        raise source.error(18, f"its header says {kind}, not accelerations")
    if integers[_EVEN_AT] == 0:
        raise source.error(22, "its header says that its times are uneven")
    names = {"station": (23, 0), "component": (29, 16)}
    known = {name: (source.line(i)[at : at + 8].strip(), i) for name, (i, at) in names.items()}
    known = {name: value for name, value in known.items() if not value[0].startswith("-12345")}
    known |= {"DELTA": (repr(head[0]), 1), "NPTS": (f"{integers[_COUNT_AT]}", 16)}
    return [Extent(1, _SAC_HEAD, _SAC_HEAD, known)]


SAC_ALPHANUMERIC = Dialect(
    name="sac-alphanumeric",
    begins=(),
    also=lambda source: _sac_head(source) is not None,
    extents=_sac_extent,
    count="NPTS",
    step="DELTA",
    width=15,
)

# A head with the number of samples and the time step, then the samples, or times and samples:
# "2000 0.01", also with more whole numbers or words behind (DEEPSOIL, eqsig with a title above,
# SHAKE), one on each of two lines, or "NPTS: 2000, DT: 0.01". Nothing need state units.

_LONGEST_HEAD = 8


def _count_and_step(source: Source) -> Extent | None:
    """The shortest head that states both, where so many samples follow.

    Where words say so, or a line has just these two numbers, it is a head even if another number
    follows, which is refused then.
    """
    written = ((i, x) for i, x in enumerate(source.lines, start=1) if x.strip())
    texts = list(islice(written, _LONGEST_HEAD + 2))
    for cut in range(1, len(texts) - 1):
        first, second = (_row(text) for _, text in texts[cut : cut + 2])
        if not first or not second:
            continue
        counts, steps, told = _stated([text for _, text in texts[:cut]])
        if len(steps) != 1 or not 0.0 < to_float(steps[0]) <= LARGEST_STEP:
            continue
        line, head = texts[cut - 1]
        pairs = len(first) == len(second) == 2
        if pairs and not _begin_again(first[0], second[0], to_float(steps[0])):
            continue
        rows = (_row(x) for x in source.lines[line:])
        follow = sum(len(row) for row in rows if row) if counts else 0
        found = next((x for x in counts if to_float(x) * (1 + pairs) == follow), None)
        if (told and len(first) <= 2) or (counts and len(_row(head) or ()) == 2):
            found = counts[0]
        if found is not None:
            known = {"samples": (found, line), "step": (steps[0], line)}
            numbers = Header(time_step=to_float(steps[0]), time_step_line=line)
            words, _ = stated_before(source, line + 1, numbers)
            if words.units is not None and words.units_line is not None:
                known["units"] = (words.units, words.units_line)
            return Extent(1, line, line, known | ({"pairs": ("yes", line)} if pairs else {}))
    return None


def _stated(head: list[str]) -> tuple[list[str], list[str], bool]:
    """What may be the number of samples and the time step, and whether words of a head say so."""
    words = "\n".join(head)
    if (count := count_in(words)) and (step := step_in(words)):
        return [count], [repr(step)], True
    numbers = _leading(head[-1])
    if len(numbers) == 1 == len(_row(head[-1]) or ()) and len(head) > 1:
        numbers += _row(head[-2]) or []
    whole = [x for x in numbers if to_float(x) >= 2.0 and to_float(x).is_integer()]
    return whole, [x for x in numbers if x not in whole], False


def _begin_again(first: str, second: str, step: float) -> bool:
    """Whether times begin at zero or after one step."""
    start, off = to_float(first), to_float(second) - to_float(first) - step
    return start in (0.0, step) and abs(off) < 0.5 * step


def _leading(line: str) -> list[str]:
    """Numbers with which a line begins."""
    tokens = SEPARATOR.split(line.strip())
    return list(takewhile(lambda token: re.fullmatch(NUMBER, token), tokens))


def _row(line: str) -> list[str] | None:
    """Numbers of a line as printed; None where there is a word."""
    parts = [split_token(token) for token in SEPARATOR.split(line.strip(" \t,;"))]
    return None if None in parts else [number for part in parts for number in part or ()]


def _count_and_step_numbers(
    dialect: Dialect, head: Labelled, stated: StatedCount, given: Given
) -> Trace:
    """Samples, or those of pairs (t, a) whose times must be as stated."""
    source, first = head.source, head.extent.end + 1
    commas = Source(source.file, re.sub(rb"[,;]", b" ", source.content))
    if "pairs" not in head:
        return Trace(*numbers_of_block(commas, first, stated))
    pairs = StatedCount(2 * stated.count, stated.line, f"twice the {stated.name}")
    numbers, notes = numbers_of_block(commas, first, pairs)
    after = enumerate(commas.lines[first - 1 :], start=first)
    rows = list(islice(((i, x.split()[0]) for i, x in after if x.strip()), stated.count))
    times, lines = [time for _, time in rows], [i for i, _ in rows]
    refuse_other_times(source, times, lines, *head.number("step"))
    return Trace(numbers[1::2], notes)


def _count_and_step_extents(source: Source) -> list[Extent]:
    extent = _count_and_step(source)
    if extent is None:
        raise source.error(1, "no line with a number of samples and a time step, as '2000 0.01'")
    return [extent]


COUNT_AND_STEP = Dialect(
    name="count-and-step",
    begins=(),
    also=lambda source: _count_and_step(source) is not None,
    extents=_count_and_step_extents,
    count="samples",
    step="step",
    numbers=_count_and_step_numbers,
)
