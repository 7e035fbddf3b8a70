"""Rows of the events: impacts listed or held back, accumulations, changes of mode.

An impact too slow to be listed is held back until its contact comes to rest, whose one row
of an accumulation it becomes, or the cascade is over. Shared by all event-driven solvers.
"""

from __future__ import annotations

from itertools import repeat
from typing import Any, NamedTuple

import numpy as np

from eventpound.contact.event import Event, EventKind
from eventpound.contact.modes import transition_code
from eventpound.contact.state import Now
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import scalar_kernel

IMPACT, ACCUMULATION, REST, DETACHMENT, SEPARATION, STICKS, SLIPS_FORWARD, SLIPS_BACKWARD = range(8)
ERASED, UNLISTED, UNLISTED_LAST = -1, -2, -3
"""Kinds of an event row; an impact too slow to be listed may yet be counted. The last of a
cascade, after which there is no speed left, stands for all that would follow."""
_KINDS = {
    IMPACT: EventKind.IMPACT,
    ACCUMULATION: EventKind.ACCUMULATION,
    REST: EventKind.REST,
    DETACHMENT: EventKind.DETACHMENT,
    SEPARATION: EventKind.SEPARATION,
    STICKS: EventKind.STICK,
    SLIPS_FORWARD: EventKind.SLIP_FORWARD,
    SLIPS_BACKWARD: EventKind.SLIP_BACKWARD,
    # What was held back is listed where nothing gathered it.
    UNLISTED: EventKind.IMPACT,
    UNLISTED_LAST: EventKind.ACCUMULATION,
}


class EventRow(NamedTuple):
    """A row of the events.

    t (s); kind; group: number of the problem; contact; rates of the gap before and after (m/s);
    impulse (N s); energy lost (J); how many impacts it stands for.
    """

    t: float
    kind: int
    group: int
    contact: int
    before: float
    after: float
    impulse: float
    lost: float
    impacts: int


EVENT_WIDTH = len(EventRow._fields)
"""Columns of the rows."""


@scalar_kernel
def events_wanted(contacts: int, now: Now) -> int:
    """Rows for which there is to be room before an instant: two problems and who rests."""
    return now.events + 4 * contacts + 4


@scalar_kernel
def new_group(now: Now) -> int:
    """Number of the next problem."""
    now.groups += 1
    return now.groups - 1


@scalar_kernel
def kind_of_slide(rate: float) -> int:
    """Kind of the row of a contact that slides at a rate (m/s), whose sign alone counts."""
    return STICKS if rate == 0.0 else SLIPS_FORWARD if rate > 0.0 else SLIPS_BACKWARD


@scalar_kernel
def kind_of_impact(listed: bool, plastic: bool, before: float, restitution: float) -> int:
    """Kind of the row of an impact, the last of a cascade where it is `plastic` against its law.

    before: rate of the gap (m/s). restitution: the contact's own.
    """
    last = plastic and before < 0.0 and restitution > 0.0
    if listed:
        return ACCUMULATION if last else IMPACT
    return UNLISTED_LAST if last else UNLISTED


@scalar_kernel
def write_event(row: EventRow, now: Now, events: Floats) -> None:
    """Add a row."""
    place = events[now.events]
    place[0], place[1], place[2], place[3] = row.t, row.kind, row.group, row.contact
    place[4], place[5], place[6] = row.before, row.after, row.impulse
    place[7], place[8] = row.lost, row.impacts
    now.events += 1


@scalar_kernel
def write_changes(before: Any, resting: Bools, gap_rate: Floats, now: Now, events: Floats) -> None:
    """Write down which contacts changed their mode, one problem.

    Parameters
    ----------
    before, resting : ndarray, shape (K,)
        Whether contacts rested before, and do so now.
    gap_rate : ndarray, shape (K,)
        Rates of the gaps (m/s).
    now, events : Now, ndarray
        Of the run.
    """
    group = -1
    for j in range(resting.size):
        code = transition_code(before[j] != 0, resting[j], gap_rate[j])
        if code == 0:
            continue
        if group < 0:
            group = new_group(now)
        if code == 1:
            now.rested_at = now.t
        write_change(code, j, group, gap_rate[j], now, events)


@scalar_kernel
def write_change(
    code: int, contact: int, group: int, rate: float, now: Now, events: Floats
) -> None:
    """Write down that a contact changed its mode, by a code of `transition_code`."""
    # The codes of a transition follow each other as these kinds do.
    kind = REST + code - 1
    if kind == REST:
        gather_unlisted(contact, now, events)
    write_event(EventRow(now.t, kind, group, contact, 0.0, rate, 0.0, 0.0, 1), now, events)


@scalar_kernel
def write_slide(t: float, kind: int, contact: int, group: int, now: Now, events: Floats) -> None:
    """Write down that a contact at rest begins to stick or to slip at t (s), by the kind of row."""
    write_event(EventRow(t, kind, group, contact, 0.0, 0.0, 0.0, 0.0, 0), now, events)


@scalar_kernel
def gather_unlisted(contact: int, now: Now, events: Floats) -> None:
    """Make one accumulation of the unlisted impacts of a contact that rests."""
    impulse, lost, impacts, last = 0.0, 0.0, 0, -1
    for i in range(now.listed, now.events):
        row = events[i]
        # Also the last of a cascade, whose kind is the smallest number.
        if row[1] <= UNLISTED and row[3] == contact:
            impulse += row[6]
            lost += row[7]
            impacts += 1
            last = i
            row[1] = ERASED
    if impacts > 0:
        row = events[last]
        t, group, rate = row[0], int(row[2]), row[4]
        whole = EventRow(t, ACCUMULATION, group, contact, rate, 0.0, impulse, lost, impacts)
        write_event(whole, now, events)


@scalar_kernel
def list_all(now: Now, events: Floats) -> None:
    """List the impacts that were held back: their cascade has ended otherwise."""
    now.in_a_row = 0
    for i in range(now.listed, now.events):
        if events[i, 1] == UNLISTED:
            events[i, 1] = IMPACT
        elif events[i, 1] == UNLISTED_LAST:
            events[i, 1] = ACCUMULATION
    now.listed = now.events


@scalar_kernel
def end_cascade(resting: Bools, now: Now, events: Floats) -> None:
    """List the impacts that were held back, or gather them where their contact rests."""
    for j in range(resting.size):
        if resting[j]:
            gather_unlisted(j, now, events)
    list_all(now, events)


def events_of(rows: Floats) -> list[Event]:
    """Event rows, shape (n, EVENT_WIDTH), as events in order of time."""
    rows = rows[rows[:, 1] != ERASED]
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    t, kind, group, contact, *measured, impacts = rows.T
    kinds = [_KINDS[each] for each in kind.astype(int).tolist()]
    # Column by column: thousands of short lists would keep the collector of garbage busy.
    groups, contacts, counts = (each.astype(int).tolist() for each in (group, contact, impacts))
    columns = [each.tolist() for each in measured]
    # `Event(...)` would take twice as long.
    lines = zip(t.tolist(), kinds, groups, contacts, *columns, counts, strict=True)
    return list(map(tuple.__new__, repeat(Event), lines))
