"""Numbers of a run by name: peaks, their times, final values, events.

``peaks.<body>.max``, ``.t_max``, ``.min``, ``.t_min``; ``final.<body>.u``, ``.v``,
``final.<spring>.z``; ``history.<k>.<body>`` of a displacement at the k-th stated moment;
``events.<row>.t`` and, of an impact, ``.gap_velocity_before``,
``.gap_velocity_after``, ``.impulse``, with the row counted from 0 as in
``events.csv`` of the run the values are of.

The scale of a quantity is what its error is divided by and its digits are counted from: of a
displacement the largest one of its body (not the peak itself, since a body that hardly moves to
the left has a smallest displacement near zero), of a velocity the largest sampled one of its body,
of a time the length of the run, of z its bound, of a gap's speed the largest speed there is, of an
impulse what stops the lighter body from that speed. What is zero but for rounding has no scale of
its own, and that of the scene is taken. Friction that is not unique is no quantity.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from eventpound.accuracy.sequences import SOFT, loudness, stands_by
from eventpound.mechanics.model import assemble
from eventpound.mechanics.supported import lowered
from eventpound.numerics.arrays import Floats
from eventpound.scene.scene import Scene
from eventpound.score.difference import Difference, MotionScales, ScaledValue, Truth, difference
from eventpound.solvers.base import ENDS_OF_REST, EventKind, History, Recording, Task
from eventpound.solvers.events.scales import SceneScales, scene_scales, z_size
from eventpound.tolerances import AT_REST

PEAKS, FINAL = "peaks", "final"
"""First part of the name of a quantity."""
OF_IMPACTS = ("gap_velocity_before", "gap_velocity_after", "impulse")
MOST_EVENTS = 5000
"""Events whose numbers are quantities."""


def scales_of_task(task: Task) -> SceneScales:
    """Scales of the scene of a run."""
    scene = lowered(task.scene, task.start)
    return scene_scales(scene, assemble(scene), task.end - task.start)


def own_scale(own: Any, of_scene: float) -> Floats:
    """Scales of what has some of its own; those of the scene where these are but rounding."""
    return np.where(own > AT_REST * of_scene, own, of_scene)


def motion_scales(task: Task, recording: Recording) -> MotionScales:
    """Scales of a motion: its own largest displacements and speeds, and the bounds of z.

    inf for a z that is not unique, of which no difference counts.
    """
    x, scene = recording.displacement, scales_of_task(task)
    u = np.maximum(np.abs(x.maximum), np.abs(x.minimum))
    v = np.abs(recording.history.v).max(axis=0)
    z = z_size(scene.z_bound)
    if recording.unique_z is not None:
        z = np.where(recording.unique_z, z, np.inf)
    u, v = own_scale(u, scene.length), own_scale(v, scene.speed)
    return MotionScales(scene.time, u, v, z)


def values_by_name(
    scene: Scene, recording: Recording, moments: Sequence[float] = ()
) -> dict[str, float]:
    """Values of a run by name.

    Parameters
    ----------
    scene : Scene
        What moved.
    recording : Recording
        The run.
    moments : sequence of float
        Times (s) at which displacements are wanted.
    """
    return {name: float(value) for name, value, _, _ in _stated(scene, recording, moments)}


def quantities_at(
    task: Task, recording: Recording, moments: Sequence[float] = (), *, events: bool = False
) -> list[ScaledValue]:
    """Every quantity of a run with its value, displacements at some moments (s) too.

    Impacts softer than `SOFT` of the fastest, and all but the first `MOST_EVENTS` events
    are left out.

    Parameters
    ----------
    task : Task
        What was run.
    recording : Recording
        The run.
    moments : sequence of float
        Times (s).
    events : bool
        Whether those of events are wanted.
    """
    scene, duration = task.scene, task.end - task.start
    scales = motion_scales(task, recording)
    of_time = np.full(len(scene.bodies), duration)
    by_unit: Any = {"m": scales.u, "s": of_time, "m/s": scales.v, "": scales.z}
    found = [
        ScaledValue(name, float(value), float(by_unit[unit][i]), unit)
        for name, value, unit, i in _stated(scene, recording, moments)
    ]
    return [*found, *(_of_events(task, recording) if events else ())]


def _stated(
    scene: Scene, recording: Recording, moments: Sequence[float]
) -> Iterator[tuple[str, float, str, int]]:
    """Name, value and unit of each quantity that is no event's, and the place of what it is of."""
    x, history = recording.displacement, recording.history
    for i, body in enumerate(scene.bodies):
        yield f"{PEAKS}.{body.name}.max", x.maximum[i], "m", i
        yield f"{PEAKS}.{body.name}.t_max", x.time_of_maximum[i], "s", i
        yield f"{PEAKS}.{body.name}.min", x.minimum[i], "m", i
        yield f"{PEAKS}.{body.name}.t_min", x.time_of_minimum[i], "s", i
    for i, body in enumerate(scene.bodies):
        yield f"{FINAL}.{body.name}.u", recording.u[i], "m", i
        yield f"{FINAL}.{body.name}.v", recording.v[i], "m/s", i
    for i, (spring, name) in enumerate(scene.memory):
        if recording.unique_z is None or recording.unique_z[i]:
            yield f"{FINAL}.{spring}.{name}", recording.z[i], "", i
    for k, moment in enumerate(moments):
        for i, body in enumerate(scene.bodies):
            yield f"history.{k}.{body.name}", np.interp(moment, history.t, history.u[:, i]), "m", i


def row_of(quantity: ScaledValue) -> int:
    """Row of an event, -1 for what is no event's."""
    group, _, rest = quantity.name.partition(".")
    return int(rest.partition(".")[0]) if group == "events" else -1


def largest_speed(recording: Recording) -> float:
    """The largest speed of a body that was sampled, or of a gap that closed (m/s)."""
    fastest = float(np.max(loudness(recording.events), initial=0.0))
    return max(fastest, float(np.max(np.abs(recording.history.v), initial=0.0)))


def _of_events(task: Task, recording: Recording) -> list[ScaledValue]:
    scene, duration = task.scene, task.end - task.start
    loud = loudness(recording.events)
    fastest = float(np.max(loud, initial=0.0))
    speed = float(own_scale(largest_speed(recording), scales_of_task(task).speed))
    mass = {body.name: body.mass for body in scene.bodies}
    found = []
    for row, event in enumerate(recording.events[:MOST_EVENTS]):
        impact = event.kind is EventKind.IMPACT
        if stands_by(event) or (impact and loud[row] <= SOFT * fastest):
            continue
        found.append(ScaledValue(f"events.{row}.t", event.t, duration, "s"))
        if impact:
            ends = scene.contacts[event.contact].ends
            impulse = min(mass.get(end, np.inf) for end in ends) * speed
            scales = (speed, speed, impulse)
            units = ("m/s", "m/s", "N s")
            found += [
                ScaledValue(f"events.{row}.{key}", getattr(event, key), scale, unit)
                for key, unit, scale in zip(OF_IMPACTS, units, scales, strict=True)
            ]
    return found


def truth_of(task: Task, recording: Recording) -> Truth:
    """A run as others are held against it: values of peaks and the final state, events, scales."""
    scales = motion_scales(task, recording)
    wanted = [q for q in quantities_at(task, recording) if ".t_" not in q.name]
    return Truth(wanted, recording.events, scales.time, (task.start, recording.t), scales)


def errors_of(
    scene: Scene, found: Recording, truth: Truth, rows: History | None, *, rests: bool = True
) -> Difference:
    """What is wrong with a run.

    Parameters
    ----------
    scene : Scene
        What moved.
    found : Recording
        The run.
    truth : Truth
        What it is held against.
    rows : History or None
        The reference at the times of the run's history; None where motions are not compared.
    rests : bool
        Whether the method that ran knows contacts that rest.
    """
    kinds = ("impact", "rest", "detachment") if rests and says_rests(found) else ("impact",)
    motions = None if rows is None else (rows, found.history)
    values = values_by_name(scene, found)
    return difference(truth, values, found.events, kinds, end=found.t, motions=motions)


def says_rests(found: Recording) -> bool:
    """Whether a run says when its contacts rest: it lists one, or knows how long they did."""
    listed = any(event.kind in (EventKind.REST, *ENDS_OF_REST) for event in found.events)
    return listed or not np.isnan(found.resting_time).any()
