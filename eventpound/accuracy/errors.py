"""What is wrong with a run: its errors in the numbers one looks at first.

For body b with U_b = max_t |u_b| and V_b = max_t |v_b| of the reference and spring s with
the bound Z_s of its z,

    peaks:        |p - p_ref| / U_b       p = max_t u_b and min_t u_b
    final state:  |u - u_ref| / U_b,  |v - v_ref| / V_b,  |z - z_ref| / Z_s

at the end of the run. A body's own largest displacement is the measure, not the peak
itself, since one that hardly moves to the left has a smallest displacement near zero.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from eventpound.accuracy.distance import Distance, MotionScales, distance
from eventpound.accuracy.paired_events import EventErrors, impact_errors, rest_errors
from eventpound.numerics.arrays import Floats
from eventpound.scene.scene import Scene
from eventpound.solvers.base import ENDS_OF_REST, EventKind, History, Recording

PEAKS, FINAL = "peaks", "final"
"""First part of the name of a quantity."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number of a run beside its true value.

    Parameters
    ----------
    name : str
        As in ``summary.json``, ``peaks.deck1.max``.
    value, reference : float
        Of the run and of the reference (SI).
    scale : float
        What the error is divided by (SI).
    bound : float
        How far the reference itself may be off (SI); NaN where nobody knows.
    """

    name: str
    value: float
    reference: float
    scale: float
    bound: float

    @property
    def error(self) -> float:
        """Distance from the reference as a part of the scale; NaN where there is no value."""
        return abs(self.value - self.reference) / self.scale


@dataclass(frozen=True, slots=True)
class Errors:
    """Everything that is wrong with a run.

    Parameters
    ----------
    quantities : tuple of Quantity
        Peaks and final state.
    impacts : EventErrors
        Shifts, missed and extra impacts.
    rests : EventErrors or None
        The same of rests and detachments; None where the run does not say.
    distance : Distance
        Of the two motions.
    """

    quantities: tuple[Quantity, ...]
    impacts: EventErrors
    rests: EventErrors | None
    distance: Distance

    def largest(self, part: str) -> float:
        """Largest error of ``"peaks"`` or ``"final"``; NaN where none is known."""
        return _largest([q.error for q in self.quantities if q.name.startswith(part)])


def _largest(values: list[float]) -> float:
    known = [value for value in values if not np.isnan(value)]
    return max(known, default=float("nan"))


def values_of(scene: Scene, recording: Recording) -> dict[str, float]:
    """Peaks and final state of a run by their names in ``summary.json``."""
    found: dict[str, float] = {}
    x = recording.displacement
    for i, body in enumerate(scene.bodies):
        found[f"{PEAKS}.{body.name}.max"] = float(x.maximum[i])
        found[f"{PEAKS}.{body.name}.min"] = float(x.minimum[i])
    for i, body in enumerate(scene.bodies):
        found[f"{FINAL}.{body.name}.u"] = float(recording.u[i])
        found[f"{FINAL}.{body.name}.v"] = float(recording.v[i])
    for i, name in enumerate(scene.hysteretic_springs):
        found[f"{FINAL}.{name}.z"] = float(recording.z[i])
    return found


def value_scales(scene: Scene, scales: MotionScales) -> dict[str, float]:
    """What the error of each quantity is divided by (SI)."""
    divisors: dict[str, float] = {}
    for i, body in enumerate(scene.bodies):
        for key in ("max", "min"):
            divisors[f"{PEAKS}.{body.name}.{key}"] = float(scales.u[i])
        divisors[f"{FINAL}.{body.name}.u"] = float(scales.u[i])
        divisors[f"{FINAL}.{body.name}.v"] = float(scales.v[i])
    for i, name in enumerate(scene.hysteretic_springs):
        divisors[f"{FINAL}.{name}.z"] = float(scales.z[i])
    return divisors


def motion_scales(
    history: History, recording: Recording, time: float, length: float, z: Floats
) -> MotionScales:
    """Scales of a motion: its own largest displacements and speeds.

    Parameters
    ----------
    history : History
        Rows of it.
    recording : Recording
        Its extremes.
    time, length : float
        Scales of the scene (s, m), the latter for bodies that never move.
    z : ndarray, shape (H,)
        Bounds of the hysteretic variables.
    """
    x = recording.displacement
    u = np.maximum(np.abs(x.maximum), np.abs(x.minimum))
    v = np.abs(history.v).max(axis=0)
    return MotionScales(time, np.where(u > 0.0, u, length), np.where(v > 0.0, v, length / time), z)


@dataclass(frozen=True)
class Truth:
    """What a run is held against.

    Parameters
    ----------
    values, bounds : mapping of str to float
        Peaks and final state by name (SI), and how far each may be off.
    divisors : mapping of str to float
        What the error of each is divided by (SI).
    recording : Recording
        The reference run, for its events.
    scales : MotionScales
        What differences of the motion are divided by.
    """

    values: Mapping[str, float]
    bounds: Mapping[str, float]
    divisors: Mapping[str, float]
    recording: Recording
    scales: MotionScales


def errors_of(
    scene: Scene, found: Recording, truth: Truth, rows: History, *, rests: bool = True
) -> Errors:
    """Errors of a run.

    Parameters
    ----------
    scene : Scene
        What moved.
    found : Recording
        The run.
    truth : Truth
        What it is held against.
    rows : History
        The reference at the times of the run's history.
    rests : bool
        Whether the method that ran knows contacts that rest.
    """
    scales = truth.scales
    speed = float(scales.v.max())
    stretch = (float(found.history.t[0]), min(found.t, truth.recording.t))
    known = rests and says_rests(found)
    return Errors(
        tuple(_quantities(scene, found, truth)),
        impact_errors(truth.recording.events, found.events, scales.time, speed, stretch),
        rest_errors(truth.recording.events, found.events, scales.time, stretch) if known else None,
        distance(rows, found.history, scales),
    )


def says_rests(found: Recording) -> bool:
    """Whether a run says when its contacts rest: it lists one, or knows how long they did."""
    listed = any(event.kind in (EventKind.REST, *ENDS_OF_REST) for event in found.events)
    return listed or not np.isnan(found.resting_time).any()


def _quantities(scene: Scene, found: Recording, truth: Truth) -> Iterator[Quantity]:
    values = values_of(scene, found)
    for name, reference in truth.values.items():
        yield Quantity(name, values[name], reference, truth.divisors[name], truth.bounds[name])
