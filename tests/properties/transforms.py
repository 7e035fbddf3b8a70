"""Scenes seen otherwise: by another observer, in other units, in another order, beside others.

Each transformation returns the other scene and the `View` by which its answer is
translated back into the terms of the first one.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from eventpound.motion.free import NoMotion
from eventpound.motion.record import Record
from eventpound.scene import (
    BARRIER,
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Linear,
    Scene,
    Series,
    Spring,
)

Law = Linear | BilinearElastic | Series | BoucWen


@dataclass(frozen=True)
class View:
    """How another scene shows the things of the first one.

    Parameters
    ----------
    bodies, springs, loops, contacts : ndarray of int
        Where each body, spring, z and contact of the first scene stands in the other.
    turned : ndarray of float, shape (S,)
        -1 for springs whose elongation counts the other way.
    hysteretic : ndarray of int, shape (H,)
        Springs of the first scene that carry each z.
    sign : float
        -1 where the other scene is the mirror image.
    length, time, mass : float
        Units of the other scene: what is 1 in the first is this much there.
    """

    bodies: np.ndarray
    springs: np.ndarray
    loops: np.ndarray
    contacts: np.ndarray
    turned: np.ndarray
    hysteretic: np.ndarray
    sign: float = 1.0
    length: float = 1.0
    time: float = 1.0
    mass: float = 1.0

    @property
    def loop_signs(self) -> np.ndarray:
        """-1 for each z whose spring counts the other way, shape (H,)."""
        return self.turned[self.hysteretic]


Seen = tuple[Scene, View]


def loops(scene: Scene) -> np.ndarray:
    """Springs with a z, in its order, shape (H,)."""
    return np.array([i for i, s in enumerate(scene.springs) if isinstance(s.law, BoucWen)], int)


def same(scene: Scene) -> View:
    """The view of a scene that begins with the same things in the same order."""
    springs = len(scene.springs)
    return View(
        np.arange(len(scene.bodies)),
        np.arange(springs),
        np.arange(len(loops(scene))),
        np.arange(len(scene.contacts)),
        np.ones(springs),
        loops(scene),
    )


def turned(law: Law) -> Law:
    """The law of a spring whose elongation counts the other way: ``F'(x) = -F(-x)``."""
    if isinstance(law, BilinearElastic):
        return BilinearElastic(law.extension, law.compression, -law.offset)
    if isinstance(law, Series):
        return Series(tuple(turned(part) for part in law.parts))
    if isinstance(law, BoucWen):
        return replace(law, initial_z=-law.initial_z)
    return law


def mirrored(scene: Scene) -> Seen:
    """The scene seen from the other side: u -> -u."""
    motion: Any = scene.motion
    if not isinstance(motion, NoMotion):
        motion = replace(motion, reverse=not motion.reverse)
    other = Scene(
        tuple(replace(b, displacement=-b.displacement, velocity=-b.velocity) for b in scene.bodies),
        tuple(replace(s, law=turned(s.law)) for s in scene.springs),
        scene.dashpots,
        tuple(replace(c, left=c.right, right=c.left) for c in scene.contacts),
        motion,
    )
    return other, replace(same(scene), sign=-1.0)


def scaled(scene: Scene, length: float, time: float, mass: float) -> Seen:
    """The scene in other units of length, time and mass."""
    speed, force = length / time, mass * length / time**2
    k = force / length

    def law(of: Law) -> Law:
        if isinstance(of, Linear):
            return Linear(of.stiffness * k)
        if isinstance(of, BilinearElastic):
            return BilinearElastic(of.compression * k, of.extension * k, of.offset * length)
        if isinstance(of, Series):
            return Series(tuple(law(part) for part in of.parts))
        return replace(
            of,
            stiffness=of.stiffness * k,
            strength=of.strength * force,
            yield_displacement=of.yield_displacement * length,
        )

    other = Scene(
        tuple(
            Body(b.name, b.mass * mass, b.displacement * length, b.velocity * speed)
            for b in scene.bodies
        ),
        tuple(replace(s, law=law(s.law)) for s in scene.springs),
        tuple(replace(d, coefficient=d.coefficient * mass / time) for d in scene.dashpots),
        tuple(replace(c, gap=c.gap * length) for c in scene.contacts),
        _scaled_motion(scene.motion, length / time**2, time),
    )
    return other, replace(same(scene), length=length, time=time, mass=mass)


def _scaled_motion(motion: Any, acceleration: float, time: float) -> Any:
    if isinstance(motion, NoMotion):
        return motion
    changes = {"start": motion.start * time}
    if isinstance(motion, Record):
        changes |= {"samples": motion.samples * acceleration, "time_step": motion.time_step * time}
        if motion.pga is not None:
            changes["pga"] = motion.pga * acceleration
        return replace(motion, **changes)
    if getattr(motion, "center", None) is not None:
        changes["center"] = motion.center * time
    return replace(
        motion, amplitude=motion.amplitude * acceleration, period=motion.period * time, **changes
    )


def reordered(scene: Scene, rng: np.random.Generator) -> Seen:
    """The same things listed in another order, some springs and dashpots by the other end."""
    bodies, springs, dashpots, contacts = (
        rng.permutation(len(things))
        for things in (scene.bodies, scene.springs, scene.dashpots, scene.contacts)
    )
    flips = rng.random(springs.size) < 0.5

    def spring(i: int) -> Spring:
        s = scene.springs[i]
        return replace(s, between=s.between[::-1], law=turned(s.law)) if flips[i] else s

    def dashpot(i: int) -> Any:
        d = scene.dashpots[i]
        return replace(d, between=d.between[::-1]) if rng.random() < 0.5 else d

    other = Scene(
        tuple(scene.bodies[i] for i in bodies),
        tuple(spring(i) for i in springs),
        tuple(dashpot(i) for i in dashpots),
        tuple(scene.contacts[i] for i in contacts),
        scene.motion,
    )
    order = [scene.springs[i].name for i in loops(scene)]
    there = [other.springs[i].name for i in loops(other)]
    return other, View(
        np.argsort(bodies),
        np.argsort(springs),
        np.array([there.index(name) for name in order], int),
        np.argsort(contacts),
        np.where(flips, -1.0, 1.0),
        loops(scene),
    )


def with_far_bodies(scene: Scene, rng: np.random.Generator, speed: float, time: float) -> Seen:
    """The scene beside a pair of bodies that swing on a spring between them.

    They move no further and no faster than the scene's own scales, which stay what they are.
    """
    mass = scene.bodies[0].mass
    u1, v1, u2, v2 = np.clip(rng.normal(size=4), -1.0, 1.0)
    others = (
        Body("far one", mass, u1 * speed * time, v1 * speed),
        Body("far two", 0.7 * mass, u2 * speed * time, v2 * speed),
    )
    k = mass / time**2 * rng.uniform(0.07, 0.7)
    spring = Spring("far spring", ("far one", "far two"), Linear(k))
    other = replace(scene, bodies=(*scene.bodies, *others), springs=(*scene.springs, spring))
    return other, same(scene)


def with_far_contacts(scene: Scene, far: float) -> Seen:
    """The scene with barriers that its outer bodies never reach (gap `far`, m)."""
    others = (
        Contact("far left", BARRIER, scene.bodies[0].name, far, 0.5),
        Contact("far right", scene.bodies[-1].name, BARRIER, far, 0.5),
    )
    return replace(scene, contacts=(*scene.contacts, *others)), same(scene)


def free_row(scene: Scene) -> Scene:
    """The scene without anything that holds it to the ground."""
    return replace(
        scene,
        springs=tuple(s for s in scene.springs if GROUND not in s.between),
        dashpots=tuple(d for d in scene.dashpots if GROUND not in d.between),
        contacts=tuple(c for c in scene.contacts if BARRIER not in (c.left, c.right)),
    )


def from_state(scene: Scene, u: np.ndarray, v: np.ndarray, z: np.ndarray, rounding: float) -> Scene:
    """The scene with a state of its bodies and springs as the initial one.

    A gap that is closed to `rounding` (m), which refers to the scene and not to a body that
    happens to be near the origin, is made so wide that nothing penetrates.
    """
    bodies = tuple(
        replace(b, displacement=float(x), velocity=float(y))
        for b, x, y in zip(scene.bodies, u, v, strict=True)
    )
    values = iter(z)
    springs = tuple(
        replace(s, law=replace(s.law, initial_z=float(next(values))))
        if isinstance(s.law, BoucWen)
        else s
        for s in scene.springs
    )
    place = {body.name: body.displacement for body in bodies} | {BARRIER: 0.0}
    openings = [c.gap + place[c.right] - place[c.left] for c in scene.contacts]
    contacts = tuple(
        replace(c, gap=c.gap - opening) if -rounding <= opening < 0.0 else c
        for c, opening in zip(scene.contacts, openings, strict=True)
    )
    return replace(scene, bodies=bodies, springs=springs, contacts=contacts)


def shifted(scene: Scene, by: float) -> Scene:
    """The scene whose ground moves the same, `by` seconds earlier."""
    motion: Any = scene.motion
    if isinstance(motion, NoMotion):
        return scene
    changes = {"start": motion.start - by}
    if getattr(motion, "center", None) is not None:
        changes["center"] = motion.center - by
    return replace(scene, motion=replace(motion, **changes))
