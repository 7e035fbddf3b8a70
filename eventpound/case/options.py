"""The tables ``[run]`` and ``[solver]`` of a case."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence

from eventpound.basics.given import number
from eventpound.case.case import (
    DEFAULTS,
    LARGEST_RTOL,
    SMALLEST_RTOL,
    RunOptions,
    SolverOptions,
    Stated,
)
from eventpound.case.defaults import default_duration, default_output_step
from eventpound.case.table import Table
from eventpound.motion.base import LARGEST, SMALLEST
from eventpound.scene.contact_law import Element
from eventpound.scene.scene import Scene
from eventpound.scene.spring import LawName
from eventpound.units import TOLD, USUAL, Dimension

REFERENCE, FAST = "cvode", "fast"
"""The solver of one run, and that of many, where none is named."""
LISTED = {"slip": LawName.SLIDER, "soil": LawName.BACKFILL}
"""Words of ``events``, each with the law of the springs whose events it lists."""
OWN_SOLVERS = (REFERENCE, "ida", FAST, "moreau", "penalty")
"""Solvers that need no other package, by their names."""
INITIAL, EQUILIBRIUM = "initial", "equilibrium"
"""Words of ``start``."""
MOST_ROWS = 10_000_000
"""Rows of a history at equal steps; more is a slip of the unit."""

_ATOL = {
    "displacement": Dimension.LENGTH,
    "velocity": Dimension.VELOCITY,
    "z": Dimension.NUMBER,
}
_EVENTS = f"a list of {' and '.join(map(repr, LISTED))}, each at most once"
# Solvers' own keys that have a dimension; any other is taken as it is.
_SETTINGS = {"time_step": Dimension.TIME, "contact_stiffness": Dimension.STIFFNESS}
HERTZIAN = tuple(element.word for element in Element if element.hertzian)
"""Values of ``contact`` with which ``contact_stiffness`` is that of a force k δ^1.5."""


def to_be_placed(run: object) -> bool:
    """Whether ``[run]``, as it is written, asks for an equilibrium."""
    return isinstance(run, dict) and run.get("start") == EQUILIBRIUM


def read_run(table: Table, scene: Scene | None, suite: bool = False) -> RunOptions | None:
    """Read ``[run]``.

    Parameters
    ----------
    table : Table
        May be empty.
    scene : Scene or None
        What the defaults follow from; None where it has problems.
    suite : bool
        Whether each record of a suite sets its own defaults; they are NaN then.

    Returns
    -------
    RunOptions or None
        None where there are problems; they are noted.
    """
    start_time = table.quantity("start_time", Dimension.TIME, 0.0)
    positive = "a positive time (s)"
    duration = table.optional_quantity("duration", Dimension.TIME, positive)
    output_step = table.optional_quantity("output_step", Dimension.TIME, positive)
    energy, balanced = table.flag("energy"), to_be_placed(table.data)
    errors = table.flag("error_estimate") if table.has("error_estimate") else None
    stated = _read_stated(table, scene)
    if suite and not math.isnan(start_time):
        table.close()
        length, step = (math.nan if x is None else x for x in (duration, output_step))
        return RunOptions(start_time, length, step, energy, errors, stated, balanced)
    if duration is None and scene is not None and not math.isnan(start_time):
        with table.noting(""):
            duration = default_duration(scene, start_time)
    table.close()
    if scene is None or duration is None or not duration > 0.0:
        return None
    if output_step is None:
        output_step = default_output_step(scene.motion, duration)
    elif not output_step > 0.0:
        return None
    for key, problem in run_problems(start_time, duration, output_step):
        table.report(key, problem)
    return RunOptions(start_time, duration, output_step, energy, errors, stated, balanced)


def run_problems(
    start_time: float, duration: float, output_step: float
) -> Iterator[tuple[str, str]]:
    """Keys of ``[run]`` whose positive times (s) cannot be run, with what is wrong."""
    if not (SMALLEST <= duration <= LARGEST and start_time < start_time + duration):
        yield (
            "duration",
            f"found {duration!r} s from {start_time!r} s on; accepted: {SMALLEST:g} to "
            f"{LARGEST:g} s, and not lost in the rounding of the start time",
        )
    elif duration / output_step > MOST_ROWS:
        yield (
            "output_step",
            f"found {output_step!r} s, which makes {duration / output_step:.3g} rows of "
            f"{duration:.6g} s; accepted: at most {MOST_ROWS} rows",
        )


def _read_stated(table: Table, scene: Scene | None) -> Stated:
    """What is said of quantities."""
    speed = table.quantity("threshold_speed", Dimension.VELOCITY, DEFAULTS.threshold_speed)
    table.require("threshold_speed", not speed < 0.0, "a speed (m/s), not negative")
    positive = "a positive stiffness (N/m)"
    stiffness = table.optional_quantity("contact_stiffness", Dimension.STIFFNESS, positive)
    given = table.texts("quantities", "a list of texts") if table.has("quantities") else ()
    free, gaps = table.flag("without_contact"), table.flag("avoiding_gap")
    units, events = _read_units(table), _read_events(table, scene)
    return Stated(speed, stiffness, tuple(dict.fromkeys(given)), free, gaps, units, events)


def _read_events(table: Table, scene: Scene | None) -> tuple[str, ...]:
    """Words of ``events``."""
    if not table.has("events"):
        return ()
    words = table.texts("events", _EVENTS)
    for problem in event_problems(words, scene):
        table.report("events", problem)
    return words


def event_problems(words: Sequence[str], scene: Scene | None) -> Iterator[str]:
    """What is wrong with words of ``events`` for a scene, if that is known."""
    if not LISTED.keys() >= set(words) or len(set(words)) < len(words):
        yield f"found {list(words)!r}; accepted: {_EVENTS}"
    elif scene is not None:
        laws = scene.branched_springs.values()
        for word in words:
            if LISTED[word] not in laws:
                law = LISTED[word].value
                yield f"found {word!r}, which needs a spring of the law {law!r}; there is none"


def _read_units(table: Table) -> tuple[str, ...]:
    """Units that are chosen, of each dimension one at most."""
    if not table.has("units"):
        return ()
    each = (f"{dimension.value[0]} ({', '.join(USUAL[dimension])})" for dimension in TOLD)
    accepted = f"a list of texts, at most one unit each of {', '.join(each)}"
    given = table.texts("units", accepted)
    of = [dimension for unit in given for dimension in TOLD if unit in USUAL[dimension]]
    table.require("units", len(set(of)) == len(of) == len(given), accepted)
    return given


def default_solver(scenes: Iterable[Scene], many: bool) -> str:
    """The solver where none is named.

    Parameters
    ----------
    scenes : iterable of Scene
        What is run.
    many : bool
        Whether they are run many times, as in a suite or a study. Contacts that are not plain are
        left to the reference then, too.
    """
    plain = all(contact.plain for scene in scenes for contact in scene.contacts)
    return FAST if many and plain else REFERENCE


def read_solver(table: Table, default: str = REFERENCE) -> SolverOptions:
    """Read ``[solver]``, which may be empty."""
    name = table.text("name", "the name of a solver; `eventpound solvers` lists them", default)
    rtol = table.quantity("rtol", Dimension.NUMBER, 1.0e-9)
    within = math.isnan(rtol) or SMALLEST_RTOL <= rtol <= LARGEST_RTOL
    table.require("rtol", within, f"a number from {SMALLEST_RTOL:g} to {LARGEST_RTOL:g}")
    atol_table = table.table("atol")
    atol: dict[str, float] = {}
    for key, dimension in _ATOL.items():
        value = atol_table.optional_quantity(key, dimension, "a positive tolerance")
        if value is not None:
            atol[key] = value
    atol_table.close()
    known = ("name", "rtol", "atol")
    settings = {key: _setting(table, key) for key in table.data if key not in known}
    table.close()
    return SolverOptions(name, rtol, atol, settings)


def settings_in_si(settings: Mapping[str, object]) -> dict[str, object]:
    """Settings of a call, those with a dimension read as a case reads them.

    Raises
    ------
    InputError
        Naming the setting whose text is no such number.
    """
    dimensions = {key: _dimension_of(key, settings) for key in settings}
    return {
        key: value if (of := dimensions[key]) is None else number(f"settings: {key}", value, of)
        for key, value in settings.items()
    }


def _dimension_of(key: str, settings: Mapping[str, object]) -> Dimension | None:
    """Of a setting, None of one that is taken as it is."""
    if key == "contact_stiffness" and settings.get("contact") in HERTZIAN:
        return Dimension.HERTZ_STIFFNESS
    return _SETTINGS.get(key)


def _setting(table: Table, key: str) -> object:
    dimension = _dimension_of(key, table.data)
    if dimension is not None:
        return table.quantity(key, dimension)
    table.has(key)
    value = table.data[key]
    if not isinstance(value, bool | int | float | str):
        table.reject(key, "a number, a text, true or false")
    elif isinstance(value, int) and not isinstance(value, bool) and abs(value) > LARGEST:
        table.reject(key, f"a number up to {LARGEST:g}")
    return value
