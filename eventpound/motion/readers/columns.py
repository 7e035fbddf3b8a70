"""Accelerograms as plain text: one column (a), or a column of times and one a component.

Columns are separated by blanks, tabs, commas or semicolons. Lines that begin
with ``#``, ``%``, ``!`` or ``//`` and one line of titles before the numbers are
passed over; titles name the components, say which columns are accelerations and
times, and in which units (`titles`). What neither they nor a count and a step before
the numbers (`beside_samples`) state is asked for. Times may be those of a clock. The
first sample is where the motion starts, whatever time stands beside it.

Where one series runs along lines of several numbers, as in files of OpenSees examples, the
format is `opensees`: its smoothness tells (`rows.runs_along_lines`). Lines of text after its
numbers are passed over.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.parametric import require_positive
from eventpound.motion.readers.base import Channel, Given, Reader, RecordData, Source, UnstatedError
from eventpound.motion.readers.beside_samples import (
    counts,
    without_counts,
    without_edges,
    without_head,
)
from eventpound.motion.readers.block import FOLLOWING_WORD
from eventpound.motion.readers.header import Header, ask_for_missing, record_data
from eventpound.motion.readers.numbers import to_float
from eventpound.motion.readers.rows import (
    COMMENT,
    NumberRows,
    numbers_begin,
    read_rows,
    runs_along_lines,
)
from eventpound.motion.readers.time_column import even_step, increases
from eventpound.motion.readers.titles import (
    Content,
    Title,
    refuse_other_count,
    stated_before,
    titles_of,
)
from eventpound.numerics.arrays import Floats

_LEADING_CONSTANT = 10.0
"""A first sample that is the peak and this many times the second is no sample."""


def _detect(source: Source) -> bool:
    """Whether the numbers begin on the first line that is no comment, or the one after."""
    return numbers_begin(source) is not None


@dataclass(frozen=True)
class ColumnTable:
    """Rows of samples, the titles of their columns, and what stands before them.

    Parameters
    ----------
    rows : NumberRows
        Without a count, a step and numbers of rows.
    titles : list of Title
        One a column; empty ones where there are none.
    stated : Header
        With the step before the samples.
    notes : tuple of str
        What was passed over.
    """

    rows: NumberRows
    titles: list[Title]
    stated: Header = field(default_factory=Header)
    notes: tuple[str, ...] = ()

    @cached_property
    def times(self) -> list[int]:
        """Columns of times: those that titles call so, else the first if it goes up."""
        width = self.rows.width
        titled = [i for i, title in enumerate(self.titles) if title.kind is Content.TIME]
        # A later T is the transverse component.
        titled = [i for i in titled if i == titled[0] or self.titles[i].text != "T"]
        if titled or width == 1 or self.titles[0].kind is not None:
            return titled if width > 1 else []
        untitled = width == 2 and not self.titles[0].text
        return [0] if untitled or increases(self.rows.column_texts(0)) else []

    @property
    def components(self) -> list[int]:
        """Columns that may be accelerations."""
        kinds = enumerate(title.kind for title in self.titles)
        return [i for i, kind in kinds if kind not in _OTHERS and i not in self.times]


_OTHERS = (Content.VELOCITY, Content.DISPLACEMENT, Content.FORCE)


def numeric_rows(source: Source, given: Given) -> ColumnTable:
    """What stands in a file, as far as its numbers can be read.

    Raises
    ------
    InputError
        For what may be numbers of samples or not.
    """
    rows = read_rows(source)
    if rows.bad:
        return ColumnTable(rows, [Title()] * rows.width)
    rows, stated, notes = without_head(source, rows, given.time_step)
    before = [COMMENT.sub("", line) for line in rows.before[-2:]]
    titles = titles_of(before, rows.width)
    if titles is None and ":" in source.line(rows.lines[0]):
        # A date and a clock are one column.
        titles = (titles_of(before, rows.width + 1) or [])[1:]
    titles = titles or [Title()] * rows.width
    for index in reversed(range(rows.width)):
        if rows.width > 1 and _counts_rows(source, rows, index, titles[index], given):
            rows = rows.without_column(index)
            titles = titles[:index] + titles[index + 1 :]
            notes += (f"column {index + 1} counts the rows",)
    return ColumnTable(rows, titles, stated, notes + _passed_over(rows))


def _counts_rows(source: Source, rows: NumberRows, index: int, title: Title, given: Given) -> bool:
    """Whether a column is numbers of rows or samples.

    Raises
    ------
    UnstatedError
        Where it may be seconds as well.
    """
    if title.kind is Content.COUNT:
        texts = rows.column_texts(index)
        return increases(texts) and all(text.isdecimal() for text in texts)
    if title.kind is not None or index not in (0, rows.width - 1) or not counts(rows, index):
        return False
    if index == 0 and rows.width == 2 and given.time_step is None:
        raise UnstatedError(
            f"{source.file}, line {rows.lines[0]}: the first column counts; if these are samples, "
            'give their time_step = "... s", if seconds, time_step = "1 s"',
            ["time_step"],
        )
    return index > 0 or rows.width > 2 or given.time_step != 1.0


def _channels(source: Source, given: Given) -> list[Channel]:
    """The components: all columns but those of times and of other quantities.

    Raises
    ------
    InputError
        For decimal commas, tokens that are not numbers, rows of another length, no
        acceleration, or several columns of which none is a time, unless one is asked for.
    """
    refuse_decimal_commas(source)
    table = numeric_rows(source, given)
    rows, components = table.rows, table.components
    if len(components) > 1 and rows.width > 2 and not table.times and given.component is None:
        raise UnstatedError(
            f"{source.file}, line {rows.lines[0]}: {rows.width} numbers on a line, the first of "
            'which is no time; give component = "#1" to take the first column, or '
            'format = "opensees" if one series runs along the lines',
            ["component"],
        )
    rows.refuse_odd(source)
    if not components:
        found = [f"'{t.text}' is {t.kind.value}" for t in table.titles if t.kind in _OTHERS]
        raise source.error(rows.lines[0] - 1, f"{', '.join(found)}; an acceleration is needed")
    titled = rows.width > 1 and any(title.text for title in table.titles)
    stated, count = stated_before(
        source, _titles_line(source, rows) if titled else rows.lines[0], table.stated
    )
    refuse_other_count(source, count, len(rows.rows), rows.lines[-1])
    table = replace(table, stated=stated)
    names = [table.titles[i].name or None if rows.width > 2 else None for i in components]
    return [
        Channel(name, partial(read_column, source, given, table, i, name), (table.titles[i].text,))
        for i, name in zip(components, names, strict=True)
    ]


def _titles_line(source: Source, rows: NumberRows) -> int:
    """The line of titles: the last before the rows that is not blank."""
    return max(i for i in range(1, rows.lines[0]) if source.line(i).strip())


COLUMNS = Reader("columns", _detect, _channels)


def _detect_along_lines(source: Source) -> bool:
    """Whether there are lines of three numbers and more, along which a series runs."""
    return numbers_begin(source) is not None and runs_along_lines(without_edges(read_rows(source)))


def _channels_along_lines(source: Source, given: Given) -> list[Channel]:
    """The one series."""

    def read() -> RecordData:
        rows = read_rows(source)
        last = rows.lines[-1]
        after = [(i, x) for i, x in rows.bad if i > last and FOLLOWING_WORD.search(source.line(i))]
        if bad := [one for one in rows.bad if one not in after]:
            raise InputError(source.unreadable(bad))
        rows, stated, notes = without_head(source, replace(rows, bad=[]), given.time_step)
        stated, count = stated_before(source, rows.lines[0], stated)
        rows.refuse_odd(source, all_but_last=True)
        rows, dropped = without_counts(rows)
        notes += _passed_over(rows)
        notes += ("numbers of the lines passed over",) if dropped else ()
        if after:
            line, text = after[0][0], source.line(after[0][0]).strip()[:60]
            notes += (f"line {line}: text after the last sample passed over: '{text}'",)
        values = np.array([to_float(text) for row in rows.rows for text in row])
        refuse_other_count(source, count, values.size, last)
        return record_data(source, OPENSEES.name, stated, values, given, notes)

    return [Channel(None, read)]


OPENSEES = Reader("opensees", _detect_along_lines, _channels_along_lines)


def read_column(
    source: Source, given: Given, table: ColumnTable, column: int, name: str | None
) -> RecordData:
    """One column of a table.

    Parameters
    ----------
    source, given : Source, Given
        The file, and what the caller says.
    table : ColumnTable
        What stands in it.
    column : int
        Which of its columns.
    name : str or None
        What the component is called.

    Raises
    ------
    InputError
        Without units or time step; for an uneven time step, columns of times that disagree, or
        a first number that looks like a scale factor.
    """
    rows, title, stated = table.rows, table.titles[column], table.stated
    ask_for_missing(
        source,
        units=given.units is None and title.unit is None and stated.units is None,
        time_step=not table.times and stated.time_step is None and given.time_step is None,
        line=rows.lines[0],
    )
    step, line = step_of(source, table, given.time_step)
    values = rows.column(column)
    if step is None:
        assert given.time_step is not None
        require_positive("record", "time_step", given.time_step)
        _refuse_leading_constant(source, rows, column, values)
    header = Header(stated.units, stated.units_line, step, line, component=name)
    if title.units is not None:
        header = replace(header, units=title.units, units_line=rows.lines[0] - 1)
    return record_data(source, COLUMNS.name, header, values, given, table.notes)


def step_of(
    source: Source, table: ColumnTable, given: float | None = None
) -> tuple[float | None, int | None]:
    """The step (s) of the times, or else stated before them, and its line.

    Raises
    ------
    InputError
        For uneven times, and where they have another step than is stated.
    """
    rows, step, line = table.rows, table.stated.time_step, table.stated.time_step_line
    for i in table.times:
        known = given if step is None else step
        found = even_step(source, rows.column_texts(i), rows.lines, known, table.titles[i].factor)
        if step is not None and found != step:
            raise source.error(
                line, f"a time step of {step!r} s is stated, column {i + 1} has one of {found!r} s"
            )
        step, line = found, rows.lines[1]
    return step, line


def _passed_over(rows: NumberRows) -> tuple[str, ...]:
    """A note on lines before the numbers."""
    count = len(rows.before)
    return (f"{count} lines before the numbers passed over",) if count else ()


_NO_WORDS = re.compile(r"[\d\s.,;:eEdD+\-\"'TZ/]+")
_WITH_COMMA = re.compile(r"[+-]?\d*(?:[.,]\d+)?(?:[eEdD][+-]?\d+)?")


def refuse_decimal_commas(source: Source, *, whole: bool = False) -> None:
    """Stop where commas stand in numbers; or may, unless all numbers may be whole."""
    if b"," not in source.content:
        return
    lines = [(i, x) for i, x in enumerate(source.lines, start=1) if _NO_WORDS.fullmatch(x)]
    pointed = whole or any("." in line for _, line in lines)
    for number, line in lines:
        tokens = line.split()
        alone = len(tokens) > 1 and all(map(_WITH_COMMA.fullmatch, tokens))
        if re.search(r"\d,\d", line) and (";" in line or not pointed or alone):
            raise source.error(
                number, f"found '{line.strip()}': decimal commas? decimal points are expected"
            )


def _refuse_leading_constant(source: Source, rows: NumberRows, column: int, values: Floats) -> None:
    """Stop where the first of the numbers looks like a scale factor or a count."""
    first = abs(values[0])
    if (
        values.size > 2
        and first == abs(values).max()
        and first > _LEADING_CONSTANT * abs(values[1])
    ):
        raise source.error(
            rows.lines[0],
            f"the first number, {rows.rows[0][column]}, is the largest of all and far above the "
            "next; if it is a scale factor, a count or a time step, remove it from the file",
        )
