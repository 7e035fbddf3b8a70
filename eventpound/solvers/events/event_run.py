"""A run under way: its arrays, its present mode, and what it has recorded."""

from __future__ import annotations

import numpy as np

from eventpound.contact.cascade import last_speed
from eventpound.contact.event_rows import EVENT_WIDTH, events_of
from eventpound.contact.state import Instant, Now, begin
from eventpound.errors import ComputationError
from eventpound.mechanics.clusters import between_of, form_clusters_of_few
from eventpound.mechanics.contact_elements import NO_LAW
from eventpound.mechanics.contact_laws import contact_forces
from eventpound.mechanics.elements import branch_within
from eventpound.mechanics.link_law import KIND, SLIDER
from eventpound.mechanics.model import Model, assemble, with_elements, with_friction, with_sliders
from eventpound.mechanics.monitored import blank_extremes, places_in, running_of
from eventpound.mechanics.observables import Observed, blank_observed, initial_gaps
from eventpound.mechanics.reduced import Forcing, forcing_of
from eventpound.motion.base import Piece
from eventpound.motion.forcing import CurrentPiece, ground_acceleration
from eventpound.motion.loads import add_body_loads
from eventpound.numerics.arrays import Bools, Floats, Ints, longer
from eventpound.numerics.by_address import change_group, fields_of, with_address
from eventpound.numerics.compiled import in_python
from eventpound.scene.contact_law import Element
from eventpound.solvers.base import Event, History, LawRecording, Task, steps_used_up
from eventpound.solvers.events.event_bounds import Marks
from eventpound.solvers.events.law_contacts import law_recording, laws_of, with_unfinished
from eventpound.solvers.events.modes import Mode, ModeTable
from eventpound.solvers.events.recorder import PASSED, WRITTEN, Journal, history_of, row_width
from eventpound.solvers.events.run import Located, LoopProgress, Rules, Run, RunRecord, State
from eventpound.solvers.events.scales import SceneScales, scene_scales, tolerances
from eventpound.solvers.events.step_check import Examination, broken_contact, contact_error
from eventpound.tolerances import DRIFTED, FLAT_WITHIN, FORCE, GAP, LENGTH

SPARE_ROWS = 64
"""Lines of the history for which there is room at first beside those at output times, and
rows of events."""
Z_EXCESS = 10.0
"""Multiples of rtol by which |z| may exceed its bound at the end of a step."""


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
    gap, rate = initial_gaps(model, scales.length), model.rates(model.v0)
    struck = (model.elements.kind == NO_LAW) & (gap == 0.0) & (rate < 0.0)
    if not struck[: model.own_contacts].any():
        return np.empty((0, row_width(model)))
    # What friction a slider that does not slip has before it is jerked is not asked.
    slips = model.law.memory[model.hysteretic, KIND] == SLIDER
    z = np.where(slips, np.sign(model.elongations(model.v0)[model.hysteretic]), model.z0)
    elastic, total = model.link_forces(model.u0, model.v0, z)
    force = contact_forces(model.elements, gap, rate, np.zeros(gap.size))
    own_mass = model.mass[: model.bodies]
    elastic[model.plain :] = total[model.plain :] = -force[model.laws]
    return np.concatenate(
        (
            (task.start, ground_acceleration(_first_piece(task), task.start)),
            model.u0,
            model.v0,
            model.with_points(model.pulled(total) / own_mass + _loads(task, model)),
            z,
            elastic[: model.springs],
            gap,
            force,
        )
    )[np.newaxis]


def _loads(task: Task, model: Model) -> Floats:
    """What loads accelerate the bodies by as the run begins, and supports, shape (N,) (m/s²)."""
    force, driven = np.zeros((2, model.bodies))
    if model.loads:
        add_body_loads(_first_piece(task), task.start, force, driven)
    return np.asarray(force / model.mass[: model.bodies] + driven)


def _first_piece(task: Task) -> Forcing:
    """The piece of the ground motion in which the run begins."""
    piece = next(piece for piece in task.scene.motion.pieces() if piece.end > task.start)
    return forcing_of(piece, task.start)


class EventRun:
    """A run under way.

    Parameters
    ----------
    task : Task
        What to compute.

    Attributes
    ----------
    arrays : Run
        What compiled code works on, with an address.
    rules, state, record : Rules, State, RunRecord
        Parts of it.
    mode : Mode
        The present one; `enter_mode` brings it up to date.
    unique_forces : ndarray of bool, shape (K,)
        Contacts whose forces were unique whenever they rested.
    """

    def __init__(self, task: Task) -> None:
        self.task = task
        model = with_elements(with_sliders(assemble(task.scene)))
        model = self.model = with_friction(model)
        self.scales = scene_scales(task.scene, model, task.end - task.start)
        self.table = ModeTable(model, ledger=task.energy, force_noise=FORCE * self.scales.force)
        self.unique_forces = np.ones(model.contacts, np.bool_)
        self.rules = _rules_of(task, self.scales)
        self.state = _state_of(task, model, self.scales)
        self.record = _record_of(task, model, self.scales)
        self.arrays = _run_of(self.rules, self.state, self.record, model)
        # What lies between the ends of a step is looked at anew whenever it is asked for.
        self._observations = blank_observations(model, 2) + self.arrays.observations
        self._forcing: Forcing
        self._examinations: dict[int, Examination] = {}
        self.enter_mode()

    @property
    def t(self) -> float:
        """The present time (s)."""
        return float(self.state.now["t"][0])

    @property
    def names(self) -> list[str]:
        """Of the contacts, those of sliders and of friction included."""
        springs, contacts = self.task.scene.springs, self.task.scene.contacts
        return [
            *(contact.name for contact in contacts),
            *(springs[link].name for link in self.model.sliders),
            *(contacts[j].name for j in self.model.rubbing),
        ]

    @property
    def steps(self) -> int:
        """Steps so far."""
        return int(self.state.progress["steps"][0])

    def enter_mode(self) -> None:
        """Bring `mode` up to date with who rests and on which branches links are."""
        state = self.state
        opening = self.arrays.instant.opening
        mode = self.mode = self.table.mode(state.resting, state.branch, state.pressed, opening)
        state.now["stale"][0] = False
        self.table.place_ends(mode, state.u, state.z)
        self.take_closing_speeds(mode)
        if not mode.clusters.tree:
            self.unique_forces[mode.clusters.resting] &= mode.clusters.unique

    def check_held(self) -> None:
        """See that what the forces of others are to keep closed is closed.

        Raises
        ------
        ComputationError
            Where it has moved apart: on ground and on a support that do not move alike.
        """
        clusters, model, u = self.mode.clusters, self.model, self.state.u
        if clusters.tree:
            return
        strays = np.abs(model.rates(u) + self.arrays.instant.opening)[clusters.resting]
        strays[~clusters.redundant] = 0.0
        if strays.max() > DRIFTED * max(self.scales.length, np.abs(u).max()):
            name = self.names[clusters.resting[strays.argmax()]]
            raise ComputationError(
                f"{name!r} is held still while its ends move apart, by {strays.max():.3g} m by now",
                self.t,
            )

    def take_closing_speeds(self, mode: Mode) -> None:
        """What the damping of elements that depends on how they closed is in this mode."""
        if self.model.laws.size == 0:
            return
        plain, damping = self.model.plain, self.arrays.instant.law.damping
        closed = mode.branch[plain:] < 0
        mode.bodies.damping[plain:] = np.where(closed, damping[plain:], 0.0)
        for a in np.flatnonzero(mode.system.link >= plain):
            mode.system.damping[a] = mode.bodies.damping[mode.system.link[a]]

    def mark_located(self, closing: Bools, released: Bools, kinked: Bools) -> None:
        """What has been located at present; see `Located`."""
        located = self.arrays.located
        located.closing[:], located.released[:], located.kinked[:] = closing, released, kinked

    def make_room(self) -> None:
        """Make room for more lines and events, where it is half full."""
        record, journal = self.record, self.record.journal
        written, passed = int(journal.cursor[WRITTEN]), int(journal.cursor[PASSED])
        lines, events = written + journal.times.size - passed, int(self.state.now["events"][0])
        if 2 * lines > journal.rows.shape[0]:
            record = record._replace(journal=journal._replace(rows=longer(journal.rows, lines)))
        if 2 * events > record.events.shape[0]:
            record = record._replace(events=longer(record.events, events))
        self.record = with_address(record)
        instant = with_address(self.arrays.instant._replace(events=record.events))
        self.arrays = with_address(self.arrays._replace(record=self.record, instant=instant))
        self._examinations.clear()

    def events(self) -> list[Event]:
        """Everything listed so far, in order of time."""
        listed = events_of(self.record.events[: self.state.now["events"][0]])
        group = int(self.state.now["groups"][0])
        return with_unfinished(listed, self.model, self.arrays.laws, self.state.v, group)

    def law_recording(self) -> LawRecording | None:
        """What contacts with laws of their own did; None where there are none."""
        return law_recording(self.model, self.arrays.laws, self.t, self.record.extremes)

    def history(self) -> History:
        """Everything sampled so far, in order."""
        journal = self.record.journal
        rows = journal.rows[: journal.cursor[WRITTEN]]
        return history_of(rows, self.unique_forces, self.model)

    def piece(self, piece: Piece, stop: float) -> CurrentPiece:
        """Begin a piece of the ground motion up to `stop` (s), with an address."""
        family, coefficients = int(piece.family), np.ascontiguousarray(piece.coefficients)
        samples = np.ascontiguousarray(piece.samples)
        self._forcing = with_address(Forcing(family, coefficients, samples, self.t))
        self._examinations.clear()
        return with_address(CurrentPiece(family, coefficients, samples, stop))

    def forcing(self) -> Forcing:
        """The ground motion from the present instant on, at the same address in all of a piece."""
        change_group(self._forcing, self._forcing._replace(start=self.t))
        return self._forcing

    def examination(self, frame: Floats, *, finds_events: bool) -> Examination:
        """What steps of the present mode are examined with, the present instant as their start.

        It is made once in a piece. Where the integrator `finds_events` itself only extremes are
        looked for.
        """
        mode, size, arrays = self.mode, self.mode.system.size, self.arrays
        if id(mode) not in self._examinations:
            self._examinations[id(mode)] = with_address(
                Examination(
                    mode.unwatched if finds_events else mode.dynamics,
                    self._forcing,
                    frame,
                    self._observations,
                    np.zeros((2, size)),
                    np.zeros((2, size)),
                    self.record,
                    arrays.marks,
                    self.scales.z_bound,
                    Z_EXCESS * self.task.rtol,
                )
            )
        e = self._examinations[id(mode)]
        # The instant was made ready where it was settled.
        e.y[0], e.rate[0] = arrays.y[:size], arrays.rate[:size]
        both = e.observations[0], arrays.observations[0]
        for observed, values in zip(*map(fields_of, both), strict=True):
            observed[...] = values
        return e

    def report_time(self, t: float) -> None:
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

    def broken_contact(self, t: float) -> ComputationError:
        """What to raise where the last observation has a contact that penetrates or pulls."""
        observed, guards = self.arrays.observations[2], self.mode.guards
        j = in_python(broken_contact)(observed, guards, self.rules.length_noise)
        return contact_error(t, j, observed, guards, self.names)


def blank_observations(model: Model, count: int) -> tuple[Observed, ...]:
    """Empty observations of a scene, so many, with addresses."""
    return tuple(with_address(blank_observed(*model.counts)) for _ in range(count))


def _rules_of(task: Task, scales: SceneScales) -> Rules:
    """Constants of a run."""
    atol = tolerances(task, scales)
    return Rules(
        atol_u=np.asarray(atol["displacement"]),
        atol_v=np.asarray(atol["velocity"]),
        atol_z=np.asarray(atol["z"]),
        atol_energy=float(atol["energy"]),
        rtol=task.rtol,
        length=scales.length,
        time=scales.time,
        # Where a peak is flat to rounding: |u - peak| = a t²/2 with a = L/T².
        near=FLAT_WITHIN * scales.time,
        length_noise=GAP * scales.length,
    )


def _state_of(task: Task, model: Model, scales: SceneScales) -> State:
    """The state at the start."""
    gap = initial_gaps(model, scales.length)
    # These take no part in impacts and rests.
    gap[model.laws] = gap[model.own_contacts :] = np.inf
    branch = _first_branches(model, LENGTH * scales.length)
    now = np.zeros(1, Now.layout)
    begin(now, task.start, scales.time)
    return State(
        u=model.u0.copy(),
        v=model.v0.copy(),
        z=model.z0.copy(),
        gap=gap,
        gap_rate=model.rates(model.v0),
        resting=np.zeros(model.contacts, np.bool_),
        pressed=np.zeros(model.contacts, np.bool_),
        branch=branch,
        ledger=np.zeros(model.ledger_entries),
        now=now,
        progress=np.zeros(1, LoopProgress.layout),
    )


def _first_branches(model: Model, noise: float) -> Ints:
    """Branches that z or x' alone decides (L,), else 0; lengths (m) below `noise` are none."""
    branch, within = np.zeros(model.links, np.int64), in_python(branch_within)
    x, rate = model.elongations(model.u0), model.elongations(model.v0)
    memory, offset = model.law.memory, model.elastic.offset
    for a, z in zip(model.hysteretic.tolist(), model.z0.tolist(), strict=True):
        branch[a] = within(a, memory, offset[a], x[a], rate[a], z, noise)
    return branch


def _record_of(task: Task, model: Model, scales: SceneScales) -> RunRecord:
    """A record without extremes, with an address."""
    first = lines_before(task, model, scales)
    times = np.ascontiguousarray(task.output_times, np.float64)
    rows = np.empty((times.size + SPARE_ROWS, row_width(model)))
    rows[: first.shape[0]] = first
    cursor = np.zeros(2, np.int64)
    cursor[WRITTEN] = first.shape[0]
    at = places_in(model)
    extremes = blank_extremes(at, scales)
    return with_address(
        RunRecord(
            journal=Journal(times, rows, cursor, model.law.damping[: model.springs].copy()),
            events=np.empty((SPARE_ROWS + 8 * model.contacts, EVENT_WIDTH)),
            extremes=extremes,
            running=in_python(running_of)(extremes, at),
            saved_extremes=np.zeros_like(extremes),
            saved_cursor=np.zeros(2, np.int64),
        )
    )


def _instant_of(
    model: Model, rules: Rules, state: State, located: Located, events: Floats
) -> Instant:
    """What the rules of an instant work on."""
    law = model.law._replace(damping=model.law.damping.copy())
    # None has closed.
    unclosed = model.elements.kind[model.laws] == Element.HERTZ_DAMP
    law.damping[model.plain :][unclosed] = 0.0
    none = np.zeros(model.contacts, np.bool_)
    return Instant(
        mass=model.mass,
        weights=model.weights,
        compliance=form_clusters_of_few(between_of(model), none, none).compliance,
        ends=model.link_ends,
        law=law,
        compression=model.elastic.compression,
        extension=model.elastic.extension,
        offset=model.elastic.offset,
        hysteretic=model.hysteretic,
        left=model.left,
        right=model.right,
        opening=model.gap.copy(),
        restitution=model.restitution,
        length=rules.length,
        time=rules.time,
        last_speed=last_speed(
            rules.length / rules.time, model.sliders.size + model.rubbing.size > 0
        ),
        u=state.u,
        v=state.v,
        gap=state.gap,
        gap_rate=state.gap_rate,
        resting=state.resting,
        pressed=state.pressed,
        branch=state.branch,
        released=located.released,
        vanished=located.vanished,
        before=np.zeros_like(state.v),
        now=state.now,
        events=events,
    )


def _run_of(rules: Rules, state: State, record: RunRecord, model: Model) -> Run:
    """All of it with its scratch, with an address."""
    K, L = model.contacts, model.links
    size = 2 * model.coordinates + model.hysteretic.size + model.ledger_entries
    located = Located(*(np.zeros(n, np.bool_) for n in (K, K, K, L)))
    marks = Marks(*(np.zeros(n, np.bool_) for n in (K, K, L, record.extremes.shape[1])))
    y, rate, atol = np.zeros((3, size))
    return with_address(
        Run(
            rules=rules,
            state=state,
            instant=with_address(_instant_of(model, rules, state, located, record.events)),
            record=record,
            located=located,
            marks=with_address(marks),
            observations=blank_observations(model, 3),
            y=y,
            rate=rate,
            atol=atol,
            laws=laws_of(model),
        )
    )
