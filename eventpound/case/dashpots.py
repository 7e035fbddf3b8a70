"""Dashpots of a case: coefficients and damping ratios.

A ratio of a dashpot between a body of mass m and the ground is of the critical
damping 2 sqrt(k m), with k the stiffnesses at rest of the springs between the
same ends, or of 2 m omega.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from eventpound.case.elements import OF_LINK, ends_of
from eventpound.case.frequency import agree, frequency_or_period
from eventpound.case.spring_stiffness import held_mass
from eventpound.case.table import Table
from eventpound.errors import InputError
from eventpound.scene.at_rest import stiffness_of
from eventpound.scene.damping import ratio_coefficient
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.deck import Deck
from eventpound.scene.ends import End
from eventpound.scene.grounded import ends_on_ground
from eventpound.scene.spring import Spring
from eventpound.units import Dimension, quantity

_YIELDED = {"initial-stiffness": False, "post-yield-stiffness": True}
_REFERS_TO = (
    '"initial-stiffness", "post-yield-stiffness", or a frequency or period such as "6.3 rad/s"'
)


def read_dashpot(
    table: Table,
    masses: Mapping[str, float],
    springs: Iterable[Spring],
    supports: Sequence[str] = (),
    decks: Sequence[Deck] = (),
) -> Dashpot:
    """A dashpot from its ``[[dashpot]]`` table.

    Parameters
    ----------
    table : Table
        With ``coefficient``, or ``ratio`` and what it refers to.
    masses : mapping of str to float
        Masses of the bodies (kg).
    springs : iterable of Spring
        Springs of the scene at rest.
    supports : sequence of str
        Names of supports, which count as the ground.
    decks : sequence of Deck
        Whose places may be ends.

    Returns
    -------
    Dashpot
        Its coefficient is NaN where it could not be read.
    """
    between = ends_of(table, OF_LINK, {deck.name: deck for deck in decks})
    coefficient = table.optional_quantity("coefficient", Dimension.DAMPING)
    if table.has("ratio"):
        mass = held_mass(ends_on_ground(between, supports), masses)
        from_ratio = _from_ratio(table, between, mass, springs)
        if coefficient is None:
            coefficient = from_ratio
        elif not agree(coefficient, from_ratio):
            table.reject(
                "coefficient",
                f"one of coefficient and ratio; the ratio says {from_ratio:.10g} N s/m",
            )
    elif table.has("refers_to"):
        table.report("ratio", "missing; refers_to says what a ratio refers to")
    if coefficient is None:
        table.report_missing("coefficient", f"{Dimension.DAMPING.accepted}; or ratio, refers_to")
        coefficient = math.nan
    table.close()
    return Dashpot(between, coefficient)


def given_ratios(tables: Iterable[Table]) -> list[tuple[str, float]]:
    """Damping ratios of tables without problems, each with what messages call its table."""
    found = [(table.where, table.data["ratio"]) for table in tables if "ratio" in table.data]
    return [
        (where, quantity(ratio, Dimension.NUMBER))
        for where, given in found
        for ratio in (given if isinstance(given, list) else [given])
    ]


def _from_ratio(
    table: Table, between: tuple[End, End], mass: float | None, springs: Iterable[Spring]
) -> float:
    """Coefficient for the ratio of a table (N s/m); NaN with a problem noted where undefined.

    `mass` (kg): of the one body, which the ground holds at the other end.
    """
    ratio = table.quantity("ratio", Dimension.NUMBER)
    table.require("ratio", not ratio < 0.0, "a ratio that is not negative")
    refers_to = table.data["refers_to"] if table.has("refers_to") else None
    if mass is None:
        table.reject(
            "ratio", "coefficient; a ratio is defined for a dashpot to the ground only (one mass)"
        )
        return math.nan
    if refers_to is not None and refers_to not in list(_YIELDED):
        try:
            return 2.0 * ratio * mass * frequency_or_period(refers_to)
        except InputError:
            table.reject("refers_to", _REFERS_TO)
            return math.nan
    stiffness = _referred_stiffness(table, refers_to, between, springs)
    return ratio_coefficient(ratio, stiffness, mass) if stiffness * mass >= 0.0 else math.nan


def _referred_stiffness(
    table: Table, refers_to: object, between: tuple[End, End], springs: Iterable[Spring]
) -> float:
    """Stiffness between two ends (N/m); without `refers_to`, where there is only one."""
    parallel = [spring for spring in springs if set(spring.sides) == set(between)]
    if not parallel:
        table.reject("ratio", "coefficient; no spring has the same ends, refer to a frequency")
        return math.nan
    sums = {
        word: sum(stiffness_of(spring, yielded) for spring in parallel)
        for word, yielded in _YIELDED.items()
    }
    if math.isnan(sums["initial-stiffness"]):
        return math.nan
    if not sums["initial-stiffness"] > 0.0:
        idle = f"spring '{parallel[0].name}' does not resist at rest"
        table.reject("ratio", f"coefficient; {idle}, refer to a frequency")
        return math.nan
    if refers_to is None and not agree(*sums.values()):
        table.report_missing("refers_to", _REFERS_TO)
        return math.nan
    found = sums[str(refers_to or "initial-stiffness")]
    if found < 0.0:
        table.reject("refers_to", "initial-stiffness, or a frequency: after yield P-Delta is more")
        return math.nan
    return found
