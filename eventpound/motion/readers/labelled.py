"""Formats with headers of text: one reader, told what differs by a `Dialect`.

A dialect says where headers stand in a file, how their values are found (labels with values
behind them, patterns with named groups) and which of them is what. The numbers follow a
header, one component in a block or several in columns. Letter case means nothing in the words
of a header: agencies change it between years. The dialects are in `dialects.py`, `archives.py`,
`volumes.py` and `interchange.py`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import NamedTuple

from eventpound.errors import InputError
from eventpound.motion.readers.base import SAME_STEP, Channel, Given, Reader, RecordData, Source
from eventpound.motion.readers.block import StatedCount, miscounted, numbers_of_block
from eventpound.motion.readers.header import (
    Extent,
    Extents,
    Header,
    Peak,
    named_groups,
    record_data,
    word_pattern,
)
from eventpound.motion.readers.numbers import NUMBER, to_count, to_float
from eventpound.motion.readers.rows import NumberRows, read_rows
from eventpound.motion.readers.time_column import even_step
from eventpound.numerics.arrays import Floats

TOO_MANY = 1e12
_ROUNDED = 0.01
"""Rounding of a printed duration (s)."""
_FIRST_NUMBER = re.compile(NUMBER)


def _folded(found: Mapping[str, tuple[str, int]]) -> dict[str, tuple[str, int]]:
    return {label.casefold(): value for label, value in found.items()}


@dataclass(frozen=True)
class Labelled:
    """What a header says: values as printed, by labels without capitals, with lines (from 1)."""

    source: Source
    extent: Extent
    found: Mapping[str, tuple[str, int]]

    def __contains__(self, label: str) -> bool:
        return label.casefold() in self.found

    def line(self, labels: str) -> int | None:
        """The line of a value, of ``A|B`` the first; None where it is missing."""
        return next((self.found[x.casefold()][1] for x in labels.split("|") if x in self), None)

    def text(self, labels: str | tuple[str, ...]) -> str | None:
        """A value, None where it is missing or blank; of ``A|B`` the first, of a tuple all."""
        if isinstance(labels, tuple):
            return " ".join(text for label in labels if (text := self.text(label))) or None
        values = (self.found[x.casefold()][0] for x in labels.split("|") if x in self)
        return next(filter(None, values), None)

    def require(self, label: str) -> None:
        """Stop where a label is missing."""
        if label not in self:
            start = self.extent.start
            where = start if start > 1 else None
            raise self.source.error(where, f"the header has no line '{label}'")

    def number(self, label: str, *, positive: bool = False) -> tuple[float, int]:
        """The first number of a value, and its line.

        Raises
        ------
        InputError
            Where the label is missing or has no number, or none that is positive.
        """
        self.require(label)
        text, line = self.found[label.casefold()]
        number = _FIRST_NUMBER.search(text)
        value = to_float(number.group()) if number else 0.0
        if number is None or (positive and not value > 0.0):
            kind = "positive number" if positive else "number"
            raise self.source.error(line, f"found '{text}' for '{label}'; a {kind} is expected")
        return value, line

    def count(self, label: str) -> StatedCount:
        """A whole number that is positive.

        Raises
        ------
        InputError
            Where it is missing or none.
        """
        value, line = self.number(label)
        if not (1.0 <= value < TOO_MANY and value == int(value)):
            raise self.source.error(
                line,
                f"found '{self.text(label)}' for '{label}'; a positive whole number is expected",
            )
        return StatedCount(int(value), line, label)


class Trace(NamedTuple):
    """Numbers in the header's unit, notes on what was done, and a time step (s) they imply."""

    values: Floats
    notes: tuple[str, ...] = ()
    time_step: float | None = None


Numbers = Callable[["Dialect", Labelled, StatedCount, Given], Trace]


def plain_numbers(dialect: Dialect, head: Labelled, stated: StatedCount, given: Given) -> Trace:
    """The block that follows a header, as it is."""
    width = to_count(head.text("width") or "") or dialect.width
    first = head.extent.end + 1
    return Trace(*numbers_of_block(head.source, first, stated, width, ends_file=dialect.ends_file))


@dataclass(frozen=True)
class Dialect:
    """A format with headers of text.

    Parameters
    ----------
    name : str
        Of the format.
    begins : tuple of str
        Patterns of its first lines, which tell the format.
    extents : callable
        Where the headers of a file stand, one for each block of numbers.
    parted : str or int, optional
        What stands between label and value, or the characters that labels have.
    patterns : tuple of str
        Searched in the text of a header; their named groups are values, too.
    also : callable
        What else tells the format.
    needs : tuple of str
        Labels that a header must have besides those of its sampling.
    kind : tuple of str
        A label, a pattern its value has for an accelerogram, and what is needed if it has not.
    count, step, rate, duration : str
        Labels of the number of samples, or of their rate (Hz) and duration (s), and of the
        time step (s), or of the rate. All that are named must agree.
    units, event, station, component, date : str or tuple of str
        Labels, as `Labelled.text` takes them.
    unit : str, optional
        The unit of a format that does not print it.
    renamed : mapping of str to str
        Names of components by what the header has instead.
    peak : tuple of str, optional
        Label of the peak and its unit; without it both are where there are groups `peak` and
        `peak units`.
    columns : tuple of str, optional
        A label and a pattern, which finds the names of the columns of a table in its value.
    column_peak : str
        A pattern for the numbers of which one is the peak of the column that stands for ``{}``.
    timed : bool
        Whether a column of times comes before those of the components.
    width : int, optional
        Characters of a number, where the format fixes it, unless a group `width` says so.
    ends_file : bool
        Whether nothing but text may follow the block.
    missing : str
        What is said of a file without a header.
    numbers : callable
        The `Trace` of a component.
    other_names : callable
        What else a component may be asked for by.
    """

    name: str
    begins: tuple[str, ...]
    extents: Extents
    parted: str | int | None = None
    patterns: tuple[str, ...] = ()
    also: Callable[[Source], bool] = lambda source: True
    needs: tuple[str, ...] = ()
    kind: tuple[str, str, str] | None = None
    count: str = ""
    step: str = ""
    rate: str = ""
    duration: str = ""
    units: str = "units"
    unit: str | None = None
    event: str = "event"
    station: str | tuple[str, ...] = "station"
    component: str = "component"
    date: str = "date"
    renamed: Mapping[str, str] = field(default_factory=dict)
    peak: tuple[str, str] | None = None
    columns: tuple[str, str] | None = None
    column_peak: str = ""
    timed: bool = False
    width: int | None = None
    ends_file: bool = True
    missing: str = ""
    numbers: Numbers = plain_numbers
    other_names: Callable[[Labelled], tuple[str, ...]] = lambda head: ()

    def reader(self) -> Reader:
        """The reader of the format."""
        patterns = [word_pattern(pattern) for pattern in self.begins]

        def detect(source: Source) -> bool:
            numbered = enumerate(patterns, start=1)
            return all(like.match(source.line(i)) for i, like in numbered) and self.also(source)

        def channels(source: Source, given: Given) -> list[Channel]:
            heads = [self._head(source, extent) for extent in self.extents(source)]
            if self.missing and not heads:
                raise source.error(None, self.missing)
            return [channel for head in heads for channel in self._channels(head, given)]

        return Reader(self.name, detect, channels)

    def _head(self, source: Source, extent: Extent) -> Labelled:
        """The values of one header; of several with one label the first."""
        found = _folded(extent.known)
        text = source.lines[extent.start - 1 : extent.last]
        if self.parted is not None:
            for number, line in enumerate(text, start=extent.start):
                label, is_parted, value = _parted(line, self.parted)
                if is_parted:
                    found.setdefault(label.casefold(), (value, number))
        joined = "\n".join(text) if self.patterns else ""
        for pattern in self.patterns:
            if match := word_pattern(pattern).search(joined):
                for label, (value, _) in named_groups(match, 0).items():
                    above = joined.count("\n", 0, match.start(label.replace(" ", "_")))
                    found.setdefault(label.casefold(), (value, extent.start + above))
        return Labelled(source, extent, found)

    def _channels(self, head: Labelled, given: Given) -> list[Channel]:
        """The components under one header."""
        for label in self.needs:
            head.require(label)
        self._refuse_other_kind(head)
        stated, time_step, line = self._sampling(head)
        printed = head.text(self.component)
        name = self.renamed.get(printed or "", printed)
        names = [name] if self.columns is None else self._columns(head)
        headers = [
            Header(
                units=head.text(self.units) or self.unit,
                units_line=head.line(self.units),
                time_step=time_step,
                time_step_line=line,
                event=head.text(self.event),
                station=head.text(self.station),
                component=name,
                date=head.text(self.date),
                peak=self._peak(head, name),
            )
            for name in names
        ]

        def read(column: int) -> RecordData:
            header = headers[column]
            if self.columns is None:
                values, notes, step = self.numbers(self, head, stated, given)
                header = header if step is None else replace(header, time_step=step)
            else:
                rows = self._table(head, stated, header)
                values, notes = rows.column(column + self.timed)[: stated.count], ()
                if filled := len(rows.rows) - stated.count:
                    notes = (f"{filled} rows that repeat the last one passed over",)
            return record_data(head.source, self.name, header, values, given, notes)

        other_names = (printed or "", *self.other_names(head))
        return [Channel(name, partial(read, i), other_names) for i, name in enumerate(names)]

    def _refuse_other_kind(self, head: Labelled) -> None:
        """Stop where the header says that the numbers are no accelerations."""
        if self.kind is None:
            return
        label, pattern, needed = self.kind
        found = head.text(label)
        if found is not None and not word_pattern(pattern).match(found):
            raise head.source.error(head.line(label), f"found '{found}'; {needed} is needed")

    def _sampling(self, head: Labelled) -> tuple[StatedCount, float | None, int | None]:
        """Number of samples, time step (s) and the line that states it.

        Raises
        ------
        InputError
            Where a label is missing, or rate and duration make no number of samples.
        """
        if not (self.step or self.rate):
            return head.count(self.count), None, None
        if self.step and (self.step in head or not self.rate):
            return head.count(self.count), *head.number(self.step)
        frequency, line = head.number(self.rate, positive=True)
        if self.count and not self.duration:
            return head.count(self.count), 1.0 / frequency, line
        duration, _ = head.number(self.duration)
        count = frequency * duration
        if self.count:
            stated = head.count(self.count)
            if abs(count - stated.count) > 1.0 + _ROUNDED * frequency:
                raise head.source.error(
                    line, f"{stated.count} samples at {frequency:g} Hz do not last {duration:g} s"
                )
            return stated, 1.0 / frequency, line
        if not 0.5 < count < TOO_MANY:
            raise head.source.error(
                line, f"{frequency:g} Hz for {duration:g} s is no number of samples"
            )
        stated = StatedCount(round(count), line, "frequency times duration")
        return stated, 1.0 / frequency, line

    def _peak(self, head: Labelled, component: str | None) -> Peak | None:
        """The peak that the header states for a component."""
        if self.column_peak:
            pattern = word_pattern(self.column_peak.replace("{}", re.escape(component or "")))
            text = enumerate(head.source.lines[: head.extent.last], start=1)
            found = ((i, match) for i, x in text if (match := pattern.search(x)))
            at, match = next(found, (0, None))
            units = head.text(self.units)
            if match is None or units is None:
                return None
            return Peak(max(match.groups(), key=lambda text: abs(to_float(text))), units, at)
        label, units = self.peak or ("peak", head.text("peak units"))
        peak, line = head.text(label), head.line(label)
        return Peak(peak, units, line) if peak and units and line else None

    def _columns(self, head: Labelled) -> Sequence[str]:
        """Names of the columns of a table."""
        assert self.columns is not None
        label, pattern = self.columns
        names = word_pattern(pattern).findall(head.text(label) or "")
        if not names:
            raise head.source.error(None, f"the header names no components after '{label}'")
        return names

    def _table(self, head: Labelled, stated: StatedCount, header: Header) -> NumberRows:
        """The rows under a header; times beside the components must be those it states."""
        source = head.source
        rows = read_rows(source, head.extent.end)
        rows.refuse_odd(source, len(self._columns(head)) + self.timed)
        last, after = rows.rows[stated.count - 1 : stated.count], rows.rows[stated.count :]
        if not last or any(row != last[0] for row in after):
            raise InputError(miscounted(source, stated, len(rows.rows), rows.lines[-1], "rows"))
        if self.timed:
            times = rows.column_texts(0)
            refuse_other_times(source, times, rows.lines, header.time_step, header.time_step_line)
        return rows


def refuse_other_times(
    source: Source, times: list[str], lines: list[int], time_step: float | None, line: int | None
) -> None:
    """Stop where times beside the samples are not those of the step that a line states (s)."""
    step = even_step(source, times, lines, time_step)
    if time_step is None or abs(step - time_step) > SAME_STEP * step:
        raise source.error(
            line, f"a time step of {time_step!r} s is stated, its times are {step!r} s apart"
        )


def _parted(line: str, at: str | int) -> tuple[str, bool, str]:
    """Label and value of a line, and whether it has both."""
    if isinstance(at, int):
        return line[:at].strip(), True, line[at:].strip()
    label, found, value = line.partition(at)
    return label.strip(), bool(found), value.strip()
