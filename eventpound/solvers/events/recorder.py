"""What a run leaves behind: samples, extremes, events, sums over the resting contacts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import accumulate, pairwise

import numpy as np

from eventpound.mechanics.model import Model
from eventpound.mechanics.observables import Observed
from eventpound.numerics.arrays import Bools, Floats
from eventpound.solvers.base import Event, EventKind, Extremes, History
from eventpound.solvers.events.inspection import (
    Found,
    Running,
    blank_extremes,
    update_extremes,
    update_settled,
    update_turning_point,
)
from eventpound.solvers.events.location import Quantity, Step, turning_points
from eventpound.solvers.events.scales import SceneScales

ROUNDING = 2e-13
"""Part of a scene's scales by which an extreme must be exceeded to be attained anew."""


def _row(t: float, seen: Observed, model: Model) -> Floats:
    """One line of the history; a spring's force is without the dashpot beside it."""
    springs = model.springs
    viscous = model.law.damping[:springs] * seen.elongation[1, :springs]
    return np.concatenate(
        (
            (t, seen.ground[0]),
            seen.u,
            seen.v,
            seen.acceleration[0],
            seen.z[0],
            seen.force[0, :springs] - viscous,
            seen.gap[0],
            seen.contact_force[0],
        )
    )


@dataclass(frozen=True)
class Monitored:
    """A quantity whose extremes are recorded: its value and rate."""

    kind: str
    index: int

    def __call__(self, seen: Observed) -> tuple[float, float]:
        """Value and rate."""
        i = self.index
        match self.kind:
            case "displacement":
                return seen.u[i], seen.v[i]
            case "shear":
                return seen.shear[0], seen.shear[1]
            case _:
                pair = getattr(seen, self.kind)
                return pair[0, i], pair[1, i]


class Recorder:
    """Collects the record of a run as it goes.

    Parameters
    ----------
    model : Model
        The scene.
    output_times : ndarray
        Times of the history (s), increasing.
    scales : SceneScales
        From which the rounding of the extremes follows.
    first : ndarray, shape (n, `row_width`)
        Lines with which the history begins.
    """

    def __init__(
        self, model: Model, output_times: Floats, scales: SceneScales, first: Floats
    ) -> None:
        self.model = model
        self.output_times = output_times
        self._next_output = 0
        self._rows: list[Floats] = list(first)
        self._held_rows = 0
        self.events: list[Event] = []
        self.groups = 0
        bodies, springs, contacts = model.bodies, model.springs, model.contacts
        # Where a peak is flat to rounding: |u - peak| = a t²/2 with a = L/T².
        self._near = 10.0 * np.sqrt(ROUNDING) * scales.time
        self.table = blank_extremes(extremes_rounding(model, scales))
        self._held_table = self.table.copy()
        self.running = Running(*self.table)
        self.unique_forces = np.ones(contacts, np.bool_)
        self.quantities: list[Quantity] = [
            Monitored(kind, i)
            for kind, count in (
                ("displacement", bodies),
                ("elongation", springs),
                ("gap", contacts),
                ("acceleration", bodies),
                ("shear", 1),
                ("contact_force", contacts),
            )
            for i in range(count)
        ]

    def instant(self, t: float, seen: Observed) -> None:
        """Put one side of an event into the history and the extremes."""
        self._rows.append(_row(t, seen, self.model))
        self.extremes(t, seen)

    def settled(self, t: float, seen: Observed) -> None:
        """Put the state after an event, its bodies on their constraints, into both."""
        update_settled(seen.u, seen.elongation[0], seen.gap[0], self.model.springs, t, self.running)
        self.instant(t, seen)

    def hold(self) -> None:
        """Remember history and extremes as they are, for `forget`."""
        self._held_rows = len(self._rows)
        self._held_table[:] = self.table

    def forget(self) -> None:
        """Take back what has come into history and extremes since `hold`."""
        del self._rows[self._held_rows :]
        self.table[:] = self._held_table

    def extremes(self, t: float, seen: Observed) -> None:
        """Take an instant into the extremes."""
        update_extremes(seen, self.model.springs, t, self.running)

    def samples(self, step: Step, origin: float, end: float) -> None:
        """Sample the history at the output times before ``origin + end`` (s)."""
        times = self.output_times
        while self._next_output < times.size and times[self._next_output] < origin + end:
            t = float(times[self._next_output])
            if t >= origin + step.start:
                self._rows.append(_row(t, step.look(max(t - origin, step.start)), self.model))
            self._next_output += 1

    def due(self, t: float) -> bool:
        """Whether an output time lies before t (s)."""
        return self.next_due < t

    @property
    def next_due(self) -> float:
        """The next output time (s), inf after the last."""
        i = self._next_output
        return float(self.output_times[i]) if i < self.output_times.size else math.inf

    def peaks(self, step: Step, origin: float, end: float, found: Found) -> None:
        """Locate the extremes that an inspection marked, up to `end` (s) of the step."""
        marked = np.flatnonzero(found.peak)
        if marked.size == 0:
            return
        quantities = [self.quantities[i] for i in marked]
        for i, times in zip(marked, turning_points(step, quantities, end), strict=True):
            for tau in times:
                value = self.quantities[i](step.look(tau))[0]
                update_turning_point(int(i), value, origin + tau, self._near, self.running)

    def event(self, event: Event) -> None:
        """Add one row to the events."""
        self.events.append(event)

    def new_group(self) -> int:
        """Number of the next problem."""
        self.groups += 1
        return self.groups - 1

    def history(self) -> History:
        """Everything sampled so far, in order."""
        return history_of(np.array(self._rows).reshape(-1, row_width(self.model)), self.model)

    def bounds(self, kind: str) -> Extremes:
        """Extremes of one kind of `Monitored` quantity."""
        return extremes_of(kind, self.table, self.model)


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
    kept = np.ones(t.size, np.bool_)
    later = np.flatnonzero(t[1:] == t[:-1]) + 1
    for i in later[(rows[later] == rows[later - 1]).all(axis=1)]:
        least = 1 if t[i] == t[0] else 2
        if kept[slice(*np.searchsorted(t, (t[i], np.nextafter(t[i], np.inf))))].sum() > least:
            kept[i] = False
    return kept


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
