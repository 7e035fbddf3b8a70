"""Whether two solvers give the same answers on scenes drawn at random.

``python -m tests.benchmarks.agreement [COUNT] [SEED] [SOLVER] [supports | resting]``

Each scene, or with `supports` one on supports and under forces, with `resting` one whose bodies
rest on a support, is run by the fast solver and another (cvode) at two tolerances. How
far each solver's own answer moves between the two is its own error; a difference
of the solvers beyond `TIMES` of that, and beyond `ROUNDING`, is looked into: both
run again at `TIGHT`, and on scenes whose masses and forces are changed in their
last digits. What neither explains is called a defect. A motion that amplifies the errors of
the steps shows it by its own change from ten times `TIGHT` to it.
"""

import sys
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from eventpound.errors import ComputationError
from eventpound.numerics.compiling import Stopwatch
from eventpound.scene import Scene
from eventpound.solvers import solver_named
from eventpound.solvers.base import Event, EventKind, Recording, Task
from tests.solvers.random_scenes import driven_scene, nudged, random_scene, resting_scene

LOOSE, FINE, TIGHT = 1e-7, 1e-9, 1e-12
TIMES = 20.0
"""Own errors by which the solvers may differ."""
ROUNDING = 1e3
"""The same in units of rtol."""
NUDGE = 1.0
"""Change of masses and forces in units of rtol."""
PATIENCE = 30.0
"""Processor time of one run, without what compiling takes (s)."""
LOUD = 1e-4
"""Part of the fastest closing speed above which impacts must be the same."""


class TooLongError(Exception):
    """A run that takes more than `PATIENCE`."""


def run(scene: Scene, end: float, solver: str, rtol: float) -> Recording:
    """A recording, or `TooLongError`."""
    began, clock = time.process_time(), Stopwatch()

    def progress(t: float) -> None:
        if time.process_time() - began - clock.compilation > PATIENCE:
            raise TooLongError(f"{solver} at {rtol:g}: t = {t:.6g} of {end:.6g}")

    return solver_named(solver).solve(Task(scene, 0.0, end, rtol, progress=progress))


def quantities(recording: Recording, end: float) -> dict[str, tuple[np.ndarray, float]]:
    """What is compared, each with its scale."""
    x, a, s = recording.displacement, recording.acceleration, recording.base_shear
    length = float(np.max(np.abs((x.maximum, x.minimum)))) or 1.0
    speed = float(np.max(np.abs(recording.history.v))) or 1.0
    acceleration = float(np.max(np.abs((a.maximum, a.minimum)))) or 1.0
    force = float(np.max(np.abs((s.maximum, s.minimum))))
    force = force + float(np.max(recording.max_force, initial=0.0)) or 1.0
    return {
        "u": (recording.u, length),
        "v": (recording.v, speed),
        "z": (recording.z, 1.0),
        "u_max": (x.maximum, length),
        "u_min": (x.minimum, length),
        "a_max": (a.maximum, acceleration),
        "a_min": (a.minimum, acceleration),
        "x_max": (recording.elongation.maximum, length),
        "x_min": (recording.elongation.minimum, length),
        "shear_max": (s.maximum, force),
        "shear_min": (s.minimum, force),
        "gap": (recording.smallest_gap, length),
        "resting": (recording.resting_time, end),
        "force": (recording.max_force, force),
    }


def distances(one: Recording, other: Recording, end: float) -> dict[str, float]:
    """Difference of each quantity as part of its scale."""
    ours, theirs = quantities(one, end), quantities(other, end)
    return {
        key: float(np.max(np.abs(ours[key][0] - theirs[key][0]), initial=0.0) / ours[key][1])
        for key in ours
    }


def loud(recording: Recording) -> list[Event]:
    """The events without the soft impacts and the limits of accumulations."""
    rates = [e.gap_velocity_before for e in recording.events if e.kind is EventKind.IMPACT]
    fastest = LOUD * min(rates, default=0.0)
    return [
        e
        for e in recording.events
        if e.kind is not EventKind.ACCUMULATION
        and (e.kind is not EventKind.IMPACT or e.gap_velocity_before < fastest)
    ]


def sequence(recording: Recording) -> list[tuple[EventKind, int]]:
    """Kinds and contacts of the loud events.

    What happens within an error of a time to several contacts is in the order of the contacts:
    two that come to rest in one cascade do so within its last moments.
    """
    together = ROUNDING * TIGHT * recording.t
    found: list[list[tuple[EventKind, int]]] = []
    last = -np.inf
    for e in loud(recording):
        if e.t - last > together:
            found.append([])
        found[-1].append((e.kind, e.contact))
        last = e.t
    return [event for instant in found for event in sorted(instant, key=lambda event: event[1])]


def only_grazes(recording: Recording) -> bool:
    """Whether all impacts of a run at `TIGHT` are as soft as its error makes those of a graze.

    A body that comes to a contact with no speed touches it, or not, by an error e of its
    displacement, and meets it with a speed that goes as the square root of e.
    """
    fastest = float(np.max(np.abs(recording.history.v)))
    rates = [e.gap_velocity_before for e in recording.events if e.kind is EventKind.IMPACT]
    return -min(rates, default=0.0) <= np.sqrt(ROUNDING * TIGHT) * fastest


@dataclass
class Verdict:
    """Of one scene: a word, the largest difference, and what to say about it."""

    word: str
    difference: float
    remark: str = ""


def judge(
    seed: int, other: str, drawn: Callable[[int], tuple[Scene, float]] = random_scene
) -> Verdict:
    """Run a scene by the fast solver and the other and compare."""
    scene, end = drawn(seed)
    runs: dict[tuple[str, float], Recording] = {}
    for solver in ("fast", other):
        for rtol in (LOOSE, FINE):
            try:
                runs[solver, rtol] = run(scene, end, solver, rtol)
            except (ComputationError, TooLongError) as error:
                moved = np.nan
                if solver == other:
                    moved = max(distances(*(runs["fast", r] for r in (LOOSE, FINE)), end).values())
                return Verdict(f"{solver} fails", moved, f"rtol {rtol:g}: {error}")
    own = [distances(runs[s, LOOSE], runs[s, FINE], end) for s in (other, "fast")]
    apart = distances(runs[other, FINE], runs["fast", FINE], end)
    far = {
        key: value
        for key, value in apart.items()
        if not value <= max(TIMES * max(o[key] for o in own), ROUNDING * FINE)
    }
    worst = max(apart, key=lambda key: apart[key])
    same = sequence(runs[other, FINE]) == sequence(runs["fast", FINE])
    if not far and same:
        return Verdict("agree", apart[worst], worst)
    remark = ", ".join(f"{k} {v:.1e} (own {own[0][k]:.1e} {own[1][k]:.1e})" for k, v in far.items())
    if not far:
        remark = "events differ"
    return _explain(scene, end, seed, other, apart[worst], remark)


def _explain(
    scene: Scene, end: float, seed: int, other: str, difference: float, remark: str
) -> Verdict:
    """Whether a smaller tolerance or the conditioning explains a difference."""
    try:
        ours, fast = (run(scene, end, solver, TIGHT) for solver in (other, "fast"))
        looser = [run(scene, end, solver, 10.0 * TIGHT) for solver in (other, "fast")]
    except (ComputationError, TooLongError) as error:
        return Verdict("fails when tight", difference, f"{remark}; {error}")
    apart = distances(ours, fast, end)
    worst = max(apart, key=lambda key: apart[key])
    same = sequence(ours) == sequence(fast)
    remark += f"; at {TIGHT:g}: {worst} {apart[worst]:.1e}{'' if same else ', events differ'}"
    if apart[worst] <= ROUNDING * TIGHT * 10.0 and same:
        return Verdict("agree when tight", difference, remark)
    if only_grazes(ours) and only_grazes(fast):
        return Verdict("graze", difference, remark)
    # What the errors of the steps have grown to: the motion may amplify them as much as it likes.
    own = [distances(a, b, end) for a, b in zip((ours, fast), looser, strict=True)]
    grown = max(max(each.values()) for each in own)
    steady = all(sequence(a) == sequence(b) for a, b in zip((ours, fast), looser, strict=True))
    remark += f"; own {grown:.1e}"
    if apart[worst] <= TIMES * grown and (same or not steady):
        return Verdict("ill-conditioned", difference, remark)
    rng = np.random.default_rng(seed)
    moved = 0.0
    for _ in range(3):
        moved_scene = nudged(scene, rng, NUDGE * TIGHT)
        for solver, first in ((other, ours), ("fast", fast)):
            try:
                again = run(moved_scene, end, solver, TIGHT)
            except (ComputationError, TooLongError) as error:
                return Verdict("fails when nudged", difference, f"{remark}; {solver} {error}")
            moved = max(moved, *distances(first, again, end).values())
            steady = steady and sequence(first) == sequence(again)
    remark += f"; nudged {moved:.1e}{'' if steady else ', events differ'}"
    explained = apart[worst] <= TIMES * max(moved, ROUNDING * TIGHT) and (same or not steady)
    return Verdict("ill-conditioned" if explained else "DEFECT", difference, remark)


def main(report: Callable[[str], None] = lambda line: print(line, flush=True)) -> None:
    """Print what does not simply agree, and the counts."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    other = sys.argv[3] if len(sys.argv) > 3 else "cvode"
    kinds = {"supports": driven_scene, "resting": resting_scene}
    drawn = next((kinds[word] for word in sys.argv[4:] if word in kinds), random_scene)
    words: Counter[str] = Counter()
    largest = 0.0
    for seed in range(first, first + count):
        verdict = judge(seed, other, drawn)
        words[verdict.word] += 1
        if verdict.word == "agree":
            largest = max(largest, verdict.difference)
        else:
            report(f"{seed}: {verdict.word} {verdict.difference:.1e}: {verdict.remark}")
        if seed % 25 == 24:
            report(f"# up to {seed}: {dict(words)}")
    report(f"{dict(words)}; largest difference where they agree {largest:.1e} of scale")


if __name__ == "__main__":
    main()
