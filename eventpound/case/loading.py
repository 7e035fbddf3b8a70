"""From a case directory to a case, or to everything that is wrong with it."""

from __future__ import annotations

import hashlib
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from eventpound.basics.given import checked
from eventpound.basics.input_files import read_bytes
from eventpound.case.capacity import read_capacities, with_capacities
from eventpound.case.case import Case
from eventpound.case.dashpots import given_ratios
from eventpound.case.excitation import Excitation, bare_accelerations, for_scene, read_excitation
from eventpound.case.figure import Figure, one_or_several, read_figure
from eventpound.case.pi import PLACEHOLDER, read_pi, scene_of_pi, with_periods, with_unit_scales
from eventpound.case.record_file import PACKAGE
from eventpound.case.record_scaling import large_scales
from eventpound.case.run_options import RunOptions, read_run, stated_numbers, to_be_placed
from eventpound.case.scene_tables import SceneRead, at_start, read_scene, start_time
from eventpound.case.solver_options import default_solver, read_solver
from eventpound.case.suite import Suite, with_suite
from eventpound.case.supports import Driven
from eventpound.case.table import CaseProblem, Table
from eventpound.case.understood import understood_case
from eventpound.case.written_out import written_out
from eventpound.errors import InputError
from eventpound.motion.record import Record
from eventpound.scene.at_rest import at_rest
from eventpound.scene.linkage import starts_of_supports, support_warnings
from eventpound.scene.plausibility import doubts
from eventpound.scene.scene import Scene
from eventpound.scene.usual import SMALLEST_RATIO, unusual
from eventpound.units import Dimension

CASE_FILE = "case.toml"
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
    records = [motion for motion in scene.motions if isinstance(motion, Record)]
    return [(record.called, record.factor) for record in records]


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
    title = top.text("title", "some text", default=file.resolve().parent.name)
    if top.has("study"):
        # What its axes give is missing here; to say so as well would mislead.
        raise InputError(
            f"{file}: [study]: is many runs; `eventpound study` makes them, `run` makes one"
        )
    excitation = _excitation(top, file.parent)
    figures = _figures(top, excitation)
    run_table = top.table("run")
    if top.has("pi"):
        pi, read = read_pi(top), SceneRead(PLACEHOLDER)
        scene = scene_of_pi(top, pi, excitation)
        run_table = with_periods(run_table, pi, scene)
        if pi is not None and run_table.has("start") and not problems and excitation is not None:
            scene = at_start(run_table, scene, start_time(top), file.parent)
    else:
        needed = not figures or any(figure.kind.needs_scene for figure in figures)
        pi, read = None, read_scene(top, run_table, excitation, problems, needed, file.parent)
        scene = read.scene
    if excitation is not None and not problems:
        excitation, scene = _at_own_period(top, excitation, scene)
    suite = _suite(top, excitation, read.driven, file.parent)
    sound = not problems and excitation is not None
    run = read_capacities(top, read_run(run_table, scene if sound else None, suite is not None))
    solver = read_solver(top.table("solver"), default_solver([scene], many=suite is not None))
    top.close()
    if problems or excitation is None or run is None:
        raise InputError([f"{file}: {problem}" for problem in problems])
    warnings = [*read.warnings, *support_warnings(scene, run.start_time + run.duration)]
    if pi is None and scene.bodies:
        warnings += _doubts(top, document, scene, run)
    understood = understood_case(title, excitation.table, scene, run, solver, read.sources)
    return Case(
        title=title,
        scene=scene,
        run=run,
        solver=solver,
        directory=file.parent,
        source_hash=source_hash,
        record=excitation.record,
        warnings=tuple(f"{file}: {warning}" for warning in warnings),
        understood=understood
        | dict(read.driven.tables)
        | ({"figure": document["figure"]} if figures else {}),
        suite=suite,
        figures=figures,
        pi=pi,
        carried=read.carried,
        largest_scale=excitation.largest_scale,
    )


def _doubts(
    top: Table, document: Mapping[str, object], scene: Scene, options: RunOptions
) -> Iterator[str]:
    """What of a sound case is hardly meant so, or unlike earthquakes and structures."""
    kinds = ("dashpot", "rayleigh", "modal_damping")
    ratios = given_ratios([each for kind in kinds for each in top.tables(kind)])
    run = stated_numbers(top.table("run"), options)
    yield from doubts(scene, run, ratios, bare_accelerations(document), options.start_time)
    yield from unusual(scene, _given(top, run, ratios))


def _given(
    top: Table, run: Mapping[str, float], ratios: Sequence[tuple[str, float]]
) -> dict[str, tuple[str, float]]:
    """Numbers of a sound case that its scene has not, by rows of `USUAL`: where, and in SI."""
    found = {f"run.{key}": ("run", value) for key, value in run.items()}
    small = [each for each in ratios if 0.0 < each[1] < SMALLEST_RATIO]
    found |= {"damping.ratio": small[0]} if small else {}
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


def _at_own_period(top: Table, excitation: Excitation, scene: Scene) -> tuple[Excitation, Scene]:
    """Motion and scene with records scaled at a period of the scene, if the case says so."""
    start = start_time(top)
    with top.table("excitation").noting("psa_period"):
        own = for_scene(excitation, at_rest(scene, start))
        if own is excitation:
            return own, scene
        moved = replace(scene, motion=own.motion, across=own.across)
        if top.has("pi"):
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
    suite = replace(excitation.suite, beside=(*excitation.suite.beside, *driven.suites))
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
