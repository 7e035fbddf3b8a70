"""What a run leaves behind: samples, extremes, events, sums over the resting contacts."""

from __future__ import annotations

from itertools import accumulate, pairwise

import numpy as np

from eventpound.mechanics.model import Model
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.solvers.base import Event, EventKind, Extremes, History
from eventpound.solvers.events.scales import SceneScales

ROUNDING = 2e-13
"""Part of a scene's scales by which an extreme must be exceeded to be attained anew."""


def extremes_rounding(model: Model, scales: SceneScales) -> Floats:
    """By how much each monitored quantity must exceed its extreme to attain it anew."""
    bodies, springs, contacts = model.bodies, model.springs, model.contacts
    lengths = np.full(bodies + springs + contacts, scales.length)
    accelerations = np.full(bodies, scales.acceleration)
    forces = np.full(1 + contacts, scales.force)
    return ROUNDING * np.concatenate((lengths, accelerations, forces))


def _widths(model: Model) -> list[int]:
    bodies, contacts = model.bodies, model.contacts
    return [
        1,
        1,
        bodies,
        bodies,
        bodies,
        model.hysteretic.size,
        model.springs,
        contacts,
        contacts,
    ]


def row_width(model: Model) -> int:
    """Numbers in a line of the history."""
    return sum(_widths(model))


def _said_once(rows: Floats) -> Bools:
    """Lines that are not those before them again, shape (n,); two stay of each later instant."""
    t = rows[:, 0]
    later = np.flatnonzero(t[1:] == t[:-1]) + 1
    again = np.zeros(t.size, np.bool_)
    again[later] = (rows[later] == rows[later - 1]).all(axis=1)
    if not again.any():
        return ~again
    starts = np.flatnonzero(np.concatenate(([True], t[1:] != t[:-1])))
    lines = np.diff(np.append(starts, t.size))
    spared = lines - np.where(t[starts] == t[0], 1, 2)
    number = np.cumsum(again)
    within: Ints = number - np.repeat(number[starts] - again[starts], lines)
    return ~again | (within > np.repeat(spared, lines))


def history_of(rows: Floats, model: Model) -> History:
    """Lines of the history, shape (n, `row_width`), as columns.

    An output time at which an event takes place has the two lines of the event only, the
    start of a run at which nothing happens has one.
    """
    rows = rows[_said_once(rows)]
    ends = list(accumulate(_widths(model), initial=0))
    columns = [rows[:, low:high] for low, high in pairwise(ends)]
    return History(columns[0][:, 0], columns[1][:, 0], *columns[2:])


def extremes_of(kind: str, table: Floats, model: Model) -> Extremes:
    """Extremes of one kind of `Monitored` quantity from the table of `Running`."""
    bodies, springs, contacts = model.bodies, model.springs, model.contacts
    counts = (bodies, springs, contacts, bodies, 1, contacts)
    kinds = ("displacement", "elongation", "gap", "acceleration", "shear", "contact_force")
    place = kinds.index(kind)
    first = sum(counts[:place])
    return Extremes(*table[:4, first : first + counts[place]].copy())


def resting_times(events: list[Event], contacts: int, end: float) -> Floats:
    """Time each contact rested up to `end` (s), from the events; shape (K,)."""
    total = np.zeros(contacts)
    since: dict[int, float] = {}
    for event in events:
        if event.kind is EventKind.REST:
            since[event.contact] = event.t
        elif event.kind in (EventKind.DETACHMENT, EventKind.SEPARATION):
            total[event.contact] += event.t - since.pop(event.contact, event.t)
    for contact, start in since.items():
        total[contact] += end - start
    return total
