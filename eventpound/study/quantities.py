"""What a study tabulates of each run.

Any quantity of `eventpound.quantities`, as ``peaks.deck.abs_max`` or ``pi_um``; one of the
same scene without contact, ``free.peaks.deck.abs_max``; a number of the scene by its dotted
key, ``spring.frame.strength`` (SI).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from eventpound.case.run_options import Way, refuse_options
from eventpound.case.solver_options import SolverOptions
from eventpound.case.table import suggestion
from eventpound.errors import InputError
from eventpound.quantities.lookup import chosen, names_of, quantities_asked, unstated
from eventpound.scene.parameters import number_places
from eventpound.scene.scene import Scene
from eventpound.simulation import check_solver
from eventpound.study.base import Base
from eventpound.study.plan import Plan
from eventpound.study.variants import check_axes


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


_ACCEPTED = (
    "what `eventpound check CASE --quantities` lists, as peaks.<body>.abs_max or "
    "contacts.<contact>.impacts, or a number of the case, as spring.<spring>.strength"
)


def quantities_of(scene: Scene) -> list[str]:
    """Every quantity that can be tabulated of a scene.

    Parameters
    ----------
    scene : Scene
        A checked scene.
    """
    return [*names_of(scene), *number_places(scene)]
