"""What a run leaves behind: samples, extremes, events, rests, and the ledger of its energy.

Lines of the history are written in the order of time, by compiled steps and by the event loop: one
at every output time, two at every event. The array has room for all output times that are left, so
that a compiled step never needs more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from eventpound.mechanics.contact_elements import NO_LAW
from eventpound.mechanics.contact_laws import stored
from eventpound.mechanics.model import WORK_OF_SUPPORTS, Model
from eventpound.mechanics.monitored import KINDS, Places, columns_of_kind, places_in
from eventpound.mechanics.observables import Observed
from eventpound.mechanics.pressures import press_locked
from eventpound.motion.base import GroundMotion
from eventpound.motion.delayed import travelled
from eventpound.motion.loaded import LoadedMotion
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import in_python, kernel, scalar_kernel
from eventpound.scene.elastic_laws import elastic_force
from eventpound.solvers.base import (
    ENDS_OF_REST,
    FRICTION_KINDS,
    Energy,
    Event,
    EventKind,
    Extremes,
    FrictionRecording,
    History,
    LawRecording,
    Recording,
    Stick,
)
from eventpound.solvers.events.scales import SceneScales

PASSED, WRITTEN = 0, 1
"""Places in `Journal.cursor`: output times passed, and lines written."""
_COLUMNS = 64
"""Of the history that are compared at once: more than there are without many bodies."""
# Members of an enumeration are slow to look up, and events can be thousands.
_REST = EventKind.REST


class Journal(NamedTuple):
    """Lines of the history and where the next ones go.

    times (n,): output times (s), increasing. rows (m, width): lines, of which the first are
    written. cursor (2,): `PASSED` and `WRITTEN`. damping (S,): of the springs (N s/m).
    """

    times: Floats
    rows: Floats
    cursor: Ints
    damping: Floats


@scalar_kernel
def is_due(t: float, journal: Journal) -> bool:
    """Whether an output time that is not passed lies before t (s)."""
    passed = journal.cursor[PASSED]
    return passed < journal.times.size and journal.times[passed] < t


class RowColumns(NamedTuple):
    """First column of each part of a line, in the order of `History`, and its width at last."""

    t: int
    ground: int
    u: int
    v: int
    a: int
    z: int
    force: int
    gap: int
    contact_force: int
    end: int


@scalar_kernel
def line_of(bodies: int, hysteretic: int, springs: int, contacts: int) -> RowColumns:
    """Columns of the lines of a scene: N coordinates, H of S springs hysteretic, K contacts."""
    v = 2 + bodies
    a = v + bodies
    z = a + bodies
    force = z + hysteretic
    gap = force + springs
    contact_force = gap + contacts
    return RowColumns(0, 1, 2, v, a, z, force, gap, contact_force, contact_force + contacts)


def _line_in(model: Model) -> RowColumns:
    return in_python(line_of)(
        model.coordinates, model.hysteretic.size, model.springs, model.contacts
    )


@scalar_kernel
def put_line(t: float, ground: float, parts: tuple[Floats, ...], row: Floats) -> None:
    """Fill a line of the history: `parts` are those from u on, in the order of `RowColumns`."""
    row[0], row[1], at = t, ground, 2
    for values in parts:
        for i in range(values.size):
            row[at + i] = values[i]
        at += values.size


@scalar_kernel
def write_row(t: float, observed: Observed, journal: Journal) -> None:
    """Add the line of one instant; a spring's force is without the dashpot beside it."""
    row, springs = journal.rows[journal.cursor[WRITTEN]], journal.damping.size
    journal.cursor[WRITTEN] += 1
    motion = observed.u, observed.v, observed.acceleration[0], observed.z[0]
    put_line(
        t,
        observed.ground[0],
        (*motion, observed.force[0][:springs], observed.gap[0], observed.contact_force[0]),
        row,
    )
    force = line_of(observed.u.size, observed.z.shape[1], springs, observed.gap.shape[1]).force
    for s in range(springs):
        row[force + s] -= journal.damping[s] * observed.elongation[1, s]


@kernel
def write_samples(
    show: Callable[[Any, float], Observed],
    of: Any,
    origin: float,
    start: float,
    end: float,
    journal: Journal,
) -> None:
    """History at the output times of a step from `start` to `end` (s, from `origin`).

    `show` observes the motion of the step at a time of it, and is handed `of`, too.
    """
    while is_due(origin + end, journal):
        t = journal.times[journal.cursor[PASSED]]
        if t >= origin + start:
            write_row(t, show(of, max(t - origin, start)), journal)
        journal.cursor[PASSED] += 1


def row_width(model: Model) -> int:
    """Numbers in a line of the history."""
    return _line_in(model).end


def columns_of(rows: Floats, model: Model) -> list[Floats]:
    """Parts of lines of the history, shape (n, `row_width`): views, in the order of `History`."""
    return [rows[:, low:high] for low, high in pairwise(_line_in(model))]


def _said_again(rows: Floats) -> Ints:
    """Numbers of lines that are those before them again; two stay of each later instant."""
    t = rows[:, 0].copy()
    again = np.flatnonzero(t[1:] == t[:-1]) + 1
    for first in range(0, rows.shape[1], _COLUMNS):
        # Of lines of an impact few are left behind the velocities: no copy of all the others.
        part = rows[:, first : first + _COLUMNS]
        again = again[(part[again] == part[again - 1]).all(axis=1)]
    start, end = (np.searchsorted(t, t[again], side) for side in ("left", "right"))
    spared = end - start - np.where(t[again] == t[:1], 1, 2)
    within = 1 + np.arange(again.size) - np.searchsorted(again, start)
    return again[within <= spared]


def history_of(rows: Floats, unique: Bools, model: Model) -> History:
    """Lines of the history, shape (n, `row_width`), as columns.

    An output time at which an event takes place has the two lines of the event only, the
    start of a run at which nothing happens has one. Forces of locked contacts become those that
    are told; `unique` (K,): contacts that are known not to be among them.
    """
    again = _said_again(rows)
    if (again == 1 + np.arange(again.size)).all():
        # What a run begins with, mostly one line: no copy of all the others for it.
        rows = rows[again.size :]
    else:
        rows = np.delete(rows, again, axis=0)
    t, ground, *others = columns_of(rows, model)
    history = History(t[:, 0], ground[:, 0], *others)
    if not unique[: model.own_contacts].all():
        # Those of sliders are no part of what is told.
        own = np.arange(unique.size) < model.own_contacts
        press_locked(history.gap, history.contact_force, unique | ~own, model)
    return history


def extremes_of(kind: str, table: Floats, at: Places) -> Extremes:
    """Extremes of one kind of monitored quantity from a table of `Running`, or many of them."""
    columns = columns_of_kind(kind, at)
    return Extremes(*(table[..., row, columns].copy() for row in range(4)))


def kept(table: Floats, events: Sequence[Event], end: float, model: Model) -> dict[str, Any]:
    """What a run up to `end` (s) is known by: fields of a `Recording`, by their names.

    Extremes of displacements, elongations, accelerations and base shear; of the contacts smallest
    and largest gaps, resting times and largest forces.
    """
    places = places_in(model)
    found = {kind: extremes_of(kind, table, places) for kind in KINDS}
    gap, force = found.pop("gap"), found.pop("contact_force")
    return {
        **found,
        "smallest_gap": gap.minimum,
        "largest_gap": gap.maximum,
        "resting_time": resting_times(events, model.contacts, end),
        "max_force": np.maximum(force.maximum, 0.0),
    }


def own_recording(recording: Recording, model: Model) -> Recording:
    """A recording of bodies alone, and of contacts without those that stand for sliders.

    What happened at these is `Recording.sticks`; every z is that at the end.
    """
    if model.weights.size > 0:
        recording = recording.of_bodies(np.s_[: model.bodies])
    if model.friction.any():
        recording = _with_slides(recording)
    if model.contacts == model.own_contacts:
        return recording
    own = model.own_contacts
    h, laws, z = recording.history, recording.laws, recording.z.copy()
    of_sliders, unique_z = model.z_of_link[model.sliders], np.ones(z.size, np.bool_)
    unique_z[of_sliders] = recording.unique_forces[own : own + model.sliders.size]
    if h.t.size > 0:
        z[of_sliders] = h.z[-1, of_sliders]
    if laws is not None:
        laws = LawRecording(laws.smallest_force[:own], laws.longest_contact[:own])
    assert recording.largest_gap is not None
    return replace(
        recording,
        z=z,
        history=replace(h, gap=h.gap[:, :own], contact_force=h.contact_force[:, :own]),
        events=tuple(event for event in recording.events if event.contact < own),
        sticks=tuple(
            Stick(event.t, int(model.sliders[event.contact - own]), event.kind is _REST)
            for event in recording.events
            if event.contact >= own and model.sliders.size > 0
        ),
        smallest_gap=recording.smallest_gap[:own],
        largest_gap=recording.largest_gap[:own],
        resting_time=recording.resting_time[:own],
        max_force=recording.max_force[:own],
        unique_forces=recording.unique_forces[:own],
        unique_z=unique_z if model.sliders.size > 0 else None,
        laws=laws,
    )


def _with_slides(recording: Recording) -> Recording:
    """A recording whose slips and sticks stand apart from what opens and closes."""
    others, slides, last = list[Event](), list[Event](), dict[int, EventKind]()
    for event in recording.events:
        if event.kind not in FRICTION_KINDS:
            others.append(event)
            # A new rest is told what it begins with.
            last.pop(event.contact, None)
        elif last.get(event.contact) is not event.kind:
            # Another event in the instant in which a slip begins tells it again.
            slides.append(event)
            last[event.contact] = event.kind
    return replace(recording, events=tuple(others), slides=tuple(slides))


def resting_times(events: Sequence[Event], contacts: int, end: float) -> Floats:
    """Time each contact rested up to `end` (s), from the events; shape (K,)."""
    total = np.zeros(contacts)
    since: dict[int, float] = {}
    for event in events:
        if event.kind is _REST:
            since[event.contact] = event.t
        elif event.kind in ENDS_OF_REST:
            total[event.contact] += event.t - since.pop(event.contact, event.t)
    for contact, start in since.items():
        total[contact] += end - start
    return total


def stored_energy(model: Model, u: Floats, v: Floats) -> tuple[float, float]:
    """Kinetic energy, and that of the springs' ``k x`` parts and contact elements (J).

    u, v: of shape (N,).
    """
    own, springs = slice(model.supports, None), model.elastic.first(model.plain)
    kinetic = 0.5 * float(model.mass[own] @ v[own] ** 2)
    x = model.elongations(u)[: model.plain]
    _, k = elastic_force(springs, x)
    elastic = 0.5 * float(k @ (x - springs.offset) ** 2)
    return kinetic, elastic + stored(model.elements, model.gaps(u))


def impact_terms(
    model: Model, motion: GroundMotion, events: Sequence[Event]
) -> tuple[float, Floats]:
    """Kinetic energy lost in impacts, and work of each support in them (J).

    An impulse Λ at a support moves it by nothing and gives ``Λ s'`` to what it strikes. Forces of
    contacts with a law of their own have done their work already.
    """
    lost = float(sum(event.energy_lost for event in events))
    given = np.zeros(model.supports)
    if not isinstance(motion, LoadedMotion):
        return lost, given
    opens = model.rates(np.eye(model.bodies))
    for event in events:
        if model.elements.kind[event.contact] != NO_LAW or event.impulse <= 0.0:
            continue
        for s in np.flatnonzero(opens[: model.supports, event.contact]):
            (_, v), (_, v_0) = (
                travelled(m, np.array(event.t)) for m in (motion.loads[s].signal, motion.ground)
            )
            given[s] -= opens[s, event.contact] * event.impulse * float(v - v_0)
    return lost, given


def energy_ledger(
    model: Model,
    scales: SceneScales,
    u: Floats,
    v: Floats,
    work: Floats,
    impact: float,
    struck: Floats | None = None,
    friction: float = 0.0,
) -> Energy:
    """The ledger at the state u, v.

    Parameters
    ----------
    model, scales
        The scene.
    u, v : ndarray, shape (N,)
        Displacement (m) and velocity (m/s).
    work : ndarray, shape (E,)
        Input, viscous and hysteretic work, that of supports and of frictions up to there (J).
    impact : float
        Kinetic energy lost in impacts, what elements still hold included (J).
    struck : ndarray, shape (number of supports,), optional
        Work of the supports in impacts up to there (J).
    friction : float
        What friction at contacts took between impacts beside that (J).
    """
    impact -= stored(model.elements, model.gaps(u))
    impact += stored(model.elements, model.gaps(model.u0))
    kinetic, elastic = stored_energy(model, u, v)
    put_in, viscous, hysteretic = (float(value) for value in work[:WORK_OF_SUPPORTS])
    first = work.size - model.rubbing.size
    supports = work[WORK_OF_SUPPORTS:first] + (0.0 if struck is None else struck)
    friction += float(work[first:].sum())
    initial = sum(stored_energy(model, model.u0, model.v0))
    rest = initial + put_in + float(supports.sum())
    rest -= kinetic + elastic + hysteretic + viscous + impact + friction
    terms = (initial, abs(put_in), kinetic, elastic, abs(hysteretic), viscous, impact, friction)
    closure = rest / max(*terms, *np.abs(supports).tolist(), scales.energy)
    return Energy(
        initial,
        put_in,
        kinetic,
        elastic,
        hysteretic,
        viscous,
        impact,
        closure,
        tuple(supports.tolist()),
        friction,
    )


def friction_of(
    model: Model, rubbed: Floats, u: Floats, branch: Ints, ledger: Floats | None
) -> FrictionRecording | None:
    """What friction at contacts did; None where there is none.

    Parameters
    ----------
    model : Model
        The scene.
    rubbed : ndarray, shape (5, F)
        What `eventpound.contact.rubbing` has kept.
    u, branch : ndarray, shapes (N,) and (L,)
        Displacements at the end (m), and which way links slip there.
    ledger : ndarray, shape (E,), optional
        Work up to there (J), without which that between impacts is not known.
    """
    rubbing = model.rubbing
    if rubbing.size == 0:
        return None
    path, work, *impulses, place = rubbed
    slid = np.abs(model.elongations(u)[model.slides] - place)
    path = path + np.where(branch[model.slides] != 0, slid, 0.0)
    work = work + (np.nan if ledger is None else ledger[ledger.size - rubbing.size :])
    table = np.zeros((4, model.own_contacts))
    table[:, rubbing] = path, work, *impulses
    return FrictionRecording(*table)
