"""Clock times and ISO 8601 times in lines of numbers, as seconds.

``16:10:09.005``, ``2024/01/01 16:10:09.00`` and ``2024-01-01T16:10:09.005Z``, the date before or
apart, become seconds from the first midnight with the decimals that are printed. Where the date
changes, or there is none and the clock starts again, a day more has passed.
"""

from __future__ import annotations

import re

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
