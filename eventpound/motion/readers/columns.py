"""Accelerograms as plain text: one column (a), or a column of times and one a component.

Columns are separated by blanks, tabs, commas or semicolons. Lines that begin
with ``#``, ``%``, ``!`` or ``//`` and one line of titles before the numbers are
passed over; titles name the components. Units are never in such a file, nor is
the time step where there are no times: both are asked for. The first sample is
where the motion starts, whatever time stands beside it.

Where one series runs along lines of several numbers, as in files of OpenSees examples, the
format is `opensees`: its smoothness tells (`rows.runs_along_lines`). Lines of text after its
numbers are passed over.
"""

from __future__ import annotations

import re
from functools import partial

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.parametric import require_positive
from eventpound.motion.readers.base import Channel, Given, Reader, RecordData, Source, UnstatedError
from eventpound.motion.readers.block import FOLLOWING_WORD
from eventpound.motion.readers.header import Header, ask_for_missing, record_data
from eventpound.motion.readers.numbers import to_float
from eventpound.motion.readers.rows import (
    COMMENT,
    SEPARATOR,
    NumberRows,
    numbers_begin,
    read_rows,
    runs_along_lines,
)
from eventpound.motion.readers.time_column import even_step, increases
from eventpound.numerics.arrays import Floats

_LEADING_CONSTANT = 10.0
"""A first sample that is the peak and this many times the second is no sample."""


def _detect(source: Source) -> bool:
    """Whether the numbers begin on the first line that is no comment, or the one after."""
    return numbers_begin(source) is not None


def _channels(source: Source, given: Given) -> list[Channel]:
    """The components: all columns but that of times.

    Raises
    ------
    InputError
        For decimal commas, tokens that are not numbers, rows of another length,
        or several columns of which the first is no time, unless one is asked for.
    """
    _refuse_decimal_commas(source)
    rows = read_rows(source)
    timed = rows.width == 2 or (rows.width > 2 and increases(rows.column_texts(0)))
    if rows.width > 2 and not timed and given.component is None:
        raise UnstatedError(
            f"{source.file}, line {rows.lines[0]}: {rows.width} numbers on a line, the first of "
            'which is no time; give component = "#1" to take the first column, or '
            'format = "opensees" if one series runs along the lines',
            ["component"],
        )
    if rows.bad:
        raise InputError(source.unreadable(rows.bad))
    rows.refuse_other_widths(source)
    first = 1 if timed else 0
    names = _titles(rows)
    return [
        Channel(names[column], partial(_read, source, given, rows, column, timed, names[column]))
        for column in range(first, rows.width)
    ]


COLUMNS = Reader("columns", _detect, _channels)


def _detect_along_lines(source: Source) -> bool:
    """Whether there are lines of three numbers and more, along which a series runs."""
    first = numbers_begin(source)
    return first is not None and len(first) > 2 and runs_along_lines(read_rows(source))


def _channels_along_lines(source: Source, given: Given) -> list[Channel]:
    """The one series."""

    def read() -> RecordData:
        rows = read_rows(source)
        last = rows.lines[-1]
        after = [(i, x) for i, x in rows.bad if i > last and FOLLOWING_WORD.search(source.line(i))]
        bad = [one for one in rows.bad if one not in after]
        if bad:
            raise InputError(source.unreadable(bad))
        rows.refuse_other_widths(source, all_but_last=True)
        notes = _passed_over(rows)
        if after:
            line, text = after[0][0], source.line(after[0][0]).strip()[:60]
            notes += (f"line {line}: text after the last sample passed over: '{text}'",)
        values = np.array([to_float(text) for row in rows.rows for text in row])
        return record_data(source, OPENSEES.name, Header(), values, given, notes)

    return [Channel(None, read)]


OPENSEES = Reader("opensees", _detect_along_lines, _channels_along_lines)


def _read(
    source: Source, given: Given, rows: NumberRows, column: int, timed: bool, name: str | None
) -> RecordData:
    """One column.

    Raises
    ------
    InputError
        Without units or time step; for an uneven time step, or a first number
        that looks like a scale factor.
    """
    ask_for_missing(
        source,
        units=given.units is None,
        time_step=not timed and given.time_step is None,
        line=rows.lines[0],
    )
    values = rows.column(column)
    if timed:
        step = even_step(source, rows.column_texts(0), rows.lines)
        header = Header(time_step=step, time_step_line=rows.lines[1], component=name)
    else:
        assert given.time_step is not None
        require_positive("record", "time_step", given.time_step)
        _refuse_leading_constant(source, rows, column, values)
        header = Header(component=name)
    return record_data(source, COLUMNS.name, header, values, given, _passed_over(rows))


def _passed_over(rows: NumberRows) -> tuple[str, ...]:
    """A note on lines before the numbers."""
    count = len(rows.before)
    return (f"{count} lines before the numbers passed over",) if count else ()


def _titles(rows: NumberRows) -> list[str | None]:
    """Names of the columns, from the line before the numbers where it has one for each."""
    if rows.width > 2 and rows.before:
        line = COMMENT.sub("", rows.before[-1])
        names = [name.strip("\"' ") for name in SEPARATOR.split(line.strip())]
        if len(names) == rows.width and all(names):
            return list(names)
    return [None] * rows.width


def _refuse_decimal_commas(source: Source) -> None:
    """Stop where commas stand in numbers, or may."""
    if b"," not in source.content:
        return
    lines = [(i, x) for i, x in enumerate(source.lines, start=1) if not COMMENT.match(x)]
    pointed = any(re.search(r"\d\.|\.\d", line) for _, line in lines)
    if pointed and b";" not in source.content:
        return
    for number, line in lines:
        if re.search(r"\d,\d", line) and (";" in line or not pointed):
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
