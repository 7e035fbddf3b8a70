"""Springs of a case, in every way a law may be given.

A stiffness may be given as an angular frequency or a period of a mass: k = m omega^2.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from typing import Any, get_args

from eventpound.case.elements import OF_LINK, ends_of, read_names
from eventpound.case.spring_stiffness import Stiffnesses
from eventpound.case.table import Table, read_numbers
from eventpound.errors import InputError
from eventpound.scene.bouc_wen_parameters import OF_LAW, Parameter, bouc_wen_parameters
from eventpound.scene.deck import Deck
from eventpound.scene.ends import End
from eventpound.scene.grounded import ends_on_ground
from eventpound.scene.spring import (
    Backfill,
    BilinearElastic,
    BoucWen,
    DegradingBoucWen,
    Law,
    LawName,
    Linear,
    Series,
    Slider,
    Spring,
)
from eventpound.scene.wall import soil_behind
from eventpound.units import Dimension

_DIMENSIONS = {
    Parameter.YIELD_DISPLACEMENT: Dimension.LENGTH,
    Parameter.HARDENING: Dimension.NUMBER,
}
_LAWS = tuple(name.value for name in LawName)
_BY_FIELDS: dict[str, Any] = {law.word.value: law for law in get_args(Law)}
"""Laws by their words. The keys of those that nothing more is said of are their fields."""
_WALL = "height", "width"
_SOIL = "initial_stiffness", "ultimate_force", "failure_ratio"
_UNREAD = Linear(math.nan)
_TWO_PERIODS = (
    "says not which of the two periods of a bouc-wen spring; write initial_period (at its initial "
    "stiffness) or post_yield_period (after yield, as period was understood), and of_mass "
    "beside it where the spring carries more than its body"
)


def _answers(words: Mapping[str, str]) -> dict[str, str]:
    """Answers to what others call a law, by each word of a list in small letters."""
    return {word: f", {answer}" for names, answer in words.items() for word in names.split()}


_STOPS = {
    "gap gapelement stop stopper bumper buffer compressiononly": "which is 'bilinear-elastic' with "
    "extension = 0, compression = ... and offset = minus the gap, or a [[contact]]",
    "hook hookelement cable rope tie restrainer tensiononly": "which is 'bilinear-elastic' with "
    "compression = 0, extension = ... and offset = the slack",
}
_YIELDING = (
    "bilinear bilinearhysteretic elastoplastic elasticplastic hysteretic plastic "
    "leadrubber leadrubberbearing lrb"
)
_SLIDING = "coulomb friction coulombfriction dryfriction sliding frictiondamper flatslider"
_PENDULUM = "frictionpendulum frictionpendulumbearing pendulum fps fp"
_CALLED = _answers(
    _STOPS
    | {
        _YIELDING: "a spring that yields: it is 'bouc-wen' with exponent = 20 (hardening = 0 where "
        "it is elastoplastic), and 'bilinear-elastic' one with a kink that does not yield",
        _SLIDING: "which is 'slider' with friction and normal_force",
        _PENDULUM: "which is 'slider' with friction, normal_force and radius",
        "elastic spring hooke": "which is 'linear' with stiffness",
        "viscous dashpot damper": "which is a [[dashpot]]",
        "pounding impact hertz kelvinvoigt newton": "which is a [[contact]]",
        "soil hyperbolic abutment": "which is 'backfill'",
    }
)
"""Answers to what others call a law that `_LAWS` calls otherwise."""
_CALLED_IN_SERIES = _answers(
    _STOPS | {f"{_YIELDING} {_SLIDING} {_PENDULUM}": "but no part of a series yields or slides"}
)


def read_springs(
    tables: Sequence[Table],
    masses: Mapping[str, float],
    supports: Sequence[str] = (),
    decks: Sequence[Deck] = (),
) -> tuple[Spring, ...]:
    """Springs from the ``[[spring]]`` tables.

    Parameters
    ----------
    tables : sequence of Table
        In the order of the case.
    masses : mapping of str to float
        Masses of the bodies (kg), for stiffnesses given as frequencies.
    supports : sequence of str
        Names of supports, which count as the ground.
    decks : sequence of Deck
        Whose places may be ends.

    Returns
    -------
    tuple of Spring
        One a table; those without a name are named after their ends.
    """
    known = {deck.name: deck for deck in decks}
    ends = [ends_of(table, OF_LINK, known) for table in tables]
    names = read_names(tables, ends)
    return tuple(
        _read_spring(table, name, between, masses, supports)
        for table, name, between in zip(tables, names, ends, strict=True)
    )


def _read_spring(
    table: Table,
    name: str,
    between: tuple[End, End],
    masses: Mapping[str, float],
    supports: Sequence[str],
) -> Spring:
    height = table.optional_quantity("height", Dimension.LENGTH)
    stiffnesses = Stiffnesses(table, ends_on_ground(between, supports), masses)
    weight = stiffnesses.force("weight")
    if weight is not None and height is None:
        table.report_missing("height", "the height of the storey (m), beside its weight")
    frame = table.text("frame", "the name of a frame") if table.has("frame") else None
    law = _read_law(table, stiffnesses)
    stiffnesses.close()
    return Spring(name, between, law, height, weight, frame)


def _read_law(table: Table, stiffnesses: Stiffnesses) -> Law:
    law: Law
    match table.choice("law", _LAWS, _CALLED):
        case "linear":
            law = _read_linear(table, stiffnesses)
        case "bouc-wen":
            law = _read_bouc_wen(table, stiffnesses)
        case "degrading-bouc-wen":
            own = asdict(_read_bouc_wen(table, stiffnesses))
            law = DegradingBoucWen(**own, **read_numbers(table, DegradingBoucWen, *own))
        case "backfill":
            law = _read_backfill(table)
        case "slider":
            law = _read_slider(table, stiffnesses)
        case "series":
            law = _read_series(table)
        case "":
            return _UNREAD
        case word:
            law = _BY_FIELDS[word](**read_numbers(table, _BY_FIELDS[word]))
    table.close()
    return law


def _read_linear(table: Table, stiffnesses: Stiffnesses) -> Linear:
    stiffness = stiffnesses.read("stiffness", ("frequency", "period"))
    if stiffness is None:
        table.report_missing("stiffness", Dimension.STIFFNESS.accepted)
        return _UNREAD
    return Linear(stiffness)


def _read_backfill(table: Table) -> Backfill:
    wall = {key: table.optional_quantity(f"wall_{key}", Dimension.LENGTH) for key in _WALL}
    if all(value is None for value in wall.values()):
        return Backfill(**read_numbers(table, Backfill))
    return Backfill(*_soil_behind(table, wall), **read_numbers(table, Backfill, *_SOIL))


def _soil_behind(table: Table, wall: Mapping[str, float | None]) -> Sequence[float]:
    """Numbers of soil that stand by the size of its wall, and by it alone."""
    for key in filter(table.has, _SOIL):
        table.report(key, "found beside the size of a wall, which says it; accepted: one of both")
    for key in (key for key, value in wall.items() if value is None):
        table.report_missing(f"wall_{key}", Dimension.LENGTH.accepted)
    size = {key: value for key, value in wall.items() if value is not None}
    if len(size) == len(wall) and not any(map(math.isnan, size.values())):
        try:
            return soil_behind(**size)
        except InputError as error:
            for problem in error.problems:
                table.report(f"wall_{problem.partition(': ')[0]}", problem.partition(": ")[2])
    return [math.nan] * len(_SOIL)


def _read_slider(table: Table, stiffnesses: Stiffnesses) -> Slider:
    force = stiffnesses.force("normal_force")
    if force is None:
        table.report_missing("normal_force", Dimension.FORCE.accepted)
    law = Slider(
        normal_force=math.nan if force is None else force,
        **read_numbers(table, Slider, "normal_force"),
    )
    radius = table.optional_quantity("radius", Dimension.LENGTH)
    if radius is None:
        return law
    if table.has("stiffness"):
        table.report("radius", "found beside stiffness; accepted: one of stiffness, radius")
    elif not radius > 0.0 and not math.isnan(radius):
        table.report("radius", f"found {table.data['radius']!r}; accepted: a positive length (m)")
    return replace(law, stiffness=law.normal_force / radius if radius > 0.0 else math.nan)


def _read_series(table: Table) -> Series:
    parts: list[Linear | BilinearElastic] = []
    if not table.has("parts"):
        table.report_missing("parts", "a list of tables, parts = [{ law = ... }, ...]")
        return Series((_UNREAD,))
    for part in table.tables("parts"):
        match part.choice("law", ("linear", "bilinear-elastic"), _CALLED_IN_SERIES):
            case "linear":
                parts.append(Linear(**read_numbers(part, Linear)))
            case "bilinear-elastic":
                parts.append(BilinearElastic(**read_numbers(part, BilinearElastic)))
            case _:
                continue
        part.close()
    return Series(tuple(parts))


def _read_bouc_wen(table: Table, stiffnesses: Stiffnesses) -> BoucWen:
    values = {p: table.optional_quantity(p.value, d) for p, d in _DIMENSIONS.items()}
    values |= _of_a_mass(table, stiffnesses)
    given = {p: v for p in Parameter if (v := values[p]) is not None}
    own = [math.nan] * len(OF_LAW)
    if not any(math.isnan(value) for value in given.values()):
        try:
            found = bouc_wen_parameters(given)
            own = [found[p] for p in OF_LAW]
        except InputError as error:
            for problem in error.problems:
                table.blame(table.report("", problem), [p for p in Parameter if p not in given])
    return BoucWen(*own, **read_numbers(table, BoucWen, *Parameter))


def _of_a_mass(table: Table, stiffnesses: Stiffnesses) -> dict[Parameter, float | None]:
    """Stiffnesses and forces of a hysteretic spring, where they are given."""
    found = {
        Parameter.INITIAL_STIFFNESS: stiffnesses.read("initial_stiffness", ("initial_period",)),
        Parameter.STIFFNESS: stiffnesses.read("stiffness", ("frequency", "post_yield_period")),
        Parameter.STRENGTH: stiffnesses.force("strength"),
        Parameter.YIELD_FORCE: stiffnesses.force("yield_force"),
    }
    if table.has("period"):
        # One message: what the others lack without it follows from it.
        table.report("period", f"found {table.data['period']!r}, which {_TWO_PERIODS}")
        found[Parameter.STIFFNESS] = math.nan
    return found
