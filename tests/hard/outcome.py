"""What the solvers make of a hard scene, and whether they agree."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from eventpound import simulate
from eventpound.errors import ComputationError, InputError
from eventpound.mechanics.model import assemble
from eventpound.response import Response
from eventpound.results.summary import summarise
from eventpound.solvers.events.scales import scene_scales
from tests.benchmarks.agreement import NUDGE, quantities, sequence
from tests.hard.catalogue import REFUSED, Hard
from tests.solvers.random_scenes import nudged

SOLVERS = ("cvode", "fast", "ida")
"""Those that locate events."""
OWN = 1e3
"""Units of rtol by which two solvers may differ on a well-conditioned scene."""
TIMES = 20.0
"""Changes by nudging that they may differ by."""
NUDGES = 3
FLAT = 1e-16


@dataclass(frozen=True)
class Outcome:
    """One solver's part.

    Parameters
    ----------
    solver : str
        Who.
    response : Response or None
        What it returned.
    refusal : str
        What it said instead.
    """

    solver: str
    response: Response | None
    refusal: str = ""


def outcome(hard: Hard, solver: str, rtol: float | None = None) -> Outcome:
    """Run a scene by one solver."""
    try:
        return Outcome(solver, simulate(hard.case, solver=solver, rtol=rtol))
    except (ComputationError, InputError) as error:
        return Outcome(solver, None, str(error))


def disagreement(one: Response, other: Response) -> float:
    """Largest difference of two runs in parts of each quantity's scale.

    A quantity's scale is its largest value, or what the scene's own scales
    make of it where that is larger: rounding and tolerances refer to those.
    """
    task = one.task
    scales = scene_scales(task.scene, assemble(task.scene), task.end - task.start)
    floors = {"u": scales.length, "v": scales.speed, "a": scales.acceleration}
    floors |= {"x": scales.length, "gap": scales.length, "shear": scales.force}
    end = task.end - task.start
    ours, theirs = quantities(one.recording, end), quantities(other.recording, end)
    apart = [
        np.max(np.abs(ours[key][0] - theirs[key][0]), initial=0.0)
        / max(ours[key][1], floors.get(key.split("_")[0], 0.0))
        for key in ours
    ]
    return float(np.max(apart))


def wrong_values(hard: Hard, response: Response) -> list[str]:
    """Known values that a run misses."""
    summary = summarise(response)
    said = []
    for key, value in hard.values.items():
        found = _entry(summary, key)
        if not abs(found - value) <= hard.within:
            said.append(f"{key} = {found!r} instead of {value!r} ± {hard.within:g}")
    return said


def _entry(summary: Any, key: str) -> float:
    for part in key.split("."):
        summary = summary[part]
    return float(summary)


def digits(difference: float) -> int:
    """Digits to which two runs agree."""
    return math.floor(-math.log10(max(difference, FLAT)))


def allowed(hard: Hard, response: Response) -> float:
    """By how much another solver may differ: its tolerance, or what conditioning makes of it."""
    rtol = hard.case.solver.rtol
    rng = np.random.default_rng(1)
    moved = 0.0
    for _ in range(NUDGES):
        other = nudged(hard.case.scene, rng, NUDGE * rtol)
        again = simulate(other, solver=response.solver, rtol=rtol, duration=hard.case.run.duration)
        moved = max(moved, disagreement(response, again))
    return max(OWN * rtol, TIMES * moved, 2.0 * hard.within)


def verdict(hard: Hard, outcomes: list[Outcome]) -> tuple[str, str]:
    """A word (agree, refused, fails) and a remark on the outcomes of one scene."""
    said = [o for o in outcomes if o.response is None]
    if hard.name in REFUSED:
        fitting = len(said) == len(outcomes) and all(REFUSED[hard.name] in o.refusal for o in said)
        return ("refused" if fitting else "fails"), "; ".join(o.refusal for o in said)
    if said:
        return "fails", "; ".join(f"{o.solver}: {o.refusal}" for o in said)
    wrong = [
        f"{o.solver}: {w}" for o in outcomes if o.response for w in wrong_values(hard, o.response)
    ]
    if wrong:
        return "fails", "; ".join(wrong)
    first = outcomes[0].response
    assert first is not None
    apart = {o.solver: disagreement(first, o.response) for o in outcomes[1:] if o.response}
    worst = max(apart.values(), default=0.0)
    remark = ", ".join(f"{name} {digits(value)} digits" for name, value in apart.items())
    if worst > OWN * hard.case.solver.rtol:
        limit = allowed(hard, first)
        remark += f" (conditioning allows {digits(limit)})"
        return ("fails" if worst > limit else "agree"), remark
    same = all(
        sequence(o.response.recording) == sequence(first.recording) for o in outcomes if o.response
    )
    return ("agree" if same else "fails"), remark + ("" if same else "; events differ")
