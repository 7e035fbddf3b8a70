"""A case that was read, whole, and that of one record of its suite."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from eventpound.case.figure import Figure
from eventpound.case.record_scaling import LARGEST_SCALE, RecordScaling
from eventpound.case.run_options import DEFAULTS, RunOptions
from eventpound.case.solver_options import SolverOptions
from eventpound.case.suite import ATTACK, SECOND, Member, Suite
from eventpound.case.understood import sources_of, understood_case
from eventpound.errors import InputError
from eventpound.motion.readers.base import RecordData
from eventpound.scene.pi_structure import PiStructure
from eventpound.scene.scene import Scene


@dataclass(frozen=True, slots=True)
class PiTable:
    """What a case written in Π-terms says.

    Parameters
    ----------
    structure : PiStructure
        Kind and row of the structures.
    terms : mapping of str to float
        Π-terms as they are given, by the keys of `eventpound.scene.pi_terms`.
    periods : float or None
        Length of the run in periods T_p = 2 pi / omega_g.
    """

    structure: PiStructure
    terms: Mapping[str, float]
    periods: float | None


@dataclass(frozen=True, slots=True)
class Case:
    """Everything that a case directory says.

    Parameters
    ----------
    title : str
        One line; the name of the directory where none is given.
    scene : Scene
        What moves.
    run : RunOptions
        What is to be computed.
    solver : SolverOptions
        What computes it.
    directory : Path
        Where the case lies.
    source_hash : str
        SHA-256 of ``case.toml``, in hexadecimal digits.
    record : RecordData or None
        What was read from the file of a record.
    warnings : tuple of str
        What is computed as asked for, though it is hardly meant so.
    understood : dict
        The case in SI with every default filled in: a case again, which can be
        written as JSON or TOML.
    suite : Suite or None
        The records the scene is to run under, one after the other. The motion of
        the scene is then none, and times of `run` that each record sets are NaN.
    figures : tuple of Figure
        What is drawn.
    pi : PiTable or None
        The Π-terms of a case that is written in them.
    carried : mapping of str to float
        Mass (kg) that the period of a spring refers to, by the names of springs given by one.
    largest_scale : float
        Factor on a record beyond which is warned.
    """

    title: str
    scene: Scene
    run: RunOptions
    solver: SolverOptions
    directory: Path
    source_hash: str
    record: RecordData | None
    warnings: tuple[str, ...]
    understood: dict[str, object]
    suite: Suite | None = None
    figures: tuple[Figure, ...] = ()
    pi: PiTable | None = None
    carried: Mapping[str, float] = field(default_factory=dict)
    largest_scale: float = LARGEST_SCALE

    @property
    def members(self) -> tuple[Member, ...]:
        """Records of its suite; none of a case of one run."""
        return () if self.suite is None else tuple(self.suite.members(self.directory))

    @property
    def size(self) -> RecordScaling:
        """How large every record of its suite is made."""
        return RecordScaling() if self.suite is None else self.suite.options.size

    def records_at(self, name: str = "") -> dict[str, object]:
        """What is told of the records of a suite for the ground, or a support or component.

        Nothing of a case of one run.
        """
        if self.suite is None:
            return {}
        suite, at = self.suite, self.directory
        return suite.told_at(name, at) if name else suite.told(at)

    def refuse_suite(self) -> None:
        """Raise an `InputError` for a case of many records where one run is meant."""
        if self.suite is not None:
            raise InputError(
                "the case holds a suite of records, which `eventpound run` and simulate_suite run; "
                "for one of them give its `file` in [excitation], not `suite` or `synthetic`"
            )

    def apart(self, scene: Scene) -> Case:
        """The same of another scene, of which nothing is asked beyond what it gives."""
        return replace(self, scene=scene, run=replace(self.run, stated=DEFAULTS))

    def __repr__(self) -> str:
        scene = self.scene
        many = "" if self.suite is None else ", a suite of records"
        return (
            f"<Case {self.title!r}: {len(scene.bodies)} bodies, {len(scene.springs)} springs, "
            f"{len(scene.dashpots)} dashpots, {len(scene.contacts)} contacts, {scene.motion.kind}"
            f"{many}; {self.solver.name}, rtol {self.solver.rtol:g}>"
        )


def case_of(given: Case | Scene, rtol: float = 1e-9) -> Case:
    """A case as it is, or that of a scene, which says nothing else."""
    if isinstance(given, Case):
        return given
    return Case("", given, RunOptions(), SolverOptions(rtol=rtol), Path(), "", None, (), {})


def member_of(case: Case, name: str) -> Member:
    """A record of the suite of a case, by its name."""
    return next(member for member in case.members if member.name == name)


def member_case(case: Case, member: Member, data: RecordData) -> Case:
    """What a suite's case says for one of its records.

    Parameters
    ----------
    case : Case
        Of the suite.
    member : Member
        Which record.
    data : RecordData
        What was read of it.

    Returns
    -------
    Case
        A case of one record.

    Raises
    ------
    InputError
        Where the record cannot be used, or sets no duration.
    """
    scene = replace(member.on(case.scene), motion=member.options.motion(data))
    run = case.run.completed(scene)
    given: Any = case.understood["excitation"]
    read = {key: given[key] for key in (SECOND, ATTACK) if key in given} | member.of_file(data)
    records = {name: own.of_file(own.read()) for name, own in member.beside}
    read |= {SECOND: records.pop(SECOND)} if SECOND in records else {}
    sources = sources_of(case.understood)
    understood = understood_case(case.title, read, scene, run, case.solver, sources)
    driven: dict[str, Any] = {
        key: case.understood[key] for key in ("support", "force") if key in case.understood
    }
    if records:
        driven["support"] = [
            {**table, "excitation": records[table["name"]]} if table["name"] in records else table
            for table in driven["support"]
        ]
    return replace(
        case,
        title=f"{case.title}: {member.name}",
        scene=scene,
        run=run,
        record=data,
        suite=None,
        figures=(),
        understood=understood | driven,
    )
