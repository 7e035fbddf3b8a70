"""Formats that descend from the tapes of Caltech, Volume I (uncorrected) and II (corrected).

A head is text, integers and reals. In Volume I these are 13 lines, 7 and 7, and pairs (t, a)
follow, digitised where the film has its turns, so unevenly: straight lines between them are
sampled at a time step that has to be given. Pairs at even times are the samples themselves.

Sources: D. E. Hudson et al., Strong Motion Earthquake Accelerograms, EERL, Caltech (1969-1975), and
files of each agency, among them those that the tests of gmprocess (USGS) hold.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.readers.base import Given, Source, UnstatedError
from eventpound.motion.readers.block import END_OF_CHANNEL, StatedCount, numbers_of_block
from eventpound.motion.readers.header import Extent, Extents, line_like, named_groups, word_pattern
from eventpound.motion.readers.labelled import Dialect, Labelled, Trace
from eventpound.motion.readers.numbers import NUMBER, to_float
from eventpound.motion.readers.time_column import even_step
from eventpound.numerics.arrays import Floats

_TEXT, _HEAD = 13, 27
"""Lines of text, and of text, integers and reals, in Volume I."""
_MOST_OF_EACH = 1000
"""Even samples for each uneven one, at most."""
_UNITS = "UNITS ARE SEC AND"
_UNITS_LIKE = rf"\s*UNITS\b.*\bARE SEC\w* AND\s+([^\s/.]+)(?:/({NUMBER}))?"


def _heads(first: str) -> Extents:
    """A head of Volume I from each line that a pattern matches."""
    like, units_like = word_pattern(first), word_pattern(_UNITS_LIKE)

    def extent(source: Source, start: int) -> Extent:
        known = {}
        for number in range(start, start + _TEXT):
            if units := units_like.match(source.line(number)):
                divisor = to_float(units.group(2) or "1")
                if not divisor > 0.0:
                    found = source.line(number).strip()
                    raise source.error(number, f"units {found!r}; a positive divisor is expected")
                known[_UNITS] = (f"{1.0 / divisor:g} {units.group(1)}", number)
        return Extent(start, start + _TEXT - 1, start + _HEAD - 1, known)

    def extents(source: Source) -> list[Extent]:
        lines = enumerate(source.lines, start=1)
        found = [extent(source, i) for i, line in lines if like.match(line)]
        if not found:
            raise source.error(1, "not a file of Volume I; no line begins as its heads do")
        return found

    return extents


def _pairs(dialect: Dialect, head: Labelled, stated: StatedCount, given: Given) -> Trace:
    """Values at even times of the straight lines between pairs (t, a), and a note on it."""
    source, time_step, first = head.source, given.time_step, head.extent.end + 1
    pairs = StatedCount(2 * stated.count, stated.line, f"twice the {stated.name}")
    numbers, notes = numbers_of_block(source, first, pairs, dialect.width)
    t, a = numbers[0::2], numbers[1::2]
    steps = np.diff(t)
    if np.any(steps <= 0.0):
        i = int(np.argmax(steps <= 0.0))
        raise source.error(
            None, f"time goes from {t[i]:g} to {t[i + 1]:g} s at pair {i + 2} from line {first}"
        )
    if step := _even(source, t, first):
        return Trace(a, notes, step)
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
    return Trace(values, (*notes, note))


def _even(source: Source, t: Floats, line: int) -> float | None:
    """The step of times with three decimals (s); None where they are uneven."""
    try:
        return even_step(source, [f"{time:.3f}" for time in t], [line] * t.size)
    except InputError:
        return None


# University of Southern California, Volume I. The lines of text end with the number of their
# characters. "UNITS ARE SEC AND G/10".
_USC_FIRST = r"FILE\s+\d+ OF UNCORRECTED ACCELEROGRAM DATA OF VOLUME I\b"
USC = Dialect(
    name="usc",
    begins=(_USC_FIRST,),
    extents=_heads(_USC_FIRST),
    patterns=(
        r"NO\. OF POINTS\s*=\s*(?P<NO_OF_POINTS>\d+)",
        r"\A.*\n(?P<event>.*?)( {3,}\d.*)?\n(?P<date>.*?)( {3,}\d.*)?\n",
        r"\A(.*\n){5}(?P<station>.*?)( {3,}\d.*)?\n(COMP)?(?P<component>.*?)( {3,}\d.*)?\n",
    ),
    needs=(_UNITS,),
    count="NO OF POINTS",
    units=_UNITS,
    numbers=_pairs,
)

# A line "CHAN  1: 360 DEG     Location: Abutment 1", or of one component "COMP S58W". What
# follows degrees, up or down is a location without a word before it, too: "90 Deg Roof".
_CSMIP_CHANNEL = r"^ *(?:(?P<channel>CHAN +\d+):|COMP\b)"
_NAME = (
    r" *(?P<component>(?P<sure>\d+(?= *(?:DEG|°))|(?:UP|DOWN)\b)|\S.*?) *(?:DEG\w*\.?|°)?[ ,]*"
    r"(?:Loc\w*\.?: *(?P<location>.*?) *|FROM.*|\(.*| {3,}.*|(?(sure)(?P<place>\S.*?) *|(?!)))?"
)
_OTHER_NAMES = "channel", "location|place"

# California Strong Motion Instrumentation Program (CSMIP, CDMG), uncorrected records of film, and
# RENADIC (Universidad de Chile), in its layout: a head for each channel, "/&" after its pairs.
_UNCORRECTED = r"UNCORRECTED ACCELEROGRAM\b"
CDMG = Dialect(
    name="cdmg",
    begins=(_UNCORRECTED,),
    also=lambda source: (
        line_like(source, _UNITS_LIKE, _TEXT) > 0 and not line_like(source, _POINTS_LIKE, 60)
    ),
    extents=_heads(_UNCORRECTED),
    patterns=(
        r"NO\. OF POINTS\s*=\s*(?P<NO_OF_POINTS>\d+)",
        r"\A.*\n(?P<event>.*)\n(?P<date>.*?)(?: {3,}.*)?\n",
        r"^ *STATION NO.*\n *(?P<station>.*?)(?: {3,}.*)?\n" + _CSMIP_CHANNEL + _NAME + "$",
        rf"\bMAX\s*=\s*(?P<peak>{NUMBER})\s+(?P<peak_units>G)\b",
    ),
    needs=(_UNITS,),
    count="NO OF POINTS",
    units=_UNITS,
    width=7,
    numbers=_pairs,
    other_names=lambda head: tuple(head.text(key) or "" for key in _OTHER_NAMES),
)

# Building and Housing Research Centre of Iran (BHRC, ISMN): Volume I of even samples, not pairs,
# after lines of integers and reals that are cut off. The seventh real is their rate.
_BHRC_FIRST = r"\*\s*VOL1\w* FILE"
_RATE_AT = 21
"""Lines from the first to the one that the seventh real begins."""


def _bhrc_extents(source: Source) -> Iterator[Extent]:
    """Its heads, with the rate."""
    for head in _heads(_BHRC_FIRST)(source):
        line = head.start + _RATE_AT
        rate = " ".join(source.line(line).split()[:1])
        yield replace(head, known={**head.known, "rate": (rate, line)})


BHRC = Dialect(
    name="bhrc",
    begins=(_BHRC_FIRST,),
    extents=_bhrc_extents,
    patterns=(
        r"NO\. OF POINTS\s*=\s*(?P<NO_OF_POINTS>\d+)\s+DURATION\s*=\s*(?P<duration>\S+)",
        r"^Origin Time\s*:\s*(?P<date>.*)",
        r"^(?P<station>.*?) +Station\b.*?Azimuth\s+L\s*(?P<L>\d+)\s+T\s*(?P<T>\d+)",
        r"^COMP\s+(?P<component>[A-Z]+)",
    ),
    needs=(_UNITS,),
    count="NO OF POINTS",
    rate="rate",
    duration="duration",
    units=_UNITS,
    other_names=lambda head: (head.text(head.text("component") or "") or "",),
)

# CSMIP (CDMG), V1 with a time step and V2, and Volume II of USC and Caltech. For each channel some
# 45 lines of head, then the numbers after one of four lines:
#     3251 POINTS OF ACCEL DATA EQUALLY SPACED AT  .020 SEC.  (UNITS: CM/SEC/SEC)     V2
#     12000 points of accel data equally spaced at  .005 sec, in cm/sec2.
#     1887 POINTS OF ACC DATA EQUALLY SPACED AT   .020 SEC.  IN UNITS CM/SEC/SEC      Volume II
#     13200 Accelerogram points at 200 pts/sec in units of g .  Format: (8f9.6)       V1
# The third may lack its unit, which is that of the peak. V2 goes on with velocity and
# displacement, which are passed over. A channel of a structure has a location behind its name.
_POINTS_LIKE = r"\s*\d+\s+(?:POINTS OF ACC\w* DATA EQUALLY SPACED|Accelerogram points at)\b"
_CSMIP_NUMBERS = (
    word_pattern(
        rf"\s*(?P<points>\d+)\s+POINTS OF ACC\w* DATA EQUALLY SPACED AT\s+(?P<step>{NUMBER})\s*SEC"
        r"\w*\W*(?:(?:UNITS:|in(?: units(?: of)?)?)\s*(?P<units>[^)\s]+?)\s*(?:\)|\.?(?=\s|$)))?"
    ),
    word_pattern(
        rf"\s*(?P<points>\d+)\s+Accelerogram points at\s+(?P<rate>{NUMBER})\s+pts/sec"
        r" in units of\s+(?P<units>\S+?)\s*\.?\s+Format:\s*\(\d+f(?P<width>\d+)"
    ),
)


def _csmip_extents(source: Source) -> Iterator[Extent]:
    """The channels of acceleration."""
    start = 1
    for number, line in enumerate(source.lines, start=1):
        numbers = None
        if "points" in line.casefold():
            matches = (like.match(line) for like in _CSMIP_NUMBERS)
            numbers = next(filter(None, matches), None)
        if numbers is not None:
            yield Extent(start, number, number, named_groups(numbers, number))
        if numbers or line.startswith(END_OF_CHANNEL):
            start = number + 1


CSMIP = Dialect(
    name="csmip",
    begins=(r"(UN)?CORRECTED ACCELEROGRAM\b",),
    also=lambda source: line_like(source, _CSMIP_CHANNEL, 12) > 0,
    extents=_csmip_extents,
    patterns=(
        _CSMIP_CHANNEL + _NAME + r"\n *(?P<event>.*?)(?: {3,}(?P<date>.*?)(?: {3,}.*)?)?$",
        r"^ *STATION\b.*\n *(?P<station>.*?)(?: {3,}.*)?$",
        rf"PEAK ACCELERATION\s*=\s*(?P<peak>{NUMBER})\s+(?P<peak_units>CMS?/SEC/SEC|G)\b",
        rf"\bMax\s*=\s*(?P<peak>{NUMBER})\s+(?P<peak_units>g)\b",
    ),
    count="points",
    step="step",
    rate="rate",
    units="units|peak units",
    width=10,
    ends_file=False,
    missing="no line 'n POINTS OF ACCEL DATA EQUALLY SPACED AT ...' or "
    "'n Accelerogram points at ... pts/sec in units of ...'",
    other_names=lambda head: tuple(head.text(key) or "" for key in _OTHER_NAMES),
)
