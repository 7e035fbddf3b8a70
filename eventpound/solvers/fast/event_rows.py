"""Rows of the events: impacts listed or held back, accumulations, changes of mode."""

from __future__ import annotations

from eventpound.numerics.arrays import Floats, Ints
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.plan import EVENTS, State

IMPACT, ACCUMULATION, REST, DETACHMENT, SEPARATION, ERASED, UNLISTED, UNLISTED_LAST = (
    0, 1, 2, 3, 4, -1, -2, -3,
)  # fmt: skip
"""Kinds of an event row; an impact too slow to be listed may yet be counted. The last of a
cascade, after which there is no speed left, stands for all that would follow."""
LISTED_AS = {UNLISTED: IMPACT, UNLISTED_LAST: ACCUMULATION}
"""What those that were held back are where nothing gathers them."""


@compiled
def kind_of_impact(listed: bool, plastic: bool, before: float, restitution: float) -> int:
    """Kind of the row of an impact, the last of a cascade where it is `plastic` against its law.

    before: rate of the gap (m/s). restitution: the contact's own.
    """
    last = plastic and before < 0.0 and restitution > 0.0
    if listed:
        return ACCUMULATION if last else IMPACT
    return UNLISTED_LAST if last else UNLISTED


@compiled_apart
def write_event(
    t: float,
    count: Ints,
    events: Floats,
    kind: int,
    group: int,
    contact: int,
    before: float,
    after: float,
    impulse: float,
    lost: float,
    impacts: int,
) -> None:
    """Add a row to the events."""
    row = events[count[EVENTS]]
    row[0], row[1], row[2], row[3] = t, kind, group, contact
    row[4], row[5], row[6], row[7], row[8] = before, after, impulse, lost, impacts
    count[EVENTS] += 1


@compiled_apart
def write_change(
    code: int, contact: int, group: int, rate: float, t: float, count: Ints, events: Floats
) -> None:
    """Write down that a contact changed its mode, by a code of `transition_code`."""
    kind = REST + code - 1
    if kind == REST:
        gather_unlisted(contact, count, events)
    write_event(t, count, events, kind, group, contact, 0.0, rate, 0.0, 0.0, 1)


@compiled_apart
def gather_unlisted(contact: int, count: Ints, events: Floats) -> None:
    """Make one accumulation of the unlisted impacts of a contact that rests."""
    impulse, lost, impacts, last = 0.0, 0.0, 0, -1
    for i in range(count[EVENTS]):
        row = events[i]
        if row[1] <= UNLISTED and row[3] == contact:
            impulse += row[6]
            lost += row[7]
            impacts += 1
            last = i
            row[1] = ERASED
    if impacts > 0:
        row = events[last]
        t, group, rate = row[0], int(row[2]), row[4]
        write_event(
            t, count, events, ACCUMULATION, group, contact, rate, 0.0, impulse, lost, impacts
        )


@compiled_apart
def list_all(count: Ints, events: Floats) -> None:
    """List the impacts that were held back: their cascade has ended otherwise."""
    for i in range(count[EVENTS]):
        if events[i, 1] == UNLISTED:
            events[i, 1] = IMPACT
        elif events[i, 1] == UNLISTED_LAST:
            events[i, 1] = ACCUMULATION


@compiled_apart
def end_cascade(state: State, events: Floats) -> None:
    """List the impacts that were held back, or gather them where their contact rests."""
    for j in range(state.resting.size):
        if state.resting[j]:
            gather_unlisted(j, state.count, events)
    list_all(state.count, events)
