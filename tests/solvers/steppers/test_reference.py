"""Moreau–Jean against the solved problems, at a coarse and at a fine step."""

import math

import numpy as np
import pytest

from eventpound.solvers import solver_named
from eventpound.solvers.base import EventKind, Task
from tests.reference.comparison import LISTED
from tests.reference.problems import load
from tests.solvers.random_scenes import random_scene

PROBLEMS = load()
# Accumulations have no count of impacts for the bound to grow with, and chaos has no bound.
COUNTED = [
    name
    for name, problem in PROBLEMS.items()
    if problem.result["n_impacts"] is not None and problem.result["amplification"]["final_u"] < 1e3
]


@pytest.mark.parametrize("steps", [200, 3200])
@pytest.mark.parametrize("name", COUNTED)
def test_peaks_err_as_the_rule_shifts_impacts(name, steps):
    problem = PROBLEMS[name]
    stored = problem.result
    settings = {"steps_per_period": steps}
    recording = solver_named("moreau").solve(
        Task(problem.scene, 0.0, problem.end, 1e-9, settings=settings)
    )
    wanted = [np.array([float(x) for x in stored[key]]) for key in ("u_max", "u_min")]
    found = (recording.displacement.maximum, recording.displacement.minimum)
    error = max(np.abs(a - b).max() for a, b in zip(found, wanted, strict=True))
    # Every impact is up to h/2 off in time and up to h γ in place, so what follows is off by
    # h times the closing speed, as far as the problem amplifies changes (of its inputs: a
    # factor of 2 for those of a state). Between impacts the phase is slow by (ω h)²/12.
    h = problem.end / recording.work.steps
    shift = h * float(stored["max_closing_speed"]) * stored["n_impacts"]
    angle = 2.0 * math.pi / steps
    length = max(np.abs(part).max() for part in wanted)
    slow = recording.work.steps * angle * angle**2 / 12.0 * length
    amplification = max(1.0, stored["amplification"]["extremes"])
    assert error < 2.0 * amplification * (shift + slow)


MISCOUNTED = {
    "B07": (1, "a near miss at 3.1 s becomes an impact"),
    "D01": (-1, "a step leaps over the graze that is the only impact"),
}
"""By how many impacts the rule is wrong with 12800 steps a period, and why."""


@pytest.mark.parametrize("name", COUNTED)
def test_impacts_are_counted(name):
    problem = PROBLEMS[name]
    stored = problem.result
    if stored["threshold_margin_log10"] < 0.3:
        pytest.skip("the count hangs on a threshold")
    recording = solver_named("moreau").solve(
        Task(problem.scene, 0.0, problem.end, 1e-9, settings={"steps_per_period": 12800})
    )
    fastest = float(stored["max_closing_speed"])
    groups: dict[int, float] = {}
    for event in recording.events:
        if event.kind is EventKind.IMPACT:
            groups[event.group] = min(groups.get(event.group, 0.0), event.gap_velocity_before)
    loud = [group for group, rate in groups.items() if rate < -LISTED * fastest]
    wrong, _ = MISCOUNTED.get(name, (0, ""))
    assert len(loud) == stored["n_impacts_above_fraction_of_max_speed"]["1e-4"] + wrong


@pytest.mark.parametrize("steps", [100, 1600])
def test_a_collapse_beside_a_barrier_is_not_seen(steps):
    # A body thrown to and fro between a barrier and a heavier one that it has just met: the
    # gap opens by less than the penetration of the impact before, so the rule takes both
    # contacts as one problem, whatever the step. This is a limit of the method, held here.
    scene, end = random_scene(308)
    task = Task(scene, 0.0, end, 1e-9, settings={"steps_per_period": steps})
    mine = solver_named("moreau").solve(task).displacement
    true = solver_named("fast").solve(Task(scene, 0.0, end, 1e-9)).displacement
    scale = max(np.abs(true.maximum).max(), np.abs(true.minimum).max())
    off = max(np.abs(mine.maximum - true.maximum).max(), np.abs(mine.minimum - true.minimum).max())
    assert off > 0.5 * scale
