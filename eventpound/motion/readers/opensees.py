"""Headerless series with several numbers a line, as OpenSees examples have them.

Five or eight numbers a line, read along the lines; units and time step have to
be given. Lines of text after the numbers are passed over. That the series runs
along the lines is told by its smoothness (`rows.runs_along_lines`).
"""

from __future__ import annotations

import re

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.readers.base import Channel, Given, Reader, RecordData, Source
from eventpound.motion.readers.checks import unreadable
from eventpound.motion.readers.header import Header, record_data
from eventpound.motion.readers.numbers import to_float
from eventpound.motion.readers.rows import Rows, numbers_begin, read_rows_of_text, runs_along_lines

_WORD = re.compile(r"\b(?!nan\b|inf(?:inity)?\b)[a-z]{2,}", re.IGNORECASE)


def _detect(source: Source) -> bool:
    """Whether there are lines of three numbers and more, along which a series runs."""
    first = numbers_begin(source)
    return first is not None and len(first) > 2 and runs_along_lines(read_rows_of_text(source))


def _channels(source: Source, given: Given) -> list[Channel]:
    """The one series."""

    def read() -> RecordData:
        rows = read_rows_of_text(source)
        notes = _notes(source, rows)
        values = np.array([to_float(text) for row in rows.rows for text in row])
        return record_data(source, READER.name, Header(), values, given, notes)

    return [Channel(None, read)]


READER = Reader("opensees", _detect, _channels)


def _notes(source: Source, rows: Rows) -> tuple[str, ...]:
    """What is passed over: lines before the numbers, text after them.

    Raises
    ------
    InputError
        For tokens that are no numbers, or a line before the last that is short
        or long.
    """
    last = rows.lines[-1]
    bad = [(i, x) for i, x in rows.bad if i < last or not _WORD.search(source.line(i))]
    if bad:
        raise InputError(unreadable(source, bad))
    for number, row in zip(rows.lines[:-1], rows.rows[:-1], strict=True):
        if len(row) != rows.width:
            raise source.error(
                number, f"{len(row)} numbers; {rows.width} expected, as on line {rows.lines[0]}"
            )
    notes = [f"{len(rows.before)} lines before the numbers passed over"] if rows.before else []
    if rows.bad:
        line = rows.bad[0][0]
        text = source.line(line).strip()[:60]
        notes.append(f"line {line}: text after the last sample passed over: '{text}'")
    return tuple(notes)
