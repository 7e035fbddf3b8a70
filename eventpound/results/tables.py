"""Tables as CSV files, CSV files as columns of text, and columns of text as exact numbers.

Python's own conversion is correctly rounded, so a number written with the
digits that identify it reads back as the same double; pandas promises that in
some versions only.
"""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from eventpound.errors import InputError
from eventpound.input_files import read_bytes
from eventpound.numerics.arrays import Floats

if TYPE_CHECKING:
    import pandas as pd


def table_csv(table: pd.DataFrame) -> bytes:
    """Table as CSV, UTF-8; every number reads back as the same double.

    Parameters
    ----------
    table : DataFrame
        Its index is left out.
    """
    text: str = table.to_csv(index=False, lineterminator="\n")
    return text.encode()


def read_columns(path: Path) -> dict[str, list[str]]:
    """Cells of a CSV file by column.

    Parameters
    ----------
    path : Path
        The file, UTF-8, with one line of column names.

    Raises
    ------
    InputError
        Where it is missing or empty, where a name stands twice, or where a row
        has more or fewer cells than there are names.
    """
    try:
        text = read_bytes(path).decode("utf-8-sig")
        rows = list(csv.reader(io.StringIO(text, newline="")))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path}: cannot be read: {error}") from error
    if not rows or not rows[0]:
        raise InputError(f"{path}: is empty; a line of column names is expected")
    names = [name.strip() for name in rows[0]]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError(f"{path}: column {', '.join(twice)} stands more than once")
    for line, row in enumerate(rows[1:], start=2):
        if len(row) != len(names):
            raise InputError(
                f"{path}: row {line} has {len(row)} cells, the line of names {len(names)}"
            )
    return {name: [row[i] for row in rows[1:]] for i, name in enumerate(names)}


def to_numbers(path: Path, name: str, cells: list[str]) -> Floats:
    """Numbers of a column; an empty cell is NaN.

    Parameters
    ----------
    path : Path
        The file, to be named in an error.
    name : str
        The column.
    cells : list of str
        Its cells.

    Returns
    -------
    ndarray, shape (n,)

    Raises
    ------
    InputError
        At the first cell that is no number.
    """
    numbers = np.empty(len(cells))
    for i, cell in enumerate(cells):
        try:
            numbers[i] = float(cell) if cell else np.nan
        except ValueError:
            raise InputError(
                f"{path}: row {i + 2}, column {name}: {cell!r} is not a number"
            ) from None
    return numbers
