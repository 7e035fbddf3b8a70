"""Which event of one run is which event of another.

Contacts are taken one by one, since rows of one instant may stand in any order.
The rows of a contact are cut into *episodes* at what is not an impact: a rest, a
detachment, a separation, the limit of an accumulation. These must be the same in
both runs. In an episode impacts are paired in order; the last ones of a cascade,
softer than `SOFT` of the fastest, are many or few as the rounding wants and may
be missing in either run. Where two runs part, they are taken up again at the next
row of the same kind and, to `TOGETHER` of the run, the same time. Rests that follow
impacts softer than `SOFT` alone need not be in both runs either.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.solvers.base import ENDS_OF_REST, Event, EventKind

Tried = TypeVar("Tried")

SOFT = 1e-6
"""Part of the fastest closing speed below which an impact need not be in both runs."""
TOGETHER = 1e-5
"""Part of the length of a run by which one event may be off in two runs that had parted."""
BRIEF = 1e-12
"""The same below which a contact that detaches and rests again has not opened."""
TINY = 1e-300
"""What is divided by instead of nothing."""
AHEAD = 60
"""Rows of a contact that are searched for it."""
MARGIN = 10.0
"""Multiple of a limit of speed below which one run may find an impact softer than it and the
other not."""


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


def rows_by_contact(events: Sequence[Event], contacts: int) -> list[list[int]]:
    """Rows of each of so many contacts, in order of time."""
    rows: list[list[int]] = [[] for _ in range(contacts)]
    for row, event in enumerate(events):
        rows[event.contact].append(row)
    return rows


def lasting_rows(
    events: Sequence[Event], rows: Sequence[int], brief: float, soft: float = 0.0
) -> list[int]:
    """Rows of a contact, without those that rounding decides whether to list.

    A contact that opens and rests again within no time has not opened. One that rests after
    impacts which are all too soft was as good as at rest before, and stays open here until it
    moves again; so does one whose vibration dies away: its impacts get softer, but do not follow
    each other faster, and go on as long as there are digits. The limit of a cascade after which
    the contact does not rest is where the cascade was cut off.

    Parameters
    ----------
    events : sequence of Event
        Of a run, in order of time.
    rows : sequence of int
        Those of the contact (`rows_by_contact`).
    brief : float
        What is no time (s).
    soft : float
        Closing speeds up to this are too soft (m/s), beside all that are not listed.
    """
    kept: list[int] = []
    flight: _Flight | None = None
    died_away = False
    for row in rows:
        event = events[row]
        if stands_by(event):
            continue
        rests = event.kind is EventKind.REST
        if not rests and kept and events[kept[-1]].kind is EventKind.ACCUMULATION:
            del kept[-1]
        if rests:
            left = flight.rows_left(len(kept), event.t, brief) if flight else None
            if left is None and _dies_away([events[i] for i in kept[-3:]]):
                left = len(kept) - 1
            if left is not None:
                # A flight that took no time leaves the contact as it was.
                died_away = flight is None or left != flight.first or flight.hidden
                del kept[left:]
                flight = None
                continue
            flight = None
        elif event.kind in ENDS_OF_REST:
            flight = _Flight(len(kept), event.t, died_away)
            if died_away:
                died_away = False
                continue
        elif flight and event.kind is EventKind.IMPACT:
            flight.quiet = flight.quiet and -event.gap_velocity_before <= soft
        kept.append(row)
    return kept


@dataclass
class _Flight:
    """From where a contact opens on: its first row, when, and whether that row is left out.

    `quiet`: whether all impacts so far were too soft.
    """

    first: int
    t: float
    hidden: bool
    quiet: bool = True

    def rows_left(self, rows: int, t: float, brief: float) -> int | None:
        """Rows that are left where it ends by a rest at t (s) that is none; else None."""
        if not self.quiet:
            return None
        if t - self.t <= brief:
            return self.first
        opened = self.first + (not self.hidden)
        return opened if self.hidden or rows > opened else None


def _dies_away(last: Sequence[Event]) -> bool:
    """Whether impacts that end in a rest did not follow each other faster, from the last rows.

    Where impacts accumulate the intervals shrink as the speeds do.
    """
    kinds = [event.kind for event in last]
    if kinds != [EventKind.IMPACT, EventKind.IMPACT, EventKind.ACCUMULATION]:
        return False
    first, second, limit = last
    slower = second.gap_velocity_before / min(first.gap_velocity_before, -TINY)
    sooner = (limit.t - second.t) / (limit.count * max(second.t - first.t, TINY))
    return 0.0 < slower < 1.0 and sooner >= math.sqrt(slower)


def soft_limits(*runs: Sequence[Event]) -> list[float]:
    """Speeds (m/s) up to which impacts between two rests may be as good as none.

    Two runs that see the same with one of them see the same: with one limit alone an impact
    might lie above it in one run and below in the other.
    """
    closing = (-event.gap_velocity_before for events in runs for event in events)
    fastest = max(closing, default=0.0)
    return [part * fastest for part in (0.0, SOFT, MARGIN * SOFT)]


def loudness(events: Sequence[Event]) -> Floats:
    """Largest closing speed in the problem each row belongs to, shape (rows,) (m/s).

    A resting contact that takes part in an impact does not close by itself; the
    impact is as loud as its fastest contact.
    """
    speed: dict[int, float] = {}
    for event in events:
        speed[event.group] = max(speed.get(event.group, 0.0), -event.gap_velocity_before)
    return np.array([speed[event.group] for event in events])


def match_events(
    ours: Sequence[Event], theirs: Sequence[Event], contacts: int, missing: float = MARGIN * SOFT
) -> Matching:
    """Pair the events of two runs.

    Parameters
    ----------
    ours, theirs : sequence of Event
        In order of time.
    contacts : int
        Number of contacts of the scene.
    missing : float
        Part of the fastest closing speed up to which an impact that one run lacks is no parting.
    """
    loud = [loudness(events) for events in (ours, theirs)]
    fastest = max((float(x.max()) for x in loud if x.size), default=0.0)
    parts = sorted({SOFT, missing / MARGIN, missing})
    impact_limits = [part * fastest for part in parts]
    limits = soft_limits(ours, theirs)
    last = max((events[-1].t for events in (ours, theirs) if events), default=0.0)
    first = min((events[0].t for events in (ours, theirs) if events), default=0.0)
    near = TOGETHER * (last - first)
    pairs: dict[int, int] = {}
    partings: list[Parting] = []
    touches = False
    brief = BRIEF * (last - first)
    of_contacts = (rows_by_contact(events, contacts) for events in (ours, theirs))
    for our_rows, their_rows in zip(*of_contacts, strict=True):
        tried = (
            _match_contact(
                _Rows(ours, lasting_rows(ours, our_rows, brief, limit), loud[0]),
                _Rows(theirs, lasting_rows(theirs, their_rows, brief, limit), loud[1]),
                impact_limits,
                near,
            )
            for limit in limits
        )
        found = first_that(tried, lambda matching: matching.parting is None)
        pairs.update(found.pairs)
        touches = touches or found.touches
        if found.parting is not None:
            partings.append(found.parting)
    partings.sort(key=lambda parting: parting.t)
    first_of_all = partings[0] if partings else None
    return Matching(pairs, first_of_all, touches, tuple(each.contact for each in partings))


def first_that(tried: Iterable[Tried], agrees: Callable[[Tried], bool]) -> Tried:
    """The first that agrees; where none does, the first of all."""
    seen = []
    for found in tried:
        if agrees(found):
            return found
        seen.append(found)
    return seen[0]


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


def _match_contact(ours: _Rows, theirs: _Rows, limits: Sequence[float], near: float) -> Matching:
    pairs: dict[int, int] = {}
    first: Parting | None = None
    touches = False
    i = j = 0
    while True:
        one, i = ours.episode(i)
        other, j = theirs.episode(j)
        parting = _match_impacts((ours, one), (theirs, other), limits, pairs)
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
    limits: Sequence[float],
    pairs: dict[int, int],
) -> Parting | None:
    """Pair the impacts of an episode; the first loud one that has no partner.

    Where there are more in one run, those are left out that are softer than the first of the
    `limits` (m/s) which leaves only soft ones without a partner: softer than the last.
    """
    tried = []
    for limit in [0.0, *limits]:
        one, other = (
            [row for row in rows if side.loud[row] > limit or limit == 0.0]
            for side, rows in (ours, theirs)
        )
        if limit == 0.0 and len(one) != len(other):
            continue
        shared = min(len(one), len(other))
        alone = [
            side.events[row]
            for (side, _), rows in ((ours, one), (theirs, other))
            for row in rows[shared:]
            if side.loud[row] > limits[-1]
        ]
        tried.append((dict(zip(one, other, strict=False)), alone))
        if not alone:
            break
    paired, alone = tried[0] if tried[-1][1] else tried[-1]
    pairs.update(paired)
    if not alone:
        return None
    event = alone[0]
    return Parting(float(event.t), event.contact, event.kind.value, "nothing")


def _parting(ours: _Rows, theirs: _Rows, i: int, j: int) -> Parting:
    """The earlier one of two rows of different kind."""
    one = ours.events[ours.rows[i]] if i < len(ours.rows) else None
    other = theirs.events[theirs.rows[j]] if j < len(theirs.rows) else None
    if one is None or (other is not None and other.t < one.t):
        one, other = other, one
    assert one is not None
    instead = other.kind.value if other else "nothing"
    return Parting(float(one.t), one.contact, one.kind.value, instead)
