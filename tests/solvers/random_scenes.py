"""Scenes drawn at random: whatever a scene may hold, in every combination."""

from dataclasses import fields, replace
from itertools import pairwise
from typing import Any

import numpy as np

from eventpound.motion.constant import Constant, PhasedSine
from eventpound.motion.free import NoMotion
from eventpound.motion.harmonic import Harmonic
from eventpound.motion.mavroeidis_papageorgiou import MavroeidisPapageorgiou
from eventpound.motion.pulses import Cosine, Sine, TypeC
from eventpound.motion.record import Record
from eventpound.motion.ricker import AntisymmetricRicker, Ricker
from eventpound.scene import (
    BARRIER,
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Force,
    Linear,
    Point,
    Scene,
    Series,
    Spring,
    Support,
)
from eventpound.scene.check import check_scene
from eventpound.scene.linkage import starts_of_supports

EXPONENTS = (1.0, 1.5, 2.0, 5.0, 20.0, 50.0)
SHAPES = ((0.5, 0.5), (0.1, 0.9), (0.9, 0.1), (-0.2, 0.8), (1.0, 1.0))
"""β and γ of the Bouc–Wen law."""
PULSES = (Sine, Cosine, TypeC, Ricker, AntisymmetricRicker, MavroeidisPapageorgiou, Harmonic)
FORCES = {"friction", "initial_stiffness", "stiffness", "strength", "ultimate_force"}
"""Fields of laws with a memory that its forces are proportional to."""
RESTITUTION = (0.0, 0.0, 0.3, 0.5, 0.8, 1.0)

Law = Linear | BilinearElastic | Series | BoucWen


def random_scene(seed: int) -> tuple[Scene, float]:
    """A scene with one to six bodies in a row, and the length of its run (s).

    Parameters
    ----------
    seed : int
        The same scene for the same seed.
    """
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 7))
    strength, period = rng.uniform(1.0, 5.0), rng.uniform(0.4, 2.0)
    motion = _motion(rng, strength, period)
    length = strength * (period / (2.0 * np.pi)) ** 2
    bodies = _bodies(rng, count, length, length / period)
    springs, dashpots = _links(rng, bodies, strength, length)
    contacts = _contacts(rng, bodies, length)
    scene = Scene(bodies, tuple(springs), tuple(dashpots), contacts, motion)
    check_scene(scene)
    return scene, float(rng.uniform(2.0, 5.0) * period)


def _motion(rng: np.random.Generator, amplitude: float, period: float) -> Any:
    kind = rng.integers(0, len(PULSES) + 3)
    if kind < len(PULSES):
        return PULSES[kind](amplitude, period, reverse=bool(rng.integers(0, 2)))
    if kind == len(PULSES):
        return NoMotion()
    dt = period / rng.choice([7.0, 40.0, 100.0])
    t = dt * np.arange(int(3.0 * period / dt) + 2)
    samples = sum(
        rng.normal() * np.sin(2.0 * np.pi * t * rng.uniform(0.5, 3.0) / period + rng.uniform(0, 6))
        for _ in range(4)
    )
    return Record(samples, dt, pga=amplitude)


def _bodies(rng: np.random.Generator, count: int, length: float, speed: float) -> tuple[Body, ...]:
    moving = rng.random() < 0.5
    return tuple(
        Body(
            f"b{i}",
            10.0 ** rng.uniform(-0.7, 0.7),
            rng.normal() * length * 0.3 if moving else 0.0,
            rng.normal() * speed if moving or rng.random() < 0.1 else 0.0,
        )
        for i in range(count)
    )


def _law(rng: np.random.Generator, mass: float, strength: float, length: float) -> Law:
    k = mass * strength / length * 10.0 ** rng.uniform(-1.0, 1.0)
    kind = rng.integers(0, 7)
    if kind == 0:
        return Linear(k)
    if kind == 1:
        return BilinearElastic(*_two(rng, k), float(rng.choice([0.0, length * rng.normal()])))
    if kind == 2:
        parts = (Linear(k), BilinearElastic(k * rng.uniform(0.1, 3.0), k, length * rng.normal()))
        return Series(parts)
    beta, gamma = SHAPES[rng.integers(0, len(SHAPES))]
    if rng.random() < 0.3:
        beta = rng.uniform(-0.5, 1.0)
        gamma = rng.uniform(0.2, 1.0) + max(0.0, -beta)
    n = float(rng.choice(EXPONENTS))
    force = mass * strength * rng.uniform(0.1, 1.0)
    u_y = length * 10.0 ** rng.uniform(-2.0, 0.0)
    bound = (beta + gamma) ** (-1.0 / n)
    z = float(rng.choice([0.0, bound * rng.uniform(-1.0, 1.0)]))
    return BoucWen(rng.choice([0.0, 0.1]) * force / u_y, force, u_y, n, beta, gamma, z)


def _two(rng: np.random.Generator, k: float) -> tuple[float, float]:
    return (k, 0.0) if rng.random() < 0.3 else (k * rng.uniform(0.0, 2.0), k)


def _links(
    rng: np.random.Generator, bodies: tuple[Body, ...], strength: float, length: float
) -> tuple[list[Spring], list[Dashpot]]:
    springs, dashpots = [], []
    ends = [(GROUND, body.name) for body in bodies if rng.random() < 0.9]
    ends += [(a.name, b.name) for a, b in pairwise(bodies) if rng.random() < 0.4]
    masses = {body.name: body.mass for body in bodies}
    for i, pair in enumerate(ends):
        if rng.random() < 0.3:
            pair = pair[::-1]
        mass = min(masses.get(end, np.inf) for end in pair)
        springs.append(Spring(f"s{i}", pair, _law(rng, mass, strength, length)))
        if rng.random() < 0.4:
            c = 0.1 * rng.random() * mass * np.sqrt(strength / length)
            dashpots.append(Dashpot(pair, c))
    return springs, dashpots


def _contacts(
    rng: np.random.Generator, bodies: tuple[Body, ...], length: float
) -> tuple[Contact, ...]:
    names = [BARRIER, *(body.name for body in bodies), BARRIER]
    u = {body.name: body.displacement for body in bodies} | {BARRIER: 0.0}
    contacts = []
    closed = rng.random() < 0.2
    for i, (a, b) in enumerate(pairwise(names)):
        if rng.random() < 0.25:
            continue
        opening = 0.0 if closed or rng.random() < 0.1 else length * rng.uniform(0.0, 1.5)
        contacts.append(
            Contact(f"c{i}", a, b, u[a] - u[b] + opening, float(rng.choice(RESTITUTION)))
        )
    return tuple(contacts)


def pointed_scene(seed: int) -> tuple[Scene, float]:
    """A scene of `random_scene` with one to three contacts at points, and its end (s).

    Points are on two bodies, or on one and the ground; half of the contacts of the row stay.
    """
    number = 7919 * (seed + 1)
    while len(random_scene(number)[0].bodies) < 3:
        number += 1
    scene, end = random_scene(number)
    rng = np.random.default_rng([seed, 58])
    u = {body.name: body.displacement for body in scene.bodies} | {GROUND: 0.0}
    size = (
        max((abs(c.gap) for c in scene.contacts), default=0.0) or max(map(abs, u.values())) or 0.1
    )
    contacts = [c for c in scene.contacts if rng.random() < 0.5]
    for i in range(int(rng.integers(1, 4))):
        striking, *on = rng.permutation([body.name for body in scene.bodies])[:3].tolist()
        if rng.random() < 0.3:
            on[0] = GROUND
        weight = float(rng.uniform(0.1, 0.9))
        point = Point({on[0]: weight, on[1]: 1.0 - weight})
        apart = weight * u[on[0]] + (1.0 - weight) * u[on[1]] - u[striking]
        opening = 0.0 if rng.random() < 0.2 else size * float(rng.uniform(0.0, 1.0))
        ends, sign = ((striking, point), 1.0) if rng.random() < 0.5 else ((point, striking), -1.0)
        gap = opening - sign * apart + 1e-15
        contacts.append(Contact(f"p{i}", *ends, gap, _plastic(rng)))
    scene = replace(scene, contacts=tuple(contacts))
    check_scene(scene)
    return scene, end


def driven_scene(seed: int) -> tuple[Scene, float]:
    """A scene of `random_scene` on one or two supports, with forces on some bodies."""
    scene, end = random_scene(seed)
    rng = np.random.default_rng([seed, 22])
    scales = scene.motion.scales()
    strength = scales.a_g if scales else rng.uniform(1.0, 5.0)
    period = scales.period if scales else rng.uniform(0.4, 2.0)
    supports = tuple(
        _support(rng, f"p{i}", strength, period) for i in range(int(rng.integers(0, 3)))
    )
    forces = tuple(
        Force(body.name, _history(rng, strength, period), per_mass=True)
        for body in scene.bodies
        if rng.random() < (0.3 if supports else 0.6)
    )
    names = [support.name for support in supports]

    def moved(ends: tuple[str, str]) -> tuple[str, str]:
        if not names or rng.random() < 0.4:
            return ends
        new = str(rng.choice(names))
        first, second = (new if end == GROUND else end for end in ends)
        return first, second

    scene = replace(
        scene,
        supports=supports,
        forces=forces,
        springs=tuple(replace(s, between=moved(s.between)) for s in scene.springs),
        dashpots=tuple(replace(d, between=moved(d.between)) for d in scene.dashpots),
    )
    if names and rng.random() < 0.6:
        scene = replace(scene, contacts=_at_support(rng, scene, str(rng.choice(names))))
    check_scene(scene)
    return scene, end


def resting_scene(seed: int) -> tuple[Scene, float]:
    """A row that forces press against a support that moves, and its end (s).

    Most springs yield, most contacts are plastic: the bodies rest on the support and on each
    other, and are let go as it, their springs or their forces want.
    """
    rng = np.random.default_rng([seed, 23])
    strength, period = rng.uniform(1.0, 5.0), rng.uniform(0.4, 2.0)
    motion = _motion(rng, strength, period)
    length = strength * (period / (2.0 * np.pi)) ** 2
    bodies = tuple(
        Body(f"b{i}", 10.0 ** rng.uniform(-0.7, 0.7)) for i in range(int(rng.integers(1, 5)))
    )
    support = _support(rng, "p", strength, period)
    if isinstance(motion, NoMotion) or not support.moves_apart:
        support = Support("p", motion=Sine(strength * rng.uniform(0.3, 1.2), period))
    springs, dashpots = _links(rng, bodies, strength, length)
    forces = [
        Force(body.name, Constant(-strength * rng.uniform(0.0, 1.5)), per_mass=True)
        for body in bodies
    ]
    forces += [
        Force(body.name, _history(rng, strength, period), per_mass=True)
        for body in bodies
        if rng.random() < 0.5
    ]
    s = starts_of_supports(Scene(bodies, motion=motion, supports=(support,)), 0.0)["p"]
    names, contacts = ["p", *(body.name for body in bodies)], []
    for i, (left, right) in enumerate(pairwise(names)):
        opening = length * float(rng.choice([0.0, rng.uniform(0.0, 0.3)]))
        contacts.append(
            Contact(f"c{i}", left, right, opening + (s if i == 0 else 0.0), _plastic(rng))
        )
    scene = Scene(
        bodies, tuple(springs), tuple(dashpots), tuple(contacts), motion, (support,), tuple(forces)
    )
    check_scene(scene)
    return scene, float(rng.uniform(2.0, 4.0) * period)


def _plastic(rng: np.random.Generator) -> float:
    return 0.0 if rng.random() < 0.7 else float(rng.choice(RESTITUTION))


def _support(rng: np.random.Generator, name: str, strength: float, period: float) -> Support:
    if rng.random() < 0.6:
        return Support(name, float(rng.choice([0.0, period * rng.uniform(0.01, 1.0)])))
    kind = PULSES[rng.integers(0, len(PULSES) - 1)]
    return Support(name, motion=kind(strength * rng.uniform(0.3, 1.2), period))


def _history(rng: np.random.Generator, strength: float, period: float) -> Any:
    part = strength * rng.uniform(0.1, 1.0)
    kind = rng.integers(0, 3)
    if kind == 0:
        return Constant(float(rng.choice([-1.0, 1.0])) * part)
    if kind == 1:
        cycles = rng.choice([0.5, 1.0, None])
        phase, start = rng.uniform(0.0, 6.0), rng.uniform(-0.5, 1.0) * period
        return PhasedSine(part, period * rng.uniform(0.5, 2.0), False, start, cycles, phase)
    return Record(rng.normal(size=20) * part, period / 9.0)


def _at_support(rng: np.random.Generator, scene: Scene, name: str) -> tuple[Contact, ...]:
    """Contacts with one support in the place of both barriers: no row is closed in on."""
    s = starts_of_supports(scene, 0.0)[name]
    return tuple(
        replace(
            c,
            left=name if c.left == BARRIER else c.left,
            right=name if c.right == BARRIER else c.right,
            gap=c.gap + s * ((c.left == BARRIER) - (c.right == BARRIER)),
        )
        for c in scene.contacts
    )


def nudged(scene: Scene, rng: np.random.Generator, part: float) -> Scene:
    """The scene with masses, stiffnesses and strengths changed by a relative part of themselves."""

    def changed(value: float) -> float:
        return value * (1.0 + part * rng.uniform(-1.0, 1.0))

    def law(of: Law) -> Law:
        if isinstance(of, Linear):
            return Linear(changed(of.stiffness))
        if isinstance(of, BilinearElastic):
            return BilinearElastic(changed(of.compression), changed(of.extension), of.offset)
        if isinstance(of, Series):
            return Series(tuple(law(part) for part in of.parts))
        names = {f.name for f in fields(of)} & FORCES
        return replace(of, **{name: changed(getattr(of, name)) for name in sorted(names)})

    return replace(
        scene,
        bodies=tuple(replace(b, mass=changed(b.mass)) for b in scene.bodies),
        springs=tuple(replace(s, law=law(s.law)) for s in scene.springs),
    )
