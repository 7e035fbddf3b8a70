"""The scene's own scales, from which default tolerances and noise levels follow.

``L = L_e`` and ``T = 1/ω_g`` of the ground motion; without motion
``T = min sqrt(m/k)`` (or, without stiffness, a length over a speed) and L the
largest of |u_0|, |v_0| T, u_y and the gaps. A scaled scene has scaled
tolerances, so it takes the same steps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eventpound.errors import InputError
from eventpound.mechanics.hysteresis import z_bound
from eventpound.mechanics.model import Model
from eventpound.mechanics.reduced import Reduced
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import in_python
from eventpound.scene.scene import Scene
from eventpound.solvers.base import Task


@dataclass(frozen=True)
class SceneScales:
    """Length L (m), time T (s), mass (kg) and bounds of z of a scene."""

    length: float
    time: float
    mass: float
    z_bound: Floats

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
    mass = float(model.mass.max())
    try:
        motion = scene.motion.scales()
    except InputError:
        # A record without any motion in the band of T_m has no scales of its own.
        motion = None
    if motion is not None:
        return SceneScales(motion.length, 1.0 / motion.omega_g, mass, bounds)
    lengths = np.concatenate((np.abs(model.u0), law.yield_displacement[h], model.gap))
    length = float(lengths.max(initial=0.0))
    speed = float(np.abs(model.v0).max())
    time = _elastic_time(model)
    if not np.isfinite(time):
        time = length / speed if length > 0.0 and speed > 0.0 else duration
    length = max(length, speed * time)
    return SceneScales(length if length > 0.0 else 1.0, time, mass, bounds)


def _elastic_time(model: Model) -> float:
    """Smallest sqrt(m/k) over the links, inf where nothing is stiff."""
    masses = np.append(model.mass, np.inf)
    smallest = np.inf
    for i, law in enumerate(model.elastic):
        k = max(law.compression, law.extension)
        k += model.law.strength[i] / model.law.yield_displacement[i]
        if k > 0.0:
            smallest = min(smallest, np.sqrt(masses[model.link_ends[i]].min() / k))
    return float(smallest)


def tolerances(task: Task, scales: SceneScales) -> dict[str, Floats | float]:
    """Absolute tolerances: of displacement (m), velocity (m/s), each z, and energy (J)."""
    atol = task.atol
    return {
        "displacement": atol.get("displacement", task.rtol * scales.length),
        "velocity": atol.get("velocity", task.rtol * scales.speed),
        "z": (
            np.full(scales.z_bound.size, atol["z"]) if "z" in atol else task.rtol * scales.z_bound
        ),
        "energy": task.rtol * scales.energy,
    }


def state_tolerances(system: Reduced, atol: dict[str, Floats | float]) -> Floats:
    """Absolute tolerance of each entry of a mode's state vector, shape (size,)."""
    weights = np.empty(system.size)
    weights[system.iq] = atol["displacement"]
    weights[system.iv] = atol["velocity"]
    active = system.z_of >= 0
    weights[system.z_of[active]] = np.asarray(atol["z"])[active]
    if system.ledger >= 0:
        weights[system.ledger :] = atol["energy"]
    return weights
