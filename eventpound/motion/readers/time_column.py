"""The even time step behind a printed column of times.

It is a step h for which every printed time is

    t_i = t_0 + i h

to half a unit of its last decimal and a thousandth of h (s), for some t_0: so times that were
cut off are read as those that were rounded. All h of which this is true are an interval, of
which the roundest is taken: the one of fewest digits, as a step (0.005 s) or as a rate (512 Hz).

Times printed more coarsely than their step repeat or skip, regularly. Where only a few do, rows
are missing or there twice.
"""

from __future__ import annotations

import re

import numpy as np

from eventpound.errors import InputError
from eventpound.motion.readers.base import SAME_STEP, Source
from eventpound.motion.readers.numbers import HALF_A_DIGIT, clean_numbers, to_count, to_float
from eventpound.numerics.arrays import Floats

_TOLERANCE = 1.0e-3
"""Deviation of a printed time, in steps, beyond the rounding of its last decimal."""
_AFTER_POINT = re.compile(r"\.(.*)")
"""What follows the first point of a line."""
_MOST = 0.9
"""Share of steps that are positive in a column of times; about half are in other columns."""
_REGULAR, _SOME = 0.1, 3
"""Share and number of steps that repeat or skip a time, at least, where rounding does it."""
_LOOSE = 0.25
"""Range of the steps that fit, in steps, above which one is no more than a guess."""
_LARGEST_POWER = 308
"""Of ten, that a double can hold."""


def increases(texts: list[str]) -> bool:
    """Whether the printed numbers go up, as times do: most, or none down and some up."""
    times = _times(texts)
    if times.size < 2:
        return False
    steps = np.diff(times)
    up = float(np.mean(steps > 0.0))
    return up > _MOST or (up > _REGULAR and float(np.min(steps)) >= 0.0)


def even_step(
    source: Source,
    texts: list[str],
    lines: list[int],
    stated: float | None = None,
    unit: float = 1.0,
) -> float:
    """The step of a column of times.

    Parameters
    ----------
    source : Source
        The file, for messages.
    texts : list of str
        The times as printed.
    lines : list of int
        The line of each (from 1).
    stated : float, optional
        The step (s) that is known otherwise; it is taken where it fits the times.
    unit : float
        Seconds in one of the unit of the times.

    Returns
    -------
    float
        h (s).

    Raises
    ------
    InputError
        Naming the first line where the times do not increase evenly.
    """
    times = _times(texts)
    if times.size < 2:
        raise source.error(None, "one row of numbers; at least 2 are needed")
    width = 2.0 * HALF_A_DIGIT * resolution(texts)
    width += 2.0 * _TOLERANCE * abs(float(times[-1] - times[0])) / (times.size - 1)
    found = _steps_within(times, width)
    if found is None or found[1] <= 0.0:
        raise _uneven(source, texts, lines, times, width)
    middle, steps = 0.5 * (found[0] + found[1]), np.diff(times)
    loose = found[1] - found[0] > _LOOSE * middle
    odd = np.flatnonzero(np.abs(steps - middle) >= _MOST * middle)
    if loose and steps.max() - steps.min() > 0.5 * width:
        # A few coarse times fit many steps, of which none is borne out.
        odd = np.flatnonzero(np.abs(steps - steps[0]) > 0.5 * width)
    elif odd.size >= _SOME:
        # Those that rounding makes are as far apart everywhere, but for one row.
        apart, ends = np.diff(odd), max(int(odd[0]), steps.size - 1 - int(odd[-1]))
        regular = np.ptp(apart) <= 1 and ends <= apart.max()
        if regular or odd.size >= _REGULAR * steps.size:
            odd = odd[:0]
    if odd.size:
        raise _uneven(source, texts, lines, times, width, int(odd[0]) + 1)
    low, high = found[0] * unit, found[1] * unit
    step = _roundest(low, high)
    if stated is None or not low * (1.0 - SAME_STEP) <= stated <= high * (1.0 + SAME_STEP) or loose:
        return step
    return stated


def _steps_within(times: Floats, width: float) -> tuple[float, float] | None:
    """Smallest and largest h for which all t_i - i h lie within a width; None where none is."""
    low, high = _least_step(times, width), _least_step(-times, width)
    return None if low is None or high is None else (low, -high)


def _least_step(times: Floats, width: float) -> float | None:
    """Smallest h for which all t_i - i h lie within a width.

    Their largest less their smallest is convex in h, and straight between its corners: Newton's
    iteration from below goes from corner to corner.
    """
    i = np.arange(times.size)
    h = float(times[-1] - times[0] - width) / (times.size - 1)
    rounding = 4.0 * np.finfo(float).eps * float(np.max(np.abs(times)))
    while True:
        rest = times - h * i
        most, least = int(np.argmax(rest)), int(np.argmin(rest))
        if rest[most] - rest[least] <= width + rounding:
            return h
        if most <= least:
            return None
        higher = float(times[most] - times[least] - width) / (most - least)
        if not higher > h:
            return h
        h = higher


def _roundest(low: float, high: float) -> float:
    """The number of fewest digits of an interval, or with a reciprocal of no more."""
    rate = 0.5 / low + 0.5 / high if low > 0.0 else np.inf
    for digits in range(17):
        for step in (1.0 / float(f"{rate:.{digits}e}"), float(f"{0.5 * (low + high):.{digits}e}")):
            if low <= step <= high and step > 0.0:
                return step
    return 0.5 * (low + high)


def _uneven(
    source: Source,
    texts: list[str],
    lines: list[int],
    times: Floats,
    width: float,
    at: int | None = None,
) -> InputError:
    """What is wrong with times, at the first for which no even step is left."""
    steps = np.diff(times)
    usual = float(np.sort(steps)[(steps.size - 1) // 2]) or float(np.mean(steps))
    if usual <= 0.0:
        return source.error(
            lines[1], "two columns, but the first does not increase, so it is no time"
        )
    if at is None:
        at, last = 1, times.size - 1
        while at < last:
            middle = (at + last) // 2
            if _steps_within(times[: middle + 1], width) is None:
                last = middle
            else:
                at = middle + 1
    found = f"{steps[at - 1]:.6g} s, expected {usual:.6g} s"
    if abs(steps[at - 1] - usual) <= 0.5 * width:
        found = f"t = {texts[at]} s, expected {times[0] + at * usual:.9g} s"
    return source.error(lines[at], f"the time step is not even: found {found}")


def _times(texts: list[str]) -> Floats:
    """The printed numbers."""
    times = clean_numbers(texts)
    return np.array([to_float(text) for text in texts]) if times is None else times


def resolution(texts: list[str]) -> float:
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
