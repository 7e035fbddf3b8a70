"""What a study consists of: scenes, the axes along which each is varied, and what is kept."""

from __future__ import annotations

import hashlib
import math
import platform
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from importlib.metadata import PackageNotFoundError, version

from eventpound.case.case import Case
from eventpound.case.suite import Member
from eventpound.errors import InputError
from eventpound.results.jsontext import canonical
from eventpound.study.axes import NumberAxis, sizes
from eventpound.sweep import FAST

PART, RECORD = "part", "record"
"""Columns that name the part of a study a row belongs to, and the record it ran under."""
MOST_RECORDS = 64
"""Records of one chunk, at most: all of them are in memory together."""
_CHUNKS = 256
# A batch of the fast solver costs milliseconds whatever its size; other runs cost more each.
_SMALLEST_BATCH, _SMALLEST_CHUNK, _LARGEST_CHUNK = 64, 4, 2048
# What can change the last bit of a result.
_PACKAGES = ("eventpound", "numpy", "numba", "llvmlite", "scikit-sundae")


@dataclass(frozen=True)
class Base:
    """One scene of a study and the numbers that vary on it.

    Parameters
    ----------
    case : Case
        The scene with the first value of every axis, and how it is run.
    labels : mapping
        Words that make this scene, by columns of the table.
    axes : tuple of NumberAxis
        Along which it is varied; the last one fastest.
    own_duration : bool
        Whether the case says how long a run lasts; else each run has the
        default of its own motion and structure.
    records : tuple of Member
        Under each of which all the axes vary; without, the motion is that of the case.
    """

    case: Case
    labels: Mapping[str, object]
    axes: tuple[NumberAxis, ...]
    own_duration: bool
    records: tuple[Member, ...] = ()

    @property
    def size_of_record(self) -> int:
        """Number of runs under one record."""
        return math.prod(sizes(self.axes).values())

    @property
    def size(self) -> int:
        """Number of runs."""
        return self.size_of_record * max(1, len(self.records))

    def at_first(self) -> Base:
        """The same under the first record that can be read, where there are any.

        Raises
        ------
        InputError
            Where none can be.
        """
        for number, record in enumerate(self.records, 1):
            try:
                return self.under(record)
            except InputError:
                if number == len(self.records):
                    raise
        return self

    @property
    def one_by_one(self) -> bool:
        """Whether each record makes a scene of its own: supports move by others than the ground."""
        return any(record.supports for record in self.records)

    def under(self, record: Member) -> Base:
        """The same scene and axes under one record.

        Raises
        ------
        InputError
            Where it cannot be read.
        """
        case = replace(self.case, scene=record.on(self.case.scene))
        return replace(self, case=case, records=())


@dataclass(frozen=True)
class Chunk:
    """Rows of one scene that are computed and stored together.

    Parameters
    ----------
    number : int
        Position among the chunks of the study.
    base : int
        Position of the scene.
    low, high : int
        Rows of that scene.
    """

    number: int
    base: int
    low: int
    high: int


@dataclass(frozen=True)
class Study:
    """Everything that decides the table of a study.

    Parameters
    ----------
    title : str
        One line.
    bases : tuple of Base
        Scenes, in the order of the table.
    columns : tuple of str
        Part and axes, the first columns of the table.
    quantities : tuple of str
        What is tabulated after them.
    solver : str
        Name of the solver.
    rtol : float
        Relative tolerance.
    """

    title: str
    bases: tuple[Base, ...]
    columns: tuple[str, ...]
    quantities: tuple[str, ...]
    solver: str
    rtol: float

    @property
    def size(self) -> int:
        """Number of runs."""
        return sum(base.size for base in self.bases)

    @property
    def chunk_size(self) -> int:
        """Runs a chunk: some 256 chunks a study, so that what is in flight is little of it."""
        smallest = _SMALLEST_BATCH if self.solver == FAST else _SMALLEST_CHUNK
        most = [MOST_RECORDS * base.size_of_record for base in self.bases if base.records]
        return min(max(-(-self.size // _CHUNKS), smallest), _LARGEST_CHUNK, *most)

    def chunks(self) -> Iterator[Chunk]:
        """All chunks, in the order of the table."""
        number, step = 0, self.chunk_size
        for i, base in enumerate(self.bases):
            for low in range(0, base.size, step):
                yield Chunk(number, i, low, min(low + step, base.size))
                number += 1

    @cached_property
    def digest(self) -> str:
        """SHA-256 of what decides the table, in hexadecimal digits."""
        return hashlib.sha256(canonical(self.described())).hexdigest()

    def described(self) -> dict[str, object]:
        """What decides the table, for the manifest."""
        return {
            "columns": self.columns,
            "quantities": self.quantities,
            "solver": self.solver,
            "rtol": self.rtol,
            "scenes": [_described(base) for base in self.bases],
            "versions": {"python": platform.python_version(), **_versions()},
        }


def _described(base: Base) -> dict[str, object]:
    pi = base.case.pi
    record = base.case.record
    return {
        "labels": base.labels,
        "case": {key: v for key, v in base.case.understood.items() if key != "title"},
        "record_sha256": None if record is None else record.sha256,
        "pi": None
        if pi is None
        else {
            "structure": pi.structure.kind.word,
            "row": pi.structure.row,
            "terms": pi.terms,
            "periods": pi.periods,
        },
        "own_duration": base.own_duration,
        "axes": [
            {"key": axis.key, "together": axis.together, "values": _values(axis)}
            for axis in base.axes
        ],
        **({"records": [member.described() for member in base.records]} if base.records else {}),
    }


def _values(axis: NumberAxis) -> object:
    """Values of an axis; of a long one its ends and its hash."""
    if axis.values.size <= 1000:
        return axis.values
    return {
        "first": axis.values[0],
        "last": axis.values[-1],
        "count": axis.values.size,
        "sha256": hashlib.sha256(axis.values.astype("<f8").tobytes()).hexdigest(),
    }


def _versions() -> dict[str, str | None]:
    found: dict[str, str | None] = {}
    for package in _PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = None
    return found
