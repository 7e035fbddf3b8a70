"""A row of bodies on linear springs and dashpots with contact laws, by SciPy's DOP853.

Written from the formulas alone, for scenes without Newton contacts. Each closing and opening ends
a piece, and so does the end of an approach, so that the integrator never crosses a kink.
"""

import math
from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

from eventpound.numerics.arrays import Floats
from eventpound.scene import Linear, Scene


class Program:
    """A scene; `final` carries it to a time."""

    def __init__(self, scene: Scene) -> None:
        index = {body.name: i for i, body in enumerate(scene.bodies)}
        n = len(scene.bodies)
        self.scene, self.n = scene, n
        self.mass = np.array([body.mass for body in scene.bodies])
        self.stiffness, self.damping = np.zeros((n, n)), np.zeros((n, n))
        for spring in scene.springs:
            assert isinstance(spring.law, Linear)
            _add(self.stiffness, [index.get(e) for e in spring.between], spring.law.stiffness)
        for dashpot in scene.dashpots:
            _add(self.damping, [index.get(e) for e in dashpot.between], dashpot.coefficient)
        self.ends = [(index.get(c.left), index.get(c.right)) for c in scene.contacts]
        self.closed = [False] * len(self.ends)
        self.approach = [0.0] * len(self.ends)
        self.nearing = [True] * len(self.ends)

    def gap(self, j: int, y: Floats) -> tuple[float, float]:
        """Gap of contact j and its rate."""
        left, right = self.ends[j]
        u = [0.0 if b is None else y[b] for b in (left, right)]
        v = [0.0 if b is None else y[self.n + b] for b in (left, right)]
        return self.scene.contacts[j].gap + u[1] - u[0], v[1] - v[0]

    def force(self, j: int, y: Floats) -> float:
        """Force of contact j, were it closed."""
        contact = self.scene.contacts[j]
        law, masses = contact.law, [self.mass[b] for b in self.ends[j] if b is not None]
        assert law is not None
        m, k = 1.0 / sum(1.0 / each for each in masses), law.stiffness
        gap, rate = self.gap(j, y)
        d, d_rate, constant = max(-gap, 0.0), -rate, contact.damping or 0.0
        match law.kind:
            case "linear" | "kelvin-voigt":
                found = -k * gap + 2.0 * constant * math.sqrt(k * m) * d_rate
                return found if law.tension else max(found, 0.0)
            case "hertz-damp":
                part = constant * d_rate / self.approach[j] if self.approach[j] > 0.0 else 0.0
                return k * d**1.5 * (1.0 + part)
            case "jankowski" if self.nearing[j]:
                return k * d**1.5 + 2.0 * constant * math.sqrt(k * math.sqrt(d) * m) * d_rate
        return k * d**1.5

    def rate(self, t: float, y: Floats) -> Floats:
        """Rate of the state."""
        u, v = y[: self.n], y[self.n :]
        f = -self.stiffness @ u - self.damping @ v
        for j, (left, right) in enumerate(self.ends):
            if self.closed[j]:
                push = self.force(j, y)
                if left is not None:
                    f[left] -= push
                if right is not None:
                    f[right] += push
        ground = float(self.scene.motion.acceleration(np.array([t]))[0])
        return np.concatenate((v, f / self.mass - ground))

    def final(self, end: float, breaks: tuple[float, ...] = (), rtol: float = 1e-12) -> Floats:
        """The state at `end` (s), from time zero; kinks of the ground motion at `breaks`."""
        y = np.concatenate(
            [[getattr(b, key) for b in self.scene.bodies] for key in ("displacement", "velocity")]
        )
        for j in range(len(self.ends)):
            self.closed[j] = self.gap(j, y)[0] < 0.0
            self.nearing[j] = self.gap(j, y)[1] < 0.0
        t = 0.0
        for stop in (*[b for b in breaks if 0.0 < b < end], end):
            while t < stop:
                t, y = self._piece(t, y, stop, rtol)
        return y

    def _piece(self, t: float, y: Floats, stop: float, rtol: float) -> tuple[float, Floats]:
        watched = [self._passing(j) for j in range(len(self.ends))]
        watched += [self._turning(j) for j in range(len(self.ends))]
        run = solve_ivp(self.rate, (t, stop), y, "DOP853", rtol=rtol, atol=1e-15, events=watched)
        t, y = float(run.t[-1]), run.y[:, -1]
        for j in range(len(self.ends)):
            if run.status == 1 and run.t_events[j].size:
                self.closed[j] = not self.closed[j]
                self.nearing[j] = self.closed[j]
                self.approach[j] = -self.gap(j, y)[1]
            if run.status == 1 and run.t_events[len(self.ends) + j].size:
                self.nearing[j] = not self.nearing[j]
        return t, y

    def _passing(self, j: int) -> Callable[[float, Floats], float]:
        def value(_: float, y: Floats) -> float:
            return self.gap(j, y)[0]

        value.terminal = True  # type: ignore[attr-defined]
        value.direction = 1.0 if self.closed[j] else -1.0  # type: ignore[attr-defined]
        return value

    def _turning(self, j: int) -> Callable[[float, Floats], float]:
        def value(_: float, y: Floats) -> float:
            return self.gap(j, y)[1] if self.closed[j] else 1.0

        value.terminal = True  # type: ignore[attr-defined]
        value.direction = 1.0 if self.nearing[j] else -1.0  # type: ignore[attr-defined]
        return value


def _add(matrix: Floats, ends: list[int | None], value: float) -> None:
    """Add a spring or dashpot between two bodies, None for the ground."""
    for b in ends:
        if b is not None:
            matrix[b, b] += value
    first, second = ends
    if first is not None and second is not None:
        matrix[first, second] -= value
        matrix[second, first] -= value
