"""A recording from rows of a motion: for steppers that know rows and nothing else.

A stepper that advances u, v (and z) from one time to the next hands its rows over and
gets the `Recording` that a solver must return. Extremes are those of the rows, so they
are as good as the rows are dense; impacts, where the stepper does not list them, are read
off the rows (`eventpound.score.answer.turns`): a near miss that coarse rows do not show to be
one has a rate of the acceleration times a step there, and counts as a very slow impact. Contact
forces, impulses and resting times are not known (NaN).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields

import numpy as np

from eventpound.mechanics.model import Model, assemble
from eventpound.numerics.arrays import Bools, Floats
from eventpound.score.answer import turns
from eventpound.solvers.base import Event, EventKind, Extremes, History, Recording, Task, Work
from eventpound.tolerances import SAME_SAMPLE


def sampled_recording(
    task: Task,
    t: Floats,
    u: Floats,
    v: Floats,
    z: Floats | None = None,
    *,
    events: Sequence[Event] | None = None,
    work: Work | None = None,
) -> Recording:
    """What a solver returns, from the rows of a motion.

    Parameters
    ----------
    task : Task
        What was asked.
    t : ndarray, shape (n,)
        Times (s), not decreasing; two rows of one time are before and after a jump.
    u, v : ndarray, shape (n, N)
        Displacements (m) and velocities (m/s) relative to the ground; NaN throughout where
        a body's velocity is not known.
    z : ndarray, shape (n, H), optional
        Hysteretic variables in the order of the Bouc-Wen springs; not known without.
    events : sequence of Event, optional
        In order of time; impacts are read off the rows without.
    work : Work, optional
        What the run cost.
    """
    model = assemble(task.scene)
    t, u, v, z = rows = _rows(model, t, u, v, z)
    impacts = inferred_impacts(model, t, u, v) if events is None else tuple(events)
    full = _history(task, model, rows)
    elongation = model.elongations(u)[:, : model.springs]
    ends = float(t[-1]) >= task.end - SAME_SAMPLE * (task.end - task.start)
    unknown = np.full(model.contacts, np.nan)
    return Recording(
        success=ends,
        message="reached the end of the run" if ends else f"ended at t = {t[-1]:.6g} s",
        t=float(t[-1]),
        u=u[-1].copy(),
        v=v[-1].copy(),
        z=z[-1].copy(),
        history=_wanted(task.output_times, full, impacts),
        events=impacts,
        displacement=_extremes(t, u),
        elongation=_extremes(t, elongation),
        acceleration=_extremes(t, full.a),
        base_shear=_extremes(t, _base_shear(model, full)),
        smallest_gap=full.gap.min(axis=0, initial=np.inf),
        resting_time=unknown,
        max_force=unknown.copy(),
        unique_forces=np.ones(model.contacts, np.bool_),
        work=work or Work(steps=t.size - 1),
        largest_gap=full.gap.max(axis=0, initial=-np.inf),
    )


def inferred_impacts(model: Model, t: Floats, u: Floats, v: Floats) -> tuple[Event, ...]:
    """Impacts of a sampled motion, in order of time.

    Parameters
    ----------
    model : Model
        The scene.
    t : ndarray, shape (n,)
        Times (s), not decreasing; two rows of one time are before and after a jump.
    u, v : ndarray, shape (n, N)
        Displacements (m) and velocities (m/s).

    Returns
    -------
    tuple of Event
        Impulses and lost energies are not known (NaN); every impact is a group of its own.
    """
    gaps, rates = model.gaps(u), model.rates(v)
    length = float(np.abs(u).max(initial=0.0))
    found = [
        (time, j, before, after)
        for j in range(model.contacts)
        for time, before, after in turns(t, gaps[:, j], rates[:, j], length)
    ]
    return tuple(
        Event(time, EventKind.IMPACT, group, j, before, after, np.nan, np.nan)
        for group, (time, j, before, after) in enumerate(sorted(found))
    )


def _rows(
    model: Model, t: Floats, u: Floats, v: Floats, z: Floats | None
) -> tuple[Floats, Floats, Floats, Floats]:
    """The rows in the shapes everything expects; z that is not known is NaN."""
    t = np.asarray(t, dtype=np.float64)
    u, v = (np.asarray(x, dtype=np.float64).reshape(t.size, model.bodies) for x in (u, v))
    found = np.full((t.size, model.hysteretic.size), np.nan)
    if z is not None:
        given = np.asarray(z, dtype=np.float64).reshape(t.size, -1)
        found[:, : given.shape[1]] = given
    return t, u, v, found


def _history(task: Task, model: Model, rows: tuple[Floats, Floats, Floats, Floats]) -> History:
    """All rows with what follows from them."""
    t, u, v, z = rows
    springs, total = model.link_forces(u, v, z)
    return History(
        t,
        task.scene.motion.acceleration(t),
        u,
        v,
        # The forces of contacts are not known; while one rests they are missing here.
        model.pulled(total) / model.mass[: model.bodies],
        z,
        springs[:, : model.springs],
        model.gaps(u),
        np.full((t.size, model.contacts), np.nan),
    )


def _base_shear(model: Model, full: History) -> Floats:
    """Sum of the forces of springs and dashpots on the ground (N), shape (n, 1)."""
    shear: Floats = model.link_forces(full.u, full.v, full.z)[1] @ model.on_ground
    return shear[:, None]


def _extremes(t: Floats, values: Floats) -> Extremes:
    """Extremes of the columns of values, shape (n, k), over the rows."""
    if values.shape[1] == 0:
        return Extremes(*(np.empty(0) for _ in range(4)))
    columns = np.arange(values.shape[1])
    high, low = values.argmax(axis=0), values.argmin(axis=0)
    return Extremes(values[high, columns], t[high], values[low, columns], t[low])


def _wanted(times: Floats, full: History, impacts: Sequence[Event]) -> History:
    """Rows at the output times, linear between, and all rows beside a jump or an impact."""
    kept = _beside_jumps(full.t, impacts) | np.isin(full.t, times)
    between = np.setdiff1d(times[(times >= full.t[0]) & (times <= full.t[-1])], full.t[kept])
    order = np.argsort(np.concatenate((full.t[kept], between)), kind="stable")
    columns = []
    for values in (getattr(full, field.name) for field in fields(History)):
        inner = np.empty((between.size, *values.shape[1:]))
        for place in np.ndindex(values.shape[1:]):
            inner[:, *place] = np.interp(between, full.t, values[:, *place])
        columns.append(np.concatenate((values[kept], inner))[order])
    return History(*columns)


def _beside_jumps(t: Floats, impacts: Sequence[Event]) -> Bools:
    """Which rows share their time with another or are next to an impact."""
    kept = np.zeros(t.size, np.bool_)
    same = t[1:] == t[:-1]
    kept[1:] |= same
    kept[:-1] |= same
    following = np.searchsorted(t, [event.t for event in impacts], side="right")
    kept[np.clip(following, 0, t.size - 1)] = True
    kept[np.clip(following - 1, 0, t.size - 1)] = True
    return kept
