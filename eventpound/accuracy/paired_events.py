"""Impacts, rests and detachments of a run against those of the reference, contact by contact.

Of all pairings of two increasing sequences of times that keep their order and pair no two
times further apart than a window w, the one of least cost

    Σ_pairs |t_i - s_j| + (w/2) (number of unpaired times)

is taken (`eventpound.score.pair_times`): so a pair is made exactly where it is cheaper than two
times left alone, and one event too many does not set all later ones against the wrong partner.

Slight events need care: an accumulation has infinitely many impacts, and a looser tolerance moves
one across any threshold, as it makes and unmakes short rests. So all whose weight is above `LISTED`
are paired, and one left without a partner counts as missed or extra only where its weight is above
`COUNTED`. The weight of an impact is its closing speed as part of the reference's largest, that of
a rest how long it lasts as part of the scene's time scale T. A rest is the stretch of time from a
``rest`` to the ``detachment`` or ``separation`` that ends it, or to the end of the run; beginnings
are paired with beginnings and ends with ends.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from eventpound.score import pair_times
from eventpound.solvers.base import ENDS_OF_REST, Event, EventKind

LISTED, COUNTED = 1e-3, 1e-2
ALWAYS = (-math.inf, math.inf)
Kind = Literal["impact", "rest", "detachment"]


class Weighed(NamedTuple):
    """An event and its weight."""

    event: Event
    weight: float


@dataclass(frozen=True, slots=True)
class Pair:
    """What happens in the reference, in the run, or in both.

    Parameters
    ----------
    contact : int
        Position in ``scene.contacts``.
    kind : "impact", "rest" or "detachment"
        What it is; a detachment is the end of a rest, however the contact was opened.
    reference, found : Event or None
        The two; None where there is none.
    """

    contact: int
    kind: Kind
    reference: Event | None
    found: Event | None

    @property
    def t(self) -> float:
        """When (s), in the reference where it is there."""
        event = self.reference or self.found
        assert event is not None
        return event.t

    @property
    def shift(self) -> float:
        """How much later the run has it (s); NaN without a partner."""
        if self.reference is None or self.found is None:
            return math.nan
        return self.found.t - self.reference.t


@dataclass(frozen=True, slots=True)
class EventErrors:
    """What is wrong with the events of a run.

    Parameters
    ----------
    pairs : tuple of Pair
        In order of time; those without a partner are listed where they count.
    """

    pairs: tuple[Pair, ...]

    def of(self, kind: Kind) -> EventErrors:
        """Those of one kind."""
        return EventErrors(tuple(pair for pair in self.pairs if pair.kind == kind))

    @property
    def matched(self) -> int:
        """Number of those that both have."""
        return len(self.pairs) - self.missed - self.extra

    @property
    def missed(self) -> int:
        """Number of those of the reference that the run lacks."""
        return sum(pair.found is None for pair in self.pairs)

    @property
    def extra(self) -> int:
        """Number of those of the run that the reference lacks."""
        return sum(pair.reference is None for pair in self.pairs)

    @property
    def largest_shift(self) -> float:
        """Largest error of the time of a matched one (s); NaN without one."""
        shifts = (abs(pair.shift) for pair in self.pairs)
        return max((shift for shift in shifts if not math.isnan(shift)), default=math.nan)


def impact_errors(
    reference: Sequence[Event],
    found: Sequence[Event],
    window: float,
    speed: float,
    covered: tuple[float, float] = ALWAYS,
) -> EventErrors:
    """Pair the impacts of a run with those of the reference.

    Parameters
    ----------
    reference, found : sequence of Event
        Events of the two runs; only impacts are looked at.
    window : float
        Largest shift of a pair (s).
    speed : float
        Closing speed (m/s) that the parts refer to where the reference has no impact.
    covered : tuple of float, optional
        Stretch of time (s) that both runs cover.
    """
    wanted, had = (
        [e for e in events if e.kind is EventKind.IMPACT and covered[0] <= e.t <= covered[1]]
        for events in (reference, found)
    )
    largest = max(map(_closing_speed, wanted), default=speed)

    def weigh(impacts: list[Event]) -> list[Weighed]:
        return [Weighed(e, _closing_speed(e) / largest) for e in impacts]

    return EventErrors(_in_order(_paired("impact", weigh(wanted), weigh(had), window)))


def rest_errors(
    reference: Sequence[Event],
    found: Sequence[Event],
    time: float,
    covered: tuple[float, float] = ALWAYS,
) -> EventErrors:
    """Pair beginnings and ends of the rests of a run with those of the reference.

    Parameters
    ----------
    reference, found : sequence of Event
        Events of the two runs, in order of time.
    time : float
        Time scale T of the scene (s), the largest shift of a pair.
    covered : tuple of float, optional
        Stretch of time (s) that both runs cover.
    """
    wanted, had = (list(_rests(events, time, covered)) for events in (reference, found))
    kinds: tuple[tuple[Kind, Callable[[_Rest], Event | None]], ...] = (
        ("rest", lambda rest: rest.first),
        ("detachment", lambda rest: rest.last),
    )
    pairs: list[Pair] = []
    for kind, end_of in kinds:
        a, b = (
            [Weighed(event, rest.weight) for rest in rests if (event := end_of(rest))]
            for rests in (wanted, had)
        )
        pairs += _paired(kind, a, b, time)
    return EventErrors(_in_order(pairs))


def _closing_speed(event: Event) -> float:
    """Closing speed (m/s); where a program does not say it, it counts as fast."""
    before = -event.gap_velocity_before
    return math.inf if math.isnan(before) else before


def _paired(kind: Kind, wanted: list[Weighed], had: list[Weighed], window: float) -> Iterator[Pair]:
    """Events of one kind, contact by contact."""
    for contact in sorted({each.event.contact for each in (*wanted, *had)}):
        a, b = (
            [x for x in side if x.event.contact == contact and x.weight > LISTED]
            for side in (wanted, had)
        )
        t, s = (np.array([x.event.t for x in side], dtype=np.float64) for side in (a, b))
        found = pair_times(t, s, window)
        yield from (Pair(contact, kind, a[i].event, b[j].event) for i, j in found)
        for i in sorted(set(range(len(a))) - {i for i, _ in found}):
            if a[i].weight > COUNTED:
                yield Pair(contact, kind, a[i].event, None)
        for j in sorted(set(range(len(b))) - {j for _, j in found}):
            if b[j].weight > COUNTED:
                yield Pair(contact, kind, None, b[j].event)


def _in_order(pairs: Iterator[Pair] | list[Pair]) -> tuple[Pair, ...]:
    return tuple(sorted(pairs, key=lambda pair: pair.t))


class _Rest(NamedTuple):
    """A rest: its first event and the one that ends it, None where it goes on."""

    first: Event
    last: Event | None
    weight: float


def _rests(events: Sequence[Event], time: float, covered: tuple[float, float]) -> Iterator[_Rest]:
    """Rests that begin in a stretch of time (s), weighed by the scene's time scale (s)."""
    since: dict[int, Event] = {}
    ended: list[tuple[Event, Event | None]] = []
    for event in events:
        if event.kind is EventKind.REST:
            since.setdefault(event.contact, event)
        elif event.kind in ENDS_OF_REST and event.contact in since:
            ended.append((since.pop(event.contact), event))
    ended += [(first, None) for first in since.values()]
    for first, last in ended:
        if covered[0] <= first.t <= covered[1]:
            inside = last if last and last.t <= covered[1] else None
            end = inside.t if inside else covered[1]
            yield _Rest(first, inside, (end - first.t) / time)
