"""Blocks of a stated number of samples, which are there in full or refused."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.readers.base import Source
from eventpound.motion.readers.numbers import clean_numbers, numbers_of_line, parted
from eventpound.numerics.arrays import Floats

FOLLOWING_WORD = re.compile(r"\b(?!nan\b|inf(?:inity)?\b)[a-z]{2,}", re.IGNORECASE)
"""What tells text after the numbers from a number that is damaged."""

END_OF_CHANNEL = "/&"
"""What the line after the last number of a channel begins with, in files of several."""


@dataclass(frozen=True)
class StatedCount:
    """How many samples a file says there are.

    Parameters
    ----------
    count : int
        The number.
    line : int
        The line that says so (from 1).
    name : str
        What the number is called there.
    """

    count: int
    line: int
    name: str = "NPTS"


@dataclass(frozen=True, eq=False)
class Block:
    """Samples and the line after them (from 1)."""

    values: Floats
    next_line: int


def numbers_of_block(
    source: Source,
    first: int,
    stated: StatedCount,
    width: int | None = None,
    *,
    ends_file: bool = True,
) -> tuple[Floats, tuple[str, ...]]:
    """The samples of a block, and a note on text behind one that should end its file."""
    block = read_block(source, first, stated, width)
    return block.values, after_last(source, block.next_line, stated) if ends_file else ()


def read_block(source: Source, first: int, stated: StatedCount, width: int | None = None) -> Block:
    """Read exactly the stated number of samples.

    Parameters
    ----------
    source : Source
        The file.
    first : int
        Line of the first sample (from 1).
    stated : StatedCount
        How many there are.
    width : int, optional
        Characters of a field, where the format fixes it.

    Returns
    -------
    Block
        The samples.

    Raises
    ------
    InputError
        For tokens that are not numbers, too few numbers, or a line that goes on
        beyond the last of them.
    """
    while first <= len(source.lines) and not source.line(first).strip():
        first += 1
    a_line = len(parted(source.line(first)) or source.line(first).split())
    if a_line:
        lines = source.lines[first - 1 : first - 1 + -(-stated.count // a_line)]
        values = _values(lines, stated.count)
        if values is not None:
            return Block(values, first + len(lines))
    return _read_line_by_line(source, first, stated, width)


def _values(lines: list[str], count: int) -> Floats | None:
    """All numbers of lines that have this many, told by blanks and signs alone."""
    text = "\n".join(lines)
    tokens = text.split()
    if len(tokens) < count:
        tokens = parted(text) or []
    return clean_numbers(tokens) if len(tokens) == count else None


def _read_line_by_line(source: Source, first: int, stated: StatedCount, width: int | None) -> Block:
    """The slow way: touching numbers, D exponents, lines of any length, and what is wrong."""
    values: list[float] = []
    problems: list[tuple[int, str]] = []
    number = first
    for number in range(first, len(source.lines) + 1):
        if len(values) + len(problems) >= stated.count:
            break
        numbers, bad = numbers_of_line(source.line(number), width)
        if len(numbers) < len(bad) and FOLLOWING_WORD.search(source.line(number)):
            break  # what follows the numbers, too early
        values += numbers
        problems += [(number, token) for token in bad]
    else:
        number = len(source.lines) + 1
    messages = source.unreadable(problems)
    if len(values) + len(problems) != stated.count:
        messages.append(miscounted(source, stated, len(values), number - 1))
    if messages:
        raise InputError(messages)
    return Block(np.array(values), number)


def after_last(source: Source, first: int, stated: StatedCount) -> tuple[str, ...]:
    """What follows a block that should end its file, from a line on (from 1).

    Text is passed over, which a note says.

    Raises
    ------
    InputError
        Where more numbers follow.
    """
    for number in range(first, len(source.lines) + 1):
        line = source.line(number)
        if not line.strip():
            continue
        if line.startswith(END_OF_CHANNEL):
            return ()
        if numbers_of_line(line)[0]:
            more = sum(len(numbers_of_line(x)[0]) for x in source.lines[number - 1 :])
            last = len(source.lines)
            raise InputError(miscounted(source, stated, stated.count + more, last))
        return (f"line {number}: text after the last sample passed over: '{line.strip()[:60]}'",)
    return ()


def miscounted(
    source: Source, stated: StatedCount, found: int, last: int, what: str = "numbers"
) -> str:
    """The message for another number of samples up to a line than is stated."""
    while last > 1 and not source.line(last).strip():
        last -= 1
    return (
        f"{source.file}: {found} {what} found up to line {last}; "
        f"line {stated.line} states {stated.name} = {stated.count}"
    )
