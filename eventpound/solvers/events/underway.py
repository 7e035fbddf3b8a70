"""A run under way: its arrays, its present mode, and what it has recorded."""

from __future__ import annotations

import numpy as np

from eventpound.errors import ComputationError
from eventpound.mechanics.clusters import unique_forces
from eventpound.mechanics.contact_elements import NO_LAW
from eventpound.mechanics.contact_laws import contact_forces
from eventpound.mechanics.descriptor import contact_rows
from eventpound.mechanics.model import Model, assemble, with_elements
from eventpound.mechanics.observables import Observed
from eventpound.mechanics.packing import observed_size, unpack_observed
from eventpound.mechanics.points import unique_forces_of
from eventpound.mechanics.reduced import Forcing, forcing_of
from eventpound.motion.base import Piece as MotionPiece
from eventpound.motion.forcing import ground_acceleration
from eventpound.motion.loads import add_body_loads
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import in_python
from eventpound.scene.contact_law import Element
from eventpound.solvers.base import (
    Event,
    Extremes,
    History,
    LawRecording,
    Task,
    steps_used_up,
)
from eventpound.solvers.events import noise
from eventpound.solvers.events.cascade import EVENTS, GROUPS, INTERVAL, RESTED_AT, T
from eventpound.solvers.events.event_bounds import blank_extremes
from eventpound.solvers.events.event_rows import EVENT_WIDTH, events_of
from eventpound.solvers.events.journal import PASSED, WRITTEN
from eventpound.solvers.events.law_contacts import law_recording, laws_of, with_unfinished
from eventpound.solvers.events.modes import Mode, ModeTable
from eventpound.solvers.events.recorder import (
    ROUNDING,
    extremes_of,
    extremes_rounding,
    history_of,
    row_width,
)
from eventpound.solvers.events.run import (
    POINTS,
    SIZES,
    STALE,
    STEPS,
    Piece,
    Rules,
    RunArrays,
    happened_in,
    layout_of,
    marks_in,
    numbers_in,
    record_in,
    rules_in,
    state_in,
)
from eventpound.solvers.events.scales import SceneScales, scene_scales, tolerances
from eventpound.solvers.events.step_check import broken_contact, contact_error

SPARE_ROWS = 64
"""Lines of the history for which there is room at first beside those at output times, and
rows of events."""
LENGTH_NOISE = 1e-15
"""Gaps and distances to a kink below this part of L have no meaningful sign."""


def lines_before(task: Task, model: Model, scales: SceneScales) -> Floats:
    """Lines of the history (`eventpound.solvers.events.recorder.history_of`) before the first.

    Parameters
    ----------
    task : Task
        The run.
    model : Model
        Its scene.
    scales : SceneScales
        What a gap of zero is.

    Returns
    -------
    ndarray, shape (0 or 1, row width)
        The state as the scene gives it where an impact changes it at once; elsewhere the line
        of the settled state says the same.
    """
    if not model.v0.any():
        return np.empty((0, row_width(model)))
    gap, rate = model.initial_gaps(scales.length), model.rates(model.v0)
    if not ((model.elements.kind == NO_LAW) & (gap == 0.0) & (rate < 0.0)).any():
        return np.empty((0, row_width(model)))
    z_of_link = np.zeros(model.links)
    z_of_link[model.hysteretic] = model.z0
    elastic = _elastic_forces(model) + model.law.strength * z_of_link
    total = elastic + model.law.damping * model.elongations(model.v0)
    force = contact_forces(model.elements, gap, rate, np.zeros(gap.size))
    elastic[model.plain :] = total[model.plain :] = -force[model.laws]
    line = np.concatenate(
        (
            (task.start, _ground(task)),
            model.u0,
            model.v0,
            (_pulled(model, total) + _loads(task, model)) / model.mass,
            model.z0,
            elastic[: model.springs],
            gap,
            force,
        )
    )
    return line.reshape(1, -1)


def _elastic_forces(model: Model) -> Floats:
    """``k x + f`` of every link, shape (L,) (N)."""
    below = np.array([law.compression for law in model.elastic], float)
    above = np.array([law.extension for law in model.elastic], float)
    x = model.elongations(model.u0) - np.array([law.offset for law in model.elastic], float)
    return np.where(x < 0.0, below, above) * x


def _pulled(model: Model, force: Floats) -> Floats:
    """Sum of the forces of the links on each body, shape (N,) (N)."""
    total = np.zeros(model.bodies + 1)
    np.add.at(total, model.link_ends[:, 0], force)
    np.add.at(total, model.link_ends[:, 1], -force)
    return total[:-1]


def _ground(task: Task) -> float:
    """Acceleration of the ground as the run begins (m/s²)."""
    return float(ground_acceleration(_first_piece(task), task.start))


def _loads(task: Task, model: Model) -> Floats:
    """Loads on the bodies as the run begins, shape (N,) (N)."""
    force = np.zeros(model.bodies)
    if model.loads:
        add_body_loads(_first_piece(task), task.start, force)
    return force


def _first_piece(task: Task) -> Forcing:
    """The piece of the ground motion in which the run begins."""
    piece = next(piece for piece in task.scene.motion.pieces() if piece.end > task.start)
    return forcing_of(piece, task.start)


class Underway:
    """A run under way.

    Parameters
    ----------
    task : Task
        What to compute.

    Attributes
    ----------
    run : RunArrays
        What compiled code works on.
    rules, state, record, marks : Rules, State, Record, ndarray
        Views of it.
    mode : Mode
        The present one; `enter_mode` brings it up to date.
    unique_forces : ndarray of bool, shape (K,)
        Contacts whose forces were unique whenever they rested.
    """

    def __init__(self, task: Task) -> None:
        self.task = task
        model = self.model = with_elements(assemble(task.scene))
        self.scales = scene_scales(task.scene, model, task.end - task.start)
        self.table = ModeTable(
            model, ledger=task.energy, force_noise=noise.FORCE * self.scales.force
        )
        self.unique_forces = np.ones(model.contacts, np.bool_)
        self._counts = model.bodies, model.links, model.contacts, model.hysteretic.size
        self._set(_blank_run(task, model, self.scales))
        self._fill()
        self.enter_mode()

    def _set(self, run: RunArrays) -> None:
        """Take a run and its views."""
        ints, floats, bools = run.ints, run.floats, run.bools
        self.run = run
        self.rules = in_python(rules_in)(ints, floats)
        self.state = in_python(state_in)(ints, floats, bools)
        self.record = in_python(record_in)(ints, floats, run.times, run.rows, run.events)
        self.marks = in_python(marks_in)(ints, bools)

    def _fill(self) -> None:
        """Constants, the state at the start, and a record without extremes."""
        task, model, scales, state = self.task, self.model, self.scales, self.state
        _fill_rules(self.rules, self.run, task, model, scales, self.table)
        state.u[:], state.v[:], state.z[:] = model.u0, model.v0, model.z0
        state.gap[:] = model.initial_gaps(scales.length)
        state.gap_rate[:] = model.rates(model.v0)
        # These take no part in impacts and rests, and none has closed.
        state.gap[model.laws] = np.inf
        state.count[POINTS] = model.points.size
        unclosed = self.run.laws.kind == Element.HERTZ_DAMP
        self.rules.law.damping[model.plain :][unclosed] = 0.0
        clock, record = state.clock, self.record
        clock[T], clock[INTERVAL], clock[RESTED_AT] = task.start, scales.time, -np.inf
        record.extremes[:] = blank_extremes(extremes_rounding(model, scales))
        record.journal.damping[:] = model.law.damping[: model.springs]
        first = lines_before(task, model, scales)
        record.journal.rows[: first.shape[0]] = first
        record.journal.cursor[WRITTEN] = first.shape[0]

    @property
    def t(self) -> float:
        """The present time (s)."""
        return float(self.state.clock[T])

    @property
    def steps(self) -> int:
        """Steps so far."""
        return int(self.state.count[STEPS])

    def enter_mode(self) -> None:
        """Bring `mode` up to date with who rests and on which branches links are."""
        state, model = self.state, self.model
        mode = self.mode = self.table.mode(state.resting, state.branch, state.pressed)
        state.count[STALE] = 0
        self.take_closing_speeds(mode)
        if not mode.clusters.tree:
            if model.points.size > 0:
                unique = unique_forces_of(contact_rows(model)[mode.clusters.resting])
            else:
                unique = unique_forces(mode.clusters, model.left, model.right)
            self.unique_forces[mode.clusters.resting] &= unique

    def take_closing_speeds(self, mode: Mode) -> None:
        """What the damping of elements that depends on how they closed is in this mode."""
        if self.model.laws.size == 0:
            return
        plain, damping = self.model.plain, self.rules.law.damping
        closed = mode.contacts[2, self.model.laws]
        mode.bodies.damping[plain:] = np.where(closed, damping[plain:], 0.0)
        for a in np.flatnonzero(mode.system.link >= plain):
            mode.system.damping[a] = mode.bodies.damping[mode.system.link[a]]

    def mark_happened(self, closing: Bools, released: Bools, kinked: Bools) -> None:
        """What happens at present; see `Happened`."""
        happened = in_python(happened_in)(self.run.ints, self.run.bools)
        happened.closing[:], happened.released[:], happened.kinked[:] = closing, released, kinked

    def make_room(self) -> None:
        """Double the room for lines and for events, where it is half full."""
        run, cursor = self.run, self.record.journal.cursor
        written, taken = int(cursor[WRITTEN]), int(self.state.count[EVENTS])
        if 2 * (written + run.times.size - cursor[PASSED]) > run.rows.shape[0]:
            run = run._replace(rows=_doubled(run.rows, written))
        if 2 * taken > run.events.shape[0]:
            run = run._replace(events=_doubled(run.events, taken))
        self._set(run)

    def events(self) -> list[Event]:
        """Everything listed so far, in order of time."""
        listed = events_of(self.run.events[: self.state.count[EVENTS]])
        group = int(self.state.count[GROUPS])
        return with_unfinished(listed, self.model, self.run.laws, self.state.v, group)

    def law_recording(self) -> LawRecording | None:
        """What contacts with laws of their own did; None where there are none."""
        return law_recording(self.model, self.run.laws, self.t, self.record.extremes)

    def history(self) -> History:
        """Everything sampled so far, in order."""
        return history_of(self.run.rows[: self.record.journal.cursor[WRITTEN]], self.model)

    def bounds(self, kind: str) -> Extremes:
        """Extremes of one kind of quantity, as `extremes_of` names them."""
        return extremes_of(kind, self.record.extremes, self.model)

    def piece(self, piece: MotionPiece, stop: float) -> Piece:
        """A piece of the ground motion up to `stop` (s), for compiled code."""
        return Piece(
            int(piece.family),
            np.ascontiguousarray(piece.coefficients),
            np.ascontiguousarray(piece.samples),
            stop,
        )

    def forcing(self, piece: Piece) -> Forcing:
        """The ground motion from the present instant on."""
        return Forcing(piece.family, piece.coefficients, piece.samples, self.t)

    def go_on(self, t: float) -> None:
        """Report the time reached (s).

        Raises
        ------
        ComputationError
            Where whoever watches the run or the limit of steps ends it there.
        """
        task = self.task
        if task.progress is not None:
            task.progress(t)
        if task.max_steps is not None and self.steps >= task.max_steps:
            raise steps_used_up(task.max_steps, t)

    def steps_left(self, most: int) -> int:
        """Steps up to `most` that the limit of the run allows."""
        limit = self.task.max_steps
        return most if limit is None else min(most, limit - self.steps)

    def look(self, row: int) -> Observed:
        """One of the run's looks."""
        return in_python(unpack_observed)(self.run.looks[row], *self._counts)

    def broken_contact(self, t: float) -> ComputationError:
        """What to raise where the last of the looks shows a contact that penetrates or pulls."""
        seen, watched = self.look(2), self.mode.watched
        j = in_python(broken_contact)(seen, watched, self.rules.length_noise)
        return contact_error(t, j, seen, watched, self.task.scene)


def _doubled(rows: Floats, taken: int) -> Floats:
    """An array of twice as many rows, with the first that are taken."""
    result = np.empty((2 * rows.shape[0], rows.shape[1]))
    result[:taken] = rows[:taken]
    return result


def _blank_run(task: Task, model: Model, scales: SceneScales) -> RunArrays:
    """Flat arrays for a scene, with its sizes at their head."""
    counts = model.bodies, model.links, model.contacts, model.hysteretic.size
    monitored = extremes_rounding(model, scales).size
    layout = layout_of(model, monitored)
    times = np.ascontiguousarray(task.output_times, np.float64)
    ints = np.zeros(layout.ints, np.int64)
    ints[:SIZES] = *counts, model.springs, monitored, model.ledger_entries
    size = 2 * model.bodies + model.hysteretic.size + model.ledger_entries
    return RunArrays(
        ints,
        np.zeros(layout.floats),
        np.zeros(layout.bools, np.bool_),
        times,
        np.empty((times.size + SPARE_ROWS, row_width(model))),
        np.empty((SPARE_ROWS + 8 * model.contacts, EVENT_WIDTH)),
        np.zeros((3, observed_size(*counts))),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        laws_of(model),
    )


def _fill_rules(
    rules: Rules, run: RunArrays, task: Task, model: Model, scales: SceneScales, table: ModeTable
) -> None:
    """Constants of a run into their places."""
    atol = tolerances(task, scales)
    for place, value in (
        (rules.mass, model.mass),
        (rules.link_ends, model.link_ends),
        *zip(rules.law, model.law, strict=True),
        (rules.hysteretic, model.hysteretic),
        (rules.compression, table.compression),
        (rules.extension, table.extension),
        (rules.offset, table.offset),
        (rules.left, model.left),
        (rules.right, model.right),
        (rules.gap, model.gap),
        (rules.restitution, model.restitution),
        (rules.atol_u, atol["displacement"]),
        (rules.atol_v, atol["velocity"]),
        (rules.atol_z, atol["z"]),
    ):
        place[...] = value
    numbers_in(run.ints, run.floats)[:] = (
        atol["energy"],
        task.rtol,
        scales.length,
        scales.time,
        # Where a peak is flat to rounding: |u - peak| = a t²/2 with a = L/T².
        10.0 * np.sqrt(ROUNDING) * scales.time,
        LENGTH_NOISE * scales.length,
        noise.FORCE * scales.force,
        noise.TOGETHER * scales.time,
    )
