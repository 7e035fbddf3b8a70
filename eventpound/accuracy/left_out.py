"""What a run leaves out or rounds off, the same by every route: no difference of runs shows it.

A step rounds the state once, an event `ROUNDINGS_OF_EVENT` times (page "accuracy" of the docs).
A cascade has infinitely many impacts; it ends by a rule (`eventpound.contact.cascade`), and
then its contacts rest with a closing speed taken from them that is at most

    `LAST_SPEED` L/T                                 at its end (`LAST_SPEED_OF_SLIDERS`)
    10 `FADED` of the fastest, at every contact      where all happens in one instant
    n `LISTED_SPEED` of the fastest                  after n times `TIRED` impacts

The last impact followed comes before the limit of the cascade by all intervals that would
follow. Impacts that lose the same part of their speed each have intervals that shrink as the
speeds do: with v_p and v_n at the impacts t_p and t_n of a contact,

    limit - t_n = (t_n - t_p) ρ/(1 - ρ),    ρ = v_n/v_p.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence

from eventpound.contact.cascade import TIRED, last_speed
from eventpound.contact.event import STRIKES
from eventpound.scene.scene import Scene
from eventpound.scene.spring import LawName
from eventpound.solvers.base import Event, EventKind, Recording
from eventpound.tolerances import EPS, FADED, LISTED_SPEED

ROUNDINGS_OF_EVENT = 4
"""Of the state at an event: its place in time, the state there, the constraint, the impulse."""
_BESIDE = 2.0
"""Safety of the limit's time: the acceleration between impacts is not quite constant."""


def displaced(recording: Recording, scene: Scene) -> float:
    """By how much the state is put off in all, in parts of its scale.

    Parameters
    ----------
    recording : Recording
        The run.
    scene : Scene
        What moved.
    """
    sliders = LawName.SLIDER in scene.branched_springs.values()
    roundings = recording.work.steps + ROUNDINGS_OF_EVENT * sum(e.count for e in recording.events)
    return EPS * roundings + _taken(recording.events, last_speed(1.0, sliders))


def _taken(events: Sequence[Event], last: float) -> float:
    """Speeds taken from cascades at their ends, in parts of the fastest."""
    groups: defaultdict[float, set[int]] = defaultdict(set)
    ends: defaultdict[float, int] = defaultdict(int)
    for event in events:
        if event.kind in STRIKES:
            groups[event.t].add(event.group)
        if event.kind is EventKind.ACCUMULATION:
            ends[event.t] += event.count
    taken = 0.0
    for t, count in ends.items():
        taken += last
        if len(groups[t]) > 1:
            taken += 10.0 * FADED
        taken += LISTED_SPEED * (count // TIRED)
    return taken


def time_to_limits(events: Sequence[Event]) -> Mapping[float, float]:
    """By how much limits of cascades may come later than the times listed for them (s).

    Parameters
    ----------
    events : sequence of Event
        Of a run, in order.

    Returns
    -------
    mapping of float to float
        By the time listed; of several limits of one instant the largest.
    """
    last: dict[int, tuple[float, float]] = {}
    later: dict[float, float] = {}
    for event in events:
        speed = -event.gap_velocity_before
        if event.kind is EventKind.ACCUMULATION and event.contact in last:
            before, faster = last[event.contact]
            if 0.0 < speed < faster:
                rest = (event.t - before) * speed / (faster - speed)
                later[event.t] = max(later.get(event.t, 0.0), _BESIDE * rest)
        if event.kind is EventKind.IMPACT and speed > 0.0:
            last[event.contact] = (event.t, speed)
    return later
