"""What a study consists of: scenes, the axes along which each is varied, and what is kept."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from functools import cached_property

from eventpound.case.case import Case, case_of
from eventpound.case.run_options import with_given
from eventpound.case.solver_options import FAST, SolverOptions, default_solver, solver_given
from eventpound.case.suite import Member
from eventpound.case.understood import understood_case
from eventpound.errors import InputError
from eventpound.motion.base import GroundMotion
from eventpound.results.description import driven, pieces_hash
from eventpound.results.jsontext import canonical
from eventpound.results.manifest import versions
from eventpound.scene.scene import Scene
from eventpound.simulation import refuse_suite
from eventpound.study.axes import NumberAxis, sizes

PART, RECORD = "part", "record"
"""Columns that name the part of a study a row belongs to, and the record it ran under."""
_MOST_RECORDS = 64
"""Records of one chunk, at most: all of them are in memory together."""
_CHUNKS, _CHUNKS_OF_RECORDS = 256, 16
# A batch of the fast solver costs milliseconds whatever its size; other runs cost more each.
_SMALLEST_BATCH, _SMALLEST_CHUNK, _LARGEST_CHUNK = 64, 4, 2048
_RTOL = 1e-6
"""Relative tolerance of many runs of a scene that has none of its own."""
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
        """Whether each record makes a scene of its own: others go with it."""
        return any(record.beside for record in self.records)

    def under(self, record: Member) -> Base:
        """The same scene and axes under one record.

        Raises
        ------
        InputError
            Where it cannot be read.
        """
        case = replace(self.case, scene=record.on(self.case.scene))
        return replace(self, case=case, records=())


def suite_base(case: Case) -> Base:
    """A case under every record of its suite."""
    return Base(case, {}, (), False, case.members)


def base_of(
    given: Case | Scene,
    axes: tuple[NumberAxis, ...],
    records: Sequence[Member],
    solver: SolverOptions,
    length: float = math.nan,
) -> Base:
    """What a call varies, as a file would have it.

    Parameters
    ----------
    given : Case or Scene
        The scene, and how it is run.
    axes : tuple of NumberAxis
        Along which it is varied.
    records : sequence of Member
        Under which.
    solver : SolverOptions
        What computes it.
    length : float
        Length of the runs (s); NaN for that of the case or of each motion.

    Raises
    ------
    InputError
        Where the scene or its run cannot be.
    """
    case = case_of(given)
    run, own = case.run, not math.isnan(length)
    if own:
        run = replace(run, duration=length, output_step=length)
    sets_length = not math.isnan(run.duration)
    if not records:
        refuse_suite(case)
    if own or not records:
        run = with_given(run, {}, case.scene)
    case = replace(case, run=run, solver=solver, suite=None, figures=())
    return Base(case, {}, axes, sets_length, tuple(records))


def solver_of(
    given: Case | Scene, rtol: float | str | None, solver: str | None = None
) -> SolverOptions:
    """What computes many runs of a call, by default to the tolerance of its case.

    Parameters
    ----------
    given : Case or Scene
        What is run.
    rtol : float or str, optional
        Relative tolerance instead.
    solver : str, optional
        A solver with settings; by default that of many runs.

    Raises
    ------
    InputError
        Where either is none.
    """
    case = case_of(given, _RTOL)
    return solver_given(case.solver, solver or default_solver([case.scene], many=True), rtol)


def described(base: Base) -> Base:
    """The same, told by its scene as it is, which need not be that of the file any more."""
    case = base.case
    found = understood_case("", _motion(case.scene.motion), case.scene, case.run, case.solver)
    return replace(base, case=replace(case, understood=found))


def _motion(motion: GroundMotion) -> dict[str, object]:
    """A motion made in Python by its numbers; the samples of a record are in its pieces."""
    numbers = {
        field.name: getattr(motion, field.name)
        for field in fields(motion)  # type: ignore[arg-type]
        if field.name not in ("samples", "source")
    }
    return {"kind": motion.kind, **numbers}


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
class OfSuite:
    """What the table of a suite has beside its quantities.

    Parameters
    ----------
    sa : tuple of float, optional
        Period (s) and damping at which Sa of each record is given, PGV beside it; else neither.
    errors : bool
        Whether errors of the peaks are estimated.
    """

    sa: tuple[float, float] | None = None
    errors: bool = False


@dataclass(frozen=True)
class Plan:
    """Everything that decides the table of a study or a suite.

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
    suite : OfSuite, optional
        Of a suite: a row tells all of its record, and why there are no numbers.
    """

    title: str
    bases: tuple[Base, ...]
    columns: tuple[str, ...]
    quantities: tuple[str, ...]
    solver: str
    rtol: float
    suite: OfSuite | None = None

    @property
    def size(self) -> int:
        """Number of runs."""
        return sum(base.size for base in self.bases)

    @property
    def chunk_size(self) -> int:
        """Runs a chunk: some 256 chunks a study, so that what is in flight is little of it."""
        smallest = _SMALLEST_BATCH if self.solver == FAST else _SMALLEST_CHUNK
        most = [_records_at_once(base) * base.size_of_record for base in self.bases if base.records]
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
            **({} if self.suite is None else {"suite": asdict(self.suite)}),
            "versions": versions(_PACKAGES),
        }


def _records_at_once(base: Base) -> int:
    """Records of one chunk: some sixteen chunks a suite, to share the work and to go on from."""
    return min(max(len(base.records) // _CHUNKS_OF_RECORDS, 1), _MOST_RECORDS)


def _deciding(understood: Mapping[str, object]) -> dict[str, object]:
    """A case without what changes no number: its title, and units in which it is told."""
    run = understood["run"]
    assert isinstance(run, dict)
    kept = {key: value for key, value in understood.items() if key != "title"}
    return kept | {"run": {key: value for key, value in run.items() if key != "units"}}


def _described(base: Base) -> dict[str, object]:
    pi, scene = base.case.pi, base.case.scene
    return {
        "labels": base.labels,
        "case": _deciding(base.case.understood),
        # Files that the case names are in these as they were read.
        "pieces_sha256": pieces_hash(scene.motion),
        **driven(scene),
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
        **({"at_once": _records_at_once(base)} if base.records else {}),
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
