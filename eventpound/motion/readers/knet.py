"""K-NET and KiK-net (NIED): 17 labelled lines, then counts, eight a line.

``Scale Factor  7845(gal)/8223790`` turns counts into gal. The mean is removed,
as NIED does for its ``Max. Acc.``, because the counts have an arbitrary zero.
``Dir.`` is the direction, in KiK-net a number: 1 to 3 in the borehole, 4 to 6
at the surface. Where ObsPy is installed it reads the file, too, and a note says
whether it finds the same.
"""

from __future__ import annotations

import re

import numpy as np

from eventpound.motion.readers.base import Channel, Given, Reader, RecordData, Source
from eventpound.motion.readers.block import Stated, after_last, read_block
from eventpound.motion.readers.header import Header, Peak, record_data
from eventpound.motion.readers.labelled import TOO_MANY, Labelled
from eventpound.motion.readers.numbers import NUMBER, to_float
from eventpound.motion.readers.second_reader import beside_obspy

_GAL = 0.01
"""m/s^2."""
_HEADER_LINES = 17
_LABEL_WIDTH = 18
_FIELD_WIDTH = 9
_SCALE = re.compile(rf"({NUMBER})\s*\((gal)\)\s*/\s*({NUMBER})", re.IGNORECASE)
_KIK_NET = {"1": "NS1", "2": "EW1", "3": "UD1", "4": "NS2", "5": "EW2", "6": "UD2"}


def _detect(source: Source) -> bool:
    """Whether first and last line of the header are there."""
    return source.line(1).startswith("Origin Time") and source.line(_HEADER_LINES).startswith(
        "Memo"
    )


def _channels(source: Source, given: Given) -> list[Channel]:
    """The one component."""
    labels = _labels(source)
    frequency, line = labels.number("Sampling Freq(Hz)")
    duration, _ = labels.number("Duration Time(s)")
    count = frequency * duration
    if not 1.0 <= count < TOO_MANY or count != int(count):
        raise source.error(line, f"{frequency:g} Hz for {duration:g} s is no number of samples")
    stated = Stated(int(count), line, "frequency times duration")
    header = _header(labels, 1.0 / frequency, line)
    factor = _factor(labels)

    def read() -> RecordData:
        block = read_block(source, _HEADER_LINES + 1, stated, _FIELD_WIDTH)
        values = block.values * factor
        mean = float(np.mean(values))
        notes = (
            f"mean of {mean:.6g} gal removed",
            *after_last(source, block, stated),
            *beside_obspy(source, "KNET", _GAL * values),
        )
        return record_data(source, READER.name, header, values - mean, given, notes)

    return [Channel(header.component, read, (labels.text("Dir.") or "",))]


READER = Reader("knet", _detect, _channels)


def _labels(source: Source) -> Labelled:
    """Labels stand in the first 18 characters of a line."""
    pairs = [
        (line[:_LABEL_WIDTH].strip(), line[_LABEL_WIDTH:].strip())
        for line in source.lines[:_HEADER_LINES]
    ]
    lines = {label: number for number, (label, _) in enumerate(pairs, start=1)}
    return Labelled(source, dict(pairs), lines)


def _factor(labels: Labelled) -> float:
    """Gal in a count."""
    scale = _SCALE.search(labels.text("Scale Factor") or "")
    if scale is None or to_float(scale.group(3)) == 0.0:
        raise labels.source.error(
            labels.lines.get("Scale Factor"),
            f"found '{labels.text('Scale Factor')}'; a factor like '7845(gal)/8223790' is expected",
        )
    return to_float(scale.group(1)) / to_float(scale.group(3))


def _header(labels: Labelled, time_step: float, time_step_line: int) -> Header:
    """What the labels say."""
    direction = labels.text("Dir.")
    peak = labels.text("Max. Acc. (gal)")
    return Header(
        units="gal",
        units_line=labels.lines.get("Scale Factor"),
        time_step=time_step,
        time_step_line=time_step_line,
        event=labels.text("Origin Time"),
        station=labels.text("Station Code"),
        component=_KIK_NET.get(direction or "", direction),
        date=labels.text("Record Time"),
        peak=None if peak is None else Peak(peak, "gal", labels.lines["Max. Acc. (gal)"]),
    )
