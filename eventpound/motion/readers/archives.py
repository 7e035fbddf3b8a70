"""Formats of archives that go back to tapes: text, integers and reals before the numbers."""

from __future__ import annotations

import re
from collections.abc import Iterator

from eventpound.motion.readers.base import Source
from eventpound.motion.readers.block import StatedCount, read_block
from eventpound.motion.readers.header import Extent, named_groups, word_pattern
from eventpound.motion.readers.labelled import Dialect, Labelled
from eventpound.motion.readers.numbers import NUMBER, to_count

# GeoNet (New Zealand), uncorrected (V1A) and corrected accelerograms (V2A): three components, one
# after the other, each with 16 lines of text, 10 of numbers, then the accelerations; V2A goes on
# with velocities and displacements. V1A says "Raw readings in units of 1.00 mm/s/s  at intervals
# of 0.005 s", V2A "Instrument corrected data at 0.020 sec intervals".

_GEONET_FIRST = word_pattern(r"(?:Un)?corrected accelerogram\b.*\bGNS\b")


def _geonet_extents(source: Source) -> list[Extent]:
    def extent(start: int) -> Extent:
        date = " ".join(source.line(start + 7).split())
        place = source.line(start + 2).strip()
        known = {"date": (date, start + 7), "place": (place, start + 2)}
        return Extent(start, start + 15, start + 25, known)

    lines = enumerate(source.lines, start=1)
    return [extent(i) for i, line in lines if _GEONET_FIRST.match(line)]


def _azimuth(head: Labelled) -> tuple[str, ...]:
    """The bearing N28W as degrees from north, 332."""
    bearing = re.fullmatch(r"([NS])(\d+)([EW])", (head.text("Component") or "").upper())
    if bearing is None:
        return ()
    side, degrees, other = bearing.group(1), to_count(bearing.group(2)), bearing.group(3)
    angle = degrees if side == "N" else 180 - degrees
    return (str((angle if other == "E" else -angle) % 360),)


GEONET = Dialect(
    name="geonet",
    begins=(_GEONET_FIRST.pattern,),
    extents=_geonet_extents,
    patterns=(
        r"Number of points +(?P<Number_of_points>\d+)",
        rf"data at +(?P<data_at>{NUMBER}) +sec intervals",
        rf"in units of +(?P<units>{NUMBER} +mm/s/s) +at intervals of +(?P<data_at>{NUMBER}) +s",
        rf"Acceleration:\s+peak\s+(?P<Acceleration>{NUMBER})\s+(?P<units>mm/s/s)",
        r"Component\s+(?P<Component>\S+)",
        r"Site\s+(?P<Site>\S+)",
    ),
    needs=("Site", "Component", "Acceleration"),
    count="Number of points",
    step="data at",
    station=("Site", "place"),
    component="Component",
    peak=("Acceleration", "mm/s/s"),
    width=8,
    ends_file=False,
    other_names=_azimuth,
)

# COSMOS, version 1.20 (V1 uncorrected, V2 corrected). For each channel: lines of text (their
# number stands in the first), 100 integers, 100 reals, comments, a line "7000 acceleration pts,
# approx 70 secs, units=cm/sec2(04), Format=(8F10.5)", the numbers, and a line that says that they
# end. Agencies set commas, points and blanks in that line as they like. Real 62 is the time step in
# milliseconds, real 34 that of the raw record in seconds, integer 54 the azimuth.

_COSMOS_FIRST = word_pattern(r".*\(Format v0?\d+\.\d+ with\s+(\d+) text lines\)")
_COMMENTS = word_pattern(r"\s*(\d+)\s+Comment line")
_COSMOS_NUMBERS = word_pattern(
    rf"\s*(?P<pts>\d+)\s+(?P<kind>.*?)\W*\b(?:pts|points)\b"
    rf"(?:.*?approx\w*\W*(?P<length>{NUMBER})\s*sec)?"
    r"(?:(?!approx).)*?units\s*[=:]?\s*(?P<units>[^,;.(\s]+)"
    r"(?:.*?Format\s*[=:]?\s*\(\s*\d*[FEGI](?P<width>\d+))?"
)
_AZIMUTH_AT, _UNKNOWN = 53, -999.0
_TIME_STEPS_AT = (61, 1000.0), (33, 1.0)


def _cosmos_extents(source: Source) -> Iterator[Extent]:
    """The channels of acceleration."""
    for start, line in enumerate(source.lines, start=1):
        # The pattern is slow on lines of numbers.
        first = _COSMOS_FIRST.match(line) if "(" in line else None
        if first and (extent := _cosmos_extent(source, start, start + to_count(first.group(1)))):
            yield extent


def _cosmos_extent(source: Source, start: int, line: int) -> Extent | None:
    """The channel that begins on a line, with its integers on another."""
    last = line - 1
    values: list[list[float]] = []
    for name in ("Integer-header", "Real-header"):
        match = word_pattern(rf"\s*(\d+)\s+{name} values").match(source.line(line))
        if match is None:
            raise _expected(source, line, f"'{name} values' are")
        block = read_block(source, line + 1, StatedCount(to_count(match.group(1)), line, "values"))
        values.append(block.values.tolist())
        line = block.next_line
    integers, reals = values
    if comments := _COMMENTS.match(source.line(line)):
        line += 1 + to_count(comments.group(1))
    numbers = _COSMOS_NUMBERS.match(source.line(line))
    if numbers is None:
        raise _expected(
            source,
            line,
            "a line like '7000 acceleration pts, approx 70 secs, units=cm/sec2(04), "
            "Format=(8F10.5)' is",
        )
    if "accel" not in numbers["kind"].casefold():
        return None
    if numbers["units"].casefold().startswith("count"):
        raise _expected(source, line, "accelerations and not counts, as its V1 and V2 have, are")
    known = named_groups(numbers, line) | {
        "step": (_cosmos_step(source, line, reals, numbers), line)
    }
    if len(integers) > _AZIMUTH_AT and integers[_AZIMUTH_AT] != _UNKNOWN:
        known["azimuth"] = (f"{integers[_AZIMUTH_AT]:g}", line)
    return Extent(start, last, line, known)


def _cosmos_step(source: Source, line: int, reals: list[float], numbers: re.Match[str]) -> str:
    """Time step (s), checked against the length, which is printed to a second or better."""
    steps = (reals[i] / unit for i, unit in _TIME_STEPS_AT if i < len(reals))
    step = next((step for step in steps if step > 0.0), 0.0)
    count, length = to_count(numbers["pts"]), numbers["length"]
    if not step or (length and abs(count * step - float(length)) > 1.0 + step):
        raise source.error(
            line,
            f"{count} samples in about {length or 'unknown'} s, but real 62 of the header gives a "
            f"time step of {step:g} s",
        )
    return repr(step)


def _expected(source: Source, line: int, what: str) -> Exception:
    return source.error(line, f"found '{source.line(line).strip()[:60]}'; {what} expected")


COSMOS = Dialect(
    name="cosmos",
    begins=(_COSMOS_FIRST.pattern,),
    extents=_cosmos_extents,
    patterns=(
        r"\A.*\n(?P<event>.*)",
        r"Sta Chan?:? *\S+?: *(?P<component>\d+(?= *deg)|.*?) *(?:deg\w*)? *"
        r"(?:\(|Location:|$|(?<=deg ))",
        r"Location: *(?P<location>\S.*)",
        rf"(?<!Uncor )Max\s*=\s*(?P<peak>{NUMBER})\s*(?P<peak_units>cm/s\w*2|g)\b",
        r"Code:(?P<station>.*)",
        r"Origin:(?P<date>.*)",
    ),
    count="pts",
    step="step",
    ends_file=False,
    missing="no acceleration among its series",
    other_names=lambda head: (head.text("azimuth") or "", head.text("location") or ""),
)

# USGS strong-motion CD (SMC): 11 lines of text, 48 integers, 50 reals, comments, numbers. The
# second real is the samples per second, the 16th integer the number of comment lines, the 17th
# that of samples; eight numbers of ten characters a line, which touch, in cm/s^2.

_SMC_KIND = r"\s*[0-9]\s+((UN)?CORRECTED ACCELEROGRAM|VELOCITY|DISPLACEMENT|.*SPECTR)"


_SMC_UNKNOWN = 1e37
"""Reals above are not known; 1.7e38 is written."""


def _smc_extent(source: Source) -> list[Extent]:
    kind = source.line(1)
    if "accelerogram" not in kind.casefold():
        raise source.error(1, f"found '{kind.strip()}'; an acceleration time series is needed")
    integers = read_block(source, 12, StatedCount(48, 1, "integers"), 10)
    reals = read_block(source, integers.next_line, StatedCount(50, 1, "reals"), 15)
    comments, samples = integers.values[15:17].tolist()
    if reals.values[1] > _SMC_UNKNOWN:
        raise source.error(
            integers.next_line,
            "no samples per second: an uncorrected record of uneven times; give the corrected one",
        )
    known = {
        "samples": (f"{int(samples)}", integers.next_line - 4),
        "samples per second": (repr(float(reals.values[1])), integers.next_line),
    }
    if event := re.match(r"\s*((?:\d+\s+){3}\d+)\s+(.*)", source.line(4)):
        known["date"] = (" ".join(event.group(1).split()), 4)
        known["event"] = (event.group(2).strip(), 4)
    return [Extent(1, 11, reals.next_line + max(int(comments), 0) - 1, known)]


SMC = Dialect(
    name="smc",
    begins=(_SMC_KIND, r"\*"),
    extents=_smc_extent,
    patterns=(
        r"station *= *(?P<station>.*?) *component *= *(?P<component>\S+)",
        rf"pk(?:\s+acc)?\s*=\s*(?P<peak>{NUMBER})",
    ),
    count="samples",
    rate="samples per second",
    unit="cm/s2",
    peak=("peak", "cm/s2"),
    width=10,
)
