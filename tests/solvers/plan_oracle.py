"""Decks in plan by SciPy alone: DOP853 between events, every decision by going through all cases.

Coordinates u, v and the angle θ itself, masses m, m and J; contacts as rows of a matrix that are
written here anew from the shape of the decks. Nothing of the package but classes of its scene, and
the acceleration of a motion at a time.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import chain, combinations
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from eventpound.numerics.arrays import Floats
from eventpound.scene import BARRIER, Deck, Scene
from eventpound.scene.joint import Joint

TOO_FAST = 1e-4
"""Interval between impacts (s) below which a scene is left to others."""
MOST_PIECES = 100
"""Smooth pieces of a motion."""
_RTOL, _ATOL, _STILL = 1e-13, 1e-15, 1e-9


class LeftAloneError(Exception):
    """Impacts follow each other too fast for this program."""


@dataclass
class Plan:
    """Arrays of decks in plan: M (n,), K and C (n, n), pushes (n, 2), W (k, n), gaps and ε (k,)."""

    mass: Floats
    stiffness: Floats
    damping: Floats
    pushed: Floats
    W: Floats
    gap: Floats
    restitution: Floats
    motions: tuple[Any, Any]
    impacts: list[tuple[float, tuple[int, ...]]] = field(default_factory=list)

    def free(self, t: float, q: Floats, v: Floats) -> Floats:
        """Accelerations without contacts."""
        ground = np.array([float(m.acceleration(np.array(t))) for m in self.motions])
        pulled = -self.stiffness @ q - self.damping @ v
        return pulled / self.mass - np.einsum("ij,j->i", self.pushed, ground)

    def pressed(self, t: float, q: Floats, v: Floats, rests: tuple[int, ...]) -> Floats:
        """Forces of resting contacts that keep their gaps from accelerating."""
        W = self.W[list(rests)]
        return np.linalg.solve(W / self.mass @ W.T, -W @ self.free(t, q, v))

    def rate(self, t: float, y: Floats, rests: tuple[int, ...]) -> Floats:
        """y' of y = (q, v)."""
        q, v = np.split(y, 2)
        a = self.free(t, q, v)
        if rests:
            a = a + self.W[list(rests)].T @ self.pressed(t, q, v, rests) / self.mass
        return np.concatenate((v, a))

    def struck(self, v: Floats, closed: list[int]) -> Floats:
        """Velocities after an impact at closed contacts, none of which separates."""
        for some in _subsets(closed):
            W = self.W[list(some)]
            after = (1.0 + self.restitution[list(some)]) * (W @ v)
            impulse = np.linalg.solve(W / self.mass @ W.T, -after) if some else np.zeros(0)
            new = v + W.T @ impulse / self.mass
            left = self.W[closed] @ new + self.restitution[closed] * (self.W[closed] @ v)
            if (impulse >= 0.0).all() and (left >= -1e-13).all():
                return new
        raise AssertionError("no impact found")

    def resting(self, t: float, q: Floats, v: Floats, candidates: list[int]) -> tuple[int, ...]:
        """Those of contacts without gap and rate that stay closed."""
        for some in _subsets(candidates):
            a = self.rate(t, np.concatenate((q, v)), some)[q.size :]
            force = self.pressed(t, q, v, some) if some else np.zeros(0)
            others = [j for j in candidates if j not in some]
            if (force >= 0.0).all() and (self.W[others] @ a >= 0.0).all():
                return some
        raise AssertionError("no accelerations found")

    def _gap_of(self, j: int) -> Any:
        """Event of a gap that closes."""
        return _downward(lambda t, y: self.gap[j] + self.W[j] @ y[: y.size // 2])

    def _force_of(self, i: int, rests: tuple[int, ...]) -> Any:
        """Event of a contact that lets go."""
        n = self.mass.size
        return _downward(lambda t, y: self.pressed(t, y[:n], y[n:], rests)[i])

    def at_times(self, y: Floats, times: Floats) -> Floats:
        """States at times, the first of which is the start, shape (len(times), 2 n)."""
        t, end, rows, last = float(times[0]), float(times[-1]), [y], -np.inf
        gone: list[int] = []
        for _ in range(MOST_PIECES):
            if t >= end:
                return np.array(rows)
            q, v = np.split(y, 2)
            gaps = self.gap + self.W @ q
            closed = [j for j in range(gaps.size) if abs(gaps[j]) < _STILL and j not in gone]
            rates = self.W @ v
            candidates = [j for j in closed if abs(rates[j]) < _STILL]
            rests = self.resting(t, q, v, candidates)
            begun = set(rests)

            watched = [j for j in range(gaps.size) if j not in begun]
            events = [self._gap_of(j) for j in watched]
            events += [self._force_of(i, rests) for i in range(len(rests))]
            found = solve_ivp(
                lambda s, y, rests=rests: self.rate(s, y, rests), (t, end), y, "DOP853",
                rtol=_RTOL, atol=_ATOL, dense_output=True, events=events, first_step=1e-5,
                max_step=0.02,
            )  # fmt: skip
            assert found.success
            due = times[len(rows) :]
            rows += [found.sol(s) for s in due[due <= found.t[-1]]]
            t, y = float(found.t[-1]), found.y[:, -1].copy()
            gone = []
            if t >= end:
                continue
            q, v = np.split(y, 2)
            if rests and any(found.t_events[len(watched) + i].size for i in range(len(rests))):
                gone = [j for i, j in enumerate(rests) if found.t_events[len(watched) + i].size]
                continue
            gaps, rates = self.gap + self.W @ q, self.W @ v
            for _ in range(20):
                closed = [
                    j for j in range(gaps.size) if abs(gaps[j]) < _STILL and rates[j] < _STILL
                ]
                if not any(rates[j] < -_STILL for j in closed):
                    break
                v = self.struck(v, closed)
                rates = self.W @ v
                self.impacts.append((t, tuple(closed)))
            if t - last < TOO_FAST:
                raise LeftAloneError
            last = t
            y = np.concatenate((q, v))
        raise LeftAloneError


def _downward(value: Callable[[float, Floats], Any]) -> Any:
    def event(t: float, y: Floats) -> float:
        return float(value(t, y))

    event.terminal, event.direction = True, -1.0  # type: ignore[attr-defined]
    return event


def _subsets(of: list[int]) -> Any:
    return chain.from_iterable(combinations(of, k) for k in range(len(of) + 1))


def plan_of(scene: Scene, joints: list[Joint]) -> Plan:
    """Arrays of a scene of decks on springs and dashpots to the ground, one a coordinate."""
    decks = {deck.name: i for i, deck in enumerate(scene.decks)}
    n = 3 * len(decks)
    mass, K, C, pushed = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros((n, 2))
    cosine, sine = math.cos(scene.attack), math.sin(scene.attack)
    for name, i in decks.items():
        deck = scene.decks[i]
        # A parallelogram sheared by tan α, as a sum over its moments.
        shear = math.tan(deck.skew)
        J = deck.mass * (deck.length**2 + deck.width**2 * (1.0 + shear**2)) / 12.0
        r_squared = J / deck.mass
        mass[3 * i : 3 * i + 3] = deck.mass, deck.mass, J
        pushed[3 * i] = cosine, -sine
        pushed[3 * i + 1] = sine, cosine
        for k, (word, unit) in enumerate((("x", 1.0), ("y", 1.0), ("turn", r_squared))):
            for spring in scene.springs:
                if spring.between[1] == f"{name}.{word}":
                    K[3 * i + k] += unit * spring.law.stiffness  # type: ignore[union-attr]
            for dashpot in scene.dashpots:
                if dashpot.between[1] == f"{name}.{word}":
                    C[3 * i + k] += unit * dashpot.coefficient
    rows, gaps, restitution = [], list[float](), list[float]()
    for joint in joints:
        pair = [None if end == BARRIER else scene.decks[decks[end]] for end in joint.between]
        there = [deck for deck in pair if deck is not None]
        low = max(deck.centre[1] - deck.width / 2 for deck in there)
        high = min(deck.centre[1] + deck.width / 2 for deck in there)
        for y, gap in zip((low, high), joint.gap, strict=True):
            row = np.zeros(n)
            for end, sign in zip(pair, (-1.0, 1.0), strict=True):
                if end is not None:
                    i = 3 * decks[end.name]
                    row[i : i + 3] += sign * _row(end, -sign, y - end.centre[1])
            rows.append(row)
            gaps.append(gap)
            restitution.append(joint.restitution)
    return Plan(
        mass, np.diag(K), np.diag(C), pushed, np.reshape(rows, (-1, n)), np.array(gaps),
        np.array(restitution, float), (scene.motion, scene.across),
    )  # fmt: skip


def _row(deck: Deck, side: float, y: float) -> Floats:
    """What u, v and θ move a place of the right (1) or left (-1) edge along its normal."""
    edge = np.array([-math.sin(deck.skew), math.cos(deck.skew)])
    place = np.array([side * deck.length / 2, 0.0]) + edge * y / edge[1]
    normal = np.array([edge[1], -edge[0]])
    turned = np.array([-place[1], place[0]])
    return np.array([*normal, normal @ turned])
