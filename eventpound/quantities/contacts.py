"""Numbers of a contact, from the events of a run."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.quantities.base import Value
from eventpound.quantities.runs import Runs
from eventpound.solvers.base import Event, EventKind, Recording

_Rows = list[Event]


def of_events(number: Callable[[_Rows], float]) -> Value:
    """A number of the events of contact i."""

    def values(many: Runs, i: int) -> Floats:
        found = [[e for e in r.events if e.contact == i] for r in many.recordings]
        return np.array([number(events) for events in found], dtype=np.float64)

    return values


def of_recording(number: Callable[[Recording, int], float]) -> Value:
    """A number of the recording that contact i has."""
    return lambda many, i: np.array([number(r, i) for r in many.recordings], dtype=np.float64)


def max_force(recording: Recording, i: int) -> float:
    """Largest force while resting (N); NaN where it was not unique."""
    return float(recording.max_force[i]) if recording.unique_forces[i] else np.nan


def struck(events: _Rows) -> _Rows:
    """Events that are impacts, or stand for some."""
    return [e for e in events if e.kind in (EventKind.IMPACT, EventKind.ACCUMULATION)]


def closing(event: Event) -> float:
    """Closing speed (m/s)."""
    return -event.gap_velocity_before


def time_of_largest(events: _Rows, size: Callable[[Event], float]) -> float:
    """Time of the impact that is largest in some size (s)."""
    found = struck(events)
    return max(found, key=size).t if found else np.nan


def energy_shares(events: Sequence[Event], contacts: int) -> Floats:
    """Kinetic energy lost in each contact (J), shape (contacts,).

    What a problem of several contacts loses is ``-1/2 sum_j L_j (g_j- + g_j+)``, with the
    impulses L and the rates g of the gaps before and after, so that each has its part. A row
    that stands for several impacts keeps what its problem lost.
    """
    groups: dict[int, _Rows] = {}
    for event in struck(list(events)):
        groups.setdefault(event.group, []).append(event)
    lost = np.zeros(contacts)
    for group in groups.values():
        shared = len(group) > 1 and all(e.count == 1 for e in group)
        for e in group:
            rates = e.gap_velocity_before + e.gap_velocity_after
            lost[e.contact] += -0.5 * e.impulse * rates if shared else e.energy_lost
    return lost


def lost(recording: Recording, i: int) -> float:
    """Kinetic energy lost in contact i (J)."""
    return float(energy_shares(recording.events, recording.resting_time.size)[i])


def faster(many: Runs, i: int) -> Floats:
    """Impacts that close faster than the threshold."""
    least = many.stated.threshold_speed
    return of_events(lambda events: sum(e.count for e in struck(events) if closing(e) > least))(
        many, i
    )


def estimated_force(many: Runs, i: int) -> Floats:
    """Force of the strongest impact if the contact were a spring of the stated stiffness (N).

    Two bodies of the reduced mass m on a spring k touch for half a period, ``pi sqrt(m/k)``; an
    impulse J in the shape of half a sine has the peak ``J sqrt(k/m) / 2``.
    """
    stiffness, scene = many.stated.contact_stiffness, many.scene
    if stiffness is None:
        return many.t * np.nan
    mass = {body.name: body.mass for body in scene.bodies}
    ends = (scene.contacts[i].left, scene.contacts[i].right)
    reduced = 1.0 / sum(1.0 / mass[end] for end in ends if end in mass)
    strongest = of_events(lambda events: max((e.impulse for e in events), default=0.0))(many, i)
    return np.asarray(0.5 * strongest * np.sqrt(stiffness / reduced))
