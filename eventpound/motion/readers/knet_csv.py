"""The CSV files of K-NET and KiK-net (NIED): all components of a station, in gal.

    #K-NET CSV
    #Event
    #OriginTime,Latitude,Longitude,Depth(km),Magnitude
    #2024/01/01 16:10:00,37.5,137.3,16,7.6
    ...
    #SamplingFrequency(Hz)
    #100
    #DurationTime(s)
    #300
    #Offset
    #N-S(gal),E-W(gal),U-D(gal)
    #0.10,1.70,16.50
    #Time,RelativeTime(s),N-S(gal),E-W(gal),U-D(gal)
    2024/01/01 16:10:09.00,0.00,0.12,1.71,16.49

Lines of titles, each with a line of values below. The offset, which the sensor has at rest, is
still in the samples, and is taken off. Titles are numbers in KiK-net: 1 to 3 in the borehole,
4 to 6 at the surface.
"""

from __future__ import annotations

from dataclasses import replace

from eventpound.errors import InputError
from eventpound.motion.readers.base import Channel, Given, Reader, RecordData, Source
from eventpound.motion.readers.block import StatedCount, miscounted
from eventpound.motion.readers.columns import numeric_rows, read_column
from eventpound.motion.readers.dialects import KNET
from eventpound.motion.readers.header import Header
from eventpound.motion.readers.numbers import split_token, to_float

_RATE, _DURATION, _OFFSET = "samplingfrequency(hz)", "durationtime(s)", "offset"


def _detect(source: Source) -> bool:
    return source.line(1).strip().casefold().startswith("#k-net csv")


def _header_of(source: Source) -> dict[str, tuple[str, int]]:
    """Values by titles in small letters, and their lines; "offset" before those of offsets."""
    found: dict[str, tuple[str, int]] = {}
    above = ["", ""]
    for number, line in enumerate(source.lines, start=1):
        if not line.startswith("#"):
            break
        cells = line.strip("# \r").split(",")
        titles = above[-1].casefold().split(",")
        if len(titles) == len(cells):
            group = f"{_OFFSET} " if above[-2].casefold() == _OFFSET else ""
            for title, cell in zip(titles, cells, strict=True):
                found.setdefault(group + title.strip(), (cell.strip(), number))
        above.append(line.strip("# \r"))
    return found


def _channels(source: Source, given: Given) -> list[Channel]:
    """The components, three or six.

    Raises
    ------
    InputError
        For a header without what is needed, or rows that are not those it states.
    """
    header = _header_of(source)

    def number(key: str) -> float:
        text, line = header.get(key, ("", None))
        if split_token(text) is None:
            raise source.error(line, f"found '{text}' for '{key}'; a number is expected")
        return to_float(text)

    rate, line = number(_RATE), header[_RATE][1]
    count = round(rate * number(_DURATION))
    if not (rate > 0.0 and count > 0):
        raise source.error(line, f"{rate:g} Hz for {number(_DURATION):g} s is no number of samples")
    table = numeric_rows(source, given)
    rows = table.rows
    rows.refuse_odd(source)
    if len(rows.rows) != count:
        stated = StatedCount(count, line, "frequency times duration")
        raise InputError(miscounted(source, stated, len(rows.rows), rows.lines[-1], "rows"))
    stating = replace(table, stated=Header(time_step=1.0 / rate, time_step_line=line))

    def channel(column: int) -> Channel:
        title = table.titles[column]
        name = KNET.renamed.get(title.name, title.name)

        def read() -> RecordData:
            offset = number(f"{_OFFSET} {title.text.casefold()}")
            data = read_column(source, given, stating, column, name)
            return replace(
                data,
                acceleration=data.acceleration - offset * title.factor,
                format=KNET_CSV.name,
                event=header.get("origintime", (None,))[0],
                station=header.get("code", (None,))[0],
                date=source.line(rows.lines[0]).partition(",")[0],
                notes=(f"offset of {offset:g} {title.unit} taken off",),
            )

        return Channel(name, read, (title.name, title.text))

    return [channel(column) for column in table.components]


KNET_CSV = Reader("knet-csv", _detect, _channels)
