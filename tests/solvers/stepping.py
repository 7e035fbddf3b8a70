"""A scene about to take a step of its own, for tests of the parts of the fast stepper."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.model import Model, assemble
from eventpound.numerics.arrays import Floats
from eventpound.scene import Scene
from eventpound.solvers.base import Task
from eventpound.solvers.events.event_rows import EVENT_WIDTH
from eventpound.solvers.events.inspection import Running, blank_extremes
from eventpound.solvers.events.recorder import extremes_rounding, row_width
from eventpound.solvers.events.scales import scene_scales
from eventpound.solvers.fast.blanks import blank_series, blank_state
from eventpound.solvers.fast.instant import start
from eventpound.solvers.fast.plan import Plan, Record, Series, State
from eventpound.solvers.fast.planning import plan_of
from eventpound.solvers.fast.sample_forces import begin


class Stepper(NamedTuple):
    """What the compiled stepper works on, and the table of the present tangents."""

    plan: Plan
    state: State
    series: Series
    model: Model
    running: Running
    table: int


def stepper_of(scene: Scene, z: Floats, rtol: float, dt: float = 1.0) -> Stepper:
    """A scene at the start of a run of 2 s, its springs at z, steps of dt (s) before it."""
    task = Task(scene, 0.0, 2.0, rtol)
    model = assemble(task.scene)
    scales = scene_scales(task.scene, model, task.end)
    plan = plan_of(task, model, scales)
    state = blank_state(plan, model.u0, model.v0, z, task.start)
    sizes = model.bodies, model.links, model.hysteretic.size, model.contacts
    series = blank_series(*sizes, plan.limits.order)
    table = blank_extremes(extremes_rounding(model, scales))
    room = np.zeros((9, EVENT_WIDTH)), np.zeros((9, row_width(model)))
    start(plan, state, series, Record(*room, table, np.ones(model.contacts, bool)))
    return Stepper(plan, state, series, model, Running(*table), begin(dt, plan, state, series))
