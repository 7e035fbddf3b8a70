"""The fast solver: tasks in, recordings out; and whether it can run at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from eventpound.contact.cascade import (
    EVENTS,
    GROUPS,
    IN_A_ROW,
    LONGEST_CASCADE,
    T,
    crowded_message,
    endless_message,
    long_message,
)
from eventpound.contact.event_rows import EVENT_WIDTH, events_of, events_wanted
from eventpound.contact.impacts import ENDLESS, FULL
from eventpound.errors import ComputationError
from eventpound.mechanics.model import Model, assemble
from eventpound.mechanics.monitored import blank_extremes, places_in, running_of
from eventpound.mechanics.supported import lowered
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import in_python
from eventpound.numerics.compiled.linked import Entry
from eventpound.numerics.compiling import Stopwatch
from eventpound.scene.spring import Hysteretic, Linear
from eventpound.solvers.base import Energy, Recording, Task, Work, steps_used_up
from eventpound.solvers.events.recorder import (
    energy_ledger,
    history_of,
    impact_terms,
    kept,
    row_width,
)
from eventpound.solvers.events.scales import SceneScales, scene_scales
from eventpound.solvers.events.step_check import check_energy
from eventpound.solvers.events.underway import lines_before
from eventpound.solvers.fast.advance import advance
from eventpound.solvers.fast.constants import (
    blank_happened,
    blank_series,
    blank_state,
    links_of,
    plan_of,
)
from eventpound.solvers.fast.evaluate import blank_seen
from eventpound.solvers.fast.links import all_variables
from eventpound.solvers.fast.record import rows_wanted
from eventpound.solvers.fast.run import (
    CROWDED,
    EXPANSIONS,
    FINISHED,
    GOING_ON,
    MESSAGES,
    ROWS,
    STEPS,
    STUCK,
    FastPlan,
    FastRecord,
    FastRun,
    FastState,
)
from eventpound.solvers.fast.single.body import oscillator_of
from eventpound.solvers.fast.single.oscillator import oscillate
from eventpound.solvers.supported import with_supports

BUDGET = 20_000
"""Steps between two reports of progress."""
FIRST_ROOM = 256
"""Events for which there is room at first."""
GROWTH = 4
"""Times the room there was, where it is too little."""
MOST_EVENTS = 2_000_000
"""Events after which a run gives up, before they fill the memory."""


class Fast:
    """Compiled Taylor series, hysteresis eliminated."""

    name = "fast"
    summary = "compiled Taylor series with hysteresis eliminated: for many runs"
    settings: Mapping[str, str] = {}
    counts_steps = True
    takes_supports = True

    def solve(self, task: Task) -> Recording:
        """Carry the scene from start to end; see `eventpound.solvers.base.Solver`."""
        return with_supports(task, self._solve)

    def _solve(self, task: Task) -> Recording:
        clock = Stopwatch()
        model = assemble(task.scene)
        scales = scene_scales(task.scene, model, task.end - task.start)
        plan = plan_of(task, model, scales)
        state = blank_state(plan, model.u0, model.v0, model.z0, task.start, model.ledger_entries)
        run, ended, stopped = _run(task, plan, state, model, scales)
        recording = recording_of(task, model, scales, run, ended, clock)
        if stopped is not None:
            stopped.recording = replace(recording, message=str(stopped))
            raise stopped
        if ended != FINISHED:
            raise ComputationError(recording.message, float(state.clock[T]), recording)
        if recording.energy is not None:
            try:
                check_energy(recording.t, recording.energy, task.rtol)
            except ComputationError as error:
                error.recording = recording
                raise
        return recording


def run_of(plan: FastPlan, state: FastState, model: Model, scales: SceneScales) -> FastRun:
    """A run with nothing recorded."""
    at = places_in(model)
    record = FastRecord(
        np.zeros((FIRST_ROOM + 4 * model.contacts, EVENT_WIDTH)),
        np.zeros((plan.output_times.size + 2 * FIRST_ROOM, row_width(model))),
        blank_extremes(at, scales),
        np.ones(model.contacts, np.bool_),
    )
    return FastRun(
        plan=plan,
        state=state,
        series=blank_series(plan, model.loads > 0),
        happened=blank_happened(plan),
        record=record,
        seen=blank_seen(plan),
        running=in_python(running_of)(record.extremes, at),
    )


def _run(
    task: Task, plan: FastPlan, state: FastState, model: Model, scales: SceneScales
) -> tuple[FastRun, int, ComputationError | None]:
    """Advance to the end, with progress and room for the record; how it ended, who stopped it."""
    run = run_of(plan, state, model, scales)
    alone = plan.oscillator.alone
    most = task.max_steps
    while True:
        budget = BUDGET if most is None else min(BUDGET, most - int(state.count[STEPS]))
        if alone:
            ended = oscillate(budget, plan, state, run.series.single, run.record)
        else:
            ended = advance(budget, run)
        if ended == FULL:
            if state.count[EVENTS] > MOST_EVENTS:
                return run, CROWDED, None
            run = run._replace(record=_enlarged(run.record, plan, state))
        elif ended != GOING_ON:
            return run, ended, None
        try:
            if task.progress is not None:
                task.progress(float(state.clock[T]))
            if most is not None and state.count[STEPS] >= most:
                raise steps_used_up(most, float(state.clock[T]))
        except ComputationError as stopped:
            return run, ended, stopped


def _enlarged(record: FastRecord, plan: FastPlan, state: FastState) -> FastRecord:
    """The record with more room for what it has too little of."""
    rows, events = record.rows, record.events
    wanted = in_python(events_wanted)(plan.contacts.left.size, state.count)
    if wanted > events.shape[0]:
        events = _longer(events)
    if in_python(rows_wanted)(plan.output_times.size, state.count) > rows.shape[0]:
        rows = _longer(rows)
    return record._replace(events=events, rows=rows)


def _longer(rows: Floats) -> Floats:
    """The rows with room for more behind them."""
    longer = np.empty((GROWTH * rows.shape[0], rows.shape[1]))
    longer[: rows.shape[0]] = rows
    return longer


def recording_of(
    task: Task, model: Model, scales: SceneScales, run: FastRun, ended: int, clock: Stopwatch
) -> Recording:
    """What a run leaves, as every solver returns it."""
    plan, state, record = run.plan, run.state, run.record
    events = events_of(record.events[: state.count[EVENTS]])
    t = float(state.clock[T])
    energy: Energy | None = None
    if task.energy:
        terms = impact_terms(model, task.scene.motion, events)
        energy = energy_ledger(model, scales, state.u, state.v, state.ledger, *terms)
    rows, before = record.rows[: state.count[ROWS]], lines_before(task, model, scales)
    if before.size > 0:
        rows = np.vstack((before, rows))
    z = np.empty(model.hysteretic.size)
    all_variables(model.elongations(state.u), plan.hysteresis, state, z)
    message = MESSAGES.get(ended, "left before its end")
    if ended == ENDLESS:
        message = endless_message(events, task.scene.contacts)
    elif ended == STUCK and state.count[IN_A_ROW] > LONGEST_CASCADE:
        message = long_message(events, task.scene.contacts)
    elif ended == CROWDED:
        message = crowded_message(events, task.scene.contacts)
    return Recording(
        ended == FINISHED,
        message,
        t,
        state.u.copy(),
        state.v.copy(),
        z,
        history_of(rows, record.unique, model),
        tuple(events),
        unique_forces=record.unique,
        work=Work(
            int(state.count[EXPANSIONS]),
            0,
            int(state.count[STEPS]),
            int(state.count[GROUPS]),
            clock.seconds,
            clock.compilation,
        ),
        energy=energy,
        **kept(record.extremes, events, t, model),
    )


def kernels_kept(task: Task) -> bool:
    """Whether a run of a task would compile none of the large kernels.

    Nothing is compiled to tell: types do not depend on numbers, so the scene stands here with
    linear springs in the place of hysteretic ones, for which no backbone is made, and a kernel
    that has run in this process serves every scene.
    """
    curved = [isinstance(spring.law, Hysteretic) for spring in task.scene.springs]
    springs = tuple(
        replace(spring, law=Linear(1.0)) if bends else spring
        for spring, bends in zip(task.scene.springs, curved, strict=True)
    )
    scene = lowered(replace(task.scene, springs=springs), task.start)
    task = replace(task, scene=scene, progress=None)
    model = assemble(task.scene)
    scales = scene_scales(task.scene, model, task.end - task.start)
    one = oscillator_of(model, scales.length, links_of(model), energy=task.energy)
    needed: tuple[Callable[..., Any], ...] = (advance,)
    if one.alone and sum(curved) <= 1:
        needed = (oscillate,)
    if all(isinstance(each, Entry) and each.overloads for each in needed):
        return True
    plan = plan_of(task, model, scales)
    state = blank_state(plan, model.u0, model.v0, model.z0, task.start, model.ledger_entries)
    run = run_of(plan, state, model, scales)
    arguments: dict[Callable[..., Any], tuple[Any, ...]] = {
        oscillate: (BUDGET, plan, state, run.series.single, run.record),
        advance: (BUDGET, run),
    }
    return all(_ready(each, *arguments[each]) for each in needed)


def _ready(function: Callable[..., Any], *arguments: Any) -> bool:
    """Whether a compiled function can be called with such arguments at once."""
    if not isinstance(function, Entry):
        return False
    types = tuple(function.typeof_pyval(each) for each in arguments)
    return types in function.overloads or function._cache.has(types, function.targetctx)
