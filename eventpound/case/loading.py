"""From a case directory to a case, or to everything that is wrong with it."""

from __future__ import annotations

import hashlib
import json
import math
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from eventpound.basics.given import checked
from eventpound.basics.input_files import read_bytes
from eventpound.case.capacity import read_capacities, with_capacities
from eventpound.case.case import Case
from eventpound.case.damping import read_group_damping
from eventpound.case.dashpots import given_ratios, read_dashpot
from eventpound.case.elements import read_body, read_contacts, read_seats
from eventpound.case.excitation import Excitation, bare_accelerations, for_scene, read_excitation
from eventpound.case.figure import Figure, one_or_several, read_figure
from eventpound.case.pi import OF_SCENE, read_pi, scene_of_pi, with_periods, with_unit_scales
from eventpound.case.record_file import PACKAGE
from eventpound.case.record_scaling import large_scales
from eventpound.case.run_options import EQUILIBRIUM, INITIAL, RunOptions, read_run, to_be_placed
from eventpound.case.solver_options import default_solver, read_solver
from eventpound.case.spring_stiffness import masses_carried
from eventpound.case.springs import read_springs
from eventpound.case.suite import Suite, with_suite
from eventpound.case.supports import Driven, read_driven
from eventpound.case.table import CaseProblem, Table
from eventpound.case.understood import SOURCED, understood_case
from eventpound.case.written_out import written_out
from eventpound.errors import InputError
from eventpound.motion.free import NoMotion
from eventpound.motion.record import Record
from eventpound.scene.at_rest import at_rest
from eventpound.scene.check import Problem, scene_problems, scene_warnings
from eventpound.scene.continuation import continued
from eventpound.scene.linkage import starts_of_supports, support_warnings
from eventpound.scene.plausibility import doubts
from eventpound.scene.scene import Scene
from eventpound.scene.spring import Linear
from eventpound.scene.usual import SMALLEST_RATIO, unusual
from eventpound.units import Dimension, quantity

CASE_FILE = "case.toml"
SUMMARY = "summary.json"
"""Of a run, as `eventpound.results` writes it; another case may go on from its final state."""
MOST_BYTES = 2**24
"""Of it; ten thousand bodies take some 3 000 000."""
_MOST_PARTS = 64
# Dotted keys: tomllib's time grows with the square of their parts.
_PART = r"""(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')"""
_ENDLESS_KEY = re.compile(rf"(?<![\w.\"'-])(?:{_PART}[ \t]*+\.[ \t]*+){{{_MOST_PARTS}}}")


@checked
def load_case(path: str | Path, suite: str | None = None) -> Case:
    """Load a case.

    Parameters
    ----------
    path : str or Path
        Directory of the case, or its ``case.toml``.
    suite : str, optional
        Pattern of records, or a list of them, that take the place of the case's own
        records; relative to the working directory.

    Returns
    -------
    Case
        In SI, with every default filled in.

    Raises
    ------
    InputError
        With one line for every problem: file, table, key, what was found and
        what is accepted.

    Examples
    --------
    >>> case = load_case("cases/bridge-pulse")
    >>> [body.name for body in case.scene.bodies]
    ['segment1', 'segment2']
    """
    document, file, source_hash = read_document(path)
    if suite is not None:
        document = _with_suite(document, file, suite)
    case = read_case(document, file, source_hash)
    text = large_scales(_factors(case.scene), case.largest_scale)
    said = (f"{file}: [excitation]: {text}",) if text else ()
    return replace(case, warnings=(*said, *case.warnings))


def _factors(scene: Scene) -> list[tuple[str, float]]:
    """Factors on the records of the ground and of supports, by the names of their files."""
    motions = [scene.motion, *(support.motion for support in scene.supports)]
    return [(motion.called, motion.factor) for motion in motions if isinstance(motion, Record)]


def read_document(path: str | Path) -> tuple[dict[str, object], Path, str]:
    """Tables of the file of a case, before anything is understood of them.

    Parameters
    ----------
    path : str or Path
        Directory of the case, or its ``case.toml``.

    Returns
    -------
    dict
        As tomllib gives it.
    Path
        The file.
    str
        SHA-256 of the file, in hexadecimal digits.

    Raises
    ------
    InputError
        Where there is no such file or it is not valid TOML.
    """
    file = _case_file(Path(path))
    try:
        content = read_bytes(file, MOST_BYTES)
        document = tomllib.loads(_text(content))
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{file}: is not UTF-8 text (byte {error.start})") from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"{file}: is not valid TOML: {error}") from error
    return document, file, hashlib.sha256(content).hexdigest()


def _text(content: bytes) -> str:
    """Text of a file, without the mark that some editors begin it with.

    Raises
    ------
    ValueError
        Where it is not UTF-8, or has a key of so many parts that reading it would take long.
    """
    text = content.decode("utf-8-sig")
    found = _ENDLESS_KEY.search(text)
    if found is not None:
        line = text.count("\n", 0, found.start()) + 1
        raise ValueError(f"a key of more than {_MOST_PARTS} parts (at line {line})")
    return text


def read_case(document: Mapping[str, object], file: Path, source_hash: str = "") -> Case:
    """Make a case of the tables of its file.

    Parameters
    ----------
    document : mapping
        As tomllib gives it; ``Case.understood`` is one too.
    file : Path
        The file, for messages; record files are relative to its directory.
    source_hash : str
        SHA-256 of the file.

    Returns
    -------
    Case
        In SI, with every default filled in.

    Raises
    ------
    InputError
        With one line for every problem.
    """
    document = with_capacities(written_out(document, file), file)
    problems: list[CaseProblem] = []
    top = Table(with_unit_scales(document), "", problems)
    start = _start_time(top)
    title = top.text("title", "some text", default=file.resolve().parent.name)
    if top.has("study"):
        # What its axes give is missing here; to say so as well would mislead.
        raise InputError(
            f"{file}: [study]: is many runs; `eventpound study` makes them, `run` makes one"
        )
    excitation = _excitation(top, file.parent)
    figures = _figures(top, excitation)
    pi, run_table, warnings, carried = None, top.table("run"), list[str](), dict[str, float]()
    driven, sources = Driven(), dict[str, list[str]]()
    if top.has("pi"):
        pi = read_pi(top)
        scene = scene_of_pi(top, pi, excitation)
        run_table = with_periods(run_table, pi, scene)
    else:
        needed = not figures or any(figure.kind.needs_scene for figure in figures)
        scene, warnings, carried, driven, sources = _read_scene(
            top, excitation, problems, needed, run_table, file.parent
        )
    if pi is not None and run_table.has("start") and not problems and excitation is not None:
        scene = _at_start(run_table, scene, start, file.parent)
    if excitation is not None and not problems:
        excitation, scene = _at_own_period(top, excitation, scene, start, pi is not None)
    suite = _suite(top, excitation, driven, file.parent)
    sound = not problems and excitation is not None
    run = read_capacities(top, read_run(run_table, scene if sound else None, suite is not None))
    solver = read_solver(top.table("solver"), default_solver([scene], many=suite is not None))
    top.close()
    if problems or excitation is None or run is None:
        raise InputError([f"{file}: {problem}" for problem in problems])
    warnings += support_warnings(scene, run.start_time + run.duration)
    if pi is None and scene.bodies:
        damped = [
            each for kind in ("dashpot", "rayleigh", "modal_damping") for each in top.tables(kind)
        ]
        ratios = given_ratios(damped)
        step = run.output_step if run_table.has("output_step") else None
        warnings += doubts(scene, step, ratios, bare_accelerations(document), start)
        warnings += unusual(scene, _given(top, run, ratios))
    return Case(
        title=title,
        scene=scene,
        run=run,
        solver=solver,
        directory=file.parent,
        source_hash=source_hash,
        record=excitation.record,
        warnings=tuple(f"{file}: {warning}" for warning in warnings),
        understood=understood_case(title, excitation.table, scene, run, solver, sources)
        | dict(driven.tables)
        | ({"figure": document["figure"]} if figures else {}),
        suite=suite,
        figures=figures,
        pi=pi,
        carried=carried,
        largest_scale=excitation.largest_scale,
    )


def _given(
    top: Table, run: RunOptions, ratios: Sequence[tuple[str, float]]
) -> dict[str, tuple[str, float]]:
    """Numbers of a sound case that its scene has not, by rows of `USUAL`: where, and in SI."""
    found = {
        "run.start_time": ("run", run.start_time),
        "run.threshold_speed": ("run", run.stated.threshold_speed),
    }
    small = [each for each in ratios if 0.0 < each[1] < SMALLEST_RATIO]
    found |= {"damping.ratio": small[0]} if small else {}
    if top.table("run").has("duration"):
        found["run.duration"] = "run", run.duration
    excitation = top.table("excitation")
    for key, dimension in (("rest", Dimension.TIME), ("psa_damping", Dimension.NUMBER)):
        if excitation.has(key):
            found[f"excitation.{key}"] = "excitation", excitation.quantity(key, dimension)
    for spring in top.tables("spring"):
        if spring.has("wall_width"):
            width = spring.quantity("wall_width", Dimension.LENGTH)
            if "spring.wall_width" not in found or width > found["spring.wall_width"][1]:
                found["spring.wall_width"] = spring.where, width
    return found


def _excitation(top: Table, directory: Path) -> Excitation | None:
    if not top.has("excitation"):
        top.report("[excitation]", 'missing; accepted: a table with kind ("none" for free motion)')
        return None
    return read_excitation(top.table("excitation"), directory)


def _at_own_period(
    top: Table, excitation: Excitation, scene: Scene, start: float, of_pi: bool
) -> tuple[Excitation, Scene]:
    """Motion and scene with records scaled at a period of the scene, if the case says so."""
    with top.table("excitation").noting("psa_period"):
        own = for_scene(excitation, at_rest(scene, start))
        if own is excitation:
            return own, scene
        moved = replace(scene, motion=own.motion)
        if of_pi:
            raise InputError(
                "found a period of the scene, which [pi] makes; accepted: a period (s)"
            )
        places = (starts_of_supports(each, start) for each in (scene, moved))
        if to_be_placed(top.data.get("run")) and next(places) != next(places):
            raise InputError(
                "found a period of the scene, whose equilibrium follows from supports that this "
                "scale has moved before the start; accepted: a period (s)"
            )
        return own, moved
    return excitation, scene


def _suite(
    top: Table, excitation: Excitation | None, driven: Driven, directory: Path
) -> Suite | None:
    """The records of the case with those of supports; where their numbers differ, that is noted."""
    if excitation is None or excitation.suite is None:
        return None
    suite = replace(excitation.suite, supports=driven.suites)
    with top.noting("[[support]]"):
        suite.members(directory)
    return suite


def _with_suite(document: Mapping[str, object], file: Path, pattern: str) -> dict[str, object]:
    """The document with other records."""
    excitation = document.get("excitation")
    if not isinstance(excitation, dict) or excitation.get("kind") != "record":
        raise InputError(f'{file}: [excitation]: a suite takes the place of kind = "record" only')
    own = pattern if pattern.startswith(PACKAGE) else str(Path(pattern).absolute())
    return {**document, "excitation": with_suite(excitation, own)}


def _figures(top: Table, excitation: Excitation | None) -> tuple[Figure, ...]:
    tables = one_or_several(top, "figure")
    bodies = [body.data.get("name") for body in Table(top.data, "", []).tables("body")]
    names = [name for name in bodies if isinstance(name, str)]
    found, files = [], set[str]()
    for table in tables:
        if excitation is not None and excitation.suite is None:
            table.report("", "draws records; accepted: [excitation] with suite or synthetic")
        if (figure := read_figure(table, names)) is not None:
            if figure.name in files:
                table.report("name", f"found {figure.name!r} twice; accepted: a name of its own")
            files.add(figure.name)
            found.append(figure)
    return tuple(found)


def _read_scene(
    top: Table,
    excitation: Excitation | None,
    problems: list[CaseProblem],
    needed: bool,
    run: Table,
    directory: Path,
) -> tuple[Scene, list[str], dict[str, float], Driven, dict[str, list[str]]]:
    """Scene, warnings, masses that springs carry, supports and forces, sources of numbers.

    What is wrong is added to the problems.
    """
    tables = {kind: top.tables(kind) for kind in OF_SCENE}
    said = "where its numbers are from"
    sources = {kind: [t.text("source", said, "") for t in tables[kind]] for kind in SOURCED}
    bodies = [read_body(table) for table in tables["body"]]
    masses = {body.name: body.mass for body in bodies}
    in_suite = excitation is not None and excitation.suite is not None
    given = tables["support"], tables["force"]
    driven = read_driven(*given, masses, directory, in_suite=in_suite)
    supports = [support.name for support in driven.supports]
    springs = read_springs(tables["spring"], masses, supports)
    scene = Scene(
        tuple(bodies),
        springs,
        contacts=read_contacts(tables["contact"]),
        motion=NoMotion() if excitation is None else excitation.motion,
        supports=driven.supports,
        forces=driven.forces,
        seats=read_seats(tables["seat"]),
    )
    start = _start_time(top)
    wrong = scene_problems(scene, None)
    if run.has("start") and not (problems or wrong):
        scene = _at_start(run, scene, start, directory)
    resting = at_rest(_without(scene, wrong) if wrong else scene, start)
    dashpots = [
        read_dashpot(table, masses, resting.springs, supports) for table in tables["dashpot"]
    ]
    groups = tables["rayleigh"], tables["modal_damping"]
    of_groups = read_group_damping(*groups, bodies, resting.springs, supports)
    scene = replace(scene, dashpots=(*dashpots, *of_groups))
    if not bodies and needed:
        top.report("[[body]]", "missing; accepted: at least one body")
    elif bodies:
        # Where bodies are to be placed or go on, they need not be where they can be.
        elsewhere = _starts_elsewhere(top.data.get("run"))
        _add_scene_problems(scene, tables, problems, None if elsewhere else start)
    warnings = list(scene_warnings(scene)) if bodies else []
    warnings += [] if excitation is None or excitation.record is None else excitation.record.notes
    carried = {} if problems else masses_carried(tables["spring"], springs, masses, supports)
    return scene, warnings, carried, driven, sources


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
        if problem.kind == "excitation":
            text = f"found {problem.found}; accepted: {problem.accepted}"
            problems.append(CaseProblem("[excitation]", "", text))
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


def _at_start(run: Table, scene: Scene, start: float, directory: Path) -> Scene:
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


def _start_time(top: Table) -> float:
    """When the run starts (s); 0 where that cannot be read, which is noted elsewhere."""
    run = top.data.get("run")
    given = run.get("start_time", 0.0) if isinstance(run, dict) else 0.0
    try:
        return quantity(given, Dimension.TIME)
    except InputError:
        return 0.0


def _case_file(path: Path) -> Path:
    if path.is_dir():
        file = path / CASE_FILE
        if not file.is_file():
            raise InputError(
                f"{path}: no {CASE_FILE} in this directory; `eventpound new DIR` writes one"
            )
        return file
    if not path.exists():
        raise InputError(f"{path}: no such file or directory")
    return path
