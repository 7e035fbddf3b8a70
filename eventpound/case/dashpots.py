"""Dashpots of a case: coefficients, damping ratios and Rayleigh damping.

A ratio of a dashpot between a body of mass m and the ground is of the critical
damping 2 sqrt(k m), with k the stiffnesses of the springs between the same
ends, or of 2 m omega.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from eventpound.case.frequency import agree, frequency_or_period
from eventpound.case.table import Table
from eventpound.errors import InputError
from eventpound.scene.body import Body
from eventpound.scene.damping import (
    initial_stiffness,
    post_yield_stiffness,
    ratio_coefficient,
    rayleigh_coefficients,
    rayleigh_dashpots,
    springs_of_group,
)
from eventpound.scene.dashpot import Dashpot
from eventpound.scene.grounded import ends_on_ground
from eventpound.scene.modes import modes_of
from eventpound.scene.scene import Scene
from eventpound.scene.spring import GROUND, Spring
from eventpound.units import Dimension, quantity

_STIFFNESSES = {
    "initial-stiffness": initial_stiffness,
    "post-yield-stiffness": post_yield_stiffness,
}
_REFERS_TO = (
    '"initial-stiffness", "post-yield-stiffness", or a frequency or period such as "6.3 rad/s"'
)


def read_dashpot(
    table: Table,
    masses: Mapping[str, float],
    springs: Iterable[Spring],
    supports: Sequence[str] = (),
) -> Dashpot:
    """A dashpot from its ``[[dashpot]]`` table.

    Parameters
    ----------
    table : Table
        With ``coefficient``, or ``ratio`` and what it refers to.
    masses : mapping of str to float
        Masses of the bodies (kg).
    springs : iterable of Spring
        Springs of the scene.
    supports : sequence of str
        Names of supports, which count as the ground.

    Returns
    -------
    Dashpot
        Its coefficient is NaN where it could not be read.
    """
    between = table.pair("between", 'two bodies, or a body and "ground"')
    coefficient = table.optional_quantity("coefficient", Dimension.DAMPING)
    if table.has("ratio"):
        mass = _held_mass(ends_on_ground(between, supports), masses)
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
    return [
        (table.where, quantity(table.data["ratio"], Dimension.NUMBER))
        for table in tables
        if "ratio" in table.data
    ]


def _held_mass(between: tuple[str, str], masses: Mapping[str, float]) -> float | None:
    """Mass (kg) of the one body that a dashpot joins to the ground, None between two bodies."""
    if GROUND not in between:
        return None
    return masses.get(between[1] if between[0] == GROUND else between[0], math.nan)


def _from_ratio(
    table: Table, between: tuple[str, str], mass: float | None, springs: Iterable[Spring]
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
    if refers_to is not None and refers_to not in list(_STIFFNESSES):
        try:
            return 2.0 * ratio * mass * frequency_or_period(refers_to)
        except InputError:
            table.reject("refers_to", _REFERS_TO)
            return math.nan
    stiffness = _referred_stiffness(table, refers_to, between, springs)
    return ratio_coefficient(ratio, stiffness, mass) if stiffness * mass >= 0.0 else math.nan


def _referred_stiffness(
    table: Table, refers_to: object, between: tuple[str, str], springs: Iterable[Spring]
) -> float:
    """Stiffness between two ends (N/m); without `refers_to`, where there is only one."""
    parallel = [spring for spring in springs if set(spring.between) == set(between)]
    if not parallel:
        table.reject("ratio", "coefficient; no spring has the same ends, refer to a frequency")
        return math.nan
    sums: dict[object, float] = {}
    for word, stiffness_of in _STIFFNESSES.items():
        values = [stiffness_of(spring.law) for spring in parallel]
        stiffnesses = [value for value in values if value is not None]
        if len(stiffnesses) < len(values):
            kinked = parallel[values.index(None)].name
            table.reject(
                "ratio", f"coefficient; spring '{kinked}' has a kink, refer to a frequency"
            )
            return math.nan
        sums[word] = sum(stiffnesses)
    if refers_to is None and not agree(*sums.values()):
        table.report_missing("refers_to", _REFERS_TO)
        return math.nan
    return sums[refers_to or "initial-stiffness"]


def read_rayleigh(
    tables: Sequence[Table],
    bodies: Sequence[Body],
    springs: Sequence[Spring],
    supports: Sequence[str] = (),
) -> tuple[tuple[Dashpot, ...], list[str]]:
    """Dashpots from the ``[[rayleigh]]`` tables.

    Parameters
    ----------
    tables : sequence of Table
        One a group of bodies.
    bodies, springs : sequence
        Those of the scene.
    supports : sequence of str
        Names of supports, which count as the ground.

    Returns
    -------
    tuple of Dashpot
        What the groups add to the scene.
    list of str
        Warnings.
    """
    taken: set[str] = set()
    standing = [
        replace(spring, between=ends_on_ground(spring.between, supports)) for spring in springs
    ]
    dashpots: list[Dashpot] = []
    warnings: list[str] = []
    for table in tables:
        group = _read_group(table, bodies, taken)
        a, b = _read_coefficients(table, group, standing)
        ground = _ground_of(table, supports)
        table.close()
        if math.isnan(a + b):
            continue
        dashpots += rayleigh_dashpots(group, springs, a, b, supports, ground)
        if b > 0.0:
            warnings += [
                f"{table.where}: spring '{spring.name}' has a kink and is given no damping"
                for spring in springs_of_group([body.name for body in group], standing)
                if initial_stiffness(spring.law) is None
            ]
    return tuple(dashpots), warnings


def _ground_of(table: Table, supports: Sequence[str]) -> str:
    """The end from which the mass part of a group acts: the ground, or the support it names."""
    if not table.has("support"):
        return GROUND
    name = table.text("support", "the name of a support")
    if name not in (GROUND, "", *supports):
        table.reject("support", f"one of {', '.join([GROUND, *supports])}")
    return name if name in supports else GROUND


def _read_group(table: Table, bodies: Sequence[Body], taken: set[str]) -> list[Body]:
    """Bodies of one group; their names are added to those taken."""
    by_name = {body.name: body for body in bodies}
    names = table.texts("bodies", "a list of names of bodies")
    for name in names:
        if name not in by_name:
            table.report("bodies", f"found {name!r}; accepted: some of {', '.join(by_name)}")
        elif name in taken:
            table.report("bodies", f"found {name!r} again; accepted: every body in one group only")
        taken.add(name)
    return [by_name[name] for name in names if name in by_name]


def _read_coefficients(
    table: Table, group: Sequence[Body], springs: Sequence[Spring]
) -> tuple[float, float]:
    """Coefficients a (1/s) and b (s) of one group; NaN where they could not be read."""
    a = table.optional_quantity("mass_coefficient", Dimension.RATE)
    b = table.optional_quantity("stiffness_coefficient", Dimension.TIME)
    for key, value in (("mass_coefficient", a), ("stiffness_coefficient", b)):
        if value is not None and value < 0.0:
            table.reject(key, "a coefficient that is not negative")
    if a is not None or b is not None:
        for key in ("ratio", *_TWO):
            if table.has(key):
                table.reject(key, f"ratio with one of {', '.join(_TWO)}, or the two coefficients")
        return a or 0.0, b or 0.0
    ratio = table.quantity("ratio", Dimension.NUMBER)
    table.require("ratio", not ratio < 0.0, "a ratio that is not negative")
    omegas = _read_two_frequencies(table, group, springs)
    return rayleigh_coefficients(ratio, *omegas)


_TWO = ("frequencies", "periods", "modes")
"""Where a ratio holds."""


def _read_two_frequencies(
    table: Table, group: Sequence[Body], springs: Sequence[Spring]
) -> tuple[float, float]:
    keys = [key for key in _TWO if table.has(key)]
    if len(keys) != 1:
        table.report(
            "frequencies",
            f"found {' and '.join(keys) or 'none'} of {', '.join(_TWO)}; "
            "accepted: one of them, a list of two",
        )
        return math.nan, math.nan
    (key,) = keys
    values = table.data[key]
    if not isinstance(values, list) or len(values) != 2:
        table.reject(key, f"a list of two {key}")
        return math.nan, math.nan
    if key == "modes":
        return _frequencies_of_modes(table, values, group, springs)
    dimension = Dimension.ANGULAR_FREQUENCY if key == "frequencies" else Dimension.TIME
    try:
        first, second = (quantity(value, dimension) for value in values)
    except InputError as error:
        table.report(key, str(error))
        return math.nan, math.nan
    if min(first, second) <= 0.0:
        table.reject(key, f"two positive {key}")
        return math.nan, math.nan
    if key == "frequencies":
        return first, second
    return 2.0 * math.pi / first, 2.0 * math.pi / second


def _frequencies_of_modes(
    table: Table, numbers: Sequence[object], group: Sequence[Body], springs: Sequence[Spring]
) -> tuple[float, float]:
    """Angular frequencies (rad/s) of two modes of a group at its initial stiffness."""
    chosen = [n for n in numbers if isinstance(n, int) and not isinstance(n, bool)]
    if len(chosen) < 2 or not 1 <= min(chosen) <= max(chosen) <= len(group):
        table.reject("modes", f"two numbers of modes, from 1 to {len(group)}")
        return math.nan, math.nan
    scene, names = Scene(tuple(group), tuple(springs)), [body.name for body in group]
    try:
        first, second = modes_of(scene, names).period[[n - 1 for n in chosen]].tolist()
    except InputError:
        # A mass or a stiffness is wrong, which is said where it stands.
        return math.nan, math.nan
    if not math.isfinite(max(first, second)):
        table.reject("modes", "modes that a spring resists")
        return math.nan, math.nan
    return 2.0 * math.pi / first, 2.0 * math.pi / second
