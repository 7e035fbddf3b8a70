"""Scenes that pound, yield and rest, and copies of them seen otherwise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from eventpound.motion.ricker import Ricker
from eventpound.scene import (
    BARRIER,
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Linear,
    Scene,
    Spring,
)
from eventpound.solvers import solver_named
from eventpound.solvers.base import Recording, Task


def pounding_pair() -> Scene:
    """Two yielding decks, a slack cable between them, barriers on both sides (6 s)."""
    return Scene(
        bodies=(Body("a", 1.2, 0.01, 0.05), Body("b", 3.0, -0.02, 0.0)),
        springs=(
            Spring("frame a", (GROUND, "a"), BoucWen(20.0, 4.0, 0.03, 20.0)),
            Spring("frame b", (GROUND, "b"), BoucWen(90.0, 6.0, 0.02, 2.0, 0.3, 0.7, 0.1)),
            Spring("cable", ("a", "b"), BilinearElastic(0.0, 60.0, 0.015)),
        ),
        dashpots=(Dashpot((GROUND, "a"), 0.3), Dashpot(("a", "b"), 0.1)),
        contacts=(
            Contact("left", BARRIER, "a", 0.06, 0.4),
            Contact("joint", "a", "b", 0.04, 0.7),
            Contact("right", "b", BARRIER, 0.05, 0.5),
        ),
        motion=Ricker(5.0, 1.1, center=1.3),
    )


def run(
    scene: Scene,
    rtol: float,
    end: float = 6.0,
    start: float = 0.0,
    *,
    solver: str,
    energy: bool = False,
) -> Recording:
    """The recording of a run without samples in between."""
    return solver_named(solver).solve(Task(scene, start, end, rtol, energy=energy))


def scaled(scene: Scene, length: float, time: float, mass: float) -> Scene:
    """The scene in other units of length, time and mass."""
    speed, force = length / time, mass * length / time**2

    def law(of: Linear | BilinearElastic | BoucWen) -> Linear | BilinearElastic | BoucWen:
        k = force / length
        if isinstance(of, Linear):
            return Linear(of.stiffness * k)
        if isinstance(of, BilinearElastic):
            return BilinearElastic(of.compression * k, of.extension * k, of.offset * length)
        return replace(
            of,
            stiffness=of.stiffness * k,
            strength=of.strength * force,
            yield_displacement=of.yield_displacement * length,
        )

    pulse = scene.motion
    assert isinstance(pulse, Ricker)
    return Scene(
        tuple(
            Body(b.name, b.mass * mass, b.displacement * length, b.velocity * speed)
            for b in scene.bodies
        ),
        tuple(replace(s, law=law(s.law)) for s in scene.springs),
        tuple(replace(d, coefficient=d.coefficient * mass / time) for d in scene.dashpots),
        tuple(replace(c, gap=c.gap * length) for c in scene.contacts),
        Ricker(pulse.amplitude * length / time**2, pulse.period * time, center=pulse.center * time),
    )


def mirrored(scene: Scene) -> Scene:
    """The scene seen from the other side: u -> -u."""

    def law(of: Linear | BilinearElastic | BoucWen) -> Linear | BilinearElastic | BoucWen:
        if isinstance(of, BilinearElastic):
            return BilinearElastic(of.extension, of.compression, -of.offset)
        if isinstance(of, BoucWen):
            return replace(of, initial_z=-of.initial_z)
        return of

    pulse = scene.motion
    assert isinstance(pulse, Ricker)
    return Scene(
        tuple(replace(b, displacement=-b.displacement, velocity=-b.velocity) for b in scene.bodies),
        tuple(replace(s, law=law(s.law)) for s in scene.springs),
        scene.dashpots,
        tuple(replace(c, left=c.right, right=c.left) for c in scene.contacts),
        replace(pulse, reverse=True),
    )


def reordered(scene: Scene, rng: np.random.Generator) -> Scene:
    """The same things listed in another order, springs and dashpots by the other end."""

    def shuffled(things: tuple) -> tuple:
        return tuple(things[i] for i in rng.permutation(len(things)))

    return replace(
        scene,
        bodies=shuffled(scene.bodies),
        springs=shuffled(scene.springs),
        dashpots=shuffled(tuple(replace(d, between=d.between[::-1]) for d in scene.dashpots)),
        contacts=shuffled(scene.contacts),
    )


def from_state(scene: Scene, recording: Recording) -> Scene:
    """The scene with the final state of a run as its initial one."""
    bodies = tuple(
        replace(b, displacement=float(u), velocity=float(v))
        for b, u, v in zip(scene.bodies, recording.u, recording.v, strict=True)
    )
    z = iter(recording.z)
    springs = tuple(
        replace(s, law=replace(s.law, initial_z=float(next(z))))
        if isinstance(s.law, BoucWen)
        else s
        for s in scene.springs
    )
    return replace(scene, bodies=bodies, springs=springs)
