"""The scene's own scales, from which default tolerances and noise levels follow.

``L = L_e`` and ``T = 1/ω_g`` of the ground motion; without motion
``T = min sqrt(m/k)`` (or, without stiffness, a length over a speed) and L the
largest of |u_0|, |v_0| T, u_y and the gaps, or where forces act what they do in T.

A stiff body beside a soft one moves by a small part of L, and an error of a part of L would
be all of its motion, and a multiple of its forces. So a body has a length and a speed of its
own, at most L and L/T, which its tolerances follow. They come from what its springs make of
`SPARE` times the load m a of its own mass, a = L/T²: the displacement x_s at which they
carry it, yielded where it yields them, and the speed sqrt(SPARE a x_s) of a vibration of
that size, or that at which its dashpots carry it. Where the ground stands still the energy
E at the start limits both: ``x² <= 2 E / k``, ``v² <= 2 E / m``.

A scaled scene has scaled scales and tolerances, so it takes the same steps. Arrays may have
leading axes, of many variants of a scene; each variant has to the last bit what it has alone,
so nothing is summed but link by link.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from eventpound.mechanics.link_law import LinkLaw, memory_force, yielding, z_bound
from eventpound.mechanics.model import Model
from eventpound.mechanics.supported import peak_of
from eventpound.motion.base import GroundMotion
from eventpound.motion.loaded import LoadedMotion
from eventpound.numerics.arrays import Floats, Ints
from eventpound.scene.scene import Scene
from eventpound.solvers.base import Task

SPARE = 3.0
"""Multiple of a body's static response to which it is taken to move: about the largest
amplification of an undamped body by a pulse of one period."""


class Attached(NamedTuple):
    """Links of a scene: ends (L, 2), and laws, stiffnesses and offsets (..., L) in SI.

    weights (D, N): of its points (`Model.weights`).
    """

    ends: Ints
    law: LinkLaw
    compression: Floats
    extension: Floats
    offset: Floats
    weights: Floats


class InitialState(NamedTuple):
    """Displacement and velocity (..., N) and z (..., H) of the links `hysteretic` at the start."""

    u: Floats
    v: Floats
    z: Floats
    hysteretic: Ints


class _LinkSums(NamedTuple):
    """What the links of each body add up to, shape (..., N).

    Stiffness before and after yielding (N/m), force of memory (N), dashpots (N s/m), and the
    energy at which its springs yield (J).
    """

    stiffness: Floats
    yielded: Floats
    force: Floats
    damping: Floats
    yield_energy: Floats


def attached(model: Model) -> Attached:
    """Links of an assembled scene, without contact elements: they hold bodies in passing."""
    law = model.law
    if model.plain < model.links:
        law = LinkLaw(*(column[: model.plain] for column in law))
    return Attached(
        model.link_ends[: model.plain], law, *model.elastic.first(model.plain), model.weights
    )


def own_scales(
    links: Attached,
    mass: Floats,
    start: InitialState,
    length: Any,
    time: Any,
    acceleration: Any,
    shaken: Any,
) -> tuple[Floats, Floats]:
    """Length (m) and speed (m/s) of each body, shape (..., N) each; of a point the least of its.

    Parameters
    ----------
    links : Attached
        What holds the bodies.
    mass : ndarray, shape (..., N)
        Masses (kg).
    start : InitialState
        The state at the start.
    length, time, acceleration : float or ndarray, shape (...)
        L, T and L/T² of the scene (SI).
    shaken : bool or ndarray, shape (...)
        Whether the scene has the scales of a ground motion.
    """
    held = _held(links, mass)
    length, time, acceleration, shaken = (
        np.asarray(x)[..., None] for x in (length, time, acceleration, shaken)
    )
    speed = length / time
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        load = SPARE * mass * acceleration
        reach = _reach(load, held)
        swift = np.minimum(
            np.sqrt(SPARE * acceleration * reach),
            np.where(held.damping > 0.0, load / held.damping, np.inf),
        )
        if not shaken.all():
            energy = _energy(links, mass, start)[..., None]
            moving = energy > 0.0
            free_reach = np.where(moving, _swing(energy, held), np.inf)
            own = moving & np.isfinite(mass)
            free_swift = np.where(own, np.sqrt(2.0 * energy / mass), np.inf)
            reach, swift = np.where(shaken, reach, free_reach), np.where(shaken, swift, free_swift)
    lengths, speeds = np.minimum(length, reach), np.minimum(speed, swift)
    for d, weights in enumerate(links.weights, mass.shape[-1] - links.weights.shape[0]):
        for sizes in (lengths, speeds):
            sizes[..., d] = sizes[..., weights != 0.0].min(axis=-1)
    return lengths, speeds


def _held(links: Attached, mass: Floats) -> _LinkSums:
    """What holds each body, were its neighbours held."""
    memory = yielding(links.law.memory)
    # As stiff as the link gets: a stop or a cable holds on one side alone.
    after = np.maximum(links.compression, links.extension)
    energy = 0.5 * memory.force * memory.displacement
    of_link = (after + memory.stiffness, after, memory.force, links.law.damping, energy)
    held = np.zeros((len(of_link), *mass.shape))
    each = np.empty((len(of_link), *of_link[0].shape))
    each[:] = of_link
    bodies = mass.shape[-1] - links.weights.shape[0]
    for i, ends in enumerate(links.ends.tolist()):
        for b in ends:
            if b >= bodies:
                _add_at_point(each[..., i], links.weights[b - bodies], held)
            elif b >= 0:
                held[..., b] += each[..., i]
    return _LinkSums(*held)


def _add_at_point(each: Floats, weights: Floats, held: Floats) -> None:
    """Add what a link at a point does to its bodies, `each` of `_LinkSums`, to `held`."""
    for b in np.flatnonzero(weights):
        # Of the point's displacement, and of the force there, a body has a part w each.
        w = abs(weights[b])
        parts = np.array([w * w, w * w, w, w * w, 1.0])
        held[..., b] += parts.reshape(-1, *(1,) * (each.ndim - 1)) * each


def _reach(load: Floats, held: _LinkSums) -> Floats:
    """Displacement at which the springs carry a load, inf where they cannot (m)."""
    elastic = np.where(held.stiffness > 0.0, load / held.stiffness, np.inf)
    beyond = np.maximum(load - held.force, 0.0)
    yielded = np.where(
        beyond > 0.0, np.where(held.yielded > 0.0, beyond / held.yielded, np.inf), 0.0
    )
    return np.asarray(np.maximum(elastic, yielded))


def _swing(energy: Floats, held: _LinkSums) -> Floats:
    """Displacement at which the springs have taken up an energy, inf where they cannot (m)."""
    k = np.where(energy > held.yield_energy, held.yielded, held.stiffness)
    return np.asarray(np.where(k > 0.0, np.sqrt(2.0 * energy / k), np.inf))


def _energy(links: Attached, mass: Floats, start: InitialState) -> Floats:
    """Energy at the start (J), shape (...)."""
    total = np.zeros(mass.shape[:-1])
    # That of supports, whose mass is inf, is none.
    mass = np.where(np.isinf(mass), 0.0, mass)
    for b in range(mass.shape[-1]):
        total = total + 0.5 * mass[..., b] * start.v[..., b] * start.v[..., b]
    for i, (first, second) in enumerate(links.ends.tolist()):
        near = start.u[..., first] if first >= 0 else 0.0
        far = start.u[..., second] if second >= 0 else 0.0
        x = far - near - links.offset[..., i]
        k = np.where(x < 0.0, links.compression[..., i], links.extension[..., i])
        total = total + 0.5 * k * x * x
    memory = yielding(links.law.memory)
    for h, i in enumerate(start.hysteretic.tolist()):
        pull = memory_force(links.law.memory[..., i, :], start.z[..., h])
        total = total + memory.displacement[..., i] * np.abs(pull)
    return np.asarray(total)


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
        The scene; of its numbers only those of the motion count.
    model : Model
        Its arrays.
    duration : float
        Length of the run (s), the last resort for a time scale.
    """
    return scales_by(*scale_units(scene.motion, model, duration), model)


def scale_units(motion: GroundMotion, model: Model, duration: float) -> tuple[float, float, bool]:
    """L (m) and T (s) of a scene, and whether they are those of what shakes it."""
    own = motion.scales()
    if own is not None:
        return own.length, 1.0 / own.omega_g, True
    push = push_of(motion)
    return *scales_without(model, duration, push), push > 0.0


def scales_by(length: float, time: float, shaken: bool, model: Model) -> SceneScales:
    """Scales of a scene whose own are known; gaps do not count any more."""
    start = InitialState(model.u0, model.v0, model.z0, model.hysteretic)
    own = own_scales(attached(model), model.mass, start, length, time, length / time**2, shaken)
    mass = float(model.mass[model.supports :].max())
    return SceneScales(length, time, mass, z_bound(model.law.memory[model.hysteretic]), *own)


def _free_scales(model: Model, duration: float) -> tuple[float, float]:
    """L (m), zero where nothing gives one, and T (s) of a scene without motion of the ground."""
    yields = yielding(model.law.memory[model.hysteretic]).displacement
    lengths = np.concatenate((np.abs(model.u0), yields, model.gap))
    length = float(lengths.max(initial=0.0))
    speed = float(np.abs(model.v0).max())
    time = _elastic_time(model)
    if not np.isfinite(time):
        time = length / speed if length > 0.0 and speed > 0.0 else duration
    return max(length, speed * time), time


def push_of(motion: GroundMotion) -> float:
    """Largest acceleration that what moves a scene gives a body, where it has no scales (m/s²)."""
    return motion.push if isinstance(motion, LoadedMotion) else peak_of(motion)


def scales_without(model: Model, duration: float, push: float) -> tuple[float, float]:
    """L (m) and T (s) of a scene whose motion has no scales, but moves it by a `push` (m/s²).

    T is as without that; without springs the time in which it moves a body by the largest
    length of the scene, or stops it.
    """
    length, time = _free_scales(model, duration)
    if push > 0.0 and not np.isfinite(_elastic_time(model)):
        speed, given = float(np.abs(model.v0).max()), np.append(model.gap, np.abs(model.u0))
        widest = float(given.max(initial=0.0))
        time = max(np.sqrt(widest / push), speed / push) or duration
        length = max(widest, speed * time)
    length = max(length, push * time**2)
    return length if length > 0.0 else 1.0, time


def _elastic_time(model: Model) -> float:
    """Smallest sqrt(m/k) over the links, inf where nothing is stiff."""
    masses = np.append(model.felt_mass, np.inf)
    smallest, memory = np.inf, yielding(model.law.memory).stiffness
    for i in range(model.plain):
        k = max(model.elastic.compression[i], model.elastic.extension[i])
        k += memory[i]
        if k > 0.0:
            smallest = min(smallest, np.sqrt(masses[model.link_ends[i]].min() / k))
    return float(smallest)


def body_tolerance(task: Task, kind: str, own: Floats) -> Floats:
    """Absolute tolerance of each body for a kind of which the task may say its own.

    `own`: the scales of the bodies, of that kind, of any shape.
    """
    return np.full(own.shape, task.atol[kind]) if kind in task.atol else task.rtol * own


def z_size(bound: Floats) -> Floats:
    """Scales of z (..., H): their bounds, 1 of those that have none."""
    return np.where(np.isinf(bound), 1.0, bound)


def z_tolerance(task: Task, bound: Floats) -> Floats:
    """Absolute tolerances of z with such bounds (..., H)."""
    if "z" in task.atol:
        return np.full(bound.shape, task.atol["z"])
    return np.asarray(task.rtol * z_size(bound))


def tolerances(task: Task, scales: SceneScales) -> dict[str, Floats | float]:
    """Absolute tolerances: of displacement (m) and velocity (m/s) of each body, z, energy (J)."""
    return {
        "displacement": body_tolerance(task, "displacement", scales.own_length),
        "velocity": body_tolerance(task, "velocity", scales.own_speed),
        "z": z_tolerance(task, scales.z_bound),
        "energy": task.rtol * scales.energy,
    }
