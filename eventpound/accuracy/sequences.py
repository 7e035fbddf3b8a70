"""Which event of one run is which event of another.

Contacts are taken one by one, since rows of one instant may stand in any order.
The rows of a contact are cut into *episodes* at what is not an impact: a rest, a
detachment, a separation, the limit of an accumulation. These must be the same in
both runs. In an episode impacts are paired in order; the last ones of a cascade,
softer than `SOFT` of the fastest, are many or few as the rounding wants and may
be missing in either run. Where two runs part, they are taken up again at the next
row of the same kind and, to `TOGETHER` of the run, the same time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.solvers.base import Event, EventKind

SOFT = 1e-6
"""Part of the fastest closing speed below which an impact need not be in both runs."""
TOGETHER = 1e-5
"""Part of the length of a run by which one event may be off in two runs that had parted."""
BRIEF = 1e-12
"""The same below which a contact that detaches and rests again has not opened."""
AHEAD = 60
"""Rows of a contact that are searched for it."""
ENDS = (EventKind.DETACHMENT, EventKind.SEPARATION)
"""What ends a rest."""
MARGIN = 10.0
"""Multiple of `SOFT` below which one run may find an impact softer than that and the other not."""


@dataclass(frozen=True, slots=True)
class Parting:
    """The first event that one run has and another does not.

    Parameters
    ----------
    t : float
        Its time (s).
    contact : int
        Position of the contact.
    found : str
        Its kind in the run that has it first.
    instead : str
        The kind of what the other run has in its place; "nothing" where there is none.
    """

    t: float
    contact: int
    found: str
    instead: str


@dataclass(frozen=True)
class Matching:
    """What two runs have in common.

    Parameters
    ----------
    pairs : dict of int to int
        Row of the other run for rows of the one.
    parting : Parting or None
        Where they part.
    parted : tuple of int
        Contacts at which they part, the first one first.
    touches : bool
        Whether one has soft impacts that the other has not and that are not the tail
        of a cascade: a contact that one run touches and the other does not.
    """

    pairs: dict[int, int]
    parting: Parting | None
    touches: bool
    parted: tuple[int, ...] = ()


def stands_by(event: Event) -> bool:
    """Whether a row gathers soft impacts elsewhere through a contact that was closed all along.

    Whether there are any is decided by rounding, as it is of the softest impacts themselves.
    """
    return event.kind is EventKind.ACCUMULATION and event.gap_velocity_before == 0.0


def lasting_rows(events: Sequence[Event], contact: int, brief: float) -> list[int]:
    """Rows of a contact, without those that rounding decides whether to list.

    A contact that detaches and rests again within no time has not opened. One that rests after
    impacts which are all too soft to be listed, as where a vibration has died away, was as good
    as at rest before, and stays open here until it moves again.

    Parameters
    ----------
    events : sequence of Event
        Of a run, in order of time.
    contact : int
        The contact.
    brief : float
        What is no time (s).
    """
    kept: list[int] = []
    opened: int | None = None
    died_away = False
    for row, event in enumerate(events):
        if event.contact != contact or stands_by(event):
            continue
        if event.kind is EventKind.REST and opened is not None:
            within_no_time = event.t - events[kept[opened]].t <= brief
            died_away = not within_no_time and len(kept) > opened + 1
            if within_no_time or died_away:
                del kept[opened + died_away :]
                opened = None
                continue
            opened = None
        elif event.kind in ENDS:
            if died_away:
                opened, died_away = len(kept) - 1, False
                continue
            opened = len(kept)
        elif event.kind is EventKind.IMPACT and event.gap_velocity_before < 0.0:
            opened, died_away = None, False
        kept.append(row)
    return kept


def loudness(events: Sequence[Event]) -> Floats:
    """Largest closing speed in the problem each row belongs to, shape (rows,) (m/s).

    A resting contact that takes part in an impact does not close by itself; the
    impact is as loud as its fastest contact.
    """
    speed: dict[int, float] = {}
    for event in events:
        speed[event.group] = max(speed.get(event.group, 0.0), -event.gap_velocity_before)
    return np.array([speed[event.group] for event in events])


def match_events(ours: Sequence[Event], theirs: Sequence[Event], contacts: int) -> Matching:
    """Pair the events of two runs.

    Parameters
    ----------
    ours, theirs : sequence of Event
        In order of time.
    contacts : int
        Number of contacts of the scene.
    """
    loud = [loudness(events) for events in (ours, theirs)]
    soft = SOFT * max((float(x.max()) for x in loud if x.size), default=0.0)
    last = max((events[-1].t for events in (ours, theirs) if events), default=0.0)
    first = min((events[0].t for events in (ours, theirs) if events), default=0.0)
    near = TOGETHER * (last - first)
    pairs: dict[int, int] = {}
    partings: list[Parting] = []
    touches = False
    for contact in range(contacts):
        one, other = (
            lasting_rows(events, contact, BRIEF * (last - first)) for events in (ours, theirs)
        )
        found = _match_contact(_Rows(ours, one, loud[0]), _Rows(theirs, other, loud[1]), soft, near)
        pairs.update(found.pairs)
        touches = touches or found.touches
        if found.parting is not None:
            partings.append(found.parting)
    partings.sort(key=lambda parting: parting.t)
    first_of_all = partings[0] if partings else None
    return Matching(pairs, first_of_all, touches, tuple(each.contact for each in partings))


@dataclass(frozen=True)
class _Rows:
    """Rows of one contact: positions in the events of a run, with their loudness."""

    events: Sequence[Event]
    rows: list[int]
    loud: Floats

    def episode(self, start: int) -> tuple[list[int], int]:
        """Impacts from `start` on, and where the row is that ends them."""
        end = start
        while end < len(self.rows) and self.kind(end) is EventKind.IMPACT:
            end += 1
        return self.rows[start:end], end

    def kind(self, position: int) -> EventKind:
        """Kind of a row."""
        return self.events[self.rows[position]].kind

    def time(self, position: int) -> float:
        """Time of a row (s)."""
        return self.events[self.rows[position]].t


def _match_contact(ours: _Rows, theirs: _Rows, soft: float, near: float) -> Matching:
    pairs: dict[int, int] = {}
    first: Parting | None = None
    touches = False
    i = j = 0
    while True:
        one, i = ours.episode(i)
        other, j = theirs.episode(j)
        parting = _match_impacts((ours, one), (theirs, other), soft, pairs)
        ended = (i == len(ours.rows), j == len(theirs.rows))
        cascade = not any(ended) and ours.kind(i) is EventKind.ACCUMULATION
        touches = touches or (len(one) != len(other) and not cascade)
        if parting is None and not any(ended) and ours.kind(i) is theirs.kind(j):
            pairs[ours.rows[i]] = theirs.rows[j]
            i, j = i + 1, j + 1
            continue
        if parting is None and not all(ended):
            parting = _parting(ours, theirs, i, j)
        first = first or parting
        again = _together(ours, theirs, i, j, near)
        if again is None:
            return Matching(pairs, first, touches)
        i, j = again


def _together(ours: _Rows, theirs: _Rows, i: int, j: int, near: float) -> tuple[int, int] | None:
    """The next rows of both runs that are one event, None where there are none."""
    places = [
        (p + q, p, q)
        for p in range(i, min(i + AHEAD, len(ours.rows)))
        for q in range(j, min(j + AHEAD, len(theirs.rows)))
        if ours.kind(p) is theirs.kind(q) and abs(ours.time(p) - theirs.time(q)) <= near
    ]
    if not places:
        return None
    _, p, q = min(places)
    return p, q


def _match_impacts(
    ours: tuple[_Rows, list[int]],
    theirs: tuple[_Rows, list[int]],
    soft: float,
    pairs: dict[int, int],
) -> Parting | None:
    """Pair the impacts of an episode; the first loud one that has no partner."""
    one, other = ours[1], theirs[1]
    if len(one) != len(other):
        one, other = (
            [row for row in rows if side.loud[row] > soft]
            for side, rows in ((ours[0], one), (theirs[0], other))
        )
    pairs.update(zip(one, other, strict=False))
    shared = min(len(one), len(other))
    for side, rows in ((ours[0], one), (theirs[0], other)):
        for row in rows[shared:]:
            if side.loud[row] > MARGIN * soft:
                event = side.events[row]
                return Parting(float(event.t), event.contact, event.kind.value, "nothing")
    return None


def _parting(ours: _Rows, theirs: _Rows, i: int, j: int) -> Parting:
    """The earlier one of two rows of different kind."""
    one = ours.events[ours.rows[i]] if i < len(ours.rows) else None
    other = theirs.events[theirs.rows[j]] if j < len(theirs.rows) else None
    if one is None or (other is not None and other.t < one.t):
        one, other = other, one
    assert one is not None
    instead = other.kind.value if other else "nothing"
    return Parting(float(one.t), one.contact, one.kind.value, instead)
