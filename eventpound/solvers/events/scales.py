"""The scene's own scales, from which default tolerances and noise levels follow.

``L = L_e`` and ``T = 1/ω_g`` of the ground motion; without motion
``T = min sqrt(m/k)`` (or, without stiffness, a length over a speed) and L the
largest of |u_0|, |v_0| T, u_y and the gaps, or where forces act what they do in T. Each body
has a length and a speed of its own, at most L and L/T (`eventpound.solvers.events.own_scales`),
which its tolerances follow. A scaled scene has scaled tolerances, so it takes the same steps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eventpound.errors import InputError
from eventpound.mechanics.hysteresis import z_bound
from eventpound.mechanics.model import Model
from eventpound.motion.loaded import LoadedMotion
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import in_python
from eventpound.scene.scene import Scene
from eventpound.solvers.base import Task
from eventpound.solvers.events.own_scales import Start, attached, own_scales


@dataclass(frozen=True)
class SceneScales:
    """Length L (m), time T (s), mass (kg) and bounds of z of a scene.

    `own_length` (m), `own_speed` (m/s), shape (N,): those of each body.
    """

    length: float
    time: float
    mass: float
    z_bound: Floats
    own_length: Floats
    own_speed: Floats

    @property
    def speed(self) -> float:
        """L/T (m/s)."""
        return self.length / self.time

    @property
    def acceleration(self) -> float:
        """L/T² (m/s²)."""
        return self.length / self.time**2

    @property
    def force(self) -> float:
        """Force m L/T² (N)."""
        return self.mass * self.length / self.time**2

    @property
    def energy(self) -> float:
        """Energy m (L/T)² (J)."""
        return self.mass * self.speed**2


def scene_scales(scene: Scene, model: Model, duration: float) -> SceneScales:
    """Scales of a scene.

    Parameters
    ----------
    scene : Scene
        The scene.
    model : Model
        Its arrays.
    duration : float
        Length of the run (s), the last resort for a time scale.
    """
    law = model.law
    h = model.hysteretic
    bounds = np.array([in_python(z_bound)(law.exponent[i], law.beta[i], law.gamma[i]) for i in h])
    mass = float(model.mass[model.supports :].max())
    try:
        motion = scene.motion.scales()
    except InputError:
        # A record without any motion in the band of T_m has no scales of its own.
        motion = None
    if motion is not None:
        length, time = motion.length, 1.0 / motion.omega_g
    else:
        length, time = free_scales(model, duration)
    shaken = motion is not None
    if isinstance(scene.motion, LoadedMotion) and scene.motion.push > 0.0 and not shaken:
        length, time = _pushed_scales(model, duration, scene.motion.push)
        shaken = True
    start = Start(model.u0, model.v0, model.z0, h)
    own = own_scales(attached(model), model.mass, start, length, time, length / time**2, shaken)
    return SceneScales(length, time, mass, bounds, *own)


def free_scales(model: Model, duration: float) -> tuple[float, float]:
    """L (m) and T (s) of a scene without motion of the ground."""
    yielding = model.law.yield_displacement[model.hysteretic]
    lengths = np.concatenate((np.abs(model.u0), yielding, model.gap))
    length = float(lengths.max(initial=0.0))
    speed = float(np.abs(model.v0).max())
    time = _elastic_time(model)
    if not np.isfinite(time):
        time = length / speed if length > 0.0 and speed > 0.0 else duration
    length = max(length, speed * time)
    return length if length > 0.0 else 1.0, time


def _pushed_scales(model: Model, duration: float, push: float) -> tuple[float, float]:
    """L (m) and T (s) of a scene that forces alone move, the largest as an acceleration (m/s²).

    T is as without them; without springs the time in which they move a body by the largest
    length of the scene, or stop it.
    """
    length, time = free_scales(model, duration)
    if not np.isfinite(_elastic_time(model)):
        speed, given = float(np.abs(model.v0).max()), np.append(model.gap, np.abs(model.u0))
        room = float(given.max(initial=0.0))
        time = max(np.sqrt(room / push), speed / push) or duration
        length = max(room, speed * time)
    return max(length, push * time**2), time


def _elastic_time(model: Model) -> float:
    """Smallest sqrt(m/k) over the links, inf where nothing is stiff."""
    masses = np.append(model.mass, np.inf)
    smallest = np.inf
    for i, law in enumerate(model.elastic[: model.plain]):
        k = max(law.compression, law.extension)
        k += model.law.strength[i] / model.law.yield_displacement[i]
        if k > 0.0:
            smallest = min(smallest, np.sqrt(masses[model.link_ends[i]].min() / k))
    return float(smallest)


def body_tolerance(task: Task, kind: str, own: Floats) -> Floats:
    """Absolute tolerance of each body for a kind of which the task may say its own.

    `own`: the scales of the bodies, of that kind, of any shape.
    """
    return np.full(own.shape, task.atol[kind]) if kind in task.atol else task.rtol * own


def tolerances(task: Task, scales: SceneScales) -> dict[str, Floats | float]:
    """Absolute tolerances: of displacement (m) and velocity (m/s) of each body, z, energy (J)."""
    atol = task.atol
    return {
        "displacement": body_tolerance(task, "displacement", scales.own_length),
        "velocity": body_tolerance(task, "velocity", scales.own_speed),
        "z": (
            np.full(scales.z_bound.size, atol["z"]) if "z" in atol else task.rtol * scales.z_bound
        ),
        "energy": task.rtol * scales.energy,
    }
