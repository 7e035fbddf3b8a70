"""What a certificate is about: peaks, their times, final values, events, by name.

``peaks.<body>.max``, ``.t_max``, ``.min``, ``.t_min``; ``final.<body>.u``, ``.v``,
``final.<spring>.z``; ``history.<k>.<body>`` of a displacement at the k-th stated moment;
``events.<row>.t`` and, of an impact, ``.gap_velocity_before``,
``.gap_velocity_after``, ``.impulse``, with the row counted from 0 as in
``events.csv`` of the run the values are of.

The scale of a quantity is what its digits are counted from: of a displacement the
largest one of its body, of a velocity the largest sampled one of its body, of a
time the length of the run, of z its bound, of a gap's speed the largest speed there
is, of an impulse what stops the lighter body from that speed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from eventpound.accuracy import errors
from eventpound.accuracy.sequences import SOFT, loudness, stands_by
from eventpound.mechanics.hysteresis import z_bound
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import in_python
from eventpound.scene.scene import Scene
from eventpound.scene.spring import BoucWen
from eventpound.solvers.base import EventKind, Recording


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number of a run.

    Parameters
    ----------
    name : str
        As at the head of this module.
    unit : str
        SI; empty for a pure number.
    scale : float
        What its digits are counted from, in its unit.
    row : int
        Row of an event, -1 for what is no event's.
    at : (float, int), optional
        Moment (s) and body of a displacement in the history.
    """

    name: str
    unit: str
    scale: float
    row: int = -1
    at: tuple[float, int] | None = None


def quantities_of(
    scene: Scene, recording: Recording, duration: float, moments: Sequence[float] = ()
) -> list[Quantity]:
    """Every quantity of a run that takes `duration` (s), displacements at some moments (s) too.

    Impacts softer than `SOFT` of the fastest, and all but the first `MOST_EVENTS` events
    are left out.
    """
    x = recording.displacement
    largest = np.maximum(np.abs(x.maximum), np.abs(x.minimum))
    speeds = np.max(np.abs(recording.history.v), axis=0, initial=0.0)
    found = []
    for i, body in enumerate(scene.bodies):
        length = _positive(largest[i], largest)
        for key in ("max", "min"):
            found.append(Quantity(f"peaks.{body.name}.{key}", "m", length))
            found.append(Quantity(f"peaks.{body.name}.t_{key}", "s", duration))
    for i, body in enumerate(scene.bodies):
        length, speed = _positive(largest[i], largest), _positive(speeds[i], speeds)
        found.append(Quantity(f"final.{body.name}.u", "m", length))
        found.append(Quantity(f"final.{body.name}.v", "m/s", speed))
    for spring in scene.springs:
        law = spring.law
        if isinstance(law, BoucWen):
            bound = float(in_python(z_bound)(law.exponent, law.beta, law.gamma))
            found.append(Quantity(f"final.{spring.name}.z", "", bound))
    for k, moment in enumerate(moments):
        for i, body in enumerate(scene.bodies):
            length = _positive(largest[i], largest)
            found.append(Quantity(f"history.{k}.{body.name}", "m", length, at=(moment, i)))
    return found + _of_events(scene, recording, duration)


MOST_EVENTS = 5000
"""Events whose numbers are quantities."""
STILL = 1e-9
"""Part of the largest motion below which a body is at rest but for rounding."""


def _positive(value: float, others: Floats) -> float:
    """A scale that is not zero: `STILL` of the others' where a body does not move, or 1."""
    return max(float(value), STILL * float(np.max(others, initial=0.0))) or 1.0


def largest_speed(recording: Recording) -> float:
    """The largest speed of a body that was sampled, or of a gap that closed (m/s)."""
    fastest = float(np.max(loudness(recording.events), initial=0.0))
    return max(fastest, float(np.max(np.abs(recording.history.v), initial=0.0)))


def _of_events(scene: Scene, recording: Recording, duration: float) -> list[Quantity]:
    loud = loudness(recording.events)
    fastest = float(np.max(loud, initial=0.0))
    speed = largest_speed(recording) or 1.0
    mass = {body.name: body.mass for body in scene.bodies}
    found = []
    for row, event in enumerate(recording.events[:MOST_EVENTS]):
        impact = event.kind is EventKind.IMPACT
        if stands_by(event) or (impact and loud[row] <= SOFT * fastest):
            continue
        found.append(Quantity(f"events.{row}.t", "s", duration, row))
        if impact:
            contact = scene.contacts[event.contact]
            lighter = min(mass.get(end, np.inf) for end in contact.ends)
            for key in ("gap_velocity_before", "gap_velocity_after"):
                found.append(Quantity(f"events.{row}.{key}", "m/s", speed, row))
            found.append(Quantity(f"events.{row}.impulse", "N s", lighter * speed, row))
    return found


def values_of(
    scene: Scene, recording: Recording, wanted: list[Quantity], rows: Mapping[int, int]
) -> Floats:
    """Values of quantities in a run.

    Parameters
    ----------
    scene : Scene
        What moved.
    recording : Recording
        The run.
    wanted : list of Quantity
        Quantities, with rows of the run they were listed for.
    rows : mapping of int to int
        The row of this run for each of those rows.

    Returns
    -------
    ndarray, shape (len(wanted),)
        NaN for an event this run does not have.
    """
    known = values_of_state(scene, recording)
    history = recording.history
    values = np.full(len(wanted), np.nan)
    for i, quantity in enumerate(wanted):
        if quantity.at is not None:
            moment, body = quantity.at
            values[i] = np.interp(moment, history.t, history.u[:, body])
        elif quantity.row < 0:
            values[i] = known[quantity.name]
        elif quantity.row in rows:
            event = recording.events[rows[quantity.row]]
            values[i] = getattr(event, quantity.name.rpartition(".")[2])
    return values


def values_of_state(scene: Scene, recording: Recording) -> dict[str, float]:
    """Values of all quantities of a run but those of its events, by name."""
    x = recording.displacement
    known = errors.values_of(scene, recording)
    for i, body in enumerate(scene.bodies):
        known[f"peaks.{body.name}.t_max"] = x.time_of_maximum[i]
        known[f"peaks.{body.name}.t_min"] = x.time_of_minimum[i]
    return known
