"""What a user has to know of a scene whose program has events but no contacts: modes, and rules.

    u' = v,    v' = -(k u + Q z)/m - a_g(t),    z' = (v/u_y) (1 - loading z^20)

with beta = gamma = 1/2, so that a spring is loading while v z > 0; it has yielded where z^20 is
1 but for rounding, and keeps its z until it turns. Contacts follow Newton's law; a body that
bounces back by less than `SLOW` of the speed of the motion is held at its barrier until it is
pulled away. A run is cut at whatever changes a mode, which is an event of the program:

    v_i = 0,    z_i = 0,    z_i² = NEAR²,    z_i² = YIELDED²,    g_j = 0 closing,    pull = 0

`NEAR` changes nothing: it ends a step, since below it z^20 hides from the terms of a series.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from eventpound.motion.base import Family
from eventpound.scene import BARRIER
from eventpound.solvers.base import Task
from tests.benchmarks.answers import Answer, Impact

NEAR, YIELDED = 0.3, 1.0 - 1e-13
SLOW = 1e-8
OF_A_BODY = 4
"""Events of each body, before those of the contacts and the pull."""


@dataclass(frozen=True)
class Stretch:
    """Of the ground motion, up to `end` (s): a_g = a + b (t - start) + A cos(w t + p)."""

    end: float
    start: float
    a: float
    b: float
    A: float


class Row:
    """Numbers of N bodies, each on a spring to the ground, and of K contacts, of a task.

    Attributes
    ----------
    m, k, Q, u_y : list of float
        Of the bodies and springs.
    ends : list of tuple of int
        Bodies at the left and right of each contact, -1 for a barrier.
    gaps, restitution : list of float
        Of the contacts.
    stretches : list of Stretch
        The ground motion.
    omega, phase : float
        Of its cosine.
    """

    def __init__(self, task: Task) -> None:
        scene, laws = task.scene, [spring.law for spring in task.scene.springs]
        place = {body.name: i for i, body in enumerate(scene.bodies)} | {BARRIER: -1}
        self.m = [body.mass for body in scene.bodies]
        self.k, self.Q, self.u_y = (
            [getattr(law, name) for law in laws]
            for name in ("stiffness", "strength", "yield_displacement")
        )
        self.ends = [(place[c.left], place[c.right]) for c in scene.contacts]
        self.gaps = [c.gap for c in scene.contacts]
        self.restitution = [c.restitution or 0.0 for c in scene.contacts]
        self.speed = scene.motion.scales().length * scene.motion.scales().omega_g
        self.omega = self.phase = 0.0
        self.stretches: list[Stretch] = []
        for piece in scene.motion.pieces():
            numbers, end = piece.coefficients.tolist(), min(piece.end, task.end)
            if piece.family is Family.SAMPLES:
                start, step = numbers
                t = start + step * np.arange(piece.samples.size)
                slopes = (np.diff(piece.samples) / step).tolist()
                of = t[1:].tolist(), t.tolist(), piece.samples.tolist(), slopes
                lines = zip(*of, strict=False)
                self.stretches += [Stretch(min(to, end), *line, 0.0) for to, *line in lines]
            elif piece.family is Family.SINUSOIDS:
                start, amplitude, self.omega, phase = numbers
                self.phase = phase - self.omega * start
                self.stretches.append(Stretch(end, 0.0, 0.0, 0.0, amplitude))
            elif end > task.start:
                self.stretches.append(Stretch(end, 0.0, 0.0, 0.0, 0.0))


class Modes:
    """In which mode a run is, and what it has seen.

    Attributes
    ----------
    loading, flowing, free : list of float
        1 or 0 of each body: of the equation above, whether z changes, whether the body moves.
    """

    def __init__(self, row: Row) -> None:
        n = len(row.m)
        self.row, self.impacts = row, list[Impact]()
        self.loading, self.flowing, self.free = [1.0] * n, [1.0] * n, [1.0] * n
        self.way, self.side = [0.0] * n, [0.0] * n
        self.lowest, self.highest = [0.0] * n, [0.0] * n

    def pull(self, i: int, t: float, y: Any, stretch: Stretch) -> float:
        """Acceleration of body i, if it is let go."""
        row, n = self.row, len(self.way)
        a_g = stretch.a + stretch.b * (t - stretch.start)
        a_g += stretch.A * math.cos(row.omega * t + row.phase)
        return float(-(row.k[i] * y[i] + row.Q[i] * y[2 * n + i]) / row.m[i] - a_g)

    def begin(self, t: float, y: Any, stretch: Stretch) -> None:
        """From rest, with z = 0."""
        for i in range(len(self.way)):
            self._goes(i, self.pull(i, t, y, stretch) or self.pull(i, t + 1e-6, y, stretch))
            self.side[i] = self.way[i]
            self._sort(i)

    def happens(self, event: int, t: float, y: Any, stretch: Stretch) -> None:
        """Take what an event changes, of the state y = (u, v, z) too."""
        n = len(self.way)
        i, kind = divmod(event, OF_A_BODY)
        self.see(y)
        if i >= n:
            self._meets(event - OF_A_BODY * n, t, y, stretch)
        elif kind == 0 and self.free[i]:
            self._goes(i, self.pull(i, t, y, stretch))
        elif kind == 1:
            self.side[i] = self.way[i]
        elif kind == 3 and self.loading[i]:
            self.flowing[i] = 0.0
        for i in range(n):
            self._sort(i)

    def see(self, y: Any) -> None:
        """Take displacements into the extremes."""
        for i in range(len(self.way)):
            self.lowest[i] = min(self.lowest[i], y[i])
            self.highest[i] = max(self.highest[i], y[i])

    def answer(self, y: Any) -> Answer:
        """What is judged."""
        self.see(y)
        u = np.array(y[: len(self.way)], float)
        return Answer(np.array(self.lowest), np.array(self.highest), u, tuple(self.impacts))

    def _goes(self, i: int, way: float) -> None:
        self.way[i] = math.copysign(1.0, way)

    def _sort(self, i: int) -> None:
        """Whether the spring of body i is loading."""
        self.loading[i] = 1.0 if self.way[i] * self.side[i] > 0.0 else 0.0
        if not self.loading[i]:
            self.flowing[i] = 1.0

    def _meets(self, j: int, t: float, y: Any, stretch: Stretch) -> None:
        row, n = self.row, len(self.way)
        if j == len(row.ends):
            self.free[0], self.way[0] = 1.0, -1.0
            return
        left, right = row.ends[j]
        speed = y[n + left] - (y[n + right] if right >= 0 else 0.0)
        inverse = [1.0 / row.m[left], 1.0 / row.m[right] if right >= 0 else 0.0]
        impulse = (1.0 + row.restitution[j]) * speed / sum(inverse)
        y[n + left] -= impulse * inverse[0]
        if right >= 0:
            y[n + right] += impulse * inverse[1]
        self.impacts.append(Impact(t, j, float(speed)))
        for i in {left, right} - {-1}:
            self._goes(i, y[n + i])
        if right < 0 and speed < SLOW * row.speed and self.pull(left, t, y, stretch) > 0.0:
            y[n + left], self.free[left] = 0.0, 0.0
