"""Judge a program's history by the certified answer of a problem: NumPy and nothing else.

    python score.py PROBLEM ANSWER.csv [--json FILE] [--html FILE]

PROBLEM is a directory with ``problem.json`` and ``answer.json``. ANSWER begins with the line
``# problem NAME``; then a line of column names, ``t`` and ``u.<body>``, if known ``v.<body>``
and ``z.<spring>``; then rows from the start to the end of the run, one of them at each of the
stated moments. Two rows of one time are the state before and after a jump. Impacts are read off
the velocities, unless ``ANSWER.events.csv`` lists them (``t``, ``contact``; perhaps ``kind``,
``gap_velocity_before``). Kinds are impact, rest, detachment, separation and accumulation; who
knows kinds that may not occur says so in a first line ``# kinds impact, rest, detachment``.
Extremes are those of the cubics through u and v of the rows.

Judged are, each in parts of its scale,

    peaks       largest and smallest displacement of every body
    final       u, v and z at the end
    history     u at the stated moments
    impacts     their times; missed and extra ones
    events      the same of rests, of their ends and of accumulations, for programs that list them
    penetration the deepest overlap of a contact
    energy      whether any appears from nowhere, seen from the rows

A level is passed where every error is within level * scale + floor, the floor being the bound of
the answer and what rounding does to a well-made program in double precision, and where no
impact is missed or extra; what is found of other events decides no level. Exit code 0 where the
answer was judged, 2 where it cannot be.
"""

# Chapters, most of which stand on those before them:
#
#     the problem                     what is given, and the certified answer
#     the answer                      a program's files as a motion with events
#     impacts in the rows             where none are listed
#     which event is which            pairs of events of two runs
#     how far two motions are apart   distances of their graphs
#     the difference of two runs      numbers, events, motions
#     numbers of an answer            extremes, final values, stated moments, overlap
#     energy from nowhere
#     the card of an answer           what is found of it, and which levels that passes
#     a card in words
#     pages and drawings              HTML and SVG
#     the page of a card
#     programs on many problems       what the package says of many cards
#     the command

from __future__ import annotations

import argparse
import csv
import html
import json
import math
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

LEVELS = {"engineering": 1e-2, "research": 1e-4, "reference": 1e-8}
"""Parts of the scale that may be wrong."""
ROUNDING = 4.0 * 2.0**-52
"""Relative change of the inputs that a well-made program's rounding amounts to."""
SAME_TIME = 1e-9
"""Part of a run within which two times are one."""
START = 1e-6
"""Part of the largest motion by which a history may begin off the initial state."""
UNIT_OF_TIME = 0.05
"""Part of a run that shifts of impacts are measured in; none further apart are paired."""
LISTED, COUNTED = 1e-3, 1e-2
"""Weight above which an event is paired, and above which one without a partner counts."""
EVENTS = {
    "rest": ("rest",),
    "detachment": ("detachment", "separation"),
    "accumulation": ("accumulation",),
}
"""Events beside impacts as they are judged, and the kinds in a list: a rest has one end, however
its contact is opened."""
UNJUDGED = ("cut-impact",)
"""Kinds of events that a list may hold and that nobody is judged by."""
ALWAYS = (-math.inf, math.inf)
TINY = 1e-300
"""What is divided by instead of nothing."""
MOST_COSTS = 10**7
"""Pairs of times that are weighed at once; of more a smaller window is taken."""
CREATED = 1e-2
"""Part of the largest energy that may appear from nowhere, and of the largest ground acceleration
that the rows may not show."""
ROUND_GAP, CLOSED = 1e-9, 1e-6
"""Part of the largest rate below which a gap does not close; of the largest displacement by which
a gap at a double row may be off zero."""
KEYS = {
    "problem.json": "problem tests start end moments bodies contacts M C B W springs gaps "
    "restitutions initial motion",
    "answer.json": "quantities event_columns events",
}
"""What the two files of a problem must have."""
SMOOTH = 1e-3
"""Part of the change of a gap's rate by which the gap may leave a parabola; an impact between two
rows leaves it by up to a half."""
IGNORED = ("a_g", "a.", "force.", "gap.", "lambda.")
"""Columns that an answer may have, too."""

Floats = Any
"""An array of doubles."""


class ScoreError(Exception):
    """An answer cannot be judged; the message says why."""


# ---------------------------------------------------------------- the problem


@dataclass(frozen=True)
class Problem:
    """A problem and its answer, as in ``problem.json`` and ``answer.json``."""

    given: dict[str, Any]
    answer: dict[str, Any]

    @property
    def name(self) -> str:
        """What the set calls it."""
        return str(self.given["problem"])

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies."""
        return list(self.given["bodies"])

    @property
    def hysteretic(self) -> list[int]:
        """Positions of the springs with a z."""
        return [s for s, q in enumerate(self.given["springs"]["strength"]) if q != 0.0]

    @property
    def z_columns(self) -> list[str]:
        """Columns of the hysteretic variables."""
        return [f"z.{self.given['springs']['names'][s]}" for s in self.hysteretic]

    @property
    def duration(self) -> float:
        """Length of the run (s)."""
        return float(self.given["end"] - self.given["start"])

    @property
    def length(self) -> float:
        """Largest displacement (m)."""
        return max(row[4] for row in self.answer["quantities"] if row[0].endswith((".max", ".min")))

    @property
    def truth(self) -> Truth:
        """The answer."""
        contacts = list(self.given["contacts"])
        rows = (
            dict(zip(self.answer["event_columns"], row, strict=True))
            for row in self.answer["events"]
        )
        return Truth(
            [
                ScaledValue(name, value, scale, _unit(name), bound, amplification or 0.0)
                for name, value, bound, amplification, scale in self.answer["quantities"]
            ],
            [
                Event(e["kind"], e["t"], contacts.index(e["contact"]), e["before"],
                      math.nan if e["after"] is None else e["after"], e["t_bound"])
                for e in rows
            ],
            UNIT_OF_TIME * self.duration,
            (self.given["start"], self.given["end"]),
        )  # fmt: skip

    def array(self, key: str) -> Floats:
        """A matrix or vector of the problem."""
        return np.array(self.given[key], dtype=float)

    @property
    def directions(self) -> Floats:
        """B, whose columns make elongations of displacements, shape (N, springs)."""
        return self.array("B").reshape(len(self.bodies), -1)

    def gaps(self, u: Floats) -> Floats:
        """Gaps for displacements of shape (n, N): shape (n, contacts)."""
        return self.array("gaps") + u @ self.array("W").reshape(len(self.bodies), -1)

    def rates(self, v: Floats) -> Floats:
        """Their rates for velocities of shape (n, N)."""
        return v @ self.array("W").reshape(len(self.bodies), -1)

    def ground(self, t: Floats) -> Floats:
        """Ground acceleration (m/s^2) at times of shape (n,); after a jump at its time."""
        a_g = np.zeros(t.shape)
        for piece in self.given["motion"]:
            inside = (t >= piece["start"]) & (t < piece["end"])
            s = t[inside] - piece["origin"]
            if "sinusoids" in piece:
                a_g[inside] = sum(a * np.cos(w * s + p) for a, w, p in piece["sinusoids"])
            elif "gaussian" in piece:
                q, *c = piece["gaussian"]
                a_g[inside] = np.polyval(c[::-1], s) * np.exp(-q * s * s)
            else:
                samples = np.array(piece["samples"])
                a_g[inside] = np.interp(s, piece["dt"] * np.arange(samples.size), samples)
        return a_g


def _unit(name: str) -> str:
    """Of a quantity, by its name."""
    key = name.rpartition(".")[2]
    of_state = {"v": "m/s", "z": ""} if name.startswith("final.") else {}
    return "s" if key in ("t_max", "t_min") else of_state.get(key, "m")


def read_problem(folder: Path) -> Problem:
    """The problem of a directory.

    Raises
    ------
    ScoreError
        Where it has none.
    """
    content = []
    for name, needed in KEYS.items():
        try:
            found = json.loads((folder / name).read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise ScoreError(f"{folder / name}: cannot be read: {error}") from error
        missing = [key for key in needed.split() if key not in found]
        if missing:
            raise ScoreError(f"{folder / name}: has no {', '.join(missing)}")
        content.append(found)
    return Problem(content[0], content[1])


# ---------------------------------------------------------------- the answer


@dataclass(frozen=True, slots=True)
class Event:
    """What happens at a contact.

    Parameters
    ----------
    kind : str
        "impact", or one of those in `EVENTS`.
    t : float
        Time (s).
    contact : int
        Position of the contact.
    gap_velocity_before, gap_velocity_after : float
        Rate of the gap (m/s), negative when closing; NaN where it is not known.
    bound : float or None
        That of the time (s), None where it has none.
    """

    kind: str
    t: float
    contact: int
    gap_velocity_before: float = math.nan
    gap_velocity_after: float = math.nan
    bound: float | None = None


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
        What columns are called there, by what we call them.

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
    places = {name: (called or {}).get(name, name) for name in columns_of(bodies, springs)}
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
        lines = lines[1:]
    elif lines and lines[0].startswith("# kinds"):
        lines = lines[1:]
    rows = [row for row in csv.reader(lines) if row]
    if not rows or (len(rows) == 1 and first is not None):
        raise ScoreError(f"{path}: has no rows")
    names = [name.strip() for name in rows[0]]
    short = [i for i, row in enumerate(rows) if len(row) != len(names)]
    if short:
        line = short[0] + (1 if first is None else 2)
        raise ScoreError(f"{path}: line {line}: {len(rows[short[0]])} cells, not {len(names)}")
    return names, list(zip(*rows[1:], strict=True)) or [()] * len(names)


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
    gone = moments[np.abs(t[_nearest(t, moments)] - moments) > slack]
    if gone.size:
        raise ScoreError(
            f"{path}: no row at t = {float(gone[0])!r} s and {gone.size - 1} more of the "
            f"{moments.size} stated moments ('moments' of problem.json)"
        )


def _nearest(t: Floats, moments: Floats) -> Floats:
    """Rows whose times are nearest to some moments."""
    right = np.clip(np.searchsorted(t, moments), 1, t.size - 1)
    return np.where(moments - t[right - 1] < t[right] - moments, right - 1, right)


# ---------------------------------------------------------------- impacts in the rows


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


# ---------------------------------------------------------------- which event is which


@dataclass(frozen=True, slots=True)
class Pair:
    """An event of the reference, of a run, or of both.

    Parameters
    ----------
    kind : str
        "impact" or a key of `EVENTS`.
    reference, found : Event or None
        The two (`Event`, or any with its attributes); None where there is none.
    weight : float
        Of the reference's, where it is there.
    """

    kind: str
    reference: Any
    found: Any
    weight: float

    @property
    def contact(self) -> int:
        """Position of the contact."""
        return int((self.reference or self.found).contact)

    @property
    def t(self) -> float:
        """When (s), in the reference where it is there."""
        return float((self.reference or self.found).t)

    @property
    def shift(self) -> float:
        """How much later the run has it (s); NaN without a partner."""
        both = self.reference is not None and self.found is not None
        return self.found.t - self.reference.t if both else math.nan


@dataclass(frozen=True, slots=True)
class Paired:
    """Events of two runs.

    Parameters
    ----------
    pairs : tuple of Pair
        In order of time; those too slight to count without a partner, too.
    counted : float
        Weight above which one without a partner counts.
    """

    pairs: tuple[Pair, ...] = ()
    counted: float = COUNTED

    def of(self, *kinds: str) -> Paired:
        """Those of some kinds."""
        return replace(self, pairs=tuple(pair for pair in self.pairs if pair.kind in kinds))

    @property
    def listed(self) -> tuple[Pair, ...]:
        """Those with a partner, and those that count without."""
        return tuple(p for p in self.pairs if p.weight > self.counted or not math.isnan(p.shift))

    @property
    def alone(self) -> tuple[Pair, ...]:
        """Those that count without a partner, and have none."""
        return tuple(p for p in self.pairs if p.weight > self.counted and math.isnan(p.shift))

    @property
    def expected(self) -> int:
        """Number of those of the reference."""
        return sum(pair.reference is not None for pair in self.pairs)

    @property
    def matched(self) -> int:
        """Number of those that both have."""
        return sum(not math.isnan(pair.shift) for pair in self.pairs)

    @property
    def missed(self) -> int:
        """Number of those that count and that the run lacks."""
        return sum(pair.found is None for pair in self.listed)

    @property
    def extra(self) -> int:
        """Number of those that count and that the reference lacks."""
        return sum(pair.reference is None for pair in self.listed)

    @property
    def largest_shift(self) -> float:
        """Largest difference in time of two that are paired (s); NaN without a pair."""
        shifts = [abs(pair.shift) for pair in self.pairs if not math.isnan(pair.shift)]
        return max(shifts, default=math.nan)


Weigh = Callable[
    [str, Sequence[Any], float, float, tuple[float, float]], Iterator[tuple[Any, float]]
]
"""Events of a kind, and how far each is from being none, see `weighed`."""


@dataclass(frozen=True)
class Weights:
    """Which events are paired, and which of them count where they have no partner.

    Parameters
    ----------
    weigh : callable
        Events of a kind with the weight of each.
    bands : tuple of tuple of float
        Weights above and up to which events are paired, one band after the other.
    counted : float
        Weight above which an event without a partner counts.
    """

    weigh: Weigh
    bands: tuple[tuple[float, float], ...]
    counted: float


def pair_events(
    reference: Sequence[Any],
    found: Sequence[Any],
    unit: float,
    kinds: Sequence[str] = ("impact",),
    *,
    speed: float = 0.0,
    covered: tuple[float, float] = ALWAYS,
    weights: Weights | None = None,
) -> Paired:
    """Pair events of two runs, kind by kind and contact by contact.

    Slight events need care: an accumulation has infinitely many impacts, and a looser tolerance
    moves one across any threshold, as it makes and unmakes short rests. So each has a weight. All
    above one are paired by `pair_times`; one left without a partner counts above another. Without
    others these are `LISTED` and `COUNTED`, and the weight of an impact is its closing speed as
    part of the reference's largest, infinite where it is not known; that of a rest and its end how
    long it lasts as part of the unit, infinite for an end without a beginning. What lists the soft
    impacts at a contact that stays closed (closing speed 0) is the limit of none.

    Parameters
    ----------
    reference, found : sequence of Event
        In order of time; anything with the attributes of an `Event`.
    unit : float
        Largest shift of a pair, and unit of the lengths of rests (s).
    kinds : sequence of str
        "impact" and keys of `EVENTS`.
    speed : float
        Closing speed (m/s) that weights refer to where the reference has no impact.
    covered : tuple of float
        Stretch of time (s) that both runs cover.
    weights : Weights, optional
        Others.
    """
    rule = weights or Weights(weighed, ((LISTED, math.inf),), COUNTED)
    hits = [e for e in reference if e.kind == "impact" and covered[0] <= e.t <= covered[1]]
    fastest = max(map(_closing_speed, hits), default=speed) or TINY
    pairs: list[Pair] = []
    for kind in kinds:
        both = [
            list(rule.weigh(kind, events, unit, fastest, covered)) for events in (reference, found)
        ]
        for contact in sorted({event.contact for side in both for event, _ in side}):
            a, b = ([row for row in side if row[0].contact == contact] for side in both)
            for band in rule.bands:
                a, b, paired = _pair_within(band, a, b, unit)
                pairs += [Pair(kind, x, y, weight) for x, y, weight in paired]
            least = rule.bands[-1][0]
            a, b = ([row for row in side if row[1] > least] for side in (a, b))
            pairs += [Pair(kind, event, None, weight) for event, weight in a]
            pairs += [Pair(kind, None, event, weight) for event, weight in b]
    return Paired(tuple(sorted(pairs, key=lambda pair: pair.t)), rule.counted)


_Weighed = list[tuple[Any, float]]


def _pair_within(
    band: tuple[float, float], a: _Weighed, b: _Weighed, window: float
) -> tuple[_Weighed, _Weighed, list[tuple[Any, Any, float]]]:
    """What remains of two lists, and the pairs of some weights, with the first one's."""
    low, high = band
    i, k = ([n for n, row in enumerate(side) if low < row[1] <= high] for side in (a, b))
    t, s = (np.array([x[n][0].t for n in rows], dtype=float) for x, rows in ((a, i), (b, k)))
    both = [(i[m], k[n]) for m, n in pair_times(t, s, window)]
    gone = [{pair[side] for pair in both} for side in (0, 1)]
    left, right = (
        [row for n, row in enumerate(side) if n not in paired]
        for side, paired in zip((a, b), gone, strict=True)
    )
    return left, right, [(a[m][0], b[n][0], a[m][1]) for m, n in both]


def weighed(
    kind: str, events: Sequence[Any], unit: float, fastest: float, covered: tuple[float, float]
) -> Iterator[tuple[Any, float]]:
    """Events of a kind, and the weight of each, contact by contact in order of time."""
    first, end = covered
    if kind in ("rest", "detachment"):
        for began, ended in rests_of(events):
            if not first <= (began or ended).t <= end:
                continue
            inside = ended if ended is not None and ended.t <= end else None
            event = began if kind == "rest" else inside
            if event is not None:
                lasts = math.inf if began is None else (inside.t if inside else end) - began.t
                yield event, lasts / unit
        return
    for event in events:
        if event.kind == kind and first <= event.t <= end:
            if kind == "impact":
                yield event, _closing_speed(event) / fastest
            elif event.gap_velocity_before != 0.0:
                yield event, math.inf


def _closing_speed(event: Any) -> float:
    """Closing speed (m/s); where a program does not say it, it counts as fast."""
    before = -event.gap_velocity_before
    return math.inf if math.isnan(before) else before


def rests_of(events: Sequence[Any]) -> list[tuple[Any, Any]]:
    """First and last event of each rest; None for a beginning or an end that is not listed."""
    since: dict[int, Any] = {}
    found = []
    for event in events:
        if event.kind == "rest":
            since.setdefault(event.contact, event)
        elif event.kind in EVENTS["detachment"]:
            found.append((since.pop(event.contact, None), event))
    return found + [(began, None) for began in since.values()]


def pair_times(reference: Floats, found: Floats, window: float) -> list[tuple[int, int]]:
    """Pair the times of two sequences that do not decrease.

    Of all pairings that keep the order and pair no two times further apart than the window w,
    the one with the least sum of shifts and w/2 for each unpaired time, by dynamic programming
    (Needleman and Wunsch 1970).

    Parameters
    ----------
    reference, found : ndarray, shape (n,), (m,)
        Times (s).
    window : float
        w (s), positive.
    """
    if reference.size == found.size and np.abs(reference - found).sum() <= window:
        # Anything else leaves one of each alone.
        return [(i, i) for i in range(found.size)]
    pairs = []
    every = np.sort(np.concatenate((reference, found)))
    starts = every[np.flatnonzero(np.diff(every, prepend=-np.inf) > window)]
    a, b = (np.append(np.searchsorted(x, starts), x.size) for x in (reference, found))
    for i in range(starts.size):
        # Stretches between which nothing can be paired.
        x, y = reference[a[i] : a[i + 1]], found[b[i] : b[i + 1]]
        if x.size * y.size > MOST_COSTS and window > np.finfo(float).eps * y[-1]:
            near = pair_times(x, y, 0.1 * window)
        else:
            near = _cheapest(np.abs(x[:, None] - y), window)
        pairs += [(int(a[i]) + j, int(b[i]) + k) for j, k in near]
    return pairs


def _cheapest(shifts: Floats, window: float) -> list[tuple[int, int]]:
    """Pairs of least cost for the shifts of all pairs, shape (n, m)."""
    cost = _costs(shifts, window)
    i, j = shifts.shape
    pairs = []
    while i > 0 and j > 0:
        together = cost[i - 1, j - 1] + shifts[i - 1, j - 1]
        if together <= min(cost[i - 1, j], cost[i, j - 1]) + 0.5 * window:
            pairs.append((i - 1, j - 1))
            i, j = i - 1, j - 1
        elif cost[i - 1, j] <= cost[i, j - 1]:
            i -= 1
        else:
            j -= 1
    return pairs[::-1]


def _costs(shifts: Floats, window: float) -> Floats:
    """Least cost of pairing the first i with the first j times, shape (n + 1, m + 1).

    ``c_ij = min(c_(i-1)(j-1) + shift, c_(i-1)j + w/2, c_i(j-1) + w/2)``; a shift above w
    never pays. Row by row, the last alternative is a running minimum.
    """
    alone = 0.5 * window
    n, m = shifts.shape
    steps = alone * np.arange(m + 1)
    cost = np.empty((n + 1, m + 1))
    cost[0] = steps
    for i in range(1, n + 1):
        best = cost[i - 1] + alone
        best[1:] = np.minimum(best[1:], cost[i - 1, :-1] + shifts[i - 1])
        cost[i] = np.minimum.accumulate(best - steps) + steps
    return cost


# ---------------------------------------------------------------- how far two motions are apart


@dataclass(frozen=True, slots=True)
class MotionScales:
    """What differences of a motion are divided by; N bodies, H hysteretic springs.

    Parameters
    ----------
    time : float
        T (s).
    u, v : ndarray, shape (N,)
        Largest displacement U (m) and speed V (m/s) of each body.
    z : ndarray, shape (H,)
        Bound Z of each hysteretic variable.
    """

    time: float
    u: Floats
    v: Floats
    z: Floats


@dataclass(frozen=True, slots=True)
class Distance:
    """Distances of two motions, in parts of their scales.

    Parameters
    ----------
    graph : float
        Hausdorff distance of the completed graphs.
    graph_time : float
        Where it is attained (s).
    sup : float
        Largest difference at one time.
    """

    graph: float
    graph_time: float
    sup: float


def distance(first: Any, second: Any, scales: MotionScales) -> Distance:
    """Distances of two motions over the stretch of time that both cover.

    The completed graph of a body's motion is the curve of its points (t/T, u/U, v/V), with those
    before and after a jump of v joined by a line; that of a hysteretic spring is (t/T, z/Z). The
    graph distance is the largest, over bodies and springs, of the Hausdorff distances of these
    curves A and B,

        d = max( sup_{p in A} inf_{q in B} |p - q|,  sup_{q in B} inf_{p in A} |p - q| ),

    with the suprema over the rows. A jump of any size that comes δ later is worth δ/T; the sup
    norm of the difference calls it the whole jump. Bodies are taken one by one, since two impacts
    that swap places within δ would otherwise be far apart. Alt and Godau (1995) for distances of
    polygonal curves; Moreau (1978) for completed graphs of motions with jumps of velocity.

    Parameters
    ----------
    first, second : Motion
        Or anything with its t, u, v, z, at least one row each; columns with a NaN, as velocities
        that a program did not write, are left out.
    scales : MotionScales
        What differences are divided by.
    """
    end = min(first.t[-1], second.t[-1])
    a, b = (
        [x[: int(np.searchsorted(m.t, end, side="right"))] for x in (m.t, m.u, m.v, m.z)]
        for m in (first, second)
    )
    bodies, springs = range(scales.u.size), range(scales.z.size)
    curves = [([(1, scales.u[i]), (2, scales.v[i])], i) for i in bodies]
    curves += [([(3, scales.z[i])], i) for i in springs]
    graph, at, sup = 0.0, float(a[0][0]), 0.0
    for parts, i in curves:
        columns = [(a[k][:, i] / size, b[k][:, i] / size) for k, size in parts]
        known = [pair for pair in columns if not np.isnan(np.concatenate(pair)).any()]
        left = np.column_stack([a[0] / scales.time, *(pair[0] for pair in known)])
        right = np.column_stack([b[0] / scales.time, *(pair[1] for pair in known)])
        for one, other in ((left, right), (right, left)):
            far, vertex = furthest_vertex(one, other)
            if far > graph:
                graph, at = far, float(one[vertex, 0] * scales.time)
        sup = max(sup, _largest_difference(left, right))
    return Distance(graph, at, sup)


def _largest_difference(a: Floats, b: Floats) -> float:
    """Sup norm over both sides of every row of either curve."""
    t = np.union1d(a[:, 0], b[:, 0])
    largest = 0.0
    for before in (True, False):
        for column in range(1, a.shape[1]):
            values = [one_sided(t, curve[:, 0], curve[:, column], before) for curve in (a, b)]
            largest = max(largest, float(np.abs(values[0] - values[1]).max()))
    return largest


def one_sided(t: Floats, times: Floats, values: Floats, before: bool) -> Floats:
    """Values between rows, linear; at a time that has several rows, before or after the jump.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Where (s).
    times, values : ndarray, shape (m,)
        The rows; times never decrease.
    before : bool
        Whether a jump is looked at from before it.

    Returns
    -------
    ndarray, shape (n,)
        Constant beyond the rows.
    """
    following = np.searchsorted(times, t, side="left" if before else "right")
    right = np.clip(following, 0, times.size - 1)
    left = np.clip(following - 1, 0, times.size - 1)
    width = times[right] - times[left]
    part = np.where(width > 0.0, (t - times[left]) / np.where(width > 0.0, width, 1.0), 0.0)
    part = np.clip(part, 0.0, 1.0)
    return np.asarray(values[left] + part * (values[right] - values[left]))


def furthest_vertex(points: Floats, curve: Floats) -> tuple[float, int]:
    """Largest distance of the vertices of a polyline from another, and the first that has it.

        sup_i  min_k  min_{0 <= s <= 1} | p_i - q_k - s (q_(k+1) - q_k) |

    The distance from the segment at the same first coordinate is an upper bound, and no segment
    further along than it comes nearer; so the vertices are taken from the largest bound on, until
    no bound exceeds what was found.

    Parameters
    ----------
    points, curve : ndarray, shape (n, d), (m, d)
        Vertices, n, m >= 1; the first coordinate never decreases in either.
    """
    beside = np.searchsorted(curve[:, 0], points[:, 0], side="right") - 1
    near = _from_segments(points.T, curve, np.maximum(beside, 0))
    order = np.argsort(-near, kind="stable")
    worst, vertex = -1.0, 0
    for n in range(0, order.size, 64):
        rows = order[n : n + 64]
        if near[rows[0]] < worst:
            break
        # Each vertex with the segments of its own that may be nearer than its bound.
        low, high = (points[rows, 0] + side * near[rows] for side in (-1.0, 1.0))
        start = np.maximum(np.searchsorted(curve[:, 0], low) - 1, 0)
        count = np.maximum(np.searchsorted(curve[:, 0], high, side="right") - start, 1)
        begins = np.cumsum(count) - count
        segments = np.arange(count.sum()) + np.repeat(start - begins, count)
        apart = _from_segments(points[np.repeat(rows, count)].T, curve, segments)
        far = np.minimum.reduceat(apart, begins)
        first = int(rows[far == far.max()].min())
        if far.max() > worst or (far.max() == worst and first < vertex):
            worst, vertex = float(far.max()), first
    return worst, vertex


def _from_segments(points: Floats, curve: Floats, k: Floats) -> Floats:
    """Distances of points, shape (d, ...), from segments k; the last one is its vertex."""
    start, step = curve[k].T, (curve[np.minimum(k + 1, curve.shape[0] - 1)] - curve[k]).T
    along = length = total = np.zeros(1)
    for p, q, h in zip(points, start, step, strict=True):
        along, length = along + (p - q) * h, length + h * h
    s = np.clip(along / np.where(length > 0.0, length, 1.0), 0.0, 1.0)
    for p, q, h in zip(points, start, step, strict=True):
        total = total + (p - q - s * h) ** 2
    return np.sqrt(total)


# ---------------------------------------------------------------- the difference of two runs


@dataclass(frozen=True, slots=True)
class ScaledValue:
    """A number of a run.

    Parameters
    ----------
    name : str
        As in ``summary.json``, ``peaks.deck1.max``.
    value : float
        In its unit.
    scale : float
        What its error is divided by and its digits are counted from, in its unit.
    unit : str
        SI; empty for a pure number.
    bound : float
        How far the value itself may be off, in its unit; NaN where nobody knows.
    amplification : float
        Change, in parts of the scale, for a relative change of the inputs.
    """

    name: str
    value: float
    scale: float
    unit: str = ""
    bound: float = math.nan
    amplification: float = 0.0


@dataclass(frozen=True, slots=True)
class Deviation:
    """A quantity of the reference beside its value in a run."""

    quantity: ScaledValue
    value: float

    @property
    def error(self) -> float:
        """Distance of the two in parts of the scale; NaN where there is no value."""
        return abs(self.value - self.quantity.value) / self.quantity.scale

    @property
    def floor(self) -> float:
        """What the reference leaves open and rounding does to a well-made program, likewise."""
        quantity = self.quantity
        return quantity.bound / quantity.scale + ROUNDING * quantity.amplification


@dataclass(frozen=True)
class Truth:
    """What a run is held against.

    Parameters
    ----------
    quantities : sequence of ScaledValue
        Its numbers.
    events : sequence of Event
        In order of time.
    unit : float
        Of shifts and lengths of rests (s), see `pair_events`.
    covered : tuple of float
        Stretch of time (s).
    scales : MotionScales or None
        What differences of the motions are divided by, where they are compared.
    weights : Weights or None
        Which events are paired and count, where not those of `pair_events`.
    of_events : tuple of str
        Attributes of events that are quantities, ``events.<row>.<attribute>``.
    """

    quantities: Sequence[ScaledValue]
    events: Sequence[Any]
    unit: float
    covered: tuple[float, float] = ALWAYS
    scales: MotionScales | None = None
    weights: Weights | None = None
    of_events: tuple[str, ...] = ()


@dataclass(frozen=True)
class Difference:
    """How far a run is from another.

    Parameters
    ----------
    quantities : tuple of Deviation
        Those that both have.
    events : Paired
        Of the kinds that the run reports.
    kinds : tuple of str
        These kinds.
    distance : Distance
        Of the motions; NaN where they were not given.
    """

    quantities: tuple[Deviation, ...]
    events: Paired
    kinds: tuple[str, ...]
    distance: Distance

    @property
    def impacts(self) -> Paired:
        """Impacts of both."""
        return self.events.of("impact")

    @property
    def rests(self) -> Paired | None:
        """Beginnings and ends of rests; None where the run does not say."""
        return self.events.of("rest", "detachment") if "rest" in self.kinds else None

    def largest(self, part: str) -> float:
        """The error of `worst`; NaN where none is known."""
        worst = self.worst(part)
        return math.nan if worst is None else worst.error

    def worst(self, part: str) -> Deviation | None:
        """The largest error of ``"peaks"``, ``"final"`` or ``"history"``, times left out."""
        known = [
            q for q in self.quantities
            if q.quantity.name.startswith(part) and ".t_" not in q.quantity.name
            and not math.isnan(q.error)
        ]  # fmt: skip
        return max(known, key=lambda q: q.error, default=None)


def difference(
    truth: Truth,
    values: Mapping[str, float],
    events: Sequence[Any],
    kinds: Sequence[str] = ("impact", *EVENTS),
    *,
    end: float = math.inf,
    motions: tuple[Any, Any] | None = None,
) -> Difference:
    """How far a run is from what it is held against.

    Parameters
    ----------
    truth : Truth
        The reference.
    values : mapping of str to float
        Numbers of the run by name; NaN for what it does not know.
    events : sequence of Event
        Its events, in order of time.
    kinds : sequence of str
        What of them is paired.
    end : float
        Where the run ends (s), if that is earlier.
    motions : tuple of Motion, optional
        The motion of the reference and that of the run.
    """
    scales = truth.scales
    covered = truth.covered[0], min(truth.covered[1], end)
    speed = 0.0 if scales is None else float(scales.v.max())
    paired = pair_events(
        truth.events, events, truth.unit, kinds,
        speed=speed, covered=covered, weights=truth.weights,
    )  # fmt: skip
    row = {id(event): i for i, event in enumerate(truth.events)}
    known = {
        **values,
        **{
            f"events.{row[id(p.reference)]}.{key}": getattr(p.found, key)
            for p in paired.pairs
            if not math.isnan(p.shift)
            for key in truth.of_events
        },
    }
    return Difference(
        tuple(Deviation(q, known[q.name]) for q in truth.quantities if q.name in known),
        paired,
        tuple(kinds),
        distance(*motions, scales)
        if motions is not None and scales is not None
        else Distance(math.nan, math.nan, math.nan),
    )


# ---------------------------------------------------------------- numbers of an answer


def _values(
    problem: Problem, history: Motion, crests: _Crests
) -> tuple[dict[str, float], list[str]]:
    """Numbers of a history by their names in the answer, and what it cannot say."""
    values: dict[str, float] = {}
    left_out = []
    scale = {row[0]: row[4] for row in problem.answer["quantities"]}
    coarse = []
    for i, body in enumerate(problem.bodies):
        size = scale.get(f"peaks.{body}.max", scale.get(f"peaks.{body}.min", problem.length))
        if crests.beyond[i] > LEVELS["engineering"] * size:
            coarse.append(body)
            continue
        extremes = crests.highest, crests.lowest, *crests.when
        for key, of_bodies in zip(("max", "min", "t_max", "t_min"), extremes, strict=True):
            values[f"peaks.{body}.{key}"] = float(of_bodies[i])
    if coarse:
        left_out.append(
            f"peaks of {', '.join(coarse[:5])}: the rows are too far apart to tell them; "
            "judged are the final values, the history at the stated moments and, with velocities, "
            "the impacts"
        )
    for i, body in enumerate(problem.bodies):
        values[f"final.{body}.u"] = float(history.u[-1, i])
        if history.v is not None:
            values[f"final.{body}.v"] = float(history.v[-1, i])
    if history.v is None:
        left_out.append("final velocities: there are no columns v.<body>")
    for k, column in enumerate(problem.z_columns):
        if history.z is not None:
            values[f"final.{column[2:]}.z"] = float(history.z[-1, k])
    if problem.z_columns and history.z is None:
        left_out.append(f"hysteretic variables: there are no columns {problem.z_columns[0]} ...")
    moments = np.array(problem.given["moments"])
    for k, row in enumerate(_nearest(history.t, moments)):
        for i, body in enumerate(problem.bodies):
            values[f"history.{k}.{body}"] = float(history.u[row, i])
    return values, left_out


@dataclass(frozen=True)
class _Crests:
    """Extremes of every body, shape (N,), and by how much rows alone miss them (m)."""

    highest: Floats
    lowest: Floats
    when: tuple[Floats, Floats]
    beyond: Floats


def _crests(history: Motion, impacts: list[Event] | None) -> _Crests:
    """Extremes of the rows and of the cubics between them, but where an impact lies between."""
    t, u, v = history.t, history.u, history.v
    high, low = np.argmax(u, axis=0), np.argmin(u, axis=0)
    columns = np.arange(u.shape[1])
    highest, lowest = u[high, columns].copy(), u[low, columns].copy()
    when = (t[high].copy(), t[low].copy())
    beyond = np.zeros(u.shape[1])
    if v is None:
        for i in columns:
            beyond[i] = max(_sag(t, u[:, i], int(high[i])), _sag(t, u[:, i], int(low[i])))
        return _Crests(highest, lowest, when, beyond)
    h = np.diff(t)
    struck = _struck(t, impacts)
    for i in columns:
        turning = np.flatnonzero((h > 0.0) & ~struck & (v[:-1, i] * v[1:, i] < 0.0))
        for k in turning:
            s, value = _crest(h[k], u[k, i], u[k + 1, i], v[k, i], v[k + 1, i])
            up = v[k, i] > 0.0
            best = highest if up else lowest
            if value > best[i] if up else value < best[i]:
                beyond[i] = max(beyond[i], abs(value - u[[k, k + 1], i]).max())
                best[i], when[0 if up else 1][i] = value, t[k] + s * h[k]
    # A row lies below a crest by θ²/8 of it at least, on one side; the cubic errs by θ⁴/384.
    size = np.maximum(np.abs(highest), np.abs(lowest))
    beyond = beyond**2 / (6.0 * np.where(size > 0.0, size, 1.0))
    return _Crests(highest, lowest, when, beyond)


def _struck(t: Floats, impacts: list[Event] | None) -> Floats:
    """Intervals between rows, shape (n - 1,), in or beside which an impact lies."""
    struck = np.zeros(t.size - 1, dtype=bool)
    for impact in impacts or []:
        at = int(np.searchsorted(t, impact.t, side="right")) - 1
        struck[max(at - 1, 0) : at + 2] = True
    return struck


def _crest(h: float, u0: float, u1: float, v0: float, v1: float) -> tuple[float, float]:
    """Where, in parts of the step h, and how high the cubic turns whose ends move against."""
    d = (u1 - u0) / h
    c2, c3 = h * (3.0 * d - 2.0 * v0 - v1), h * (v0 + v1 - 2.0 * d)
    # h v0 + 2 c2 s + 3 c3 s^2 = 0, the root between 0 and 1, without cancellation
    root = math.sqrt(max(c2 * c2 - 3.0 * c3 * h * v0, 0.0))
    q = -(c2 + math.copysign(root, c2))
    roots = [q / (3.0 * c3) if c3 else math.inf, h * v0 / q if q else math.inf]
    s = min((r for r in roots if 0.0 <= r <= 1.0), default=0.5)
    return s, u0 + s * (h * v0 + s * (c2 + s * c3))


def _sag(t: Floats, u: Floats, k: int) -> float:
    """What a crest beside a row may exceed it by (m): θ²/8 of it, by how far its neighbours lie."""
    sides = [abs(u[k] - u[j]) for j in (k - 1, k + 1) if 0 <= j < u.size and t[j] != t[k]]
    return float(sum(sides)) / 8.0


# ---------------------------------------------------------------- energy from nowhere


def _created_energy(
    problem: Problem, history: Motion, impacts: list[Event] | None
) -> tuple[float | None, str]:
    """The largest rise of kinetic and elastic energy less all work done, part of its largest.

    Rows with an overlap are left out, where a contact element may hold energy of its own, and
    those beside an impact, where a program may write a velocity between the two; and it is looked
    at anew where the ground does between two rows what they do not show.
    """
    t, u, v = history.t, history.u, history.v
    springs = problem.given["springs"]
    if v is None:
        return None, "there are no velocities"
    if any(springs["strength"]) and history.z is None:
        return None, "there are no hysteretic variables"
    x = u @ problem.directions - np.array(springs["offset"])
    k = np.where(x < 0.0, springs["compression"], springs["extension"])
    stored = 0.5 * (v * v) @ problem.array("M") + 0.5 * (k * x * x).sum(axis=1)
    done, unsure = _work(problem, history, v)
    apart = (problem.gaps(u) >= -CLOSED * problem.length).all(axis=1)
    struck = _struck(t, impacts)
    apart[:-1] &= ~struck
    apart[1:] &= ~struck
    most = float(stored.max()) or 1.0
    if not apart.any():
        return None, "impacts or overlaps in every row"
    if unsure[-1] > most:
        return None, "the rows are too far apart"
    kept = (stored + done - unsure)[apart]
    parts = np.split(kept, np.searchsorted(np.flatnonzero(apart), _unseen(problem, t)))
    rise = max(float(np.max(part - np.minimum.accumulate(part), initial=0.0)) for part in parts)
    return rise / most, ""


def _work(problem: Problem, history: Motion, v: Floats) -> tuple[Floats, Floats]:
    """Work against ground, dashpots and hysteresis up to every row, and what it may be off by (J).

    By Simpson's rule on the cubics between the rows; off by a tenth of what the trapezoid rule
    makes of it otherwise.
    """
    t, u, z = history.t, history.u, history.z
    yielding = problem.directions[:, problem.hysteretic]
    strength = np.array(problem.given["springs"]["strength"])[problem.hysteretic]

    def power(t: Floats, v: Floats, z: Floats | None) -> Floats:
        p = problem.ground(t) * (v @ problem.array("M"))
        p = p + np.einsum("ni,ij,nj->n", v, problem.array("C"), v)
        return p if z is None else p + ((v @ yielding) * z) @ strength

    first = np.flatnonzero(np.diff(t) > 0.0)
    last = first + 1
    h = t[last] - t[first]
    v_mid = 1.5 * (u[last] - u[first]) / h[:, None] - 0.25 * (v[first] + v[last])
    z_mid = None if z is None else 0.5 * (z[first] + z[last])
    # A jump of the ground at a row belongs to the other side of it.
    begins, ends = (
        power(t[rows] + side * 1e-9 * h, v[rows], None if z is None else z[rows])
        for rows, side in ((first, 1.0), (last, -1.0))
    )
    middle = power(0.5 * (t[first] + t[last]), v_mid, z_mid)
    simpson = h * (begins + 4.0 * middle + ends) / 6.0
    sums = np.zeros((2, t.size))
    sums[0, last] = simpson
    sums[1, last] = 0.1 * np.abs(simpson - 0.5 * h * (begins + ends))
    return np.cumsum(sums[0]), np.cumsum(sums[1])


def _unseen(problem: Problem, t: Floats) -> Floats:
    """Rows before which the ground does what a parabola through three of its values misses."""
    parts = (1e-9, 0.25, 0.5, 0.75, 1.0 - 1e-9)
    at = [problem.ground(t[:-1] + part * np.diff(t)) for part in parts]
    first, near, middle, far, last = at
    off = np.maximum(
        np.abs(near - (3.0 * first + 6.0 * middle - last) / 8.0),
        np.abs(far - (3.0 * last + 6.0 * middle - first) / 8.0),
    )
    return np.flatnonzero(off > CREATED * np.max(np.abs(at), initial=0.0)) + 1


# ---------------------------------------------------------------- the card of an answer

UNKNOWN: dict[str, Any] = dict.fromkeys(("expected", "matched", "missed", "extra", "largest_shift"))
"""What is counted of events of a kind, where nothing is known of them."""


@dataclass
class Card:
    """What is found of an answer.

    Parameters
    ----------
    problem : str
        Its name.
    digits : dict
        Fewest digits by what is judged; None where nothing is known.
    worst : dict
        The quantity that has them.
    deviations : tuple of Deviation
        Every number beside the certified one.
    impacts : dict
        expected, matched, missed, extra, largest_shift (part of `UNIT_OF_TIME` of the run).
    events : dict of dict
        The same of the other events by their kinds, the keys of `EVENTS`; matched is None where
        the program does not report them.
    penetration : float
        Deepest overlap, part of the largest displacement.
    energy : float or None
        What appears from nowhere, part of the largest energy.
    impact_rows : list of dict
        Of each impact ``contact``, ``t`` (s), ``speed`` (m/s, closing) and ``restitution`` (how
        many times faster it opens), by the answer, and the same as ``t_found`` ..., by the
        velocities of the rows; None where either has it not.
    reasons : dict of list
        By level everything that keeps it from being passed; nothing where it is.
    not_judged : list of str
        What was left out, and why.
    seconds : float or None
        What the run took.
    size : str
        Step or tolerance of the run.
    """

    problem: str
    digits: dict[str, float | None] = field(default_factory=dict)
    worst: dict[str, str] = field(default_factory=dict)
    deviations: tuple[Deviation, ...] = ()
    impacts: dict[str, Any] = field(default_factory=dict)
    events: dict[str, dict[str, Any]] = field(default_factory=dict)
    penetration: float = 0.0
    energy: float | None = None
    impact_rows: list[dict[str, Any]] = field(default_factory=list)
    reasons: dict[str, list[str]] = field(default_factory=dict)
    not_judged: list[str] = field(default_factory=list)
    seconds: float | None = None
    size: str = ""

    @classmethod
    def of_failure(cls, problem: str, why: str, size: str = "") -> Card:
        """Of a run that gave no answer."""
        reasons = {level: [why] for level in LEVELS}
        return cls(problem, impacts=UNKNOWN | {"expected": 0}, reasons=reasons, size=size)

    @property
    def levels(self) -> dict[str, str]:
        """By level why it is not passed, empty where it is."""
        return {level: "; ".join(why) for level, why in self.reasons.items()}

    @property
    def next_why(self) -> list[str]:
        """What keeps it from the easiest level that is not passed."""
        return next((why for why in self.reasons.values() if why), [])

    @property
    def passed(self) -> str | None:
        """The hardest level passed."""
        passed = [level for level, why in self.reasons.items() if not why]
        return passed[-1] if passed else None

    @property
    def fewest(self) -> float:
        """Digits of peaks, final values and history; 0 where nothing is right."""
        known = [self.digits.get(group) for group in ("peaks", "final", "history")]
        return min((d for d in known if d is not None), default=0.0)

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        names = (
            "problem size passed digits worst impacts events penetration energy levels "
            "impact_rows not_judged seconds"
        )
        numbers = [
            [q.quantity.name.partition(".")[0], q.quantity.name, q.error, q.floor]
            for q in self.deviations
        ]
        return {name: getattr(self, name) for name in names.split()} | {"quantities": numbers}


def judge(problem: Problem, history: Motion, seconds: float | None = None) -> Card:
    """Hold a history against the answer.

    Parameters
    ----------
    problem : Problem
        With its answer.
    history : Motion
        That `check` has passed.
    seconds : float, optional
        What it took to compute.
    """
    card = Card(problem.name, seconds=seconds)
    impacts = impacts_of(problem, history)
    crests = _crests(history, impacts)
    values, left_out = _values(problem, history, crests)
    card.not_judged += left_out
    others = [event for event in history.events if event.kind != "impact"]
    found = difference(problem.truth, values, [*(impacts or ()), *others])
    card.deviations = found.quantities
    for group in ("peaks", "final", "history"):
        worst = found.worst(group)
        card.digits[group] = None if worst is None else digits_of(max(worst.error, worst.floor))
        card.worst[group] = "" if worst is None else worst.quantity.name
    card.impacts = _counts(problem, found.events, "impact", impacts is not None)
    if impacts is None:
        card.not_judged.append("impacts: there are neither velocities nor a list of them")
    card.events = {
        kind: _counts(problem, found.events, kind, kind in history.reported) for kind in EVENTS
    }
    shift = card.impacts["largest_shift"]
    card.digits["impacts"] = None if shift is None else digits_of(shift)
    card.penetration = abs(float(problem.gaps(history.u).min(initial=0.0))) / problem.length
    card.energy, why = _created_energy(problem, history, impacts)
    if why:
        card.not_judged.append(f"energy: {why}")
    card.impact_rows = _impact_rows(problem, history)
    card.reasons = {level: _why_not(card, size) for level, size in LEVELS.items()}
    return card


def _counts(problem: Problem, events: Paired, kind: str, known: bool) -> dict[str, Any]:
    """Events of a kind in numbers; shifts in parts of `UNIT_OF_TIME` of the run.

    Of impacts only shifts of those that count do; other events of the answer whose time has no
    bound may be found or not.
    """
    impact = kind == "impact"
    of_kind = Paired(tuple(
        p for p in events.of(kind).pairs
        if impact or p.reference is None or p.reference.bound is not None
    ))  # fmt: skip
    nothing = UNKNOWN | {"expected": of_kind.expected}
    if not known:
        return nothing
    unit = UNIT_OF_TIME * problem.duration
    shifts = [
        max(abs(p.shift) - (p.reference.bound or 0.0), 0.0) / unit
        for p in of_kind.pairs
        if not math.isnan(p.shift) and (not impact or p.weight > COUNTED)
    ]
    return nothing | {
        "matched": of_kind.matched, "missed": of_kind.missed, "extra": of_kind.extra,
        "largest_shift": max(shifts, default=None),
    }  # fmt: skip


def _impact_rows(problem: Problem, motion: Motion) -> list[dict[str, Any]]:
    """Every impact of the answer beside that in the rows, with what restitution both come to."""

    def row(event: Event | None) -> tuple[float | None, float | None, float | None]:
        if event is None:
            return None, None, None
        before, after = event.gap_velocity_before, event.gap_velocity_after
        return event.t, -before, -after / before if before < 0.0 else None

    truth, contacts = problem.truth, problem.given["contacts"]
    found = read_off(problem, motion) or []
    keys = ("t", "speed", "restitution")
    return [
        {"contact": contacts[p.contact]}
        | dict(zip(keys, row(p.reference), strict=True))
        | {f"{key}_found": x for key, x in zip(keys, row(p.found), strict=True)}
        for p in pair_events(truth.events, found, truth.unit).listed
    ]


def digits_of(part: float) -> float:
    """Decimal digits that an error of this part of the scale leaves, to a tenth, 0 to 16."""
    if not math.isfinite(part):
        return 0.0
    return round(min(max(-math.log10(max(part, 1e-16)), 0.0), 16.0) + 0.0, 1)


def _why_not(card: Card, level: float) -> list[str]:
    """Everything that keeps an answer from passing a level."""
    found, why = card.impacts, []
    if found["expected"] and found["matched"] is None:
        why.append("impacts not judged")
    if found["missed"] or found["extra"]:
        wrong = f"{found['missed']} missed, {found['extra']} extra"
        why.append(f"of {found['expected']} impacts {wrong}")
    if card.penetration > level + 1e-12:
        why.append(f"penetrates by {card.penetration:.1e} of the largest displacement")
    judged = [q for q in card.deviations if ".t_" not in q.quantity.name]
    off = [q for q in judged if q.error > level + q.floor]
    if off:
        worst = max(off, key=lambda q: q.error - q.floor)
        more = f", and {len(off) - 1} more" if off[1:] else ""
        why.append(f"{worst.quantity.name} off by {worst.error:.1e} of its scale{more}")
    if (found["largest_shift"] or 0.0) > level:
        shift = found["largest_shift"] * UNIT_OF_TIME
        why.append(f"an impact comes {shift:.1e} of the run off")
    if card.energy is not None and card.energy > max(level, CREATED):
        why.append(f"{card.energy:.1e} of the energy comes from nowhere")
    if not judged:
        why.append("nothing could be judged")
    missing = [what.partition(":")[0] for what in card.not_judged if what.startswith("peaks")]
    return why + [f"{what} not judged" for what in missing]


# ---------------------------------------------------------------- a card in words


def card_text(card: Card) -> str:
    """A card as lines of text."""
    lines = [("problem", card.problem), ("passed", card.passed or "no level")]
    for level, why in card.levels.items():
        lines.append((f"  {level}", f"{LEVELS[level]:<7g}{why or 'passed'}"))
    for group, digits in card.digits.items():
        said = "not judged" if digits is None else f"{digits:.1f} digits"
        worst = card.worst.get(group)
        lines.append((group, f"{said}{f', fewest at {worst}' if worst else ''}"))
    if card.impacts["matched"] is not None:
        lines.append(("", _counted(card.impacts)))
    lines += [("restitution", said) for said in _restitution_words(card)]
    lines += [(f"{kind}s", said) for kind, said in event_words(card).items()]
    lines.append(("penetration", f"{card.penetration:.1e} of the largest displacement"))
    if card.energy is not None:
        lines.append(("energy", f"{card.energy:.1e} of the largest from nowhere"))
    if card.seconds is not None:
        lines.append(("time", f"{card.seconds:.3g} s"))
    lines += [("not judged", what) for what in card.not_judged]
    return "".join(f"{head:<15}{said}\n" for head, said in lines)


def _restitution_words(card: Card) -> list[str]:
    """The impact whose effective restitution is the most wrong."""
    keys = ("restitution", "restitution_found")
    fastest = max((r["speed"] or 0.0 for r in card.impact_rows), default=0.0)
    known = [
        r
        for r in card.impact_rows
        if None not in (r[keys[0]], r[keys[1]]) and r["speed"] > COUNTED * fastest
    ]
    if not known:
        return []
    worst = max(known, key=lambda r: abs(r[keys[0]] - r[keys[1]]))
    return [
        f"{worst[keys[1]]:.3g} in the rows where it is {worst[keys[0]]:.3g}, "
        f"{worst['contact']} at {worst['t']:.4g} s, furthest off"
    ]


def event_words(card: Card) -> dict[str, str]:
    """What is said of events beside impacts, by kinds, where any are expected or found."""
    said = {}
    for kind, found in card.events.items():
        if found["matched"] is None:
            if found["expected"]:
                said[kind] = f"{found['expected']} expected, not reported"
        elif found["expected"] or found["extra"]:
            shift = found["largest_shift"]
            digits = "" if shift is None else f", {digits_of(shift):.1f} digits"
            said[kind] = _counted(found) + digits
    return said


def _counted(found: dict[str, Any]) -> str:
    words = ("expected", "matched", "missed", "extra")
    return ", ".join(f"{found[word]} {word}" for word in words)


# ---------------------------------------------------------------- pages and drawings

COLOURS = {None: "#c0392b", "engineering": "#e08e0b", "research": "#2e86c1", "reference": "#1e8449"}
LINES = ("#1f4e79", "#b9770e", "#7d3c98", "#117a65", "#922b21", "#5d6d7e", "#2e4053", "#af601a")
_STYLE = """\
body { font: 15px/1.45 system-ui, sans-serif; margin: 2em auto; max-width: 64em; padding: 0 1.5em;
  color: #222; } h2 { margin-top: 1.6em; border-bottom: 1px solid #ccc; }
table { border-collapse: collapse; margin: 1em 0; }
td, th { padding: .25em .6em; text-align: left; vertical-align: top; }
a { white-space: nowrap; } ul { margin: 0; padding-left: 1.1em; }
td { border-top: 1px solid #ddd; } .n { text-align: right; font-variant-numeric: tabular-nums; }
.badge { color: #fff; border-radius: .3em; padding: .1em .5em; white-space: nowrap; }
svg { max-width: 100%; height: auto; } svg text { font: 12px system-ui, sans-serif; fill: #333; }
.small { color: #666; font-size: 13px; }
"""


def page(title: str, parts: list[str]) -> str:
    """A page that needs nothing from elsewhere."""
    body = "\n".join(parts)
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        f"<title>{html.escape(title)}</title><style>\n{_STYLE}</style></head>\n"
        f"<body><h1>{html.escape(title)}</h1>\n{body}\n</body></html>\n"
    )


def badge(level: str | None, word: str = "") -> str:
    """A level as a coloured word, its own where no other is given."""
    word = word or level or "none"
    return f'<span class="badge" style="background:{COLOURS[level]}">{word}</span>'


def table(head: list[str], rows: list[list[str]], words: int = 99) -> str:
    """A table; cells are HTML, those after the first so many numbers, which stand to the right."""

    def line(cells: list[str], tag: str) -> str:
        kinds = ["" if i < words else ' class="n"' for i in range(len(cells))]
        row = (f"<{tag}{kind}>{cell}</{tag}>" for kind, cell in zip(kinds, cells, strict=True))
        return f"<tr>{''.join(row)}</tr>"

    return "\n".join(["<table>" + line(head, "th"), *(line(r, "td") for r in rows)]) + "</table>"


@dataclass
class Axes:
    """A drawing of some width and height whose points are given in its own numbers."""

    x: tuple[float, float]
    y: tuple[float, float]
    width: float = 900.0
    height: float = 260.0
    left: float = 66.0
    below: float = 34.0
    marks: list[str] = field(default_factory=list)

    def place(self, x: float, y: float) -> tuple[float, float]:
        """Where a point lies in the picture."""
        across = (x - self.x[0]) / ((self.x[1] - self.x[0]) or 1.0)
        up = (y - self.y[0]) / ((self.y[1] - self.y[0]) or 1.0)
        return (
            self.left + across * (self.width - self.left - 12.0),
            self.height - self.below - up * (self.height - self.below - 16.0),
        )

    def line(self, x: Floats, y: Floats, colour: str, style: str = "") -> None:
        """A polyline."""
        points = " ".join(
            "{:.1f},{:.1f}".format(*self.place(a, b)) for a, b in zip(x, y, strict=True)
        )
        self.marks.append(f'<polyline points="{points}" fill="none" stroke="{colour}" {style}/>')

    def dot(self, x: float, y: float, colour: str, size: float = 3.0, filled: bool = True) -> None:
        """A circle."""
        a, b = self.place(x, y)
        fill = colour if filled else "#fff"
        self.marks.append(
            f'<circle cx="{a:.1f}" cy="{b:.1f}" r="{size}" fill="{fill}" stroke="{colour}"/>'
        )

    def bar(self, x: float, end: float, y: float, height: float, colour: str) -> None:
        """A bar of some pixels' height from x to another, a pixel wide at least."""
        (a, b), (c, _) = self.place(x, y), self.place(end, y)
        self.marks.append(
            f'<rect x="{a:.1f}" y="{b - height:.1f}" width="{max(c - a, 1.0):.1f}" '
            f'height="{height}" fill="{colour}" opacity="0.7"/>'
        )

    def legend(self, names: list[str]) -> None:
        """Names of the first colours, above the picture."""
        across = self.left
        for name, colour in zip(names, LINES, strict=False):
            self.marks.append(
                f'<rect x="{across:.0f}" y="3" width="9" height="9" fill="{colour}"/>'
                f'<text x="{across + 13:.0f}" y="12">{html.escape(name)}</text>'
            )
            across += 34.0 + 7.0 * len(name)

    def word(self, x: float, y: float, text: str, anchor: str = "start") -> None:
        """A word at a point."""
        a, b = self.place(x, y)
        self.marks.append(_text(a, b, html.escape(text), anchor))

    def svg(
        self, x_ticks: dict[float, str], y_ticks: dict[float, str], label: str, upwards: str = ""
    ) -> str:
        """The picture with its axes and what they show."""
        grid = []
        for x, text in x_ticks.items():
            (a, b), (_, top) = self.place(x, self.y[0]), self.place(x, self.y[1])
            grid += [_line(a, a, b, top), _text(a, b + 15.0, text, "middle")]
        for y, text in y_ticks.items():
            (a, b), (right, _) = self.place(self.x[0], y), self.place(self.x[1], y)
            grid += [_line(a, right, b, b), _text(a - 5.0, b + 4.0, text, "end")]
        a, b = self.place(0.5 * sum(self.x), 0.5 * sum(self.y))
        grid.append(f'<text x="{a:.1f}" y="{self.height - 3}" text-anchor="middle">{label}</text>')
        turned = f'transform="translate(13 {b:.1f}) rotate(-90)" text-anchor="middle"'
        grid.append(f"<text {turned}>{upwards}</text>")
        return (
            f'<svg width="{self.width:g}" height="{self.height:g}" '
            f'viewBox="0 0 {self.width:g} {self.height:g}" xmlns="http://www.w3.org/2000/svg">'
            + "".join(grid + self.marks)
            + "</svg>"
        )


def _text(x: float, y: float, text: str, anchor: str) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{text}</text>'


def _line(x: float, to_x: float, y: float, to_y: float) -> str:
    return f'<line x1="{x:.1f}" x2="{to_x:.1f}" y1="{y:.1f}" y2="{to_y:.1f}" stroke="#eee"/>'


def _ticks(low: float, high: float, count: int = 5) -> dict[float, str]:
    step = 10.0 ** math.floor(math.log10(max(high - low, 1e-300) / count))
    step *= min(
        (m for m in (1.0, 2.0, 5.0, 10.0) if (high - low) / (step * m) <= count), default=10.0
    )
    first = math.ceil(low / step)
    return {k * step: f"{k * step:g}" for k in range(first, math.floor(high / step) + 1)}


def _length_unit(size: float) -> tuple[float, str]:
    """What a length (m) is multiplied by to be shown, and its unit."""
    return (1.0, "m") if size >= 2.0 else (1e2, "cm") if size >= 0.02 else (1e3, "mm")


# ---------------------------------------------------------------- the page of a card


def card_page(problem: Problem, history: Motion, card: Card) -> str:
    """A card as a page."""
    worst = sorted(card.deviations, key=lambda q: -q.error)[:20]
    rows = [
        [
            html.escape(q.quantity.name), f"{q.quantity.value:.6g}", f"{q.value:.6g}",
            f"{q.value - q.quantity.value:+.1e}", q.quantity.unit, f"{q.error:.1e}",
            f"{q.floor:.1e}", f"{digits_of(max(q.error, q.floor)):.1f}",
        ]
        for q in worst
    ]  # fmt: skip
    head = ["quantity", "certified", "found", "error", "unit", "part of its scale", "floor",
            "digits"]  # fmt: skip
    parts = [
        f"<p>{html.escape(problem.given['tests'])}</p>",
        f"<p>Hardest level passed: {badge(card.passed)}</p>",
        _verdicts(card),
        digits_picture(card),
        _facts(card),
        "<h2>Motion</h2>",
        motion_picture(problem, history),
        '<p class="small">Lines: the answer judged. Circles: certified displacements. '
        "Red: certified impacts. Green: certified rests.</p>",
        *_impacts_part(problem, card),
        "<h2>Events</h2>",
        _events_table(problem, card),
        "<h2>Largest errors</h2>",
        table(head, rows, 1),
    ]
    return page(f"{card.problem}: score card", parts)


def _verdicts(card: Card) -> str:
    """Levels with everything that keeps an answer from them."""
    rows = []
    for level, reasons in card.reasons.items():
        said = "".join(f"<li>{html.escape(why)}</li>" for why in reasons)
        verdict = f"<ul>{said}</ul>" if reasons else "passed"
        rows.append([level if reasons else badge(level), f"{LEVELS[level]:g}", verdict])
    return table(["level", "error allowed", ""], rows)


def _facts(card: Card) -> str:
    """What is judged beside the numbers, and what is not judged."""
    rows = [["deepest overlap", f"{card.penetration:.1e} of the largest displacement"]]
    if card.energy is not None:
        rows.append(["energy from nowhere", f"{card.energy:.1e} of the largest"])
    if card.seconds is not None:
        rows.append(["processor time", f"{card.seconds:.3g} s"])
    rows += [["not judged", html.escape(what)] for what in card.not_judged]
    return table(["beside the numbers", ""], rows)


def _impacts_part(problem: Problem, card: Card, most: int = 40) -> list[str]:
    """Every impact: when, how fast, and with which effective restitution."""
    if not card.impact_rows:
        return []

    def cell(value: float | None, form: str, missing: str = "") -> str:
        return missing if value is None else f"{value:{form}}"

    rows = []
    for r in card.impact_rows[:most]:
        shift = None if None in (r["t"], r["t_found"]) else r["t_found"] - r["t"]
        rows.append([
            html.escape(r["contact"]),
            cell(r["t"], ".5f", "extra"), cell(r["t_found"], ".5f", "missed"), cell(shift, "+.1e"),
            cell(r["speed"], ".4g"), cell(r["speed_found"], ".4g"),
            cell(r["restitution"], ".3f"), cell(r["restitution_found"], ".3f"),
        ])  # fmt: skip
    head = ["contact", "t (s)", "found (s)", "shift (s)", "closes with (m/s)", "found (m/s)",
            "restitution", "found"]  # fmt: skip
    more = len(card.impact_rows) - most
    return [
        "<h2>Impacts</h2>",
        restitution_picture(problem, card),
        '<p class="small">Effective restitution: how many times faster the gap opens than it '
        "closed. Circles: certified; dots: in the rows of the answer judged, whatever else it "
        "lists.</p>",
        table(head, rows, 1),
        f'<p class="small">and {more} more in the JSON file.</p>' if more > 0 else "",
    ]


def _events_table(problem: Problem, card: Card) -> str:
    """Events by their kinds; those that are neither expected nor found are left out."""
    rows = []
    for kind, found in {"impact": card.impacts, **card.events}.items():
        if not (found["expected"] or found["extra"]):
            continue
        unknown = found["matched"] is None
        shift = found["largest_shift"]
        late = "" if shift is None else f"{shift * UNIT_OF_TIME * problem.duration:.1e}"
        counts = ["not reported"] if unknown else [f"{found['matched']}"]
        counts += ["" if unknown else f"{found[key]}" for key in ("missed", "extra")]
        rows.append([f"{kind}s", f"{found['expected']}", *counts, late])
    head = ["events", "expected", "matched", "missed", "extra", "largest shift (s)"]
    return table(head, rows, 1) if rows else "<p>None.</p>"


def motion_picture(problem: Problem, history: Motion, most: int = 4) -> str:
    """Displacements of an answer, the certified ones as circles, impacts as ticks."""
    shown = problem.bodies[:most]
    values = {row[0]: row[1] for row in problem.answer["quantities"]}
    t = history.t
    rows = np.unique(np.linspace(0, t.size - 1, min(t.size, 3000)).astype(int))
    factor, unit = _length_unit(problem.length)
    u = factor * history.u[:, : len(shown)]
    margin = 0.08 * float(np.ptp(u)) or 1.0
    axes = Axes((float(t[0]), float(t[-1])), (float(u.min()) - margin, float(u.max()) + margin))
    for i, body in enumerate(shown):
        axes.line(t[rows], u[rows, i], LINES[i])
        for k, moment in enumerate(problem.given["moments"]):
            if f"history.{k}.{body}" in values:
                value = factor * values[f"history.{k}.{body}"]
                axes.dot(moment, value, LINES[i], 2.6, filled=False)
    axes.legend(shown)
    bottom = axes.y[0]
    for event in problem.truth.events:
        if event.kind == "impact":
            axes.bar(event.t, event.t, bottom, 7.0, "#c0392b")
    for rest, last in rests_of(problem.truth.events):
        if rest is not None:
            until = problem.given["end"] if last is None else last.t
            axes.bar(rest.t, until, bottom, 4.0, "#1e8449")
    return axes.svg(_ticks(*axes.x), _ticks(*axes.y), "t (s)", f"u ({unit})")


def restitution_picture(problem: Problem, card: Card) -> str:
    """Effective restitution of every impact, certified (circles) and found (dots)."""
    struck = {row["contact"] for row in card.impact_rows}
    contacts = [contact for contact in problem.given["contacts"] if contact in struck]
    known = [r[k] for r in card.impact_rows for k in ("restitution", "restitution_found") if r[k]]
    times = [r[k] for r in card.impact_rows for k in ("t", "t_found") if r[k] is not None]
    margin = 0.03 * (max(times) - min(times) or problem.duration)
    axes = Axes(
        (min(times) - margin, max(times) + margin), (0.0, min(max([1.0, *known]), 2.0)), height=190
    )
    for row in card.impact_rows:
        colour = LINES[contacts.index(row["contact"]) % len(LINES)]
        for end in ("", "_found"):
            if row[f"restitution{end}"] is not None:
                height = min(row[f"restitution{end}"], axes.y[1])
                axes.dot(row[f"t{end}"], height, colour, 4.0 if not end else 2.4, filled=bool(end))
    axes.legend(contacts[:6])
    return axes.svg(_ticks(*axes.x), _ticks(*axes.y, 4), "t (s)", "restitution")


def digits_picture(card: Card) -> str:
    """Digits of what is judged as bars, the levels as lines."""
    groups = [(g, d) for g, d in card.digits.items() if d is not None]
    axes = Axes((0.0, 16.0), (0.0, float(len(groups))), height=60.0 + 26.0 * len(groups), left=90.0)
    for level, size in LEVELS.items():
        x = -math.log10(size)
        axes.line([x, x], [0.0, axes.y[1]], COLOURS[level], 'stroke-dasharray="5 4"')
        axes.word(x, axes.y[1], level, "middle")
    for i, (group, digits) in enumerate(groups):
        y = len(groups) - i
        axes.bar(0.0, digits, y - 0.72, 12.0, LINES[0])
        worst = card.worst.get(group)
        axes.word(digits + 0.1, y - 0.66, f"{digits:.1f}{f'  {worst}' if worst else ''}")
    names = {len(groups) - i - 0.5: group for i, (group, _) in enumerate(groups)}
    return axes.svg(
        {float(k): f"{k}" for k in range(0, 17, 2)},
        names,
        "digits, and the quantity with the fewest",
    )


# ---------------------------------------------------------------- programs on many problems


def best_of(cards: list[Card]) -> Card:
    """The first card of the hardest level; the last one where none is passed."""
    order: list[str | None] = [None, *LEVELS]
    hardest = max(cards, key=lambda card: order.index(card.passed))
    return hardest if hardest.passed else cards[-1]


def solved(ladders: Iterable[list[Card]]) -> dict[str, int]:
    """How many problems a program solves to each level or a harder one."""
    passed = [best_of(cards).passed for cards in ladders]
    levels = list(LEVELS)
    return {level: sum(p in levels[i:] for p in passed) for i, level in enumerate(levels)}


def ladder_text(cards: list[Card]) -> str:
    """Cards of one program from coarse to fine, a line a size: error against work in numbers."""
    groups = ("peaks", "final", "history", "impacts")
    rows = [["size", "passed", *groups, "missed", "extra", "overlap", "energy", "time (s)"]]
    for card in cards:
        digits = (card.digits.get(group) for group in groups)
        counts = (card.impacts[key] for key in ("missed", "extra"))
        numbers = (card.penetration if card.digits else None, card.energy)
        rows.append([
            card.size or "-", card.passed or "-",
            *("-" if d is None else f"{d:.1f}" for d in digits),
            *("-" if n is None else str(n) for n in counts),
            *("-" if x is None else f"{x:.0e}" for x in numbers),
            "-" if card.seconds is None else f"{card.seconds:.3g}",
        ])  # fmt: skip
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = ["  ".join(c.ljust(w) for c, w in zip(r, widths, strict=True)).rstrip() for r in rows]
    for card in cards:
        why = "; ".join(card.next_why)
        said = "; ".join(f"{kind}s: {words}" for kind, words in event_words(card).items())
        lines.append(f"{card.size or '-'}: {'; '.join(x for x in (why, said) if x) or 'passed'}")
    return "\n".join(lines) + "\n"


def count_text(ladders: list[list[Card]]) -> str:
    """How many problems a program solves to each level."""
    parts = [f"{count} {level}" for level, count in solved(ladders).items()]
    return f"of {len(ladders)} problems {', '.join(parts)}"


def set_page(title: str, found: dict[str, dict[str, list[Card]]], limit: float) -> str:
    """Programs (by name) on problems (by name), cards from coarse to fine, as a page."""
    problems = list(next(iter(found.values()), {}))
    summary = [
        [html.escape(label), *map(str, solved(by_problem.values()).values())]
        for label, by_problem in found.items()
    ]
    rows = []
    for name in problems:
        cells = [f'<a href="#{name}">{name}</a>']
        for label in found:
            card = best_of(found[label][name])
            why = card.levels["reference"] if card.passed != "reference" else ""
            digits = f"{-math.log10(LEVELS[card.passed]):.0f}" if card.passed else "–"
            cells.append(f'<span title="{html.escape(why)}">{badge(card.passed, digits)}</span>')
        rows.append(cells)
    parts = [
        f"<p>Solved to each level, of {len(problems)} problems:</p>",
        table(["program", *LEVELS], summary),
        "<p>Hardest level passed at any step or tolerance, by its digits; what keeps it from the "
        f"next is shown by the pointer. A run may take {limit:g} s.</p>",
        table(["problem", *(html.escape(label) for label in found)], rows),
        '<h2>Digits against time</h2><p class="small">The fewest digits of any peak, final '
        "value or stated displacement, over processor time, a point a step or tolerance. Open: "
        "impacts missed or extra. In the tables: rests, their ends and accumulations, matched of "
        "expected.</p>",
    ]
    for name in problems:
        parts.append(f'<h3 id="{name}">{name}</h3>')
        parts.append(work_picture({label: found[label][name] for label in found}))
        head = ["program", "size", "passed", "what keeps it back", *(f"{k}s" for k in EVENTS)]
        parts.append(table(head, [
            [html.escape(label), card.size, badge(card.passed),
             html.escape("; ".join(card.next_why)),
             *(_found(card.events.get(kind)) for kind in EVENTS)]
            for label in found for card in found[label][name]
        ]))  # fmt: skip
    return page(title, parts)


def _found(event: dict[str, Any] | None) -> str:
    """Matched of expected events in few characters; empty where there are none."""
    if event is None or not (event["expected"] or event["extra"]):
        return ""
    if event["matched"] is None:
        return "not reported"
    extra = f", {event['extra']} extra" if event["extra"] else ""
    return f"{event['matched']}/{event['expected']}{extra}"


def work_picture(lines: dict[str, list[Card]], width: float = 900.0, height: float = 380.0) -> str:
    """Digits against time, a line a program, a point a step size or tolerance."""
    timed = {name: [c for c in cards if c.seconds] for name, cards in lines.items()}
    seconds = [c.seconds for cards in timed.values() for c in cards if c.seconds]
    if not seconds:
        return '<p class="small">Nothing was timed.</p>'
    low, high = math.floor(math.log10(min(seconds))), math.ceil(math.log10(max(seconds)) + 1e-9)
    axes = Axes((low, max(high, low + 1)), (0.0, 16.0), width, height)
    ends: list[tuple[float, float, str]] = []
    for i, (name, cards) in enumerate(timed.items()):
        if not cards:
            continue
        colour = LINES[i % len(LINES)]
        dash = "" if i < len(LINES) else 'stroke-dasharray="4 3"'
        points = [(math.log10(c.seconds), c.fewest) for c in cards if c.seconds]
        axes.line([p[0] for p in points], [p[1] for p in points], colour, dash)
        for (x, y), card in zip(points, cards, strict=True):
            axes.dot(x, y, colour, filled=not (card.impacts["missed"] or card.impacts["extra"]))
        ends.append((*points[-1], name))
    if len(lines) > 1:
        _name_ends(axes, ends)
    decades = {float(k): f"1e{k}" for k in range(low, max(high, low + 1) + 1)}
    return axes.svg(
        decades, {float(k): f"{k}" for k in range(0, 17, 4)}, "processor time (s)", "fewest digits"
    )


def _name_ends(axes: Axes, ends: list[tuple[float, float, str]]) -> None:
    """Names at points, moved up where they would lie on each other."""
    taken: list[tuple[float, float]] = []
    for x, y, name in sorted(ends, key=lambda end: end[1]):
        across, down = axes.place(x, y + 0.4)
        for a, b in taken:
            if abs(a - across) < 95.0 and down > b - 12.0:
                down = b - 12.0
        taken.append((across, down))
        axes.marks.append(f'<text x="{across:.1f}" y="{down:.1f}">{html.escape(name)}</text>')


# ---------------------------------------------------------------- the command


def main(arguments: list[str] | None = None) -> int:
    """Judge the answer that the command line names."""
    head, _, rest = str(__doc__).partition("\n\n")
    parser = argparse.ArgumentParser(
        description=head, epilog=rest, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("problem", metavar="PROBLEM", type=Path)
    parser.add_argument("answer", metavar="ANSWER.csv", type=Path)
    parser.add_argument("--json", metavar="FILE", type=Path, help="write the card as JSON")
    parser.add_argument("--html", metavar="FILE", type=Path, help="write the card as a page")
    options = parser.parse_args(arguments)
    try:
        problem = read_problem(options.problem)
        history = read_history(problem, options.answer)
    except ScoreError as error:
        print(f"score: {error}", file=sys.stderr)
        return 2
    card = judge(problem, history)
    if options.json:
        options.json.write_text(json.dumps(card.as_dict(), indent=1) + "\n", encoding="utf-8")
    if options.html:
        options.html.write_text(card_page(problem, history, card), encoding="utf-8")
    print(card_text(card), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
