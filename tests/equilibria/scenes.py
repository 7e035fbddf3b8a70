"""Scenes drawn at random that forces press on stops, cables, barriers and each other."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from eventpound.motion import Sine
from eventpound.scene import (
    BARRIER,
    GROUND,
    Backfill,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    DegradingBoucWen,
    Force,
    Linear,
    Scene,
    Series,
    Slider,
    Spring,
    Support,
)
from eventpound.scene.point import Point

Law = Linear | BilinearElastic | Series | BoucWen | Backfill | Slider
SI = (1.0, 1.0, 1.0)
"""Units of length, mass and time."""
EXPONENTS = (1.0, 1.5, 2.0, 5.0, 20.0, 50.0)
SHAPES = ((0.5, 0.5), (0.1, 0.9), (0.9, 0.1), (-0.2, 0.8), (1.0, 1.0))


class Drawn:
    """A scene drawn from a seed, the same one in any units.

    Lengths are about 0.03, masses 1, and stiffnesses lie within four orders of 10.
    """

    def __init__(self, seed: int, units: Sequence[float] = SI) -> None:
        self.rng = np.random.default_rng(seed)
        self.length, self.mass, time = units
        self.force = self.mass * self.length / time**2
        self.stiffness = self.force / self.length
        self.time = time

    def number(self, low: float, high: float) -> float:
        """One of a range."""
        return float(self.rng.uniform(low, high))

    def chance(self, part: float) -> bool:
        """Whether something is so in this part of all scenes."""
        return bool(self.rng.random() < part)

    def scene(self) -> Scene:
        """A row of bodies on supports, or two frames that touch at heights."""
        if self.chance(0.3):
            return self._frames()
        count = int(self.rng.integers(1, 7))
        names = [f"b{i}" for i in range(count)]
        supports = self._supports() if self.chance(0.3) else ()
        ends = [GROUND, *(support.name for support in supports)]
        pairs = [(str(self.rng.choice(ends)), b) for b in names if self.chance(0.7)]
        pairs += [pair for pair in pairwise(names) if self.chance(0.35)]
        walls = [(str(self.rng.choice(ends)).replace(GROUND, BARRIER)) for _ in range(2)]
        touching = [p for p in pairwise([walls[0], *names, walls[1]]) if self.chance(0.75)]
        touching += [p for p in touching if self.chance(0.15)]
        return Scene(
            self._bodies(names),
            self._springs(pairs),
            (),
            self._contacts(touching, supports),
            supports=supports,
            forces=self._forces(names),
        )

    def with_memory(self) -> Scene:
        """The scene, some of whose springs are backfill, degrade or are sliders."""
        scene = self.scene()
        kinds = 2 if any(contact.at_point for contact in scene.contacts) else 3
        springs = [
            replace(spring, law=self._memory(kinds)) if self.chance(0.6) else spring
            for spring in scene.springs
        ]
        return replace(scene, springs=tuple(springs))

    def _memory(self, kinds: int) -> Law:
        k = self.stiffness * 10.0 ** self.number(-2.0, 2.0)
        strength = k * 0.03 * self.length * self.number(0.1, 1.0)
        hardening = float(self.rng.choice([0.0, 0.01, 0.1]))
        kind = self.rng.integers(0, kinds)
        if kind == 0:
            gap, wider = (0.01 * self.length * self.number(0.0, 1.0) for _ in range(2))
            return Backfill(
                k, strength, self.number(0.5, 1.0), gap, (gap + wider) * self.chance(0.3)
            )
        if kind == 2:
            return Slider(0.1, 10.0 * strength, hardening * k)
        n, u_y = (
            float(self.rng.choice(EXPONENTS[:5])),
            self.length * 10.0 ** self.number(-3.0, -1.0),
        )
        beta, gamma = SHAPES[self.rng.integers(0, 2)]
        z = 0.9 * self.number(-1.0, 1.0) if self.chance(0.3) else 0.0
        loss = [0.1 * self.number(0.0, 1.0) for _ in range(3)]
        return DegradingBoucWen(hardening * k, strength, u_y, n, beta, gamma, z, *loss)

    def _frames(self) -> Scene:
        stories = [[f"{c}{i}" for i in range(int(self.rng.integers(1, 5)))] for c in "AB"]
        names = [name for frame in stories for name in frame]
        pairs = [pair for frame in stories for pair in pairwise([GROUND, *frame])]
        touching = []
        for _ in range(int(self.rng.integers(1, 4))):
            ends: list[Point | str] = []
            for frame in stories:
                i = int(self.rng.integers(0, len(frame)))
                below = frame[i - 1] if i > 0 else GROUND
                part = self.number(0.1, 0.9)
                at = Point({below: part, frame[i]: 1.0 - part})
                ends.append(frame[i] if self.chance(0.3) else at)
            touching.append((ends[0], ends[1]))
        return Scene(
            self._bodies(names),
            self._springs(pairs),
            (),
            self._contacts(touching, ()),
            forces=self._forces(names),
        )

    def _supports(self) -> tuple[Support, ...]:
        """Supports that have come to rest elsewhere than the ground."""
        return tuple(
            Support(
                f"p{i}",
                motion=Sine(
                    self.number(0.01, 0.05) * self.length / self.time**2,
                    self.time,
                    start=-2.0 * self.time,
                ),
            )
            for i in range(int(self.rng.integers(1, 3)))
        )

    def _bodies(self, names: Sequence[str]) -> tuple[Body, ...]:
        moved = self.chance(0.4)
        return tuple(
            Body(
                name,
                self.mass * 10.0 ** self.number(-0.5, 0.5),
                self.length * 0.03 * self.number(-1.0, 1.0) if moved else 0.0,
            )
            for name in names
        )

    def _springs(self, pairs: Sequence[tuple[str, str]]) -> tuple[Spring, ...]:
        turned = [pair[::-1] if self.chance(0.3) else pair for pair in pairs]
        return tuple(Spring(f"s{i}", pair, self._law()) for i, pair in enumerate(turned))

    def _law(self) -> Law:
        k = self.stiffness * 10.0 ** self.number(-2.0, 2.0)
        offset = self.length * self.number(-0.03, 0.03)
        kind = self.rng.integers(0, 6)
        if kind == 0:
            return Linear(k)
        if kind == 1:
            sides = [(k, 0.0), (0.0, k), (k, k * self.number(0.01, 3.0))]
            return BilinearElastic(*sides[self.rng.integers(0, 3)], offset)
        if kind == 2:
            return Series((Linear(k), BilinearElastic(k * self.number(0.1, 3.0), k, offset)))
        beta, gamma = SHAPES[self.rng.integers(0, len(SHAPES))]
        n = float(self.rng.choice(EXPONENTS))
        u_y = self.length * 10.0 ** self.number(-3.0, -1.0)
        bound = (beta + gamma) ** (-1.0 / n)
        z = bound * self.number(-1.0, 1.0) if self.chance(0.3) else 0.0
        hardening = float(self.rng.choice([0.0, 0.01, 0.1]))
        strength = k * 0.03 * self.length * self.number(0.1, 1.0)
        return BoucWen(hardening * k, strength, u_y, n, beta, gamma, z)

    def _contacts(
        self, touching: Sequence[tuple[Point | str, Point | str]], supports: Sequence[Support]
    ) -> tuple[Contact, ...]:
        """Gaps of all sizes; in some scenes none, so that rows are locked, but not on supports.

        What these close in on is refused by a run, were it by the rounding of their speeds.
        """
        shut = self.chance(0.1) and not supports
        at = {s.name: float(s.motion.displacement(np.array(0.0))) for s in supports if s.motion}
        found = []
        for i, (left, right) in enumerate(touching):
            touch = self.chance(0.1) and not supports
            gap = 0.0 if shut or touch else self.length * self.number(0.0, 0.05)
            gap += at.get(str(left), 0.0) - at.get(str(right), 0.0)
            found.append(Contact(f"c{i}", left, right, gap, 0.5))
        return tuple(found)

    def _forces(self, names: Sequence[str]) -> tuple[Force, ...]:
        size = self.force * 0.03 * 10.0 ** self.number(-1.0, 1.0)
        return tuple(Force(b, size * self.number(-1.0, 1.0)) for b in names if self.chance(0.7))
