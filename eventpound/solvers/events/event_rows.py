"""Rows of the events: impacts listed or held back, accumulations, changes of mode.

An impact too slow to be listed is held back until its contact comes to rest, whose one row
of an accumulation it becomes, or the cascade is over.
"""

from __future__ import annotations

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import scalar_kernel
from eventpound.solvers.base import Event, EventKind

EVENT_WIDTH = 9
"""Columns of an event: t, kind, group, contact, rates before and after, impulse, loss, count."""
IMPACT, ACCUMULATION, REST, DETACHMENT, SEPARATION, ERASED, UNLISTED, UNLISTED_LAST = (
    0, 1, 2, 3, 4, -1, -2, -3,
)  # fmt: skip
"""Kinds of an event row; an impact too slow to be listed may yet be counted. The last of a
cascade, after which there is no speed left, stands for all that would follow."""
_KINDS = {
    IMPACT: EventKind.IMPACT,
    ACCUMULATION: EventKind.ACCUMULATION,
    REST: EventKind.REST,
    DETACHMENT: EventKind.DETACHMENT,
    SEPARATION: EventKind.SEPARATION,
    # What was held back is listed where nothing gathered it.
    UNLISTED: EventKind.IMPACT,
    UNLISTED_LAST: EventKind.ACCUMULATION,
}


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
def put_event(
    row: Floats,
    t: float,
    kind: int,
    group: int,
    contact: int,
    rates: tuple[float, float],
    impulse: float,
    lost: float,
    impacts: int,
) -> None:
    """Fill a row; `rates` are those of the gap before and after (m/s)."""
    row[0], row[1], row[2], row[3] = t, kind, group, contact
    row[4], row[5], row[6], row[7], row[8] = rates[0], rates[1], impulse, lost, impacts


@scalar_kernel
def gather_unlisted(contact: int, count: int, events: Floats) -> int:
    """Make one accumulation of the unlisted impacts of a contact that rests.

    Parameters
    ----------
    contact : int
        The contact.
    count : int
        Rows so far.
    events : ndarray, shape (n, EVENT_WIDTH)
        The rows.

    Returns
    -------
    int
        Rows now.
    """
    impulse, lost, impacts, last = 0.0, 0.0, 0, -1
    for i in range(count):
        row = events[i]
        if row[1] <= UNLISTED and row[3] == contact:
            impulse += row[6]
            lost += row[7]
            impacts += 1
            last = i
            row[1] = ERASED
    if impacts == 0:
        return count
    row = events[last]
    t, group, rates = row[0], int(row[2]), (row[4], 0.0)
    put_event(events[count], t, ACCUMULATION, group, contact, rates, impulse, lost, impacts)
    return count + 1


@scalar_kernel
def list_all(count: int, events: Floats) -> None:
    """List the impacts that were held back: their cascade has ended otherwise."""
    for i in range(count):
        if events[i, 1] == UNLISTED:
            events[i, 1] = IMPACT
        elif events[i, 1] == UNLISTED_LAST:
            events[i, 1] = ACCUMULATION


def events_of(rows: Floats) -> list[Event]:
    """Event rows, shape (n, EVENT_WIDTH), as events in order of time."""
    rows = rows[rows[:, 1] != ERASED]
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    return [
        Event(t, _KINDS[int(kind)], int(group), int(j), before, after, impulse, lost, int(n))
        for t, kind, group, j, before, after, impulse, lost, n in rows.tolist()
    ]
