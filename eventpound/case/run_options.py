"""The table ``[run]`` of a case: every option is declared here, and stands nowhere else.

From a declaration follow reading and checking it, in which ways to run it holds, the quantities
that it asks for, and its rows on the page "case-format" of the docs, which
``pytest -n 0 tests/case/test_run_options.py`` prints.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

import numpy as np

from eventpound.basics.told import OptionWarning, warn_caller
from eventpound.case.defaults import default_duration, default_output_step
from eventpound.case.keys import (
    Bound,
    Key,
    flag_key,
    keys_of,
    number_key,
    read_elsewhere,
    read_given,
    read_keys,
    texts_key,
)
from eventpound.case.table import Table
from eventpound.errors import InputError
from eventpound.motion.base import LARGEST, SMALLEST
from eventpound.numerics.arrays import Floats
from eventpound.scene.scene import Scene
from eventpound.scene.spring import LawName
from eventpound.units import TOLD, USUAL, Dimension


class Way(StrEnum):
    """A way to run a case, as messages call it."""

    RUN = "a single run"
    SUITE = "a suite"
    STUDY = "a study"
    MANY = "simulate_many"
    VERIFY = "verify"
    COMPARE = "compare"
    EXPORT = "export"
    FLOOR = "floor spectra"


LISTED = {"slip": LawName.SLIDER, "soil": LawName.BACKFILL}
"""Words of ``events``, each with the law of the springs whose events it lists."""
INITIAL, EQUILIBRIUM = "initial", "equilibrium"
"""Words of ``start``."""
MOST_ROWS = 10_000_000
"""Rows of a history at equal steps; more is a slip of the unit."""
_ALL = frozenset(Way)
_RUNS = frozenset({Way.RUN, Way.SUITE, Way.STUDY, Way.MANY})
_TOLD_OF_ONE = frozenset({Way.RUN, Way.SUITE})
_OF_VARIED = {Way.STUDY, Way.MANY}
"""Ways in which numbers of the scene vary."""
_POSITIVE = Bound("a positive time (s)", lambda time: time > 0.0)
_EVENTS = f"a list of {' and '.join(map(repr, LISTED))}, each at most once"
_UNITS = "a list of texts, at most one unit each of " + ", ".join(
    f"{dimension.value[0]} ({', '.join(USUAL[dimension])})" for dimension in TOLD
)


def _one_of_each(units: Sequence[str]) -> bool:
    """Whether these are units that may be chosen, of each dimension one at most."""
    of = [dimension for unit in units for dimension in TOLD if unit in USUAL[dimension]]
    return len(set(of)) == len(of) == len(units)


def _springs_missing(words: Sequence[str], scene: Scene) -> Iterator[str]:
    """Which words of ``events`` list nothing of a scene."""
    laws = scene.branched_springs.values()
    for word in words:
        if LISTED[word] not in laws:
            law = LISTED[word].value
            yield f"found {word!r}, which needs a spring of the law {law!r}; there is none"


DEMAND_OVER_CAPACITY = "demand_over_capacity"
"""The quantity that is the largest of all demands over their capacities."""


@dataclass(frozen=True, slots=True)
class Stated:
    """What ``[run]`` says of quantities: which are wanted, and numbers that some need.

    ``[capacity]`` gives `capacities`, what quantities may not exceed (SI), by their names, the
    `capacity_dimensions` of those with a unit, and the `fractile` of the demands over records
    that are held against them (per cent).
    """

    quantities: tuple[str, ...] = texts_key(
        '[quantities](quantities.md) that take further runs, `["velocity.<body>.abs_max"]`',
        "a list of texts",
        asks=lambda names: names,
        holds=_RUNS,
    )
    without_contact: bool = flag_key(
        "run without contact too, for `amplification` and `free` in the summary",
        asks=lambda _: ("amplification.<body>", "free.peaks.<body>.*"),
        holds=_RUNS,
    )
    contact_stiffness: float | None = number_key(
        "estimate the force of the strongest impact with it (N/m)",
        Dimension.STIFFNESS,
        None,
        Bound("a positive stiffness (N/m)", lambda stiffness: stiffness > 0.0),
        asks=lambda _: ("contacts.<contact>.estimated_force",),
        holds=_RUNS,
    )
    threshold_speed: float = number_key(
        "closing speed from which on an impact counts in `impacts_faster`",
        Dimension.VELOCITY,
        0.01,
        Bound("a speed (m/s), not negative", lambda speed: not speed < 0.0),
        "1 cm/s",
        asks=lambda _: ("contacts.<contact>.impacts_faster",),
        holds=_RUNS,
    )
    avoiding_gap: bool = flag_key(
        "find [the gaps that avoid contact](design.md): `separation_needed`, `avoiding_gap`, "
        "`avoiding_gap_alone`",
        asks=lambda _: (
            f"contacts.<contact>.{word}"
            for word in ("separation_needed", "avoiding_gap", "avoiding_gap_alone")
        ),
        holds=_RUNS,
    )
    units: tuple[str, ...] = texts_key(
        "of [design numbers](design.md) and the lines after a single run, "
        '`["MN", "cm", "m/s^2"]`: at most one each of force (`N`, `kN`, `MN`, `kip`), length '
        "(`m`, `cm`, `mm`, `in`) and acceleration (`m/s^2`, `g`). Impulse and energy follow the "
        "force, masses do not; tables in files stay in SI",
        _UNITS,
        Bound(_UNITS, _one_of_each),
        default="mm, g, and kN, or N where every body is lighter than 10 t",
        holds=_TOLD_OF_ONE,
    )
    events: tuple[str, ...] = texts_key(
        'write where sliders stick and slip, `["slip"]`, and backfill is touched and left, '
        '`["soil"]`, to [spring_events.csv](results.md#spring-events-csv)',
        _EVENTS,
        Bound(_EVENTS, lambda words: LISTED.keys() >= set(words) and len(set(words)) == len(words)),
        of_scene=_springs_missing,
        holds=_TOLD_OF_ONE,
    )
    capacities: tuple[tuple[str, float], ...] = ()
    capacity_dimensions: tuple[tuple[str, Dimension], ...] = field(default=(), compare=False)
    fractile: float = 84.0

    @property
    def faster(self) -> str:
        """From which closing speed on impacts count as faster, in words."""
        return f"faster than {100.0 * self.threshold_speed:.4g} cm/s"

    def named(self) -> Iterator[tuple[str, str]]:
        """Names and paths of all quantities that are wanted, each after the option that says so."""
        for option, (key, usual) in keys_of(Stated).items():
            value = getattr(self, option)
            if value != usual:
                yield from ((option, name) for name in key.asks(value))
        yield from (("capacity", name) for name, _ in self.capacities)
        if self.capacities:
            yield "capacity", DEMAND_OVER_CAPACITY


DEFAULTS = Stated()
"""Where a case does not say."""


@dataclass(frozen=True, slots=True)
class RunOptions:
    """What is to be computed; times are NaN where each record of a suite sets them."""

    start_time: float = number_key(
        "when the run starts (s)",
        Dimension.TIME,
        0.0,
        default="0",
        called="start of the run",
        holds=_ALL,
    )
    duration: float = number_key(
        "how long it lasts (s)",
        Dimension.TIME,
        math.nan,
        _POSITIVE,
        "see below",
        called="duration",
        holds=_ALL,
    )
    output_step: float = number_key(
        "distance of the rows of the history (s); at most 10 million rows",
        Dimension.TIME,
        math.nan,
        _POSITIVE,
        "time step of a record, else duration/2000",
        called="output step",
        holds=_TOLD_OF_ONE,
    )
    energy: bool = flag_key("keep the energy balance", holds=_RUNS)
    error_estimate: bool | None = flag_key(
        "[estimate the errors](accuracy.md#an-estimate-with-every-run) whatever it costs, or never",
        None,
        "a single run: by what is at hand; a suite: never",
        holds=_TOLD_OF_ONE,
        refused=dict.fromkeys(
            _OF_VARIED,
            "a single run or a suite; of some runs, `eventpound verify` of a case with their "
            "numbers",
        ),
    )
    stated: Stated = DEFAULTS
    in_equilibrium: bool = read_elsewhere(
        "`initial`: bodies start where `[[body]]` says; `equilibrium`: where forces, springs and "
        "contacts hold them at the start, springs with a memory loaded straight to there from the "
        "initial displacements, which may overlap, sliders stuck while friction holds them. Of "
        "several such places, the nearest to the initial displacements (least sum of squares). "
        '`{ results = "../mainshock" }`: where [another run ended](aftershocks.md), instead of '
        "initial displacements, velocities and z",
        False,
        "`initial`",
        name="start",
        holds=_ALL - _OF_VARIED,
        refused=dict.fromkeys(
            _OF_VARIED,
            '"initial", where numbers of the scene vary: all would start in the equilibrium of one',
        ),
    )

    @property
    def times(self) -> dict[str, float]:
        """Its times (s), without those that each record of a suite sets for itself."""
        times = {
            "start": self.start_time,
            "duration": self.duration,
            "output_step": self.output_step,
        }
        return {key: value for key, value in times.items() if value == value}

    @property
    def output_times(self) -> Floats:
        """Times of the rows of the history (s), without the end of a run that ends between two."""
        count = int(np.floor(self.duration / self.output_step * (1.0 + 1e-12)))
        return self.start_time + self.output_step * np.arange(count + 1, dtype=np.float64)

    def lasting(self, length: float, step: float = math.nan) -> RunOptions:
        """The same over a length (s), with rows at such steps (s), else at both ends alone.

        NaN for a length that each motion sets.
        """
        step = length if math.isnan(step) else step
        return replace(self, duration=length, output_step=step)

    def completed(self, scene: Scene) -> RunOptions:
        """The same with the times that follow from a scene and its motion where none are given.

        Raises
        ------
        InputError
            Where the motion sets no duration.
        """
        run = self
        if math.isnan(run.duration):
            run = replace(run, duration=default_duration(scene, run.start_time))
        if math.isnan(run.output_step):
            step = default_output_step(scene.motion, run.duration)
            run = replace(run, output_step=step)
        return run

    def problems(self) -> Iterator[tuple[str, str]]:
        """Keys of positive times that cannot be run, with what is wrong."""
        start, duration, step = self.start_time, self.duration, self.output_step
        if not (SMALLEST <= duration <= LARGEST and start < start + duration):
            yield (
                "duration",
                f"found {duration!r} s from {start!r} s on; accepted: {SMALLEST:g} to "
                f"{LARGEST:g} s, and not lost in the rounding of the start time",
            )
        elif duration / step > MOST_ROWS:
            yield (
                "output_step",
                f"found {step!r} s, which makes {duration / step:.3g} rows of "
                f"{duration:.6g} s; accepted: at most {MOST_ROWS} rows",
            )


def options() -> Iterator[tuple[str, Key]]:
    """Every option by its key, in the order of the page."""
    for made in (RunOptions, Stated):
        yield from ((key.name or name, key) for name, (key, _) in keys_of(made).items())


def stated_numbers(table: Table, options: RunOptions) -> dict[str, float]:
    """Numbers that ``[run]`` states, by their keys (SI)."""
    return {
        name: getattr(owner, name)
        for made, owner in ((RunOptions, options), (Stated, options.stated))
        for name, (key, _) in keys_of(made).items()
        if key.dimension is not None and table.has(name)
    }


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
    found = read_keys(table, RunOptions, scene)
    stated = Stated(**read_keys(table, Stated, scene))
    run = RunOptions(**found | {"stated": stated, "in_equilibrium": to_be_placed(table.data)})
    table.close()
    if suite and not math.isnan(run.start_time):
        return run
    if scene is None or math.isnan(run.start_time) or table.noted("duration"):
        return None
    with table.noting(""):
        run = run.completed(scene)
        for key, problem in () if table.noted("output_step") else run.problems():
            table.report(key, problem)
        return run
    return None


def with_given(options: RunOptions, given: dict[str, Any], scene: Scene) -> RunOptions:
    """Options with what a call gives instead, by their keys; None where it gives nothing.

    Raises
    ------
    InputError
        With a line for every problem.
    """
    of_stated = {key: value for key, value in given.items() if key in keys_of(Stated)}
    of_run = {key: value for key, value in given.items() if key not in of_stated}
    stated = replace(options.stated, **read_given(Stated, of_stated, scene))
    options = replace(options, stated=stated, **read_given(RunOptions, of_run)).completed(scene)
    if found := [f"{key}: {problem}" for key, problem in options.problems()]:
        raise InputError(found)
    return options


def given_options(options: RunOptions) -> list[str]:
    """Options that say something else than their defaults; times always have a value."""
    found = []
    for made, owner in ((RunOptions, options), (Stated, options.stated)):
        for name, (key, usual) in keys_of(made).items():
            value = getattr(owner, name)
            if key.dimension is not Dimension.TIME and value is not False and value != usual:
                found.append(key.name or name)
    return found


def refuse_options(run_options: RunOptions, way: Way, varied: Iterable[str] = ()) -> None:
    """Refuse options that make no sense in a way to run a case.

    Parameters
    ----------
    run_options : RunOptions
        Of the case.
    way : Way
        How it is run.
    varied : iterable of str
        Dotted keys of numbers that vary.

    Raises
    ------
    InputError
        With a line for every option.
    """
    # Those of the ground motion move no equilibrium.
    moving = any(not key.startswith("excitation.") for key in varied)
    given = given_options(run_options)
    problems = [
        f"[run]: {name}: not for {way}; accepted: {key.refused[way]}"
        for name, key in options()
        if name in given and way in key.refused and (name != "start" or moving)
    ]
    if problems:
        raise InputError(problems)


def warn_left_out(run_options: RunOptions, way: Way) -> None:
    """Say which options play no part in what is computed of a case.

    Warns
    -----
    OptionWarning
        In one line, where there are some.
    """
    given = given_options(run_options)
    left = [name for name, key in options() if name in given and way not in key.holds]
    if left:
        warn_caller(without_part(left, way), OptionWarning)


def without_effect(way: Way) -> list[str]:
    """Options that a way to run neither follows nor refuses."""
    return [name for name, key in options() if way not in key.holds and way not in key.refused]


def without_part(names: Iterable[str], way: Way) -> str:
    """What is said of options that play no part."""
    return f"[run]: {', '.join(names)}: no part of {way}, only of `eventpound run`"
