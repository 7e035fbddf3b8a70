"""What a stepper records: extremes over its steps, rows between them, events, how they end.

Extremes are those of the ends of the steps, and a row of the history lies on the
straight line between the two steps around it: these methods know no more.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.model import Model
from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.event_bounds import Running, blank_extremes, update_extreme
from eventpound.solvers.events.event_rows import EVENT_WIDTH
from eventpound.solvers.events.recorder import row_width
from eventpound.solvers.timestepping.compiled import step_kernel
from eventpound.solvers.timestepping.equations import accept, copy_values, difference
from eventpound.solvers.timestepping.structure import ROWS, STEPS, State, Structure, Touch, Trial

DONE, NO_ROOM, NOT_CONVERGED, NOT_SOLVED = range(4)
"""All steps taken; too little room for the events of the next; Newton's iteration or the
complementarity problem of the next fails."""

MESSAGES = {
    DONE: "reached the end of the run in steps of at most {step:.6g} s",
    NOT_CONVERGED: "Newton's iteration of a step of {step:.6g} s does not converge; "
    "try a smaller time_step",
    NOT_SOLVED: "the complementarity problem of a step of {step:.6g} s is not solved; "
    "try a smaller time_step",
}


class Record(NamedTuple):
    """Room for a run: events (e, EVENT_WIDTH), output times (n,), rows and the last two steps.

    A row (w,) is that of `eventpound.solvers.events.recorder`; `running` are the extremes.
    """

    events: Floats
    times: Floats
    rows: Floats
    last: Floats
    running: Running


class Stepping(NamedTuple):
    """What the kernels of a method work on."""

    structure: Structure
    state: State
    trial: Trial
    touch: Touch
    record: Record


class Span(NamedTuple):
    """Steps of one length h (s), by their numbers from the start of the forcing.

    first: that of the first. last: that of the one not taken.
    """

    first: int
    last: int
    h: float


def blank_record(model: Model, times: Floats, rounding: Floats, room: int) -> Record:
    """Room for a run with so many events at first."""
    width = row_width(model)
    return Record(
        np.zeros((room, EVENT_WIDTH)),
        times,
        np.zeros((times.size, width)),
        np.zeros((2, width)),
        Running(*blank_extremes(rounding)),
    )


@step_kernel
def _shear(structure: Structure, state: State) -> float:
    """Sum of the forces of links on the ground (N)."""
    total = 0.0
    for link in range(structure.damping.size):
        first, second = structure.ends[link, 0], structure.ends[link, 1]
        if first >= 0 and second >= 0:
            continue
        force = state.link[link] + structure.damping[link] * difference(state.v, first, second)
        total += force if first < 0 else -force
    return total


@step_kernel
def _fill_row(structure: Structure, t: float, ground: float, state: State, row: Floats) -> None:
    """One line of the history from the present state."""
    bodies, contacts = structure.mass.size, structure.gap.size
    row[0], row[1] = t, ground
    place = 2
    for b in range(bodies):
        row[place + b] = state.u[b]
        row[place + bodies + b] = state.v[b]
        row[place + 2 * bodies + b] = state.f[b]
    for j in range(contacts):
        left, right = structure.left[j], structure.right[j]
        if left >= 0:
            row[place + 2 * bodies + left] -= state.contact[j]
        if right >= 0:
            row[place + 2 * bodies + right] += state.contact[j]
    for b in range(bodies):
        row[place + 2 * bodies + b] /= structure.mass[b]
    place += 3 * bodies
    for i in range(state.z.size):
        row[place + i] = state.z[i]
    place += state.z.size
    for i in range(structure.springs):
        row[place + i] = state.link[i]
    place += structure.springs
    for j in range(contacts):
        row[place + j] = structure.gap[j] + difference(
            state.u, structure.left[j], structure.right[j]
        )
        row[place + contacts + j] = state.contact[j]


@step_kernel
def _take_extremes(structure: Structure, t: float, state: State, record: Record) -> None:
    """Take the row of the present state into the extremes, in the order of `Running`."""
    row, running = record.last[1], record.running
    bodies, springs, contacts = structure.mass.size, structure.springs, structure.gap.size
    gaps = 2 + 3 * bodies + state.z.size + springs
    for b in range(bodies):
        update_extreme(b, row[2 + b], t, running)
    place = bodies
    for i in range(springs):
        x = difference(state.u, structure.ends[i, 0], structure.ends[i, 1])
        update_extreme(place + i, x, t, running)
    place += springs
    for j in range(contacts):
        update_extreme(place + j, row[gaps + j], t, running)
    place += contacts
    for b in range(bodies):
        update_extreme(place + b, row[2 + 2 * bodies + b], t, running)
    place += bodies
    update_extreme(place, _shear(structure, state), t, running)
    for j in range(contacts):
        update_extreme(place + 1 + j, row[gaps + contacts + j], t, running)


@step_kernel
def record_step(
    structure: Structure, t: float, ground: float, state: State, record: Record
) -> None:
    """Record the present state: its extremes, and the rows up to it.

    Parameters
    ----------
    structure : Structure
        The scene.
    t : float
        Time of the state (s).
    ground : float
        Ground acceleration there (m/s²).
    state : State
        The state.
    record : Record
        The record; `last[1]` is the state before, or anything at the start.
    """
    before, now = record.last[0], record.last[1]
    copy_values(now, before)
    _fill_row(structure, t, ground, state, now)
    _take_extremes(structure, t, state, record)
    i = state.counters[ROWS]
    while i < record.times.size and record.times[i] <= t:
        share = 1.0
        if t > before[0] and record.times[i] > before[0]:
            share = (record.times[i] - before[0]) / (t - before[0])
        for k in range(now.size):
            record.rows[i, k] = now[k] if share == 1.0 else before[k] + share * (now[k] - before[k])
        record.rows[i, 0] = record.times[i]
        i += 1
    state.counters[ROWS] = i


@step_kernel
def end_step(t: float, ground: float, run: Stepping) -> None:
    """Make the end of the step, at t (s), the present state, and record it."""
    accept(run.state, run.trial)
    run.state.counters[STEPS] += 1
    record_step(run.structure, t, ground, run.state, run.record)
