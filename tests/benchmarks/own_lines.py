"""Two lines more of a work-precision diagram: a run among many, and an element's own model.

A contact element of linear stiffness k is, as a model, a spring that pushes where the gap is
below zero: a bilinear-elastic spring in the place of the contact. Event-driven solvers take its
kinks exactly, so that the error of a stepper against *its own model* can be told from that of
the model against the rigid law (docs/measured/steppers.md takes it further apart).
"""

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from eventpound import Case, simulate_many
from eventpound.accuracy.compare import Comparison, entries, judge_entries
from eventpound.accuracy.work_precision import Judged
from eventpound.mechanics.model import assemble
from eventpound.scene import BARRIER, GROUND, BilinearElastic, Scene, Spring
from eventpound.solvers.base import Task
from eventpound.solvers.events.scales import scene_scales
from eventpound.solvers.penalty.elements import contact_stiffness

AMONG_MANY, OWN_MODEL = "fast, one of 1000 runs", "penalty, its own model"
RUNS, CALLS = 1000, 3
FAST = "fast"


def own_model(case: Case) -> Case:
    """The case with springs of the element's stiffness in the place of its contacts."""
    scene, end = case.scene, case.run.duration
    model = assemble(scene)
    task = Task(scene, 0.0, end, 1e-9)
    scales = scene_scales(scene, model, end)
    k = np.broadcast_to(contact_stiffness(task, model, scales), len(scene.contacts))
    springs = tuple(
        Spring(
            f"stop of {contact.name}",
            (_end(contact.left), _end(contact.right)),
            BilinearElastic(float(stiffness), 0.0, -contact.gap),
        )
        for contact, stiffness in zip(scene.contacts, k, strict=True)
    )
    without = Scene(scene.bodies, (*scene.springs, *springs), scene.dashpots, (), scene.motion)
    return replace(case, scene=without)


def _end(name: str) -> str:
    return GROUND if name == BARRIER else name


def with_own_lines(comparison: Comparison, steps: Sequence[float]) -> Comparison:
    """The comparison with both lines among its runs."""
    among = [
        replace(run, label=AMONG_MANY, seconds=_seconds_among_many(comparison.case, run))
        for run in comparison.runs
        if run.label == FAST and run.errors is not None
    ]
    own = judge_entries(
        own_model(comparison.case), entries([("penalty", {})], [], steps), repeats=1
    )
    stepped = [replace(run, label=OWN_MODEL) for run in own.runs]
    return replace(comparison, runs=(*comparison.runs, *among, *stepped))


def _seconds_among_many(case: Case, run: Judged) -> float:
    """Processor time of one of many equal runs in one call, on one worker (s)."""
    contact = case.scene.contacts[0]
    gaps = {f"contact.{contact.name}.gap": np.full(RUNS, contact.gap)}
    best = np.inf
    for _ in range(CALLS):
        began = time.process_time()
        simulate_many(case.scene, gaps, rtol=run.entry.rtol, duration=case.run.duration, workers=1)
        best = min(best, time.process_time() - began)
    return float(best) / RUNS
