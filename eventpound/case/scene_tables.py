"""The scene that the tables of a case make, as its run is to start; what is wrong is noted."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from eventpound.basics.input_files import read_bytes
from eventpound.case.bearings import read_bearings
from eventpound.case.damping import read_group_damping
from eventpound.case.dashpots import read_dashpot
from eventpound.case.decks import read_decks
from eventpound.case.elements import read_body, read_contacts, read_seats
from eventpound.case.excitation import Excitation
from eventpound.case.pi import OF_SCENE
from eventpound.case.run_options import EQUILIBRIUM, INITIAL, to_be_placed
from eventpound.case.spring_stiffness import masses_carried
from eventpound.case.springs import read_springs
from eventpound.case.supports import Driven, read_driven
from eventpound.case.table import CaseProblem, Table
from eventpound.case.understood import SOURCED
from eventpound.errors import InputError
from eventpound.motion.free import NoMotion
from eventpound.scene.at_rest import at_rest
from eventpound.scene.check import scene_problems, scene_warnings
from eventpound.scene.contact_law import IMPACT_LAWS, NEWTON
from eventpound.scene.continuation import continued
from eventpound.scene.joint import ENDS
from eventpound.scene.plan_point import DIRECTIONS
from eventpound.scene.problem import Problem
from eventpound.scene.scene import Scene
from eventpound.scene.spring import Linear
from eventpound.units import Dimension, quantity

_LAW = "impact_law"
SUMMARY = "summary.json"
"""Of a run, as `eventpound.results` writes it; another case may go on from its final state."""


@dataclass(frozen=True)
class SceneRead:
    """A scene, and what its tables say beside it.

    Parameters
    ----------
    scene : Scene
        What moves.
    warnings : list of str
        What is hardly meant so.
    carried : mapping of str to float
        Mass (kg) that the period of a spring refers to, by its name.
    driven : Driven
        Supports and forces.
    sources : mapping of str to list of str
        Where numbers are from, of each of `SOURCED`.
    """

    scene: Scene
    warnings: list[str] = field(default_factory=list)
    carried: Mapping[str, float] = field(default_factory=dict)
    driven: Driven = field(default_factory=Driven)
    sources: Mapping[str, list[str]] = field(default_factory=dict)


def read_scene(
    top: Table,
    run: Table,
    excitation: Excitation | None,
    problems: list[CaseProblem],
    needed: bool,
    directory: Path,
) -> SceneRead:
    """The scene of the tables of a case; what is wrong with it is added to the problems.

    Parameters
    ----------
    top, run : Table
        The case, and its ``[run]``.
    excitation : Excitation or None
        Its ground motion, where that is sound.
    problems : list of CaseProblem
        Of the case.
    needed : bool
        Whether it has to have a body.
    directory : Path
        Of the case, to which files are relative.
    """
    tables = {kind: top.tables(kind) for kind in OF_SCENE}
    said = "where its numbers are from"
    sources = {kind: [t.text("source", said, "") for t in tables[kind]] for kind in SOURCED}
    in_plan = read_decks(tables["deck"], tables["joint"])
    carrying = read_bearings(tables["pier"], tables["bearing"], in_plan)
    piers = [body for body, _ in carrying.bodies]
    bodies = [*(read_body(table) for table in tables["body"]), *piers, *in_plan.bodies]
    masses = {body.name: body.mass for body in bodies}
    driven = read_driven(tables["support"], tables["force"], masses, directory, excitation)
    supports = [support.name for support in driven.supports]
    springs = read_springs(tables["spring"], masses, supports, in_plan.decks)
    scene = Scene(
        tuple(bodies),
        (*springs, *(spring for spring, _ in carrying.springs)),
        contacts=(*read_contacts(tables["contact"], in_plan.decks), *in_plan.contacts),
        motion=NoMotion() if excitation is None else excitation.motion,
        supports=driven.supports,
        forces=driven.forces,
        seats=read_seats(tables["seat"]),
        decks=in_plan.decks,
        across=NoMotion() if excitation is None else excitation.across,
        attack=0.0 if excitation is None else excitation.attack,
        impact_law=(top.has(_LAW) and top.choice(_LAW, IMPACT_LAWS)) or NEWTON,
    )
    # Where the problems of what they stand for are noted.
    own = tables["spring"].copy()
    tables["body"] += [table for _, table in carrying.bodies]
    tables["body"] += [table for table in tables["deck"] for _ in DIRECTIONS]
    tables["spring"] += [table for _, table in carrying.springs]
    tables["contact"] += [table for table in tables["joint"] for _ in ENDS]
    start = start_time(top)
    wrong = scene_problems(scene, None)
    if run.has("start") and not (problems or wrong):
        scene = at_start(run, scene, start, directory)
    resting = at_rest(_without(scene, wrong) if wrong else scene, start)
    dashpots = [
        read_dashpot(table, masses, resting.springs, supports, in_plan.decks)
        for table in tables["dashpot"]
    ]
    dashpots += [dashpot for dashpot, _ in carrying.dashpots]
    tables["dashpot"] += [table for _, table in carrying.dashpots]
    groups = tables["rayleigh"], tables["modal_damping"]
    of_groups = read_group_damping(*groups, bodies, resting.springs, supports)
    scene = replace(scene, dashpots=(*dashpots, *of_groups))
    if not bodies and needed:
        top.report("[[body]]", "missing; accepted: at least one body, or a deck")
    elif bodies:
        # Where bodies are to be placed or go on, they need not be where they can be.
        elsewhere = _starts_elsewhere(top.data.get("run"))
        _add_scene_problems(scene, tables, problems, None if elsewhere else start)
    warnings = list(scene_warnings(scene)) if bodies else []
    warnings += [] if excitation is None or excitation.record is None else excitation.record.notes
    carried = {} if problems else masses_carried(own, springs, masses, supports)
    return SceneRead(scene, warnings, carried, driven, sources)


def _without(scene: Scene, wrong: Sequence[Problem]) -> Scene:
    """Springs alone, the wrong ones without a stiffness: what follows from it is not noted."""
    bad = {problem.position for problem in wrong if problem.kind == "spring"}
    unknown = Linear(math.nan)
    springs = enumerate(scene.springs, 1)
    return Scene((), tuple(replace(s, law=unknown) if i in bad else s for i, s in springs))


def _add_scene_problems(
    scene: Scene,
    tables: Mapping[str, list[Table]],
    problems: list[CaseProblem],
    start: float | None,
) -> None:
    """Add what is wrong with a scene and was not noted while its tables were read."""
    noted = {(problem.where, problem.key) for problem in problems}
    nameless = any(not body.name for body in scene.bodies)
    for problem in scene_problems(scene, start):
        # No table gives NaN: it stands for a value that was noted when it was read.
        placeholder = isinstance(problem.found, float) and math.isnan(problem.found)
        if placeholder or (problem.key == "between" and nameless):
            continue
        if problem.kind in ("excitation", "scene"):
            text = f"found {problem.found}; accepted: {problem.accepted}"
            place = ("[excitation]", "") if problem.kind == "excitation" else ("", problem.key)
            problems.append(CaseProblem(*place, text))
            continue
        if problem.position > len(tables[problem.kind]):
            # A dashpot of a group; wrong masses and coefficients were noted as such.
            if not problems:
                where = "[[rayleigh]]" if tables["rayleigh"] else "[[modal_damping]]"
                problems.append(CaseProblem(where, "", f"adds {problem}"))
            continue
        table = tables[problem.kind][problem.position - 1]
        if (table.where, problem.key) not in noted:
            found = table.data.get(problem.key, problem.found)
            text = f"found {found!r}; accepted: {problem.accepted}"
            problems.append(CaseProblem(table.where, problem.key, text))


def _starts_elsewhere(run: object) -> bool:
    """Whether ``[run]``, as it is written, puts the bodies elsewhere than their tables do."""
    return to_be_placed(run) or (isinstance(run, dict) and isinstance(run.get("start"), dict))


def at_start(run: Table, scene: Scene, start: float, directory: Path) -> Scene:
    """The scene as the run is to start: as given, in equilibrium, or where another run ended."""
    if isinstance(run.data["start"], dict):
        return _after(run.table("start"), scene, start, directory)
    run.choice("start", (INITIAL, EQUILIBRIUM))
    if not to_be_placed(run.data):
        return scene
    from eventpound.scene.statics import in_equilibrium

    try:
        return in_equilibrium(scene, start)
    except InputError as error:
        run.report("start", str(error).removeprefix("start: "))
        return scene


def _after(table: Table, scene: Scene, start: float, directory: Path) -> Scene:
    """The scene in the state in which a run ended, whose results are in a folder."""
    accepted = f'a folder with a {SUMMARY} of `eventpound run`, or its case: "../mainshock"'
    name = table.text("results", accepted)
    table.close()
    if not name:
        return scene
    folder = directory / name
    try:
        found = folder if (folder / SUMMARY).exists() else folder / "results"
        summary = json.loads(read_bytes(found / SUMMARY))
        if not (isinstance(summary, dict) and isinstance(summary.get("final"), dict)):
            raise ValueError("no summary of a run")
        if not summary.get("success"):
            raise InputError(f"found {name!r}, a run that did not reach its end")
        return continued(scene, summary["final"], start)
    except (OSError, ValueError):
        table.reject("results", accepted)
    except InputError as error:
        for problem in error.problems:
            table.report("results", problem.removeprefix("start: "))
    return scene


def start_time(top: Table) -> float:
    """When the run starts (s); 0 where that cannot be read, which is noted elsewhere."""
    run = top.data.get("run")
    given = run.get("start_time", 0.0) if isinstance(run, dict) else 0.0
    try:
        return quantity(given, Dimension.TIME)
    except InputError:
        return 0.0
