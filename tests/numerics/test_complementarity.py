"""Complementarity problems against non-negative least squares and against enumeration."""

from itertools import product

import numpy as np
import pytest
from scipy.optimize import nnls

from eventpound.numerics.lcp import solve_chain, solve_dense
from tests.numerics.problems import (
    EPS,
    Contacts,
    assert_solved,
    graph,
    masses,
    rounding,
    row,
    violation,
)


def _check_solution(G: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Solve and assert the conditions of optimality; returns x and w."""
    x, w, solved = solve_dense(G, q, 0.0)
    assert_solved(G, q, x, w, solved)
    return x, w


def _compare_with_nnls(contacts: Contacts, p: np.ndarray) -> bool:
    """``q = Aᵀ p``: min |A x + p| over x >= 0. Returns whether nnls itself had solved it."""
    A, G = contacts.factor, contacts.G
    q = A.T @ p
    _, w = _check_solution(G, q)
    oracle, _ = nnls(A, -p, maxiter=1000)
    if violation(G, q, oracle) > 1.0:
        return False
    # w is unique: A x is the projection of -p on a convex cone. A residual ρ of either
    # in the sense of `violation` moves A x by at most sqrt(x ρ).
    x = np.abs(oracle)
    level = rounding(G, oracle, q)
    blur = np.sqrt(4.0 * float(x @ level)) * np.sqrt(np.diag(G))
    assert (np.abs(G @ oracle + q - w) <= blur + 4.0 * level).all()
    return True


@pytest.mark.parametrize("decades", [0.0, 1.0, 3.0])
@pytest.mark.parametrize("barriers", ["none", "left", "right", "both"])
def test_random_rows(decades, barriers):
    rng = np.random.default_rng(11)
    judged = 0
    for _ in range(100):
        contacts = row(rng, int(rng.integers(2, 9)), decades, barriers)
        judged += _compare_with_nnls(contacts, rng.normal(size=contacts.mass.size))
    # nnls is itself wrong on a few singular problems in ten thousand.
    assert judged >= 96


@pytest.mark.parametrize("decades", [0.0, 1.0, 3.0])
def test_random_graphs(decades):
    rng = np.random.default_rng(12)
    judged = 0
    for _ in range(1500):
        contacts = graph(rng, decades)
        judged += _compare_with_nnls(contacts, rng.normal(size=contacts.mass.size))
    assert judged >= 1490


def _by_enumeration(G: np.ndarray, q: np.ndarray) -> np.ndarray | None:
    """W of the first active set whose least-squares solution meets every condition."""
    for members in product((False, True), repeat=q.size):
        inside = np.array(members)
        x = np.zeros(q.size)
        if inside.any():
            x[inside] = np.linalg.lstsq(G[np.ix_(inside, inside)], -q[inside], rcond=1e-12)[0]
        w = G @ x + q
        if (x >= -1e-11).all() and (w >= -1e-11).all() and abs(x @ w) <= 1e-11:
            return w
    return None


def test_against_every_active_set():
    # Masses of one decade and at most six contacts: no condition number above 1e4.
    rng = np.random.default_rng(13)
    compared = 0
    for _ in range(400):
        contacts = graph(rng, 0.5)
        if contacts.left.size > 6:
            continue
        G = contacts.G
        q = contacts.factor.T @ rng.normal(size=contacts.mass.size)
        expected = _by_enumeration(G, q)
        assert expected is not None
        _, w = _check_solution(G, q)
        np.testing.assert_allclose(w, expected, rtol=0.0, atol=1e-9)
        compared += 1
    assert compared > 200


def test_parallel_contacts_with_different_restitution():
    # Two contacts of the same pair, q = (1 + ε) γ out of the range of G: the one with
    # the larger ε takes all, γ⁺ = -ε_max γ⁻, whatever else is touched.
    rng = np.random.default_rng(14)
    for _ in range(500):
        m = masses(rng, 2, 2.0)
        eps = rng.uniform(0.0, 1.0, 3)
        contacts = Contacts(np.array([0, 0, 0]), np.array([1, 1, 1]), m)
        q = -(1.0 + eps) * 0.3
        x, w = _check_solution(contacts.G, q)
        largest = int(np.argmax(eps))
        reduced = m[0] * m[1] / m.sum()
        expected = np.zeros(3)
        expected[largest] = reduced * (1.0 + eps[largest]) * 0.3
        np.testing.assert_allclose(x, expected, rtol=16 * EPS)
        np.testing.assert_allclose(w, q - q[largest], rtol=0.0, atol=16 * EPS)


def test_parallel_contacts_in_random_graphs():
    # Approaching contacts of one velocity field, each with its own ε.
    rng = np.random.default_rng(15)
    solved = 0
    for _ in range(2000):
        contacts = graph(rng, 1.0)
        rate = contacts.W.T @ rng.normal(size=contacts.mass.size)
        members = rate <= 0.0
        if not members.any():
            continue
        some = Contacts(contacts.left[members], contacts.right[members], contacts.mass)
        eps = rng.uniform(0.0, 1.0, members.sum())
        _check_solution(some.G, (1.0 + eps) * rate[members])
        solved += 1
    assert solved > 1000


@pytest.mark.parametrize("bodies", [1, 2, 5, 12])
def test_row_squeezed_between_two_barriers(bodies):
    # At rest, pushed by forces p: x is not unique, but w = 0 where all are pressed.
    rng = np.random.default_rng(bodies)
    for _ in range(100):
        contacts = row(rng, bodies, 1.0, "both")
        lam = rng.uniform(0.1, 1.0, bodies + 1)
        q = -contacts.G @ lam
        _, w = _check_solution(contacts.G, q)
        assert not (w > rounding(contacts.G, lam, q)).any()


@pytest.mark.parametrize("ratio", [1e-6, 1e6])
@pytest.mark.parametrize("bodies", [2, 3, 6])
def test_mass_ratios(ratio, bodies):
    rng = np.random.default_rng(16)
    for barriers in ("none", "left", "both"):
        for _ in range(50):
            contacts = row(rng, bodies, 0.1, barriers)
            contacts.mass[::2] *= ratio
            p = rng.normal(size=bodies)
            _compare_with_nnls(contacts, p)


def test_a_problem_without_solution_is_told():
    # Both contacts of a squeezed body are to open at once.
    contacts = Contacts(np.array([-1, 0]), np.array([0, -1]), np.array([1.0]))
    assert not solve_dense(contacts.G, np.array([-1.0, -1.0]), 0.0)[2]


def test_a_locked_row_is_solved_to_the_accuracy_of_its_data():
    # Exactly, the sum of q over the gaps between two barriers is nothing.
    contacts = Contacts(np.array([-1, 0, 1]), np.array([0, 1, -1]), np.array([1.5, 0.2]))
    q = np.array([-1.0, 0.0, 1.0 - 1e-12])
    assert not solve_dense(contacts.G, q, 1e-14)[2]
    x, w, solved = solve_dense(contacts.G, q, 1e-12)
    assert solved
    # Body 0 is held by the left barrier's force m a and hands the rest on.
    np.testing.assert_allclose(w, 0.0, atol=3e-12)
    np.testing.assert_allclose(x - x[2], [1.7, 0.2, 0.0], rtol=1e-11)


def test_nothing_to_do():
    x, w, solved = solve_dense(np.eye(3), np.array([0.0, 1.0, 2.0]), 0.0)
    assert solved
    assert not x.any()
    np.testing.assert_array_equal(w, [0.0, 1.0, 2.0])


def _couplings(contacts: Contacts) -> np.ndarray:
    ends = np.append(contacts.left, contacts.right[-1])
    return np.append(1.0 / contacts.mass, 0.0)[ends]


@pytest.mark.parametrize("decades", [0.0, 1.0, 3.0])
@pytest.mark.parametrize("barriers", ["none", "left", "right", "both"])
def test_chain_against_dense(decades, barriers):
    rng = np.random.default_rng(17)
    for _ in range(40):
        contacts = row(rng, int(rng.integers(2, 40)), decades, barriers)
        G = contacts.G
        q = contacts.factor.T @ rng.normal(size=contacts.mass.size)
        x, w = solve_chain(_couplings(contacts), q)
        assert violation(G, q, x) <= 1.0
        assert not (x * w).any()
        y, v = _check_solution(G, q)
        # The same argument as for nnls: two solutions to rounding have Ax this close.
        level = rounding(G, np.maximum(x, y), q)
        blur = np.sqrt(4.0 * float((x + y) @ level)) * np.sqrt(np.diag(G))
        assert (np.abs(w - v) <= blur + 4.0 * level).all()


def test_long_chain_of_equal_masses():
    # The first of N equal bodies hits the others at rest with ε = 1: only the last leaves,
    # so every contact takes the whole momentum. The condition of G is about (N/2)².
    size = 2000
    q = np.zeros(size)
    q[0] = -2.0
    x, _ = solve_chain(np.ones(size + 1), q)
    # G x = -q where all are passive: x falls linearly from 2 size/(size + 1) to 2/(size + 1).
    expected = 2.0 * np.arange(size, 0, -1) / (size + 1)
    np.testing.assert_allclose(x, expected, rtol=size**2 * EPS)
