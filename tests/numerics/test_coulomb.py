"""Contacts with friction beside a closed form, exact enumeration, and feasibility by programs."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from scipy.optimize import linprog

from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.coulomb import (
    ANSWERED,
    BACKWARD,
    FORWARD,
    NO_ANSWER,
    OPEN,
    SEVERAL,
    STICK,
    UNIQUE,
    Rubbing,
    solve_rubbing,
)

Exact = list[Fraction]


def _solve(G: Floats, q: Floats, friction: Floats, way: Ints) -> tuple[Floats, Floats, Ints, int]:
    x, w, state = np.zeros(q.size), np.zeros(q.size), np.zeros(way.size, np.int64)
    problem = Rubbing(G, q, friction, way, np.zeros(q.size))
    return x, w, state, solve_rubbing(problem, x, w, state)


def _violation(G: Floats, q: Floats, friction: Floats, way: Ints, x: Floats) -> float:
    """By how much x fails the laws themselves, beside the largest right-hand side."""
    k, w = way.size, G @ x + q
    N, T, w_N, w_T = x[:k], x[k:], w[:k], w[k:]
    # T in -μ N Sgn(w_T) is that T is the nearest point to T - w_T in [-μ N, μ N].
    bound = friction * np.maximum(N, 0.0)
    free = np.clip(T - w_T, -bound, bound) - T
    slip = np.where(way == 0, free, T + way * friction * N)
    return float(np.max(np.abs([np.minimum(N, w_N), slip]))) / max(1.0, float(np.max(np.abs(q))))


def _eliminate(rows: list[Exact], right: Exact) -> Exact | None:
    """Solve a system exactly; None where its rows depend on each other."""
    n = len(rows)
    work = [[*row, value] for row, value in zip(rows, right, strict=True)]
    for c in range(n):
        pivot = next((i for i in range(c, n) if work[i][c] != 0), None)
        if pivot is None:
            return None
        work[c], work[pivot] = work[pivot], work[c]
        work[c] = [value / work[c][c] for value in work[c]]
        for i in range(n):
            if i != c:
                factor = work[i][c]
                work[i] = [a - factor * b for a, b in zip(work[i], work[c], strict=True)]
    return [row[-1] for row in work]


def _keeps(
    state: str, force: tuple[Fraction, ...], rate: tuple[Fraction, ...], mu: Fraction
) -> bool:
    """Whether normal and tangential numbers of a contact keep the inequalities of its state."""
    if state == "o":
        return rate[0] >= 0
    if state == "s":
        return abs(force[1]) <= mu * force[0]
    return force[0] >= 0 and (rate[1] >= 0 if state == "+" else rate[1] <= 0)


def _exact_answers(G: list[Exact], q: Exact, friction: Exact) -> set[tuple[Fraction, ...]]:
    """Motions w of all answers: 2k equations in N, T for each state, in fractions."""
    k, found = len(friction), set()
    one = [[Fraction(i == j) for j in range(2 * k)] for i in range(2 * k)]
    for state in product("o+-s", repeat=k):
        rows, right = [], []
        for i, s in enumerate(state):
            rows.append(one[i] if s == "o" else G[i])
            right.append(Fraction(0) if s == "o" else -q[i])
            if s == "s":
                rows.append(G[k + i])
                right.append(-q[k + i])
            else:
                drag = {"o": Fraction(0), "+": friction[i], "-": -friction[i]}[s]
                rows.append([a + drag * b for a, b in zip(one[k + i], one[i], strict=True)])
                right.append(Fraction(0))
        x = _eliminate(rows, right)
        if x is None:
            continue
        w = [
            sum(a * b for a, b in zip(row, x, strict=True)) + c for row, c in zip(G, q, strict=True)
        ]
        if all(
            _keeps(s, (x[i], x[k + i]), (w[i], w[k + i]), friction[i]) for i, s in enumerate(state)
        ):
            found.add(tuple(w))
    return found


@pytest.mark.parametrize(("k", "problems"), [(1, 300), (2, 150), (3, 12)])
def test_beside_exact_enumeration(k: int, problems: int) -> None:
    rng = np.random.default_rng(k)
    met = set()
    for _ in range(problems):
        # Few directions, so that for k = 3 rows depend on each other, and μ up to Painlevé's.
        W = rng.integers(-3, 4, (2 * k, min(2 * k, 4) + 1))
        q = rng.integers(-5, 6, 2 * k)
        eighths = rng.integers(0, 25, k)
        G = W @ W.T
        answers = _exact_answers(
            [[Fraction(int(a)) for a in row] for row in G],
            [Fraction(int(a)) for a in q],
            [Fraction(int(a), 8) for a in eighths],
        )
        friction, way = eighths / 8.0, np.zeros(k, np.int64)
        x, w, _, outcome = _solve(G.astype(float), q.astype(float), friction, way)
        assert outcome == {0: NO_ANSWER, 1: UNIQUE}.get(len(answers), SEVERAL)
        met.add(outcome)
        if outcome == UNIQUE:
            (motion,) = answers
            # Numbers up to some 10⁵ in the determinants of six rows.
            np.testing.assert_allclose(w, np.array(motion, float), rtol=1e-10, atol=1e-10)
            assert _violation(G.astype(float), q.astype(float), friction, way, x) < 1e-10
    assert met > {UNIQUE} or k == 3


def _feasible(G: Floats, q: Floats, friction: Floats, along: Floats) -> list[float]:
    """Range of ``along · w`` over all answers, by a linear program for each state."""
    k, found = friction.size, []
    one = np.eye(2 * k)
    for state in product("o+-s", repeat=k):
        equal: list[tuple[Floats, float]] = []
        least: list[tuple[Floats, float]] = []
        for i, s in enumerate(state):
            N, T = one[i], one[k + i]
            if s == "o":
                equal += [(N, 0.0), (T, 0.0)]
                least += [(-G[i], q[i])]
                continue
            equal += [(G[i], -q[i])]
            least += [(-N, 0.0)]
            if s == "s":
                equal += [(G[k + i], -q[k + i])]
                least += [(T - friction[i] * N, 0.0), (-T - friction[i] * N, 0.0)]
            else:
                sign = 1.0 if s == "+" else -1.0
                equal += [(T + sign * friction[i] * N, 0.0)]
                least += [(-sign * G[k + i], sign * q[k + i])]
        (A_eq, b_eq), (A_ub, b_ub) = (list(zip(*rows, strict=True)) for rows in (equal, least))
        for sign in (1.0, -1.0):
            program = linprog(sign * (G.T @ along), A_ub, b_ub, A_eq, b_eq, bounds=(None, None))
            if program.status == 0:
                found.append(sign * program.fun + float(along @ q))
    return found


def test_redundant_contacts_have_one_motion() -> None:
    """Two corners of one edge: their tangential rows are the same, no forces of stick unique."""
    rng = np.random.default_rng(5)
    for _ in range(25):
        x_1, x_2, y, radius = rng.uniform(-1.0, 1.0, 4)
        rows = np.array([[0.0, 1.0, x_1], [0.0, 1.0, x_2], [1.0, 0.0, -y], [1.0, 0.0, -y]])
        W = rows / np.array([1.0, 1.0, 0.5 + abs(radius)])
        G, q = W @ W.T, W @ rng.uniform(-1.0, 1.0, 3)
        friction = np.full(2, rng.uniform(0.05, 0.4))
        along = rng.uniform(-1.0, 1.0, 4)
        found = _feasible(G, q, friction, along)
        x, w, _, outcome = _solve(G, q, friction, np.zeros(2, np.int64))
        assert outcome == UNIQUE
        assert _violation(G, q, friction, np.zeros(2, np.int64), x) < 1e-12
        # Each program ends within 1e-7 of its inequalities.
        np.testing.assert_allclose(found, along @ w, atol=1e-5)


def test_friction_that_is_not_unique_is_the_least() -> None:
    """Two corners stick with the least of all forces, or one of them is at its bound."""
    rows = np.array([[0.0, 1.0, -2.0], [0.0, 1.0, 2.0], [1.0, 0.0, -1.0], [1.0, 0.0, -1.0]])
    W, friction, both = rows / np.array([1.0, 1.0, 1.5]), np.full(2, 0.4), np.zeros(2, int)
    scale = np.sqrt(np.diag(W @ W.T))
    # Either corner of what presses is at the bound last: N_1 + N_2 = 1 carries 0.4 at most.
    for load, states in ((0.0, "ss"), (0.3, "ss"), (0.39, "s+ +s"), (0.41, "++")):
        q = W @ [load, -1.0, 0.0]
        x, w, state, outcome = _solve(W @ W.T, q, friction, both)
        assert outcome == UNIQUE
        assert "".join("o+-s"[s] for s in state) in states.split()
        np.testing.assert_allclose(w, W @ [max(0.0, load - 0.4), 0.0, 0.0], atol=1e-15)
        if states == "ss":
            least = np.linalg.lstsq(W.T / scale, [-load, 1.0, 0.0])[0]
            np.testing.assert_allclose(x * scale, least, atol=1e-15)


def test_one_corner_of_a_rectangle() -> None:
    """Slip and stick of a corner that strikes a wall have regions in closed form."""
    rng = np.random.default_rng(9)
    met = set()
    for _ in range(400):
        m, J, x, y = rng.uniform(0.5, 2.0), rng.uniform(0.1, 2.0), *rng.uniform(-1.0, 1.0, 2)
        mu, approach, slip = rng.uniform(0.05, 0.5), rng.uniform(0.1, 2.0), rng.uniform(-2.0, 2.0)
        a, b, c = 1.0 / m + x * x / J, 1.0 / m + y * y / J, -x * y / J
        G = np.array([[a, c], [c, b]])
        # (1 + ε) γ_N⁻ and γ_T⁻ of the approach.
        found, w, state, outcome = _solve(
            G, np.array([-approach, slip]), np.array([mu]), np.zeros(1, int)
        )
        if not (a - mu * abs(c) > 0.0 and outcome == UNIQUE):
            continue
        if slip * (a - mu * c) > approach * (mu * b - c):
            N = approach / (a - mu * c)
            expected = FORWARD, N, -mu * N, slip + N * (c - mu * b)
        elif slip * (a + mu * c) < approach * (-mu * b - c):
            N = approach / (a + mu * c)
            expected = BACKWARD, N, mu * N, slip + N * (c + mu * b)
        else:
            N, T = np.array([[b, -c], [-c, a]]) @ np.array([approach, -slip]) / (a * b - c * c)
            expected = STICK, N, T, 0.0
        met.add(expected[0])
        assert state[0] == expected[0]
        np.testing.assert_allclose([*found, w[1]], expected[1:], rtol=1e-12, atol=1e-12)
    assert met == {FORWARD, BACKWARD, STICK}


@pytest.mark.parametrize("slope", [0.1, -0.29, 0.31, -0.5])
def test_a_block_on_a_slope(slope: float) -> None:
    """It sticks up to the angle of friction; beyond it slides down with tan α - μ."""
    mass, mu, g = 1e5, 0.3, 9.81
    G = np.eye(2) / mass
    q = g * np.array([-1.0, slope])
    x, w, state, outcome = _solve(G, q, np.array([mu]), np.zeros(1, int))
    assert outcome == UNIQUE
    slides = max(0.0, abs(slope) - mu) * np.sign(slope)
    np.testing.assert_allclose(w, [0.0, g * slides], atol=1e-14)
    np.testing.assert_allclose(x, mass * g * np.array([1.0, -np.clip(slope, -mu, mu)]), rtol=1e-14)
    assert state[0] == (STICK if slides == 0.0 else FORWARD if slides > 0.0 else BACKWARD)
    # Sliding up, it is slowed by both.
    up = np.array([-1], np.int64)
    _, w, _, _ = _solve(G, q, np.array([mu]), up)
    np.testing.assert_allclose(w[1], g * (slope + mu), atol=1e-14)


def test_paradox_of_painleve() -> None:
    """Where friction presses more than it lifts there is no answer, or there are two."""
    # A rod that slides on its lower end: G_NN - μ G_NT < 0.
    G, way = np.array([[1.0, 0.8], [0.8, 1.0]]), np.ones(1, np.int64)
    for pull, outcome in ((-1.0, NO_ANSWER), (1.0, SEVERAL)):
        assert _solve(G, np.array([pull, 0.0]), np.array([2.0]), way)[3] == outcome
    assert _solve(G, np.array([-1.0, 0.0]), np.array([1.0]), way)[3] == UNIQUE


def test_many_contacts() -> None:
    """More than can be gone through: by Lemke's method, the answers of parts by themselves."""
    rng = np.random.default_rng(3)
    # Six on one line share what presses and what shears; none needs to slide.
    rows = np.array([[0.0, 1.0, a - 2.5] for a in range(6)] + [[1.0, 0.0, -1.0]] * 6)
    q = rows @ [0.1, -1.0, 0.0]
    x, w, state, outcome = _solve(rows @ rows.T, q, np.full(6, 0.4), np.zeros(6, int))
    assert outcome == ANSWERED
    assert _violation(rows @ rows.T, q, np.full(6, 0.4), np.zeros(6, int), x) < 1e-12
    assert np.abs(w).max() < 1e-12
    assert np.isin(state, (OPEN, STICK)).all()
    for k in (6, 12, 25):
        for _ in range(10):
            W = rng.normal(size=(2 * k, 2 * k)) + 4.0 * np.eye(2 * k)
            G, q = W @ W.T, 10.0 * rng.normal(size=2 * k)
            friction, way = rng.uniform(0.0, 0.4, k), rng.integers(-1, 2, k)
            x, _, _, outcome = _solve(G, q, friction, way)
            assert outcome in (UNIQUE, ANSWERED)
            assert _violation(G, q, friction, way, x) < 1e-9
    # Eight contacts in four parts, beside each part alone.
    parts = [np.linalg.qr(rng.normal(size=(4, 4)))[0] * rng.uniform(0.5, 2.0, 4) for _ in range(4)]
    places = [np.array([2 * p, 2 * p + 1, 8 + 2 * p, 8 + 2 * p + 1]) for p in range(4)]
    G, q, friction = np.zeros((16, 16)), rng.normal(size=16), rng.uniform(0.0, 0.5, 8)
    for part, at in zip(parts, places, strict=True):
        G[np.ix_(at, at)] = part @ part.T
    _, w, state, outcome = _solve(G, q, friction, np.zeros(8, int))
    assert outcome == UNIQUE
    for part, at in zip(parts, places, strict=True):
        own = _solve(part @ part.T, q[at], friction[at[:2]], np.zeros(2, int))
        np.testing.assert_array_equal(own[1], w[at])
        np.testing.assert_array_equal(own[2], state[at[:2]])


def test_without_friction_nothing_drags() -> None:
    rng = np.random.default_rng(8)
    for _ in range(50):
        W = rng.normal(size=(4, 5))
        G, q = W @ W.T, rng.normal(size=4)
        x, _, state, outcome = _solve(G, q, np.zeros(2), rng.integers(-1, 2, 2))
        assert outcome == UNIQUE
        assert (x[2:] == 0.0).all()
        assert ((state == OPEN) == (x[:2] == 0.0)).all()


@pytest.mark.parametrize("ratio", [1e-6, 1e3, 1e6])
def test_scales_do_not_matter(ratio: float) -> None:
    """Heavy and light bodies, millimetres and metres: the same state, forces in proportion."""
    rng = np.random.default_rng(4)
    for _ in range(50):
        W = rng.normal(size=(4, 5))
        G, q, friction = W @ W.T, rng.normal(size=4), rng.uniform(0.0, 0.3, 2)
        scale = np.array([1.0, ratio, 1.0, ratio])
        x, w, state, outcome = _solve(G, q, friction, np.zeros(2, int))
        scaled = G * scale * scale[:, None]
        y, v, other, same = _solve(scaled, q * scale, friction, np.zeros(2, int))
        assert same == outcome
        assert (other == state).all()
        np.testing.assert_allclose(y * scale, x, rtol=1e-10, atol=1e-12)
        np.testing.assert_allclose(v / scale, w, rtol=1e-10, atol=1e-12)
