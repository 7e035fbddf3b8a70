"""What a study tabulates of each run.

Any quantity of `eventpound.quantities`, as ``peaks.deck.abs_max`` or ``pi_um``; one of the
same scene without contact, ``free.peaks.deck.abs_max``; a number of the scene by its dotted
key, ``spring.frame.strength`` (SI).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from eventpound.case.table import suggestion
from eventpound.errors import InputError
from eventpound.quantities.lookup import names_of, unstated
from eventpound.scene.parameters import places_of
from eventpound.scene.scene import Scene
from eventpound.simulation import check_solver
from eventpound.study.plan import Base, Study
from eventpound.study.variants import check_axes


def default_quantities(bases: Sequence[Base]) -> tuple[str, ...]:
    """What is tabulated where a study does not say."""
    if any(base.case.scene.contacts for base in bases):
        return ("pi_um", "amplification", "impacts", "resting_time")
    return ("pi_um",)


def study_problems(study: Study) -> list[str]:
    """What is wrong with a study before anything runs: its solver, quantities or values.

    A quantity that some scene has is accepted.
    """
    try:
        for base in study.bases:
            options = replace(base.case.solver, name=study.solver, rtol=study.rtol)
            check_solver(options, base.case.scene)
        bases = [base.at_first() for base in study.bases]
    except InputError as error:
        return list(error.problems)
    known: dict[str, None] = {}
    for base in bases:
        known |= dict.fromkeys(quantities_of(base.case.scene))
    problems = []
    for name in study.quantities:
        if name not in known:
            meant = suggestion(name, list(known)) or f"; accepted: {_ACCEPTED}"
            problems.append(f"[study]: quantities: found {name!r}{meant}")
        elif all(text := unstated(name, base.case.run.stated) for base in bases):
            problems.append(f"[study]: {text}")
    return problems or [problem for base in bases for problem in check_axes(base)]


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
    return [*names_of(scene), *places_of(scene)]
