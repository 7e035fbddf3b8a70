"""A program's files as a motion with events, which are read off its rows where none are listed."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from eventpound.score.levels import (
    CLOSED,
    EVENTS,
    IGNORED,
    ROUND_GAP,
    SAME_TIME,
    SMOOTH,
    START,
    UNJUDGED,
    Floats,
    ScoreError,
)
from eventpound.score.pairing import Event
from eventpound.score.problem import Problem


@dataclass(frozen=True)
class Motion:
    """What a program answers.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Times (s), not decreasing.
    u, v, z : ndarray, shape (n, N), (n, N), (n, H)
        Displacements (m), velocities (m/s) or None, hysteretic variables or None.
    events : sequence of Event
        In order of time.
    reported : set of str
        "impact" and keys of `EVENTS`: what the program would list if it occurred. Impacts that it
        does not list are read off the velocities.
    """

    t: Floats
    u: Floats
    v: Floats | None = None
    z: Floats | None = None
    events: Sequence[Any] = ()
    reported: frozenset[str] = frozenset()


def read_history(problem: Problem, path: Path) -> Motion:
    """The answer of a file.

    Raises
    ------
    ScoreError
        Where it has not the form that is asked for, or is of another problem.
    """
    springs = [column[2:] for column in problem.z_columns]
    named = problem.bodies, springs, list(problem.given["contacts"])
    history, names = read_motion(path, *named, first=f"# problem {problem.name}")
    accepted = columns_of(problem.bodies, springs)
    unknown = [n for n in names if n not in accepted and not n.startswith(IGNORED)]
    if unknown:
        raise ScoreError(
            f"{path}: unknown column {', '.join(unknown[:5])}; accepted: {', '.join(accepted[:12])}"
        )
    v, z = (None if x is None or np.isnan(x).any() else x for x in (history.v, history.z))
    history = replace(history, v=v, z=z)
    check(problem, history, str(path))
    return history


def columns_of(bodies: Sequence[str], springs: Sequence[str]) -> list[str]:
    """Columns of a history that are judged; t and u are needed."""
    return ["t", *(f"{k}.{b}" for k in "uv" for b in bodies), *(f"z.{s}" for s in springs)]


def read_motion(
    path: Path,
    bodies: Sequence[str],
    springs: Sequence[str],
    contacts: Sequence[str],
    *,
    first: str | None = None,
    called: Mapping[str, str] | None = None,
) -> tuple[Motion, list[str]]:
    """A motion from a CSV file, with the events of the file beside it.

    That is ``X.events.csv`` beside ``X.csv``, ``events.csv`` beside ``history.csv``.

    Parameters
    ----------
    path : Path
        The file.
    bodies, springs, contacts : sequence of str
        Names of all bodies, of the springs with a z, and of all contacts.
    first : str, optional
        What its first line must be, before that of the names.
    called : mapping of str to str, optional
        What columns are called there, by what we call them, or the numbers of columns.

    Returns
    -------
    Motion
        With columns of NaN for velocities and z that are not there, None where none is.
    list of str
        Names of all columns.

    Raises
    ------
    ScoreError
        Where it has not that form.
    """
    names, cells = _cells(path, first)
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ScoreError(f"{path}: column {', '.join(twice[:5])} is there more than once")
    places = {
        name: place_of(names, (called or {}).get(name, name))
        for name in columns_of(bodies, springs)
    }
    missing = [name for name, place in places.items() if name[0] in "tu" and place not in names]
    if missing:
        raise ScoreError(
            f"{path}: no column {', '.join(missing[:5])}; found {', '.join(names[:9])}; "
            f"accepted: {', '.join([*places][:12])}"
        )
    columns = {
        name: _numbers(path, place, cells[names.index(place)])
        for name, place in places.items()
        if place in names
    }
    t = columns["t"]
    back = np.flatnonzero(np.diff(t) < 0.0)
    if back.size:
        raise ScoreError(f"{path}: row {back[0] + 2}: t goes back; accepted: times in order")

    def together(kind: str, owners: Sequence[str]) -> Floats | None:
        keys = [f"{kind}.{owner}" for owner in owners]
        known = any(key in columns for key in keys)
        unknown = np.full(t.size, math.nan)
        return np.column_stack([columns.get(key, unknown) for key in keys]) if known else None

    u, v, z = together("u", bodies), together("v", bodies), together("z", springs)
    beside = "events.csv" if path.name == "history.csv" else f"{path.stem}.events.csv"
    return Motion(t, u, v, z, *_listed(path.with_name(beside), contacts)), names


def place_of(names: Sequence[str], place: str) -> str:
    """Name of the column that is called so, or has this number (from 1)."""
    numbered = place not in names and place.isdecimal() and 0 < int(place) <= len(names)
    return names[int(place) - 1] if numbered else place


def _cells(path: Path, first: str | None) -> tuple[list[str], list[tuple[str, ...]]]:
    """Names and columns of a CSV file, whose first line may be prescribed."""
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise ScoreError(f"{path}: cannot be read: {error}") from error
    if first is not None:
        found = " ".join(lines[0].split()) if lines else ""
        if found != first:
            other = found.removeprefix("# problem ") if found.startswith("# problem ") else ""
            said = f"is the answer to problem {other}" if other else f"begins with {found[:60]!r}"
            raise ScoreError(f"{path}: {said}; expected as its first line: {first}")
        rows = [row for row in csv.reader(lines[1:]) if row]
    else:
        rows = _rows_of_any(lines)
    if not rows or (len(rows) == 1 and first is not None):
        raise ScoreError(f"{path}: has no rows")
    names = [name.strip() for name in rows[0]]
    short = [i for i, row in enumerate(rows) if len(row) != len(names)]
    if short:
        line = short[0] + (1 if first is None else 2)
        raise ScoreError(f"{path}: line {line}: {len(rows[short[0]])} cells, not {len(names)}")
    return names, list(zip(*rows[1:], strict=True)) or [()] * len(names)


def _rows_of_any(lines: Sequence[str]) -> list[list[str]]:
    """Names and rows of another program, parted by what parts its last line.

    Where there are no names, as in the files of a recorder, the last comment may have them; else
    the numbers of the columns are their names.
    """
    comments = [line.lstrip()[1:] for line in lines if line.lstrip()[:1] in ("#", "%")]
    lines = [line for line in lines if line.strip() and line.lstrip()[0] not in "#%"]
    mark = next((mark for mark in ",;\t" if lines and mark in lines[-1]), None)

    def cells(lines: Sequence[str]) -> list[list[str]]:
        return (
            [line.split() for line in lines]
            if mark is None
            else [*csv.reader(lines, delimiter=mark)]
        )

    rows = cells(lines)
    if not rows or not all(map(_is_number, rows[0])):
        return rows
    named = cells(comments[-1:])
    if not named or len(named[0]) != len(rows[0]):
        named = [[str(i + 1) for i in range(len(rows[0]))]]
    return named + rows


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _numbers(path: Path, name: str, cells: tuple[str, ...], unknown: bool = False) -> Floats:
    """Numbers of a column; empty cells and ``nan`` are NaN where they may be `unknown`."""
    values = np.empty(len(cells))
    for i, cell in enumerate(cells):
        try:
            values[i] = float(cell)
        except ValueError:
            values[i] = math.nan
        if not math.isfinite(values[i]) and not (unknown and cell.strip().lower() in ("", "nan")):
            raise ScoreError(
                f"{path}: row {i + 1}, column {name}: found {cell.strip()[:30]!r}; "
                "accepted: a finite number"
            )
    return values


def _listed(path: Path, known_contacts: Sequence[str]) -> tuple[list[Event], frozenset[str]]:
    """Events of a file beside the answer, and which kinds it would list."""
    if not path.is_file():
        return [], frozenset()
    names, cells = _cells(path, None)
    missing = [name for name in ("t", "contact") if name not in names]
    if missing:
        raise ScoreError(f"{path}: no column {', '.join(missing)}; found {', '.join(names[:9])}")
    column = dict(zip(names, cells, strict=True))
    t = _numbers(path, "t", column["t"])
    contacts = _among(path, "contact", column["contact"], list(known_contacts))
    kinds = ("impact", *(kind for words in EVENTS.values() for kind in words), *UNJUDGED)
    numbers = _among(path, "kind", column.get("kind", ("impact",) * t.size), list(kinds))
    before, after = (
        _numbers(path, name, column[name], True) if name in names else np.full(t.size, math.nan)
        for name in ("gap_velocity_before", "gap_velocity_after")
    )
    rows = zip(numbers, t.tolist(), contacts, before.tolist(), after.tolist(), strict=True)
    known = {kinds[n] for n in (*numbers, *_among(path, "# kinds", _kinds_said(path), list(kinds)))}
    return (
        sorted((Event(kinds[n], *row) for n, *row in rows), key=lambda event: event.t),
        frozenset(["impact", *(key for key, words in EVENTS.items() if known & set(words))]),
    )


def _among(path: Path, name: str, cells: tuple[str, ...], accepted: list[str]) -> list[int]:
    """Positions of words among those that are accepted."""
    for cell in cells:
        if cell.strip() not in accepted:
            raise ScoreError(
                f"{path}: {name} {cell.strip()!r} is not known; accepted: {', '.join(accepted)}"
            )
    return [accepted.index(cell.strip()) for cell in cells]


def _kinds_said(path: Path) -> tuple[str, ...]:
    """Kinds of events that the first line says the program knows."""
    first, *_ = path.read_text(encoding="utf-8").splitlines() or [""]
    words = first.removeprefix("# kinds")
    return () if words == first else tuple(word.strip() for word in words.split(","))


def check(problem: Problem, history: Motion, path: str = "the answer") -> None:
    """Refuse a history that is not of the run asked for.

    Raises
    ------
    ScoreError
        Naming what is wrong.
    """
    t, given, slack = history.t, problem.given, SAME_TIME * problem.duration
    if abs(t[0] - given["start"]) > slack or abs(t[-1] - given["end"]) > slack:
        raise ScoreError(
            f"{path}: goes from t = {t[0]:.9g} to {t[-1]:.9g} s; "
            f"asked for: {given['start']:.9g} to {given['end']:.9g} s"
        )
    off = np.abs(history.u[0] - np.array(given["initial"]["u"]))
    if np.max(off) > START * problem.length:
        body = int(np.argmax(off))
        raise ScoreError(
            f"{path}: u.{problem.bodies[body]} begins at {history.u[0, body]:.9g} m, "
            f"the problem at {given['initial']['u'][body]:.9g} m: is it another problem's answer?"
        )
    moments = np.array(given["moments"])
    gone = moments[np.abs(t[nearest_rows(t, moments)] - moments) > slack]
    if gone.size:
        raise ScoreError(
            f"{path}: no row at t = {float(gone[0])!r} s and {gone.size - 1} more of the "
            f"{moments.size} stated moments ('moments' of problem.json)"
        )


def nearest_rows(t: Floats, moments: Floats) -> Floats:
    """Rows whose times are nearest to some moments."""
    right = np.clip(np.searchsorted(t, moments), 1, t.size - 1)
    return np.where(moments - t[right - 1] < t[right] - moments, right - 1, right)


def impacts_of(problem: Problem, motion: Motion) -> list[Event] | None:
    """Impacts of a motion, listed or read off its velocities; None where nobody knows."""
    if "impact" in motion.reported:
        return [event for event in motion.events if event.kind == "impact"]
    return read_off(problem, motion)


def read_off(problem: Problem, motion: Motion) -> list[Event] | None:
    """Impacts read off the velocities of a motion; None where it has none."""
    if motion.v is None:
        return None
    gaps, rates = problem.gaps(motion.u), problem.rates(motion.v)
    length = float(np.abs(motion.u).max(initial=0.0))
    found = [
        Event("impact", t, j, before, after)
        for j in range(gaps.shape[1])
        for t, before, after in turns(motion.t, gaps[:, j], rates[:, j], length)
    ]
    return sorted(found, key=lambda impact: impact.t)


def turns(t: Floats, gap: Floats, rate: Floats, length: float) -> list[tuple[float, float, float]]:
    """Time, closing and opening rate of the impacts of one contact, read off a sampled motion.

    An impact lies where the rate of the gap turns from closing to opening while the gap is
    closed: between two rows of one instant with a gap near zero, within a step in which the
    bodies get as far as each other, or, for a compliant contact, at the row at which g < 0 began.
    A gap that turns as a parabola and stays open is none.

    Parameters
    ----------
    t, gap, rate : ndarray, shape (n,)
        Times (s), gaps (m) and their rates (m/s).
    length : float
        Largest displacement (m).
    """
    slow = ROUND_GAP * float(np.abs(rate).max(initial=0.0))
    turning = np.flatnonzero((rate[:-1] < -slow) & (rate[1:] >= -slow))
    found: list[tuple[float, float, float]] = []
    last_entry = -1
    for k in turning.tolist():
        step = float(t[k + 1] - t[k])
        reach = step * max(abs(float(rate[k])), abs(float(rate[k + 1])))
        if min(gap[k], gap[k + 1]) > (CLOSED * length if step == 0.0 else reach):
            continue
        if step > 0.0 and _passes(t, gap, rate, k):
            continue
        entry, leaving = _in_contact(t, gap, rate, k, slow)
        if entry == last_entry:
            continue
        last_entry = entry
        late = max(float(gap[entry]), 0.0) / -float(rate[entry])
        begins = float(t[entry]) + min(late, float(t[entry + 1] - t[entry]))
        found.append((begins, float(rate[entry]), float(rate[leaving])))
    return found


def _passes(t: Floats, gap: Floats, rate: Floats, k: int) -> bool:
    """Whether an open gap turns after row k as a parabola does: a near miss, no impact.

    A parabola has the acceleration of the steps beside it. Rows alone of a method whose steps
    are parabolas would not tell an impact by anything else.
    """
    step, change = t[k + 1] - t[k], rate[k + 1] - rate[k]
    least = gap[k] - 0.5 * step * rate[k] ** 2 / change
    off = gap[k + 1] - gap[k] - 0.5 * step * (rate[k] + rate[k + 1])
    beside = [
        abs(rate[j + 1] - rate[j]) / (t[j + 1] - t[j])
        for j in (k - 1, k + 1)
        if 0 <= j < t.size - 1 and t[j + 1] > t[j]
    ]
    return bool(
        min(gap[k], gap[k + 1], least) > 0.0
        and abs(off) < SMOOTH * step * change
        and change / step < 2.0 * max(beside, default=0.0)
    )


def _in_contact(t: Floats, gap: Floats, rate: Floats, k: int, slow: float) -> tuple[int, int]:
    """Last row before and first row after the closed stretch around a turn after row k."""
    entry, leaving = k, k + 1
    if t[k + 1] == t[k]:
        return entry, leaving
    while entry > 0 and gap[entry] < 0.0 and rate[entry - 1] < -slow:
        entry -= 1
    while leaving + 1 < t.size and gap[leaving] < 0.0 and rate[leaving + 1] > slow:
        leaving += 1
    return entry, leaving
