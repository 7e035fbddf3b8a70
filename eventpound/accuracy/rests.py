"""Rests of a run against those of the reference, contact by contact.

A rest is the stretch of time from a ``rest`` to the ``detachment`` or ``separation`` that
ends it, or to the end of the run. Beginnings are matched with beginnings and ends with
ends, as impacts are. A looser tolerance makes and unmakes short rests as it does slow
impacts: all that last longer than `LISTED` of the scene's time scale T are matched, and the
beginning or end of one without a partner counts as missed or extra where it lasts longer
than `COUNTED` of T.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from eventpound.accuracy.matching import (
    count_extra,
    count_matched,
    count_missed,
    largest_shift,
    match,
)
from eventpound.solvers.base import Event, EventKind

LISTED, COUNTED = 1e-3, 1e-2
ENDS = (EventKind.DETACHMENT, EventKind.SEPARATION)
Kind = Literal["rest", "detachment"]


@dataclass(frozen=True, slots=True)
class Rest:
    """A stretch of time (s) in which a contact rests; `last` is infinite where it goes on."""

    contact: int
    first: float
    last: float


@dataclass(frozen=True, slots=True)
class PairedEnd:
    """The beginning or the end of a rest in the reference, in the run, or in both.

    Parameters
    ----------
    contact : int
        Position in ``scene.contacts``.
    kind : "rest" or "detachment"
        Whether it is the beginning or the end, however the contact was opened.
    reference, found : float or None
        When (s); None where there is none.
    """

    contact: int
    kind: Kind
    reference: float | None
    found: float | None

    @property
    def t(self) -> float:
        """When (s), in the reference where it is there."""
        t = self.found if self.reference is None else self.reference
        assert t is not None
        return t

    @property
    def shift(self) -> float:
        """How much later the run has it (s); NaN without a partner."""
        if self.reference is None or self.found is None:
            return float("nan")
        return self.found - self.reference


@dataclass(frozen=True, slots=True)
class RestErrors:
    """What is wrong with the rests of a run.

    Parameters
    ----------
    pairs : tuple of PairedEnd
        In order of time; those without a partner are listed where they count.
    """

    pairs: tuple[PairedEnd, ...]

    def of(self, kind: Kind) -> list[PairedEnd]:
        """Beginnings, or ends."""
        return [pair for pair in self.pairs if pair.kind == kind]

    def matched(self, kind: Kind) -> int:
        """Number of pairs."""
        return count_matched(self.of(kind))

    def missed(self, kind: Kind) -> int:
        """Number of those of the reference that the run lacks."""
        return count_missed(self.of(kind))

    def extra(self, kind: Kind) -> int:
        """Number of those of the run that the reference lacks."""
        return count_extra(self.of(kind))

    def largest_shift(self, kind: Kind) -> float:
        """Largest error of the time of a matched one (s); NaN without one."""
        return largest_shift(self.of(kind))


def rest_errors(
    reference: Sequence[Event],
    found: Sequence[Event],
    time: float,
    covered: tuple[float, float] = (-np.inf, np.inf),
) -> RestErrors:
    """Match the rests of a run with those of the reference.

    Parameters
    ----------
    reference, found : sequence of Event
        Events of the two runs, in order of time.
    time : float
        Time scale T of the scene (s), the largest shift of a pair.
    covered : tuple of float, optional
        Stretch of time (s) that both runs cover.
    """
    wanted, had = (list(rests(events, covered)) for events in (reference, found))
    pairs: list[PairedEnd] = []
    for contact in sorted({rest.contact for rest in (*wanted, *had)}):
        a, b = (
            [r for r in all_rests if r.contact == contact and _lasts(r, covered) > LISTED * time]
            for all_rests in (wanted, had)
        )
        pairs += _paired(contact, "rest", a, b, time, covered)
        pairs += _paired(contact, "detachment", a, b, time, covered)
    return RestErrors(tuple(sorted(pairs, key=lambda pair: pair.t)))


def rests(events: Sequence[Event], covered: tuple[float, float]) -> Iterator[Rest]:
    """Rests that begin in a stretch of time, in the order of their ends."""
    since: dict[int, float] = {}
    for event in events:
        if event.kind is EventKind.REST:
            since.setdefault(event.contact, event.t)
        elif event.kind in ENDS and event.contact in since:
            yield from _inside(Rest(event.contact, since.pop(event.contact), event.t), covered)
    for contact, first in since.items():
        yield from _inside(Rest(contact, first, np.inf), covered)


def _inside(rest: Rest, covered: tuple[float, float]) -> Iterator[Rest]:
    if covered[0] <= rest.first <= covered[1]:
        yield rest if rest.last <= covered[1] else Rest(rest.contact, rest.first, np.inf)


def _lasts(rest: Rest, covered: tuple[float, float]) -> float:
    return min(rest.last, covered[1]) - rest.first


def _paired(
    contact: int,
    kind: Kind,
    reference: list[Rest],
    found: list[Rest],
    time: float,
    covered: tuple[float, float],
) -> Iterator[PairedEnd]:
    """Beginnings or ends of the rests of one contact."""

    def instant(rest: Rest) -> float:
        return rest.first if kind == "rest" else rest.last

    a, b = ([r for r in rests if np.isfinite(instant(r))] for rests in (reference, found))
    matching = match(np.array([instant(r) for r in a]), np.array([instant(r) for r in b]), time)
    for i, j in matching.pairs:
        yield PairedEnd(contact, kind, instant(a[i]), instant(b[j]))
    for i in matching.missed:
        if _lasts(a[i], covered) > COUNTED * time:
            yield PairedEnd(contact, kind, instant(a[i]), None)
    for j in matching.extra:
        if _lasts(b[j], covered) > COUNTED * time:
            yield PairedEnd(contact, kind, None, instant(b[j]))
