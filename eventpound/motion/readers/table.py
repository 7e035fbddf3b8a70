"""Components side by side: a stated number of rows, a column each."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.readers.base import Channel, Given, RecordData, Source
from eventpound.motion.readers.block import Stated
from eventpound.motion.readers.checks import unreadable
from eventpound.motion.readers.header import Header, record_data
from eventpound.motion.readers.numbers import clean_numbers, numbers_of_line
from eventpound.numerics.arrays import Floats


def table_channels(
    source: Source,
    format: str,
    headers: Sequence[Header],
    first: int,
    stated: Stated,
    given: Given,
) -> list[Channel]:
    """The components of a table, one a column.

    Parameters
    ----------
    source : Source
        The file.
    format : str
        Name of the reader.
    headers : sequence of Header
        What is known of each column.
    first : int
        Line of the first row (from 1).
    stated : Stated
        How many rows there are.
    given : Given
        What the caller knows.

    Returns
    -------
    list of Channel
        In the order of the columns.
    """

    def read(column: int) -> RecordData:
        values = read_rows(source, first, stated, len(headers))[:, column]
        return record_data(source, format, headers[column], values, given)

    return [Channel(header.component, partial(read, i)) for i, header in enumerate(headers)]


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
    odd = next(((i, len(x.split())) for i, x in lines if len(x.split()) != columns), None)
    values = clean_numbers([line for _, line in lines])
    if values is None or odd is not None:
        rows = [(i, *numbers_of_line(line)) for i, line in lines]
        bad = [(i, token) for i, _, tokens in rows for token in tokens]
        if bad:
            raise InputError(unreadable(source, bad))
        odd = next(((i, len(row)) for i, row, _ in rows if len(row) != columns), None)
        if odd is not None:
            raise source.error(odd[0], f"{odd[1]} numbers; {columns} expected")
        values = np.array([x for _, row, _ in rows for x in row])
    if len(lines) != stated.count:
        last = lines[-1][0] if lines else first - 1
        raise source.error(
            None,
            f"{len(lines)} rows found up to line {last}; "
            f"line {stated.line} states {stated.name} = {stated.count}",
        )
    return values.reshape(-1, columns)
