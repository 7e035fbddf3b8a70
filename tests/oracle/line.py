"""Bodies on lines: laws, sliders and Newton contacts, also at points between bodies.

What an instant leaves open is tried in every pattern of slip, stick, rest and opening: in the right
one slips go along their friction's pull, gaps open, and some forces within their bounds hold the
rest, unique or not. Rows have a column for each body, then one for each support.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
from scipy.optimize import linprog, nnls

from eventpound.scene import Backfill, Contact, Linear, Point, Scene, Slider
from tests.oracle.laws import APART, Law, Soil, Touch
from tests.oracle.pieces import Event, march, stops_of

TOLERANCE = 1e-12
NOISE = 1e-11
"""By which part of L/T or of a force a value passes its end before it counts, so that the motion
then tells where it goes."""
STILL = 1e-10
"""Part of L/T below which what passed zero stands still."""
LAST = 1e-5
"""Part of L/T below which an impact is plastic: a flight after it would be within the noise."""
PASSED = 1e-8
"""Part of L by which no gap may be below zero."""
MOST_STEPS = 500
"""A run has more: SciPy does not see what begins and ends within one."""


@dataclass
class Answer:
    """What a run did.

    Final state; times of turns of sliders and soils, and of impacts (s); when which soil was
    touched (-1) or left (1); the soils at the end; the way of each slip (m).
    """

    u: np.ndarray
    v: np.ndarray
    turns: list[float] = field(default_factory=list)
    impacts: list[float] = field(default_factory=list)
    touched: list[tuple[float, int, int]] = field(default_factory=list)
    soils: list[Soil] = field(default_factory=list)
    path: np.ndarray = field(default_factory=lambda: np.zeros(0))


class Program:
    """A scene whose motion has sizes of `length` (m) and `time` (s)."""

    def __init__(self, scene: Scene, length: float, time: float) -> None:
        self.scene, self.length, self.speed = scene, length, length / time
        bodies = scene.bodies
        self.names = [each.name for each in (*bodies, *scene.supports)]
        self.n, self.mass = len(bodies), np.array([body.mass for body in bodies])
        self.y = np.array([b.displacement for b in bodies] + [b.velocity for b in bodies])
        size = len(self.names)
        self.stiffness, self.damping = np.zeros((2, size, size))
        self.laws, rows, bounds = list[Law](), [], []
        for spring in scene.springs:
            B, law = self.row(spring.between), spring.law
            if isinstance(law, Backfill):
                self.laws.append(Soil(B, law))
                continue
            assert isinstance(law, Linear | Slider)
            self.stiffness += law.stiffness * np.outer(B, B)
            if isinstance(law, Slider):
                rows.append(B)
                bounds.append(law.friction * law.normal_force)
        for dashpot in scene.dashpots:
            B = self.row(dashpot.between)
            self.damping += dashpot.coefficient * np.outer(B, B)
        self.laws += [self._touch(c) for c in scene.contacts if c.law is not None]
        hard = [c for c in scene.contacts if c.law is None]
        self.B, self.F = np.reshape(rows, (-1, size)), np.array(bounds)
        self.W = np.reshape([self.row((c.left, c.right)) for c in hard], (-1, size))
        self.gap = np.array([c.gap for c in hard])
        self.restitution = np.array([c.restitution for c in hard], float)
        # Of each slider +1, -1 or 0 where it sticks; of each contact whether it rests.
        self.slip, self.rest = np.zeros(len(bounds), int), np.zeros(self.gap.size, bool)
        # Events ask again at the same time.
        self.supported = lru_cache(16)(self._supported)
        u, v = np.split(self.y, 2)
        self.answer = Answer(u, v, path=np.zeros(self.F.size))
        self.answer.soils = [law for law in self.laws if isinstance(law, Soil)]
        for law in self.laws:
            law.begin(*self.elongation(law, 0.0, self.y))
        self.moved = self.B @ self.with_supports(0.0, u, "displacement")

    def row(self, ends: tuple[str | Point, str | Point]) -> np.ndarray:
        """What bodies and supports move the second end relative to the first."""
        found = np.zeros(len(self.names))
        for end, sign in zip(ends, (-1.0, 1.0), strict=True):
            for name, weight in end.weights if isinstance(end, Point) else ((end, 1.0),):
                if name in self.names:
                    found[self.names.index(name)] += sign * weight
        return found

    def _touch(self, contact: Contact) -> Touch:
        W = self.row((contact.left, contact.right))
        return Touch(W, contact, 1.0 / float(W[: self.n] ** 2 @ (1.0 / self.mass)))

    def with_supports(self, t: float, values: np.ndarray, what: str) -> np.ndarray:
        """Displacements, velocities or accelerations of the bodies, then those of supports."""
        return np.append(values, self.supported(t, what)) if self.scene.supports else values

    def _supported(self, t: float, what: str) -> np.ndarray:
        """How supports move relative to the ground."""
        ground, at = self.scene.motion, np.array(t)
        own = [float(getattr(s.moved_by(ground), what)(at)) for s in self.scene.supports]
        return np.array(own) - float(getattr(ground, what)(at))

    def elongation(self, law: Law, t: float, y: np.ndarray) -> tuple[float, float]:
        """Of a law, and its rate."""
        u = self.with_supports(t, y[: self.n], "displacement")
        return float(law.row @ u), float(law.row @ self.with_supports(t, y[self.n :], "velocity"))

    def free(self, t: float, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Forces on the bodies without friction of sliders that stick, and without contacts."""
        ground, n = float(self.scene.motion.acceleration(np.array(t))), self.n
        force = -self.stiffness @ self.with_supports(t, u, "displacement")
        force -= self.damping @ self.with_supports(t, v, "velocity")
        force -= self.B.T @ (self.F * self.slip)
        for law in self.laws:
            force += law.push(*self.elongation(law, t, np.concatenate((u, v)))) * law.row
        for given in self.scene.forces:
            b = self.names.index(given.body)
            value = float(given.history.acceleration(np.array(t)))
            force[b] += value * (self.mass[b] if given.per_mass else 1.0)
        return force[:n] - self.mass * ground

    def held(self) -> np.ndarray:
        """Rows of what sticks, then of what rests."""
        return np.vstack((self.B[self.slip == 0], self.W[self.rest]))

    def balanced(self, t: float, u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Accelerations of bodies and supports, and some forces of what sticks and rests."""
        force, D, n = self.free(t, u, v), self.held(), self.n
        a = self.with_supports(t, force / self.mass, "acceleration")
        if D.shape[0] == 0:
            return a, np.zeros(0)
        G = D[:, :n] / self.mass @ D[:, :n].T
        found = -np.linalg.lstsq(G, D @ a, 1e-9)[0]
        a[:n] += D[:, :n].T @ found / self.mass
        return a, found

    def rate(self, t: float, y: np.ndarray) -> np.ndarray:
        """y'."""
        u, v = y[: self.n], y[self.n :]
        return np.concatenate((v, self.balanced(t, u, v)[0][: self.n]))

    def margin(self, t: float, u: np.ndarray, v: np.ndarray) -> float:
        """How far the forces of what sticks or rests can be inside their bounds, in parts.

        Or by how much it moves all the same, where supports move apart.
        """
        D = self.held()
        a, found = self.balanced(t, u, v)
        apart = float(np.abs(D @ a).max()) / (
            np.abs(a).max() + (self.F / self.mass.min()).max(initial=0.0)
        )
        room = self._room(D[:, : self.n], found, self.free(t, u, v))
        return room if apart < 0.01 * NOISE else min(room, -apart)

    def _room(self, D: np.ndarray, found: np.ndarray, force: np.ndarray) -> float:
        sticks = int((self.slip == 0).sum())
        F = self.F[self.slip == 0]
        unit = max(F.max(initial=0.0), float((self.mass * np.abs(force / self.mass)).max()), 1e-300)
        low = np.concatenate((-F, np.zeros(D.shape[0] - sticks)))
        high = np.concatenate((F, np.full(D.shape[0] - sticks, np.inf)))
        null = np.linalg.svd(D.T)[2][np.linalg.matrix_rank(D, 1e-9) :]
        if null.shape[0] > 1:
            # The largest m with a <= lambda + Z c, and + m below it, by linear programming.
            rows = np.vstack((np.column_stack((-null.T, np.ones(low.size))),
                              np.column_stack((null.T, np.ones(low.size)))))  # fmt: skip
            right = np.concatenate((found - low, high - found)) / unit
            kept = np.isfinite(right)
            most = linprog(np.append(np.zeros(null.shape[0]), -1.0), rows[kept], right[kept],
                           bounds=[*[(None, None)] * null.shape[0], (None, 1e3)])  # fmt: skip
            return -float(most.fun)
        if null.shape[0] == 0:
            return float(np.minimum(found - low, high - found).min()) / unit
        # λ + s n within its bounds for some s: the largest margin is that of two of them.
        n = null[0]
        free = np.abs(n) < 1e-9
        fixed = np.minimum(found - low, high - found)[free].min(initial=np.inf)
        up, down = [], []
        for value, slope, a, b in zip(found, n, low, high, strict=True):
            if abs(slope) < 1e-9:
                continue
            # value + s slope - a >= m and b - value - s slope >= m.
            for c, d in ((value - a, slope), (b - value, -slope)):
                (up if d < 0.0 else down).append((c, abs(d)))
        shared = min(
            ((c1 / d1 + c2 / d2) / (1.0 / d1 + 1.0 / d2) for c1, d1 in up for c2, d2 in down),
            default=np.inf,
        )
        return float(min(fixed, shared, 1e300)) / unit

    def strike(self, t: float, u: np.ndarray, v: np.ndarray, closing: set[int]) -> np.ndarray:
        """Velocities after the impacts of contacts that close or are closed, one problem by one."""
        W = self.W[:, : self.n]
        gaps = self.gap + self.W @ self.with_supports(t, u, "displacement")
        shut = [j for j in range(gaps.size)
                if j in closing or self.rest[j] or gaps[j] <= STILL * self.speed]  # fmt: skip
        for _ in range(20):
            rates = self.W @ self.with_supports(t, v, "velocity")
            taken = [j for j in shut if rates[j] <= STILL * self.speed]
            if not any(rates[j] < -STILL * self.speed for j in taken):
                return v
            A = W[taken] / np.sqrt(self.mass)
            bounces = rates[taken] < -LAST * self.speed
            q = (1.0 + self.restitution[taken] * bounces) * rates[taken]
            b = np.linalg.lstsq(A, q, 1e-9)[0]
            impulses = nnls(A.T, -b)[0]
            if np.abs(A @ b - q).max() > 1e-9 * np.abs(q).max():
                raise ArithmeticError("impacts of contacts that depend on each other")
            v = v + W[taken].T @ impulses / self.mass
        raise ArithmeticError("impacts without end")

    def decide(self, t: float, u: np.ndarray, v: np.ndarray) -> None:
        """Who sticks and slips, rests and opens."""
        all_v = self.with_supports(t, v, "velocity")
        still = [i for i in range(self.F.size) if abs(self.B[i] @ all_v) <= STILL * self.speed]
        gaps = self.gap + self.W @ self.with_supports(t, u, "displacement")
        shut = [
            j
            for j in range(self.gap.size)
            if (self.rest[j] or gaps[j] <= STILL * self.speed) and
            abs(self.W[j] @ all_v) <= STILL * self.speed
        ]  # fmt: skip
        for i in range(self.F.size):
            self.slip[i] = 0 if i in still else int(np.sign(self.B[i] @ all_v))
        self.rest[:] = False
        best, found = -np.inf, (self.slip.copy(), self.rest.copy())
        for slips in product((0, 1, -1), repeat=len(still)):
            self.slip[still] = slips
            for rests in product((True, False), repeat=len(shut)):
                self.rest[shut] = rests
                a = self.balanced(t, u, v)[0]
                unit = np.abs(a).max() + (self.F / self.mass.min()).max(initial=0.0)
                ways = [s * float(self.B[i] @ a) / unit for i, s in zip(still, slips, strict=True)]
                opens = [float(self.W[j] @ a) / unit for j in shut if not self.rest[j]]
                held = [self.margin(t, u, v)] if self.held().shape[0] else []
                least = min([w for w, s in zip(ways, slips, strict=True) if s] + opens + held,
                            default=0.0)  # fmt: skip
                if least > best:
                    best, found = least, (self.slip.copy(), self.rest.copy())
        assert best > -1e-9, best
        self.slip, self.rest = found

    def events(self) -> list[Event]:
        """Ends of slips, of flights, of what is held, and of the states of laws."""
        n, found = self.n, list[Event]()

        def along(row: np.ndarray, t: float, values: np.ndarray, what: str) -> float:
            return float(row @ self.with_supports(t, values, what))

        for i in np.flatnonzero(self.slip):
            found.append((("slip", i), lambda t, y, i=i: self.slip[i] * along(
                self.B[i], t, y[n:], "velocity") + NOISE * self.speed))  # fmt: skip
        for j in np.flatnonzero(~self.rest):
            found.append((("contact", j), lambda t, y, j=j: self.gap[j] + along(
                self.W[j], t, y[:n], "displacement") + NOISE * self.length))  # fmt: skip
        if self.held().shape[0]:
            found.append((("held", 0), lambda t, y: self.margin(t, y[:n], y[n:]) + NOISE))
        for i, law in enumerate(self.laws):
            for which, end in enumerate(law.ends(NOISE * self.length)):
                found.append((("law", i, which), lambda t, y, law=law, end=end: end(
                    *self.elongation(law, t, y))))  # fmt: skip
        return found

    def happened(self, t: float, y: np.ndarray, owners: list[Any]) -> np.ndarray:
        """The state after turns and impacts."""
        u, v = np.split(y, 2)
        moved = self.B @ self.with_supports(t, u, "displacement")
        self.answer.path += np.abs(moved - self.moved) * (self.slip != 0)
        self.moved = moved
        gaps = self.gap + self.W @ self.with_supports(t, u, "displacement")
        if (gaps[~self.rest] < -PASSED * self.length).any():
            raise ArithmeticError("an impact within a step was not seen")
        for kind, i, *which in owners:
            if kind == "law":
                self._turn(t, y, i, *which)
            elif kind != "contact":
                self.answer.turns.append(t)
        closing = {i for kind, i, *_ in owners if kind == "contact"}
        if closing:
            self.answer.impacts += [t] * len(closing)
            v = self.strike(t, u, v, closing)
            y = np.concatenate((u, v))
            for law in self.laws:
                law.jump(*self.elongation(law, t, y))
        self.decide(t, u, v)
        return y

    def _turn(self, t: float, y: np.ndarray, i: int, which: int) -> None:
        law, now = self.laws[i], self.elongation(self.laws[i], t, y)
        if not isinstance(law, Soil):
            law.turn(which, *now)
            return
        apart = law.state == APART
        law.turn(which, *now)
        self.answer.turns.append(t)
        if apart != (law.state == APART):
            way = -1 if apart else 1
            self.answer.touched.append((t, self.answer.soils.index(law), way))


def solved(scene: Scene, end: float, length: float, time: float,
           corners: Iterable[float] = (), steps: int = MOST_STEPS) -> Answer:  # fmt: skip
    """The scene to `end` (s), whose motion has corners at some times, by so many steps or more."""
    program = Program(scene, length, time)
    program.decide(0.0, *np.split(program.y, 2))
    tolerances = {"rtol": TOLERANCE, "atol": 1e-15 * length, "max_step": end / steps}
    last = march(program, program.y, stops_of(end, corners), **tolerances)[-1]
    program.answer.u, program.answer.v = np.split(last, 2)
    return program.answer
