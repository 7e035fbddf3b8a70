"""Central Weather Bureau of Taiwan: lines of ``#label: value``, then time and components.

``#DataSequence: Time U(+); N(+); E(+)`` names the columns, ``#AmplitudeUnit``
their unit.
"""

from __future__ import annotations

import re
from functools import partial
from itertools import islice

from eventpound.motion.readers.base import Channel, Given, Reader, RecordData, Source
from eventpound.motion.readers.block import Stated
from eventpound.motion.readers.checks import agreed_time_step
from eventpound.motion.readers.header import Header, Peak, record_data
from eventpound.motion.readers.labelled import TOO_MANY, Labelled, read_labelled
from eventpound.motion.readers.numbers import NUMBER, to_float
from eventpound.motion.readers.table import read_rows
from eventpound.motion.readers.time_column import even_step

_COLUMN = re.compile(r"([A-Z])\([+-]\)")


def _detect(source: Source) -> bool:
    """Whether the first lines are those of the header."""
    return source.line(1).startswith("#Earthquake Information") and any(
        line.startswith("#DataSequence:") for line in source.lines[:40]
    )


def _channels(source: Source, given: Given) -> list[Channel]:
    """The components."""
    last = next(
        (i for i, line in enumerate(source.lines) if line.strip() and not line.startswith("#")),
        len(source.lines),
    )
    labels = read_labelled(source, last)
    frequency, rate_line = labels.number("#SampleRate(Hz)")
    duration, _ = labels.number("#RecordLength(sec)")
    if not frequency > 0.0:
        raise source.error(rate_line, f"{frequency!r} samples per second; a positive number")
    if not 0.0 <= frequency * duration < TOO_MANY:
        raise source.error(
            rate_line, f"{frequency:g} Hz for {duration:g} s is no number of samples"
        )
    stated = Stated(round(frequency * duration), rate_line, "SampleRate times RecordLength")
    names = _COLUMN.findall(labels.text("#DataSequence") or "")
    headers = [_header(labels, name, 1.0 / frequency, rate_line) for name in names]

    def read(column: int) -> RecordData:
        rows = read_rows(source, last + 1, stated, len(names) + 1)
        filled = (i for i in range(last + 1, len(source.lines) + 1) if source.line(i).strip())
        lines = list(islice(filled, len(rows)))
        texts = [source.line(i).split()[0] for i in lines]
        agreed_time_step(source, even_step(source, texts, lines), rate_line, 1.0 / frequency)
        return record_data(source, READER.name, headers[column], rows[:, column + 1], given)

    return [Channel(name, partial(read, i)) for i, name in enumerate(names)]


READER = Reader("cwb", _detect, _channels)


def _header(labels: Labelled, name: str, time_step: float, time_step_line: int) -> Header:
    """What the labels say of a component."""
    label = f"#AmplitudeMAX. {name}"
    line = labels.lines.get(label, time_step_line)
    units = re.match(r"\w+", labels.text("#AmplitudeUnit") or "")
    extremes = re.findall(NUMBER, labels.text(label) or "")
    station = [labels.text("#StationCode"), labels.text("#StationName")]
    return Header(
        units=units.group() if units else None,
        units_line=labels.lines.get("#AmplitudeUnit"),
        time_step=time_step,
        time_step_line=time_step_line,
        event=labels.text("#Origin Time(GMT+08)"),
        station=" ".join(text for text in station if text) or None,
        component=name,
        date=labels.text("#StartTime(GMT+08)"),
        peak=Peak(max(extremes, key=lambda text: abs(to_float(text))), units.group(), line)
        if extremes and units
        else None,
    )
