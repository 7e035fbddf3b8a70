"""Numbers and clock times as Fortran and other programs print them.

A field that is full leaves no blank before a minus sign, so that
``-4.8458E-02-2.8645E-02`` is two numbers. It is unambiguous only where every
number has its decimal point and each but the first its sign: anything else
that touches (``0.123-101``, an exponent that lost its E) is unreadable, unless
the format says how wide a field is.

Clock times and ISO 8601 times in lines of numbers, as seconds.

``16:10:09.005``, ``2024/01/01 16:10:09.00`` and ``2024-01-01T16:10:09.005Z``, the date before or
apart, become seconds from the first midnight with the decimals that are printed. Where the date
changes, or there is none and the clock starts again, a day more has passed.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np

from eventpound.numerics.arrays import Floats

NUMBER = r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eEdD][+-]?\d+)?"

_ALONE = re.compile(NUMBER)
_POINTED = r"[+-]?(?:\d+\.\d*|\.\d+)(?:[eEdD][+-]?\d+)?"
_TOUCHING = re.compile(rf"{_POINTED}(?:(?=[+-]){_POINTED})+")
_ONE_OF_TOUCHING = re.compile(_POINTED)
HALF_A_DIGIT = 0.51
"""Rounding of a printed number in units of its last decimal, and a little for binary numbers."""
_TOUCH = re.compile(r"(?<=[\d.])(?=[+-])")


def to_float(text: str) -> float:
    """The number that what matches `NUMBER` shows; infinite where it is too large for a double."""
    return float(text.replace("d", "e").replace("D", "E"))


def to_count(text: str) -> int:
    """The whole number that digits show; too large in any case where they are dozens.

    Python refuses to make a number of thousands of digits.
    """
    return int(text.lstrip("0")[:18] or "0")


def split_token(token: str) -> list[str] | None:
    """The numbers a blank-free token holds, several where they touch.

    None where the token is not finite numbers.
    """
    if _ALONE.fullmatch(token):
        parts = [token]
    elif _TOUCHING.fullmatch(token):
        parts = _ONE_OF_TOUCHING.findall(token)
    else:
        return None
    return parts if all(math.isfinite(to_float(part)) for part in parts) else None


def clean_numbers(tokens: Sequence[str]) -> Floats | None:
    """Numbers of tokens of which each is one, shape (n,).

    This is what most lines of most files are. What it does not understand, a token that is
    not a finite number as `float` reads it, is left to `numbers_of_line`: it returns None.
    """
    try:
        values = np.array(tokens, dtype=float)
    except ValueError:
        return None
    underscored = "_" in "".join(tokens)  # which Python's numbers may be
    return None if underscored or not np.isfinite(values).all() else values


def parted(line: str) -> list[str] | None:
    """Tokens of a line or of many, with a blank put before each sign that begins a number.

    None unless each has a decimal point, because otherwise an exponent may have lost its E.
    """
    tokens = _TOUCH.sub(" ", line).split()
    return tokens if all("." in token for token in tokens) else None


def numbers_of_line(line: str, width: int | None = None) -> tuple[list[float], list[str]]:
    """Numbers of a line, and the tokens that are none.

    Fields of `width` characters, where the format has them, are used where numbers touch that
    cannot be parted otherwise.
    """
    tokens = line.split()
    parts = [split_token(token) for token in tokens]
    if None in parts and width:
        text = line.rstrip()
        fields = [text[i : i + width].strip() for i in range(0, len(text), width)]
        in_fields = [split_token(field) for field in fields]
        if all(part is not None and len(part) == 1 for part in in_fields):
            tokens, parts = fields, in_fields
    numbers = [to_float(text) for part in parts if part is not None for text in part]
    return numbers, [token for token, part in zip(tokens, parts, strict=True) if part is None]


_DATE = r"\d{4}[-/.]\d\d?[-/.]\d\d?|\d\d?[-/.]\d\d?[-/.]\d{4}"
_CLOCK = re.compile(
    rf"[\"']?(?:(?<!\d)(?P<date>{_DATE})[\"']?(?:[T_]|\s*[,;]\s*|\s+)[\"']?)?"
    r"(?P<hours>(?<!\d)\d\d?):(?P<minutes>[0-5]\d):(?P<seconds>[0-5]\d)"
    # A comma parts columns, unless a semicolon does.
    r"(?P<decimals>\.\d*|:\d+|,\d+(?=\s*;))?(?:\s*(?:Z|UTC)\b|[+-]\d\d:?\d\d\b|\s+[+-]\d\d:?\d\d(?=[\"']?\s*[,;\t]))?[\"']?"
)
_BEFORE = re.compile(r"\s*(?:\d+[\s,;]+)?")
"""What may stand before: nothing, or the number of the row."""
_DAY = 86400


def with_seconds(lines: list[str]) -> list[str]:
    """Lines with seconds in the place of a clock time at their beginning.

    Parameters
    ----------
    lines : list of str
        All lines of a file.

    Returns
    -------
    list of str
        The same list where no line has one.
    """
    read: list[str] = []
    changed, days, date, last = False, 0, None, 0
    for line in lines:
        match = _CLOCK.search(line) if ":" in line else None
        if match is None or not _BEFORE.fullmatch(line[: match.start()]):
            read.append(line)
            continue
        hours, minutes, seconds = (int(match[key]) for key in ("hours", "minutes", "seconds"))
        clock = 3600 * hours + 60 * minutes + seconds
        if changed:
            days += date != match["date"] if match["date"] else clock < last - _DAY // 2
        changed, date, last = True, match["date"], clock
        decimals = (match["decimals"] or "")[1:]
        text = f"{_DAY * days + clock}" + (f".{decimals}" if decimals else "")
        read.append(line[: match.start()] + text + " " + line[match.end() :])
    return read if changed else lines
