"""Files that a user names: read where they are files of a reasonable size, and found by patterns.

CSV files are read as columns of text, and these as exact numbers: Python's own conversion is
correctly rounded, so a number written with the digits that identify it reads back as the same
double; pandas promises that in some versions only.

A device, a pipe or a file of gigabytes would be read for ever or until the memory is full;
a pattern that begins at the root of the disk would look through all of it.
"""

from __future__ import annotations

import csv
import io
import os
import stat
from itertools import islice
from pathlib import Path, PurePath
from typing import TYPE_CHECKING

from eventpound.errors import InputError

if TYPE_CHECKING:
    from eventpound.numerics.arrays import Floats

MOST_BYTES = 2**30
"""Of a record; a million samples take some 15 000 000."""
MOST_MATCHES = 100_000
"""Files of one pattern."""
_WILD = "*?["


def read_bytes(path: Path, most: int = MOST_BYTES) -> bytes:
    """Content of a file.

    Parameters
    ----------
    path : Path
        The file.
    most : int
        Bytes that it may have.

    Raises
    ------
    InputError
        Where it is a device or a pipe, or larger.
    OSError
        Where it cannot be read.
    ValueError
        Where no file can have such a name.
    """
    kind = os.stat(path)
    if not (stat.S_ISREG(kind.st_mode) or stat.S_ISDIR(kind.st_mode)):
        raise InputError(f"{path}: is no file but a device or a pipe")
    with path.open("rb") as file:
        content = file.read(min(most, kind.st_size) + 1)
        content += b"" if len(content) > most else file.read(most + 1 - len(content))
    if len(content) > most:
        raise InputError(f"{path}: is larger than {most} bytes, which are accepted at most")
    return content


def matching_files(pattern: str, directory: Path) -> list[Path]:
    """Files that match a pattern, in order.

    Hidden files and folders match only where the pattern names them so; ``**`` goes through
    folders, but not through links to them.

    Parameters
    ----------
    pattern : str
        ``"folder/*.AT2"``, relative to a directory or absolute.
    directory : Path
        What it is relative to.

    Raises
    ------
    InputError
        Where it is no pattern, would go through a whole disk, or matches too many files.
    """
    parts = PurePath(pattern).parts
    wild = next((i for i, part in enumerate(parts) if any(c in part for c in _WILD)), len(parts))
    base, rest = directory.joinpath(*parts[:wild]), parts[wild:]
    try:
        if not rest:
            return [base] if parts and base.is_file() else []
        if "**" in rest and base.resolve() == Path(base.resolve().anchor):
            raise InputError(
                f"found {pattern!r}, which goes through the whole disk; accepted: a pattern "
                "below some folder"
            )
        shown = (path for path in base.glob("/".join(rest)) if _is_shown(path, base, rest))
        found = sorted(islice((path for path in shown if path.is_file()), MOST_MATCHES + 1))
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or str(error)
        raise InputError(f"found {pattern!r}, which is no pattern of files: {why}") from error
    if len(found) > MOST_MATCHES:
        raise InputError(
            f"found {pattern!r}, which matches more than {MOST_MATCHES} files; accepted: at most "
            "so many"
        )
    return found


def _is_shown(path: Path, base: Path, rest: tuple[str, ...]) -> bool:
    hidden = [part for part in path.relative_to(base).parts if part.startswith(".")]
    return not hidden or any(part.startswith(".") for part in rest)


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
    import numpy as np

    numbers = np.empty(len(cells))
    for i, cell in enumerate(cells):
        try:
            numbers[i] = float(cell) if cell else np.nan
        except ValueError:
            raise InputError(
                f"{path}: row {i + 2}, column {name}: {cell!r} is not a number"
            ) from None
    return numbers
