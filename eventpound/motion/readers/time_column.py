"""The even time step behind a printed column of times.

It is the shortest decimal number dt for which every printed time is

    t_i = t_0 + i dt

to half a unit of its last decimal and a thousandth of dt (s). Times rounded
more coarsely by their writer cannot be told from the file.
"""

from __future__ import annotations

import re

import numpy as np

from eventpound.motion.readers.base import Source
from eventpound.motion.readers.numbers import HALF_A_DIGIT, clean_numbers, to_count, to_float
from eventpound.numerics.arrays import Floats

_TOLERANCE = 1.0e-3
"""Deviation of a printed time, in steps, beyond the rounding of its last decimal."""
_AFTER_POINT = re.compile(r"\.(.*)")
"""What follows the first point of a line."""
_MOST = 0.9
"""Share of steps that are positive in a column of times; about half are in other columns."""
_LARGEST_POWER = 308
"""Of ten, that a double can hold."""


def increases(texts: list[str]) -> bool:
    """Whether most of the printed numbers are larger than the one before, as times are."""
    times = _times(texts)
    return times.size > 1 and float(np.mean(np.diff(times) > 0.0)) > _MOST


def even_step(source: Source, texts: list[str], lines: list[int]) -> float:
    """The step of a column of times.

    Parameters
    ----------
    source : Source
        The file, for messages.
    texts : list of str
        The times as printed.
    lines : list of int
        The line of each (from 1).

    Returns
    -------
    float
        dt (s).

    Raises
    ------
    InputError
        Naming the first line where the times do not increase evenly.
    """
    times = _times(texts)
    if times.size < 2:
        raise source.error(None, "one row of numbers; at least 2 are needed")
    resolution = _resolution(texts)
    usual = float(np.median(np.diff(times)))
    _refuse_uneven_steps(source, lines, np.diff(times), usual, resolution)
    dt = _shortest_step(times, resolution, usual)
    allowed = HALF_A_DIGIT * resolution + _TOLERANCE * dt
    off = np.flatnonzero(np.abs(times - times[0] - dt * np.arange(times.size)) > allowed)
    if off.size:
        i = int(off[0])
        raise source.error(
            lines[i],
            f"the time step is not even: found t = {texts[i]} s, "
            f"expected {times[0] + i * dt:.9g} s",
        )
    return dt


def _refuse_uneven_steps(
    source: Source, lines: list[int], steps: Floats, usual: float, resolution: float
) -> None:
    """Stop at the first step that is not positive or far from the usual one."""
    if usual <= 0.0:
        raise source.error(
            lines[1],
            "two columns, but the first does not increase, so it is no time; "
            "one column (a) or two (t, a) are accepted",
        )
    allowed = 2.0 * HALF_A_DIGIT * resolution + 10.0 * _TOLERANCE * usual
    uneven = np.flatnonzero((steps <= 0.0) | (np.abs(steps - usual) > allowed))
    if uneven.size:
        i = int(uneven[0])
        raise source.error(
            lines[i + 1],
            f"the time step is not even: found {steps[i]:.6g} s, expected {usual:.6g} s",
        )


def _times(texts: list[str]) -> Floats:
    """The printed numbers."""
    times = clean_numbers(texts)
    return np.array([to_float(text) for text in texts]) if times is None else times


def _resolution(texts: list[str]) -> float:
    """Unit of the last decimal (s); the finest counts, trailing zeros may be missing."""
    joined = "\n".join(texts)
    if any(letter in joined for letter in "eEdD"):
        return float(10.0 ** min(_LARGEST_POWER, *(_last_power(text) for text in texts)))
    decimals = max(map(len, _AFTER_POINT.findall(joined)), default=0)
    return float(10.0**-decimals)


def _last_power(text: str) -> int:
    """Power of ten of the last digit printed, however many digits its exponent has."""
    digits, _, power = text.upper().replace("D", "E").partition("E")
    size = to_count(power.lstrip("+-"))
    return (-size if power.startswith("-") else size) - len(digits.partition(".")[2])


def _shortest_step(times: Floats, resolution: float, usual: float) -> float:
    """Shortest decimal number that leads from the first time to the last (s)."""
    intervals = times.size - 1
    mean = float(times[-1] - times[0]) / intervals
    allowed = HALF_A_DIGIT * resolution + _TOLERANCE * usual
    candidates = (float(f"{mean:.{digits}e}") for digits in range(17))
    return next(dt for dt in candidates if abs(dt - mean) * intervals <= allowed)
