"""What a case may give as a frequency or as a period: omega = 2 pi / T.

omega in rad/s, T in s.
"""

from __future__ import annotations

import math

from eventpound.case.table import Table
from eventpound.errors import InputError
from eventpound.scene.bouc_wen_parameters import AGREEMENT
from eventpound.units import Dimension, quantity


def agree(first: float, second: float) -> bool:
    """Whether two ways of giving one value agree; a placeholder agrees with everything."""
    return not abs(first - second) > AGREEMENT * max(abs(first), abs(second))


def optional_period(table: Table, key: str) -> float | None:
    """A period (s) that a key gives; None where it is not given, NaN where it is wrong."""
    period = table.optional_quantity(key, Dimension.TIME, "a positive period (s)")
    return math.nan if period is not None and period <= 0.0 else period


def optional_omega(table: Table, key: str) -> float | None:
    """An angular frequency (rad/s) that a key gives; None where it is not given, NaN if wrong."""
    omega = table.optional_quantity(key, Dimension.ANGULAR_FREQUENCY)
    if omega is not None and omega < 0.0:
        table.reject(key, "a frequency that is not negative (rad/s)")
        return math.nan
    return omega


def optional_frequency(table: Table) -> tuple[float, float] | None:
    """Angular frequency and period from ``frequency`` or ``period``.

    Parameters
    ----------
    table : Table
        Has perhaps one of them, or both where they agree.

    Returns
    -------
    tuple of float, or None
        omega (rad/s, not negative) and T (s, positive), what is given as it is;
        None where neither is, NaN where it is wrong.
    """
    omega, period = optional_omega(table, "frequency"), optional_period(table, "period")
    if period is None:
        if omega is None:
            return None
        return omega, (2.0 * math.pi / omega if omega else math.inf)
    from_period = 2.0 * math.pi / period
    if omega is None:
        return from_period, period
    if not agree(omega, from_period):
        table.reject(
            "frequency", f"one of frequency and period; period says {from_period:.10g} rad/s"
        )
    return omega, period


def required_frequency(table: Table) -> tuple[float, float]:
    """Angular frequency and period that a table has to give, positive; NaN with problems noted."""
    omega, period = optional_frequency(table) or (math.nan, math.nan)
    if not (table.has("period") or table.has("frequency")):
        table.report_missing("period", f"{Dimension.TIME.accepted}; or frequency (rad/s)")
    elif omega == 0.0:
        table.reject("frequency", "a positive frequency (rad/s)")
    return omega or math.nan, period


def frequency_or_period(value: object) -> float:
    """Angular frequency from a frequency or, with a unit of time, a period.

    Parameters
    ----------
    value : object
        A number (rad/s) or a string with a unit.

    Returns
    -------
    float
        omega (rad/s), positive.

    Raises
    ------
    InputError
        Where it is neither, or not positive.
    """
    try:
        omega = quantity(value, Dimension.ANGULAR_FREQUENCY)
    except InputError as not_a_frequency:
        try:
            period = quantity(value, Dimension.TIME)
        except InputError:
            raise not_a_frequency from None
        omega = 2.0 * math.pi / period if period > 0.0 else math.nan
    if not omega > 0.0:
        raise InputError(f"found {value!r}; accepted: a positive frequency or period")
    return omega
