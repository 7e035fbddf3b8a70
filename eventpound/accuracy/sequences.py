"""Which events two runs must both have: weights for the pairing of `eventpound.score`.

A certificate and an estimate ask of two exact solutions whether they are the same, so that any
difference counts that rounding does not make. Rounding makes and unmakes the last impacts of a
cascade, softer than `SOFT` of the fastest; rests that follow such impacts alone, with their ends;
flights that take no time; and the limit of a cascade after which nothing rests. What weighs more
than one must have a partner.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.score.levels import TINY, UNIT_OF_TIME
from eventpound.score.pairing import Pair, Paired, Weights
from eventpound.solvers.base import ENDS_OF_REST, Event, EventKind

SOFT = 1e-6
"""Part of the fastest closing speed below which an impact need not be in both runs."""
BRIEF = 1e-12
"""Part of the length of a run below which a contact that detaches and rests again has not
opened."""
MARGIN = 10.0
"""Multiple of a limit of speed below which one run may find an impact softer than it and the
other not."""
KINDS = ("impact", "rest", "detachment", "accumulation", "cut-impact")
"""What is paired."""


def stands_by(event: Event) -> bool:
    """Whether a row gathers soft impacts elsewhere through a contact that was closed all along.

    Whether there are any is decided by rounding, as it is of the softest impacts themselves.
    """
    return event.kind is EventKind.ACCUMULATION and event.gap_velocity_before == 0.0


def loudness(events: Sequence[Event]) -> Floats:
    """Largest closing speed in the problem each row belongs to, shape (rows,) (m/s).

    A resting contact that takes part in an impact does not close by itself; the
    impact is as loud as its fastest contact.
    """
    speed: dict[int, float] = {}
    for event in events:
        speed[event.group] = max(speed.get(event.group, 0.0), -event.gap_velocity_before)
    return np.array([speed[event.group] for event in events])


@dataclass
class _Contact:
    """What the events of a contact so far say of the next one."""

    recent: list[int] = field(default_factory=list)
    opened: int | None = None
    loudest: float = math.inf
    before: float = math.inf


def speeds_of_events(events: Sequence[Event], brief: float) -> Floats:
    """Closing speed (m/s) of the impacts that each event stands and falls with, shape (rows,).

    Of an impact its loudness; of a rest the largest one since the contact opened, inf where it
    never did, that of the rest before where nothing happened since; of the end of a rest, and of
    the limit of a cascade, that of the rest. A flight of up to `brief` (s) is as loud as its
    impacts, and goes on with the rest before it. Impacts that do not follow each other faster as
    they get softer never end in a rest.
    """
    speeds = loudness(events)
    contacts: dict[int, _Contact] = {}
    for row, event in enumerate(events):
        if stands_by(event):
            speeds[row] = -math.inf
            continue
        at = contacts.setdefault(event.contact, _Contact())
        if event.kind is EventKind.IMPACT:
            at.loudest = max(at.loudest, -event.gap_velocity_before)
        elif event.kind is EventKind.ACCUMULATION:
            speeds[row], at.loudest = 0.0, max(at.loudest, 0.0)
        elif event.kind is EventKind.REST:
            short = at.opened is not None and event.t - events[at.opened].t <= brief
            silent = 0.0 if short else at.before
            speeds[row] = at.loudest if at.loudest >= 0.0 else silent
            if _dies_away([events[i] for i in at.recent]):
                speeds[row] = 0.0
            if short and at.opened is not None:
                speeds[at.opened] = min(speeds[row], speeds[at.opened])
            else:
                at.before = speeds[row]
            if at.recent and events[at.recent[-1]].kind is EventKind.ACCUMULATION:
                speeds[at.recent[-1]] = speeds[row]
        elif event.kind in ENDS_OF_REST:
            speeds[row], at.opened, at.loudest = at.before, row, -math.inf
        at.recent = [*at.recent[-2:], row]
    return speeds


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


def weights_for(missing: float = MARGIN * SOFT) -> Weights:
    """How events are weighed: what a run may lack weighs no more than one.

    Parameters
    ----------
    missing : float
        Part of the fastest closing speed up to which an impact that one run lacks is none that
        counts.
    """

    def weigh(
        kind: str, events: Sequence[Event], unit: float, fastest: float, _: object
    ) -> Iterator[tuple[Event, float]]:
        least = fastest * (missing if kind == EventKind.IMPACT else MARGIN * SOFT)
        kinds = ENDS_OF_REST if kind == EventKind.DETACHMENT else (kind,)
        brief = BRIEF * unit / UNIT_OF_TIME
        for event, speed in zip(events, speeds_of_events(events, brief), strict=True):
            if event.kind in kinds:
                yield event, float(speed) / least

    bands = ((1.0, math.inf), (1.0 / MARGIN, math.inf), (-TINY, 1.0))
    return Weights(weigh, bands, 1.0)


def first_parting(paired: Paired) -> dict[int, Pair]:
    """The first event of each contact that one run has and the other has not, in order of time."""
    first: dict[int, Pair] = {}
    for pair in paired.alone:
        first.setdefault(pair.contact, pair)
    return first


def instead_of(pair: Pair, paired: Paired) -> str:
    """The kind of what the other run has in the place of an event; "nothing" without one.

    One of the same kind would have been its partner, were it not too far away.
    """
    others = (
        (other.found if pair.reference else other.reference)
        for other in paired.alone
        if other.contact == pair.contact and other.kind != pair.kind
    )
    return next((event.kind.value for event in others if event is not None), "nothing")


def touches(paired: Paired, *runs: Sequence[Event]) -> bool:
    """Whether a run has impacts alone that are not the tail of a cascade.

    A contact that one run touches and the other does not.
    """
    impacts = [pair for pair in paired.of("impact").pairs if math.isnan(pair.shift)]
    alone = {id(pair.reference or pair.found) for pair in impacts}
    for events in runs if alone else ():
        open_: set[int] = set()
        for event in events:
            if id(event) in alone:
                open_.add(event.contact)
            elif event.kind is EventKind.ACCUMULATION:
                open_.discard(event.contact)
            elif event.kind is not EventKind.IMPACT and event.contact in open_:
                return True
        if open_:
            return True
    return False
