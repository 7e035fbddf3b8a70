"""Runs judged by a reference, and by the rigid law that contact laws stand for.

A law with a `restitution` means that; one with ζ, a or ξ what the formula of
`eventpound.scene.contact_law` has for it, inverted; one without damping, 1.

Several solvers on one case, each at several tolerances or steps, and other programs' results.

A run of a scene with contact laws is held against that scene, which tells what its steps
do, and against the same scene under Newton's law, which tells what they and the springs do. The
reference of the one held against that of the other is what the springs alone do.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from eventpound.accuracy.foreign_history import judge_history, read_foreign
from eventpound.accuracy.quantities import errors_of
from eventpound.accuracy.reference import Reference, certified_bounds, reference_of
from eventpound.accuracy.work_precision import Judged, SolverChoice, is_stepped, judge
from eventpound.case.case import Case
from eventpound.case.run_options import RunOptions, Way, warn_left_out
from eventpound.errors import ComputationError, InputError
from eventpound.scene.check import check_scene
from eventpound.scene.contact import Contact
from eventpound.scene.contact_law import Element
from eventpound.scene.scene import Scene
from eventpound.score.difference import Difference
from eventpound.simulation import check_case, check_solver
from eventpound.solvers import solver_named
from eventpound.tolerances import REPEATS


def meant_restitution(contact: Contact) -> float:
    """Coefficient of restitution that a contact with a law stands for, or that of Newton's.

    Parameters
    ----------
    contact : Contact
        A checked one.
    """
    if contact.restitution is not None:
        return contact.restitution
    if contact.law is None or contact.law.damping is None:
        return 1.0
    return restitution_of(contact.law.element, contact.law.damping)


def restitution_of(element: Element, constant: float) -> float:
    """Coefficient of restitution whose formula gives this ζ, a or ξ; 0 beyond its end."""
    if element is Element.KELVIN_VOIGT:
        if constant >= 1.0:
            return 0.0
        return math.exp(-math.pi * constant / math.sqrt(1.0 - constant**2))
    if element is Element.HERTZ_DAMP:
        return math.sqrt(max(0.0, 1.0 - constant / 0.75))
    if element is Element.JANKOWSKI:
        # A quadratic of e, in the form that does not cancel where it has a small root.
        lead = 4.5 * math.sqrt(5.0)
        square = lead + constant * (9.0 * math.pi - 16.0)
        return lead / (8.0 * constant + math.sqrt(64.0 * constant**2 + square * lead))
    return 1.0


def rigid(scene: Scene, restitution: float | None = None) -> Scene:
    """The scene with Newton's law in the place of every other.

    Parameters
    ----------
    scene : Scene
        Checked.
    restitution : float, optional
        ε of the contacts that have a law (`meant_restitution`).
    """

    def changed(contact: Contact) -> Contact:
        if contact.law is None:
            return contact
        e = meant_restitution(contact) if restitution is None else restitution
        return replace(contact, restitution=e, law=None)

    return replace(scene, contacts=tuple(map(changed, scene.contacts)))


Chosen = tuple[str, Mapping[str, object]]
"""A solver's name and its settings."""


@dataclass(frozen=True)
class Comparison:
    """What a comparison found.

    Parameters
    ----------
    case : Case
        What was run.
    reference : Reference
        What everything is held against.
    runs : tuple of Judged
        Line by line, in the order asked for.
    laws : Difference or None
        What contact laws alone do, against the rigid law.
    """

    case: Case
    reference: Reference
    runs: tuple[Judged, ...]
    laws: Difference | None = None


class ComparisonInterrupted(KeyboardInterrupt):
    """Ctrl-C in `compare`.

    Parameters
    ----------
    comparison : Comparison
        The runs that were done.
    """

    def __init__(self, comparison: Comparison) -> None:
        self.comparison = comparison
        super().__init__("interrupted")


def entries(
    solvers: Sequence[Chosen], rtol: Sequence[float], steps: Sequence[float]
) -> list[SolverChoice]:
    """What is to be run: each solver at each tolerance, or step where it takes fixed ones.

    Parameters
    ----------
    solvers : sequence of (str, mapping)
        Names and settings.
    rtol : sequence of float
        Relative tolerances.
    steps : sequence of float
        Time steps (s).

    Raises
    ------
    InputError
        Where a solver is not known, does not know a setting, or a value of it, or has nothing to
        run at.
    """
    found: list[SolverChoice] = []
    problems: list[str] = []
    for name, settings in solvers:
        solver = solver_named(name)
        stepped = is_stepped(solver)
        if stepped and not steps:
            problems.append(f"--steps: {name} takes fixed steps; give some, as --steps 0.01,0.001")
        if not stepped and not rtol:
            problems.append(f"rtol: {name} takes a tolerance; give some")
        sizes = steps if stepped else rtol
        found += [
            SolverChoice(name, settings, None if stepped else size, size if stepped else None)
            for size in sizes
        ]
    for entry in found:
        try:
            check_solver(entry.options)
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(list(dict.fromkeys(problems)))
    return found


def judge_entries(
    case: Case,
    asked: Sequence[SolverChoice],
    against: Sequence[Path] = (),
    columns: Mapping[str, str | int] | None = None,
    *,
    repeats: int = REPEATS,
    restitution: float | None = None,
    progress: Callable[[str], None] = lambda what: None,
) -> Comparison:
    """Run entries, read histories, and judge them all by one reference.

    Parameters
    ----------
    case : Case
        What is run; quantities that it names play no part.
    asked : sequence of SolverChoice
        Solvers at tolerances or steps; `entries` makes them.
    against : sequence of Path
        Histories of other programs.
    columns : mapping of str to str or int, optional
        Their columns by name or number, by what we call them.
    repeats : int
        Runs whose median time is taken.
    restitution : float, optional
        ε of the rigid law beside contact laws.
    progress : callable, optional
        Told what is being done.

    Raises
    ------
    InputError
        Where a history cannot be read or a solver cannot be asked this; before any run
        where that can be known.
    ComputationError
        Where the reference fails.
    ComparisonInterrupted
        After Ctrl-C, where a run was done by then.
    """
    case.refuse_suite()
    check_case(case)
    if not asked and not against:
        raise InputError("compare: found nothing to judge; accepted: a solver, or a history")
    if columns and not against:
        raise InputError("columns: found without against; accepted: beside a history alone")
    warn_left_out(case.run, Way.COMPARE)
    _check_restitution(case, restitution)
    for entry in asked:
        entry.task(case)
    histories = [read_foreign(case, path, columns or {}) for path in against]
    progress("reference")
    reference = reference_of(case, case.run, certified_bounds(case))
    reference = _with_rigid(case, case.run, reference, restitution)
    laws = _error_of_laws(case, reference)
    runs: list[Judged] = []
    try:
        for entry in asked:
            progress(f"{entry.line} {entry.size}")
            runs.append(judge(case, entry, reference, repeats))
        names = [path.name for path in against]
        for history in histories:
            progress(str(history.path))
            name = history.path.name
            label = name if names.count(name) == 1 else str(history.path)
            runs.append(judge_history(case, history, reference, label))
    except KeyboardInterrupt:
        if not runs:
            raise
        raise ComparisonInterrupted(Comparison(case, reference, tuple(runs), laws)) from None
    return Comparison(case, reference, tuple(runs), laws)


def _check_restitution(case: Case, restitution: float | None) -> None:
    """Refuse a restitution that no contact of a case can be held against.

    Raises
    ------
    InputError
        Where no contact has a law, or it is not from 0 to 1.
    """
    if restitution is None:
        return
    if all(contact.law is None for contact in case.scene.contacts):
        raise InputError("--restitution: no contact of the case has a law of its own")
    if not 0.0 <= restitution <= 1.0:
        raise InputError(f"--restitution: found {restitution!r}; accepted: a number from 0 to 1")


def _with_rigid(
    case: Case, options: RunOptions, reference: Reference, restitution: float | None = None
) -> Reference:
    """A reference with that of the rigid law beside it, where contacts have laws.

    Parameters
    ----------
    case : Case
        What is run.
    options : RunOptions
        The stretch of time.
    reference : Reference
        Of the case over that.
    restitution : float, optional
        ε in the place of every law; without, what each stands for. `_check_restitution` has it.
    """
    laws = [contact for contact in case.scene.contacts if contact.law is not None]
    if not laws:
        return reference
    scene = rigid(case.scene, restitution)
    try:
        check_scene(scene)
        beside = reference_of(replace(case, scene=scene), options, None)
    except (InputError, ComputationError) as error:
        return replace(reference, rigid_words=f"not to be had: {error}")
    names = {contact.name for contact in laws}
    said = [f"{c.name} {c.restitution:.3g}" for c in scene.contacts if c.name in names]
    words = f"Newton's with a restitution of {', '.join(said)}; {beside.words}"
    return replace(reference, rigid=beside, rigid_words=words)


def _error_of_laws(case: Case, reference: Reference) -> Difference | None:
    """What the contact laws alone do to the motion; None where no rigid law is beside it."""
    beside = reference.rigid
    if beside is None:
        return None
    rows = beside.rows(reference.task.output_times)
    return errors_of(case.scene, reference.recording, beside.truth, rows, rests=False)
