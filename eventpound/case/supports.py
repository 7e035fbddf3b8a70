"""Supports and forces of a case."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from eventpound.case.excitation import Excitation, read_component
from eventpound.case.frequency import required_frequency
from eventpound.case.record_file import find_record
from eventpound.case.suite import Suite
from eventpound.case.table import Table
from eventpound.errors import InputError
from eventpound.motion import GroundMotion, NoMotion, Record
from eventpound.motion.base import LARGEST
from eventpound.motion.constant import Constant, PhasedSine
from eventpound.motion.readers import Given
from eventpound.motion.readers.base import Source, load
from eventpound.motion.readers.binary import binary_kind
from eventpound.motion.readers.columns import numeric_rows, refuse_decimal_commas, step_of
from eventpound.motion.readers.rows import NumberRows
from eventpound.motion.readers.titles import Content, Title, title_of_kind
from eventpound.numerics.arrays import Floats
from eventpound.scene.force import Force, constant_force
from eventpound.scene.support import Support
from eventpound.units import Dimension

_CYCLES = {"half-sine": 0.5, "sine": 1.0, "harmonic": None}
"""Periods that forces by a formula last."""
_SECONDS = Given(time_step=1.0)
"""Whole numbers that count up are seconds beside a force."""
_AMOUNT = (
    'a force: a number in N, or a string like "-12 kN"; or an acceleration like "-9.81 m/s^2", '
    "for each unit of mass"
)


@dataclass(frozen=True, slots=True)
class Driven:
    """Supports and forces, and the tables that would give them again.

    Parameters
    ----------
    supports, forces : tuple
        For the scene.
    tables : mapping
        ``support`` and ``force`` in SI, each where there are some.
    suites : tuple of (str, Suite)
        Of supports under a record for each one of the case, which stand still in the scene.
    """

    supports: tuple[Support, ...] = ()
    forces: tuple[Force, ...] = ()
    tables: Mapping[str, object] = field(default_factory=dict)
    suites: tuple[tuple[str, Suite], ...] = ()


def read_driven(
    supports: Sequence[Table],
    forces: Sequence[Table],
    bodies: Iterable[str],
    directory: Path,
    excitation: Excitation | None,
) -> Driven:
    """Supports and forces from their tables.

    Parameters
    ----------
    supports, forces : sequence of Table
        The ``[[support]]`` and ``[[force]]`` tables; problems are noted.
    bodies : iterable of str
        Names of the bodies.
    directory : Path
        Of the case, to which files are relative.
    excitation : Excitation or None
        Of the case, where it is sound; with its suite those of supports may go.
    """
    in_suite = excitation is not None and excitation.suite is not None
    read = [_read_support(table, directory, in_suite) for table in supports]
    names = list(bodies)
    pushed = [pair for table in forces for pair in _read_forces(table, names, directory)]
    tables: dict[str, object] = {}
    if read:
        tables["support"] = [understood for _, understood, _ in read]
    if pushed:
        tables["force"] = [understood for _, understood in pushed]
    return Driven(
        tuple(s for s, _, _ in read),
        tuple(f for f, _ in pushed),
        tables,
        tuple((support.name, suite) for support, _, suite in read if suite is not None),
    )


def _read_support(
    table: Table, directory: Path, in_suite: bool
) -> tuple[Support, dict[str, object], Suite | None]:
    """One ``[[support]]``: a delay, or a motion of its own, or one for each of the case."""
    name = table.text("name", "a name for the support")
    delay = table.optional_quantity("delay", Dimension.TIME)
    excitation = _own_motion(table, directory, in_suite) if table.has("excitation") else None
    if (delay is None) != table.has("excitation"):
        table.report(
            "delay",
            ("found beside excitation" if delay is not None else "missing")
            + "; accepted: one of delay (of the motion of the case, s) and excitation (a table)",
        )
    if delay is not None:
        table.require("delay", not delay < 0.0, "a time that is not negative (s)")
    table.close()
    if excitation is None:
        # What could not be read was noted; a support at rest stands for it.
        standing = None if delay is not None else NoMotion()
        return Support(name, delay, standing), {"name": name, "delay": delay}, None
    understood: dict[str, object] = {"name": name, "excitation": dict(excitation.table)}
    return Support(name, None, excitation.motion), understood, excitation.suite


def _own_motion(table: Table, directory: Path, in_suite: bool) -> Excitation | None:
    own = table.table("excitation")
    for key in ("suite", "synthetic"):
        if own.has(key) and not in_suite:
            own.reject(key, "file: records of a support go with those of a suite in [excitation]")
            return None
    if own.has("largest_scale"):
        own.reject("largest_scale", "in [excitation] of the case, for all records")
        return None
    excitation = read_component(own, directory)
    if excitation is not None and isinstance(excitation.table.get("psa_period"), str):
        own.reject("psa_period", "a period (s)")
        return None
    return excitation


def _read_forces(
    table: Table, bodies: Sequence[str], directory: Path
) -> list[tuple[Force, dict[str, object]]]:
    """The forces of one ``[[force]]``, one a body."""
    if table.has("bodies"):
        names = list(table.texts("bodies", "a list of names of bodies"))
        if table.has("body"):
            table.reject("bodies", "one of body and bodies")
    else:
        names = [table.text("body", f"a body, one of {', '.join(bodies[:8])}")]
    for name in names:
        if name and name not in bodies:
            key = "bodies" if table.has("bodies") else "body"
            table.report(key, f"found {name!r}; accepted: one of {', '.join(bodies[:8])}")
    ways = {"value": _constant, "file": _from_file, "kind": _formula}
    said = f": a constant force, a history in a file, or {', '.join(_CYCLES)}"
    given = table.one_of(tuple(ways), said)
    if not given:
        return []
    history, per_mass, understood = ways[given](table, directory)
    table.close()
    return [
        (Force(name, history, per_mass), {"body": name, **understood})
        for name in names
        if name in bodies
    ]


_History = tuple[GroundMotion, bool, dict[str, object]]


def _amount(table: Table, key: str) -> tuple[float, bool]:
    """A force or an acceleration; NaN with a problem noted where it is neither."""
    if not table.has(key):
        table.report_missing(key, _AMOUNT)
        return math.nan, False
    with suppress(InputError):
        value, per_mass = constant_force(table.data[key])
        if abs(value) <= LARGEST:
            return value, per_mass
    table.reject(key, _AMOUNT)
    return math.nan, False


def _with_unit(value: float, per_mass: bool) -> object:
    return f"{value!r} m/s^2" if per_mass else value


def _constant(table: Table, directory: Path) -> _History:
    value, per_mass = _amount(table, "value")
    history = Constant(value) if math.isfinite(value) else Constant(0.0)
    return history, per_mass, {"value": _with_unit(value, per_mass)}


def _formula(table: Table, directory: Path) -> _History:
    kind = table.choice("kind", list(_CYCLES))
    amplitude, per_mass = _amount(table, "amplitude")
    table.require("amplitude", not amplitude <= 0.0, "a positive force; reverse turns it round")
    omega, period = required_frequency(table)
    cycles = _CYCLES.get(kind)
    if kind == "harmonic":
        cycles = table.optional_quantity("cycles", Dimension.NUMBER)
    numbers = {
        "phase": table.quantity("phase", Dimension.ANGLE, 0.0),
        "start": table.quantity("start", Dimension.TIME, 0.0),
    }
    reverse = table.flag("reverse")
    if not kind or not (amplitude > 0.0 and omega > 0.0) or math.isnan(sum(numbers.values())):
        return NoMotion(), per_mass, {}
    understood: dict[str, object] = {
        "kind": kind,
        "amplitude": _with_unit(amplitude, per_mass),
        "period": period,
        **({"cycles": cycles} if kind == "harmonic" and cycles is not None else {}),
        **numbers,
        "reverse": reverse,
    }
    with table.noting(""):
        history = PhasedSine(amplitude, period, reverse, **numbers, cycles=cycles)
        return history, per_mass, understood
    return NoMotion(), per_mass, {}


def _from_file(table: Table, directory: Path) -> _History:
    """Two columns, time and force, evenly spaced; linear between, zero before and after."""
    file = table.text("file", "a CSV file of two columns, time (s) and force (N)")
    scale = table.quantity("scale", Dimension.NUMBER, 1.0)
    table.require("scale", not scale <= 0.0, "a positive number; reverse turns a force round")
    reverse = table.flag("reverse")
    understood: dict[str, object] = {"file": file, "scale": scale, "reverse": reverse}
    if not file or not scale > 0.0:
        return NoMotion(), False, understood
    try:
        start, step, force = read_force(find_record(file, directory))
        history = Record(force, step, scale, None, reverse, start)
    except InputError as error:
        text = "; ".join(problem.removeprefix("file: ") for problem in error.problems)
        table.report("file", text)
        return NoMotion(), False, understood
    return history, False, understood


def read_force(path: Path) -> tuple[float, float, Floats]:
    """First time (s), time step (s) and forces (N) of a file of two columns.

    Parameters
    ----------
    path : Path
        Times and forces as in a record of columns, in s and N unless titles say otherwise.

    Raises
    ------
    InputError
        Naming the file, the line and what is accepted.
    """
    source = load(path)
    if kind := binary_kind(source.content, may_have_zeros=False):
        raise source.error(None, f"found {kind}; times and forces are needed")
    refuse_decimal_commas(source, whole=True)
    table = numeric_rows(source, _SECONDS)
    rows, times = table.rows, table.times
    rows.refuse_odd(source)
    if rows.width != 2 or len(times) != 1:
        accepted = "accepted: two, a time (s) and a force (N)"
        raise source.error(rows.lines[0], f"found {rows.width} columns; {accepted}")
    time, force = times[0], 1 - times[0]
    title = _force_title(source, rows, table.titles[force].text)
    if title.kind not in (None, Content.FORCE):
        raise source.error(rows.lines[0] - 1, f"'{title.text}' is no force but {title.kind.value}")
    step, _ = step_of(source, table)
    assert step is not None
    start = table.titles[time].factor * float(rows.column(time)[0])
    return start, step, title.factor * rows.column(force)


def _force_title(source: Source, rows: NumberRows, text: str) -> Title:
    """The title of forces, with the unit that it or, without one, a comment states.

    Raises
    ------
    InputError
        For a unit in brackets that is none of a force.
    """
    title = title_of_kind(text, Content.FORCE)
    if not text:
        words = (re.sub(r"(?i)^\W*(units?\b)?", "force ", line) for line in rows.before)
        said = (title_of_kind(line, Content.FORCE) for line in words)
        return next((one for one in said if one.unit is not None), title)
    if title.kind in (None, Content.FORCE) and title.unit is None and re.search(r"[(\[]", text):
        raise source.error(
            rows.lines[0] - 1, f"'{text}' states no unit of a force that is known, as (kN) does"
        )
    return title
