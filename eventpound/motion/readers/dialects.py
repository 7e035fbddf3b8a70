"""Formats with a few lines of text before the numbers, a `Dialect` each."""

from __future__ import annotations

import re

import numpy as np

from eventpound.motion.readers.base import Given, Source
from eventpound.motion.readers.block import StatedCount, after_last, read_block
from eventpound.motion.readers.header import (
    Extent,
    line_like,
    named_groups,
    of_length,
    until_like,
    while_like,
    word_pattern,
)
from eventpound.motion.readers.labelled import Dialect, Labelled, Trace, plain_numbers
from eventpound.motion.readers.numbers import NUMBER, numbers_of_line, to_count, to_float

# PEER (AT2). Five headers are in use. Four end with "NPTS= 4000, DT= .0100 SEC" (NGA-West2, with
# and without filter poles after it; PEER 2000, also "dt=" without SEC; Pacific Engineering),
# NGA-West1 with "4000 0.0100 NPTS, DT". The line before says "... IN UNITS OF G"; the one before
# that is "EVENT[,] DATE[[,] TIME], STATION, COMPONENT (...)". Some files have more lines of text.

_LONGEST_AT2 = 30
_COUNT_AND_STEP = (
    word_pattern(rf"\bNPTS?\s*[=:]?\s*(?P<NPTS>\d+)\b.*\b(?:DT|TSTEP)\s*[=:]?\s*(?P<DT>{NUMBER})"),
    word_pattern(rf"^\s*(?P<NPTS>\d+)[\s,]+(?P<DT>{NUMBER})[\s,]+NPTS\s*,\s*DT"),
)
_DATE = re.compile(r"\d{1,2}/\d{1,2}/\d{2,4}")
_TIME_OF_DAY = re.compile(r"^[\s,]*\d{1,2}:?\d{2}\b")
_REMARK = re.compile(r"[\s,]*\([^()]*\)\s*$")


def _at2_end(source: Source) -> tuple[int, re.Match[str]] | None:
    """Number (from 1) and match of the line that states NPTS and DT."""
    for number, line in enumerate(source.lines[:_LONGEST_AT2], start=1):
        for pattern in _COUNT_AND_STEP:
            if found := pattern.search(line):
                return number, found
    return None


def _at2_extent(source: Source) -> list[Extent]:
    found = _at2_end(source)
    if found is None:
        raise source.error(
            None,
            f"not a PEER AT2 file: none of the first {_LONGEST_AT2} lines states "
            "NPTS and DT; expected 'NPTS= 4000, DT= .0100 SEC' or '4000 0.0100 NPTS, DT'",
        )
    end, match = found
    dated = enumerate(source.lines[: end - 1], start=1)
    number, line = next(((i, x) for i, x in dated if _DATE.search(x)), (0, ""))
    return [Extent(1, end - 1, end, named_groups(match, end) | _at2_identity(line, number))]


def _at2_identity(line: str, number: int) -> dict[str, tuple[str, int]]:
    """Event, date, station and component of the line with a date; without one, nothing."""
    if not line:
        return {}
    event, date, after = re.split(rf"({_DATE.pattern})", line, maxsplit=1)
    after = _REMARK.sub("", _TIME_OF_DAY.sub("", after))
    fields = [field.strip() for field in after.split(",") if field.strip()]
    return {
        "event": (event.strip(" ,"), number),
        "date": (date, number),
        "station": (", ".join(fields[:-1]), number),
        "component": (fields[-1] if fields else "", number),
    }


AT2 = Dialect(
    name="at2",
    begins=(),
    also=lambda source: _at2_end(source) is not None,
    extents=_at2_extent,
    patterns=(
        r"^(?P<kind>.*\b(VELOCITY|DISPLACEMENT) +TIME.*)$",
        r"\bUNITS? *(?:OF|ARE|IN|:|=) *\(? *(?P<units>[A-Z]+(?:/[A-Z0-9/^*]+)?)",
    ),
    kind=("kind", "ACCELERATION", "an acceleration time series"),
    count="NPTS",
    step="DT",
)

# Engineering Strong Motion database and ITACA (DYNA ASCII): 64 lines of labels, one column.
ESM = Dialect(
    name="esm",
    begins=("EVENT_NAME:", "EVENT_ID:"),
    extents=while_like(r"[A-Z][A-Z0-9_/^.-]*:"),
    parted=":",
    kind=("DATA_TYPE", "ACCELERATION(?!.*SPECTR)", "an acceleration time series"),
    count="NDATA",
    step="SAMPLING_INTERVAL_S",
    units="UNITS",
    event="EVENT_NAME|EVENT_ID",
    station=("STATION_CODE", "STATION_NAME"),
    component="STREAM|COMPONENT",
    date="EVENT_DATE_YYYYMMDD",
    peak=("PGA_CM/S^2", "cm/s2"),
)

# Turkish national network (AFAD, TR-NSMN): three columns, in the unit of the label of the peaks.
AFAD = Dialect(
    name="afad",
    begins=("STRONG GROUND MOTION RECORDS OF TURK",),
    extents=until_like(
        r"\s*N-S\s+E-W(\s|$)", 40, "no line of titles 'N-S E-W U-D' before the numbers"
    ),
    parted=":",
    patterns=(r"^RAW PGA VALUES \((?P<units>.+?)\)", r"^(?P<titles>\s*N-S\s+E-W(\s.*)?)\Z"),
    columns=("titles", r"\S+"),
    count="NUMBER OF DATA",
    step="SAMPLING INTERVAL (sec)",
    event="EARTHQUAKE DATE",
    station="STATION ID",
    date="RECORD TIME",
    column_peak=rf"^RAW PGA VALUES .*\({{}}\)\s*({NUMBER})",
)

# Reprocessed Italian records as RESORCE has them: five numbers a line, which may touch. The
# line before them says "Accelaration time series in m/s/s" (so spelt).
_ITACA_END = r"\s*Acc\w+ time series in\s+\S"
ITACA = Dialect(
    name="itaca",
    begins=("Event Date & Time",),
    also=lambda source: line_like(source, _ITACA_END, within=20) > 0,
    extents=until_like(
        _ITACA_END, 20, "no line 'Acceleration time series in ...' before the numbers"
    ),
    parted=":",
    patterns=(r"^\s*Acc\w+ time series in\s+(?P<units>\S+).*\Z",),
    count="Number of Data",
    step="Time Increment (s)",
    station="Station Code / Name",
    component="Orientation",
    date="Event Date & Time",
    peak=("PGA (m/s/s)", "m/s2"),
    width=14,
)

# ITSAK text: labels, a ruled line, a column for each of "components: E N Z".
ITSAK = Dialect(
    name="itsak",
    begins=("type of record:",),
    extents=until_like(r"-{5,}\*+-{5,}", 30, "no ruled line before the numbers"),
    parted=":",
    columns=("components", r"\S+"),
    kind=("type of record", "accelerogram", "an accelerogram"),
    count="npts",
    rate="sampling frequency",
    station="station name",
    date="datetime of first sample",
)

# Mexican standard file (UNAM and the networks that share it), version 2.0: Spanish labels, then a
# column a channel under two ruled lines, between which their names stand.
_RULED = r"-+\+[-+]+\s*$"
UNAM = Dialect(
    name="unam",
    begins=(),
    also=lambda source: line_like(source, r"\s*ARCHIVO ESTANDAR DE ACELERACION", within=20) > 0,
    extents=until_like(_RULED, 200, "no ruled line '----+----' before the numbers"),
    parted=":",
    patterns=(
        r"^UNIDADES DE LOS DATOS\s*:\s*(?P<units>[^\s(]+)",
        rf"^(?P<titles>.*\S.*)\n{_RULED}\Z",
    ),
    columns=("titles", r"\S+"),
    count="NUM. TOTAL DE MUESTRAS, C1-C6",
    step="INTERVALO DE MUESTREO, C1-C6 (s)",
    station=("CLAVE DE LA ESTACION", "NOMBRE DE LA ESTACION"),
    date="FECHA DEL SISMO [GMT]",
)

# China Strong Motion Networks Center (CSMNC): one component, some 16 lines of text.
CSMNC = Dialect(
    name="csmnc",
    begins=(),
    also=lambda source: line_like(source, r"NO\. OF POINTS\s*:.*EQUALLY SPACED", within=25) > 0,
    extents=while_like(r"(?=.*[^\W\dE_])|\s*$"),
    patterns=(
        r"^(?P<kind>.*?)\s+UNIT\s*:\s*(?P<units>\S+)",
        rf"^NO\. OF POINTS\s*:\s*(?P<points>\d+).*INTERVALS OF\s*:\s*(?P<step>{NUMBER})",
        rf"^PEAK VALUE\s*:\s*(?P<peak>{NUMBER})",
        r"^STATION\s*:\s*(?P<station>\S+)",
        r"^COMP\w*[.:]*\s*(?P<component>\S+)",
        r"\A.*\n(?:\S+ +)?(?P<date>.*)\n(?P<event>.*)",
    ),
    kind=("kind", ".*ACCEL", "an acceleration time series"),
    count="points",
    step="step",
    peak=("peak", "cm/s2"),
)

# Central Weather Bureau of Taiwan: "#label: value", then time and components;
# "#DataSequence: Time U(+); N(+); E(+)" names the columns.
CWB = Dialect(
    name="cwb",
    begins=("#Earthquake Information",),
    also=lambda source: line_like(source, "#DataSequence:", within=40) > 0,
    extents=while_like(r"#|\s*$"),
    parted=":",
    patterns=(r"^#AmplitudeUnit:\s*(?P<units>\w+)",),
    columns=("#DataSequence", r"([A-Z])\([+-]\)"),
    timed=True,
    rate="#SampleRate(Hz)",
    duration="#RecordLength(sec)",
    event="#Origin Time(GMT+08)",
    station=("#StationCode", "#StationName"),
    date="#StartTime(GMT+08)",
    column_peak=rf"^#AmplitudeMAX\. {{}}:\s*({NUMBER})\s*~\s*({NUMBER})",
)

# K-NET and KiK-net (NIED): 17 lines, labels in 18 characters, then counts. "Scale Factor
# 7845(gal)/8223790" turns them into gal. Their zero is arbitrary, so the mean is removed, as
# NIED does for its "Max. Acc.". "Dir." is a number in KiK-net: 1 to 3 in the borehole, 4 to 6
# at the surface.

_SCALE = word_pattern(rf"({NUMBER})\s*\((gal)\)\s*/\s*({NUMBER})")


def _knet_numbers(dialect: Dialect, head: Labelled, stated: StatedCount, given: Given) -> Trace:
    """Counts as gal, less their mean."""
    text = head.text("Scale Factor")
    scale = _SCALE.search(text or "")
    if scale is None or to_float(scale.group(3)) == 0.0:
        raise head.source.error(
            head.line("Scale Factor"),
            f"found '{text}'; a factor like '7845(gal)/8223790' is expected",
        )
    counts, notes, _ = plain_numbers(dialect, head, stated, given)
    values = counts * (to_float(scale.group(1)) / to_float(scale.group(3)))
    mean = float(np.mean(values))
    return Trace(values - mean, (f"mean of {mean:.6g} gal removed", *notes))


KNET = Dialect(
    name="knet",
    begins=("Origin Time",),
    also=lambda source: source.line(17).casefold().startswith("memo"),
    extents=of_length(17),
    parted=18,
    patterns=(r"^Scale Factor.*\((?P<units>gal)\)",),
    needs=("Scale Factor",),
    rate="Sampling Freq(Hz)",
    duration="Duration Time(s)",
    event="Origin Time",
    station="Station Code",
    component="Dir.",
    renamed={"1": "NS1", "2": "EW1", "3": "UD1", "4": "NS2", "5": "EW2", "6": "UD2"},
    date="Record Time",
    peak=("Max. Acc. (gal)", "gal"),
    width=9,
    numbers=_knet_numbers,
)

# Older ITSAK files: two lines of header, then the numbers in a Fortran format.
#     A299_T  ITSAK CHALANDRI STATION         5702 Values
#     (8F15.0)             0.005
# The second line has the format and the time step (s); units are not stated. The last line of
# samples is filled up, and lines of zeros follow; both are dropped.

_NAMED = word_pattern(
    r"\s*\S*?(_(?P<component>[^_\s]*))?\s+(?P<station>.*?)\s+(?P<Values>\d+)\s+Values\s*$"
)
_FORMAT = word_pattern(
    rf"\s*\((?P<a_line>\d+)[FEG](?P<width>\d+)\.\d+\)\s+(?P<time_step>{NUMBER})\s*$"
)


def _two_lines(source: Source) -> list[Extent]:
    first, second = _NAMED.match(source.line(1)), _FORMAT.match(source.line(2))
    if first is None or second is None:
        raise source.error(
            1, "not an ITSAK header; expected 'NAME STATION 5702 Values', then '(8F15.0) 0.005'"
        )
    return [Extent(1, 2, 2, named_groups(first, 1) | named_groups(second, 2))]


def _filled_numbers(dialect: Dialect, head: Labelled, stated: StatedCount, given: Given) -> Trace:
    """The stated number of numbers, and a note on what fills up the last lines."""
    source, first = head.source, head.extent.end + 1
    a_line, width = head.count("a line").count, to_count(head.text("width") or "")
    lines = -(-stated.count // a_line)
    last = source.line(first + lines - 1)
    excess = len(numbers_of_line(last, width)[0]) + (lines - 1) * a_line - stated.count
    full = StatedCount(stated.count + max(excess, 0), stated.line, stated.name)
    block = read_block(source, first, full, width)
    values, fill = block.values[: stated.count], block.values[stated.count :]
    line = block.next_line
    while (row := numbers_of_line(source.line(line), width)[0]) and not any(row):
        fill = np.concatenate([fill, row])
        line += 1
    notes = after_last(source, line, stated)
    if fill.size:
        notes += (
            f"{fill.size} numbers after the {stated.count} {stated.name} that line "
            f"{stated.line} states passed over; the largest is {np.max(np.abs(fill)):g}",
        )
    return Trace(values, notes)


ITSAK_FIXED = Dialect(
    name="itsak-fixed",
    begins=(_NAMED.pattern, _FORMAT.pattern),
    extents=_two_lines,
    count="Values",
    step="time step",
    numbers=_filled_numbers,
)
