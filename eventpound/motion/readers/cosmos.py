"""COSMOS strong-motion format, version 1.20 (V1 uncorrected, V2 corrected).

For each channel: lines of text (their number stands in the first), 100
integers, 100 reals, comments, a line ``7000 acceleration pts, approx 70 secs,
units=cm/sec2(04), Format=(8F10.5)``, the numbers, and a line that says that
they end. Real 62 is the time step in milliseconds, integer 54 the azimuth.
"""

from __future__ import annotations

import re

from eventpound.motion.readers.base import Channel, Given, Reader, Source
from eventpound.motion.readers.block import Stated, block_channel, read_block
from eventpound.motion.readers.header import Header, Peak
from eventpound.motion.readers.numbers import NUMBER, to_count

_FIRST = re.compile(r".*\(Format v0?\d+\.\d+ with\s+(\d+) text lines\)", re.IGNORECASE)
_INTEGERS = re.compile(r"\s*(\d+)\s+Integer-header values", re.IGNORECASE)
_REALS = re.compile(r"\s*(\d+)\s+Real-header values", re.IGNORECASE)
_COMMENTS = re.compile(r"\s*(\d+)\s+Comment line", re.IGNORECASE)
_NUMBERS = re.compile(
    r"\s*(?P<count>\d+)\s+(?P<kind>.*?)pts,\s*approx\s+(?P<length>\d+\.?\d*)\s*secs?,"
    r"\s*units\s*=\s*(?P<units>[^,(]+?)\s*\(\d+\)\s*,\s*Format\s*=\s*\((?P<format>.*?)\)",
    re.IGNORECASE,
)
_WIDTH = re.compile(r"\d*[FEGI](\d+)", re.IGNORECASE)
_CHANNEL = re.compile(r"Sta Chan?:?\s*\S+?:\s*(.*?)\s*(?:\(|$)", re.IGNORECASE)
_PEAK = re.compile(rf"(?<!Uncor )Max\s*=\s*({NUMBER})\s*(cm/s\w*2|g)\b", re.IGNORECASE)
_STATION = re.compile(r"Code:\s*(.*?)\s*$", re.IGNORECASE)
_ORIGIN = re.compile(r"Origin:\s*(.*?)\s*$", re.IGNORECASE)
_TIME_STEP_AT, _AZIMUTH_AT, _UNKNOWN = 61, 53, -999.0


def _detect(source: Source) -> bool:
    """Whether the first line names the format."""
    return bool(_FIRST.match(source.line(1)))


def _channels(source: Source, given: Given) -> list[Channel]:
    """The channels of acceleration.

    Raises
    ------
    InputError
        Also where there is none.
    """
    starts = [i for i, line in enumerate(source.lines, start=1) if _is_first(line)]
    found = (_channel(source, start, given) for start in starts)
    channels = [channel for channel in found if channel is not None]
    if not channels:
        raise source.error(None, "no acceleration among its series")
    return channels


READER = Reader("cosmos", _detect, _channels)


def _is_first(line: str) -> bool:
    """Whether a channel begins here; the pattern is slow on lines of numbers."""
    return "(Format" in line and _FIRST.match(line) is not None


def _channel(source: Source, start: int, given: Given) -> Channel | None:
    """The channel that begins on a line; None where it is no acceleration."""
    first = _FIRST.match(source.line(start))
    assert first is not None
    line = start + to_count(first.group(1))
    values: list[list[float]] = []
    for pattern, name in ((_INTEGERS, "Integer-header"), (_REALS, "Real-header")):
        match = pattern.match(source.line(line))
        if match is None:
            raise source.error(
                line, f"found '{source.line(line).strip()[:60]}'; '{name} values' are expected"
            )
        block = read_block(source, line + 1, Stated(to_count(match.group(1)), line, "values"))
        values.append(block.values.tolist())
        line = block.next_line
    integers, reals = values
    if comments := _COMMENTS.match(source.line(line)):
        line += 1 + to_count(comments.group(1))
    numbers = _NUMBERS.match(source.line(line))
    if numbers is None:
        raise source.error(
            line,
            f"found '{source.line(line).strip()[:60]}'; a line like '7000 acceleration pts, "
            "approx 70 secs, units=cm/sec2(04), Format=(8F10.5)' is expected",
        )
    if "accel" not in numbers["kind"].lower():
        return None
    time_step = _time_step(source, line, reals, numbers)
    azimuth = integers[_AZIMUTH_AT] if len(integers) > _AZIMUTH_AT else _UNKNOWN
    width = _WIDTH.match(numbers["format"])
    return block_channel(
        source,
        READER.name,
        _header(source, start, line, numbers["units"], time_step),
        line + 1,
        Stated(to_count(numbers["count"]), line, "pts"),
        given,
        width=to_count(width.group(1)) if width else None,
        ends_file=False,
        other_names=(f"{azimuth:g}",) if azimuth != _UNKNOWN else (),
    )


def _time_step(source: Source, line: int, reals: list[float], numbers: re.Match[str]) -> float:
    """Time step (s), checked against the length, which is printed to a second or better."""
    step = reals[_TIME_STEP_AT] / 1000.0 if len(reals) > _TIME_STEP_AT else _UNKNOWN
    count, length = to_count(numbers["count"]), float(numbers["length"])
    if not (step > 0.0 and abs(count * step - length) <= 1.0 + step):
        raise source.error(
            line,
            f"{count} samples in about {length:g} s, but real {_TIME_STEP_AT + 1} of the header "
            f"gives a time step of {step:g} s",
        )
    return step


def _header(source: Source, start: int, last: int, units: str, time_step: float) -> Header:
    """What the lines of text say."""
    text = {i: source.line(i) for i in range(start, last)}
    found = {
        name: next(((i, m) for i, x in text.items() if (m := pattern.search(x))), None)
        for name, pattern in (
            ("channel", _CHANNEL),
            ("peak", _PEAK),
            ("station", _STATION),
            ("origin", _ORIGIN),
        )
    }
    peak = found["peak"]
    name = {key: None if one is None else one[1].group(1) for key, one in found.items()}
    channel = re.sub(r"\s*deg\w*$", "", name["channel"] or "", flags=re.IGNORECASE)
    return Header(
        units=units,
        units_line=last,
        time_step=time_step,
        time_step_line=last,
        event=text[start + 1].strip() or None,
        station=name["station"],
        component=channel or None,
        date=name["origin"],
        peak=None if peak is None else Peak(peak[1].group(1), peak[1].group(2), peak[0]),
    )
