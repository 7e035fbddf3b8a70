"""Stiffnesses of a spring, given as such or by a frequency or a period of a mass.

k = m omega^2 = m (2 pi / T)^2. The mass is that of the body, for a spring between a
body and the ground, unless ``of_mass`` says another: what the spring carries in truth.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from eventpound.case.frequency import agree, optional_omega, optional_period
from eventpound.case.table import Table
from eventpound.case.written_out import weight_share
from eventpound.scene.ends import End
from eventpound.scene.grounded import ends_on_ground
from eventpound.scene.spring import GROUND, Spring
from eventpound.units import STANDARD_GRAVITY, Dimension

OF_MASS = "of_mass"
_FREQUENCY = "frequency"
_MASS = 'a positive mass (kg, or a string like "1250 t"), or a list of different bodies'
_UNDEFINED = (
    "stiffness, or of_mass beside it; between two bodies a frequency or period has no mass "
    "of its own"
)


class Stiffnesses:
    """Reads the stiffnesses of one ``[[spring]]``; problems are noted.

    Parameters
    ----------
    table : Table
        The spring.
    between : tuple of str
        Its ends.
    masses : mapping of str to float
        Masses of the bodies (kg).
    """

    def __init__(self, table: Table, between: tuple[End, End], masses: Mapping[str, float]) -> None:
        self._table = table
        self._mass = _swinging(table, between, masses)
        self._used = False

    def read(self, key: str, ways: Sequence[str]) -> float | None:
        """Stiffness by its own key or by what may stand for it.

        Parameters
        ----------
        key : str
            ``"stiffness"`` or ``"initial_stiffness"``.
        ways : sequence of str
            ``"frequency"``, or names of periods.

        Returns
        -------
        float or None
            k (N/m); None where it is not given, NaN where it is wrong.
        """
        given: dict[str, float] = {}
        stiffness = self._table.optional_quantity(key, Dimension.STIFFNESS)
        if stiffness is not None:
            given[key] = stiffness
        for word in ways:
            omega = self._omega(word)
            if omega is not None:
                given[word] = self._of(word, omega)
        if not given:
            return None
        first, *others = given
        for word in others:
            if not agree(given[first], given[word]):
                self._table.reject(
                    first, f"one of {first} and {word}; {word} says {given[word]:.10g} N/m"
                )
        return given[first]

    def force(self, key: str) -> float | None:
        """A force (N), perhaps as a part of the weight of the mass, ``"0.15 W"``."""
        share = weight_share(self._table.data.get(key))
        if share is None:
            return self._table.optional_quantity(key, Dimension.FORCE)
        self._table.has(key)
        self._used = True
        if self._mass is None:
            self._table.reject(key, "a force, or of_mass beside it, whose weight W is")
            return math.nan
        return share * self._mass * STANDARD_GRAVITY

    def close(self) -> None:
        """Note a mass that nothing refers to, where what refers to it was not refused."""
        if self._table.has(OF_MASS) and not (self._used or self._table.has("period")):
            self._table.reject(
                OF_MASS, 'it beside a frequency, a period or a force like "0.15 W", which it is of'
            )

    def _omega(self, word: str) -> float | None:
        if word == _FREQUENCY:
            return optional_omega(self._table, word)
        period = optional_period(self._table, word)
        return None if period is None else 2.0 * math.pi / period

    def _of(self, word: str, omega: float) -> float:
        self._used = True
        if self._mass is None:
            self._table.reject(word, _UNDEFINED)
            return math.nan
        return self._mass * omega * omega


def masses_carried(
    tables: Sequence[Table],
    springs: Sequence[Spring],
    masses: Mapping[str, float],
    supports: Sequence[str] = (),
) -> dict[str, float]:
    """Masses (kg) that swing on springs, by their names, where there is one of a spring.

    Parameters
    ----------
    tables : sequence of Table
        Of the springs, without problems.
    springs : sequence of Spring
        What was read of them.
    masses : mapping of str to float
        Masses of the bodies (kg).
    supports : sequence of str
        Names of supports, which count as the ground.
    """
    found: dict[str, float] = {}
    for table, spring in zip(tables, springs, strict=True):
        between = ends_on_ground(spring.between, supports)
        mass = _swinging(Table(table.data, "", []), between, masses)
        if mass is not None:
            found[spring.name] = mass
    return found


def _swinging(table: Table, between: tuple[End, End], masses: Mapping[str, float]) -> float | None:
    """The mass that a frequency or period is one of (kg); None where there is none."""
    named = _named_mass(table, masses)
    return held_mass(between, masses) if named is None else named


def held_mass(between: tuple[End, End], masses: Mapping[str, float]) -> float | None:
    """Mass (kg) of the one body that something joins to the ground, None between others."""
    if GROUND not in between:
        return None
    end = between[1] if between[0] == GROUND else between[0]
    return masses.get(end, math.nan) if isinstance(end, str) else None


def _named_mass(table: Table, masses: Mapping[str, float]) -> float | None:
    """The mass that ``of_mass`` gives (kg); None without it, NaN where it is wrong."""
    if not table.has(OF_MASS):
        return None
    value = table.data[OF_MASS]
    if not isinstance(value, list):
        mass = table.quantity(OF_MASS, Dimension.MASS)
        table.require(OF_MASS, not mass <= 0.0, _MASS)
        return mass if mass > 0.0 else math.nan
    known = [name for name in value if isinstance(name, str) and name in masses]
    if not value or len(known) < len(value) or len(set(known)) < len(known):
        table.reject(OF_MASS, f"{_MASS}, of {', '.join([*masses][:8])}")
        return math.nan
    return sum(masses[name] for name in known)
