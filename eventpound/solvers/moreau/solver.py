"""The solver ``moreau``: tasks in, recordings out."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from eventpound.mechanics.model import assemble
from eventpound.solvers.base import Recording, Task
from eventpound.solvers.events.scales import scene_scales
from eventpound.solvers.moreau.step import Active, advance
from eventpound.solvers.settings import Settings, number
from eventpound.solvers.timestepping.run import carry_to_end, prepared
from eventpound.solvers.timestepping.steps import SETTINGS, checked_choices, time_step

THETA = 0.5


class Moreau:
    """Moreau–Jean time-stepping with a fixed step; `eventpound.solvers.moreau.step`."""

    name = "moreau"
    summary = "Moreau–Jean time-stepping, fixed step: a baseline; rtol is not used"
    settings: Mapping[str, str] = {
        **SETTINGS,
        "theta": f"of the rule, 0.5 to 1 (default {THETA}: second order where nothing closes)",
    }
    counts_steps = True

    def check_settings(self, settings: Settings) -> None:
        """Refuse values that it cannot take; see `eventpound.solvers.base.Solver`."""
        _theta(settings)
        checked_choices(settings)

    def check_task(self, task: Task) -> None:
        """Refuse more steps than there may be."""
        model = assemble(task.scene)
        time_step(task, model, scene_scales(task.scene, model, task.end - task.start), math.inf)

    def solve(self, task: Task) -> Recording:
        """Carry the scene from start to end; see `eventpound.solvers.base.Solver`."""
        run = prepared(task, _theta(task.settings))
        step = time_step(task, run.model, run.scales, math.inf)
        contacts = np.zeros(run.model.contacts, np.int64)
        marked, struck, resting = np.zeros((3, contacts.size), np.bool_)
        active = Active(contacts, marked, struck, resting, np.zeros(run.model.bodies))
        return carry_to_end(run, step, advance, active)


def _theta(settings: Settings) -> float:
    theta = number(settings, "theta", "a number from 0.5 to 1", 0.5, 1.0)
    return THETA if theta is None else theta
