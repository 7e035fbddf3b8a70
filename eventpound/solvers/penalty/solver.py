"""The solver ``penalty``: tasks in, recordings out."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from eventpound.mechanics.contact_laws import contact_forces
from eventpound.mechanics.model import assemble
from eventpound.scene.contact_law import BY_WORD
from eventpound.solvers.base import Recording, Task
from eventpound.solvers.events.scales import scene_scales
from eventpound.solvers.penalty.elements import (
    STIFFER,
    contact_steps,
    contact_stiffness,
    elements_of,
    shortest_period,
)
from eventpound.solvers.penalty.step import advance
from eventpound.solvers.settings import Settings
from eventpound.solvers.timestepping.run import carry_to_end, prepared
from eventpound.solvers.timestepping.steps import SETTINGS, checked_choices, time_step


class Penalty:
    """Newmark's method with contact elements; `eventpound.solvers.penalty.step`."""

    name = "penalty"
    summary = "Newmark with contact elements, fixed step: a baseline; rtol is not used"
    rests = False
    settings: Mapping[str, str] = {
        "contact_steps": "contacts under Newton's law so stiff that one lasts so many steps of "
        f"time_step; default {STIFFER:g} times the stiffest spring's, and never softer",
        **SETTINGS,
    }
    counts_steps = True
    contact_laws = tuple(BY_WORD)

    def check_settings(self, settings: Settings) -> None:
        """Refuse values that it cannot take; see `eventpound.solvers.base.Solver`."""
        contact_steps(settings)
        checked_choices(settings)

    def check_task(self, task: Task) -> None:
        """Refuse more steps than there may be."""
        model = assemble(task.scene)
        scales = scene_scales(task.scene, model, task.end - task.start)
        elements = elements_of(task.scene, contact_stiffness(task, model, scales))
        time_step(task, model, scales, shortest_period(model, scales, elements))

    def solve(self, task: Task) -> Recording:
        """Carry the scene from start to end; see `eventpound.solvers.base.Solver`."""
        run = prepared(task, 0.5)
        model, scales = run.model, run.scales
        elements = elements_of(task.scene, contact_stiffness(task, model, scales))
        run.laws = elements.laws
        step = time_step(task, model, scales, shortest_period(model, scales, elements))
        gap, rate = model.gaps(model.u0), model.rates(model.v0)
        run.work.state.contact[:] = contact_forces(model.elements, gap, rate, np.zeros(gap.size))
        return carry_to_end(run, step, advance, elements)
