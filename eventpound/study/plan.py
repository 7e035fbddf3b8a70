"""What a study consists of: scenes, the axes along which each is varied, and what is kept.

It keeps any quantity of `eventpound.quantities`, as ``peaks.deck.abs_max`` or ``pi_um``; one of the
same scene without contact, ``free.peaks.deck.abs_max``; a number of the scene by its dotted key,
``spring.frame.strength`` (SI).
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

from eventpound.case.run_options import Way, refuse_options
from eventpound.case.solver_options import FAST, SolverOptions
from eventpound.case.table import suggestion
from eventpound.errors import InputError
from eventpound.quantities.lookup import chosen, names_of, quantities_asked, unstated
from eventpound.results.jsontext import canonical
from eventpound.results.manifest import driven, pieces_hash, versions
from eventpound.scene.parameters import number_places
from eventpound.scene.scene import Scene
from eventpound.simulation import check_solver
from eventpound.study.axes import NumberAxis
from eventpound.study.base import Base
from eventpound.study.forms import OfStudy
from eventpound.study.variants import check_axes

_MOST_RECORDS = 64
"""Records of one chunk, at most: all of them are in memory together."""
_CHUNKS, _CHUNKS_OF_RECORDS = 256, 16
# A batch of the fast solver costs milliseconds whatever its size; other runs cost more each.
_SMALLEST_BATCH, _SMALLEST_CHUNK, _LARGEST_CHUNK = 64, 4, 2048
# What can change the last bit of a result.
_PACKAGES = ("eventpound", "numpy", "numba", "llvmlite", "scikit-sundae")
_ACCEPTED = (
    "what `eventpound check CASE --quantities` lists, as peaks.<body>.abs_max or "
    "contacts.<contact>.impacts, or a number of the case, as spring.<spring>.strength"
)
"""What a study may tabulate, for messages."""


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
    form : OfStudy
        What its table is called, and what it has beside its quantities.
    """

    title: str
    bases: tuple[Base, ...]
    columns: tuple[str, ...]
    quantities: tuple[str, ...]
    solver: str
    rtol: float
    form: OfStudy = field(default_factory=OfStudy)

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
            **self.form.described(),
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


def default_quantities(bases: Sequence[Base]) -> tuple[str, ...]:
    """What is tabulated where a study does not say."""
    if any(base.case.scene.contacts for base in bases):
        return ("pi_um", "amplification", "impacts", "resting_time")
    return ("pi_um",)


def planned(
    bases: tuple[Base, ...], columns: Sequence[str], quantities: Sequence[str], by: SolverOptions
) -> tuple[Plan, list[str]]:
    """The plan of a study, and what is wrong with it before anything runs.

    Parameters
    ----------
    bases : tuple of Base
        Scenes, in the order of the table.
    columns : sequence of str
        Part, record and axes.
    quantities : sequence of str
        What is tabulated, by name or by path, of whatever scene has it; beside it stands what
        ``[run]`` asks for.
    by : SolverOptions
        Solver and tolerance.
    """
    study = Plan(bases[0].case.title, bases, tuple(columns), (), by.name, by.rtol)
    try:
        for base in bases:
            case = base.case
            check_solver(replace(case.solver, name=by.name, rtol=by.rtol), case.scene, case.run)
            refuse_options(base.case.run, Way.STUDY, [axis.key for axis in base.axes])
        first = [base.at_first() for base in bases]
        asked = quantities_asked((base.case.scene, base.case.run) for base in first)
    except InputError as error:
        return study, list(error.problems)
    known: dict[str, None] = {}
    for base in first:
        known |= dict.fromkeys(quantities_of(base.case.scene))
    names: dict[str, None] = {}
    problems = []
    for word in quantities or default_quantities(first):
        found = [name for base in first for name in _meant(base.case.scene, word) if name in known]
        texts = [unstated(name, base.case.run.stated) for name in found for base in first]
        if not found:
            meant = suggestion(word, list(known)) or f"; accepted: {_ACCEPTED}"
            problems.append(f"[study]: quantities: found {word!r}{meant}")
        elif all(texts):
            problems.append(f"[study]: {texts[0]}")
        names |= dict.fromkeys(found)
    study = replace(study, quantities=tuple(dict.fromkeys([*names, *asked])))
    return study, problems or [problem for base in first for problem in check_axes(base)]


def _meant(scene: Scene, word: str) -> list[str]:
    """Names of quantities or of a number of a scene by a name or a path; none where it has none."""
    try:
        return [word] if word in number_places(scene) else chosen(scene, [word])
    except InputError:
        return []


def quantities_of(scene: Scene) -> list[str]:
    """Every quantity that can be tabulated of a scene.

    Parameters
    ----------
    scene : Scene
        A checked scene.
    """
    return [*names_of(scene), *number_places(scene)]
