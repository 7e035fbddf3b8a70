"""Formats of archives that go back to tapes: text, integers and reals before the numbers."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from eventpound.motion.readers.base import Given, Source, UnstatedError
from eventpound.motion.readers.block import StatedCount, numbers_of_block, read_block
from eventpound.motion.readers.labelled import Dialect, Extent, Labelled, groups_of
from eventpound.motion.readers.numbers import NUMBER, to_count, to_float
from eventpound.numerics.arrays import Floats

# GeoNet (New Zealand), corrected accelerograms (V2A): three components, one after the other,
# each with 16 lines of text, 10 of numbers, then acceleration, velocity and displacement.

_GEONET_FIRST = re.compile(r"(?i)Corrected accelerogram\b.*\bGNS\b")


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
    bearing = re.fullmatch(r"([NS])(\d+)([EW])", head.text("Component") or "")
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
        r"(?i)Number of points +(?P<Number_of_points>\d+)",
        rf"(?i)data at +(?P<data_at>{NUMBER}) +sec intervals",
        rf"(?i)Acceleration:\s+peak\s+(?P<Acceleration>{NUMBER})\s+(?P<units>mm/s/s)",
        r"(?i)Component\s+(?P<Component>\S+)",
        r"(?i)Site\s+(?P<Site>\S+)",
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
# end. Real 62 is the time step in milliseconds, integer 54 the azimuth.

_COSMOS_FIRST = re.compile(r"(?i).*\(Format v0?\d+\.\d+ with\s+(\d+) text lines\)")
_COMMENTS = re.compile(r"(?i)\s*(\d+)\s+Comment line")
_COSMOS_NUMBERS = re.compile(
    r"(?i)\s*(?P<pts>\d+)\s+(?P<kind>.*?)pts,\s*approx\s+(?P<length>\d+\.?\d*)\s*secs?,"
    r"\s*units\s*=\s*(?P<units>[^,(]+?)\s*\(\d+\)\s*,\s*Format\s*=\s*\((\d*[FEGI](?P<width>\d+))?"
)
_TIME_STEP_AT, _AZIMUTH_AT, _UNKNOWN = 61, 53, -999.0


def _cosmos_extents(source: Source) -> Iterator[Extent]:
    """The channels of acceleration."""
    found = False
    for start, line in enumerate(source.lines, start=1):
        # The pattern is slow on lines of numbers.
        first = _COSMOS_FIRST.match(line) if "(Format" in line else None
        if first and (extent := _cosmos_extent(source, start, start + to_count(first.group(1)))):
            found = True
            yield extent
    if not found:
        raise source.error(None, "no acceleration among its series")


def _cosmos_extent(source: Source, start: int, line: int) -> Extent | None:
    """The channel that begins on a line, with its integers on another."""
    last = line - 1
    values: list[list[float]] = []
    for name in ("Integer-header", "Real-header"):
        match = re.match(rf"(?i)\s*(\d+)\s+{name} values", source.line(line))
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
    if "accel" not in numbers["kind"].lower():
        return None
    known = groups_of(numbers, line) | {"step": (_cosmos_step(source, line, reals, numbers), line)}
    if len(integers) > _AZIMUTH_AT and integers[_AZIMUTH_AT] != _UNKNOWN:
        known["azimuth"] = (f"{integers[_AZIMUTH_AT]:g}", line)
    return Extent(start, last, line, known)


def _cosmos_step(source: Source, line: int, reals: list[float], numbers: re.Match[str]) -> str:
    """Time step (s), checked against the length, which is printed to a second or better."""
    step = reals[_TIME_STEP_AT] / 1000.0 if len(reals) > _TIME_STEP_AT else _UNKNOWN
    count, length = to_count(numbers["pts"]), float(numbers["length"])
    if not (step > 0.0 and abs(count * step - length) <= 1.0 + step):
        raise source.error(
            line,
            f"{count} samples in about {length:g} s, but real {_TIME_STEP_AT + 1} of the header "
            f"gives a time step of {step:g} s",
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
        r"(?i)Sta Chan?:? *\S+?: *(?P<component>.*?) *(?:deg\w*)? *(?:\(|$)",
        rf"(?i)(?<!Uncor )Max\s*=\s*(?P<peak>{NUMBER})\s*(?P<peak_units>cm/s\w*2|g)\b",
        r"(?i)Code:(?P<station>.*)",
        r"(?i)Origin:(?P<date>.*)",
    ),
    count="pts",
    step="step",
    ends_file=False,
    other_names=lambda head: (head.text("azimuth") or "",),
)

# California Strong Motion Instrumentation Program (CSMIP, CDMG), V1 and V2. For each channel some
# 45 lines of header, then the numbers after one of three lines:
#     3251 POINTS OF ACCEL DATA EQUALLY SPACED AT  .020 SEC.  (UNITS: CM/SEC/SEC)     V2
#     12000 points of accel data equally spaced at  .005 sec, in cm/sec2.
#     13200 Accelerogram points at 200 pts/sec in units of g .  Format: (8f9.6)       V1
# V2 goes on with velocity and displacement, which are passed over.

_CSMIP_CHANNEL = r"(?i)^ *CHAN +\d+:"
_CSMIP_NUMBERS = (
    re.compile(
        rf"(?i)\s*(?P<points>\d+)\s+POINTS OF ACCEL\w* DATA EQUALLY SPACED AT\s+(?P<step>{NUMBER})"
        r"\s+SEC\.?(?:\s+\(UNITS:\s*|,\s*in\s+)(?P<units>[^)\s]+?)\s*(?:\)|\.?(?=\s|$))"
    ),
    re.compile(
        rf"(?i)\s*(?P<points>\d+)\s+Accelerogram points at\s+(?P<rate>{NUMBER})\s+pts/sec"
        r" in units of\s+(?P<units>\S+?)\s*\.?\s+Format:\s*\(\d+f(?P<width>\d+)"
    ),
)


def _csmip_extents(source: Source) -> Iterator[Extent]:
    """The channels of acceleration."""
    start, found = 1, False
    for number, line in enumerate(source.lines, start=1):
        numbers = None
        if "points" in line.lower():
            matches = (like.match(line) for like in _CSMIP_NUMBERS)
            numbers = next(filter(None, matches), None)
        if numbers is not None:
            found = True
            yield Extent(start, number, number, groups_of(numbers, number))
        if numbers or line.startswith("/&"):
            start = number + 1
    if not found:
        raise source.error(
            None,
            "no line 'n POINTS OF ACCEL DATA EQUALLY SPACED AT ...' or "
            "'n Accelerogram points at ... pts/sec in units of ...'",
        )


CSMIP = Dialect(
    name="csmip",
    begins=(r"(?i)(UN)?CORRECTED ACCELEROGRAM\b",),
    also=lambda source: any(re.match(_CSMIP_CHANNEL, line) for line in source.lines[:12]),
    extents=_csmip_extents,
    patterns=(
        _CSMIP_CHANNEL + r" *(?P<component>.*?) *(?:DEG\w*)? *(?:FROM.*)?"
        r"\n *(?P<event>.*?)(?: {3,}(?P<date>.*?)(?: {3,}.*)?)?$",
        r"(?i)^ *STATION NO.*\n *(?P<station>.*?)(?: {3,}.*)?$",
        rf"(?i)PEAK ACCELERATION\s*=\s*(?P<peak>{NUMBER})\s+(?P<peak_units>CM/SEC/SEC|G)\b",
        rf"(?i)\bMax\s*=\s*(?P<peak>{NUMBER})\s+(?P<peak_units>g)\b",
    ),
    count="points",
    step="step",
    rate="rate",
    width=10,
    ends_file=False,
)

# USGS strong-motion CD (SMC): 11 lines of text, 48 integers, 50 reals, comments, numbers. The
# second real is the samples per second, the 16th integer the number of comment lines, the 17th
# that of samples; eight numbers of ten characters a line, which touch, in cm/s^2.

_SMC_KIND = r"\s*[0-9]\s+((UN)?CORRECTED ACCELEROGRAM|VELOCITY|DISPLACEMENT|.*SPECTR)"


def _smc_extent(source: Source) -> list[Extent]:
    kind = source.line(1)
    if "ACCELEROGRAM" not in kind:
        raise source.error(1, f"found '{kind.strip()}'; an acceleration time series is needed")
    integers = read_block(source, 12, StatedCount(48, 1, "integers"), 10)
    reals = read_block(source, integers.next_line, StatedCount(50, 1, "reals"), 15)
    comments, samples = integers.values[15:17].tolist()
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
        r"(?i)station *= *(?P<station>.*?) *component *= *(?P<component>\S+)",
        rf"pk(?:\s+acc)?\s*=\s*(?P<peak>{NUMBER})",
    ),
    count="samples",
    rate="samples per second",
    unit="cm/s2",
    peak=("peak", "cm/s2"),
    width=10,
)

# University of Southern California, uncorrected accelerograms (Volume I), of all times. 13 lines
# of text, which end with the number of their characters, 100 integers, 50 reals, then pairs (t, a),
# digitised where the film has its turns, so unevenly: straight lines between them are sampled at a
# time step that has to be given. "UNITS ARE SEC AND G/10".

_MOST_OF_EACH = 1000
"""Even samples for each uneven one, at most."""
_USC_UNITS = "UNITS ARE SEC AND"
_USC_FRACTION = re.compile(rf"{_USC_UNITS}\s+(\S+?)(?:/({NUMBER}))?\s+\d*\s*$")


def _usc_extent(source: Source) -> list[Extent]:
    lines = enumerate(source.lines[:13], start=1)
    line, units = next(((i, m) for i, x in lines if (m := _USC_FRACTION.search(x))), (0, None))
    if units is None:
        return [Extent(1, 13, 13)]
    divisor = to_float(units.group(2) or "1")
    if not divisor > 0.0:
        raise source.error(line, f"units {units.group(0)!r}; a positive divisor is expected")
    return [Extent(1, 13, 13, {_USC_UNITS: (f"{1.0 / divisor:g} {units.group(1)}", line)})]


def _usc_numbers(
    dialect: Dialect, head: Labelled, stated: StatedCount, given: Given
) -> tuple[Floats, tuple[str, ...]]:
    """Values at even times of the straight lines between uneven ones, and a note on it."""
    source, time_step = head.source, given.time_step
    integers = read_block(source, head.extent.end + 1, StatedCount(100, 1, "integers"), 5)
    reals = read_block(source, integers.next_line, StatedCount(50, 1, "reals"), 10)
    pairs = StatedCount(2 * stated.count, stated.line, f"twice the {stated.name}")
    numbers, notes = numbers_of_block(source, reals.next_line, pairs)
    t, a = numbers[0::2], numbers[1::2]
    steps = np.diff(t)
    if np.any(steps <= 0.0):
        i = int(np.argmax(steps <= 0.0))
        raise source.error(
            None,
            f"time goes from {t[i]:g} to {t[i + 1]:g} s at pair {i + 2} from line "
            f"{reals.next_line}",
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
    values = np.interp(t[0] + time_step * np.arange(int(count) + 1), t, a)
    note = (
        f"{t.size} samples at uneven times, straight lines between them taken every "
        f"{time_step:g} s; peak {np.max(np.abs(a)):g}, of those taken {np.max(np.abs(values)):.6g}"
    )
    return values, (*notes, note)


USC = Dialect(
    name="usc",
    begins=(r"FILE\s+\d+ OF UNCORRECTED ACCELEROGRAM DATA OF VOLUME I\b",),
    extents=_usc_extent,
    patterns=(
        r"NO\. OF POINTS\s*=\s*(?P<NO_OF_POINTS>\d+)",
        r"\A.*\n(?P<event>.*?)( {3,}\d+ *)?\n(?P<date>.*?)( {3,}\d+ *)?\n",
        r"\A(.*\n){5}(?P<station>.*?)( {3,}\d+ *)?\n(COMP)?(?P<component>.*?)( {3,}\d+ *)?\n",
    ),
    needs=(_USC_UNITS,),
    count="NO OF POINTS",
    units=_USC_UNITS,
    numbers=_usc_numbers,
)
