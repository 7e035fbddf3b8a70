"""Another program's history as a run to be judged.

The file has the columns of ``history.csv``: ``t`` and ``u.<body>``, and ``v.<body>`` and
``z.<spring>`` where the program knows them; or a map says which of its columns are these.
Its peaks are those of its rows. Impacts are read off the velocities, unless a file beside
it lists them: ``X.events.csv`` beside ``X.csv``, ``events.csv`` beside ``history.csv``.
The reference runs over the stretch of time that the file covers, with rows at its times.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from eventpound.accuracy.quantities import errors_of
from eventpound.accuracy.reference import Reference, reference_of
from eventpound.accuracy.work_precision import Judged
from eventpound.case.case import Case
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.results.tables import read_columns, to_numbers
from eventpound.scene.scene import Scene
from eventpound.score import Difference
from eventpound.solvers.base import ENDS_OF_REST, Event, EventKind, Task
from eventpound.solvers.from_samples import sampled_recording

_READ_OFF = "impacts read off the velocities"
SAME_TIME = 1e-9
"""Part of the duration within which two times are one."""


@dataclass(frozen=True)
class ForeignHistory:
    """A history as it was read.

    Parameters
    ----------
    path : Path
        Its file.
    t : ndarray, shape (n,)
        Times (s), not decreasing.
    u, v : ndarray, shape (n, N)
        Displacements (m) and velocities (m/s); columns of NaN where there are none.
    z : ndarray, shape (n, H)
        Hysteretic variables, likewise.
    events : tuple of Event or None
        Impacts and rests from the file beside it; None without one.
    lacking : tuple of str
        Columns it does not have.
    """

    path: Path
    t: Floats
    u: Floats
    v: Floats
    z: Floats
    events: tuple[Event, ...] | None
    lacking: tuple[str, ...]


def read_foreign(case: Case, path: Path, columns: Mapping[str, str]) -> ForeignHistory:
    """Read a history.

    Parameters
    ----------
    case : Case
        Whose history it is.
    path : Path
        The file.
    columns : mapping of str to str
        Names of its columns by what we call them; ours where one is not mapped.

    Raises
    ------
    InputError
        Where the file is missing, lacks a column it needs or has other rows than it should.
    """
    cells = read_columns(path)
    wanted = wanted_columns(case.scene)
    _check_map(path, columns, cells, wanted)
    numbers: dict[str, Floats] = {}
    for name in wanted:
        place = columns.get(name, name)
        if place in cells:
            numbers[name] = _whole(path, place, to_numbers(path, place, cells[place]))
    _check_there(path, numbers, wanted, list(cells))
    t = numbers["t"]
    _check_times(path, t, case)
    bodies = [body.name for body in case.scene.bodies]
    springs = case.scene.hysteretic_springs

    def matrix(prefix: str, names: list[str]) -> Floats:
        nothing = np.full(t.size, np.nan)
        return np.column_stack(
            [numbers.get(f"{prefix}.{name}", nothing) for name in names] or [np.empty((t.size, 0))]
        )

    return ForeignHistory(
        path,
        t,
        matrix("u", bodies),
        matrix("v", bodies),
        matrix("z", springs),
        _events_beside(path, case.scene),
        tuple(name for name in wanted if name not in numbers),
    )


def wanted_columns(scene: Scene) -> list[str]:
    """Columns of a history that are judged."""
    bodies = [body.name for body in scene.bodies]
    springs = scene.hysteretic_springs
    return ["t", *(f"{k}.{b}" for k in "uv" for b in bodies), *(f"z.{s}" for s in springs)]


def _check_map(
    path: Path, columns: Mapping[str, str], cells: Mapping[str, object], wanted: list[str]
) -> None:
    unknown = [name for name in columns if name not in wanted]
    if unknown:
        raise InputError(
            f"--columns: {', '.join(unknown)} is not known; accepted: {', '.join(wanted)}"
        )
    missing = [place for place in columns.values() if place not in cells]
    if missing:
        raise InputError(
            f"{path}: has no column {', '.join(missing)}, which --columns names; "
            f"it has {', '.join(cells)}"
        )


def _check_there(
    path: Path, numbers: Mapping[str, Floats], wanted: list[str], names: list[str]
) -> None:
    missing = [name for name in wanted if name[0] in "tu" and name not in numbers]
    if missing:
        raise InputError(
            f"{path}: has no column {', '.join(missing)}; it has {', '.join(names)}; "
            f"--columns {missing[0]}=NAME says which of them it is"
        )


def _whole(path: Path, name: str, values: Floats) -> Floats:
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        raise InputError(f"{path}: row {bad[0] + 2}, column {name}: a finite number is expected")
    return values


def _check_times(path: Path, t: Floats, case: Case) -> None:
    if t.size < 2:
        raise InputError(f"{path}: has {t.size} rows; at least two are needed")
    back = np.flatnonzero(np.diff(t) < 0.0)
    if back.size:
        raise InputError(f"{path}: row {back[0] + 3}: t goes back; accepted: times in order")
    start, slack = case.run.start_time, SAME_TIME * case.run.duration
    if abs(t[0] - start) > slack:
        raise InputError(f"{path}: begins at t = {t[0]:.9g} s, the case at {start:.9g} s")
    if t[-1] - t[0] <= slack:
        raise InputError(f"{path}: all rows are of one time, {t[0]:.9g} s")


def _events_beside(path: Path, scene: Scene) -> tuple[Event, ...] | None:
    """Impacts, rests and their ends listed beside a history; None where there is no such file."""
    name = "events.csv" if path.name == "history.csv" else f"{path.stem}.events.csv"
    file = path.with_name(name)
    if not file.is_file():
        return None
    cells = read_columns(file)
    missing = [key for key in ("t", "contact") if key not in cells]
    if missing:
        raise InputError(f"{file}: has no column {', '.join(missing)}; it has {', '.join(cells)}")
    names = [contact.name for contact in scene.contacts]
    unknown = sorted(set(cells["contact"]) - set(names))
    if unknown:
        raise InputError(
            f"{file}: contact {', '.join(unknown)} is not in the case; accepted: {', '.join(names)}"
        )
    t = to_numbers(file, "t", cells["t"])
    kinds = cells.get("kind", [EventKind.IMPACT.value] * t.size)
    before, after = (
        to_numbers(file, key, cells[key]) if key in cells else np.full(t.size, np.nan)
        for key in ("gap_velocity_before", "gap_velocity_after")
    )
    known = {kind.value for kind in (EventKind.IMPACT, EventKind.REST, *ENDS_OF_REST)}
    rows = [i for i in np.argsort(t, kind="stable") if kinds[i] in known]
    return tuple(
        Event(
            float(t[i]),
            EventKind(kinds[i]),
            group,
            names.index(cells["contact"][i]),
            float(before[i]),
            float(after[i]),
        )
        for group, i in enumerate(rows)
    )


def judge_history(case: Case, history: ForeignHistory, truth: Reference, label: str) -> Judged:
    """Hold a history against the reference over the time that it covers.

    Parameters
    ----------
    case : Case
        Whose history it is.
    history : ForeignHistory
        What was read.
    truth : Reference
        The case's reference, used where the history covers the whole run.
    label : str
        What tables and figures call it.
    """
    t = history.t
    covered = float(t[-1] - t[0])
    whole = abs(covered - case.run.duration) <= SAME_TIME * case.run.duration
    if not whole:
        run, beside = replace(case.run, duration=covered, energy=False), truth.rigid
        truth = reference_of(case, run, None)
        if beside is not None:
            other = reference_of(replace(case, scene=beside.task.scene), run, None)
            truth = replace(truth, rigid=other)
    task = Task(case.scene, float(t[0]), float(t[-1]), truth.task.rtol, {}, np.unique(t))
    recording = sampled_recording(task, t, history.u, history.v, history.z, events=history.events)

    def errors(by: Reference) -> Difference:
        return errors_of(case.scene, recording, by.truth, by.rows(task.output_times))

    rigid = None if truth.rigid is None else errors(truth.rigid)
    remark = "" if whole else f", up to t = {t[-1]:.6g} s"
    return Judged(label, "", None, errors(truth), remark=_remark(history) + remark, rigid=rigid)


def _remark(history: ForeignHistory) -> str:
    words = ["peaks as sampled"]
    if history.events is None:
        silent = np.isnan(history.v).any()
        words.append("no impacts without velocities" if silent else _READ_OFF)
    if history.lacking:
        words.append(f"without {', '.join(history.lacking)}")
    return ", ".join(words)
