"""The solver ``moreau``: tasks in, recordings out."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from eventpound.contact.rubbing import PLACE
from eventpound.errors import ComputationError
from eventpound.mechanics.model import Model, assemble
from eventpound.mechanics.supported import lowered
from eventpound.numerics.arrays import Bools, Floats
from eventpound.scene.contact_law import IMPACT_LAWS
from eventpound.scene.scene import Scene
from eventpound.solvers.base import FrictionRecording, Recording, Task
from eventpound.solvers.events.scales import scene_scales
from eventpound.solvers.moreau.step import Active, advance
from eventpound.solvers.settings import Settings, number
from eventpound.solvers.supported import with_supports
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
    takes_points = True
    takes_forces = True
    takes_friction = True
    impact_laws = IMPACT_LAWS

    def check_settings(self, settings: Settings) -> None:
        """Refuse values that it cannot take; see `eventpound.solvers.base.Solver`."""
        _theta(settings)
        checked_choices(settings)

    def check_task(self, task: Task) -> None:
        """Refuse more steps than there may be."""
        task = replace(task, scene=lowered(task.scene, task.start))
        model = assemble(task.scene)
        time_step(task, model, scene_scales(task.scene, model, task.end - task.start), math.inf)

    def solve(self, task: Task) -> Recording:
        """Carry the scene from start to end; see `eventpound.solvers.base.Solver`."""
        return with_supports(task, _solve)


def _solve(task: Task) -> Recording:
    """The same of a scene as the engine has it."""
    run = prepared(task, _theta(task.settings))
    step = time_step(task, run.model, run.scales, math.inf)
    contacts = np.zeros(run.model.contacts, np.int64)
    marked, struck, resting = np.zeros((3, contacts.size), np.bool_)
    rubbed = np.zeros((5, contacts.size))
    column, slides = np.zeros(run.model.coordinates), np.full(contacts.size, -1)
    active = Active(contacts, marked, struck, resting, column, rubbed, slides)
    try:
        recording = carry_to_end(run, step, advance, active, lambda: _rubbing(task.scene, marked))
    except ComputationError as error:
        if error.recording is not None:
            error.recording = _with_friction(error.recording, run.model, rubbed)
        raise
    return _with_friction(recording, run.model, rubbed)


def _rubbing(scene: Scene, marked: Bools) -> str:
    """The contacts of a step, for a message."""
    closed = [
        contact for contact, takes_part in zip(scene.contacts, marked, strict=True) if takes_part
    ]
    return ", ".join(f"{c.name!r} (friction {c.friction:g})" for c in closed)


def _with_friction(recording: Recording, model: Model, rubbed: Floats) -> Recording:
    """A recording with what friction did, in a scene that has some."""
    if not model.friction.any():
        return recording
    return replace(recording, friction=FrictionRecording(*rubbed[:PLACE]))


def _theta(settings: Settings) -> float:
    theta = number(settings, "theta", "a number from 0.5 to 1", 0.5, 1.0)
    return THETA if theta is None else theta
