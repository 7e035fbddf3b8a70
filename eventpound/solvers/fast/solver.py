"""The fast solver: tasks in, recordings out; and whether it can run at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from threading import local
from typing import Any, NamedTuple

import numpy as np

from eventpound.contact.cascade import (
    LONGEST_CASCADE,
    crowded_message,
    endless_message,
    long_message,
)
from eventpound.contact.event_rows import EVENT_WIDTH, events_of, events_wanted
from eventpound.contact.friction import decide_friction
from eventpound.contact.impacts import ENDLESS, FULL, NO_FORCES
from eventpound.contact.instant import no_forces_message
from eventpound.contact.rubbing import FRICTION_MEANING, Rubs, friction_message
from eventpound.errors import ComputationError
from eventpound.mechanics.backbone import Hysteresis
from eventpound.mechanics.model import Model, assemble, shape_of, with_friction, with_sliders
from eventpound.mechanics.monitored import blank_extremes, places_in, running_of
from eventpound.mechanics.numbers import OF_CONTACTS, numbers_of, put_numbers, with_numbers
from eventpound.mechanics.supported import lowered
from eventpound.motion.parametric import Parametric
from eventpound.motion.record import Record
from eventpound.numerics.arrays import Bytes, Floats, longer
from eventpound.numerics.by_address import change_first, with_address
from eventpound.numerics.compiled import in_python
from eventpound.numerics.compiled.linked import Entry
from eventpound.numerics.compiling import Stopwatch
from eventpound.scene.body import Body
from eventpound.scene.contact import Contact
from eventpound.scene.contact_law import IMPACT_LAWS
from eventpound.scene.parameters import Place
from eventpound.scene.scene import Scene
from eventpound.scene.spring import LawName, Spring
from eventpound.solvers.base import Energy, History, Recording, Task, Work, steps_used_up
from eventpound.solvers.events.event_run import lines_before
from eventpound.solvers.events.recorder import (
    energy_ledger,
    friction_of,
    history_of,
    impact_terms,
    kept,
    own_recording,
    row_width,
)
from eventpound.solvers.events.scales import SceneScales, scale_units, scales_by, scene_scales
from eventpound.solvers.events.step_check import check_energy
from eventpound.solvers.fast.advance import advance
from eventpound.solvers.fast.constants import (
    begin_state,
    blank_located,
    blank_series,
    clear_scratch,
    links_of,
    plan_of,
    zero_state,
)
from eventpound.solvers.fast.evaluate import blank_fast_observed
from eventpound.solvers.fast.followed import follow
from eventpound.solvers.fast.links import all_variables
from eventpound.solvers.fast.record import rows_wanted
from eventpound.solvers.fast.reused import JoinedArrays, LatestParts
from eventpound.solvers.fast.run import (
    CROWDED,
    FINISHED,
    GOING_ON,
    MESSAGES,
    STUCK,
    FastPlan,
    FastRecord,
    FastRun,
    FastState,
)
from eventpound.solvers.fast.sdof.body import has_play, oscillator_of
from eventpound.solvers.fast.sdof.oscillator import oscillate_alone
from eventpound.solvers.supported import with_supports

BUDGET = 20_000
"""Steps between two reports of progress."""
FIRST_ROOM = 256
"""Events for which there is room at first."""
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
    takes_points = True
    takes_friction = True
    impact_laws = IMPACT_LAWS
    memories = frozenset(LawName)
    lists_springs = True

    def solve(self, task: Task) -> Recording:
        """Carry the scene from start to end; see `eventpound.solvers.base.Solver`."""
        return with_supports(task, lambda lowered: Ready(lowered).run({}, lowered)())

    def ready(self, task: Task) -> Ready | None:
        """The task, to be run with other numbers; see `eventpound.solvers.base.Solver`."""
        return None if task.scene.is_driven else Ready(task)


class Ready:
    """A task that is run with other numbers; see `eventpound.solvers.base.ReadyTask`.

    Parameters
    ----------
    task : Task
        The run of the scene as it is, which has no supports and forces any more, and is on a line.
    """

    def __init__(self, task: Task) -> None:
        self._scene, self._model = task.scene, with_friction(with_sliders(assemble(task.scene)))
        self._own = b"".join(numbers.tobytes() for numbers in numbers_of(self._model).values())
        self._shape = task.rtol, task.energy, *shape_of(self._model)

    def run(self, values: Mapping[Place, float], task: Task) -> Callable[[], Recording]:
        """Run it."""
        known = _last_of_thread.arrays
        # Who watches a run may begin another.
        arrays = known.pop(self._shape, None) or Arrays(self._model)
        arrays.numbers.data[:] = np.frombuffer(self._own, np.uint8)
        if values:
            columns = {place: np.array((value,)) for place, value in values.items()}
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
    numbers : JoinedArrays
        `eventpound.mechanics.numbers.numbers_of` of the next run.
    rows : dict of str to ndarray
        The same, each with a leading axis.
    """

    def __init__(self, model: Model) -> None:
        own = numbers_of(model)
        self.numbers = JoinedArrays(list(own.values()))
        named = dict(zip(own, self.numbers.arrays, strict=True))
        self.rows = {key: array[None] for key, array in named.items()}
        self._model, self._keep = with_numbers(model, named), LatestParts()
        of_contacts = sum(named[key].nbytes for key in OF_CONTACTS)
        # Those of contacts are the last.
        self._others = self.numbers.data[: self.numbers.data.size - of_contacts]
        self._moving = moving_of(model)
        self._run: FastRun | None = None

    def run(self, task: Task) -> FastOutcome:
        """Run a task of the present numbers, but for the motion, which is that of its scene."""
        clock, begun = Stopwatch(), self._begun(task)
        run, ended, stopped = _run(task, self._blank_run(begun))
        self._run = run if run.record.rows.nbytes <= MOST_KEPT else None
        left = self._left(task, begun.scales, run, ended, clock)
        if stopped is not None:
            stopped.recording = replace(left.recording(), message=str(stopped))
            raise stopped
        if ended != FINISHED:
            recording = left.recording()
            raise ComputationError(recording.message, recording.t, recording)
        if left.energy is not None:
            try:
                check_energy(float(run.state.now["t"][0]), left.energy, task.rtol)
            except ComputationError as error:
                error.recording = left.recording()
                raise
        return left

    def _begun(self, task: Task) -> _Begun:
        """What a run begins with, made anew where a number that it depends on is another."""
        model, motion = self._model, task.scene.motion
        length, time, shaken = scale_units(motion, model, task.end - task.start)

        def made() -> _Begun:
            scales = scales_by(length, time, shaken, model)
            plan = plan_of(task, model, scales, self._keep)
            put_start(plan, task.start, model, scales, self._moving)
            return _Begun(scales, plan, self._moving.data.copy())

        if not isinstance(motion, Parametric | Record):
            return made()
        # These two are equal where all their numbers are the same, which cannot change.
        own = motion, task.start, task.end, task.output_times.tobytes(), *task.atol.items()
        of = length, time, shaken, has_play(model.gap, length), self._others.tobytes(), *own
        return self._keep(("begun", *of), made)

    def _blank_run(self, begun: _Begun) -> FastRun:
        """A run with nothing recorded, with an address, in the arrays of the one before."""
        run, plan = self._run, begun.plan
        self._moving.data[:] = begun.moving
        if run is None or not np.array_equal(run.plan.ground.family, plan.ground.family):
            return with_address(run_of(plan, self._moving, self._model))
        if plan is not run.plan:
            change_first(run, plan)
        if not plan.oscillator.alone:
            in_python(clear_scratch)(run.series, run.located, run.observed)
        return run

    def _left(
        self, task: Task, scales: SceneScales, run: FastRun, ended: int, clock: Stopwatch
    ) -> FastOutcome:
        """What a run leaves, in arrays of its own."""
        state, record, model = run.state, run.record, self._model
        events = record.events[: state.now["events"][0]].copy()
        energy: Energy | None = None
        if task.energy:
            terms = impact_terms(model, task.scene.motion, events_of(events))
            energy = energy_ledger(model, scales, state.u, state.v, state.ledger, *terms)
        rows = record.rows[: state.progress["rows"][0]]
        # A long history is nobody's but this run's.
        rows = rows if self._run is None else rows.copy()
        # Elsewhere no impact can come at once.
        if any(model.v0.tolist()):
            rows = np.vstack((lines_before(task, model, scales), rows))
        unique = record.unique[: model.own_contacts].tolist()
        return FastOutcome(
            (
                *task.scene.contacts,
                *(task.scene.springs[a] for a in model.sliders),
                *(task.scene.contacts[j] for j in model.rubbing),
            ),
            model,
            ended,
            self._moving.copy(),
            run.plan.hysteresis,
            events,
            rows,
            None if all(unique) else history_of(rows, record.unique.copy(), model),
            energy,
            clock.seconds,
            clock.compilation,
        )


class _Begun(NamedTuple):
    """What runs of the same numbers begin with; moving: the data of `moving_of`."""

    scales: SceneScales
    plan: FastPlan
    moving: Bytes


def moving_of(model: Model) -> JoinedArrays:
    """Arrays of `FastState`, then extremes and uniqueness of forces of `FastRecord`."""
    extremes = np.zeros((5, places_in(model).end))
    state = zero_state(model.counts, model.ledger_entries, model.rubbing.size)
    return JoinedArrays([*state, extremes, np.zeros(model.contacts, np.bool_)])


def put_start(
    plan: FastPlan, start: float, model: Model, scales: SceneScales, moving: JoinedArrays
) -> None:
    """Put what moves at the start of a run (s)."""
    *state, extremes, unique = moving.arrays
    moving.data[:] = 0
    begin_state(plan, model.u0, model.v0, model.z0, start, FastState(*state))
    extremes[:], unique[:] = blank_extremes(places_in(model), scales), True


class FastOutcome(NamedTuple):
    """What a run has left, from which a recording is made when it is asked for.

    Behind the `contacts` of the scene are its sliders, or those with friction. Of `model` only the
    shape counts: its numbers may be those of a later run. So `history` is made at once where forces
    were not unique. `moving`: `moving_of`, as it was last. `events`, `rows`: of `FastRecord`.
    `seconds`, `compilation`: of `Work`.
    """

    contacts: tuple[Contact | Spring, ...]
    model: Model
    ended: int
    moving: JoinedArrays
    hysteresis: Hysteresis
    events: Floats
    rows: Floats
    history: History | None
    energy: Energy | None
    seconds: float
    compilation: float

    def recording(self) -> Recording:
        """The same as every solver returns it."""
        *moving, extremes, unique = self.moving.arrays
        state, events, z = (
            FastState(*moving),
            events_of(self.events),
            np.empty(self.hysteresis.link.size),
        )
        all_variables(self.model.elongations(state.u), self.hysteresis, state, z)
        now, progress = state.now, state.progress
        known = None if self.energy is None else state.ledger
        t = float(now["t"][0])
        names = [contact.name for contact in self.contacts]
        message = MESSAGES.get(self.ended, "left before its end")
        if self.ended == ENDLESS:
            message = endless_message(events, self.contacts)
        elif self.model.rubbing.size > 0 and self.ended in FRICTION_MEANING:
            rubs = Rubs(self.model.rubbing, self.model.friction, state.rubbed)
            gaps = state.gap, state.gap_rate, state.resting
            message = friction_message(self.ended, names, rubs, *gaps)
        elif self.ended == NO_FORCES:
            message = no_forces_message(state.resting, names, self.model.supports)
        elif self.ended == STUCK and now["in_a_row"][0] > LONGEST_CASCADE:
            message = long_message(events, self.contacts)
        elif self.ended == CROWDED:
            message = crowded_message(events, self.contacts)
        expansions, steps = int(progress["expansions"][0]), int(progress["steps"][0])
        recording = Recording(
            self.ended == FINISHED,
            message,
            t,
            state.u,
            state.v,
            z,
            self.history or history_of(self.rows, unique, self.model),
            tuple(events),
            unique_forces=unique,
            work=Work(expansions, 0, steps, int(now["groups"][0]), self.seconds, self.compilation),
            energy=self.energy,
            friction=friction_of(self.model, state.rubbed, state.u, state.branch, known),
            **kept(extremes, events, t, self.model),
        )
        return own_recording(recording, self.model)


def run_of(plan: FastPlan, moving: JoinedArrays, model: Model) -> FastRun:
    """A run with nothing recorded, in arrays of `moving_of`."""
    *state, extremes, unique = moving.arrays
    record = FastRecord(
        np.zeros((FIRST_ROOM + 4 * model.contacts, EVENT_WIDTH)),
        np.zeros((plan.output_times.size + 2 * FIRST_ROOM, row_width(model))),
        extremes,
        unique,
    )
    return FastRun(
        plan=plan,
        state=FastState(*state),
        series=blank_series(plan, model.loads > 0),
        located=blank_located(plan),
        record=record,
        observed=blank_fast_observed(plan),
        running=in_python(running_of)(extremes, places_in(model)),
    )


def _run(task: Task, run: FastRun) -> tuple[FastRun, int, ComputationError | None]:
    """Advance to the end, with progress and room for the record; how it ended, who stopped it."""
    plan, state, most = run.plan, run.state, task.max_steps
    carry = oscillate_alone if plan.oscillator.alone else advance
    while True:
        budget = BUDGET if most is None else min(BUDGET, most - int(state.progress["steps"][0]))
        ended = carry(budget, run)
        if ended == FULL:
            if state.now["events"][0] > MOST_EVENTS:
                return run, CROWDED, None
            run = with_address(run._replace(record=_enlarged(run.record, plan, state)))
        elif ended != GOING_ON:
            return run, ended, None
        try:
            if task.progress is not None:
                task.progress(float(state.now["t"][0]))
            if most is not None and state.progress["steps"][0] >= most:
                raise steps_used_up(most, float(state.now["t"][0]))
        except ComputationError as stopped:
            return run, ended, stopped


def _enlarged(record: FastRecord, plan: FastPlan, state: FastState) -> FastRecord:
    """The record with more room for what it has too little of."""
    rows, events = record.rows, record.events
    wanted = in_python(events_wanted)(plan.contacts.left.size, state.now[0])
    if wanted > events.shape[0]:
        events = longer(events, wanted)
    # A run before may have left room for much fewer output times.
    wanted = in_python(rows_wanted)(plan.output_times.size, state.progress[0])
    if wanted > rows.shape[0]:
        rows = longer(rows, wanted + 2 * FIRST_ROOM)
    return record._replace(events=events, rows=rows)


def kernels_kept(task: Task) -> bool:
    """Whether a run of a task would compile none of the large kernels.

    Nothing is compiled to tell. A kernel that has run in this process serves every scene, and so
    do those that follow a z, and those of friction; types are those of a run of any scene.
    """
    asked = ((task.scene.branched_springs, follow), (task.scene.rubbing, decide_friction))
    if any(needed and not getattr(part, "overloads", ()) for needed, part in asked):
        return False
    scene = lowered(task.scene, task.start)
    model = assemble(scene)
    length, _, _ = scale_units(scene.motion, model, task.end - task.start)
    one = oscillator_of(model, length, links_of(model), energy=task.energy)
    needed: Callable[..., Any] = oscillate_alone if one.alone else advance
    if not isinstance(needed, Entry):
        return False
    if needed.overloads:
        return True
    scene = Scene((Body("any", 1.0),))
    model = assemble(scene)
    plan = plan_of(replace(task, scene=scene), model, scene_scales(scene, model, 1.0))
    run = with_address(run_of(plan, moving_of(model), model))
    types = tuple(needed.typeof_pyval(each) for each in (BUDGET, run))
    return needed._cache.has(types, needed.targetctx)
