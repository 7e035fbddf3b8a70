"""Turkish national network (AFAD, TR-NSMN): labelled lines, three columns N-S, E-W, U-D.

The numbers are in gal, the unit of ``RAW PGA VALUES (gal)`` in the header.
"""

from __future__ import annotations

import re

from eventpound.motion.readers.base import Channel, Given, Reader, Source
from eventpound.motion.readers.block import Stated
from eventpound.motion.readers.header import Header, Peak
from eventpound.motion.readers.labelled import Labelled, read_labelled
from eventpound.motion.readers.numbers import NUMBER
from eventpound.motion.readers.table import table_channels

_FIRST_LINE = "STRONG GROUND MOTION RECORDS OF TURK"
_LONGEST_HEADER = 40
_PEAKS = re.compile(r"RAW PGA VALUES \((.+?)\)")


def _detect(source: Source) -> bool:
    """Whether the first line is that of the network."""
    return source.line(1).startswith(_FIRST_LINE)


def _channels(source: Source, given: Given) -> list[Channel]:
    """The three components."""
    titles = next(
        (
            i
            for i, line in enumerate(source.lines[:_LONGEST_HEADER], start=1)
            if line.split()[:2] == ["N-S", "E-W"]
        ),
        None,
    )
    if titles is None:
        raise source.error(None, "no line of titles 'N-S E-W U-D' before the numbers")
    labels = read_labelled(source, titles - 1)
    stated = Stated(*labels.count("NUMBER OF DATA"), name="NUMBER OF DATA")
    headers = [_header(labels, name) for name in source.line(titles).split()]
    return table_channels(source, READER.name, headers, titles + 1, stated, given)


READER = Reader("afad", _detect, _channels)


def _header(labels: Labelled, component: str) -> Header:
    """What the labels say of a component."""
    time_step, time_step_line = labels.number("SAMPLING INTERVAL (sec)")
    units, units_line, peak = None, None, None
    for label, value in labels.values.items():
        if found := _PEAKS.match(label):
            units, units_line = found.group(1), labels.lines[label]
            if stated := re.search(rf"\({re.escape(component)}\)\s*({NUMBER})", value):
                peak = Peak(stated.group(1), units, units_line)
    return Header(
        units=units,
        units_line=units_line,
        time_step=time_step,
        time_step_line=time_step_line,
        event=labels.text("EARTHQUAKE DATE"),
        station=labels.text("STATION ID"),
        component=component,
        date=labels.text("RECORD TIME"),
        peak=peak,
    )
