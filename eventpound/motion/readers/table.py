"""Tables: a stated number of rows of numbers, a component a column."""

from __future__ import annotations

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.readers.base import Source
from eventpound.motion.readers.block import Stated
from eventpound.motion.readers.checks import unreadable
from eventpound.motion.readers.numbers import clean_numbers, numbers_of_line, parted
from eventpound.numerics.arrays import Floats


def read_rows(source: Source, first: int, stated: Stated, columns: int) -> Floats:
    """Rows of numbers up to the end of the file.

    Parameters
    ----------
    source : Source
        The file.
    first : int
        Line of the first row (from 1).
    stated : Stated
        How many rows there are.
    columns : int
        Numbers in each.

    Returns
    -------
    ndarray, shape (count, columns)
        The numbers.

    Raises
    ------
    InputError
        For tokens that are not numbers, rows of another length, or another
        number of rows.
    """
    lines = [
        (number, line)
        for number, line in enumerate(source.lines[first - 1 :], start=first)
        if line.strip()
    ]
    tokens = [line.split() for _, line in lines]
    rows = [row if len(row) == columns else parted(" ".join(row)) or row for row in tokens]
    values = None
    if all(len(row) == columns for row in rows):
        values = clean_numbers([token for row in rows for token in row])
    if values is None:
        values = _line_by_line(source, lines, columns)
    if len(lines) != stated.count:
        last = lines[-1][0] if lines else first - 1
        raise source.error(
            None,
            f"{len(lines)} rows found up to line {last}; "
            f"line {stated.line} states {stated.name} = {stated.count}",
        )
    return values.reshape(-1, columns)


def _line_by_line(source: Source, lines: list[tuple[int, str]], columns: int) -> Floats:
    """The slow way: touching numbers, D exponents, and what is wrong."""
    rows = [(i, *numbers_of_line(line)) for i, line in lines]
    bad = [(i, token) for i, _, tokens in rows for token in tokens]
    if bad:
        raise InputError(unreadable(source, bad))
    for number, row, _ in rows:
        if len(row) != columns:
            raise source.error(number, f"{len(row)} numbers; {columns} expected")
    return np.array([x for _, row, _ in rows for x in row])
