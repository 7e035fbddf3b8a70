"""The tables ``[study]`` and ``[figure]`` of a case.

[study]
quantities = ["pi_um", "impacts"]      # what is tabulated
records = "folder/*.AT2"               # under each of which all axes vary
[[study.axis]]                         # one a key, the last one fastest
key = "pi.Q"
from = 0.05
to = 2.0
count = 200
[[study.part]]                         # other tables of the case, and further axes
name = "elastic"
pi = { structure = "elastic" }
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

from eventpound.case.loading import read_case, read_document
from eventpound.case.run_options import Way, without_effect, without_part
from eventpound.case.solver_options import default_solver, read_solver
from eventpound.case.suite import RECORDS, with_suite
from eventpound.case.table import CaseProblem, Table
from eventpound.errors import InputError, told_of
from eventpound.scene.periods import T_1
from eventpound.study.axes import OF_PLAN, PI, NumberAxis, WordAxis, read_axes
from eventpound.study.base import PART, RECORD, Base
from eventpound.study.figure import FigurePlan, read_figures
from eventpound.study.intensity import IntensityPlan, read_intensities
from eventpound.study.kinds import has_records
from eventpound.study.plan import Plan, planned
from eventpound.study.table import manifest_there

_Document = Mapping[str, object]
_OF_STUDY = ("study", "figure", "intensity")
_OVERRIDES = ("excitation", "pi", "run", "solver", "body", "spring", "dashpot", "contact")
_PSA = "excitation.psa"


@dataclass(frozen=True)
class StudyCase:
    """A case with a ``[study]``.

    Parameters
    ----------
    study : Plan
        What decides its table.
    figures : tuple of FigurePlan
        How the table is drawn.
    intensities : tuple of IntensityPlan
        Fractile curves that are made of it.
    directory : Path
        Where the case lies.
    warnings : tuple of str
        Of its scenes, each once.
    """

    study: Plan
    figures: tuple[FigurePlan, ...]
    intensities: tuple[IntensityPlan, ...]
    directory: Path
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class _Part:
    """Tables of one part and its axes, those of all parts first."""

    name: str
    tables: _Document
    axes: tuple[NumberAxis | WordAxis, ...]


def load_study(path: str | Path) -> StudyCase:
    """Load a case with a ``[study]``.

    Parameters
    ----------
    path : str or Path
        Directory of the case, or its ``case.toml``.

    Returns
    -------
    StudyCase
        Checked: every value of every axis by itself makes a scene that can be run.

    Raises
    ------
    InputError
        With one line for every problem.
    """
    document, file, source_hash = read_document(path)
    if "study" not in document:
        raise InputError(f"{file}: [study]: missing; `eventpound run` makes the run of this case")
    problems: list[CaseProblem] = []
    top = Table(document, "", problems)
    table = top.table("study")
    quantities = table.texts("quantities", "a list of texts") if table.has("quantities") else ()
    rest = {key: v for key, v in document.items() if key not in _OF_STUDY}
    if table.has("records"):
        rest["excitation"] = _under_records(table, document.get("excitation"))
    parts = _read_parts(table, file.parent, has_records(rest))
    table.close()
    keys = tuple(dict.fromkeys(axis.key for part in parts for axis in part.axes))
    figures, intensities = read_figures(top), read_intensities(top)
    _raise(problems, file)
    named = any(part.name for part in parts)
    bases = tuple(base for part in parts for base in _bases(part, rest, file, source_hash, named))
    columns = (*([PART] if named else []), *([RECORD] if has_records(rest) else []), *keys)
    unnamed = default_solver([base.case.scene for base in bases], many=True)
    solver = read_solver(Table(_table(rest, "solver"), "[solver]", problems), unnamed)
    _raise(problems, file)
    study, found = planned(bases, columns, quantities, solver)
    plans: tuple[FigurePlan | IntensityPlan, ...] = (*figures, *intensities)
    found += [problem for plan in plans for problem in plan.problems(study)]
    _raise(list(dict.fromkeys(found)), file)
    warnings = dict.fromkeys(w for base in bases for w in base.case.warnings)
    doubts = (f"{file}: {doubt}" for plan in intensities for doubt in plan.doubts())
    warnings |= dict.fromkeys(doubts)
    given = {key for tables in (rest, *(p.tables for p in parts)) for key in _table(tables, "run")}
    if left := [option for option in without_effect(Way.STUDY) if option in given]:
        warnings[f"{file}: {without_part(left, Way.STUDY)}"] = None
    return StudyCase(study, figures, intensities, file.parent, tuple(warnings))


def load_finished(path: Path, results: Path | None) -> tuple[StudyCase, Path, dict[str, object]]:
    """Load a case with a ``[study]`` whose table is made.

    Parameters
    ----------
    path : Path
        Directory of the case.
    results : Path, optional
        Where the table is, if not in ``results`` of the case.

    Returns
    -------
    StudyCase
        The study.
    Path
        Where its table is.
    dict
        The manifest of the table.

    Raises
    ------
    InputError
        Where there is no table, or one of another state of the case.
    """
    case = load_study(path)
    out = results or case.directory / "results"
    manifest = manifest_there(out)
    if manifest is None or manifest.get("study_sha256") != case.study.digest:
        raise InputError(f"{out}: no table of this case as it is; `eventpound study` makes it")
    return case, out, manifest


def _raise(problems: Sequence[object], file: Path) -> None:
    if problems:
        raise InputError([f"{file}: {problem}" for problem in problems])


def _table(document: _Document, key: str) -> _Document:
    given = document.get(key)
    return given if isinstance(given, dict) else {}


def _under_records(study: Table, excitation: object) -> _Document:
    """``[excitation]`` with the records of ``[study]``, which are relative to the case, too."""
    pattern = study.text("records", RECORDS)
    given = excitation if isinstance(excitation, dict) else {"kind": "record"}
    if given.get("kind") != "record":
        study.reject("records", 'no records, where [excitation] is not of kind = "record"')
    return with_suite(given, pattern)


def _read_parts(study: Table, directory: Path, records: bool) -> list[_Part]:
    """Parts of a study; one without a name where there are none."""
    common = read_axes(study.tables("axis"), directory)
    parts: list[_Part] = []
    for table in study.tables("part"):
        name = table.text("name", "a name for the part")
        if name and name in [part.name for part in parts]:
            table.reject("name", "a name of its own for each part")
        own = read_axes(table.tables("axis"), directory)
        tables = {key: table.data[key] for key in _OVERRIDES if table.has(key)}
        if {"name", "rtol"} & set(_table(tables, "solver")):
            table.reject("solver", "settings; name and rtol are those of [solver] in all parts")
        table.close()
        parts.append(_Part(name, tables, (*common, *own)))
    if not parts:
        if not (records or study.has("axis")):
            study.report_missing("axis", "[[study.axis]] with a key and its values")
        return [_Part("", {}, tuple(common))]
    return parts


def _bases(
    part: _Part, document: _Document, file: Path, source_hash: str, named: bool
) -> Iterator[Base]:
    """Scenes of a part, one for each combination of words."""
    words = [axis for axis in part.axes if isinstance(axis, WordAxis)]
    numbers = tuple(axis for axis in part.axes if isinstance(axis, NumberAxis))
    whole = {key: _merged(document.get(key), value) for key, value in part.tables.items()}
    whole = {**document, **whole}
    for values in product(*(axis.values for axis in words)):
        labels = dict(zip((axis.key for axis in words), values, strict=True))
        with told_of(f"{file}: "):
            worded = _with_first_values(_with_words(whole, labels), numbers)
            _refuse_shocks(worded, numbers)
        run = worded.get("run")
        own = isinstance(run, dict) and "duration" in run
        case = read_case(worded, file, source_hash)
        labels = {PART: part.name} | labels if named else labels
        yield Base(replace(case, suite=None), labels, numbers, own, case.members)


def _refuse_shocks(document: _Document, numbers: Sequence[NumberAxis]) -> None:
    """Refuse what would take the period of the first variant for all of them."""
    motion = _table(document, "excitation")
    named = str(motion.get("psa_period", "")).startswith(T_1)
    if isinstance(motion.get("psa"), list) and named and numbers:
        raise InputError(
            "[excitation]: psa_period: found a period of the scene for shocks that are scaled each "
            "for itself, in a study; accepted: a period (s)"
        )


def _merged(common: object, own: object) -> object:
    """A table of the part over that of the case; a list in its place."""
    return {**common, **own} if isinstance(common, dict) and isinstance(own, dict) else own


def _with_words(document: _Document, words: Mapping[str, object]) -> dict[str, object]:
    changed = dict(document)
    for key, value in words.items():
        table, _, name = key.partition(".")
        if key.startswith(OF_PLAN):
            changed[table] = _of_plan(changed.get(table), table, name, value)
            continue
        changed[table] = _merged(changed.get(table, {}), {name: value})
    return changed


def _of_plan(tables: object, kind: str, path: str, value: object) -> list[object]:
    """Tables of decks and the like with another value of a key, of all or of the one it names.

    Raises
    ------
    InputError
        Where there is no such table.
    """
    owner, _, key = path.rpartition(".")
    given = tables if isinstance(tables, list) else []
    meant = [isinstance(each, dict) and owner in ("", each.get("name")) for each in given]
    if not any(meant):
        raise InputError(f"[[study.axis]] ({kind}.{path}): found no [[{kind}]] of that name")
    return [{**e, key: value} if m else e for e, m in zip(given, meant, strict=True)]


def _with_first_values(document: _Document, axes: Sequence[NumberAxis]) -> _Document:
    """A case with the first values of axes in it that it cannot be read without."""
    firsts = {axis.key: float(axis.values[0]) for axis in axes}
    pi, motion = document.get("pi"), document.get("excitation")
    if isinstance(pi, dict):
        terms = {key.removeprefix(PI): v for key, v in firsts.items() if key.startswith(PI)}
        document = {**document, "pi": {**pi, **terms}}
    if isinstance(motion, dict) and _PSA in firsts:
        document = {**document, "excitation": {"psa": f"{firsts[_PSA]!r} m/s^2", **motion}}
    return document
