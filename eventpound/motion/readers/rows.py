"""Headerless text: the rows of numbers of a file, and which way its series run."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.readers.base import Source
from eventpound.motion.readers.checks import unreadable
from eventpound.motion.readers.numbers import split_token, to_float
from eventpound.numerics.arrays import Floats

COMMENT = re.compile(r"\s*(#|%|!|//)")
SEPARATOR = re.compile(r"\s*[,;]\s*|\s+")
_TITLE = re.compile(r"[\"'(]?(?!(?:nan|inf|infinity)$)[a-z]", re.IGNORECASE)
_ALONG_LINES = 0.75
"""Size of a step along the lines relative to one down the columns, at most."""


@dataclass(frozen=True)
class Rows:
    """The numbers of the file as printed, row by row, with the line of each (from 1).

    `before` are the lines before them, `bad` tokens that are no numbers, with
    their lines.
    """

    lines: list[int]
    rows: list[list[str]]
    before: list[str]
    bad: list[tuple[int, str]]

    @property
    def width(self) -> int:
        """Numbers of the first row."""
        return len(self.rows[0])

    def column(self, index: int) -> Floats:
        """Numbers of one column, shape (n,)."""
        return np.array([to_float(row[index]) for row in self.rows])

    def column_texts(self, index: int) -> list[str]:
        """Numbers of one column as printed; those of rows that are too short are left out."""
        return [row[index] for row in self.rows if len(row) > index]

    def refuse_bad(self, source: Source) -> None:
        """Stop where there are tokens that are no numbers."""
        if self.bad:
            raise InputError(unreadable(source, self.bad))


def numbers_begin(source: Source) -> list[str] | None:
    """First row of numbers, on the first line that is no comment, or the one after.

    Parameters
    ----------
    source : Source
        The file.

    Returns
    -------
    list of str or None
        The numbers; None where the file begins otherwise.
    """
    found = 0
    for line in source.lines:
        if line.strip() and not COMMENT.match(line):
            numbers, token = _numbers(line)
            if token is None:
                return numbers
            found += 1
            if found == 2:
                return None
    return None


def read_rows_of_text(source: Source) -> Rows:
    """All rows of numbers, after comments and one line of titles.

    Parameters
    ----------
    source : Source
        The file.

    Returns
    -------
    Rows
        At least one.

    Raises
    ------
    InputError
        Where there is no line of numbers.
    """
    table = Rows([], [], [], [])
    titles = 0
    for number, line in enumerate(source.lines, start=1):
        if not line.strip():
            continue
        row, token = _numbers(line)
        comment = COMMENT.match(line) is not None
        title = token is not None and not row and not titles and _TITLE.match(token) is not None
        if not table.rows and (comment or title):
            titles += not comment
            table.before.append(line)
        elif token is not None:
            table.bad.append((number, token))
        else:
            table.lines.append(number)
            table.rows.append(row)
    if not table.rows:
        raise source.error(None, "no line of numbers was found")
    return table


def runs_along_lines(rows: list[list[str]]) -> bool:
    """Whether one series runs along lines of several numbers, not several down columns.

    Consecutive samples of an accelerogram lie closer together than distant ones
    and than two components, so the median step is smaller along the series. The
    one of 55 real records, cut into lines of 3, 5 and 8, is at most 0.61 of that
    down the columns; that of components side by side is above 3 times it.

    Parameters
    ----------
    rows : list of list of str
        Numbers of the lines, all but the last of one length.
    """
    width = len(rows[0])
    if width < 3 or len(rows) < 4:
        return False
    if any(len(row) != width for row in rows[:-1]) or len(rows[-1]) > width:
        return False
    full = rows if len(rows[-1]) == width else rows[:-1]
    numbers = np.array([[to_float(text) for text in row] for row in full])
    along = float(np.median(np.abs(np.diff(numbers.ravel()))))
    down = float(np.median(np.abs(np.diff(numbers, axis=0))))
    return along < _ALONG_LINES * down


def _numbers(line: str) -> tuple[list[str], str | None]:
    """The numbers of a line as printed, and its first token that is none."""
    numbers: list[str] = []
    for token in SEPARATOR.split(line.strip()):
        parts = split_token(token)
        if parts is None:
            return numbers, token
        numbers += parts
    return numbers, None
