"""Decks in plan, with friction: every decision by going through all states of the contacts.

Coordinates u, v and the angle θ itself, masses m, m and J; contacts as rows of a matrix that are
written here anew from the shape of the decks. A state is a letter a contact: o open, + and -
slipping, s sticking; without friction a contact is o or +. By Poisson's law an impact has a second
phase, of which every contact is gone through once more, as it gives back its part or more.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from eventpound.scene import BARRIER, GROUND, Deck, Joint, Scene
from eventpound.scene.ends import End
from eventpound.scene.plan_point import PlanPoint
from tests.oracle.pieces import Event, Floats, march

TOO_FAST = 1e-4
"""Interval between impacts (s) below which a scene is left to others."""
STEPS = {"rtol": 1e-13, "atol": 1e-15, "first_step": 1e-6, "max_step": 0.02}
"""Settings of a run."""
_STILL, _OFF, _TAKEN = 1e-10, 1e-8, 1e-3
_WAY = {"+": 1.0, "-": -1.0}


class Held(NamedTuple):
    """Rows that vanish, forces of the unknowns, whose they are: normal, of sticks; their G."""

    rows: Floats
    forces: Floats
    shut: list[int]
    stuck: list[int]
    G: Floats
    dependent: bool


@dataclass
class Plan:
    """Arrays: M (n,), K and C (n, n), pushes (n, 2), W and T (k, n), gaps, ε and μ (k,).

    What closes overlaps by a length (m), so that what has just opened does not close again.
    """

    mass: Floats
    stiffness: Floats
    damping: Floats
    pushed: Floats
    W: Floats
    T: Floats
    gap: Floats
    restitution: Floats
    friction: Floats
    motions: tuple[Any, Any]
    by_poisson: bool = False
    state: str = ""
    last_impact: float = -math.inf
    overlap: float = 1e-13
    known: dict[str, Held] = field(default_factory=dict)

    def free(self, t: float, q: Floats, v: Floats) -> Floats:
        """Accelerations without contacts."""
        ground = np.array([float(m.acceleration(np.array(t))) for m in self.motions])
        pulled = -self.stiffness @ q - self.damping @ v
        return pulled / self.mass - np.einsum("ij,j->i", self.pushed, ground)

    def held(self, state: str) -> Held:
        """What a state holds, made once."""
        if state in self.known:
            return self.known[state]
        W, T, mu = self.W, self.T, self.friction
        shut = [j for j, s in enumerate(state) if s != "o"]
        stuck = [j for j, s in enumerate(state) if s == "s"]
        rows = np.concatenate((W[shut], T[stuck]))
        pushes = [W[j] - _WAY.get(state[j], 0.0) * mu[j] * T[j] for j in shut]
        forces = np.concatenate((np.reshape(pushes, (-1, W.shape[1])), T[stuck]))
        G = rows / self.mass @ forces.T
        size = np.sqrt(np.diag(rows / self.mass @ rows.T))
        dependent = bool(shut) and bool(np.linalg.cond(G / np.outer(size, size)) > 1e9)
        self.known[state] = Held(rows, forces, shut, stuck, G, dependent)
        return self.known[state]

    def answer(self, state: str, free: Floats, asked: Floats) -> tuple[Floats, Floats, Floats]:
        """Rates with forces in a state, and these (k,): rates free of them change to rows = asked.

        Raises LinAlgError where the equations depend on each other.
        """
        held, (normal, tangential) = self.held(state), np.zeros((2, len(state)))
        if not held.shut:
            return free, normal, tangential
        shut, stuck = held.shut, held.stuck
        # Forces of sticks alone need not be unique: the least ones.
        solve = _least if held.dependent and shut == stuck else np.linalg.solve
        if held.dependent and shut != stuck:
            raise np.linalg.LinAlgError
        wanted = np.concatenate((asked[shut], np.zeros(len(stuck))))
        x = solve(held.G, wanted - held.rows @ free)
        normal[shut] = x[: len(shut)]
        for j in shut:
            tangential[j] = -_WAY.get(state[j], 0.0) * self.friction[j] * normal[j]
        tangential[stuck] = x[len(shut) :]
        return free + held.forces.T @ x / self.mass, normal, tangential

    def find(
        self, free: Floats, asked: Floats, choices: list[str], forced: Collection[int] = ()
    ) -> tuple[str, Floats]:
        """The first state of all choices that keeps the inequalities, and the rates in it.

        Of contacts whose way is forced, by friction at its bound, one may stick well inside it.
        """
        for letters in product(*choices):
            state = "".join(letters)
            try:
                rate, normal, tangential = self.answer(state, free, asked)
            except np.linalg.LinAlgError:
                continue
            size = _OFF * max(np.abs(free).max(), np.abs(rate).max())
            force = size * self.mass.min()
            along, good = self.T @ rate, True
            for j, s in enumerate(state):
                if s == "o":
                    good &= len(choices[j]) == 1 or self.W[j] @ rate >= asked[j] - size
                elif s == "s":
                    bound = self.friction[j] * normal[j]
                    bound *= 1.0 - _TAKEN if j in forced else 1.0
                    good &= abs(tangential[j]) <= bound + force
                elif len(choices[j]) > 2 and j not in forced:
                    good &= _WAY[s] * along[j] >= -size
                good &= normal[j] >= -force
            if good:
                return state, rate
        raise AssertionError("no state found")

    def rate(self, t: float, y: Floats) -> Floats:
        """y' of y = (q, v)."""
        q, v = np.split(y, 2)
        a = self.answer(self.state, self.free(t, q, v), np.zeros(len(self.state)))[0]
        return np.concatenate((v, a))

    def events(self) -> list[Event]:
        """Gaps that close, contacts that let go, slips that end, sticks at their bounds."""
        n, found = self.mass.size, list[Event]()

        def forces(t: float, y: Floats) -> tuple[Floats, Floats]:
            free = self.free(t, y[:n], y[n:])
            return self.answer(self.state, free, np.zeros(len(self.state)))[1:]

        def add(kind: str, j: int, value: Callable[[float, Floats], float]) -> None:
            found.append(((kind, j), value))

        for j, s in enumerate(self.state):
            if s == "o":
                add("close", j, lambda t, y, j=j: self.gap[j] + self.W[j] @ y[:n] + self.overlap)
                continue
            add("release", j, lambda t, y, j=j: forces(t, y)[0][j])
            if s == "s":
                mu = self.friction[j]
                for way in ("+", "-"):
                    # At its bound against a slip forwards friction is -μ λ.
                    add(way, j, lambda t, y, j=j, mu=mu, f=_WAY[way]: (
                        mu * forces(t, y)[0][j] + f * forces(t, y)[1][j]))  # fmt: skip
            elif self.friction[j] > 0.0 and not self._tied(j):
                add("stop", j, lambda t, y, j=j, f=_WAY[s]: f * (self.T[j] @ y[n:]))
        return found

    def _tied(self, j: int) -> bool:
        """Whether what is closed and sticks keeps a contact from sliding."""
        rows = self.held(self.state).rows
        left = self.T[j] - rows.T @ np.linalg.lstsq(rows.T, self.T[j], rcond=None)[0]
        return bool(np.linalg.norm(left) < 1e-9 * np.linalg.norm(self.T[j]))

    def happened(self, t: float, y: Floats, owners: list[tuple[str, int]]) -> Floats:
        """The state after closings, releases and changes of slip."""
        if not owners:
            return y
        q, v = np.split(y, 2)
        for j in (j for kind, j in owners if kind == "stop"):
            H = np.vstack((self.held(self.state).rows, self.T[j]))
            v -= np.linalg.lstsq(H, H @ v, rcond=1e-12)[0]
        if any(kind == "close" for kind, _ in owners):
            if t - self.last_impact < TOO_FAST:
                raise LeftAloneError
            self.last_impact, v = t, self.impacts(q, v)
        y = np.concatenate((q, v))
        gone = {j for kind, j in owners if kind == "release"}
        self.decide(t, y, gone, {j: kind for kind, j in owners if kind in _WAY})
        return y

    def decide(self, t: float, y: Floats, gone: set[int], forced: dict[int, str]) -> None:
        """Who is open, slips and sticks; known of some that they open, or where they slip."""
        q, v = np.split(y, 2)
        gaps, rates, along = self.gap + self.W @ q, self.W @ v, self.T @ v
        # Others that stick keep these from sliding, at the bound of their friction.
        held = {j: s for j, s in enumerate(self.state) if s in _WAY and self.friction[j] > 0.0}
        held = {j: s for j, s in held.items() if abs(along[j]) < _STILL and self._tied(j)}
        forced = held | forced
        choices = []
        for j, mu in enumerate(self.friction):
            shut = abs(gaps[j]) < _STILL and abs(rates[j]) < _STILL and j not in gone
            if not shut:
                choices.append("o")
            elif j in forced:
                choices.append("s" + forced[j] + "o")
            elif mu > 0.0 and abs(along[j]) < _STILL:
                choices.append("o+-s")
            else:
                choices.append("o+" if mu == 0.0 or along[j] > 0.0 else "o-")
        free = self.free(t, q, v)
        self.state, _ = self.find(free, np.zeros(len(choices)), choices, forced)

    def impacts(self, q: Floats, v: Floats) -> Floats:
        """Velocities after impacts until none approaches."""
        gaps = self.gap + self.W @ q
        for _ in range(20):
            rates = self.W @ v
            closed = (np.abs(gaps) < _STILL) & (rates < _STILL)
            if not (rates[closed] < -_STILL).any():
                return v
            choices = [
                ("o+-s" if mu > 0.0 else "o+") if shut else "o"
                for shut, mu in zip(closed, self.friction, strict=True)
            ]
            if self.by_poisson:
                state, after = self.find(v, np.zeros(len(choices)), choices)
                normal = self.answer(state, v, np.zeros(len(choices)))[1]
                v = self.expanded(after, self.restitution * normal, np.flatnonzero(closed))
            else:
                v = self.find(v, -self.restitution * rates, choices)[1]
        raise LeftAloneError

    def expanded(self, v: Floats, given: Floats, shut: Floats) -> Floats:
        """Velocities after an expansion with at least such normal impulses (k,) of shut contacts.

        Unknown are N and T of each, in parts of a mass; one gives back its part (=) or more (>).
        """
        k, mass, mu = shut.size, self.mass.min(), self.friction[shut]
        rows, given = np.vstack((self.W[shut], self.T[shut])), given[shut] / mass
        G, q, one = rows * (mass / self.mass) @ rows.T, rows @ v, np.eye(2 * k)
        size = _OFF * max(np.abs(v).max(), given.max())
        ways = ["+-s" if m > 0.0 else "+" for m in mu]
        pushes = ["=>" if part > 0.0 else ">" for part in given]
        both = [
            [*product(p, w), *([] if p == "=>" else ["=+"])]
            for p, w in zip(pushes, ways, strict=True)
        ]
        for letters in product(*both):
            A, right = one.copy(), np.zeros(2 * k)
            for i, (push, way) in enumerate(letters):
                if push == "=":
                    right[i] = given[i]
                else:
                    A[i], right[i] = G[i], -q[i]
                if way == "s":
                    A[k + i], right[k + i] = G[k + i], -q[k + i]
                else:
                    A[k + i, i] = _WAY[way] * mu[i]
            x = np.linalg.lstsq(A, right, rcond=1e-12)[0]
            w, (N, T) = G @ x + q, np.split(x, 2)
            good = np.abs(A @ x - right).max() <= size and (given <= N + size).all()
            good &= bool((w[:k] >= -size).all() and (np.abs(T) <= mu * N + size).all())
            for i, (_, way) in enumerate(letters):
                free = way != "s" and mu[i] * N[i] > size
                good &= not free or _WAY[way] * w[k + i] >= -size
            if good:
                return v + mass * (x @ rows) / self.mass
        raise AssertionError("no expansion found")


def _least(G: Floats, right: Floats) -> Floats:
    return np.linalg.lstsq(G, right, rcond=1e-9)[0]


class LeftAloneError(Exception):
    """Impacts follow each other too fast for this program."""


def states(scene: Scene, joints: list[Joint], times: Floats) -> Floats | None:
    """Displacements and velocities in metres, as the package has them, shape (times, 2 n).

    Contacts are those of joints, in their order. None of a scene that is left alone.
    """
    plan = plan_of(scene, joints)
    unit = np.ones(plan.mass.size)
    unit[2::3] = [math.sqrt(J / m) for m, J in plan.mass.reshape(-1, 3)[:, 1:]]
    both = np.concatenate((unit, unit))
    start = [b.displacement for b in scene.bodies] + [b.velocity for b in scene.bodies]
    y = np.array(start) / both
    try:
        plan.decide(float(times[0]), y, set(), {})
        return np.array(march(plan, y, times.tolist(), **STEPS)) * both
    except LeftAloneError:
        return None


def plan_of(scene: Scene, joints: list[Joint]) -> Plan:
    """Arrays of a scene of decks on linear springs and dashpots."""
    decks = {deck.name: i for i, deck in enumerate(scene.decks)}
    n = 3 * len(decks)
    mass, K, C, pushed = np.zeros(n), np.zeros((n, n)), np.zeros((n, n)), np.zeros((n, 2))
    cosine, sine = math.cos(scene.attack), math.sin(scene.attack)
    for i, deck in enumerate(scene.decks):
        # A parallelogram sheared by tan α, as a sum over its moments.
        shear = math.tan(deck.skew)
        J = deck.mass * (deck.length**2 + deck.width**2 * (1.0 + shear**2)) / 12.0
        mass[3 * i : 3 * i + 3] = deck.mass, deck.mass, J
        pushed[3 * i] = cosine, -sine
        pushed[3 * i + 1] = sine, cosine
    places = {name: 3 * i for name, i in decks.items()}
    for spring in scene.springs:
        b = _elongation(spring.between, places, mass)
        K += spring.law.stiffness * np.outer(b, b)
    for dashpot in scene.dashpots:
        b = _elongation(dashpot.between, places, mass)
        C += dashpot.coefficient * np.outer(b, b)
    W, T, gaps, restitution = [], [], list[float](), list[float]()
    for joint in joints:
        pair = [None if end == BARRIER else scene.decks[decks[end]] for end in joint.between]
        there = [deck for deck in pair if deck is not None]
        low = max(deck.centre[1] - deck.width / 2 for deck in there)
        high = min(deck.centre[1] + deck.width / 2 for deck in there)
        for y, gap in zip((low, high), joint.gap, strict=True):
            rows = np.zeros((2, n))
            for end, sign in zip(pair, (-1.0, 1.0), strict=True):
                if end is not None:
                    i = 3 * decks[end.name]
                    rows[:, i : i + 3] += sign * _rows(end, -sign, y - end.centre[1])
            W.append(rows[0])
            T.append(rows[1])
            gaps.append(gap)
            restitution.append(joint.restitution)
    return Plan(
        mass, K, C, pushed, np.reshape(W, (-1, n)), np.reshape(T, (-1, n)),
        np.array(gaps), np.array(restitution, float),
        np.array([contact.friction for contact in scene.contacts], float),
        (scene.motion, scene.across), scene.impact_law == "poisson",
    )  # fmt: skip


def _elongation(between: tuple[End, End], places: dict[str, int], mass: Floats) -> Floats:
    """What u, v and θ of decks, the first at some places, make a spring or dashpot longer by."""
    row = np.zeros(mass.size)
    for end, sign in zip(between, (-1.0, 1.0), strict=True):
        if isinstance(end, PlanPoint):
            (x, y), (n_x, n_y) = end.at, end.normal
            row[places[end.deck] :][:3] += sign * np.array([n_x, n_y, x * n_y - y * n_x])
        elif end != GROUND:
            deck, _, word = end.rpartition(".")
            i = places[deck] + ("x", "y", "turn").index(word)
            # Of a turn the length r θ.
            row[i] += sign * (math.sqrt(mass[i] / mass[i - 1]) if word == "turn" else 1.0)
    return row


def _rows(deck: Deck, side: float, y: float) -> Floats:
    """What u, v and θ move a place of the right (1) or left (-1) edge along normal and edge."""
    along = np.array([-math.sin(deck.skew), math.cos(deck.skew)])
    place = np.array([side * deck.length / 2, 0.0]) + along * y / along[1]
    turned = np.array([-place[1], place[0]])
    normal = np.array([along[1], -along[0]])
    return np.array([[*normal, normal @ turned], [*along, along @ turned]])
