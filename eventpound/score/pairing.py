"""Which event is which: pairs of events of two runs."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from eventpound.score.levels import ALWAYS, COUNTED, EVENTS, LISTED, MOST_COSTS, TINY, Floats


@dataclass(frozen=True, slots=True)
class Event:
    """What happens at a contact.

    Parameters
    ----------
    kind : str
        "impact", or one of those in `EVENTS`.
    t : float
        Time (s).
    contact : int
        Position of the contact.
    gap_velocity_before, gap_velocity_after : float
        Rate of the gap (m/s), negative when closing; NaN where it is not known.
    bound : float or None
        That of the time (s), None where it has none.
    """

    kind: str
    t: float
    contact: int
    gap_velocity_before: float = math.nan
    gap_velocity_after: float = math.nan
    bound: float | None = None


@dataclass(frozen=True, slots=True)
class Pair:
    """An event of the reference, of a run, or of both.

    Parameters
    ----------
    kind : str
        "impact" or a key of `EVENTS`.
    reference, found : Event or None
        The two (`Event`, or any with its attributes); None where there is none.
    weight : float
        Of the reference's, where it is there.
    """

    kind: str
    reference: Any
    found: Any
    weight: float

    @property
    def contact(self) -> int:
        """Position of the contact."""
        return int((self.reference or self.found).contact)

    @property
    def t(self) -> float:
        """When (s), in the reference where it is there."""
        return float((self.reference or self.found).t)

    @property
    def shift(self) -> float:
        """How much later the run has it (s); NaN without a partner."""
        both = self.reference is not None and self.found is not None
        return self.found.t - self.reference.t if both else math.nan


@dataclass(frozen=True, slots=True)
class Paired:
    """Events of two runs.

    Parameters
    ----------
    pairs : tuple of Pair
        In order of time; those too slight to count without a partner, too.
    counted : float
        Weight above which one without a partner counts.
    """

    pairs: tuple[Pair, ...] = ()
    counted: float = COUNTED

    def of(self, *kinds: str) -> Paired:
        """Those of some kinds."""
        return replace(self, pairs=tuple(pair for pair in self.pairs if pair.kind in kinds))

    @property
    def listed(self) -> tuple[Pair, ...]:
        """Those with a partner, and those that count without."""
        return tuple(p for p in self.pairs if p.weight > self.counted or not math.isnan(p.shift))

    @property
    def alone(self) -> tuple[Pair, ...]:
        """Those that count without a partner, and have none."""
        return tuple(p for p in self.pairs if p.weight > self.counted and math.isnan(p.shift))

    @property
    def expected(self) -> int:
        """Number of those of the reference."""
        return sum(pair.reference is not None for pair in self.pairs)

    @property
    def matched(self) -> int:
        """Number of those that both have."""
        return sum(not math.isnan(pair.shift) for pair in self.pairs)

    @property
    def missed(self) -> int:
        """Number of those that count and that the run lacks."""
        return sum(pair.found is None for pair in self.listed)

    @property
    def extra(self) -> int:
        """Number of those that count and that the reference lacks."""
        return sum(pair.reference is None for pair in self.listed)

    @property
    def largest_shift(self) -> float:
        """Largest difference in time of two that are paired (s); NaN without a pair."""
        shifts = [abs(pair.shift) for pair in self.pairs if not math.isnan(pair.shift)]
        return max(shifts, default=math.nan)


Weigh = Callable[
    [str, Sequence[Any], float, float, tuple[float, float]], Iterator[tuple[Any, float]]
]
"""Events of a kind, and how far each is from being none, see `weighed`."""


@dataclass(frozen=True)
class Weights:
    """Which events are paired, and which of them count where they have no partner.

    Parameters
    ----------
    weigh : callable
        Events of a kind with the weight of each.
    bands : tuple of tuple of float
        Weights above and up to which events are paired, one band after the other.
    counted : float
        Weight above which an event without a partner counts.
    """

    weigh: Weigh
    bands: tuple[tuple[float, float], ...]
    counted: float


def pair_events(
    reference: Sequence[Any],
    found: Sequence[Any],
    unit: float,
    kinds: Sequence[str] = ("impact",),
    *,
    speed: float = 0.0,
    covered: tuple[float, float] = ALWAYS,
    weights: Weights | None = None,
) -> Paired:
    """Pair events of two runs, kind by kind and contact by contact.

    Slight events need care: an accumulation has infinitely many impacts, and a looser tolerance
    moves one across any threshold, as it makes and unmakes short rests. So each has a weight. All
    above one are paired by `pair_times`; one left without a partner counts above another. Without
    others these are `LISTED` and `COUNTED`, and the weight of an impact is its closing speed as
    part of the reference's largest, infinite where it is not known; that of a rest and its end how
    long it lasts as part of the unit, infinite for an end without a beginning. What lists the soft
    impacts at a contact that stays closed (closing speed 0) is the limit of none.

    Parameters
    ----------
    reference, found : sequence of Event
        In order of time; anything with the attributes of an `Event`.
    unit : float
        Largest shift of a pair, and unit of the lengths of rests (s).
    kinds : sequence of str
        "impact" and keys of `EVENTS`.
    speed : float
        Closing speed (m/s) that weights refer to where the reference has no impact.
    covered : tuple of float
        Stretch of time (s) that both runs cover.
    weights : Weights, optional
        Others.
    """
    rule = weights or Weights(weighed, ((LISTED, math.inf),), COUNTED)
    hits = [e for e in reference if e.kind == "impact" and covered[0] <= e.t <= covered[1]]
    fastest = max(map(_closing_speed, hits), default=speed) or TINY
    pairs: list[Pair] = []
    for kind in kinds:
        both = [
            list(rule.weigh(kind, events, unit, fastest, covered)) for events in (reference, found)
        ]
        for contact in sorted({event.contact for side in both for event, _ in side}):
            a, b = ([row for row in side if row[0].contact == contact] for side in both)
            for band in rule.bands:
                a, b, paired = _pair_within(band, a, b, unit)
                pairs += [Pair(kind, x, y, weight) for x, y, weight in paired]
            least = rule.bands[-1][0]
            a, b = ([row for row in side if row[1] > least] for side in (a, b))
            pairs += [Pair(kind, event, None, weight) for event, weight in a]
            pairs += [Pair(kind, None, event, weight) for event, weight in b]
    return Paired(tuple(sorted(pairs, key=lambda pair: pair.t)), rule.counted)


_Weighed = list[tuple[Any, float]]


def _pair_within(
    band: tuple[float, float], a: _Weighed, b: _Weighed, window: float
) -> tuple[_Weighed, _Weighed, list[tuple[Any, Any, float]]]:
    """What remains of two lists, and the pairs of some weights, with the first one's."""
    low, high = band
    i, k = ([n for n, row in enumerate(side) if low < row[1] <= high] for side in (a, b))
    t, s = (np.array([x[n][0].t for n in rows], dtype=float) for x, rows in ((a, i), (b, k)))
    both = [(i[m], k[n]) for m, n in pair_times(t, s, window)]
    gone = [{pair[side] for pair in both} for side in (0, 1)]
    left, right = (
        [row for n, row in enumerate(side) if n not in paired]
        for side, paired in zip((a, b), gone, strict=True)
    )
    return left, right, [(a[m][0], b[n][0], a[m][1]) for m, n in both]


def weighed(
    kind: str, events: Sequence[Any], unit: float, fastest: float, covered: tuple[float, float]
) -> Iterator[tuple[Any, float]]:
    """Events of a kind, and the weight of each, contact by contact in order of time."""
    first, end = covered
    if kind in ("rest", "detachment"):
        for began, ended in rests_of(events):
            if not first <= (began or ended).t <= end:
                continue
            inside = ended if ended is not None and ended.t <= end else None
            event = began if kind == "rest" else inside
            if event is not None:
                lasts = math.inf if began is None else (inside.t if inside else end) - began.t
                yield event, lasts / unit
        return
    for event in events:
        if event.kind == kind and first <= event.t <= end:
            if kind == "impact":
                yield event, _closing_speed(event) / fastest
            elif event.gap_velocity_before != 0.0:
                yield event, math.inf


def _closing_speed(event: Any) -> float:
    """Closing speed (m/s); where a program does not say it, it counts as fast."""
    before = -event.gap_velocity_before
    return math.inf if math.isnan(before) else before


def rests_of(events: Sequence[Any]) -> list[tuple[Any, Any]]:
    """First and last event of each rest; None for a beginning or an end that is not listed."""
    since: dict[int, Any] = {}
    found = []
    for event in events:
        if event.kind == "rest":
            since.setdefault(event.contact, event)
        elif event.kind in EVENTS["detachment"]:
            found.append((since.pop(event.contact, None), event))
    return found + [(began, None) for began in since.values()]


def pair_times(reference: Floats, found: Floats, window: float) -> list[tuple[int, int]]:
    """Pair the times of two sequences that do not decrease.

    Of all pairings that keep the order and pair no two times further apart than the window w,
    the one with the least sum of shifts and w/2 for each unpaired time, by dynamic programming
    (Needleman and Wunsch 1970).

    Parameters
    ----------
    reference, found : ndarray, shape (n,), (m,)
        Times (s).
    window : float
        w (s), positive.
    """
    if reference.size == found.size and np.abs(reference - found).sum() <= window:
        # Anything else leaves one of each alone.
        return [(i, i) for i in range(found.size)]
    pairs = []
    every = np.sort(np.concatenate((reference, found)))
    starts = every[np.flatnonzero(np.diff(every, prepend=-np.inf) > window)]
    a, b = (np.append(np.searchsorted(x, starts), x.size) for x in (reference, found))
    for i in range(starts.size):
        # Stretches between which nothing can be paired.
        x, y = reference[a[i] : a[i + 1]], found[b[i] : b[i + 1]]
        if x.size * y.size > MOST_COSTS and window > np.finfo(float).eps * y[-1]:
            near = pair_times(x, y, 0.1 * window)
        else:
            near = _cheapest(np.abs(x[:, None] - y), window)
        pairs += [(int(a[i]) + j, int(b[i]) + k) for j, k in near]
    return pairs


def _cheapest(shifts: Floats, window: float) -> list[tuple[int, int]]:
    """Pairs of least cost for the shifts of all pairs, shape (n, m)."""
    cost = _costs(shifts, window)
    i, j = shifts.shape
    pairs = []
    while i > 0 and j > 0:
        together = cost[i - 1, j - 1] + shifts[i - 1, j - 1]
        if together <= min(cost[i - 1, j], cost[i, j - 1]) + 0.5 * window:
            pairs.append((i - 1, j - 1))
            i, j = i - 1, j - 1
        elif cost[i - 1, j] <= cost[i, j - 1]:
            i -= 1
        else:
            j -= 1
    return pairs[::-1]


def _costs(shifts: Floats, window: float) -> Floats:
    """Least cost of pairing the first i with the first j times, shape (n + 1, m + 1).

    ``c_ij = min(c_(i-1)(j-1) + shift, c_(i-1)j + w/2, c_i(j-1) + w/2)``; a shift above w
    never pays. Row by row, the last alternative is a running minimum.
    """
    alone = 0.5 * window
    n, m = shifts.shape
    steps = alone * np.arange(m + 1)
    cost = np.empty((n + 1, m + 1))
    cost[0] = steps
    for i in range(1, n + 1):
        best = cost[i - 1] + alone
        best[1:] = np.minimum(best[1:], cost[i - 1, :-1] + shifts[i - 1])
        cost[i] = np.minimum.accumulate(best - steps) + steps
    return cost
