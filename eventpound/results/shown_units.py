"""Units in which numbers are shown, and how many digits: the one place that chooses them.

Tables and pages are in the units of the trade, kN, mm, g and per cent, or in those that a case
chooses, with three digits. Figures are in those of the largest number that they show.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from eventpound.case.run_options import Stated
from eventpound.quantities.lookup import is_whole
from eventpound.scene.scene import Scene
from eventpound.units import STANDARD_GRAVITY, TOLD, USUAL, Dimension

HEAVY = 1e4
"""Mass (kg) from which on tables and axes are in t, tables in kN and mm."""
_DIGITS = 3
_NOTHING = 1e-6
"""What rounding leaves of nothing, in a unit of the trade that nobody chose."""
_BUILT = (".separation_needed", ".avoiding_gap", ".avoiding_gap_alone")
"""Ends of names of gaps that are to be built: told too wide, if anything."""


class Unit(NamedTuple):
    """Its name as printed and its size (SI)."""

    name: str
    size: float

    def of(self, value: float) -> str:
        """A value (SI) in it, with its name."""
        return f"{value / self.size:.4g} {self.name}".rstrip()


PERCENT, GRAVITY = Unit("%", 0.01), Unit("g", STANDARD_GRAVITY)
_BY_SIZE = {
    Dimension.LENGTH: ((1.0, Unit("m", 1.0)), (5e-3, Unit("cm", 1e-2)), (0.0, Unit("mm", 1e-3))),
    Dimension.STIFFNESS: ((1e6, Unit("MN/m", 1e6)),),
    Dimension.MASS: ((HEAVY, Unit("t", 1e3)),),
}
"""Units by the least of what they are read for (SI)."""


def unit_by_size(dimension: Dimension, largest: float) -> Unit:
    """Unit in which numbers are read most easily, by the largest of them (SI)."""
    for least, unit in _BY_SIZE.get(dimension, ()):
        if abs(largest) >= least:
            return unit
    if dimension.unit.startswith(("N", "J")) and abs(largest) >= 1e3:
        return Unit("k" + dimension.unit, 1e3)
    return Unit(dimension.unit.replace("^2", "²"), 1.0)


@dataclass(frozen=True, slots=True)
class Units:
    """Units in which numbers of a scene are told.

    Parameters
    ----------
    heavy : bool
        Whether the scene is: in kN and t, else in N and kg; mm and g.
    chosen : tuple of str
        Units of `eventpound.units.TOLD` instead. Impulse and energy follow the force.
    """

    heavy: bool = True
    chosen: tuple[str, ...] = ()

    def unit(self, unit: str, name: str = "") -> Unit:
        """What stands for a unit of SI, for a quantity of a name: a drift ratio is in per cent."""
        if name.endswith("drift_ratio"):
            return PERCENT
        usual = ("kN" if self.heavy else "N", "mm", "g")
        force, length, acceleration = (
            next((word for word in self.chosen if word in USUAL[dimension]), word)
            for dimension, word in zip(TOLD, usual, strict=True)
        )
        size, inch = USUAL[Dimension.FORCE][force], USUAL[Dimension.LENGTH]["in"]
        energy = ("kip in", size * inch) if force == "kip" else (force.replace("N", "J"), size)
        told = {
            Dimension.FORCE: (force, size),
            Dimension.IMPULSE: (f"{force} s", size),
            Dimension.STIFFNESS: (f"{force}/m", size),
            Dimension.DAMPING: (f"{force} s/m", size),
            Dimension.ENERGY: energy,
            Dimension.LENGTH: (length, USUAL[Dimension.LENGTH][length]),
            Dimension.ACCELERATION: (
                acceleration.replace("^2", "²"),
                USUAL[Dimension.ACCELERATION][acceleration],
            ),
            Dimension.MASS: ("t", 1e3) if self.heavy else ("kg", 1.0),
        }
        return Unit(*{of.unit: each for of, each in told.items()}.get(unit, (unit, 1.0)))

    def of_row(self, row: Any) -> Unit:
        """What stands for the unit of a row of design numbers."""
        return self.unit(str(row["unit"]), str(row["quantity"]))

    def number(self, value: float, unit: str, name: str = "") -> str:
        """A value (SI) in the unit of the trade, without its name."""
        size = self.unit(unit, name).size
        if _is_count(name, value / size):
            return f"{value / size:.{_DIGITS}g}"
        up = name.endswith(_BUILT)
        return three_digits(value / size, self.nothing(unit, name), math.ceil if up else round)

    def nothing(self, unit: str, name: str = "") -> float:
        """What rounding leaves of nothing, in the unit that is told; the same whatever that is."""
        return _NOTHING * Units(self.heavy).unit(unit, name).size / self.unit(unit, name).size

    def words(self, value: float, unit: str, name: str = "") -> str:
        """A value (SI) with its unit of the trade."""
        return f"{self.number(value, unit, name)} {self.unit(unit, name).name}".rstrip()


def _is_count(name: str, value: float) -> bool:
    """Whether a value is of a quantity that is counted, and has no more than three digits."""
    return is_whole(name) and 0.0 <= value < 10**_DIGITS - 1


def units_of_scene(scene: Scene, stated: Stated) -> Units:
    """Units in which numbers of a scene are told, as its case chooses."""
    heaviest = max((body.mass for body in scene.bodies), default=0.0)
    return Units(heaviest >= HEAVY, stated.units)


def three_digits(
    value: float, nothing: float = _NOTHING, whole: Callable[[float], int] = round
) -> str:
    """A number with three digits and no exponent; a dash where there is none.

    What is smaller than `nothing` is zero. `whole` makes a whole number of all digits.
    """
    if not math.isfinite(value):
        return "–"
    if abs(value) < nothing:
        return "0"
    places = _DIGITS - 1 - math.floor(math.log10(abs(value)))
    rounded = whole(value * 10.0**places) / 10.0**places
    # What rounds up to the next power of ten has one place less.
    places -= math.floor(math.log10(abs(rounded))) > math.floor(math.log10(abs(value)))
    return f"{rounded:.{max(places, 0)}f}"
