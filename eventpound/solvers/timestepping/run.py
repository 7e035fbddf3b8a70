"""The loop that all fixed-step methods share: segments, chunks, the record."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from eventpound.contact.event_rows import events_of
from eventpound.errors import ComputationError
from eventpound.mechanics.contact_elements import NO_LAW
from eventpound.mechanics.model import Model, assemble
from eventpound.mechanics.reduced import Forcing, forcing_of
from eventpound.motion.base import Family
from eventpound.motion.loads import add_body_loads
from eventpound.numerics.compiling import Stopwatch
from eventpound.solvers.base import Energy, Recording, Task, Work, steps_used_up
from eventpound.solvers.events.law_contacts import law_recording, laws_of, with_unfinished
from eventpound.solvers.events.recorder import energy_ledger, history_of, kept, own_recording
from eventpound.solvers.events.run import Laws
from eventpound.solvers.events.scales import SceneScales, scene_scales
from eventpound.solvers.timestepping.equations import end_of_step
from eventpound.solvers.timestepping.stepping import (
    CONTACT,
    DONE,
    FRICTION,
    MESSAGES,
    NO_ROOM,
    Span,
    Stepping,
    blank_equations,
    blank_record,
    initial_instant,
    record_step,
    structure_of,
)
from eventpound.solvers.timestepping.steps import EqualSteps, segments
from eventpound.tolerances import SAME_SAMPLE

CHUNK = 20_000
"""Steps between two reports of progress."""
ROOM = 256
"""Events for which there is room at first."""


@dataclass
class FixedStepRun:
    """Everything a stepper works on during one run.

    Parameters
    ----------
    task, model, scales
        What to compute.
    work : Stepping
        The arrays of the kernels; the record is replaced by a larger one when full.
    laws : Laws
        Contacts that are elements, under Newton's law too; none where a method has none.
    t : float
        Time reached (s).
    clock : Stopwatch
        Running since the run began.
    """

    task: Task
    model: Model
    scales: SceneScales
    work: Stepping
    laws: Laws
    t: float
    clock: Stopwatch


Advance = Callable[[Span, Forcing, Any, Stepping], tuple[int, int]]
"""Takes the steps of a span, with what a method knows of contacts.

Returns the number of the step before which it stopped, and one of
`eventpound.solvers.timestepping.stepping`.
"""


def prepared(task: Task, theta: float) -> FixedStepRun:
    """A run before its first step, by a rule with θ."""
    clock, model = Stopwatch(), assemble(task.scene)
    scales = scene_scales(task.scene, model, task.end - task.start)
    structure = structure_of(model, scales, theta)
    record = blank_record(model, task.output_times, scales, ROOM + 4 * model.contacts)
    equations = blank_equations(model, structure.bandwidth)
    state, trial = initial_instant(model), initial_instant(model)
    work = Stepping(structure, state, trial, equations, record)
    return FixedStepRun(task, model, scales, work, laws_of(model), task.start, clock)


def carry_to_end(
    run: FixedStepRun,
    time_step: float,
    advance: Advance,
    contacts: Any,
    taking_part: Callable[[], str] = str,
) -> Recording:
    """Take all steps.

    Parameters
    ----------
    run : FixedStepRun
        At its start.
    time_step : float
        Length that no step exceeds (s).
    advance : callable
        The method.
    contacts
        What it knows of contacts.
    taking_part : callable
        Says which contacts take part in a step that fails.

    Raises
    ------
    ComputationError
        Where a step fails; what was computed is in its `recording`.
    """
    task, progress = run.task, run.work.record.progress[0]
    _take_start(run)
    for segment in segments(task.scene.motion.pieces(), task.start, task.end, time_step):
        try:
            outcome = _carry_over(run, segment, advance, contacts)
        except ComputationError as stopped:  # by whoever watches the run, or the limit of steps
            stopped.recording = recording_of(run, str(stopped), success=False)
            raise
        if outcome != DONE:
            message = MESSAGES[outcome].format(step=segment.step, contacts=taking_part())
            raise ComputationError(message, run.t, recording_of(run, message, success=False))
    run.t = task.end
    # The last output time may lie a rounding error after the last step.
    record, last = run.work.record, run.t + SAME_SAMPLE * (task.end - task.start)
    while progress.rows < record.times.size and record.times[progress.rows] <= last:
        record.rows[progress.rows] = record.last[1]
        progress.rows += 1
    message = MESSAGES[DONE].format(step=time_step)
    return recording_of(run, message, success=True)


def _take_start(run: FixedStepRun) -> None:
    """Forces of the initial state, and its place in the record."""
    state, trial = run.work.state, run.work.trial
    start, load = run.task.start, run.work.equations.load
    piece = next(each for each in run.task.scene.motion.pieces() if each.end > start)
    if piece.family is Family.LOADED:
        add_body_loads(forcing_of(piece, start), start, load[1], load[0])
    end_of_step(0.0, run.work)
    state.f[:], state.link[:] = trial.f, trial.link
    ground = float(run.task.scene.motion.acceleration(np.array([start]))[0])
    record_step(start, ground, run.work)


def _carry_over(run: FixedStepRun, segment: EqualSteps, advance: Advance, contacts: Any) -> int:
    """The steps of one segment; an outcome."""
    forcing, done, most = forcing_of(segment.piece, segment.start), 0, run.task.max_steps
    while done < segment.steps:
        chunk = CHUNK
        if most is not None:
            chunk = min(chunk, most - int(run.work.record.progress[0].steps))
            if chunk <= 0:
                raise steps_used_up(most, run.t)
        target = min(done + chunk, segment.steps)
        done, outcome = advance(Span(done, target, segment.step), forcing, contacts, run.work)
        run.t = segment.start + done * segment.step
        if outcome == NO_ROOM:
            record, events = run.work.record, run.work.record.events
            larger = record._replace(events=np.concatenate((events, np.zeros_like(events))))
            run.work = run.work._replace(record=larger)
        elif outcome != DONE:
            return outcome
        if run.task.progress is not None:
            run.task.progress(run.t)
    return DONE


def recording_of(run: FixedStepRun, message: str, *, success: bool) -> Recording:
    """What a run leaves, as every solver returns it."""
    model, state, record = run.model, run.work.state, run.work.record
    now, progress = record.now[0], record.progress[0]
    own = np.flatnonzero(model.elements.kind != NO_LAW)
    contact, kind, damping, touch = run.laws
    laws = Laws(contact[own], kind[own], damping[own], touch[:, own])
    events = events_of(record.events[: now.events])
    events = with_unfinished(events, model, laws, state.v, int(now.groups))
    table, unique = np.stack(record.running[:5]), np.ones(model.contacts, np.bool_)
    recording = Recording(
        success,
        message,
        run.t,
        state.u.copy(),
        state.v.copy(),
        state.z.copy(),
        history_of(record.rows[: progress.rows], unique, model),
        tuple(events),
        unique_forces=unique,
        work=Work(
            rhs=int(progress.evaluations),
            steps=int(progress.steps),
            seconds=run.clock.seconds,
            compilation=run.clock.compilation,
        ),
        energy=_energy(run),
        laws=law_recording(model, laws, run.t, table),
        **kept(table, events, run.t, model),
    )
    return own_recording(recording, model)


def _energy(run: FixedStepRun) -> Energy | None:
    """The ledger, where it is kept; it closes as well as the method keeps energy."""
    if not run.task.energy:
        return None
    state, work = run.work.state, run.work.record.work
    lost, by_friction = float(work[CONTACT]), float(work[FRICTION])
    found = run.model, run.scales, state.u, state.v, work[:CONTACT], lost
    return energy_ledger(*found, friction=by_friction)
