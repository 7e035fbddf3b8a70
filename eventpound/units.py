"""Numbers with units, read at the border of the program; inside, everything is SI.

A number is SI already; a string is a number and a unit, ``"1.27 cm"``. One g is
standard gravity, 9.80665 m/s^2 exactly (3rd CGPM, 1901).
"""

from __future__ import annotations

import math
import re
from contextlib import suppress
from decimal import Decimal
from enum import Enum
from functools import cache
from numbers import Real
from typing import TYPE_CHECKING

from eventpound.errors import InputError

if TYPE_CHECKING:
    from pint import UnitRegistry

STANDARD_GRAVITY = 9.80665
"""1 g (m/s^2)."""


class Dimension(Enum):
    """What a quantity is; the value is its name, its SI unit and an example with a unit."""

    LENGTH = ("length", "m", "1.27 cm")
    VELOCITY = ("velocity", "m/s", "15 cm/s")
    ACCELERATION = ("acceleration", "m/s^2", "0.4 g")
    MASS = ("mass", "kg", "1301 t")
    INERTIA = ("moment of inertia", "kg m^2", "2e5 t m^2")
    FORCE = ("force", "N", "3440 kN")
    IMPULSE = ("impulse", "N s", "120 kN s")
    ENERGY = ("energy", "J", "35 kJ")
    STIFFNESS = ("stiffness", "N/m", "1051 kN/m")
    HERTZ_STIFFNESS = ("Hertz stiffness", "N/m^1.5", "2.75e6 kN/m^1.5")
    DAMPING = ("damping coefficient", "N s/m", "1743 kN s/m")
    TIME = ("time", "s", "0.8 s")
    ANGULAR_FREQUENCY = ("angular frequency", "rad/s", "7.85 rad/s")
    FREQUENCY = ("frequency", "Hz", "25 Hz")
    RATE = ("rate", "1/s", "0.3 1/s")
    ANGLE = ("angle", "rad", "90 deg")
    NUMBER = ("plain number", "", "5 %")

    @property
    def unit(self) -> str:
        """The SI unit."""
        return self.value[1]

    @property
    def accepted(self) -> str:
        """What may be written, as a phrase."""
        name, unit, example = self.value
        article = "an" if name[0] in "aeiou" else "a"
        if unit:
            return f'{article} {name}: a number in {unit}, or a string like "{example}"'
        return f'{article} {name}, or a string like "{example}"'


USUAL = {
    Dimension.LENGTH: {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254},
    Dimension.VELOCITY: {"m/s": 1.0, "cm/s": 0.01},
    Dimension.ACCELERATION: {"m/s^2": 1.0, "g": STANDARD_GRAVITY},
    Dimension.MASS: {"kg": 1.0, "t": 1e3},
    Dimension.ANGLE: {"rad": 1.0, "deg": math.pi / 180.0},
    Dimension.FORCE: {"N": 1.0, "kN": 1e3, "MN": 1e6, "kip": 4448.2216152605},
    Dimension.STIFFNESS: {"N/m": 1.0, "kN/m": 1e3, "MN/m": 1e6},
    Dimension.DAMPING: {"N s/m": 1.0, "kN s/m": 1e3},
    Dimension.TIME: {"s": 1.0, "ms": 0.001},
    Dimension.FREQUENCY: {"Hz": 1.0},
    Dimension.ANGULAR_FREQUENCY: {"rad/s": 1.0},
    Dimension.NUMBER: {"%": 0.01},
}
"""SI values of the units that most cases are written in, as pint has them. To start pint takes
longer than to run such a case; whatever is not here, it reads."""
TOLD = (Dimension.FORCE, Dimension.LENGTH, Dimension.ACCELERATION)
"""What a case may choose a unit of, for design numbers: one of the usual."""


def quantity(value: object, dimension: Dimension) -> float:
    """Read a quantity as a case gives it.

    Parameters
    ----------
    value : object
        A number (SI), of NumPy too, or a string of a number and a unit.
    dimension : Dimension
        What is expected.

    Returns
    -------
    float
        The value in the SI unit of the dimension; finite.

    Raises
    ------
    InputError
        With what was found and what is accepted: not a number, not finite, an
        unknown or ambiguous unit, or a unit of another dimension.
    """
    if isinstance(value, bool) or not isinstance(value, Real | str):
        raise InputError(f"found {value!r}; accepted: {dimension.accepted}")
    try:
        result = _with_unit(value, dimension) if isinstance(value, str) else float(value)
    except OverflowError:
        result = math.inf
    if not math.isfinite(result):
        raise InputError(f"found {value!r}, not finite; accepted: {dimension.accepted}")
    return result


def any_quantity(value: object) -> tuple[float, Dimension | None]:
    """Read a quantity of whatever dimension its unit is of; None of one without a unit.

    Raises
    ------
    InputError
        As `quantity`.
    """
    match = _NUMBER.fullmatch(value) if isinstance(value, str) else None
    if match is None or not match[2]:
        return quantity(value, Dimension.NUMBER), None
    # Those first that have the unit in their list.
    for dimension in sorted(Dimension, key=lambda each: match[2] not in USUAL.get(each, {})):
        with suppress(InputError):
            return quantity(value, dimension), dimension
    raise InputError(f"found {value!r}; accepted: a number (SI), or a string with a unit of it")


_NUMBER = re.compile(
    r"\s*([-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d{1,3})?)\s*(.*?)\s*", re.DOTALL
)
# Names joined by space, *, · or /, each perhaps with a power: all that pint is asked to read.
_TERM = r"(?:1|[A-Za-zµμ°%]+(?:_[A-Za-z0]+)*(?:\s*(?:\^|\*\*)?\s*-?[1-9](?:\.5)?)?)"
_UNIT = re.compile(rf"{_TERM}(?:(?:\s*[*·/]\s*|\s+){_TERM})*")
_HERTZ = re.compile(r"\b[kKmM]?(?:Hz|[Hh]ertz)\b")
_RADIANS = re.compile(r"\brad(?:ians?)?\b")
_SHORT_TON = re.compile(r"\btons?\b")
_GRAVITY = re.compile(r"\bg\b")
_GAL = re.compile(r"\b[gG]al\b")
_POWER = re.compile(r"(?<=[a-zA-Z])(-?\d)")


def _with_unit(text: str, dimension: Dimension) -> float:
    match = _NUMBER.fullmatch(text)
    if match is None:
        raise InputError(f"found {text!r}; accepted: {dimension.accepted}")
    number, unit = match.groups()
    if not unit:
        return float(number)
    # In decimal arithmetic "1.27 cm" is the double nearest to 0.0127, as 0.0127 is.
    return float(Decimal(number) * Decimal(repr(_factor(unit, dimension, text))))


@cache
def _factor(unit: str, dimension: Dimension, found: str) -> float:
    """SI value of one `unit`; `found` is the whole string, for the message."""
    usual = USUAL.get(dimension, {}).get(unit)
    if usual is not None:
        return usual
    _refuse_ambiguous(unit, dimension, found)
    import pint

    normal = _POWER.sub(r"**\1", unit.replace("²", "^2").replace("·", "*"))
    if dimension is Dimension.ACCELERATION:
        # To pint a g is a gram and a gal a gallon.
        normal = _GAL.sub("galileo", _GRAVITY.sub("standard_gravity", normal))
    problem = f"unknown unit {unit!r}"
    if _UNIT.fullmatch(normal):
        try:
            return float(registry().Quantity(1.0, normal).to(dimension.unit).magnitude)
        except pint.DimensionalityError:
            problem = f"{unit!r} is no unit of {dimension.value[0]}" + _of_force(normal, dimension)
        except pint.PintError:
            pass
    raise InputError(f"found {found!r}: {problem}; accepted: {dimension.accepted}")


def _of_force(unit: str, dimension: Dimension) -> str:
    """What to write where a mass stands in the place of a force; empty elsewhere."""
    found, gravity, wanted = (
        registry().Quantity(1.0, word).dimensionality
        for word in (unit, "standard_gravity", dimension.unit)
    )
    if found * gravity != wanted:
        return ""
    return ", it has a mass for a force: write kN, or tf (the weight of 1 t, 9.80665 kN) or kgf"


def _refuse_ambiguous(unit: str, dimension: Dimension, found: str) -> None:
    """Stop at units that a careful reader could understand in two ways."""
    if _HERTZ.search(unit) and dimension in (Dimension.ANGULAR_FREQUENCY, Dimension.RATE):
        raise InputError(
            f"found {found!r}: Hz counts cycles, an angular frequency radians; write it in "
            "rad/s (2 pi times the Hz), or give the period in s"
        )
    if _RADIANS.search(unit) and dimension is Dimension.FREQUENCY:
        raise InputError(
            f"found {found!r}: rad/s is an angular frequency; write it in Hz (the rad/s over 2 pi)"
        )
    if _GRAVITY.search(unit) and dimension is not Dimension.ACCELERATION:
        raise InputError(
            f"found {found!r}: 'g' is understood as standard gravity, and only where an "
            f"acceleration is expected; accepted: {dimension.accepted}"
        )
    if _SHORT_TON.search(unit):
        raise InputError(
            f"found {found!r}: 'ton' may be 907, 1000 or 1016 kg; write 't' for 1000 kg; "
            f"accepted: {dimension.accepted}"
        )


@cache
def registry() -> UnitRegistry[float]:
    """The unit registry, built (and pint imported) when the first unit is met."""
    import pint

    return pint.UnitRegistry()
