"""Numbers as engineers write them: kN, mm, g, per cent, with three digits."""

from __future__ import annotations

import math
from dataclasses import dataclass

from eventpound.quantities.lookup import is_whole
from eventpound.results.input_tables import HEAVY
from eventpound.scene.scene import Scene
from eventpound.units import STANDARD_GRAVITY, Dimension

_DIGITS = 3
_NOTHING = 1e-6
"""What rounding leaves of nothing, in a unit of the trade."""
Unit = tuple[str, float]
"""Its name and its size (SI)."""
_LIGHT: dict[str, Unit] = {
    Dimension.LENGTH.unit: ("mm", 1e-3),
    Dimension.ACCELERATION.unit: ("g", STANDARD_GRAVITY),
}
_HEAVY = _LIGHT | {
    Dimension.FORCE.unit: ("kN", 1e3),
    Dimension.IMPULSE.unit: ("kN s", 1e3),
    Dimension.ENERGY.unit: ("kJ", 1e3),
    Dimension.MASS.unit: ("t", 1e3),
}


@dataclass(frozen=True, slots=True)
class Trade:
    """Units in which numbers of a scene are told; kN of one that is heavy, else N."""

    heavy: bool = True

    def unit(self, unit: str, name: str = "") -> Unit:
        """What stands for a unit of SI, for a quantity of a name: a drift ratio is in per cent."""
        if name.endswith("drift_ratio"):
            return "%", 0.01
        return (_HEAVY if self.heavy else _LIGHT).get(unit, (unit, 1.0))

    def number(self, value: float, unit: str, name: str = "") -> str:
        """A value (SI) in the unit of the trade, without its name."""
        shown = value / self.unit(unit, name)[1]
        return f"{shown:.{_DIGITS}g}" if _is_count(name, shown) else three_digits(shown)

    def words(self, value: float, unit: str, name: str = "") -> str:
        """A value (SI) with its unit of the trade."""
        return f"{self.number(value, unit, name)} {self.unit(unit, name)[0]}".rstrip()


def _is_count(name: str, value: float) -> bool:
    """Whether a value is of a quantity that is counted, and has no more than three digits."""
    return is_whole(name) and 0.0 <= value < 10**_DIGITS - 1


def trade_of(scene: Scene) -> Trade:
    """Units in which numbers of a scene are told."""
    return Trade(max((body.mass for body in scene.bodies), default=0.0) >= HEAVY)


def three_digits(value: float) -> str:
    """A number with three digits and no exponent; a dash where there is none."""
    if not math.isfinite(value):
        return "–"
    if abs(value) < _NOTHING:
        return "0"
    places = _DIGITS - 1 - math.floor(math.log10(abs(value)))
    # What rounds up to the next power of ten has one place less.
    rounded = round(value, places)
    places -= math.floor(math.log10(abs(rounded))) > math.floor(math.log10(abs(value)))
    return f"{rounded:.{max(places, 0)}f}"
