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
from eventpound.case.record_scaling import LARGEST_SCALE, WAYS, own_period, scaled_as
from eventpound.case.suite import (
    ATTACK,
    SECOND,
    Suite,
    read_suite_keys,
    understood_suite,
    where_beside,
)
from eventpound.case.table import Table, read_numbers
from eventpound.errors import told_of
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

_OF_BOTH = (
    *("format", "units", "time_step", "response", "processing"),
    *("start", "reverse", "rest", "largest_scale"),
)
"""Keys by which records are read, which hold for both components."""
_SUITE = "a suite"


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
    options : RecordOptions, optional
        How its records are read and scaled.
    second : Excitation, optional
        The second component.
    attack : float
        Angle from x to the first component (rad).
    across : GroundMotion
        Motion of the second component; none where that is of a suite.
    """

    motion: GroundMotion
    table: Mapping[str, object]
    record: RecordData | None = None
    suite: Suite | None = None
    options: RecordOptions | None = None
    second: Excitation | None = None
    attack: float = 0.0
    across: GroundMotion = field(default_factory=NoMotion)

    @property
    def largest_scale(self) -> float:
        """Factor on a record beyond which is warned."""
        return LARGEST_SCALE if self.options is None else self.options.size.largest


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
    excitation = _read(table, kind, directory)
    if excitation is not None:
        excitation = _in_plan(table, excitation, directory)
    table.close()
    return excitation


def read_component(table: Table, directory: Path, follows: bool = False) -> Excitation | None:
    """Read a motion by itself, as of a support or of the second component.

    `follows` says that its records are scaled as those of the first component. Otherwise as
    `read_excitation`.
    """
    kind = table.choice("kind", _KINDS)
    if not kind:
        return None
    found = _read(table, kind, directory, follows)
    table.close()
    return found


def _read(table: Table, kind: str, directory: Path, follows: bool = False) -> Excitation | None:
    with table.noting(""):
        match kind:
            case "none":
                return Excitation(NoMotion(), {"kind": kind})
            case "record":
                return _read_record(table, directory, follows)
        return _read_formula(table, kind)
    return None


def _in_plan(table: Table, excitation: Excitation, directory: Path) -> Excitation:
    """The same with a second component and an angle of attack, where the table has them."""
    said = dict(excitation.table)
    attack = table.quantity(ATTACK, Dimension.ANGLE, 0.0)
    if table.has(ATTACK):
        said[ATTACK] = attack
    if not table.has(SECOND):
        return replace(excitation, attack=attack, table=said)
    own = table.table(SECOND)
    given = {"kind": said["kind"]} | dict(own.data)
    of_records = given["kind"] == said["kind"] == "record"
    if of_records:
        given = {key: value for key, value in table.data.items() if key in _OF_BOTH} | given
    # One factor for both components, unless the second has its own.
    follows = of_records and not any(way in given for way in WAYS)
    own = own.with_data(given)
    second = None if _unlike(table, own, excitation) else read_component(own, directory, follows)
    if second is None:
        return excitation
    said[SECOND] = dict(second.table)
    suite = excitation.suite
    with table.noting(""):
        if suite is not None and second.suite is not None:
            suite = replace(suite, beside=((SECOND, second.suite),))
            suite.members(directory)
        excitation = replace(excitation, suite=suite, second=second, attack=attack, table=said)
        return _with_across(excitation)
    return excitation


def _unlike(table: Table, own: Table, first: Excitation) -> bool:
    """Whether the records of a second component are others than the first has, which is noted."""
    if own.data["kind"] != "record":
        return False
    if own_period(own):
        own.reject("psa_period", "a period (s); that of the scene scales the first component alone")
        return True
    found, beside = _records(own.data), _records(first.table)
    if found != beside and (first.table["kind"] == "record" or found == _SUITE):
        table.report(SECOND, f"found {found} beside {beside}; accepted: {beside}")
        return True
    return False


def _records(given: Mapping[str, object]) -> str:
    """What ``[excitation]`` has of records."""
    if "suite" in given or "synthetic" in given:
        return _SUITE
    return "a list of files" if isinstance(given.get("file"), list) else "one motion"


def _with_across(excitation: Excitation) -> Excitation:
    """The same with the motion of the second component beside the first as it is."""
    second, first = excitation.second, excitation.motion
    if second is None:
        return excitation
    own, options = second.motion, second.options
    follows = options is not None and options.follows
    if follows and isinstance(own, Record) and isinstance(first, Record):
        with told_of(where_beside(SECOND)):
            own = scaled_as(first, own)
    return replace(excitation, across=own)


def for_scene(excitation: Excitation, scene: Scene) -> Excitation:
    """The same with records scaled at the period of a scene, where the case says so.

    Raises
    ------
    InputError
        Where the scene has no such period.
    """
    suite, motion, options = excitation.suite, excitation.motion, excitation.options
    if options is not None and options.size.psa_at and (suite or options.size.each):
        own = replace(options, size=options.size.for_scene(scene))
        if suite is not None:
            return replace(excitation, suite=replace(suite, options=own), options=own)
        assert excitation.record is not None
        return _with_across(replace(excitation, motion=own.motion(excitation.record), options=own))
    if isinstance(motion, Record) and motion.psa_at:
        period = period_called(scene, motion.psa_at)
        return _with_across(replace(excitation, motion=motion.like(psa_period=period)))
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


def _read_record(table: Table, directory: Path, follows: bool) -> Excitation | None:
    """A record from a file beside the case or in an installed package, or a suite of them."""
    options = read_record_options(table, directory)
    options = options and replace(options, follows=follows)
    if table.has("suite") or table.has("synthetic"):
        suite = read_suite_keys(table, options)
        if suite is None:
            return None
        # What matches nothing is wrong with the case, and found before anything runs.
        suite.members(directory)
        return Excitation(NoMotion(), understood_suite(suite), None, suite, options)
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
    given = {"kind": "record", "file": list(files), "rest": rest}
    said = {**given, **options.said(), **options.understood()}
    return Excitation(options.motion(data), said, data, None, options)


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
    return Excitation(options.motion(data), options.of_file(file, data), data, None, options)
