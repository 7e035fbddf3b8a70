"""Pounding structures from the paper's equations alone: a program of NumPy and SciPy.

It shares nothing with the package, neither code nor method: hysteresis in rate form (eq. 3),
SciPy's DOP853 from event to event, complementarity problems by trying every set of contacts.
Between events all signs are frozen (of velocities, of springs with a kink, of which contacts are
closed), so that the integrator never meets a kink; an event is where a sign stops being true.

    M u'' + C u' + K u + Q z + springs = W λ − M 1 a_g(t),   z' as eq. 3, 0 ≤ g ⊥ λ ≥ 0
    impacts: 0 ≤ γ⁺ + ε γ⁻ ⊥ Λ ≥ 0 over closed contacts that do not separate
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import combinations, pairwise

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq

Array = np.ndarray
Motion = Iterable[tuple[float, float, Callable[[float], float]]]
"""Stretches of time with the ground's acceleration, smooth within each."""
RTOL = 1e-11
# Parts of the scales of displacement, velocity and force that count as zero. A bounce lower than
# CLOSED is none, so speeds below its square root have to come to rest; KINK and STILL are more
# than what a body moves and gains in the last digit of the time.
CLOSED, TOUCHING, KINK, STILL, SLOW, PULL = 2e-14, 1e-12, 1e-11, 1e-11, 1e-6, 1e-12
# Where a step is looked at: parts of it, beside halves of halves after an event.
PARTS = np.linspace(0.0, 1.0, 9)[1:]
HALVES = 0.5 ** np.arange(40, 3, -1)
MOST_EVENTS = 1000


@dataclass(frozen=True)
class Kinked:
    """An elastic spring from one body to another (-1: the ground), two stiffnesses (N/m)."""

    first: int
    second: int
    compression: float
    extension: float


@dataclass(frozen=True)
class Row:
    """Bodies in a row, each on a Bouc-Wen spring and a dashpot to the ground.

    Parameters
    ----------
    mass, stiffness, strength, yield_displacement, damping : sequence
        Of each body; an elastic one has no strength.
    gaps : tuple of (int, int, float)
        Left body, right body (-1: a barrier on the right), gap at rest (m).
    restitution : float
        Of all contacts.
    springs : tuple of Kinked
        Further ones.
    """

    mass: Array
    stiffness: Array
    strength: Array
    yield_displacement: Array
    damping: Array
    gaps: tuple[tuple[int, int, float], ...]
    restitution: float
    springs: tuple[Kinked, ...] = ()
    exponent: int = 20


@dataclass
class Signs:
    """What is frozen between two events."""

    velocity: Array
    spring: Array
    closed: list[int] = field(default_factory=list)


@dataclass
class Answer:
    """Largest |u| of each body, impacts, ends of continuous contact, and rows asked for."""

    peak: Array
    impacts: int = 0
    detachments: list[float] = field(default_factory=list)
    rows: list[Array] = field(default_factory=list)


def in_series(one: float, other: float) -> float:
    """Stiffness of two springs in a chain."""
    return one * other / (one + other)


class Program:
    """A row under a motion.

    Parameters
    ----------
    row : Row
        What moves.
    length, omega : float
        Scales of displacement (m) and frequency (rad/s), for tolerances.
    """

    def __init__(self, row: Row, length: float, omega: float) -> None:
        self.row, self.n = row, len(row.mass)
        self.length, self.speed = length, length * omega
        self.force = float(np.max(row.mass)) * length * omega**2
        self.w = np.zeros((self.n, len(row.gaps)))
        self.gap = np.array([gap for *_, gap in row.gaps])
        for j, (left, right, _) in enumerate(row.gaps):
            self.w[left, j] = -1.0
            if right >= 0:
                self.w[right, j] = 1.0
        self.b = np.zeros((self.n, len(row.springs)))
        for k, spring in enumerate(row.springs):
            for body, sign in ((spring.first, -1.0), (spring.second, 1.0)):
                if body >= 0:
                    self.b[body, k] += sign
        self.sides = np.array([(s.compression, s.extension) for s in row.springs]).reshape(-1, 2)
        self.delassus = self.w.T @ (self.w / row.mass[:, None])
        self.ground: Callable[[float], float] = lambda t: 0.0

    def free(self, t: float, y: Array, signs: Signs) -> Array:
        """Accelerations without contact forces, shape (n,)."""
        row, n = self.row, self.n
        u, v, z = y[:n], y[n : 2 * n], y[2 * n :]
        force = row.stiffness * u + row.damping * v + row.strength * z
        if row.springs:
            stiffness = np.where(signs.spring > 0.0, self.sides[:, 1], self.sides[:, 0])
            force = force + self.b @ (stiffness * (self.b.T @ u))
        return np.asarray(-force / row.mass - self.ground(t))

    def forces(self, acceleration: Array, closed: list[int]) -> Array:
        """Contact forces that keep closed contacts closed."""
        matrix = self.delassus[np.ix_(closed, closed)]
        return np.linalg.solve(matrix, -self.w[:, closed].T @ acceleration)

    def rates(self, t: float, y: Array, signs: Signs) -> Array:
        """Right-hand side, shape (3n,)."""
        row, n = self.row, self.n
        v, z = y[n : 2 * n], y[2 * n :]
        a = self.free(t, y, signs)
        if signs.closed:
            a = a + self.w[:, signs.closed] @ self.forces(a, signs.closed) / row.mass
        power = np.abs(z) ** (row.exponent - 1)
        shape = 0.5 * signs.velocity * z * power + 0.5 * np.abs(z) * power
        return np.concatenate((v, a, v * (1.0 - shape) / row.yield_displacement))

    def margins(self, t: float, y: Array, signs: Signs) -> Array:
        """Numbers that are positive as long as the signs are true."""
        n = self.n
        u, v = y[:n], y[n : 2 * n]
        opened = [j for j in range(self.gap.size) if j not in signs.closed]
        parts = [
            signs.velocity * v + STILL * self.speed,
            (self.gap + self.w.T @ u)[opened] + CLOSED * self.length,
        ]
        if self.row.springs:
            parts.append(signs.spring * (self.b.T @ u) + KINK * self.length)
        if signs.closed:
            forces = self.forces(self.free(t, y, signs), signs.closed)
            parts.append(forces + PULL * self.force)
        return np.concatenate(parts)

    def advance(self, t: float, y: Array, end: float, signs: Signs) -> tuple[float, Array, bool]:
        """On to the next event or to the end, and whether it is an event."""
        scale = np.repeat([self.length, self.speed, 1.0], self.n)
        solver = DOP853(
            lambda s, x: self.rates(s, x, signs), t, y, end, rtol=RTOL, atol=RTOL * scale
        )
        parts = np.concatenate((HALVES, PARTS))
        while solver.status == "running":
            solver.step()
            dense, before = solver.dense_output(), solver.t_old
            for s in before + (solver.t - before) * parts:
                if (self.margins(s, dense(s), signs) < 0.0).any():
                    t = min(self._crossings(dense, before, s, signs))
                    return t, dense(t), True
                before = s
            parts = PARTS
        return end, solver.y, False

    def _crossings(self, dense: Callable, low: float, high: float, signs: Signs) -> Iterator[float]:
        """Times at which a margin falls below zero."""
        ends = self.margins(low, dense(low), signs), self.margins(high, dense(high), signs)
        for i in np.flatnonzero(ends[1] < 0.0):
            if ends[0][i] <= 0.0:
                yield low
            else:
                yield brentq(
                    lambda s, i=i: self.margins(s, dense(s), signs)[i], low, high, xtol=1e-15
                )

    def impact(self, v: Array, closed: list[int], restitution: float) -> Array:
        """Velocities after the impact problem of some contacts, by trying every set of them."""
        before = self.w.T @ v
        for count in range(len(closed) + 1):
            for chosen in map(list, combinations(closed, count)):
                wanted = -(1.0 + restitution) * before[chosen]
                impulse = np.linalg.solve(self.delassus[np.ix_(chosen, chosen)], wanted)
                after = v + self.w[:, chosen] @ impulse / self.row.mass
                rest = (self.w.T @ after + restitution * before)[closed]
                if (impulse >= 0.0).all() and (rest >= -1e-12 * self.speed).all():
                    return np.asarray(after)
        raise RuntimeError("no solution of an impact")

    def pressed(self, a: Array, touching: list[int]) -> list[int]:
        """Contacts with a force, by trying every set of those that touch."""
        for count in range(len(touching) + 1):
            for chosen in map(list, combinations(touching, count)):
                force = self.forces(a, chosen) if chosen else np.zeros(0)
                after = a + self.w[:, chosen] @ force / self.row.mass
                rest = (self.w.T @ after)[touching]
                if (force >= 0.0).all() and (rest >= -1e-9 * np.abs(a).max()).all():
                    return chosen
        raise RuntimeError("no solution of the contact forces")

    def settle(self, t: float, y: Array, signs: Signs, answer: Answer) -> tuple[Array, Signs]:
        """Impacts, rests and the signs from now on."""
        n, y = self.n, y.copy()
        gap = self.gap + self.w.T @ y[:n]
        touching = [int(j) for j in np.flatnonzero(gap <= TOUCHING * self.length)]
        for _ in range(MOST_EVENTS):
            rate = self.w.T @ y[n : 2 * n]
            if not any(rate[j] < -SLOW * self.speed for j in touching):
                break
            taking_part = [j for j in touching if rate[j] <= SLOW * self.speed]
            y[n : 2 * n] = self.impact(y[n : 2 * n], taking_part, self.row.restitution)
            answer.impacts += 1
        rate = self.w.T @ y[n : 2 * n]
        slow = [j for j in touching if abs(rate[j]) <= SLOW * self.speed]
        # What touches stands on its contact, and what is slow stops.
        for part, value, which in ((y[:n], gap, touching), (y[n : 2 * n], rate, slow)):
            if which:
                moved = np.linalg.solve(self.delassus[np.ix_(which, which)], -value[which])
                part += self.w[:, which] @ moved / self.row.mass
        new = Signs(signs.velocity.copy(), signs.spring.copy())
        elongation = self.b.T @ y[:n]
        rates = self.b.T @ y[n : 2 * n]
        near = np.abs(elongation) <= 0.5 * KINK * self.length
        new.spring = np.where(np.where(near, rates, elongation) < 0.0, -1.0, 1.0)
        a = self.free(t, y, new)
        new.closed = self.pressed(a, slow)
        if new.closed:
            a = a + self.w[:, new.closed] @ self.forces(a, new.closed) / self.row.mass
        v = y[n : 2 * n]
        still = np.abs(v) <= 0.5 * STILL * self.speed
        new.velocity = np.where(np.where(still, a, v) < 0.0, -1.0, 1.0)
        if set(signs.closed) - set(new.closed):
            answer.detachments.append(t)
        return y, new

    def run(self, motion: Motion, times: Array | None = None) -> Answer:
        """From rest through all stretches of the motion.

        Parameters
        ----------
        motion : iterable
            Its stretches, one after the other.
        times : ndarray, optional
            Ends of stretches at which displacements are wanted.
        """
        n, y = self.n, np.zeros(3 * self.n)
        answer = Answer(np.zeros(n))
        signs = Signs(np.ones(n), np.ones(self.b.shape[1]))
        wanted = set() if times is None else set(times.tolist())
        for start, end, ground in motion:
            self.ground, t = ground, start
            y, signs = self.settle(t, y, signs, answer)
            for _ in range(MOST_EVENTS):
                # A step that DOP853 tries and rejects may be so long that z^20 overflows.
                with np.errstate(over="ignore", invalid="ignore"):
                    t, y, event = self.advance(t, y, end, signs)
                answer.peak = np.maximum(answer.peak, np.abs(y[:n]))
                if not event:
                    break
                y, signs = self.settle(t, y, signs, answer)
            else:
                raise RuntimeError(f"t = {t}: events without end")
            if end in wanted:
                answer.rows.append(y[:n].copy())
        return answer


def pulse(kind: str, a_p: float, omega_p: float, reverse: bool, end: float) -> Motion:
    """A sine, a cosine, or a type-C1 pulse of Makris and Chang, and the rest after it."""
    a, period = -a_p if reverse else a_p, 2.0 * np.pi / omega_p
    stop = period
    if kind == "type-c":
        phase = brentq(
            lambda p: np.cos(3 * np.pi - p) + (3 * np.pi - 2 * p) * np.sin(p) - np.cos(p), 0.0, 0.5
        )
        stop = (1.5 - phase / np.pi) * period
        yield 0.0, stop, lambda t: a * np.cos(omega_p * t + phase)
    elif kind == "sine":
        yield 0.0, stop, lambda t: a * np.sin(omega_p * t)
    else:
        yield 0.0, stop, lambda t: a * np.cos(omega_p * t)
    yield stop, end, lambda t: 0.0


def sampled(samples: Array, step: float, end: float, times: Array | None = None) -> Motion:
    """A record, linear between its samples, nothing after it; stretches end at `times`, too."""
    more = np.zeros(0) if times is None else times
    corners = step * np.arange(samples.size)
    ends = np.unique(np.concatenate((corners[corners < end], more, [end])))
    for start, stop in pairwise(ends):
        i = int(np.searchsorted(corners, start, side="right")) - 1
        if start >= corners[-1]:
            yield start, stop, lambda t: 0.0
            continue
        slope = (samples[i + 1] - samples[i]) / step
        yield start, stop, lambda t, i=i, slope=slope: samples[i] + slope * (t - corners[i])
