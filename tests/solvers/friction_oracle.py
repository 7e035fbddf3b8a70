"""Decks in plan with friction by SciPy alone: DOP853 between events, states gone through.

Arrays as `tests.solvers.plan_oracle` has them, and tangential rows. A state is a letter a contact:
o open, + and - slipping, s sticking.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import product
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from eventpound.numerics.arrays import Floats
from tests.solvers.plan_oracle import TOO_FAST, LeftAloneError, Plan, plan_of

_RTOL, _ATOL, _STILL, _OFF = 1e-13, 1e-15, 1e-10, 1e-8
_WAY = {"+": 1.0, "-": -1.0}
MOST_PIECES = 400


@dataclass
class RubbingPlan:
    """A plan with tangential rows T (k, n) and μ (k,)."""

    plan: Plan
    T: Floats
    friction: Floats
    changes: list[tuple[float, str]] = field(default_factory=list)

    def held(self, state: str) -> tuple[Floats, Floats, list[int], list[int]]:
        """Rows that vanish, forces of the unknowns, and whose they are: normal, of sticks."""
        W, T, mu = self.plan.W, self.T, self.friction
        shut = [j for j, s in enumerate(state) if s != "o"]
        stuck = [j for j, s in enumerate(state) if s == "s"]
        rows = np.concatenate((W[shut], T[stuck]))
        pushes = [W[j] - _WAY.get(state[j], 0.0) * mu[j] * T[j] for j in shut]
        forces = np.concatenate((np.reshape(pushes, (-1, W.shape[1])), T[stuck]))
        return rows, forces, shut, stuck

    def answer(self, state: str, free: Floats, asked: Floats) -> tuple[Floats, Floats, Floats]:
        """Rates with forces in a state, and these (k,): rates free of them change to rows = asked.

        Raises LinAlgError where the equations depend on each other.
        """
        rows, forces, shut, stuck = self.held(state)
        G = rows / self.plan.mass @ forces.T
        size = np.sqrt(np.diag(rows / self.plan.mass @ rows.T))
        if shut and np.linalg.cond(G / np.outer(size, size)) > 1e9:
            raise np.linalg.LinAlgError
        wanted = np.concatenate((asked[shut], np.zeros(len(stuck))))
        x = np.linalg.solve(G, wanted - rows @ free) if shut else np.zeros(0)
        normal, tangential = np.zeros((2, len(state)))
        normal[shut] = x[: len(shut)]
        for j in shut:
            tangential[j] = -_WAY.get(state[j], 0.0) * self.friction[j] * normal[j]
        tangential[stuck] = x[len(shut) :]
        return free + forces.T @ x / self.plan.mass, normal, tangential

    def find(self, free: Floats, asked: Floats, choices: list[str]) -> tuple[str, Floats]:
        """The first state of all choices that keeps the inequalities, and the rates in it."""
        for letters in product(*choices):
            state = "".join(letters)
            try:
                rate, normal, tangential = self.answer(state, free, asked)
            except np.linalg.LinAlgError:
                continue
            size = _OFF * max(np.abs(free).max(), np.abs(rate).max())
            force = size * self.plan.mass.min()
            along, good = self.T @ rate, True
            for j, s in enumerate(state):
                if s == "o":
                    good &= len(choices[j]) == 1 or self.plan.W[j] @ rate >= asked[j] - size
                elif s == "s":
                    good &= abs(tangential[j]) <= self.friction[j] * normal[j] + force
                elif len(choices[j]) > 2:
                    good &= _WAY[s] * along[j] >= -size
                good &= normal[j] >= -force
            if good:
                return state, rate
        raise AssertionError("no state found")

    def struck(self, v: Floats, involved: list[int]) -> Floats:
        """Velocities after an impact."""
        k = len(self.friction)
        asked = -self.plan.restitution * (self.plan.W @ v)
        choices = ["o+-s" if j in involved else "o" for j in range(k)]
        return self.find(v, asked, choices)[1]

    def at_times(self, y: Floats, times: Floats) -> Floats:
        """States at times, the first of which is the start, shape (len(times), 2 n)."""
        t, end, rows, last = float(times[0]), float(times[-1]), [y], -np.inf
        W, T, k = self.plan.W, self.T, len(self.friction)
        gone, forced = set[int](), dict[int, str]()
        for _ in range(MOST_PIECES):
            if t >= end:
                return np.array(rows)
            q, v = np.split(y, 2)
            free = self.plan.free(t, q, v)
            gaps, rates, along = self.plan.gap + W @ q, W @ v, T @ v
            choices = []
            for j in range(k):
                shut = abs(gaps[j]) < _STILL and abs(rates[j]) < _STILL and j not in gone
                if not shut:
                    choices.append("o")
                elif j in forced:
                    choices.append("o" + forced[j])
                else:
                    slides = "o+" if along[j] > 0.0 else "o-"
                    choices.append("o+-s" if abs(along[j]) < _STILL else slides)
            state, _ = self.find(free, np.zeros(k), choices)
            self.changes.append((t, state))
            events, whose = self._events(state)
            found = solve_ivp(
                lambda s, y, state=state: self._rate(s, y, state), (t, end), y, "DOP853",
                rtol=_RTOL, atol=_ATOL, dense_output=True, events=events, first_step=1e-6,
                max_step=0.02,
            )  # fmt: skip
            assert found.success
            due = times[len(rows) :]
            rows += [found.sol(s) for s in due[due <= found.t[-1]]]
            t, y = float(found.t[-1]), found.y[:, -1].copy()
            gone, forced = set(), {}
            happened = [whose[i] for i, at in enumerate(found.t_events) if at.size]
            q, v = np.split(y, 2)
            for kind, j in happened:
                if kind == "release":
                    gone.add(j)
                elif kind in ("+", "-"):
                    forced[j] = kind
                elif kind == "stop":
                    rows_now = [W[i] for i, s in enumerate(state) if s != "o"]
                    rows_now += [T[i] for i, s in enumerate(state) if s == "s" or i == j]
                    H = np.array(rows_now)
                    v -= np.linalg.lstsq(H, H @ v, rcond=1e-12)[0]
            if any(kind == "close" for kind, _ in happened):
                if t - last < TOO_FAST:
                    raise LeftAloneError
                last, v = t, self._impacts(t, q, v)
            y = np.concatenate((q, v))
        raise LeftAloneError

    def _impacts(self, t: float, q: Floats, v: Floats) -> Floats:
        W = self.plan.W
        for _ in range(20):
            rates, gaps = W @ v, self.plan.gap + W @ q
            closed = [j for j in range(gaps.size) if abs(gaps[j]) < _STILL and rates[j] < _STILL]
            if not any(rates[j] < -_STILL for j in closed):
                return v
            v = self.struck(v, closed)
            self.changes.append((t, "impact"))
        raise LeftAloneError

    def _rate(self, t: float, y: Floats, state: str) -> Floats:
        q, v = np.split(y, 2)
        a = self.answer(state, self.plan.free(t, q, v), np.zeros(len(state)))[0]
        return np.concatenate((v, a))

    def _events(self, state: str) -> tuple[list[Any], list[tuple[str, int]]]:
        n, events, whose = self.plan.mass.size, list[Any](), list[tuple[str, int]]()

        def forces(t: float, y: Floats) -> tuple[Floats, Floats]:
            free = self.plan.free(t, y[:n], y[n:])
            return self.answer(state, free, np.zeros(len(state)))[1:]

        def add(kind: str, j: int, value: Callable[[float, Floats], Any]) -> None:
            def event(t: float, y: Floats) -> float:
                return float(value(t, y))

            event.terminal, event.direction = True, -1.0  # type: ignore[attr-defined]
            events.append(event)
            whose.append((kind, j))

        for j, s in enumerate(state):
            if s == "o":
                add("close", j, lambda t, y, j=j: self.plan.gap[j] + self.plan.W[j] @ y[:n])
                continue
            add("release", j, lambda t, y, j=j: forces(t, y)[0][j])
            if s == "s":
                mu = self.friction[j]
                for way in ("+", "-"):
                    # At its bound against a slip forwards friction is -μ λ.
                    add(way, j, lambda t, y, j=j, mu=mu, f=_WAY[way]: (
                        mu * forces(t, y)[0][j] + f * forces(t, y)[1][j]))  # fmt: skip
            elif not self._tied(j, state):
                add("stop", j, lambda t, y, j=j, f=_WAY[s]: f * (self.T[j] @ y[n:]))
        return events, whose

    def _tied(self, j: int, state: str) -> bool:
        """Whether what is closed and sticks keeps a contact from sliding."""
        rows = self.held(state)[0]
        left = self.T[j] - rows.T @ np.linalg.lstsq(rows.T, self.T[j], rcond=None)[0]
        return bool(np.linalg.norm(left) < 1e-9 * np.linalg.norm(self.T[j]))


def rubbing_plan(scene: Any, joints: list[Any]) -> RubbingPlan:
    """Arrays of a scene whose contacts are those of joints, in their order."""
    plan = plan_of(scene, joints)
    decks = {deck.name: i for i, deck in enumerate(scene.decks)}
    rows = np.zeros(plan.W.shape)
    for j, contact in enumerate(scene.contacts):
        joint, upper = joints[j // 2], j % 2 == 1
        there = [scene.decks[decks[end]] for end in joint.between if end in decks]
        sides = [d.centre[1] + (0.5 if upper else -0.5) * d.width for d in there]
        y = min(sides) if upper else max(sides)
        for end, sign, side in zip(joint.between, (-1.0, 1.0), (1.0, -1.0), strict=True):
            if end in decks:
                i = 3 * decks[end]
                rows[j, i : i + 3] += sign * _along(scene.decks[decks[end]], side, y)
        assert contact.name == f"{joint.name}.{'upper' if upper else 'lower'}"
    return RubbingPlan(plan, rows, np.array([c.friction for c in scene.contacts]))


def _along(deck: Any, side: float, y: float) -> Floats:
    """What u, v and θ move a place of the right (1) or left (-1) edge along it, upwards."""
    edge = np.array([-math.sin(deck.skew), math.cos(deck.skew)])
    place = np.array([side * deck.length / 2, 0.0]) + edge * (y - deck.centre[1]) / edge[1]
    return np.array([*edge, edge @ [-place[1], place[0]]])
