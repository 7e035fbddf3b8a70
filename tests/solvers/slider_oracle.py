"""Bodies with sliders and contacts, also at points between bodies, by SciPy with events.

What an instant leaves open is tried in every pattern of slip, stick, rest and opening: in the right
one slips go along their friction's pull, gaps open, and some forces within their bounds hold the
rest, unique or not. Nothing here is taken from the package but the numbers of a scene and the
motions of ground and supports. Rows have a column for each body, then one for each support.
"""

from dataclasses import dataclass, field
from itertools import product

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import linprog, nnls

from eventpound.scene import Linear, Point, Scene, Slider

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
        self.n = len(names)
        self.mass = np.array([body.mass for body in scene.bodies])
        names += [support.name for support in scene.supports]

        def row(ends: tuple[str | Point, str | Point]) -> np.ndarray:
            found = np.zeros(len(names))
            for end, sign in zip(ends, (-1.0, 1.0), strict=True):
                for name, weight in end.weights if isinstance(end, Point) else ((end, 1.0),):
                    if name in names:
                        found[names.index(name)] += sign * weight
            return found

        self.stiffness, self.damping = np.zeros((2, len(names), len(names)))
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
        self.B, self.F = np.reshape(rows, (-1, len(names))), np.array(bounds)
        self.W = np.reshape([row((c.left, c.right)) for c in scene.contacts], (-1, len(names)))
        self.gap = np.array([c.gap for c in scene.contacts])
        self.restitution = np.array([c.restitution for c in scene.contacts], float)
        # Of each slider +1, -1 or 0 where it sticks; of each contact whether it rests.
        self.slip, self.rest = np.zeros(len(bounds), int), np.zeros(self.gap.size, bool)

    def with_supports(self, t: float, values: np.ndarray, what: str) -> np.ndarray:
        """Displacements, velocities or accelerations of the bodies, then those of supports."""
        moved = [
            float(getattr(m, what)(np.array(t)))
            for m in (
                self.scene.motion,
                *(s.moved_by(self.scene.motion) for s in self.scene.supports),
            )
        ]
        return np.append(values, np.array(moved[1:]) - moved[0])

    def free(self, t: float, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Forces on the bodies without friction of sliders that stick, and without contacts."""
        ground, n = float(self.scene.motion.acceleration(np.array(t))), self.n
        force = -self.stiffness @ self.with_supports(t, u, "displacement")
        force -= self.damping @ self.with_supports(t, v, "velocity")
        force -= self.B.T @ (self.F * self.slip)
        for given in self.scene.forces:
            b = [body.name for body in self.scene.bodies].index(given.body)
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
        G = D[:, :n] / self.mass @ D[:, :n].T
        found = -np.linalg.lstsq(G, D @ a, 1e-9)[0] if D.shape[0] else np.zeros(0)
        a[:n] += D[:, :n].T @ found / self.mass
        return a, found

    def acceleration(self, t: float, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Of the bodies."""
        return self.balanced(t, u, v)[0][: self.n]

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
                events.append(lambda t, y, i=i: p.slip[i] * float(
                    p.B[i] @ p.with_supports(t, y[n:], "velocity")) + NOISE * p.speed)  # fmt: skip
                owners.append(("slip", i))
            for j in np.flatnonzero(~p.rest):
                events.append(lambda t, y, j=j: p.gap[j] + float(p.W[j] @ p.with_supports(
                    t, y[:n], "displacement")) + NOISE * length)  # fmt: skip
                owners.append(("contact", j))
            if p.held().shape[0]:
                events.append(lambda t, y: p.margin(t, y[:n], y[n:]) + NOISE)
                owners.append(("held", 0))
            for function in events:
                function.terminal, function.direction = True, -1.0  # type: ignore[attr-defined]
            tolerances = {"rtol": TOLERANCE, "atol": 1e-15 * length, "max_step": end / MOST_STEPS}
            run = solve_ivp(rate, (t, stop), np.concatenate((u, v)), "DOP853", events=events,
                            **tolerances)  # fmt: skip
            before, t = p.with_supports(t, u, "displacement"), float(run.t[-1])
            u, v = np.split(run.y[:, -1], 2)
            moved = p.B @ (p.with_supports(t, u, "displacement") - before)
            answer.path += np.abs(moved) * (p.slip != 0)
            gaps = p.gap + p.W @ p.with_supports(t, u, "displacement")
            if (gaps[~p.rest] < -PASSED * length).any():
                raise ArithmeticError("an impact within a step was not seen")
            struck, closing = False, set()
            for (kind, i), times in zip(owners, run.t_events, strict=True):
                if times.size and kind == "contact":
                    closing.add(i)
                    answer.impacts.append(t)
                elif times.size:
                    answer.turns.append(t)
                struck |= times.size > 0
            v = p.strike(t, u, v, closing) if closing else v
            if len(answer.impacts) + len(answer.turns) > MOST_EVENTS:
                raise ArithmeticError("events accumulate")
            if struck:
                p.decide(t, u, v)
    answer.u, answer.v = u, v
    return answer
