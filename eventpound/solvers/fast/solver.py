"""The fast solver: tasks in, recordings out; and whether it can run at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from threading import local
from typing import Any

import numpy as np

from eventpound.case.options import FAST_KNOWS
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
from eventpound.mechanics.backbone import Hysteresis
from eventpound.mechanics.model import Model, assemble, shape_of
from eventpound.mechanics.monitored import blank_extremes, places_in, running_of
from eventpound.mechanics.numbers import numbers_of, put_numbers, with_numbers
from eventpound.mechanics.supported import lowered
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import in_python
from eventpound.numerics.compiled.linked import Entry
from eventpound.numerics.compiling import Stopwatch
from eventpound.numerics.latest import Latest
from eventpound.scene.contact import Contact
from eventpound.scene.parameters import Place
from eventpound.scene.spring import Hysteretic, Linear
from eventpound.solvers.base import Energy, History, Recording, Task, Work, steps_used_up
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
    clear_scratch,
    links_of,
    plan_of,
)
from eventpound.solvers.fast.evaluate import blank_seen
from eventpound.solvers.fast.followed import follow
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
SHAPES_KEPT = 8
"""Shapes of scenes whose arrays wait in each thread for the next run."""
MOST_KEPT = 2**20
"""Bytes of the history of a run in whose arrays the next one may go."""


class Fast:
    """Compiled Taylor series, hysteresis eliminated."""

    name = "fast"
    summary = "compiled Taylor series with hysteresis eliminated: for many runs"
    settings: Mapping[str, str] = {}
    counts_steps = True
    takes_supports = True
    memories = FAST_KNOWS

    def solve(self, task: Task) -> Recording:
        """Carry the scene from start to end; see `eventpound.solvers.base.Solver`."""
        return with_supports(task, lambda lowered: Ready(lowered).run({}, lowered)())

    def ready(self, task: Task) -> Ready | None:
        """The task, to be run with other numbers; see `eventpound.solvers.base.Solver`."""
        return None if task.scene.supports or task.scene.forces else Ready(task)


class Ready:
    """A task that is run with other numbers; see `eventpound.solvers.base.ReadyTask`.

    Parameters
    ----------
    task : Task
        The run of the scene as it is, which has no supports and forces any more.
    """

    def __init__(self, task: Task) -> None:
        self._scene, self._model = task.scene, assemble(task.scene)
        self._own = numbers_of(self._model)
        self._shape = task.rtol, task.energy, *shape_of(self._model)

    def run(self, values: Mapping[Place, float], task: Task) -> Callable[[], Recording]:
        """Run it."""
        known = _last_of_thread.arrays
        # Who watches a run may begin another.
        arrays = known.pop(self._shape, None) or Arrays(self._model)
        columns = {place: np.array((value,)) for place, value in values.items()}
        for key, array in arrays.numbers.items():
            array[...] = self._own[key]
        put_numbers(self._scene, self._model, columns, arrays.rows)
        try:
            return arrays.run(task).recording
        finally:
            while len(known) >= SHAPES_KEPT:
                del known[next(iter(known))]
            known[self._shape] = arrays


class _LastOfThread(local):
    """Arrays of the shapes of scenes that a thread has run last."""

    def __init__(self) -> None:
        self.arrays: dict[tuple[object, ...], Arrays] = {}


_last_of_thread = _LastOfThread()


class Arrays:
    """Arrays of all scenes of one shape at one tolerance, for one run after the other.

    What is kept of one run for the next is scratch, and what follows from equal numbers.

    Parameters
    ----------
    model : Model
        One of them, assembled.

    Attributes
    ----------
    numbers : dict of str to ndarray
        `eventpound.mechanics.numbers.numbers_of` of the next run.
    rows : dict of str to ndarray
        The same with a leading axis.
    """

    def __init__(self, model: Model) -> None:
        self.numbers = {key: array.copy() for key, array in numbers_of(model).items()}
        self.rows = {key: array[None] for key, array in self.numbers.items()}
        self._model, self._keep = with_numbers(model, self.numbers), Latest()
        self._run: FastRun | None = None

    def run(self, task: Task) -> Left:
        """Run a task of the present numbers, but for the motion, which is that of its scene."""
        clock, model, keep = Stopwatch(), self._model, self._keep
        scales = scene_scales(task.scene, model, task.end - task.start, keep)
        plan = plan_of(task, model, scales, keep)
        state = blank_state(plan, model.u0, model.v0, model.z0, task.start, model.ledger_entries)
        run, ended, stopped = _run(task, self._blank_run(plan, state, scales))
        left = _left_by(task, model, scales, run, ended, clock)
        self._run = run if run.record.rows.nbytes <= MOST_KEPT else None
        if stopped is not None:
            stopped.recording = replace(left.recording(), message=str(stopped))
            raise stopped
        if ended != FINISHED:
            recording = left.recording()
            raise ComputationError(recording.message, left.t, recording)
        if left.energy is not None:
            try:
                check_energy(left.t, left.energy, task.rtol)
            except ComputationError as error:
                error.recording = left.recording()
                raise
        return left

    def _blank_run(self, plan: FastPlan, state: FastState, scales: SceneScales) -> FastRun:
        """A run with nothing recorded, in the arrays of the one before."""
        run = self._run
        if run is None or not np.array_equal(run.plan.ground.family, plan.ground.family):
            return run_of(plan, state, self._model, scales)
        if not plan.oscillator.alone:
            in_python(clear_scratch)(run.series, run.happened, run.seen)
        # As bytes: a record is copied field by field.
        run.series.single.body.view(np.uint8)[:] = 0
        run.record.extremes[:] = self._keep(
            ("extremes", scales.length, scales.acceleration, scales.force),
            lambda: blank_extremes(places_in(self._model), scales),
        )
        run.record.unique[:] = True
        return run._replace(plan=plan, state=state)


@dataclass(frozen=True)
class Left:
    """What a run has left, from which a recording is made when it is asked for.

    Parameters
    ----------
    contacts : tuple of Contact
        Of the scene.
    model : Model
        Of which only the shape counts: its numbers may be those of a later run.
    ended : int
        How the run ended.
    t : float
        When (s).
    state : FastState
        As it was last.
    hysteresis : Hysteresis
        Of the plan.
    events, rows, extremes : ndarray
        Of `FastRecord`.
    unique : ndarray of bool, shape (K,)
        Whether forces were always unique.
    history : History, optional
        Where forces were not, so that it takes the numbers of the model.
    energy : Energy, optional
        The ledger, where it was kept.
    seconds, compilation : float
        Of `Work`.
    """

    contacts: tuple[Contact, ...]
    model: Model
    ended: int
    t: float
    state: FastState
    hysteresis: Hysteresis
    events: Floats
    rows: Floats
    extremes: Floats
    unique: Bools
    history: History | None
    energy: Energy | None
    seconds: float
    compilation: float

    def recording(self) -> Recording:
        """The same as every solver returns it."""
        events, state, z = events_of(self.events), self.state, np.empty(self.hysteresis.link.size)
        all_variables(self.model.elongations(state.u), self.hysteresis, state, z)
        count = state.count
        message = MESSAGES.get(self.ended, "left before its end")
        if self.ended == ENDLESS:
            message = endless_message(events, self.contacts)
        elif self.ended == STUCK and count[IN_A_ROW] > LONGEST_CASCADE:
            message = long_message(events, self.contacts)
        elif self.ended == CROWDED:
            message = crowded_message(events, self.contacts)
        work = int(count[EXPANSIONS]), 0, int(count[STEPS]), int(count[GROUPS])
        return Recording(
            self.ended == FINISHED,
            message,
            self.t,
            state.u,
            state.v,
            z,
            self.history or history_of(self.rows, self.unique, self.model),
            tuple(events),
            unique_forces=self.unique,
            work=Work(*work, self.seconds, self.compilation),
            energy=self.energy,
            **kept(self.extremes, events, self.t, self.model),
        )


def _left_by(
    task: Task, model: Model, scales: SceneScales, run: FastRun, ended: int, clock: Stopwatch
) -> Left:
    """What a run leaves, in arrays of its own."""
    state, record = run.state, run.record
    events = record.events[: state.count[EVENTS]].copy()
    energy: Energy | None = None
    if task.energy:
        terms = impact_terms(model, task.scene.motion, events_of(events))
        energy = energy_ledger(model, scales, state.u, state.v, state.ledger, *terms)
    rows, before = record.rows[: state.count[ROWS]], lines_before(task, model, scales)
    rows = np.vstack((before, rows)) if before.size > 0 else rows.copy()
    unique = record.unique.copy()
    return Left(
        task.scene.contacts,
        model,
        ended,
        float(state.clock[T]),
        state,
        run.plan.hysteresis,
        events,
        rows,
        record.extremes.copy(),
        unique,
        None if unique.all() else history_of(rows, unique, model),
        energy,
        clock.seconds,
        clock.compilation,
    )


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


def _run(task: Task, run: FastRun) -> tuple[FastRun, int, ComputationError | None]:
    """Advance to the end, with progress and room for the record; how it ended, who stopped it."""
    plan, state, most = run.plan, run.state, task.max_steps
    alone = plan.oscillator.alone
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


def kernels_kept(task: Task) -> bool:
    """Whether a run of a task would compile none of the large kernels.

    Nothing is compiled to tell: types do not depend on numbers, so the scene stands here with
    linear springs in the place of hysteretic ones, for which no backbone is made, and a kernel
    that has run in this process serves every scene. So do those that follow a z.
    """
    if task.scene.branched_springs and not getattr(follow, "overloads", ()):
        return False
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
