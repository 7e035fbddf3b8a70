"""Matrices of other programs: CSV or columns of text, NumPy's ``.npy``, Matrix Market's ``.mtx``.

A text file may name its columns in a first line, and its rows in a first column. Comments begin
with ``#``, or ``%``. Cells are parted by commas, semicolons, tabs or blanks.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from eventpound.basics.input_files import read_bytes
from eventpound.errors import InputError

if TYPE_CHECKING:
    from eventpound.numerics.arrays import Floats

MOST_BYTES = 2**26
"""Of a file; a thousand rows and columns of text take some 25 000 000."""
MOST_ROWS = 2000
"""And columns, of a Matrix Market file, which may say any number in a few bytes."""
_NUMBER = re.compile(r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eEdD][-+]?\d+)?|[-+]?(?:inf|nan)", re.I)


class NamedMatrix(NamedTuple):
    """Numbers, shape (n, m), and the names of the n rows or m columns, where the file has some."""

    values: Floats
    names: tuple[str, ...]


def read_matrix(path: Path) -> NamedMatrix:
    """Numbers of a file.

    Parameters
    ----------
    path : Path
        ``.npy``, ``.mtx``, else text.

    Raises
    ------
    InputError
        Where it cannot be read, or holds anything but real numbers; of a text with the line.
    """
    import numpy as np

    try:
        content = read_bytes(path, MOST_BYTES)
        match path.suffix.lower():
            case ".npy":
                found: Any = np.load(io.BytesIO(content), allow_pickle=False)
            case ".mtx":
                found = _market(content)
            case _:
                return _text(path, content.decode("utf-8-sig"))
    except InputError:
        raise
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error
    except (ValueError, EOFError, IndexError, OverflowError, MemoryError) as error:
        raise InputError(f"{path}: cannot be read: {error}") from error
    if not isinstance(found, np.ndarray) or found.dtype.kind not in "fiu" or found.ndim > 2:
        raise InputError(f"{path}: holds no matrix of real numbers")
    return NamedMatrix(np.atleast_2d(found.astype(np.float64)), ())


def _market(content: bytes) -> Any:
    from scipy.io import mminfo, mmread

    rows, columns, *_ = mminfo(io.BytesIO(content))
    if max(rows, columns) > MOST_ROWS:
        raise ValueError(f"{rows} rows and {columns} columns; accepted: up to {MOST_ROWS}")
    found = mmread(io.BytesIO(content))
    return found.toarray() if hasattr(found, "toarray") else found


def _text(path: Path, text: str) -> NamedMatrix:
    import numpy as np

    lines = [(i, line.strip()) for i, line in enumerate(text.splitlines(), 1)]
    lines = [(i, line) for i, line in lines if line and line[0] not in "#%"]
    rows = [(i, _cells(line)) for i, line in lines]
    head: Sequence[str] = ()
    if rows and not _is_number(rows[0][1][-1]):
        head = rows.pop(0)[1]
    named = bool(rows) and not any(_is_number(cells[0]) for _, cells in rows)
    beside = tuple(cells.pop(0) for _, cells in rows) if named else ()
    if not rows or not rows[0][1]:
        raise InputError(f"{path}: has no rows of numbers")
    width = len(rows[0][1])
    for i, cells in rows:
        if len(cells) != width:
            raise InputError(f"{path}: line {i} has {len(cells)} numbers, those before {width}")
        wrong = next((cell for cell in cells if not _is_number(cell)), None)
        if wrong is not None:
            raise InputError(f"{path}: line {i}: {wrong!r} is not a number")
    if len(head) == width + 1 and named:
        head = head[1:]
    if head and len(head) != width:
        raise InputError(f"{path}: names {len(head)} columns and has {width}")
    if head and beside and width == len(rows) and tuple(head) != beside:
        raise InputError(f"{path}: its rows and columns have other names, or another order")
    values = [[float(re.sub("[dD]", "e", cell)) for cell in cells] for _, cells in rows]
    return NamedMatrix(np.array(values), beside or (tuple(head) if width > 1 else ()))


def _cells(line: str) -> list[str]:
    for parts in (";", "\t", ","):
        if parts in line:
            (cells,) = csv.reader([line], delimiter=parts, skipinitialspace=True)
            return [cell.strip() for cell in cells]
    return line.split()


def _is_number(cell: str) -> bool:
    return _NUMBER.fullmatch(cell) is not None
