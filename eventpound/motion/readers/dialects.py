"""The formats whose headers are labels and values, a `Dialect` each."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from eventpound.motion.readers.base import Source
from eventpound.motion.readers.block import Scaled
from eventpound.motion.readers.header import Peak
from eventpound.motion.readers.labelled import (
    Dialect,
    Labelled,
    line_like,
    parted_labels,
    peak_of,
    units_of,
)
from eventpound.motion.readers.numbers import NUMBER, to_count, to_float
from eventpound.numerics.arrays import Floats


def _first_other(source: Source, pattern: str) -> int:
    """Number of the lines before the first that is filled and that a pattern does not match."""
    like = re.compile(pattern)
    lines = enumerate(source.lines)
    return next((i for i, line in lines if not like.match(line)), len(source.lines))


# Engineering Strong Motion database and ITACA (DYNA ASCII): 64 lines of labels, one column.


def _esm_header(source: Source) -> Sequence[Labelled]:
    last = _first_other(source, r"[A-Z][A-Z0-9_/^.-]*:")
    return [parted_labels(source, last, last or 1)]


ESM = Dialect(
    name="esm",
    begins=("EVENT_NAME:", "EVENT_ID:"),
    headers=_esm_header,
    kind=("DATA_TYPE", "ACCELERATION", "an acceleration time series"),
    count="NDATA",
    step="SAMPLING_INTERVAL_S",
    units=units_of("UNITS"),
    event="EVENT_NAME|EVENT_ID",
    station=("STATION_CODE", "STATION_NAME"),
    component="STREAM|COMPONENT",
    date="EVENT_DATE_YYYYMMDD",
    peak=peak_of("PGA_CM/S^2", "cm/s2"),
)

# Turkish national network (AFAD, TR-NSMN): three columns, in the unit of the label of the peaks.

_AFAD_PEAKS = re.compile(r"RAW PGA VALUES \((.+?)\)")


def _afad_header(source: Source) -> Sequence[Labelled]:
    titles = line_like(source, r"\s*N-S\s+E-W(\s|$)", within=40)
    missing = "no line of titles 'N-S E-W U-D' before the numbers"
    return [parted_labels(source, titles - 1, titles, missing=missing)]


def _afad_units(head: Labelled) -> tuple[str | None, int | None]:
    matches = ((_AFAD_PEAKS.match(label), line) for label, line in head.lines.items())
    return next(((found.group(1), line) for found, line in matches if found), (None, None))


def _afad_peak(head: Labelled, component: str | None) -> Peak | None:
    units, line = _afad_units(head)
    stated = head.text(f"RAW PGA VALUES ({units})") or ""
    found = re.search(rf"\({re.escape(component or '')}\)\s*({NUMBER})", stated)
    return Peak(found.group(1), units, line) if found and units and line else None


AFAD = Dialect(
    name="afad",
    begins=("STRONG GROUND MOTION RECORDS OF TURK",),
    headers=_afad_header,
    components=lambda head: head.source.line(head.end).split(),
    count="NUMBER OF DATA",
    step="SAMPLING INTERVAL (sec)",
    units=_afad_units,
    event="EARTHQUAKE DATE",
    station="STATION ID",
    date="RECORD TIME",
    peak=_afad_peak,
)

# Reprocessed Italian records as RESORCE has them: five numbers a line, which may touch. The
# line before them says "Accelaration time series in m/s/s" (so spelt).

_ITACA_END = r"\s*Acc\w+ time series in\s+(\S+)"


def _itaca_end(source: Source) -> int:
    return line_like(source, _ITACA_END, within=20)


def _itaca_header(source: Source) -> Sequence[Labelled]:
    end = _itaca_end(source)
    missing = "no line 'Acceleration time series in ...' before the numbers"
    return [parted_labels(source, end - 1, end, missing=missing)]


def _itaca_units(head: Labelled) -> tuple[str | None, int | None]:
    found = re.match(_ITACA_END, head.source.line(head.end), re.IGNORECASE)
    return found and found.group(1), head.end


ITACA = Dialect(
    name="itaca",
    begins=("Event Date & Time",),
    also=lambda source: _itaca_end(source) > 0,
    headers=_itaca_header,
    count="Number of Data",
    step="Time Increment (s)",
    units=_itaca_units,
    station="Station Code / Name",
    component="Orientation",
    date="Event Date & Time",
    peak=peak_of("PGA (m/s/s)", "m/s2"),
    width=14,
)

# ITSAK text: labels, a ruled line, a column for each of "components: E N Z".


def _itsak_header(source: Source) -> Sequence[Labelled]:
    rule = line_like(source, r"-{5,}\*+-{5,}", within=30)
    return [parted_labels(source, rule, rule, missing="no ruled line before the numbers")]


def _itsak_components(head: Labelled) -> Sequence[str]:
    names = (head.text("components") or "").split()
    if not names:
        raise head.source.error(None, "the header has no line 'components: E N Z'")
    return names


ITSAK = Dialect(
    name="itsak",
    begins=("type of record:",),
    headers=_itsak_header,
    components=_itsak_components,
    kind=("type of record", "accelerogram", "an accelerogram"),
    count="npts",
    rate="sampling frequency",
    units=units_of("units"),
    station="station name",
    date="datetime of first sample",
)

# Central Weather Bureau of Taiwan: "#label: value", then time and components;
# "#DataSequence: Time U(+); N(+); E(+)" names the columns.


def _cwb_header(source: Source) -> Sequence[Labelled]:
    last = _first_other(source, r"#|\s*$")
    return [parted_labels(source, last, last or 1)]


def _cwb_units(head: Labelled) -> tuple[str | None, int | None]:
    units = re.match(r"\w+", head.text("#AmplitudeUnit") or "")
    return units and units.group(), head.lines.get("#AmplitudeUnit")


def _cwb_peak(head: Labelled, component: str | None) -> Peak | None:
    label, (units, _) = f"#AmplitudeMAX. {component}", _cwb_units(head)
    extremes = re.findall(NUMBER, head.text(label) or "")
    if not extremes or units is None:
        return None
    return Peak(max(extremes, key=lambda text: abs(to_float(text))), units, head.lines[label])


CWB = Dialect(
    name="cwb",
    begins=("#Earthquake Information",),
    also=lambda source: line_like(source, "#DataSequence:", within=40) > 0,
    headers=_cwb_header,
    components=lambda head: re.findall(r"([A-Z])\([+-]\)", head.text("#DataSequence") or ""),
    timed=True,
    rate="#SampleRate(Hz)",
    duration="#RecordLength(sec)",
    units=_cwb_units,
    event="#Origin Time(GMT+08)",
    station=("#StationCode", "#StationName"),
    date="#StartTime(GMT+08)",
    peak=_cwb_peak,
)

# K-NET and KiK-net (NIED): 17 lines, labels in 18 characters, then counts. "Scale Factor
# 7845(gal)/8223790" turns them into gal. Their zero is arbitrary, so the mean is removed, as
# NIED does for its "Max. Acc.". "Dir." is a number in KiK-net: 1 to 3 in the borehole, 4 to 6
# at the surface.

_KNET_LINES, _KNET_LABEL = 17, 18
_SCALE = re.compile(rf"({NUMBER})\s*\((gal)\)\s*/\s*({NUMBER})", re.IGNORECASE)
_KIK_NET = {"1": "NS1", "2": "EW1", "3": "UD1", "4": "NS2", "5": "EW2", "6": "UD2"}


def _knet_header(source: Source) -> Sequence[Labelled]:
    head = parted_labels(source, _KNET_LINES, _KNET_LINES, _KNET_LABEL)
    direction = head.text("Dir.") or ""
    component = {"component": _KIK_NET.get(direction, direction)}
    return [Labelled(source, {**head.values, **component}, head.lines, head.end)]


def _knet_scale(head: Labelled) -> Scaled:
    text = head.text("Scale Factor")
    scale = _SCALE.search(text or "")
    if scale is None or to_float(scale.group(3)) == 0.0:
        raise head.source.error(
            head.lines.get("Scale Factor"),
            f"found '{text}'; a factor like '7845(gal)/8223790' is expected",
        )
    factor = to_float(scale.group(1)) / to_float(scale.group(3))

    def scaled(counts: Floats) -> tuple[Floats, str]:
        values = counts * factor
        mean = float(np.mean(values))
        return values - mean, f"mean of {mean:.6g} gal removed"

    return scaled


KNET = Dialect(
    name="knet",
    begins=("Origin Time",),
    also=lambda source: source.line(_KNET_LINES).startswith("Memo"),
    headers=_knet_header,
    rate="Sampling Freq(Hz)",
    duration="Duration Time(s)",
    units=lambda head: ("gal", head.lines.get("Scale Factor")),
    event="Origin Time",
    station="Station Code",
    component="component",
    date="Record Time",
    peak=peak_of("Max. Acc. (gal)", "gal"),
    width=9,
    scaled=_knet_scale,
    other_names=lambda head: (head.text("Dir.") or "",),
)

# GeoNet (New Zealand), corrected accelerograms (V2A): three components, one after the other,
# each with 16 lines of text, 10 of numbers, then acceleration, velocity and displacement.

_GEONET_FIRST = re.compile(r"(?i)Corrected accelerogram\b.*\bGNS\b")
_GEONET_LINES, _GEONET_TEXT = 26, 16
_GEONET_LABELS = {
    "Number of points": re.compile(r"Number of points\s+(\d+)", re.IGNORECASE),
    "data at ... sec intervals": re.compile(
        rf"data at\s+({NUMBER})\s+sec intervals", re.IGNORECASE
    ),
    "Acceleration: peak ... mm/s/s": re.compile(
        rf"Acceleration:\s+peak\s+({NUMBER})\s+mm/s/s", re.IGNORECASE
    ),
    "Component": re.compile(r"Component\s+(\S+)", re.IGNORECASE),
    "Site": re.compile(r"Site\s+(\S+)", re.IGNORECASE),
}


def _geonet_headers(source: Source) -> Sequence[Labelled]:
    lines = enumerate(source.lines, start=1)
    return [_geonet_header(source, i) for i, line in lines if _GEONET_FIRST.match(line)]


def _geonet_header(source: Source, start: int) -> Labelled:
    values = {
        "place": source.line(start + 2).strip(),
        "date": " ".join(source.line(start + 7).split()),
    }
    lines: dict[str, int] = {}
    text = range(start, start + _GEONET_TEXT)
    for label, pattern in _GEONET_LABELS.items():
        matches = ((i, pattern.search(source.line(i))) for i in text)
        line, found = next(((i, match) for i, match in matches if match), (0, None))
        if found is None:
            raise source.error(start, f"'{label}' is in none of the {_GEONET_TEXT} lines from here")
        values[label], lines[label] = found.group(1), line
    return Labelled(source, values, lines, start + _GEONET_LINES - 1)


def _azimuth(head: Labelled) -> tuple[str, ...]:
    """The bearing N28W as degrees from north, 332."""
    bearing = re.fullmatch(r"([NS])(\d+)([EW])", head.values["Component"])
    if bearing is None:
        return ()
    side, degrees, other = bearing.group(1), to_count(bearing.group(2)), bearing.group(3)
    angle = degrees if side == "N" else 180 - degrees
    return (str((angle if other == "E" else -angle) % 360),)


GEONET = Dialect(
    name="geonet",
    begins=(_GEONET_FIRST.pattern,),
    headers=_geonet_headers,
    count="Number of points",
    step="data at ... sec intervals",
    units=lambda head: ("mm/s/s", head.lines["Acceleration: peak ... mm/s/s"]),
    station=("Site", "place"),
    component="Component",
    date="date",
    peak=peak_of("Acceleration: peak ... mm/s/s", "mm/s/s"),
    width=8,
    ends_file=False,
    other_names=_azimuth,
)

DIALECTS = tuple(dialect.reader() for dialect in (ESM, KNET, GEONET, CWB, AFAD, ITACA, ITSAK))
"""Their readers."""
