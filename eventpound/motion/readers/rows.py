"""Rows of numbers, with and without a header, and which way their series run."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import chain

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.readers.base import Source
from eventpound.motion.readers.numbers import clean_numbers, split_token, to_float, with_seconds
from eventpound.motion.readers.time_column import increases
from eventpound.numerics.arrays import Floats

COMMENT = re.compile(r"^\s*(#|%|!|//)")
SEPARATOR = re.compile(r"\s*[,;]\s*|\s+")
_EMPTY = tuple(a + b for a in ",;\n" for b in ",;\n" if a + b != "\n\n")
"""What an empty field looks like without blanks."""
_TITLE = re.compile(r"[\"'(]?(?!(?:nan|inf|infinity)$)[a-z]", re.IGNORECASE)
_ALONG_LINES = 0.75
"""Size of a step along the lines relative to one down the columns, at most."""


@dataclass(frozen=True)
class NumberRows:
    """The numbers of the file as printed, row by row, with the line of each (from 1).

    `before` are the lines before them, `bad` tokens that are no numbers, with
    their lines.
    """

    lines: list[int]
    rows: list[list[str]]
    before: list[str]
    bad: list[tuple[int, str]]
    numbers: Floats | None = None

    @property
    def width(self) -> int:
        """Numbers of the first row."""
        return len(self.rows[0])

    def column(self, index: int) -> Floats:
        """Numbers of one column of rows of one length, shape (n,)."""
        if self.numbers is not None:
            return self.numbers[index :: self.width]
        return np.array([to_float(row[index]) for row in self.rows])

    def refuse_odd(
        self, source: Source, width: int | None = None, *, all_but_last: bool = False
    ) -> None:
        """Stop at what is no number, and at a row of other than so many, or as many as the first.

        Raises
        ------
        InputError
            Naming the first of either.
        """
        if self.bad:
            raise InputError(source.unreadable(self.bad))
        if self.numbers is not None and width in (None, self.width):
            return
        as_first = "" if width else f", as on line {self.lines[0]}"
        end = len(self.rows) - all_but_last
        for number, row in zip(self.lines[:end], self.rows[:end], strict=True):
            if len(row) != (width or self.width):
                raise source.error(
                    number, f"{len(row)} numbers; {width or self.width} expected{as_first}"
                )

    def without_rows(self, count: int) -> NumberRows:
        """The same after so many rows."""
        numbers = None if self.numbers is None else self.numbers[count * self.width :]
        return replace(self, lines=self.lines[count:], rows=self.rows[count:], numbers=numbers)

    def without_column(self, index: int) -> NumberRows:
        """The same without one number of every row."""
        rows = [[x for i, x in enumerate(row) if i != index % len(row)] for row in self.rows]
        return replace(self, rows=rows, numbers=None)

    def column_texts(self, index: int) -> list[str]:
        """Numbers of one column as printed; those of rows that are too short are left out."""
        return [row[index] for row in self.rows if len(row) > index]


def numbers_begin(source: Source) -> list[str] | None:
    """First row of numbers, on the first line that is no comment, or the one after.

    None where the file begins otherwise.
    """
    found = 0
    for line in _lines(source):
        if line.strip() and not COMMENT.match(line):
            numbers, token = _numbers(line)
            if token is None:
                return numbers
            found += 1
            if found == 2:
                return None
    return None


@lru_cache(maxsize=1)
def read_rows(source: Source, header: int = 0) -> NumberRows:
    """All rows of numbers: after a header of so many lines, or comments and one line of titles.

    Where there is no header, commas and semicolons part numbers, too. There is at least one
    row. The last file is kept, because a format is told by the same rows that it is read from,
    and each of its components is a column of them.

    Raises
    ------
    InputError
        Where there is no line of numbers.
    """
    lines: list[int] = []
    rows: list[list[str]] = []
    before: list[str] = []
    bad: list[tuple[int, str]] = []
    titles, commas = 0, not header
    printed = source.lines if header else _lines(source)
    for number, line in enumerate(printed[header:], start=header + 1):
        if not line.strip():
            continue
        row, token = _numbers(line, commas)
        comment = COMMENT.match(line) is not None
        title = token is not None and not row and not titles and _TITLE.match(token) is not None
        if not (rows or header) and (comment or title):
            titles += not comment
            before.append(line)
        elif token is not None:
            bad.append((number, token))
        else:
            if (
                not rows
                and not bad
                and (table := _clean(printed, number, len(row), before, commas=not header))
            ):
                return table
            lines.append(number)
            rows.append(row)
    if not rows:
        raise source.error(None, "no line of numbers was found")
    return NumberRows(lines, rows, before, bad)


def _clean(
    printed: list[str], start: int, width: int, before: list[str], commas: bool
) -> NumberRows | None:
    """The rows from a line on, where nothing in them is odd."""
    lines = [(i, x) for i, x in enumerate(printed[start - 1 :], start=start) if x.strip()]
    text = "\n".join(line for _, line in lines)
    if commas and _has_empty_fields(text):
        return None
    if commas:
        text = text.replace(",", " ").replace(";", " ")
    rows = [line.split() for line in text.split("\n")]
    if any(len(row) != width for row in rows):
        return None
    numbers = clean_numbers(list(chain.from_iterable(rows)))
    return None if numbers is None else NumberRows([i for i, _ in lines], rows, before, [], numbers)


@lru_cache(maxsize=1)
def _lines(source: Source) -> list[str]:
    """Lines of a file, with seconds for clock times."""
    return with_seconds(source.lines) if b":" in source.content else source.lines


def _has_empty_fields(text: str) -> bool:
    """Whether a comma or semicolon has nothing on one side."""
    if "," not in text and ";" not in text:
        return False
    bare = "\n" + text.replace(" ", "").replace("\t", "") + "\n"
    return any(empty in bare for empty in _EMPTY)


def runs_along_lines(rows: NumberRows) -> bool:
    """Whether one series runs along lines of several numbers, not several down columns.

    Consecutive samples of an accelerogram lie closer together than distant ones
    and than two components, so the median step is smaller along the series. The
    one of 55 real records, cut into lines of 3, 5 and 8, is at most 0.61 of that
    down the columns; that of components side by side is above 3 times it. All lines but the
    last have to be of one length.
    """
    width, texts = rows.width, rows.rows
    if width < 3 or len(texts) < 4 or increases(rows.column_texts(0)):
        return False
    if any(len(row) != width for row in texts[:-1]) or len(texts[-1]) > width:
        return False
    full = texts if len(texts[-1]) == width else texts[:-1]
    numbers = np.array([to_float(text) for row in full for text in row]).reshape(-1, width)
    along = float(np.median(np.abs(np.diff(numbers.ravel()))))
    down = float(np.median(np.abs(np.diff(numbers, axis=0))))
    return along < _ALONG_LINES * down


def _numbers(line: str, commas: bool = True) -> tuple[list[str], str | None]:
    """The numbers of a line as printed, and its first token that is none."""
    numbers: list[str] = []
    for token in SEPARATOR.split(line.strip().rstrip(",; ")) if commas else line.split():
        parts = split_token(token)
        if parts is None:
            return numbers, token
        numbers += parts
    return numbers, None
