"""What the fixed-step baselines make of a hard scene, beside what the others agree on."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from eventpound.accuracy.errors import motion_scales, value_scales, values_of
from eventpound.accuracy.paired_events import impact_errors
from eventpound.errors import ComputationError, InputError
from eventpound.mechanics.model import assemble
from eventpound.response import Response
from eventpound.simulation import simulate
from eventpound.solvers.base import Recording
from eventpound.solvers.events.scales import scene_scales
from tests.hard.catalogue import Hard

BASELINES = ("moreau", "penalty")
MOST_STEPS = 3_000_000
"""Of one run: a pulse of a millionth of the structure's period asks for 100 000 000."""


@dataclass(frozen=True)
class Baseline:
    """One baseline's part.

    Parameters
    ----------
    error : float
        Largest error of a peak or a final value in parts of the body's own motion;
        NaN where there is none to state.
    missed, extra : int
        Impacts.
    refusal : str
        What it said instead, or where it stopped.
    """

    error: float = math.nan
    missed: int = 0
    extra: int = 0
    refusal: str = ""

    @property
    def text(self) -> str:
        """In a cell of a table."""
        if "limit of" in self.refusal:
            return f"takes more than {MOST_STEPS:.0e} steps"
        if self.refusal:
            return self.refusal.split(";")[0]
        impacts = [f"{n} {word}" for n, word in ((self.missed, "missed"), (self.extra, "extra"))]
        return ", ".join([f"{self.error:.0e}", *(x for x in impacts if not x.startswith("0 "))])


def baseline(hard: Hard, solver: str, agreed: Response | None) -> Baseline:
    """Run a scene with the steps that the solver chooses by itself."""
    try:
        found = simulate(hard.case, solver=solver, settings={}, max_steps=MOST_STEPS)
    except (ComputationError, InputError) as error:
        return Baseline(refusal=str(error))
    if agreed is None:
        return Baseline(refusal="ends, where there is no answer")
    return _against(agreed, found.recording)


def _against(agreed: Response, found: Recording) -> Baseline:
    """Errors of a run."""
    task, reference = agreed.task, agreed.recording
    scales = scene_scales(task.scene, assemble(task.scene), task.end - task.start)
    size = motion_scales(reference.history, reference, scales.time, scales.length, scales.z_bound)
    divisors = value_scales(task.scene, size)
    values, wanted = values_of(task.scene, found), values_of(task.scene, reference)
    errors = [abs(values[key] - wanted[key]) / divisors[key] for key in wanted]
    impacts = impact_errors(
        reference.events, found.events, scales.time, float(size.v.max()), (task.start, task.end)
    )
    return Baseline(float(np.max(errors)), impacts.missed, impacts.extra)
