"""Scenes whose springs, dashpots and contacts end at points, and a program that moves some.

The program has one matrix of directions and SciPy's DOP853; of the package it takes the numbers of
a scene and the acceleration of the ground.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from eventpound.motion.constant import Constant
from eventpound.motion.pulses import Sine
from eventpound.scene import (
    BARRIER,
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    DegradingBoucWen,
    Force,
    Linear,
    Point,
    Scene,
    Slider,
    Spring,
    Support,
)

Ends = tuple[str | Point, str | Point]


def drawn_ends(rng: np.random.Generator, moving: list[str], still: list[str]) -> Ends:
    """Two ends without a name in common, each a name or a point of two or three."""
    names = rng.permutation([*moving, *still]).tolist()
    names.sort(key=lambda name: name in still and rng.random() < 0.5)
    ends: list[str | Point] = []
    for _ in range(2):
        size = min(int(rng.choice([1, 2, 3], p=(0.25, 0.5, 0.25))), len(names) - 1 + len(ends))
        own, names = names[:size], names[size:]
        parts = rng.uniform(0.2, 1.0, size)
        weights = dict(zip(own, (parts / parts.sum()).tolist(), strict=True))
        ends.append(own[0] if size == 1 else Point(weights))
    return (ends[0], ends[1]) if rng.random() < 0.5 else (ends[1], ends[0])


def _links(
    rng: np.random.Generator, moving: list[str], still: list[str], laws: list[Any]
) -> tuple[tuple[Spring, ...], tuple[Dashpot, ...]]:
    """A spring of each law, and two dashpots."""
    springs = [Spring(f"k{i}", drawn_ends(rng, moving, still), law) for i, law in enumerate(laws)]
    held = [Spring(f"h{name}", (GROUND, name), Linear(rng.uniform(0.5, 3.0))) for name in moving]
    dashpots = [
        Dashpot(drawn_ends(rng, moving, still), rng.uniform(0.05, 0.3)),
        Dashpot(springs[0].between, rng.uniform(0.05, 0.3)),
    ]
    return (*springs, *held), tuple(dashpots)


def smooth_scene(seed: int) -> tuple[Scene, float]:
    """Two to four bodies on springs that yield, degrade, have a kink or none, and its end (s)."""
    rng = np.random.default_rng([seed, 580])
    names = [f"b{i}" for i in range(int(rng.integers(2, 5)))]
    u_y = rng.uniform(0.02, 0.2, 3)
    laws = [
        Linear(rng.uniform(0.5, 3.0)),
        BoucWen(rng.uniform(0.0, 2.0), rng.uniform(0.1, 1.0), u_y[0], rng.uniform(1.5, 4.0)),
        DegradingBoucWen(
            *(rng.uniform(0.0, 2.0), rng.uniform(0.1, 1.0), u_y[1], 2.0, 0.3, 0.7),
            *(0.0, 0.02, 0.03),
        ),
        BilinearElastic(0.0, rng.uniform(1.0, 9.0), float(rng.uniform(0.0, 0.1))),
        BilinearElastic(rng.uniform(1.0, 9.0), rng.uniform(0.0, 2.0), float(-u_y[2])),
    ]
    springs, dashpots = _links(rng, names, [GROUND], laws)
    bodies = tuple(Body(name, rng.uniform(0.5, 3.0)) for name in names)
    motion = Sine(rng.uniform(0.3, 1.5), rng.uniform(3.0, 12.0))
    return Scene(bodies, springs, dashpots, (), motion), float(rng.uniform(8.0, 15.0))


def touching_scene(seed: int, supports: int) -> tuple[Scene, float]:
    """Linear springs, sliders, dashpots and contacts at points, and its end (s)."""
    rng = np.random.default_rng([seed, supports, 581])
    names = [f"b{i}" for i in range(int(rng.integers(2, 5)))]
    held = [f"p{k}" for k in range(supports)]
    laws: list[Any] = [Linear(rng.uniform(0.5, 3.0)) for _ in range(2)]
    laws += [Slider(rng.uniform(0.05, 0.5), rng.uniform(0.5, 2.0)) for _ in range(supports % 2 + 1)]
    springs, dashpots = _links(rng, names, [GROUND, *held], laws)
    contacts = []
    for i in range(int(rng.integers(1, 4))):
        ends = tuple(
            BARRIER if end == GROUND else end for end in drawn_ends(rng, names, [GROUND, *held])
        )
        gap = float(rng.choice([0.0, rng.uniform(0.05, 0.5)], p=(0.3, 0.7)))
        contacts.append(Contact(f"c{i}", *ends, gap, float(rng.choice([0.0, 0.5], p=(0.8, 0.2)))))
    motions = [Sine(rng.uniform(0.5, 1.5), rng.uniform(2.0, 9.0)) for _ in held]
    scene = Scene(
        bodies=tuple(Body(name, rng.uniform(0.5, 3.0)) for name in names),
        springs=springs,
        dashpots=dashpots,
        contacts=tuple(contacts),
        motion=Sine(rng.uniform(0.3, 1.5), rng.uniform(3.0, 12.0)),
        supports=tuple(Support(n, motion=m) for n, m in zip(held, motions, strict=True)),
        forces=tuple(Force(name, Constant(0.4 * rng.normal()), True) for name in names),
    )
    return scene, float(rng.uniform(8.0, 15.0))


def rows(scene: Scene, links: tuple[Spring | Dashpot, ...]) -> np.ndarray:
    """B: what each body does to each elongation, shape (L, N)."""
    index = {body.name: i for i, body in enumerate(scene.bodies)}
    found = np.zeros((len(links), len(index)))
    for row, link in zip(found, links, strict=True):
        for end, sign in zip(link.between, (-1.0, 1.0), strict=True):
            of = {end: 1.0} if isinstance(end, str) else dict(end.weights)
            for name, weight in of.items():
                if name in index:
                    row[index[name]] += sign * weight
    return found


def moved(scene: Scene, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Displacements (m) and velocities (m/s) of a scene without contacts at its end (s)."""
    n, mass = len(scene.bodies), np.array([body.mass for body in scene.bodies])
    B, D = rows(scene, scene.springs), rows(scene, scene.dashpots)
    c = np.array([dashpot.coefficient for dashpot in scene.dashpots])
    loops = [i for i, s in enumerate(scene.springs) if isinstance(s.law, BoucWen)]

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        u, v, (z, worn) = y[:n], y[n : 2 * n], y[2 * n :].reshape(2, -1)
        x, x_rate, force = B @ u, B @ v, np.zeros(len(B))
        z_rate, worn_rate = np.zeros(z.size), np.zeros(z.size)
        for i, spring in enumerate(scene.springs):
            law: Any = spring.law
            if isinstance(law, BilinearElastic):
                d = x[i] - law.offset
                force[i] = d * (law.compression if d < 0.0 else law.extension)
                continue
            force[i] = law.stiffness * x[i]
            if isinstance(law, BoucWen):
                h, w = loops.index(i), x_rate[i]
                force[i] += law.strength * z[h]
                power = abs(z[h]) ** law.exponent
                nu, eta = 1.0, 1.0
                if isinstance(law, DegradingBoucWen):
                    nu += law.strength_degradation * worn[h]
                    eta += law.stiffness_degradation * worn[h]
                    worn_rate[h] = z[h] * w / law.yield_displacement
                bent = law.gamma * abs(w) * np.sign(z[h]) * power + law.beta * w * power
                z_rate[h] = (w - nu * bent) / (eta * law.yield_displacement)
        ground = float(scene.motion.acceleration(np.array(t)))
        a = -(B.T @ force + D.T @ (c * (D @ v))) / mass - ground
        return np.concatenate((v, a, z_rate, worn_rate))

    y, t = np.zeros(2 * n + 2 * len(loops)), 0.0
    corners = {piece.end for piece in scene.motion.pieces()}
    for stop in [*sorted(c for c in corners if 0.0 < c < end), end]:
        run = solve_ivp(rate, (t, stop), y, "DOP853", rtol=1e-12, atol=1e-14, max_step=0.05)
        y, t = run.y[:, -1], stop
    return y[:n], y[n : 2 * n]
