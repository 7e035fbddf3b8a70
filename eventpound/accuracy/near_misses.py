"""Contacts that almost closed, impacts that almost did not happen, and turning points of samples.

Between two samples at a distance h the quintic of Hermite type is used, whose
error is h⁶/46080 of the sixth derivative; where a derivative jumps (an event) there
are two samples of the same time, and no polynomial is laid across.

A *near miss* is a turning point of an open gap; a *graze* an impact of small closing
speed that is not the tail of a cascade. Both are where a small error makes or
unmakes an event.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from eventpound.accuracy.quantities import largest_speed
from eventpound.accuracy.sequences import loudness
from eventpound.mechanics.model import assemble
from eventpound.numerics.arrays import Floats, Ints
from eventpound.scene.scene import Scene
from eventpound.solvers.base import Event, EventKind, Recording
from eventpound.solvers.supported import relative_accelerations


class Turn(NamedTuple):
    """A largest value in its neighbourhood.

    t: time (s). value: in the unit of the motion. sample: the sample it is at, where the
    rate jumps or the motion starts or ends, or the first of the two it lies between.
    between: whether it does.
    """

    t: float
    value: float
    sample: int
    between: bool


def largest_turns(t: Floats, x: Floats, v: Floats, a: Floats, above: float) -> list[Turn]:
    """Local maxima of a motion, in order of time.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Times (s), not decreasing; twice the same at an event, before and after.
    x, v, a : ndarray, shape (n,)
        Value, rate and second derivative.
    above : float
        Maxima at or below this value may be left out.
    """
    turns = [
        Turn(float(t[k]), float(x[k]), int(k), False) for k in _at_samples(t, v) if x[k] > above
    ]
    h = np.diff(t)
    rising = (v[:-1] >= 0.0) & (v[1:] <= 0.0) & (v[:-1] > v[1:]) & (h > 0.0)
    # No motion turns higher than the lines of its rates at both ends meet, but for its curvature.
    reach = np.maximum(x[:-1], x[1:]) + h * np.maximum(np.abs(v[:-1]), np.abs(v[1:]))
    for k in np.flatnonzero(rising & (reach > above)):
        tau, value = _turn(x[k : k + 2], v[k : k + 2], a[k : k + 2], float(h[k]))
        if value > above:
            turns.append(Turn(float(t[k]) + tau, value, int(k), True))
    return sorted(turns)


def _at_samples(t: Floats, v: Floats) -> Ints:
    """Samples at which the rate jumps from rising or still to falling or still."""
    before = np.concatenate(([1.0], v[:-1]))
    jump = np.concatenate(([True], np.diff(t) == 0.0))
    turned: Ints = np.flatnonzero(jump & (before >= 0.0) & (v <= 0.0) & (before > v))
    if v.size and v[-1] > 0.0:
        turned = np.append(turned, v.size - 1)
    return turned


def _turn(x: Floats, v: Floats, a: Floats, h: float) -> tuple[float, float]:
    """Where between two samples the quintic is largest (s from the first), and its value."""
    p = _quintic(x, v * h, a * h * h)
    roots = np.polynomial.polynomial.polyroots(np.polynomial.polynomial.polyder(p))
    inside = roots[(np.abs(roots.imag) < 1e-9) & (roots.real >= 0.0) & (roots.real <= 1.0)].real
    places = np.concatenate((inside, [0.0, 1.0]))
    values = np.polynomial.polynomial.polyval(places, p)
    best = int(np.argmax(values))
    return float(places[best]) * h, float(values[best])


def _quintic(x: Floats, v: Floats, a: Floats) -> Floats:
    """Coefficients, lowest first, of the quintic with these values and derivatives at 0 and 1."""
    d = x[1] - x[0] - v[0] - a[0] / 2.0
    dv = v[1] - v[0] - a[0]
    da = a[1] - a[0]
    return np.array(
        (
            x[0],
            v[0],
            a[0] / 2.0,
            10.0 * d - 4.0 * dv + da / 2.0,
            -15.0 * d + 7.0 * dv - da,
            6.0 * d - 3.0 * dv + da / 2.0,
        )
    )


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
    acceleration = relative_accelerations(scene, h)
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
