"""Engineering Strong Motion database and ITACA (DYNA ASCII): 64 labelled lines, one column.

``EVENT_NAME: ...`` on the first line; ``SAMPLING_INTERVAL_S``, ``NDATA``,
``UNITS`` and ``DATA_TYPE: ACCELERATION`` among the others.
"""

from __future__ import annotations

import re

from eventpound.motion.readers.base import Channel, Given, Reader, RecordData, Source
from eventpound.motion.readers.block import Stated, after_last, read_block
from eventpound.motion.readers.header import Header, Peak, record_data
from eventpound.motion.readers.labelled import Labelled, read_labelled

_LABEL = re.compile(r"[A-Z][A-Z0-9_/^.-]*:")


def _detect(source: Source) -> bool:
    """Whether the first lines are those of an ESM header."""
    return source.line(1).startswith("EVENT_NAME:") and source.line(2).startswith("EVENT_ID:")


def _channels(source: Source, given: Given) -> list[Channel]:
    """The one component.

    Raises
    ------
    InputError
        Also for a series of velocities or displacements.
    """
    last = next(
        (i for i, line in enumerate(source.lines) if not _LABEL.match(line)), len(source.lines)
    )
    labels = read_labelled(source, last)
    kind = labels.text("DATA_TYPE")
    if kind is not None and not kind.startswith("ACCELERATION"):
        raise source.error(
            labels.lines["DATA_TYPE"], f"found '{kind}'; an acceleration time series is needed"
        )
    stated = Stated(*labels.count("NDATA"), name="NDATA")
    header = _header(labels)

    def read() -> RecordData:
        block = read_block(source, last + 1, stated)
        notes = after_last(source, block, stated)
        return record_data(source, READER.name, header, block.values, given, notes)

    return [Channel(header.component, read)]


READER = Reader("esm", _detect, _channels)


def _header(labels: Labelled) -> Header:
    """What the labels say."""
    time_step, time_step_line = labels.number("SAMPLING_INTERVAL_S")
    peak = labels.text("PGA_CM/S^2")
    station = [labels.text("STATION_CODE"), labels.text("STATION_NAME")]
    return Header(
        units=labels.text("UNITS"),
        units_line=labels.lines.get("UNITS"),
        time_step=time_step,
        time_step_line=time_step_line,
        event=labels.text("EVENT_NAME") or labels.text("EVENT_ID"),
        station=" ".join(text for text in station if text) or None,
        component=labels.text("STREAM") or labels.text("COMPONENT"),
        date=labels.text("EVENT_DATE_YYYYMMDD"),
        peak=None if peak is None else Peak(peak, "cm/s2", labels.lines["PGA_CM/S^2"]),
    )
