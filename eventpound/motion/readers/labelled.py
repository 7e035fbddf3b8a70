"""Headers of labelled lines, ``LABEL: value``, ``LABEL = value`` or ``LABEL   value``."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from eventpound.motion.readers.base import Source
from eventpound.motion.readers.numbers import NUMBER, to_float

TOO_MANY = 1e12
_FIRST_NUMBER = re.compile(NUMBER)


@dataclass(frozen=True)
class Labelled:
    """Values of a header by their labels, as printed, and the line of each (from 1)."""

    source: Source
    values: Mapping[str, str]
    lines: Mapping[str, int]

    def text(self, label: str) -> str | None:
        """A value; None where there is none or it is blank."""
        return self.values.get(label) or None

    def number(self, label: str) -> tuple[float, int]:
        """The first number of a value, and its line.

        Raises
        ------
        InputError
            Where the label is missing or has no number.
        """
        if label not in self.values:
            raise self.source.error(None, f"the header has no line '{label}'")
        found = _FIRST_NUMBER.search(self.values[label])
        if found is None:
            raise self.source.error(
                self.lines[label],
                f"found '{self.values[label]}' for '{label}'; a number is expected",
            )
        return to_float(found.group()), self.lines[label]

    def count(self, label: str) -> tuple[int, int]:
        """A whole number that is positive, and its line.

        Raises
        ------
        InputError
            Where it is missing or none.
        """
        value, line = self.number(label)
        if not (1.0 <= value < TOO_MANY and value == int(value)):
            raise self.source.error(
                line, f"found '{self.values[label]}' for '{label}'; a whole number is expected"
            )
        return int(value), line


def read_labelled(source: Source, last: int, separator: str = ":") -> Labelled:
    """Read the header up to a line.

    Parameters
    ----------
    source : Source
        The file.
    last : int
        Its last line of labels (from 1).
    separator : str
        What stands between label and value.

    Returns
    -------
    Labelled
        The first value of each label.
    """
    values: dict[str, str] = {}
    lines: dict[str, int] = {}
    for number, line in enumerate(source.lines[:last], start=1):
        label, found, value = line.partition(separator)
        if found and label.strip() not in values:
            values[label.strip()] = value.strip()
            lines[label.strip()] = number
    return Labelled(source, values, lines)
