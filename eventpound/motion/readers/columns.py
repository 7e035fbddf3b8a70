"""Accelerograms as plain text: one column (a), or two (t, a) with an even time step.

Columns are separated by blanks, tabs, commas or semicolons. Lines that begin
with ``#``, ``%``, ``!`` or ``//`` and one line of titles before the numbers are
passed over. Units are never in such a file, nor is the time step of a single
column: both are asked for. The first sample is where the motion starts,
whatever time stands beside it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from eventpound.errors import InputError
from eventpound.motion.parametric import require_positive
from eventpound.motion.readers.base import Reader, RecordData, Source
from eventpound.motion.readers.checks import (
    accepted_units,
    agreed_time_step,
    agreed_units,
    samples_in_si,
    unreadable,
)
from eventpound.motion.readers.numbers import split_token, to_float
from eventpound.motion.readers.time_column import even_step

_COMMENT = re.compile(r"\s*(#|%|!|//)")
_SEPARATOR = re.compile(r"\s*[,;]\s*|\s+")
_TITLE = re.compile(r"[\"'(]?(?!(?:nan|inf|infinity)$)[a-z]", re.IGNORECASE)
_LEADING_CONSTANT = 10.0
"""A first sample that is the peak and this many times the second is no sample."""


@dataclass(frozen=True)
class _Table:
    """The numbers of the file as printed, row by row, with the line of each (from 1)."""

    lines: list[int]
    rows: list[list[str]]
    passed_over: int

    def column(self, index: int) -> list[float]:
        """Numbers of one column."""
        return [to_float(row[index]) for row in self.rows]


def _detect(source: Source) -> bool:
    """Whether the numbers begin on the first line that is no comment, or the one after."""
    lines = [line for line in source.lines if line.strip() and not _COMMENT.match(line)]
    return any(_numbers(line)[1] is None for line in lines[:2])


def _read(source: Source, units: str | None, time_step: float | None) -> RecordData:
    """Read one or two columns.

    Raises
    ------
    InputError
        Without units or, for one column, time step; for more columns, decimal
        commas, tokens that are not numbers, an uneven time step, or a first
        number that looks like a scale factor.
    """
    _refuse_decimal_commas(source)
    table = _read_table(source)
    width = len(table.rows[0])
    _ask_for_what_is_missing(source, units is None, width == 1 and time_step is None)
    unit, factor = agreed_units(source, None, None, units)
    values = table.column(width - 1)
    if width == 1:
        assert time_step is not None
        require_positive("record", "time_step", time_step)
        _refuse_leading_constant(source, table, values)
        dt = time_step
    else:
        dt = agreed_time_step(
            source,
            even_step(source, [row[0] for row in table.rows], table.lines),
            table.lines[1],
            time_step,
        )
    notes = (f"{table.passed_over} lines before the numbers passed over",)
    return RecordData(
        acceleration=samples_in_si(source, values, factor),
        time_step=dt,
        units=unit,
        format=READER.name,
        file=source.file,
        sha256=source.sha256,
        notes=notes if table.passed_over else (),
    )


READER = Reader("columns", _detect, _read)


def _ask_for_what_is_missing(source: Source, units: bool, time_step: bool) -> None:
    """Stop where units or time step are neither in the file nor given."""
    missing = []
    if units:
        missing.append(("units", f'units = "..." ({accepted_units()})'))
    if time_step:
        missing.append(("time step", 'time_step = "... s"'))
    if missing:
        raise source.error(
            None,
            f"the file does not state its {' and its '.join(name for name, _ in missing)}; "
            f"give {' and '.join(key for _, key in missing)}",
        )


def _numbers(line: str) -> tuple[list[str], str | None]:
    """The numbers of a line as printed, and its first token that is none."""
    numbers: list[str] = []
    for token in _SEPARATOR.split(line.strip()):
        parts = split_token(token)
        if parts is None:
            return numbers, token
        numbers += parts
    return numbers, None


def _read_table(source: Source) -> _Table:
    """All rows of numbers, refused unless each has the one or two of the first row."""
    lines: list[int] = []
    rows: list[list[str]] = []
    bad: list[tuple[int, str]] = []
    passed_over = titles = 0
    for number, line in enumerate(source.lines, start=1):
        if not line.strip():
            continue
        row, token = _numbers(line)
        comment = _COMMENT.match(line) is not None
        if not rows and (
            comment or (token is not None and not row and not titles and _TITLE.match(token))
        ):
            titles += not comment
            passed_over += 1
        elif token is not None:
            bad.append((number, token))
        else:
            lines.append(number)
            rows.append(row)
    if not rows:
        raise source.error(None, "no line of numbers was found")
    width = len(rows[0])
    if width > 2:
        raise source.error(
            lines[0], f"{width} numbers on a line; one column (a) or two (t, a) are accepted"
        )
    if bad:
        raise InputError(unreadable(source, bad))
    for number, row in zip(lines, rows, strict=True):
        if len(row) != width:
            raise source.error(
                number, f"{len(row)} numbers; {width} expected, as on line {lines[0]}"
            )
    return _Table(lines, rows, passed_over)


def _refuse_decimal_commas(source: Source) -> None:
    """Stop where commas stand in numbers, or may."""
    lines = [(i, x) for i, x in enumerate(source.lines, start=1) if not _COMMENT.match(x)]
    pointed = any(re.search(r"\d\.|\.\d", line) for _, line in lines)
    for number, line in lines:
        if re.search(r"\d,\d", line) and (";" in line or not pointed):
            raise source.error(
                number, f"found '{line.strip()}': decimal commas? decimal points are expected"
            )


def _refuse_leading_constant(source: Source, table: _Table, values: list[float]) -> None:
    """Stop where the first of the numbers looks like a scale factor or a count."""
    first = abs(values[0])
    if (
        len(values) > 2
        and first == max(map(abs, values))
        and first > _LEADING_CONSTANT * abs(values[1])
    ):
        raise source.error(
            table.lines[0],
            f"the first number, {table.rows[0][0]}, is the largest of all and far above the next; "
            "if it is a scale factor, a count or a time step, remove it from the file",
        )
