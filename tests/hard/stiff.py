"""Stiff bodies beside soft ones, drawn at random: the same events by every solver, or a warning.

``python -m tests.hard.stiff [COUNT] [SEED] [SECONDS]``

A row of two to four bodies, each on a spring of its own, with periods that differ by up to 1e4
and masses that differ by up to 1e6, runs by cvode, ida and fast at rtol 1e-9; a run that takes
more than SECONDS of processor time is left out with its scene. A scene *agrees* where all three
rest as often and as long at every contact, and their fastest impacts there, the second fastest
and so on are equally fast. Where they do not,
each contact concerned must be named by a warning of one of the two runs that differ: the scene
*warns*; else it is *unsaid*. A solver that warns and yet agrees with its own run at rtol/100
warns *needlessly*. Prints all but what agrees, and the counts.
"""

import sys
import time
from collections import Counter
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from eventpound.accuracy.estimate import estimate_of, rests_of_both, speed_differences
from eventpound.accuracy.quantities import scales_of_task
from eventpound.accuracy.sequences import KINDS, weights_for
from eventpound.errors import ComputationError
from eventpound.motion.pulses import Cosine, Sine, TypeC
from eventpound.response import Response
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Dashpot, Linear, Scene, Spring
from eventpound.scene.check import check_scene
from eventpound.score.levels import UNIT_OF_TIME
from eventpound.score.pairing import pair_events
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task
from tests.benchmarks.agreement import TooLongError

SOLVERS = ("fast", "cvode", "ida")
RTOL = 1e-9
FINER = 100.0
STIFFEST, HEAVIEST = 4.0, 6.0
"""Decades by which periods and masses may differ."""
UNSAID = 1e-4
"""Part of a run by which a time of rest may err unsaid, and of the fastest impact by which the
speed of another may; an impact softer than that may be missing."""
BOTH, ITS_OWN = 2.5, 0.5
"""Multiples of it by which two runs may differ, each of which may err by it, and by which a run
that warns must differ from a finer one."""
PATIENCE = 5.0
"""Processor time of a run (s)."""


def stiff_scene(seed: int) -> tuple[Scene, float]:
    """A scene and the length of its run (s), the same for the same seed."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 5))
    strength, period = rng.uniform(1.0, 5.0), rng.uniform(0.4, 2.0)
    length = strength * (period / (2.0 * np.pi)) ** 2
    motion = (Sine, Cosine, TypeC)[rng.integers(3)](strength, period)
    bodies = tuple(
        Body(f"b{i}", 10.0 ** rng.uniform(-0.5 * HEAVIEST, 0.5 * HEAVIEST)) for i in range(count)
    )
    # Some bodies swing about as slowly as the ground, the others faster by up to the ratio.
    stiff = rng.permutation([True, False, *(rng.random(count - 2) < 0.5)])
    faster = 10.0 ** rng.uniform(1.0, STIFFEST, count)
    springs, dashpots = [], []
    for i, body in enumerate(bodies):
        own = period * rng.uniform(0.5, 2.0) / (faster[i] if stiff[i] else 1.0)
        k = body.mass * (2.0 * np.pi / own) ** 2
        ends = (GROUND, body.name)
        law: Linear | BoucWen = Linear(k)
        if rng.random() < 0.3:
            reach = body.mass * strength / k * rng.uniform(0.2, 2.0)
            law = BoucWen(0.05 * k, 0.95 * k * reach, reach, float(rng.choice([2.0, 5.0])))
        springs.append(Spring(f"s{i}", ends, law))
        if rng.random() < 0.5:
            dashpots.append(Dashpot(ends, 2.0 * rng.uniform(0.0, 0.1) * np.sqrt(k * body.mass)))
    row = [BARRIER, *(body.name for body in bodies), BARRIER]
    contacts = tuple(
        Contact(
            f"c{i}",
            *ends,
            0.0 if rng.random() < 0.15 else length * 10.0 ** rng.uniform(-2.0, 0.0),
            float(rng.choice([0.0, 0.3, 0.5, 0.7, 0.9])),
        )
        for i, ends in enumerate(pairwise(row))
        if BARRIER not in ends or rng.random() < 0.3
    )
    scene = Scene(bodies, tuple(springs), tuple(dashpots), contacts, motion)
    check_scene(scene)
    return scene, float(rng.uniform(1.0, 2.0) * period)


@dataclass(frozen=True)
class Finding:
    """On a scene: agrees, warns, needless, unsaid, too long or fails, and what there is to say."""

    word: str
    remark: str = ""


def solved(scene: Scene, end: float, solver: str, rtol: float, seconds: float) -> Response:
    """A run, or `TooLongError`."""
    began = time.process_time()

    def progress(t: float) -> None:
        if time.process_time() - began > seconds:
            raise TooLongError(f"{solver} at {rtol:g}: t = {t:.6g} of {end:.6g}")

    task = Task(scene, 0.0, end, rtol, output_times=np.linspace(0.0, end, 101), progress=progress)
    recording = solver_named(solver).solve(task)
    return Response(replace(task, progress=None), solver, recording)


def differing(one: Response, other: Response, times: float) -> set[int]:
    """Contacts at which two runs rest another number of times or longer, or strike otherwise.

    `times` are the multiples of `UNSAID` by which they may differ.
    """
    events = one.recording.events, other.recording.events
    allowed = times * UNSAID
    apart = speed_differences(*events, len(one.scene.contacts), scales_of_task(one.task).speed)
    found = {int(j) for j in np.flatnonzero(apart > allowed)}
    unit = UNIT_OF_TIME * (one.task.end - one.task.start)
    paired = pair_events(*events, unit, KINDS, weights=weights_for(allowed))
    contacts = len(one.scene.contacts)
    for j, rests in enumerate(rests_of_both(*events, paired, contacts, one.task.end)):
        off = abs(rests.our_time - rests.their_time) / one.task.end
        if rests.ours != rests.theirs or off > allowed:
            found.add(j)
    return found


def named(response: Response) -> set[int]:
    """Contacts that the warnings of a run name."""
    text = " ".join((estimate_of(response, asked=None) or {}).get("warnings", []))
    contacts = response.scene.contacts
    return {j for j, contact in enumerate(contacts) if f"contact {contact.name!r}" in text}


def examine(seed: int, seconds: float = PATIENCE) -> Finding:
    """What the solvers make of a scene."""
    scene, end = stiff_scene(seed)
    try:
        runs = [solved(scene, end, solver, RTOL, seconds) for solver in SOLVERS]
        warned = [named(run) for run in runs]
        needless = [
            run.solver
            for run, contacts in zip(runs, warned, strict=True)
            if contacts
            and not differing(
                run, solved(scene, end, run.solver, RTOL / FINER, 4.0 * seconds), ITS_OWN
            )
        ]
    except TooLongError as error:
        return Finding("too long", str(error))
    except ComputationError as error:
        return Finding("fails", str(error))
    unsaid = [
        f"{one.solver}, {other.solver}: {scene.contacts[j].name}"
        for i, one in enumerate(runs)
        for k, other in enumerate(runs[:i])
        for j in sorted(differing(one, other, BOTH) - warned[i] - warned[k])
    ]
    if unsaid:
        return Finding("unsaid", "; ".join(unsaid))
    who = [run.solver for run, contacts in zip(runs, warned, strict=True) if contacts]
    if needless:
        return Finding("needless", ", ".join(needless))
    return Finding("warns", ", ".join(who)) if who else Finding("agrees")


def main(count: int, first: int, seconds: float) -> int:
    """Examine so many scenes; 1 where one is unsaid or fails."""
    words: Counter[str] = Counter()
    for number, seed in enumerate(range(first, first + count), 1):
        finding = examine(seed, seconds)
        words[finding.word] += 1
        if finding.word != "agrees":
            print(f"{seed}: {finding.word}: {finding.remark}", flush=True)
        if number % 20 == 0 or number == count:
            print(f"# {number} of {count}: {dict(words)}", flush=True)
    return int("unsaid" in words or "fails" in words)


if __name__ == "__main__":
    given = [float(word) for word in sys.argv[1:]]
    asked = given + [100.0, 0.0, PATIENCE][len(given) :]
    sys.exit(main(int(asked[0]), int(asked[1]), asked[2]))
