"""ITSAK text: ``label: value`` lines, a ruled line with the components, a column each.

``type of record: accelerogram`` on the first line; the sampling frequency
stands for the time step.
"""

from __future__ import annotations

import re

from eventpound.motion.readers.base import Channel, Given, Reader, Source
from eventpound.motion.readers.block import Stated
from eventpound.motion.readers.header import Header
from eventpound.motion.readers.labelled import read_labelled
from eventpound.motion.readers.table import table_channels

_LONGEST_HEADER = 30
_RULE = re.compile(r"-{5,}\*+-{5,}")


def _detect(source: Source) -> bool:
    """Whether the first line says what the record is."""
    return source.line(1).startswith("type of record:")


def _channels(source: Source, given: Given) -> list[Channel]:
    """The components.

    Raises
    ------
    InputError
        Also for another kind of record.
    """
    rules = [
        number
        for number, line in enumerate(source.lines[:_LONGEST_HEADER], start=1)
        if _RULE.match(line)
    ]
    if not rules:
        raise source.error(None, "no ruled line before the numbers")
    labels = read_labelled(source, rules[-1])
    kind = labels.text("type of record")
    if kind != "accelerogram":
        raise source.error(1, f"found '{kind}'; an accelerogram is needed")
    frequency, line = labels.number("sampling frequency")
    if not frequency > 0.0:
        raise source.error(line, f"sampling frequency {frequency!r} Hz; a positive one is needed")
    stated = Stated(*labels.count("npts"), name="npts")
    headers = [
        Header(
            units=labels.text("units"),
            units_line=labels.lines.get("units"),
            time_step=1.0 / frequency,
            time_step_line=line,
            station=labels.text("station name"),
            component=name,
            date=labels.text("datetime of first sample"),
        )
        for name in (labels.text("components") or "").split()
    ]
    if not headers:
        raise source.error(None, "the header has no line 'components: E N Z'")
    return table_channels(source, READER.name, headers, rules[-1] + 1, stated, given)


READER = Reader("itsak", _detect, _channels)
