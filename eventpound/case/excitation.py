"""The ground motion of a case."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from eventpound.case.frequency import required_frequency
from eventpound.case.record_file import find_record
from eventpound.case.record_options import RecordOptions, read_record_options
from eventpound.case.record_scaling import LARGEST_SCALE
from eventpound.case.suite import Suite, read_suite_keys, understood_suite
from eventpound.case.table import Table, read_numbers
from eventpound.motion import (
    AntisymmetricRicker,
    GroundMotion,
    Harmonic,
    NoMotion,
    Record,
    RecordData,
    Ricker,
)
from eventpound.motion.pulse_fit import PULSES
from eventpound.motion.sequence import in_sequence
from eventpound.scene.periods import period_called
from eventpound.scene.scene import Scene
from eventpound.units import Dimension

_FORMULAS: Mapping[str, Any] = {**PULSES, "harmonic": Harmonic}
_KINDS = (*_FORMULAS, "record", "none")

ACROSS, ATTACK = "across", "attack"
"""Keys of the second component, a table, and of the direction of the first."""
_OF_BOTH = (
    "format", "units", "time_step", "response", "processing", "start", "reverse", "largest_scale"
)  # fmt: skip
_SIZES = ("scale", "pga", "psa")
"""Keys by which records are read, which hold for both components, and by which they are scaled."""


@dataclass(frozen=True, slots=True)
class Excitation:
    """A ground motion and the table that would give it again.

    Parameters
    ----------
    motion : GroundMotion
        The motion.
    table : mapping
        ``[excitation]`` in SI with every default filled in.
    record : RecordData, optional
        What was read from a file.
    suite : Suite, optional
        The records of a suite; the motion is then none.
    largest_scale : float
        Factor on a record beyond which is warned.
    """

    motion: GroundMotion
    table: Mapping[str, object]
    record: RecordData | None = None
    suite: Suite | None = None
    largest_scale: float = LARGEST_SCALE
    options: RecordOptions | None = None
    """How the records of a sequence are scaled, each for itself."""
    across: GroundMotion = field(default_factory=NoMotion)
    """The second component."""
    attack: float = 0.0
    """Angle from x to the first component (rad)."""


def read_excitation(table: Table, directory: Path) -> Excitation | None:
    """Read ``[excitation]``.

    Parameters
    ----------
    table : Table
        With ``kind`` and the keys of that kind.
    directory : Path
        Directory of the case, to which record files are relative.

    Returns
    -------
    Excitation or None
        None where there are problems; they are noted.
    """
    kind = table.choice("kind", _KINDS)
    if not kind:
        return None
    excitation: Excitation | None = None
    with table.noting(""):
        match kind:
            case "none":
                excitation = Excitation(NoMotion(), {"kind": kind})
            case "record":
                excitation = _read_record(table, directory)
            case _:
                excitation = _read_formula(table, kind)
    if excitation is not None:
        excitation = _in_plan(table, excitation, directory)
    table.close()
    return excitation


def _in_plan(table: Table, excitation: Excitation, directory: Path) -> Excitation:
    """The same with a second component and an angle of attack, where the table has them."""
    said = dict(excitation.table)
    attack = table.quantity(ATTACK, Dimension.ANGLE, 0.0)
    if table.has(ATTACK):
        said[ATTACK] = attack
    if not table.has(ACROSS):
        return replace(excitation, attack=attack, table=said)
    own, first = table.table(ACROSS), excitation.motion
    if excitation.suite is not None or isinstance(said.get("file"), list):
        own.reject("", "none beside a suite or a list of records")
        return excitation
    if isinstance(first, Record) and first.psa_at:
        own.reject("", "none beside a period of the scene in psa_period; give it in s")
        return excitation
    given = {"kind": table.data["kind"]} | dict(own.data)
    if isinstance(first, Record) and given["kind"] == "record":
        # One factor for both components, unless the second has its own.
        shared = {key: value for key, value in table.data.items() if key in _OF_BOTH}
        sized = any(key in own.data for key in _SIZES)
        given = shared | ({} if sized else {"scale": abs(first.factor)}) | given
    second = read_excitation(own.with_data(given), directory)
    if second is None:
        return excitation
    said[ACROSS] = dict(second.table)
    return replace(excitation, across=second.motion, attack=attack, table=said)


def for_scene(excitation: Excitation, scene: Scene) -> Excitation:
    """The same with records scaled at the period of a scene, where the case says so.

    Raises
    ------
    InputError
        Where the scene has no such period.
    """
    suite, motion, each = excitation.suite, excitation.motion, excitation.options
    if each is not None and each.size.psa_at and excitation.record is not None:
        own = replace(each, size=each.size.for_scene(scene))
        return replace(excitation, motion=own.motion(excitation.record), options=own)
    if suite is not None and suite.options.size.psa_at:
        size = suite.options.size.for_scene(scene)
        scaled = replace(suite, options=replace(suite.options, size=size))
        return replace(excitation, suite=scaled)
    if isinstance(motion, Record) and motion.psa_at:
        period = period_called(scene, motion.psa_at)
        return replace(excitation, motion=motion.like(psa_period=period))
    return excitation


def bare_accelerations(document: Mapping[str, Any]) -> list[tuple[str, float]]:
    """Accelerations of ground motions that have no unit, by the keys of a case without problems."""
    motions = [("excitation", document["excitation"])] + [
        (f"support {i}: excitation", support["excitation"])
        for i, support in enumerate(document.get("support", ()), 1)
        if "excitation" in support
    ]
    return [
        (f"{where}: {key}", motion[key])
        for where, motion in motions
        for key in ("amplitude", "pga", "psa")
        if isinstance(motion.get(key), int | float)
    ]


def _read_formula(table: Table, kind: str) -> Excitation | None:
    """A motion given by an amplitude and a period."""
    amplitude = table.quantity("amplitude", Dimension.ACCELERATION)
    table.require(
        "amplitude", not amplitude <= 0.0, "a positive acceleration; reverse turns a motion round"
    )
    omega, period = required_frequency(table)
    own = read_numbers(table, _FORMULAS[kind], "amplitude", "period", "start")
    numbers = {"amplitude": amplitude, "period": period, **own}
    numbers["start"] = table.quantity("start", Dimension.TIME, 0.0)
    reverse = table.flag("reverse")
    if not (amplitude > 0.0 and omega > 0.0) or any(
        math.isnan(number) for number in numbers.values()
    ):
        return None
    motion = _FORMULAS[kind](**numbers, reverse=reverse)
    if isinstance(motion, Ricker | AntisymmetricRicker):
        numbers["center"] = motion.middle
    return Excitation(motion, {"kind": kind, **numbers, "reverse": reverse})


def _read_record(table: Table, directory: Path) -> Excitation | None:
    """A record from a file beside the case or in an installed package, or a suite of them."""
    options = read_record_options(table, directory)
    if table.has("suite") or table.has("synthetic"):
        suite = read_suite_keys(table, options)
        if suite is None:
            return None
        # What matches nothing is wrong with the case, and found before anything runs.
        suite.members(directory)
        said, largest = understood_suite(suite), suite.options.size.largest
        return Excitation(NoMotion(), said, None, suite, largest)
    if isinstance(table.data.get("file"), list):
        return _read_sequence(table, directory, options)
    file = table.text("file", "the file of a record")
    if not file or options is None:
        return None
    return record_excitation(file, find_record(file, directory), options)


def _read_sequence(
    table: Table, directory: Path, options: RecordOptions | None
) -> Excitation | None:
    """Records one after the other, ``file`` a list of them."""
    files = table.texts("file", "the file of a record, or a list of files")
    rest = table.quantity("rest", Dimension.TIME)
    table.require("rest", not rest <= 0.0, "a positive time between the records of a list (s)")
    if not files or options is None or not rest > 0.0:
        return None
    data = in_sequence([options.read(find_record(file, directory)) for file in files], rest)
    said = {"file": list(files), "rest": rest, **options.said(), **options.understood()}
    largest, each = options.size.largest, options if options.size.each else None
    table_said = {"kind": "record", **said}
    return Excitation(options.motion(data), table_said, data, None, largest, each)


def record_excitation(file: str, path: Path, options: RecordOptions) -> Excitation:
    """The motion of one record file.

    Parameters
    ----------
    file : str
        As a case names it.
    path : Path
        Where it is.
    options : RecordOptions
        How it is read and scaled.

    Raises
    ------
    InputError
        Where it cannot be read or used.
    """
    data = options.read(path)
    said, largest = options.of_file(file, data), options.size.largest
    return Excitation(options.motion(data), said, data, None, largest)
