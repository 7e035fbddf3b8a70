"""What every reader asks of a file and of the caller before it returns numbers."""

from __future__ import annotations

import math
import re

import numpy as np

from eventpound.motion.base import LARGEST, SMALLEST
from eventpound.motion.readers.base import Source, UnstatedError
from eventpound.motion.readers.numbers import NUMBER, to_float
from eventpound.numerics.arrays import Floats
from eventpound.units import STANDARD_GRAVITY

_UNITS = {
    "g": STANDARD_GRAVITY,
    "m/s2": 1.0,
    "cm/s2": 0.01,
    "gal": 0.01,
    "mm/s2": 0.001,
}

_FACTOR_AND_UNIT = re.compile(rf"\s*({NUMBER}(?=\s))?\s*([a-zA-Z].*)")

_MESSAGES = 5
"""Unreadable tokens that are named one by one."""


def unit_factor(units: str) -> float | None:
    """Metres per second squared in one of the unit.

    Parameters
    ----------
    units : str
        ``g``, ``m/s2``, ``cm/s2``, ``gal`` or ``mm/s2``; ``m/s^2``, ``m/s**2``,
        ``m/s/s`` and ``m/sec/sec`` are understood, capitals too. A number may
        stand before it, ``0.1 g``.

    Returns
    -------
    float or None
        The factor; None for an unknown unit.
    """
    match = _FACTOR_AND_UNIT.fullmatch(units)
    if match is None:
        return None
    number, unit = match.groups()
    name = re.sub(r"[\s*^]", "", unit.lower()).replace("sec", "s").replace("/s/s", "/s2")
    factor = _UNITS.get(name)
    return factor if factor is None or number is None else to_float(number) * factor


def accepted_units() -> str:
    """The units a record may have, as a phrase."""
    return ", ".join(_UNITS)


def ask_for_missing(
    source: Source, *, units: bool = False, time_step: bool = False, line: int | None = None
) -> None:
    """Stop where units or time step are neither in the file nor given.

    Parameters
    ----------
    source : Source
        The file, for messages.
    units, time_step : bool
        Whether they are missing.
    line : int, optional
        Where the numbers begin, before which they could stand.

    Raises
    ------
    UnstatedError
        Where one is.
    """
    missing = []
    if units:
        missing.append(("units", f'units = "..." ({accepted_units()})'))
    if time_step:
        missing.append(("time step", 'time_step = "... s"'))
    if missing:
        where = "" if line is None else f", line {line}"
        raise UnstatedError(
            f"{source.file}{where}: the file does not state its "
            f"{' and its '.join(name for name, _ in missing)}; "
            f"give {' and '.join(key for _, key in missing)}",
            [name.replace(" ", "_") for name, _ in missing],
        )


def agreed_units(
    source: Source, stated: str | None, line: int | None, given: str | None
) -> tuple[str, float]:
    """Unit of the numbers, from the file or from whoever asks.

    Parameters
    ----------
    source : Source
        The file, for messages.
    stated, line
        What the file says, and on which line (None: nothing).
    given : str or None
        What the caller says.

    Returns
    -------
    tuple of str and float
        The unit and its factor to m/s^2.

    Raises
    ------
    InputError
        Where neither says, a unit is unknown, or the two disagree.
    """
    ask_for_missing(source, units=stated is None and given is None)
    for units, where in ((given, None), (stated, line)):
        if units is not None and unit_factor(units) is None:
            raise source.error(
                where, f"units '{units}' are not understood; accepted: {accepted_units()}"
            )
    units = stated if stated is not None else given
    assert units is not None
    factor = unit_factor(units)
    assert factor is not None
    if given is not None and unit_factor(given) != factor:
        raise source.error(line, f"units = '{given}' were given, but the file states '{stated}'")
    return units, factor


def agreed_time_step(source: Source, stated: float, line: int | None, given: float | None) -> float:
    """Time step the file states, refused where the caller expects another.

    Parameters
    ----------
    source : Source
        The file, for messages.
    stated, line
        Time step of the file (s), and the line that states it.
    given : float or None
        What the caller says (s).

    Returns
    -------
    float
        The time step (s).

    Raises
    ------
    InputError
        Where it is not positive, or the two differ by more than rounding.
    """
    if not (math.isfinite(stated) and stated > 0.0):
        raise source.error(line, f"time step {stated!r} s; a positive number is needed")
    if not SMALLEST <= stated <= LARGEST:
        raise source.error(
            line, f"time step {stated!r} s; {SMALLEST:g} to {LARGEST:g} s can be computed with"
        )
    if given is not None and not math.isclose(given, stated, rel_tol=1e-9):
        raise source.error(
            line, f"time_step = {given!r} s was given, but the file has a time step of {stated!r} s"
        )
    return stated


def unreadable(source: Source, tokens: list[tuple[int, str]]) -> list[str]:
    """One message for each of the first few tokens that are not numbers.

    Parameters
    ----------
    source : Source
        The file.
    tokens : list of tuple of int and str
        Line (from 1) and token.

    Returns
    -------
    list of str
        The messages.
    """
    messages = [
        f"{source.file}, line {line}: found '{token}'; a finite number is expected"
        for line, token in tokens[:_MESSAGES]
    ]
    if len(tokens) > _MESSAGES:
        messages.append(f"{source.file}: {len(tokens) - _MESSAGES} more that are not numbers")
    return messages


def samples_in_si(source: Source, values: Floats, factor: float) -> Floats:
    """Samples in m/s^2, refused where they cannot be an accelerogram.

    Parameters
    ----------
    source : Source
        The file, for messages.
    values : ndarray, shape (n,)
        The numbers of the file.
    factor : float
        Their unit (m/s^2).

    Returns
    -------
    ndarray, shape (n,)
        Accelerations (m/s^2).

    Raises
    ------
    InputError
        For fewer than two samples, samples that are all zero, or one that no
        ground can have.
    """
    acceleration = values * factor
    if acceleration.size < 2:
        raise source.error(None, f"{acceleration.size} samples found; at least 2 are needed")
    if not np.any(acceleration):
        raise source.error(None, "every sample is zero")
    wrong = np.flatnonzero(~(np.abs(acceleration) <= LARGEST))
    if wrong.size:
        raise source.error(
            None,
            f"sample {wrong[0] + 1} is {acceleration[wrong[0]]:g} m/s^2; "
            f"at most {LARGEST:g} m/s^2 can be computed with",
        )
    return acceleration
