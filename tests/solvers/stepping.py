"""A scene about to take a step of its own, for tests of the parts of the fast stepper."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.contact.event_rows import EVENT_WIDTH
from eventpound.mechanics.model import Model, assemble
from eventpound.mechanics.monitored import Running, blank_extremes, places_in
from eventpound.numerics.arrays import Floats
from eventpound.scene import Scene
from eventpound.solvers.base import Task
from eventpound.solvers.events.recorder import row_width
from eventpound.solvers.events.scales import scene_scales
from eventpound.solvers.fast.constants import (
    begin_state,
    blank_located,
    blank_series,
    plan_of,
    zero_state,
)
from eventpound.solvers.fast.evaluate import blank_fast_observed
from eventpound.solvers.fast.instant import start
from eventpound.solvers.fast.run import FastPlan, FastRecord, FastRun, FastSeries, FastState
from eventpound.solvers.fast.sampled.forces import begin


class Stepper(NamedTuple):
    """What the compiled stepper works on, and the table of the present tangents."""

    run: FastRun
    model: Model
    table: int

    @property
    def plan(self) -> FastPlan:
        """Constants of the run."""
        return self.run.plan

    @property
    def state(self) -> FastState:
        """What moves."""
        return self.run.state

    @property
    def series(self) -> FastSeries:
        """Scratch of the run."""
        return self.run.series


def state_of(plan: FastPlan, model: Model, z: Floats) -> FastState:
    """The state of a scene before a run from 0 s on, its springs at z."""
    state = zero_state(model.counts)
    begin_state(plan, model.u0, model.v0, z, 0.0, state)
    return state


def stepper_of(scene: Scene, z: Floats, rtol: float, dt: float = 1.0) -> Stepper:
    """A scene at the start of a run of 2 s, its springs at z, steps of dt (s) before it."""
    task = Task(scene, 0.0, 2.0, rtol)
    model = assemble(task.scene)
    scales = scene_scales(task.scene, model, task.end)
    plan = plan_of(task, model, scales)
    state = state_of(plan, model, z)
    at = places_in(model)
    table = blank_extremes(at, scales)
    room = np.zeros((9, EVENT_WIDTH)), np.zeros((9, row_width(model)))
    record = FastRecord(*room, table, np.ones(model.contacts, bool))
    series, located, observed = blank_series(plan), blank_located(plan), blank_fast_observed(plan)
    run = FastRun(plan, state, series, located, record, observed, Running(*table, at))
    start(run)
    return Stepper(run, model, begin(dt, run))
