"""What the solvers make of a hard scene, and whether they agree."""

import math
from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from eventpound.accuracy.estimate import estimate_errors
from eventpound.errors import ComputationError, InputError
from eventpound.mechanics.model import assemble
from eventpound.response import Response
from eventpound.results.run_files import summarise
from eventpound.simulation import response_of
from eventpound.solvers.events.scales import scene_scales
from tests.benchmarks.agreement import NUDGE, loud, quantities, sequence
from tests.hard.catalogue import REFUSED, Hard
from tests.solvers.random_scenes import nudged

OWN = 1e3
"""Units of rtol by which two solvers may differ on a well-conditioned scene."""
TIMES = 20.0
"""Changes by nudging that they may differ by."""
NUDGES = 8
"""Nudged runs. How far they move scatters tenfold on a stiff scene: the largest of three was 4e-9
with one build and 3e-9 with the next, whose last digits differ, where solvers kept 6e-8 apart."""
NEAR = 1e-4
"""Part of a run by which the times of one event may differ."""
SEVERAL = 3
"""Events up to which they are judged by the motion alone: a graze within the tolerance may
be seen by one solver and not by another."""
PART = 0.5
"""Share of the events before nudged runs part that two solvers must have in common.

Differences grow exponentially, and the solvers' own may be `OWN` times those of the nudge:
at rtol 1e-12 they have three quarters of the time.
"""
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


@dataclass(frozen=True)
class Verdict:
    """On the outcomes of one scene.

    Parameters
    ----------
    word : str
        agree, warns, refused or fails. Runs that agree have the same numbers of impacts,
        rests and openings at every contact; where they have not, they must warn.
    remark : str
        What else there is to say.
    digits : dict
        To which each solver agrees with the first.
    """

    word: str
    remark: str
    digits: dict[str, int] = field(default_factory=dict)


def outcome(hard: Hard, solver: str, rtol: float | None = None) -> Outcome:
    """Run a scene by one solver."""
    try:
        return Outcome(solver, response_of(hard.case, solver=solver, rtol=rtol))
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


def nudged_runs(hard: Hard, response: Response) -> list[Response]:
    """The scene with masses and forces changed in the last digits that its tolerance leaves."""
    rtol = hard.case.solver.rtol
    rng = np.random.default_rng(1)
    duration = hard.case.run.duration
    return [
        response_of(
            nudged(hard.case.scene, rng, NUDGE * rtol),
            solver=response.solver,
            rtol=rtol,
            duration=duration,
        )
        for _ in range(NUDGES)
    ]


def leading(one: Response, other: Response) -> int:
    """How many loud events two runs share from the start on, in kind, contact and time."""
    near = NEAR * (one.task.end - one.task.start)
    ours, theirs = loud(one.recording), loud(other.recording)
    for count, (a, b) in enumerate(zip(ours, theirs, strict=False)):
        if (a.kind, a.contact) != (b.kind, b.contact) or abs(a.t - b.t) > near:
            return count
    return min(len(ours), len(theirs))


def tally(response: Response) -> Counter[tuple[int, str]]:
    """Loud impacts, rests and openings of each contact."""
    return Counter((event.contact, event.kind.value) for event in loud(response.recording))


def unsaid(hard: Hard, responses: list[Response]) -> list[str]:
    """Contacts of which two runs count differently, though neither warns of them."""
    names = [contact.name for contact in hard.case.scene.contacts]
    warnings = [" ".join(estimate_errors(r).get("warnings", [])) for r in responses]
    first = tally(responses[0])
    found = []
    for i, other in enumerate(responses[1:], 1):
        counts = tally(other)
        differing = {c for c, kind in first | counts if first[c, kind] != counts[c, kind]}
        found += [
            f"{responses[0].solver} and {other.solver} count differently at {names[c]}, unsaid"
            for c in sorted(differing)
            if names[c] not in warnings[0] + warnings[i]
        ]
    return found


def verdict(hard: Hard, outcomes: list[Outcome]) -> Verdict:
    """Whether the solvers agree on a scene, refuse it as they should, or fail."""
    said = [o for o in outcomes if o.response is None]
    refusals = "; ".join(f"{o.solver}: {o.refusal}" for o in said)
    if hard.name in REFUSED:
        fitting = len(said) == len(outcomes) and all(REFUSED[hard.name] in o.refusal for o in said)
        return Verdict("refused", said[0].refusal) if fitting else Verdict("fails", refusals)
    if said:
        return Verdict("fails", refusals)
    responses = [o.response for o in outcomes if o.response is not None]
    wrong = [f"{r.solver}: {text}" for r in responses for text in wrong_values(hard, r)]
    if wrong:
        return Verdict("fails", "; ".join(wrong))
    first, *others = responses
    apart = {other.solver: disagreement(first, other) for other in others}
    worst = max(apart.values(), default=0.0)
    agreeing = {solver: digits(value) for solver, value in apart.items()}
    if worst > OWN * hard.case.solver.rtol:
        return _conditioned(hard, first, others, worst, agreeing)
    events = sequence(first.recording)
    if all(sequence(other.recording) == events for other in others):
        return Verdict("agree", "", agreeing)
    return Verdict("fails", "events differ", agreeing)


def _conditioned(
    hard: Hard, first: Response, others: list[Response], worst: float, agreeing: dict[str, int]
) -> Verdict:
    """Whether the scene itself takes the digits that the solvers do not share."""
    again = nudged_runs(hard, first)
    moved = max(disagreement(first, other) for other in again)
    limit = max(OWN * hard.case.solver.rtol, TIMES * moved, 2.0 * hard.within)
    shared = min(leading(first, other) for other in others)
    steady = min(leading(first, other) for other in again)
    remark = f"conditioning allows {max(digits(limit), 0)}"
    events = len(loud(first.recording))
    if min(shared, steady) < events:
        remark += f"; the first {shared} of {events} events alike, nudged {steady}"
    if worst > limit or (steady > SEVERAL and shared < PART * steady):
        return Verdict("fails", remark, agreeing)
    if all(tally(other) == tally(first) for other in others):
        return Verdict("agree", remark, agreeing)
    silent = unsaid(hard, [first, *others])
    if silent:
        return Verdict("fails", "; ".join(silent), agreeing)
    return Verdict("warns", remark, agreeing)
