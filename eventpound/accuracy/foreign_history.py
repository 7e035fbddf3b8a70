"""Another program's history as a run to be judged.

The file has the columns of ``history.csv``: ``t`` and ``u.<body>``, and ``v.<body>`` and
``z.<spring>`` where the program knows them; or a map says which of its columns are these, by
their names or numbers. Where such a name says a unit, it is read; times that an even step
explains within the rounding of their print are those of this step.
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
from eventpound.mechanics.supported import lowered, moving_supports, support_motion
from eventpound.motion.readers.base import Source
from eventpound.motion.readers.numbers import HALF_A_DIGIT
from eventpound.motion.readers.time_column import even_step, resolution
from eventpound.motion.readers.titles import Content, title_of_kind
from eventpound.numerics.arrays import Floats
from eventpound.score.answer import Motion, columns_of, place_of, read_motion
from eventpound.score.difference import Difference
from eventpound.score.levels import SAME_TIME, ScoreError
from eventpound.solvers.base import Event, EventKind, Task
from eventpound.solvers.from_samples import sampled_recording
from eventpound.solvers.supported import own_part

_READ_OFF = "impacts read off the velocities"


@dataclass(frozen=True)
class ForeignHistory:
    """A history as it was read.

    Parameters
    ----------
    path : Path
        Its file.
    motion : Motion
        What it holds.
    lacking : tuple of str
        Columns it does not have.
    """

    path: Path
    motion: Motion
    lacking: tuple[str, ...]

    @property
    def events(self) -> tuple[Event, ...] | None:
        """Impacts and rests from the file beside it; None without one."""
        if not self.motion.reported:
            return None
        return tuple(
            Event(e.t, EventKind(e.kind), row, e.contact, e.gap_velocity_before,
                  e.gap_velocity_after)
            for row, e in enumerate(self.motion.events)
            if e.kind not in (EventKind.ACCUMULATION, EventKind.CUT)
        )  # fmt: skip


def read_foreign(case: Case, path: Path, columns: Mapping[str, str | int]) -> ForeignHistory:
    """Read a history.

    Parameters
    ----------
    case : Case
        Whose history it is.
    path : Path
        The file.
    columns : mapping of str to str or int
        Names of its columns, or their numbers from 1, by what we call them; ours where one is
        not mapped.

    Raises
    ------
    InputError
        Where the file is missing, lacks a column it needs or has other rows than it should.
    """
    scene = case.scene
    bodies, springs = [body.name for body in scene.bodies], scene.hysteretic_springs
    wanted = columns_of(bodies, springs)
    if unknown := [name for name in columns if name not in wanted]:
        raise InputError(
            f"--columns: {', '.join(unknown)} is not known; accepted: {', '.join(wanted)}"
        )
    contacts = [contact.name for contact in scene.contacts]
    called = {ours: str(theirs) for ours, theirs in columns.items()}
    try:
        motion, names = read_motion(path, bodies, springs, contacts, called=called)
    except ScoreError as error:
        hint = ""
        if "no column" in str(error):
            hint = "; --columns OURS=THEIRS says which is which, by names or numbers of columns"
        raise InputError(f"{error}{hint}") from error
    called = {ours: place_of(names, theirs) for ours, theirs in called.items()}
    if missing := [place for place in called.values() if place not in names]:
        raise InputError(
            f"{path}: has no column {', '.join(missing)}, which --columns names; "
            f"it has {', '.join(names)}"
        )
    motion = _in_si(path, motion, called, bodies)
    _check_times(path, motion.t, case)
    return ForeignHistory(
        path, motion, tuple(name for name in wanted if called.get(name, name) not in names)
    )


def _in_si(path: Path, motion: Motion, called: Mapping[str, str], bodies: list[str]) -> Motion:
    """A motion in the units that the titles of mapped columns say, at even times if they are."""

    def factor(ours: str, kind: Content) -> float:
        title = title_of_kind(called.get(ours, ""), kind)
        if title.unit is not None and title.kind is not kind:
            raise InputError(f"{path}: column '{title.text}' is no {ours}, which is {kind.value}")
        return title.factor

    t = _even(factor("t", Content.TIME) * motion.t)
    u = motion.u * [factor(f"u.{body}", Content.DISPLACEMENT) for body in bodies]
    v = motion.v
    if v is not None:
        v = v * [factor(f"v.{body}", Content.VELOCITY) for body in bodies]
    return replace(motion, t=t, u=u, v=v)


def _even(t: Floats) -> Floats:
    """Times of the even step that explains them within their rounding; else the same."""
    texts = [repr(x) for x in t.tolist()]
    try:
        step = even_step(Source("", b""), texts, [0] * t.size)
    except InputError:
        return t
    even: Floats = step * np.arange(t.size, dtype=np.float64)
    off = t - even
    spread, half = float(np.ptp(off)), HALF_A_DIGIT * resolution(texts)
    if not SAME_TIME * (t[-1] - t[0]) < spread <= 2.0 * half:
        return t
    # A run begins at a time of few digits, as printed, if that can be.
    first = t[0] if abs(off - t[0]).max() <= half else 0.5 * (off.max() + off.min())
    return even + float(first)


def _check_times(path: Path, t: Floats, case: Case) -> None:
    if t.size < 2:
        raise InputError(f"{path}: has {t.size} rows; at least two are needed")
    start, slack = case.run.start_time, SAME_TIME * case.run.duration
    if abs(t[0] - start) > slack:
        raise InputError(f"{path}: begins at t = {t[0]:.9g} s, the case at {start:.9g} s")
    if t[-1] - t[0] <= slack:
        raise InputError(f"{path}: all rows are of one time, {t[0]:.9g} s")


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
    motion = history.motion
    t = motion.t
    covered = float(t[-1] - t[0])
    whole = abs(covered - case.run.duration) <= SAME_TIME * case.run.duration
    if not whole:
        run, beside = replace(case.run, duration=covered, energy=False), truth.rigid
        truth = reference_of(case, run, None)
        if beside is not None:
            other = reference_of(replace(case, scene=beside.task.scene), run, None)
            truth = replace(truth, rigid=other)
    scene = lowered(case.scene, float(t[0]))
    task = Task(scene, float(t[0]), float(t[-1]), truth.task.rtol, {}, np.unique(t))
    # Contacts and springs may be at supports, which no history holds.
    moving = [support_motion(s, case.scene.motion, t) for s in moving_supports(case.scene)]
    v = np.full_like(motion.u, np.nan) if motion.v is None else motion.v
    u, v = (np.column_stack([*(m[i] for m in moving), x]) for i, x in enumerate((motion.u, v)))
    recording = sampled_recording(task, t, u, v, motion.z, events=history.events)
    if scene is not case.scene:
        recording = own_part(recording, case.scene)

    def errors(by: Reference) -> Difference:
        return errors_of(case.scene, recording, by.truth, by.rows(task.output_times))

    rigid = None if truth.rigid is None else errors(truth.rigid)
    remark = "" if whole else f", up to t = {t[-1]:.6g} s"
    return Judged(label, "", None, errors(truth), remark=_remark(history) + remark, rigid=rigid)


def _remark(history: ForeignHistory) -> str:
    words = ["peaks as sampled"]
    if history.events is None:
        silent = history.motion.v is None or np.isnan(history.motion.v).any()
        words.append("no impacts without velocities" if silent else _READ_OFF)
    if history.lacking:
        words.append(f"without {', '.join(history.lacking)}")
    return ", ".join(words)
