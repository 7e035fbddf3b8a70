"""Contacts that almost closed, and impacts that almost did not happen.

A *near miss* is a turning point of an open gap; a *graze* an impact of small closing
speed that is not the tail of a cascade. Both are where a small error makes or
unmakes an event.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eventpound.accuracy.quantities import largest_speed
from eventpound.accuracy.sampled import largest_turns
from eventpound.accuracy.sequences import loudness
from eventpound.mechanics.model import assemble
from eventpound.scene.scene import Scene
from eventpound.solvers.base import Event, EventKind, Recording

NEAR_GAP = 1e-4
"""Part of the largest displacement below which a gap that did not close is a near miss."""
NEAR_SPEED = 1e-3
"""Part of the largest speed below which an impact is a graze."""
MOST = 5
"""Near misses and grazes that are listed of each contact."""


@dataclass(frozen=True, slots=True)
class NearMiss:
    """A gap that turned before it closed.

    Parameters
    ----------
    contact : str
        Its name.
    t : float
        When it was smallest (s).
    gap : float
        What was left of it (m).
    """

    contact: str
    t: float
    gap: float


@dataclass(frozen=True, slots=True)
class Graze:
    """An impact that was almost none.

    Parameters
    ----------
    contact : str
        Its name.
    t : float
        When (s).
    closing_speed : float
        With which the gap closed (m/s).
    """

    contact: str
    t: float
    closing_speed: float


def near_misses(scene: Scene, recording: Recording) -> tuple[NearMiss, ...]:
    """Gaps smaller than `NEAR_GAP` of the largest displacement that did not close."""
    h, model = recording.history, assemble(scene)
    acceleration = h.a - h.ground[:, np.newaxis]
    moving = {support.name for support in scene.supports}
    largest = float(np.max(np.abs(h.u), initial=0.0))
    found = []
    for j, contact in enumerate(scene.contacts):
        if moving & {*contact.ends}:
            # Its gap carries a motion that is not among these columns.
            continue
        rate, second = (model.rates(x)[:, j] for x in (h.v, acceleration))
        turns = largest_turns(h.t, -h.gap[:, j], -rate, -second, -NEAR_GAP * largest)
        misses = [NearMiss(contact.name, turn.t, -turn.value) for turn in turns if turn.value < 0.0]
        found += sorted(misses, key=lambda miss: miss.gap)[:MOST]
    return tuple(sorted(found, key=lambda miss: miss.t))


def grazes(scene: Scene, recording: Recording) -> tuple[Graze, ...]:
    """Impacts slower than `NEAR_SPEED` of the largest speed, but those of a cascade to rest."""
    events = recording.events
    loud = loudness(events)
    slow = NEAR_SPEED * largest_speed(recording)
    found = []
    for j, contact in enumerate(scene.contacts):
        rows = [row for row, event in enumerate(events) if event.contact == j]
        soft = [
            Graze(contact.name, events[row].t, float(loud[row]))
            for row in _outside_cascades(events, rows)
            if 0.0 < loud[row] < slow
        ]
        found += sorted(soft, key=lambda graze: graze.closing_speed)[:MOST]
    return tuple(sorted(found, key=lambda graze: graze.t))


def _outside_cascades(events: tuple[Event, ...], rows: list[int]) -> list[int]:
    """Impacts of a contact, but of those that lead to an accumulation only the first."""
    kept: list[int] = []
    cascade: list[int] = []
    for row in rows:
        if events[row].kind is EventKind.IMPACT:
            cascade.append(row)
            continue
        kept += cascade[:1] if events[row].kind is EventKind.ACCUMULATION else cascade
        cascade = []
    return kept + cascade
