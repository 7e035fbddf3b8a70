"""What a run leaves behind: samples, extremes, events, sums over the resting contacts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eventpound.mechanics.model import Model
from eventpound.mechanics.observables import Observed
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import in_python
from eventpound.solvers.base import Event, EventKind, Extremes, History
from eventpound.solvers.events.inspection import (
    Found,
    Running,
    blank_extremes,
    update_extremes,
    update_settled,
    update_turning_point,
)
from eventpound.solvers.events.journal import PASSED, WRITTEN, Journal, is_due, write_row
from eventpound.solvers.events.location import Quantity, Step, turning_points
from eventpound.solvers.events.scales import SceneScales

ROUNDING = 2e-13
"""Part of a scene's scales by which an extreme must be exceeded to be attained anew."""


SPARE_ROWS = 64
"""Lines of the history that are made room for at once, beside those at output times."""


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
        times = np.ascontiguousarray(output_times, np.float64)
        rows = np.empty((first.shape[0] + times.size + SPARE_ROWS, row_width(model)))
        rows[: first.shape[0]] = first
        self.journal = Journal(
            times, rows, np.array([0, first.shape[0]]), model.law.damping[: model.springs].copy()
        )
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
        self._make_room()
        write_row(t, seen, self.journal)
        self.extremes(t, seen)

    def _make_room(self) -> None:
        """Room for a line more than those at the output times that are left."""
        journal = self.journal
        passed, written = journal.cursor
        if written + journal.times.size - passed < journal.rows.shape[0]:
            return
        rows = np.empty((2 * journal.rows.shape[0] + SPARE_ROWS, journal.rows.shape[1]))
        rows[:written] = journal.rows[:written]
        self.journal = journal._replace(rows=rows)

    def settled(self, t: float, seen: Observed) -> None:
        """Put the state after an event, its bodies on their constraints, into both."""
        update_settled(seen.u, seen.elongation[0], seen.gap[0], self.model.springs, t, self.running)
        self.instant(t, seen)

    def hold(self) -> None:
        """Remember history and extremes as they are, for `forget`."""
        self._held_rows = self.journal.cursor[WRITTEN]
        self._held_table[:] = self.table

    def forget(self) -> None:
        """Take back what has come into history and extremes since `hold`."""
        self.journal.cursor[WRITTEN] = self._held_rows
        self.table[:] = self._held_table

    def extremes(self, t: float, seen: Observed) -> None:
        """Take an instant into the extremes."""
        update_extremes(seen, self.model.springs, t, self.running)

    def samples(self, step: Step, origin: float, end: float) -> None:
        """Sample the history at the output times before ``origin + end`` (s)."""
        journal = self.journal
        while in_python(is_due)(origin + end, journal):
            t = float(journal.times[journal.cursor[PASSED]])
            if t >= origin + step.start:
                write_row(t, step.look(max(t - origin, step.start)), journal)
            journal.cursor[PASSED] += 1

    def due(self, t: float) -> bool:
        """Whether an output time lies before t (s)."""
        return in_python(is_due)(t, self.journal)

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
        return history_of(self.journal.rows[: self.journal.cursor[WRITTEN]], self.model)

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
    columns = np.split(rows, np.cumsum(_widths(model))[:-1], axis=1)
    return History(columns[0][:, 0], columns[1][:, 0], *columns[2:])


def extremes_of(kind: str, table: Floats, model: Model) -> Extremes:
    """Extremes of one kind of `Monitored` quantity from the table of `Running`."""
    bodies, springs, contacts = model.bodies, model.springs, model.contacts
    starts = np.cumsum([0, bodies, springs, contacts, bodies, 1, contacts])
    kinds = ("displacement", "elongation", "gap", "acceleration", "shear", "contact_force")
    place = kinds.index(kind)
    part = slice(starts[place], starts[place + 1])
    return Extremes(*(row[part].copy() for row in table[:4]))


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
