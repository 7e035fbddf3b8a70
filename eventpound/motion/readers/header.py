"""Where headers of a file of a record stand, and what stands in them."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from decimal import Decimal

import numpy as np

from eventpound.motion.base import LARGEST, SMALLEST
from eventpound.motion.readers.base import SAME_STEP, Given, RecordData, Source, UnstatedError
from eventpound.motion.readers.numbers import HALF_A_DIGIT, NUMBER, to_float
from eventpound.numerics.arrays import Floats
from eventpound.units import STANDARD_GRAVITY


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


_UNITS = {"g": STANDARD_GRAVITY, "m/s2": 1.0, "cm/s2": 0.01, "gal": 0.01, "mm/s2": 0.001}
_ACCEPTED = ", ".join(_UNITS)
_FACTOR_AND_UNIT = re.compile(rf"\s*({NUMBER}(?=\s))?\s*([a-zA-Z].*)")


@dataclass(frozen=True)
class Peak:
    """The largest absolute sample as a header prints it.

    Parameters
    ----------
    text : str
        The number as printed; its last decimal says how exact it is.
    units : str
        Its unit.
    line : int
        Where it stands (from 1).
    """

    text: str
    units: str
    line: int


@dataclass(frozen=True)
class Header:
    """What is known of a component besides its numbers.

    Parameters
    ----------
    units, units_line
        Unit of the numbers and the line that states it; None where nothing does.
    time_step, time_step_line
        Their distance (s) and the line that states it.
    event, station, component, date : str, optional
        As they are printed.
    peak : Peak, optional
        The peak that the file states.
    """

    units: str | None = None
    units_line: int | None = None
    time_step: float | None = None
    time_step_line: int | None = None
    event: str | None = None
    station: str | None = None
    component: str | None = None
    date: str | None = None
    peak: Peak | None = None


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
    name = re.sub(r"^(cm|gal)s\b|\.$", r"\1", name)
    factor = _UNITS.get(name)
    return factor if factor is None or number is None else to_float(number) * factor


def record_data(
    source: Source,
    format: str,
    header: Header,
    values: Floats,
    given: Given,
    notes: tuple[str, ...] = (),
) -> RecordData:
    """The record that header, numbers in the file's unit and what the caller knows make.

    Parameters
    ----------
    source, format : Source, str
        The file and the name of its reader.
    header, values : Header, ndarray of shape (n,)
        What the file says, and its numbers.
    given : Given
        What the caller says.
    notes : tuple of str
        What was passed over.

    Raises
    ------
    UnstatedError
        Where neither says units or time step.
    InputError
        Where they disagree, or the samples are no accelerogram.
    """
    ask_for_missing(
        source,
        units=header.units is None and given.units is None,
        time_step=header.time_step is None and given.time_step is None,
    )
    units, factor = _agreed_units(source, header, given)
    acceleration = _in_si(source, values, factor)
    step = _agreed_time_step(source, header, given)
    read = units, format, source.file, source.sha256
    named = header.event, header.station, header.component, header.date
    notes += _other_peak(header.peak, acceleration)
    return RecordData(acceleration, step, *read, *named, notes)


def ask_for_missing(
    source: Source, *, units: bool, time_step: bool, line: int | None = None
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
        missing.append(("units", f'units = "..." ({_ACCEPTED})'))
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


def _agreed_units(source: Source, header: Header, given: Given) -> tuple[str, float]:
    """Unit of the numbers and its factor to m/s^2; file and caller must not disagree."""
    factors = []
    for units, line in ((given.units, None), (header.units, header.units_line)):
        if units is None:
            continue
        factor = unit_factor(units)
        if factor is None:
            raise source.error(line, f"units '{units}' are not understood; accepted: {_ACCEPTED}")
        factors.append((units, factor))
    if factors[0][1] != factors[-1][1]:
        raise source.error(
            header.units_line,
            f"units = '{given.units}' were given, but the file states '{header.units}'",
        )
    return factors[-1]


def _agreed_time_step(source: Source, header: Header, given: Given) -> float:
    """Time step (s); that of the file must not differ from the caller's by more than rounding."""
    line, other = header.time_step_line, given.time_step
    stated = other if header.time_step is None else header.time_step
    assert stated is not None
    if not (math.isfinite(stated) and stated > 0.0):
        raise source.error(line, f"time step {stated!r} s; a positive number is needed")
    if not SMALLEST <= stated <= LARGEST:
        raise source.error(
            line, f"time step {stated!r} s; {SMALLEST:g} to {LARGEST:g} s can be computed with"
        )
    if other is not None and not math.isclose(other, stated, rel_tol=SAME_STEP):
        raise source.error(
            line, f"time_step = {other!r} s was given, but the file has a time step of {stated!r} s"
        )
    return stated


def _in_si(source: Source, values: Floats, factor: float) -> Floats:
    """Samples in m/s^2, refused where they cannot be an accelerogram."""
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


def _other_peak(peak: Peak | None, acceleration: Floats) -> tuple[str, ...]:
    """A note where the samples do not have the peak that the file states."""
    factor = None if peak is None else unit_factor(peak.units)
    if peak is None or factor is None or not re.fullmatch(NUMBER, peak.text):
        return ()
    exponent = int(Decimal(peak.text.replace("D", "E").replace("d", "e")).as_tuple().exponent)
    stated = abs(to_float(peak.text))
    found = float(np.max(np.abs(acceleration))) / factor
    if abs(found - stated) <= float(f"{HALF_A_DIGIT}e{exponent}") + 1e-12 * found:
        return ()
    return (
        f"line {peak.line} states a peak of {peak.text} {peak.units}, "
        f"the samples have {found:.6g} {peak.units}",
    )
