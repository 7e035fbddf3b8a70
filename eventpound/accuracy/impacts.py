"""Impacts of a run against those of the reference, contact by contact.

Slow impacts need care: an accumulation has infinitely many, and a looser tolerance moves
one across any threshold. So all impacts whose closing speed is above `LISTED` of the
reference's largest are paired, and an impact left without a partner counts as missed or
extra only where its speed is above `COUNTED` of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eventpound.accuracy.matching import (
    count_extra,
    count_matched,
    count_missed,
    largest_shift,
    match,
)
from eventpound.numerics.arrays import Floats
from eventpound.solvers.base import Event, EventKind

LISTED, COUNTED = 1e-3, 1e-2


@dataclass(frozen=True, slots=True)
class PairedImpact:
    """An impact of the reference, of the run, or of both.

    Parameters
    ----------
    contact : int
        Position in ``scene.contacts``.
    reference, found : Event or None
        The two; None where there is none.
    """

    contact: int
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
            return float("nan")
        return self.found.t - self.reference.t


@dataclass(frozen=True, slots=True)
class ImpactErrors:
    """What is wrong with the impacts of a run.

    Parameters
    ----------
    pairs : tuple of PairedImpact
        In order of time; those without a partner are listed where they count.
    """

    pairs: tuple[PairedImpact, ...]

    @property
    def matched(self) -> int:
        """Number of pairs."""
        return count_matched(self.pairs)

    @property
    def missed(self) -> int:
        """Number of the reference's impacts that the run lacks."""
        return count_missed(self.pairs)

    @property
    def extra(self) -> int:
        """Number of the run's impacts that the reference lacks."""
        return count_extra(self.pairs)

    @property
    def largest_shift(self) -> float:
        """Largest error of the time of a matched impact (s); NaN without one."""
        return largest_shift(self.pairs)


def impact_errors(
    reference: tuple[Event, ...],
    found: tuple[Event, ...],
    window: float,
    speed: float,
    covered: tuple[float, float] = (-np.inf, np.inf),
) -> ImpactErrors:
    """Pair the impacts of a run with those of the reference.

    Parameters
    ----------
    reference, found : tuple of Event
        Events of the two runs; only impacts are looked at.
    window : float
        Largest shift of a pair (s).
    speed : float
        Closing speed (m/s) that the parts refer to where the reference has no impact.
    covered : tuple of float, optional
        Stretch of time (s) that both runs cover.
    """
    wanted, had = _impacts(reference, covered), _impacts(found, covered)
    largest = max((_speed(event) for event in wanted), default=speed)
    pairs: list[PairedImpact] = []
    for contact in sorted({event.contact for event in (*wanted, *had)}):
        a = _listed(wanted, contact, largest)
        b = _listed(had, contact, largest)
        matching = match(_times(a), _times(b), window)
        pairs += [PairedImpact(contact, a[i], b[j]) for i, j in matching.pairs]
        missed = [PairedImpact(contact, a[i], None) for i in matching.missed]
        extra = [PairedImpact(contact, None, b[j]) for j in matching.extra]
        pairs += [p for p in (*missed, *extra) if _counts(p, largest)]
    return ImpactErrors(tuple(sorted(pairs, key=lambda pair: pair.t)))


def _impacts(events: tuple[Event, ...], stretch: tuple[float, float]) -> list[Event]:
    return [
        event
        for event in events
        if event.kind is EventKind.IMPACT and stretch[0] <= event.t <= stretch[1]
    ]


def _speed(event: Event) -> float:
    """Closing speed (m/s); where a program does not say it, it counts as fast."""
    before = -event.gap_velocity_before
    return np.inf if np.isnan(before) else before


def _listed(events: list[Event], contact: int, largest: float) -> list[Event]:
    return [e for e in events if e.contact == contact and _speed(e) > LISTED * largest]


def _times(events: list[Event]) -> Floats:
    return np.array([event.t for event in events], dtype=np.float64)


def _counts(pair: PairedImpact, largest: float) -> bool:
    event = pair.reference or pair.found
    return event is not None and _speed(event) > COUNTED * largest
