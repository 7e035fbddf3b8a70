"""Numbers as Fortran and other programs print them, touching ones included.

A field that is full leaves no blank before a minus sign, so that
``-4.8458E-02-2.8645E-02`` is two numbers. It is unambiguous only where every
number has its decimal point and each but the first its sign: anything else
that touches (``0.123-101``, an exponent that lost its E) is unreadable.
"""

from __future__ import annotations

import math
import re

NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?"

_ALONE = re.compile(NUMBER)
_POINTED = r"[+-]?(?:\d+\.\d*|\.\d+)(?:[eEdD][+-]?\d+)?"
_TOUCHING = re.compile(rf"{_POINTED}(?:(?=[+-]){_POINTED})+")
_ONE_OF_TOUCHING = re.compile(_POINTED)


def to_float(text: str) -> float:
    """The number a text shows, with E or D before its exponent.

    Parameters
    ----------
    text : str
        What matches `NUMBER`.

    Returns
    -------
    float
        The number; infinite where it is too large for a double.
    """
    return float(text.replace("d", "e").replace("D", "E"))


def split_token(token: str) -> list[str] | None:
    """The numbers a blank-free token holds.

    Parameters
    ----------
    token : str
        A token.

    Returns
    -------
    list of str or None
        One text, or several where numbers touch; None where the token is not
        finite numbers.
    """
    if _ALONE.fullmatch(token):
        parts = [token]
    elif _TOUCHING.fullmatch(token):
        parts = _ONE_OF_TOUCHING.findall(token)
    else:
        return None
    return parts if all(math.isfinite(to_float(part)) for part in parts) else None
