"""Forces of one elongation with a memory: soil by its deepest point, and laws of contact.

Each has an elongation x, positive where its ends are apart, and pushes them apart.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from eventpound.scene import Backfill, Contact

APART, INSIDE, PUSHED = range(3)


class Law(Protocol):
    """A force with its row of bodies and supports."""

    row: np.ndarray

    def begin(self, x: float, rate: float) -> None:
        """Set the state at the start."""

    def push(self, x: float, rate: float) -> float:
        """Force of the present state, continued (N)."""

    def ends(self, noise: float) -> list[Callable[[float, float], float]]:
        """Functions of x and its rate that fall through zero where the state ends."""

    def turn(self, which: int, x: float, rate: float) -> None:
        """Go on after one of its ends."""

    def jump(self, x: float, rate: float) -> None:
        """Go on after an impact has changed the rate."""


@dataclass(eq=False)
class Soil:
    """Apart, inside what it was pushed to, or on its backbone; how deep it was pushed (m)."""

    row: np.ndarray
    law: Backfill
    deepest: float = 0.0
    state: int = APART

    def backbone(self, y: float) -> float:
        """Force at a depth that is new (N)."""
        law = self.law
        return y / (1.0 / law.initial_stiffness + law.failure_ratio * y / law.ultimate_force)

    @property
    def left(self) -> float:
        """Depth at which it is touched again (m)."""
        return self.deepest - self.backbone(self.deepest) / self.law.initial_stiffness

    def depth(self, x: float) -> float:
        """How deep it is pushed beyond the gap (m)."""
        return -x - self.law.gap

    def begin(self, x: float, rate: float) -> None:
        if self.depth(x) > 0.0:
            self.deepest, self.state = self.depth(x), INSIDE if rate > 0.0 else PUSHED

    def push(self, x: float, rate: float) -> float:
        if self.state == APART:
            return 0.0
        if self.state == PUSHED:
            return self.backbone(self.depth(x))
        return self.law.initial_stiffness * (self.depth(x) - self.left)

    def ends(self, noise: float) -> list[Callable[[float, float], float]]:
        if self.state == APART:
            return [lambda x, rate: self.left - self.depth(x) + noise]
        if self.state == PUSHED:
            return [lambda x, rate: noise - rate]
        return [
            lambda x, rate: self.depth(x) - self.left + noise,
            lambda x, rate: self.deepest - self.depth(x) + noise,
        ]

    def turn(self, which: int, x: float, rate: float) -> None:
        if self.state == APART:
            self.state = INSIDE if self.deepest > 0.0 else PUSHED
        elif self.state == PUSHED:
            self.deepest, self.state = self.depth(x), INSIDE
        else:
            self.state = (APART, PUSHED)[which]

    def jump(self, x: float, rate: float) -> None:
        if self.state == PUSHED and rate > 0.0:
            self.turn(0, x, rate)


@dataclass(eq=False)
class Touch:
    """A contact law between masses in series `mass` (kg); its approach speed (m/s)."""

    row: np.ndarray
    contact: Contact
    mass: float
    closed: bool = False
    nearing: bool = True
    approach: float = 0.0

    def begin(self, x: float, rate: float) -> None:
        self.closed, self.nearing = x + self.contact.gap < 0.0, rate < 0.0

    def push(self, x: float, rate: float) -> float:
        if not self.closed:
            return 0.0
        law, gap, constant = self.contact.law, x + self.contact.gap, self.contact.damping or 0.0
        k, d = law.stiffness, max(-gap, 0.0)
        match law.kind:
            case "linear" | "kelvin-voigt":
                found = -k * gap - 2.0 * constant * math.sqrt(k * self.mass) * rate
                return found if law.tension else max(found, 0.0)
            case "hertz-damp":
                part = -constant * rate / self.approach if self.approach > 0.0 else 0.0
                return k * d**1.5 * (1.0 + part)
            case "jankowski" if self.nearing:
                damping = 2.0 * constant * math.sqrt(k * math.sqrt(d) * self.mass)
                return k * d**1.5 - damping * rate
        return k * d**1.5

    def ends(self, noise: float) -> list[Callable[[float, float], float]]:
        gap = self.contact.gap
        if not self.closed:
            return [lambda x, rate: gap + x]
        way = -1.0 if self.nearing else 1.0
        return [lambda x, rate: -gap - x, lambda x, rate: way * rate]

    def turn(self, which: int, x: float, rate: float) -> None:
        if which == 0:
            self.closed = self.nearing = not self.closed
            self.approach = -rate
        else:
            self.nearing = not self.nearing

    def jump(self, x: float, rate: float) -> None:
        self.nearing = rate < 0.0
