"""Values of ``[solver]``, read from the mapping of a case, a command or a call.

A solver reads each of its settings in one place, both where it runs and where it is asked
whether it can take them (`eventpound.solvers.base.Solver`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from eventpound.errors import InputError
from eventpound.units import Dimension, quantity

Settings = Mapping[str, object]


def word(settings: Settings, key: str, accepted: Sequence[str], default: str) -> str:
    """A setting that is one of some words, `default` where it is not given.

    Raises
    ------
    InputError
        For any other.
    """
    value = settings.get(key, default)
    if value not in accepted:
        *most, last = accepted
        known = f"{', '.join(most)} or {last}" if most else last
        raise InputError(f"[solver]: {key} = {value!r}; accepted: {known}")
    return str(value)


def number(
    settings: Settings,
    key: str,
    accepted: str,
    low: float,
    high: float = math.inf,
    *,
    dimension: Dimension | None = None,
) -> float | None:
    """A setting that is a number from `low` to `high`, low itself only where high is finite.

    Parameters
    ----------
    settings : mapping
        What was given.
    key : str
        Its key.
    accepted : str
        What is accepted, for the message.
    low, high : float
        Its bounds.
    dimension : Dimension, optional
        With it, a text with a unit is read, too.

    Returns
    -------
    float or None
        None where it was not given.

    Raises
    ------
    InputError
        Naming the key, its value and what is accepted.
    """
    found = value = settings.get(key)
    if value is None:
        return None
    if dimension is not None and isinstance(value, str):
        try:
            value = quantity(value, dimension)
        except InputError as error:
            raise InputError(f"[solver]: {key}: {error}") from None
    given = isinstance(value, int | float) and not isinstance(value, bool)
    try:
        result = float(value) if given else math.nan  # type: ignore[arg-type]
    except OverflowError:  # of a whole number of hundreds of digits
        result = math.inf
    above = result >= low if math.isfinite(high) else result > low
    if not (math.isfinite(result) and above and result <= high):
        raise InputError(f"[solver]: {key} = {found!r}; accepted: {accepted}")
    return result
