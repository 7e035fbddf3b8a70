"""Where the headers of a file stand, and patterns for what stands in them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

from eventpound.motion.readers.base import Source


def word_pattern(pattern: str) -> re.Pattern[str]:
    """A pattern for words of a header, whatever their letter case; ``^`` and ``$`` of a line."""
    return re.compile(pattern, re.IGNORECASE | re.MULTILINE)


@dataclass(frozen=True)
class Extent:
    """Where one header of a file stands.

    Parameters
    ----------
    start, last : int
        First and last line of its text (from 1).
    end : int
        The line after which the numbers follow.
    known : mapping of str to tuple of str and int
        Values that are not found by label or pattern, and the line of each.
    """

    start: int
    last: int
    end: int
    known: Mapping[str, tuple[str, int]] = field(default_factory=dict)


Extents = Callable[[Source], Iterable[Extent]]


def of_length(lines: int) -> Extents:
    """A header of so many lines."""
    return lambda source: [Extent(1, lines, lines)]


def while_like(pattern: str) -> Extents:
    """A header that ends before the first line that a pattern does not match."""
    like = word_pattern(pattern)

    def extents(source: Source) -> list[Extent]:
        lines = enumerate(source.lines)
        last = next((i for i, line in lines if not like.match(line)), len(source.lines))
        return [Extent(1, last, last or 1)]

    return extents


def until_like(pattern: str, within: int, missing: str) -> Extents:
    """A header that ends with the last of the first lines that a pattern matches."""

    def extents(source: Source) -> list[Extent]:
        last = line_like(source, pattern, within)
        if not last:
            raise source.error(None, missing)
        return [Extent(1, last, last)]

    return extents


def line_like(source: Source, pattern: str, within: int) -> int:
    """The last of the first lines that a pattern matches (from 1); 0 where it matches none."""
    numbered = enumerate(source.lines[:within], start=1)
    like = word_pattern(pattern)
    return max((i for i, line in numbered if like.match(line)), default=0)


def named_groups(match: re.Match[str], line: int) -> dict[str, tuple[str, int]]:
    """Values of a match in one line by the names of its groups, blanks for underscores."""
    found = match.groupdict().items()
    return {name.replace("_", " "): (text.strip(), line) for name, text in found if text}
