"""Bodies with sliders and contacts by SciPy with events.

What an instant leaves open is tried in every pattern of slip, stick, rest and opening: in the right
one slips go along their friction's pull, gaps open, and some forces within their bounds hold the
rest, unique or not. Nothing here is taken from the package but the numbers of a scene and the
acceleration of the ground.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import product

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import linprog

from eventpound.scene import Linear, Scene, Slider

TOLERANCE = 1e-12
NOISE = 1e-11
"""By which part of L/T or of a force a value passes its end before it counts, so that the motion
then tells where it goes."""
STILL = 1e-10
"""Part of L/T below which what passed zero stands still."""
MOST_EVENTS = 400
MOST_STEPS = 1500
"""A run has more: SciPy does not see what begins and ends within one."""


@dataclass
class Answer:
    """Final state, times of changes of sliders (s) and of impacts (s), and the way of each slip."""

    u: np.ndarray
    v: np.ndarray
    turns: list[float] = field(default_factory=list)
    impacts: list[float] = field(default_factory=list)
    path: np.ndarray = field(default_factory=lambda: np.zeros(0))


class Program:
    """A scene whose motion has sizes of `length` (m) and `time` (s)."""

    def __init__(self, scene: Scene, length: float, time: float) -> None:
        self.scene, self.speed = scene, length / time
        names = [body.name for body in scene.bodies]
        n = self.n = len(names)
        self.mass = np.array([body.mass for body in scene.bodies])

        def row(ends: tuple[str, str]) -> np.ndarray:
            found = np.zeros(n)
            for end_name, sign in zip(ends, (-1.0, 1.0), strict=True):
                if end_name in names:
                    found[names.index(end_name)] += sign
            return found

        self.stiffness, self.damping = np.zeros((n, n)), np.zeros((n, n))
        rows, bounds = [], []
        for spring in scene.springs:
            B, law = row(spring.between), spring.law
            assert isinstance(law, Linear | Slider)
            self.stiffness += law.stiffness * np.outer(B, B)
            if isinstance(law, Slider):
                rows.append(B)
                bounds.append(law.friction * law.normal_force)
        for dashpot in scene.dashpots:
            B = row(dashpot.between)
            self.damping += dashpot.coefficient * np.outer(B, B)
        self.B, self.F = np.reshape(rows, (-1, n)), np.array(bounds)
        self.W = np.reshape([row((c.left, c.right)) for c in scene.contacts], (-1, n))
        self.gap = np.array([c.gap for c in scene.contacts])
        self.restitution = np.array([c.restitution for c in scene.contacts], float)
        # Of each slider +1, -1 or 0 where it sticks; of each contact whether it rests.
        self.slip, self.rest = np.zeros(len(bounds), int), np.zeros(self.gap.size, bool)

    def free(self, t: float, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Forces on the bodies without friction of sliders that stick, and without contacts."""
        ground = float(self.scene.motion.acceleration(np.array(t)))
        force = -self.stiffness @ u - self.damping @ v - self.mass * ground
        return force - self.B.T @ (self.F * self.slip)

    def held(self) -> np.ndarray:
        """Rows of what sticks, then of what rests."""
        return np.vstack((self.B[self.slip == 0], self.W[self.rest]))

    def acceleration(self, t: float, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Of the bodies."""
        force, D = self.free(t, u, v), self.held()
        if D.shape[0]:
            G = D / self.mass @ D.T
            force = force - D.T @ np.linalg.lstsq(G, D @ (force / self.mass), 1e-9)[0]
        return force / self.mass

    def margin(self, t: float, u: np.ndarray, v: np.ndarray) -> float:
        """How far the forces of what sticks or rests can be inside their bounds, in parts."""
        D, force = self.held(), self.free(t, u, v)
        G = D / self.mass @ D.T
        found = -np.linalg.lstsq(G, D @ (force / self.mass), 1e-9)[0]
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

    def decide(self, t: float, u: np.ndarray, v: np.ndarray) -> None:
        """Who sticks and slips, rests and opens."""
        still = [i for i in range(self.F.size) if abs(self.B[i] @ v) <= STILL * self.speed]
        gaps = self.gap + self.W @ u
        shut = [
            j
            for j in range(self.gap.size)
            if (self.rest[j] or gaps[j] <= STILL * self.speed) and
            abs(self.W[j] @ v) <= STILL * self.speed
        ]  # fmt: skip
        for i in range(self.F.size):
            self.slip[i] = 0 if i in still else int(np.sign(self.B[i] @ v))
        self.rest[:] = False
        best, found = -np.inf, (self.slip.copy(), self.rest.copy())
        for slips in product((0, 1, -1), repeat=len(still)):
            self.slip[still] = slips
            for rests in product((True, False), repeat=len(shut)):
                self.rest[shut] = rests
                a = self.acceleration(t, u, v)
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


def solved(scene: Scene, end: float, length: float, time: float,
           corners: tuple[float, ...] = ()) -> Answer:  # fmt: skip
    """The scene to `end` (s), whose motion has corners at some times."""
    p = Program(scene, length, time)
    n = p.n
    u = np.array([body.displacement for body in scene.bodies])
    v = np.array([body.velocity for body in scene.bodies])
    answer = Answer(u, v, path=np.zeros(p.F.size))
    t = 0.0

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        return np.concatenate((y[n:], p.acceleration(t, y[:n], y[n:])))

    for stop in [*(c for c in corners if 0.0 < c < end), end]:
        p.decide(t, u, v)
        while t < stop:
            events, owners = [], []
            for i in np.flatnonzero(p.slip):
                events.append(lambda t, y, i=i: p.slip[i] * float(p.B[i] @ y[n:])
                              + NOISE * p.speed)  # fmt: skip
                owners.append(("slip", i))
            for j in np.flatnonzero(~p.rest):
                events.append(lambda t, y, j=j: p.gap[j] + float(p.W[j] @ y[:n])
                              + NOISE * length)  # fmt: skip
                owners.append(("contact", j))
            if p.held().shape[0]:
                events.append(lambda t, y: p.margin(t, y[:n], y[n:]) + NOISE)
                owners.append(("held", 0))
            for function in events:
                function.terminal, function.direction = True, -1.0  # type: ignore[attr-defined]
            tolerances = {"rtol": TOLERANCE, "atol": 1e-15 * length, "max_step": end / MOST_STEPS}
            run = solve_ivp(rate, (t, stop), np.concatenate((u, v)), "DOP853", events=events,
                            **tolerances)  # fmt: skip
            t = float(run.t[-1])
            before, (u, v) = u, np.split(run.y[:, -1], 2)
            answer.path += np.abs(p.B @ (u - before)) * (p.slip != 0)
            struck = False
            for (kind, i), times in zip(owners, run.t_events, strict=True):
                if times.size and kind == "contact":
                    impulse = -(1.0 + p.restitution[i]) * float(p.W[i] @ v)
                    v = v + impulse / float(p.W[i] @ (p.W[i] / p.mass)) * p.W[i] / p.mass
                    if p.rest.any():
                        raise ArithmeticError("an impact where contacts rest")
                    answer.impacts.append(t)
                    struck = True
                elif times.size:
                    answer.turns.append(t)
                    struck = True
            if len(answer.impacts) + len(answer.turns) > MOST_EVENTS:
                raise ArithmeticError("events accumulate")
            if struck:
                p.decide(t, u, v)
    answer.u, answer.v = u, v
    return answer
