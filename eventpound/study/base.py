"""One scene of a plan: what it is, along which axes it is varied, and under which records."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace

from eventpound.case.case import Case, case_of
from eventpound.case.run_options import with_given
from eventpound.case.solver_options import SolverOptions, default_solver, solver_given
from eventpound.case.suite import Member
from eventpound.case.understood import understood_case
from eventpound.errors import InputError
from eventpound.motion.base import GroundMotion
from eventpound.scene.scene import Scene
from eventpound.study.axes import NumberAxis, sizes

PART, RECORD = "part", "record"
"""Columns that name the part of a study a row belongs to, and the record it ran under."""
_RTOL = 1e-6
"""Relative tolerance of many runs of a scene that has none of its own."""


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
        run = run.lasting(length)
    sets_length = not math.isnan(run.duration)
    if not records:
        case.refuse_suite()
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
