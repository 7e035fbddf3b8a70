"""Formats whose header is lines of labels and values: one reader, told by a `Dialect`.

A dialect says how the header ends, which labels have the number of samples and the time
step, and where unit, station, component and peak stand. The numbers follow the header, one
component in a block or several in columns. The dialects are in `dialects.py`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import islice

from eventpound.motion.readers.base import Channel, Given, Reader, RecordData, Source
from eventpound.motion.readers.block import Scaled, Stated, block_channel
from eventpound.motion.readers.checks import agreed_time_step
from eventpound.motion.readers.header import Header, Peak, record_data
from eventpound.motion.readers.numbers import NUMBER, to_float
from eventpound.motion.readers.table import read_rows
from eventpound.motion.readers.time_column import even_step

TOO_MANY = 1e12
_FIRST_NUMBER = re.compile(NUMBER)


@dataclass(frozen=True)
class Labelled:
    """Values of a header by their labels, as printed, and the line of each (from 1).

    `end` is the line after which the numbers follow, `start` that on which one of several
    headers of a file begins.
    """

    source: Source
    values: Mapping[str, str]
    lines: Mapping[str, int]
    end: int
    start: int | None = None

    def text(self, labels: str | tuple[str, ...]) -> str | None:
        """A value, None where it is missing or blank; of ``A|B`` the first, of a tuple all."""
        if isinstance(labels, tuple):
            return " ".join(text for label in labels if (text := self.text(label))) or None
        return next((self.values[x] for x in labels.split("|") if self.values.get(x)), None)

    def number(self, label: str, *, positive: bool = False) -> tuple[float, int]:
        """The first number of a value, and its line.

        Raises
        ------
        InputError
            Where the label is missing or has no number, or none that is positive.
        """
        if label not in self.values:
            raise self.source.error(self.start, f"the header has no line '{label}'")
        found = _FIRST_NUMBER.search(self.values[label])
        value = to_float(found.group()) if found else 0.0
        if found is None or (positive and not value > 0.0):
            raise self.source.error(
                self.lines[label],
                f"found '{self.values[label]}' for '{label}'; "
                f"a {'positive ' if positive else ''}number is expected",
            )
        return value, self.lines[label]

    def count(self, label: str) -> Stated:
        """A whole number that is positive.

        Raises
        ------
        InputError
            Where it is missing or none.
        """
        value, line = self.number(label)
        if not (1.0 <= value < TOO_MANY and value == int(value)):
            raise self.source.error(
                line, f"found '{self.values[label]}' for '{label}'; a whole number is expected"
            )
        return Stated(int(value), line, label)


def parted_labels(
    source: Source, last: int, end: int, at: str | int = ":", missing: str = ""
) -> Labelled:
    """Labels and values of lines that have both.

    Parameters
    ----------
    source : Source
        The file.
    last, end : int
        The last line of labels (from 1), and that after which the numbers follow; 0 where
        the header has no end.
    at : str or int
        What stands between label and value, or the characters that labels have.
    missing : str
        The message where the header has no end.

    Returns
    -------
    Labelled
        The first value of each label.
    """
    if not end:
        raise source.error(None, missing)
    values: dict[str, str] = {}
    lines: dict[str, int] = {}
    for number, line in enumerate(source.lines[:last], start=1):
        label, found, value = (
            line.partition(at) if isinstance(at, str) else (line[:at], "at", line[at:])
        )
        if found and label.strip() not in values:
            values[label.strip()] = value.strip()
            lines[label.strip()] = number
    return Labelled(source, values, lines, end)


def line_like(source: Source, pattern: str, within: int) -> int:
    """The last of the first lines that a pattern matches (from 1); 0 where it matches none."""
    numbered = enumerate(source.lines[:within], start=1)
    like = re.compile(pattern, re.IGNORECASE)
    return max((i for i, line in numbered if like.match(line)), default=0)


Units = Callable[[Labelled], tuple[str | None, int | None]]
Peaks = Callable[[Labelled, str | None], Peak | None]


def units_of(label: str) -> Units:
    """The unit that is the value of a label, and its line."""
    return lambda head: (head.text(label), head.lines.get(label))


def peak_of(label: str, units: str) -> Peaks:
    """The peak that is the value of a label."""
    return lambda head, _: (
        Peak(text, units, head.lines[label]) if (text := head.text(label)) else None
    )


@dataclass(frozen=True)
class Dialect:
    """A format with a header of labels.

    Parameters
    ----------
    name : str
        Of the format.
    begins : tuple of str
        Patterns of its first lines, which tell the format.
    headers : callable
        The headers of a file, one for each block of numbers.
    units : callable
        Unit of the numbers and the line that states it.
    components : callable
        Names of the columns of a table; None where the numbers are one component's.
    count, step, rate, duration : str
        Labels of the number of samples, or of their rate (Hz) and duration (s), and of the
        time step (s), or of the rate.
    event, station, component, date : str or tuple of str
        Labels, as `Labelled.text` takes them.
    peak : callable
        The peak that is stated for a component.
    kind : tuple of str
        A label, how its value begins for an accelerogram, and what is needed if it does not.
    also : callable
        What else tells the format.
    width : int
        Characters of a number, where the format fixes it.
    timed : bool
        Whether a column of times comes before those of the components.
    ends_file : bool
        Whether nothing but text may follow the block.
    scaled : callable
        The numbers in the unit from those of the file, and a note on what was done.
    other_names : callable
        What else a component may be asked for by.
    """

    name: str
    begins: tuple[str, ...]
    headers: Callable[[Source], Sequence[Labelled]]
    units: Units
    components: Callable[[Labelled], Sequence[str]] | None = None
    count: str = ""
    step: str = ""
    rate: str = ""
    duration: str = ""
    event: str = ""
    station: str | tuple[str, ...] = ""
    component: str = ""
    date: str = ""
    peak: Peaks = lambda head, component: None
    kind: tuple[str, str, str] | None = None
    also: Callable[[Source], bool] = lambda source: True
    width: int | None = None
    timed: bool = False
    ends_file: bool = True
    scaled: Callable[[Labelled], Scaled] | None = None
    other_names: Callable[[Labelled], tuple[str, ...]] = lambda head: ()

    def reader(self) -> Reader:
        """The reader of the format."""
        patterns = [re.compile(pattern) for pattern in self.begins]

        def detect(source: Source) -> bool:
            numbered = enumerate(patterns, start=1)
            return all(like.match(source.line(i)) for i, like in numbered) and self.also(source)

        def channels(source: Source, given: Given) -> list[Channel]:
            heads = self.headers(source)
            return [channel for head in heads for channel in _channels(self, head, given)]

        return Reader(self.name, detect, channels)


def _channels(dialect: Dialect, head: Labelled, given: Given) -> list[Channel]:
    """The components under one header."""
    _refuse_other_kind(dialect, head)
    stated, time_step, line = _sampling(dialect, head)

    def header(component: str | None) -> Header:
        units, units_line = dialect.units(head)
        return Header(
            units=units,
            units_line=units_line,
            time_step=time_step,
            time_step_line=line,
            event=head.text(dialect.event),
            station=head.text(dialect.station),
            component=component,
            date=head.text(dialect.date),
            peak=dialect.peak(head, component),
        )

    if dialect.components is not None:
        headers = [header(name) for name in dialect.components(head)]
        read = partial(_read_column, dialect, head, stated, headers, given)
        return [Channel(one.component, partial(read, i)) for i, one in enumerate(headers)]
    return [
        block_channel(
            head.source,
            dialect.name,
            header(head.text(dialect.component)),
            head.end + 1,
            stated,
            given,
            width=dialect.width,
            ends_file=dialect.ends_file,
            scaled=dialect.scaled(head) if dialect.scaled else None,
            other_names=dialect.other_names(head),
        )
    ]


def _refuse_other_kind(dialect: Dialect, head: Labelled) -> None:
    """Stop where the header says that the numbers are no accelerations."""
    if dialect.kind is None:
        return
    label, begins, needed = dialect.kind
    found = head.text(label)
    if found is not None and not found.startswith(begins):
        raise head.source.error(head.lines[label], f"found '{found}'; {needed} is needed")


def _sampling(dialect: Dialect, head: Labelled) -> tuple[Stated, float, int]:
    """Number of samples, time step (s) and the line that states it.

    Raises
    ------
    InputError
        Where a label is missing, or rate and duration make no number of samples.
    """
    if dialect.step:
        stated = head.count(dialect.count)
        return stated, *head.number(dialect.step)
    frequency, line = head.number(dialect.rate, positive=True)
    if dialect.count:
        return head.count(dialect.count), 1.0 / frequency, line
    duration, _ = head.number(dialect.duration)
    count = frequency * duration
    if not 0.5 < count < TOO_MANY:
        raise head.source.error(
            line, f"{frequency:g} Hz for {duration:g} s is no number of samples"
        )
    stated = Stated(round(count), line, "frequency times duration")
    return stated, 1.0 / frequency, line


def _read_column(
    dialect: Dialect,
    head: Labelled,
    stated: Stated,
    headers: Sequence[Header],
    given: Given,
    column: int,
) -> RecordData:
    """One column of a table, whose times, where it has them, must be those of the header."""
    source, header = head.source, headers[column]
    rows = read_rows(source, head.end + 1, stated, len(headers) + dialect.timed)
    if dialect.timed:
        filled = (i for i in range(head.end + 1, len(source.lines) + 1) if source.line(i).strip())
        lines = list(islice(filled, len(rows)))
        step = even_step(source, [source.line(i).split()[0] for i in lines], lines)
        agreed_time_step(source, step, header.time_step_line, header.time_step)
    return record_data(source, dialect.name, header, rows[:, column + dialect.timed], given)
