"""The ground motion of a case."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from eventpound.case.frequency import optional_frequency
from eventpound.case.record_file import find_record
from eventpound.case.table import Table
from eventpound.errors import InputError
from eventpound.motion import (
    AntisymmetricRicker,
    Cosine,
    GroundMotion,
    Harmonic,
    MavroeidisPapageorgiou,
    NoMotion,
    Record,
    RecordData,
    Ricker,
    Sine,
    TypeC,
    read_record,
)
from eventpound.units import Dimension

_FORMULAS: Mapping[str, Callable[..., GroundMotion]] = {
    "sine": Sine,
    "cosine": Cosine,
    "type-c": TypeC,
    "ricker": Ricker,
    "antisymmetric-ricker": AntisymmetricRicker,
    "mavroeidis-papageorgiou": MavroeidisPapageorgiou,
    "harmonic": Harmonic,
}
_KINDS = (*_FORMULAS, "record", "none")


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
    """

    motion: GroundMotion
    table: Mapping[str, object]
    record: RecordData | None = None


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
    if table.has("suite"):
        table.reject("suite", "file; one run takes one record, a suite is not supported by `run`")
        return None
    kind = table.choice("kind", _KINDS)
    if not kind:
        return None
    excitation: Excitation | None = None
    try:
        match kind:
            case "none":
                excitation = Excitation(NoMotion(), {"kind": kind})
            case "record":
                excitation = _read_record(table, directory)
            case _:
                excitation = _read_formula(table, kind)
    except InputError as error:
        for problem in error.problems:
            table.report("", problem)
    table.close()
    return excitation


def _read_formula(table: Table, kind: str) -> Excitation | None:
    """A motion given by an amplitude and a period."""
    amplitude = table.quantity("amplitude", Dimension.ACCELERATION)
    table.require(
        "amplitude", not amplitude <= 0.0, "a positive acceleration; reverse turns a motion round"
    )
    omega, period = optional_frequency(table) or (math.nan, math.nan)
    if not (table.has("period") or table.has("frequency")):
        table.report_missing("period", f"{Dimension.TIME.accepted}; or frequency (rad/s)")
    elif omega == 0.0:
        table.reject("frequency", "a positive frequency (rad/s)")
    numbers = {"amplitude": amplitude, "period": period, **_read_shape(table, kind)}
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


def _read_shape(table: Table, kind: str) -> dict[str, float]:
    """Keys of one kind only; those not given are left to the motion's own default."""
    optional: dict[str, float | None] = {}
    match kind:
        case "type-c":
            optional["cycles"] = table.quantity("cycles", Dimension.NUMBER, 1.0)
        case "harmonic":
            optional["cycles"] = table.optional_quantity("cycles", Dimension.NUMBER)
        case "ricker" | "antisymmetric-ricker":
            optional["center"] = table.optional_quantity("center", Dimension.TIME)
        case "mavroeidis-papageorgiou":
            optional["gamma"] = table.quantity("gamma", Dimension.NUMBER, 2.0)
            optional["phase"] = table.quantity("phase", Dimension.ANGLE, 0.0)
    return {key: value for key, value in optional.items() if value is not None}


def _read_record(table: Table, directory: Path) -> Excitation | None:
    """A record from a file beside the case or in an installed package."""
    file = table.text("file", "the file of a record")
    pga = table.optional_quantity("pga", Dimension.ACCELERATION)
    scale = table.optional_quantity("scale", Dimension.NUMBER)
    time_step = table.optional_quantity("time_step", Dimension.TIME)
    start = table.quantity("start", Dimension.TIME, 0.0)
    reverse = table.flag("reverse")
    texts = {
        key: table.text(key, f"the {key} of the file") if table.has(key) else None
        for key in ("format", "units", "component", "response")
    }
    for key, value in (("pga", pga), ("scale", scale), ("time_step", time_step)):
        if value is not None:
            table.require(key, not value <= 0.0, "a positive number; reverse turns a motion round")
    if pga is not None and scale is not None:
        table.reject("scale", "one of scale and pga")
        return None
    numbers = [value for value in (pga, scale, time_step, start) if value is not None]
    if not file or any(math.isnan(number) for number in numbers) or "" in texts.values():
        return None
    response = texts.pop("response")
    data = read_record(
        find_record(file, directory),
        time_step=time_step,
        response=None if response is None else find_record(response, directory),
        **texts,
    )
    motion = Record(
        data.acceleration,
        data.time_step,
        1.0 if scale is None else scale,
        pga,
        reverse,
        start,
        data,
    )
    understood = {
        "kind": "record",
        "file": file,
        "format": data.format,
        "units": data.units,
        "time_step": data.time_step,
        **({} if texts["component"] is None else {"component": texts["component"]}),
        **({} if response is None else {"response": response}),
        **({"scale": motion.scale} if pga is None else {"pga": pga}),
        "start": start,
        "reverse": reverse,
    }
    return Excitation(motion, understood, data)
