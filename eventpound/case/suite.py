"""A suite: the records that one scene runs under, one after the other.

They are the files that match a pattern, those of a list, or synthetic motions.
A list is a CSV file as `eventpound.motion.record_list` says.
"""

from __future__ import annotations

import hashlib
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

from eventpound.basics.input_files import MOST_MATCHES, matching_files
from eventpound.case.record_file import record_root
from eventpound.case.record_options import RecordOptions
from eventpound.case.record_scaling import scaled_as
from eventpound.case.table import Table
from eventpound.errors import InputError, told_of
from eventpound.motion import Record, RecordData
from eventpound.motion.record_list import ListedRecord, read_list
from eventpound.motion.sequence import in_sequence
from eventpound.motion.synthetic import synthetic_motion
from eventpound.scene.scene import Scene
from eventpound.units import Dimension

KEPT = 128
"""Records that are kept when they have been read."""
SECOND, ATTACK = "across", "attack"
"""Keys of the second component of a motion, a table, and of the direction of the first."""
LARGEST_SEED = 2**63 - 1
"""Of a synthetic motion, and the largest number of one."""
RECORDS = 'a pattern of files, "folder/*.AT2", or a file that lists them, "records.csv"'
"""What names the records of a suite."""


@dataclass(frozen=True, slots=True)
class Member:
    """One motion of a suite.

    Parameters
    ----------
    name : str
        What results call it; no two of a suite are the same.
    file : str
        Its file; the name of the file it would have, for a synthetic motion.
    options : RecordOptions
        How it is read and scaled.
    synthetic : (int, int) or None
        Seed and number of a synthetic motion.
    problem : str
        Why it cannot be read, where its line in a list says nonsense.
    beside : tuple of (str, Member)
        The record of each support that has one in a suite of its own, by its name, or the second
        component, `SECOND`.
    files : tuple of str
        Of a sequence, all of them; else empty.
    rest : float
        Between the records of a sequence (s).
    """

    name: str
    file: str
    options: RecordOptions
    synthetic: tuple[int, int] | None = None
    problem: str = ""
    beside: tuple[tuple[str, Member], ...] = ()
    files: tuple[str, ...] = ()
    rest: float = math.nan

    def read(self) -> RecordData:
        """Read or generate it.

        Raises
        ------
        InputError
            Where it cannot be read.
        """
        if self.problem:
            raise InputError(self.problem)
        if self.synthetic is not None:
            return self.options.processing.apply(synthetic_motion(*self.synthetic).record)
        if self.files:
            read = [self.options.read(Path(file), as_needed=True) for file in self.files]
            return in_sequence(read, self.rest)
        return self.options.read(Path(self.file), as_needed=True)

    def of_file(self, data: RecordData) -> dict[str, object]:
        """``[excitation]`` of it by itself, in SI with the defaults filled in."""
        if not self.files:
            return self.options.of_file(self.file, data)
        given = {"kind": "record", "file": list(self.files), "rest": self.rest}
        return {**given, **self.options.said(), **self.options.understood()}

    def motion(self) -> Record:
        """Its ground motion; the last ones are kept, as long as their files stay as they are.

        Raises
        ------
        InputError
            Where it cannot be read or used.
        """
        try:
            found = [os.stat(file) for file in self.files or (self.file,)]
            stamp = tuple((s.st_ino, s.st_mtime_ns, s.st_size) for s in found)
        except OSError:
            # A synthetic motion has no file, and what is wrong with another reading it says.
            stamp = ()
        return _motion(self, stamp)

    def motions_beside(self) -> dict[str, Record]:
        """Motions of what goes with it, by their names.

        Raises
        ------
        InputError
            Where a record cannot be read or used.
        """
        found = {}
        for name, member in self.beside:
            with told_of(where_beside(name)):
                motion = member.motion()
                found[name] = scaled_as(self.motion(), motion) if member.options.follows else motion
        return found

    def on(self, scene: Scene) -> Scene:
        """A scene moved by it, and by what goes with it at supports.

        Raises
        ------
        InputError
            Where a record cannot be read or used.
        """
        own = self.motions_beside()
        return replace(
            scene,
            motion=self.motion(),
            across=own.get(SECOND, scene.across),
            supports=tuple(
                replace(each, motion=own[each.name]) if each.name in own else each
                for each in scene.supports
            ),
        )

    def described(self) -> Mapping[str, object]:
        """What decides the motion: its name, the hash of its file or its seed, how it is used."""
        content: object = None if self.synthetic is not None else _hash(Path(self.file))
        if self.files:
            content = [self.rest, *(_hash(Path(file)) for file in self.files)]
        response = self.options.response_path
        return {
            "record": self.name,
            "sha256": content,
            "response_sha256": None if response is None else _hash(response),
            "synthetic": self.synthetic,
            "options": {**self.options.said(), **self.options.understood()},
            **({"supports": {n: m.described() for n, m in self.beside}} if self.beside else {}),
        }


@dataclass(frozen=True, slots=True)
class Suite:
    """What a case says of its suite.

    Parameters
    ----------
    pattern : str or None
        ``"folder/*.AT2"`` or a list, relative to the case.
    synthetic : tuple of (int, int)
        Seed and number of each synthetic motion; empty with a pattern.
    options : RecordOptions
        What all of them have in common.
    beside : tuple of (str, Suite)
        Those of supports that have records of their own, by the name of the support, or of the
        second component, `SECOND`.
    rest : float or None
        Between the records of sequences (s).
    """

    pattern: str | None
    synthetic: tuple[tuple[int, int], ...]
    options: RecordOptions
    beside: tuple[tuple[str, Suite], ...] = ()
    rest: float | None = None

    def members(self, directory: Path) -> list[Member]:
        """The motions, in order of their files, each with those of the same place beside it.

        Parameters
        ----------
        directory : Path
            Of the case.

        Raises
        ------
        InputError
            Where no file matches, a list cannot be read, or a support or the second component has
            another number of records.
        """
        members = self._own_members(directory)
        problems, columns = [], []
        for name, suite in self.beside:
            own = suite.members(directory)
            columns.append([(name, member) for member in own])
            if len(own) != len(members):
                problems.append(
                    f"{where_beside(name)}found {len(own)} records for the {len(members)} of "
                    "[excitation]; accepted: as many, which go together in their order"
                )
        if problems:
            raise InputError(problems)
        pairs = zip(*columns, strict=True) if columns else ((),) * len(members)
        return [replace(m, beside=own) if own else m for m, own in zip(members, pairs, strict=True)]

    def told(self, directory: Path) -> dict[str, object]:
        """How many records there are, and how they are scaled."""
        scaling = self.options.size.words()
        return {"suite": len(self.members(directory)), **({"scaling": scaling} if scaling else {})}

    def told_at(self, name: str, directory: Path) -> dict[str, object]:
        """What is told of the records of a support or the second component, where it has some."""
        own = dict(self.beside).get(name)
        return {} if own is None else {"suite": len(own.members(directory))}

    def _own_members(self, directory: Path) -> list[Member]:
        """The motions of the ground."""
        if self.pattern is None:
            return [
                Member(name, name, self.options, (seed, number))
                for seed, number in self.synthetic
                for name in [f"synthetic-{seed}-{number:04d}.AT2"]
            ]
        root, pattern = record_root(self.pattern, directory)
        with told_of("suite: "):
            paths = matching_files(pattern, root)
        if not paths:
            raise InputError(f"suite: found {self.pattern!r}, but no file matches it in {root}")
        listed = len(paths) == 1 and paths[0].suffix.lower() == ".csv"
        if listed and (rows := read_list(paths[0])) is not None:
            folder = paths[0].parent
            return _unique_names([_listed(r, folder, self.options, self.rest) for r in rows])
        common = Path(os.path.commonpath([path.parent for path in paths]))
        return [
            Member(path.relative_to(common).as_posix(), str(path), self.options) for path in paths
        ]


def where_beside(name: str) -> str:
    """How messages about what goes with a record begin."""
    return f"{SECOND}: " if name == SECOND else f"support '{name}': "


@lru_cache(KEPT)
def _motion(member: Member, _stamp: tuple[tuple[int, int, int], ...]) -> Record:
    """The motion of a record, which parts of a study have in common."""
    return member.options.motion(member.read())


def _hash(path: Path) -> str | None:
    """SHA-256 of a file; none where it cannot be read, which its row will say."""
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError:
        return None


def read_suite_keys(table: Table, options: RecordOptions | None) -> Suite | None:
    """Read ``suite`` or ``synthetic`` of ``[excitation]``.

    Parameters
    ----------
    table : Table
        ``[excitation]``.
    options : RecordOptions or None
        Its other keys; None where they have problems.

    Returns
    -------
    Suite or None
        None where there are problems; they are noted.
    """
    pattern: str | None = None
    synthetic: tuple[tuple[int, int], ...] = ()
    if table.has("suite"):
        pattern = table.text("suite", RECORDS)
        if table.has("synthetic"):
            table.reject("synthetic", "one of suite and synthetic")
            return None
    else:
        synthetic = _read_synthetic(table.table("synthetic"))
    if table.has("file"):
        table.reject("file", "one of file and suite")
        return None
    if options is None or not (pattern or synthetic):
        return None
    rest = table.optional_quantity("rest", Dimension.TIME, "a positive time (s)")
    if rest is not None and not (pattern or "").endswith(".csv"):
        table.reject("rest", "none, but beside a list of sequences (a CSV file)")
    return Suite(pattern, synthetic, options, rest=rest)


def with_suite(excitation: Mapping[str, object], pattern: str) -> dict[str, object]:
    """``[excitation]`` with the records of a pattern in the place of its own."""
    own = ("file", "suite", "synthetic", *([] if pattern.endswith(".csv") else ["rest"]))
    kept = {k: v for k, v in excitation.items() if k not in own}
    return {**kept, "suite": pattern}


def understood_suite(suite: Suite) -> Mapping[str, object]:
    """``[excitation]`` of a suite in SI with every default filled in."""
    said = suite.options.said()
    if suite.pattern is not None:
        rest = {} if suite.rest is None else {"rest": suite.rest}
        chosen: dict[str, object] = {"suite": suite.pattern, **rest}
    else:
        seed, first = suite.synthetic[0]
        chosen = {"synthetic": {"seed": seed, "first": first, "count": len(suite.synthetic)}}
    return {"kind": "record", **chosen, **said, **suite.options.understood()}


def _read_synthetic(table: Table) -> tuple[tuple[int, int], ...]:
    """Seeds and numbers of ``synthetic = { seed, first, count }``; empty with problems noted."""
    numbers = {"seed": 1, "first": 1, "count": 60}
    for key, default in numbers.items():
        most = MOST_MATCHES if key == "count" else LARGEST_SEED
        value = table.whole_number(key, 1, most, default)
        if value is None:
            return ()
        numbers[key] = value
    table.close()
    first = numbers["first"]
    return tuple((numbers["seed"], n) for n in range(first, first + numbers["count"]))


def _listed(
    row: ListedRecord, directory: Path, common: RecordOptions, rest: float | None
) -> Member:
    """The record, or the sequence, of one line of a list in a directory."""
    options = replace(
        common,
        units=row.units or common.units,
        component=row.component or common.component,
        time_step=common.time_step if row.time_step is None else row.time_step,
    )
    if len(row.files) == 1:
        return Member(row.file, str(directory / row.file), options, None, row.problem)
    problem = row.problem
    if rest is None:
        problem = problem or 'needs rest in [excitation], the time between two shocks, "30 s"'
    files = tuple(str(directory / file) for file in row.files)
    whole = Member(row.file, "; ".join(files), options, None, problem, files=files)
    return whole if rest is None else replace(whole, rest=rest)


def _unique_names(members: Sequence[Member]) -> list[Member]:
    """The same members; those of one name get a number."""
    counts: dict[str, int] = {}
    named = []
    for member in members:
        count = counts[member.name] = counts.get(member.name, 0) + 1
        named.append(member if count == 1 else replace(member, name=f"{member.name} ({count})"))
    return named
