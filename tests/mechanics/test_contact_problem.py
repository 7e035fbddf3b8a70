"""The complementarity problem part by part against the problem as a whole."""

import numpy as np
import pytest
from scipy.optimize import nnls

from eventpound.mechanics.contact_problem import LONG_ROW, solve_contacts
from tests.numerics.problems import Contacts, assert_solved, graph, joints, row


def _together(parts: list[Contacts], rng: np.random.Generator) -> Contacts:
    """Several scenes side by side, contacts and masses shuffled."""
    left, right, mass = [], [], []
    for part in parts:
        shift = sum(m.size for m in mass)
        left.append(np.where(part.left < 0, -1, part.left + shift))
        right.append(np.where(part.right < 0, -1, part.right + shift))
        mass.append(part.mass)
    renamed = np.append(rng.permutation(sum(m.size for m in mass)), -1)
    order = rng.permutation(sum(a.size for a in left))
    masses = np.empty(renamed.size - 1)
    masses[renamed[:-1]] = np.concatenate(mass)
    return Contacts(
        renamed[np.concatenate(left)][order], renamed[np.concatenate(right)][order], masses
    )


def _check(contacts: Contacts, p: np.ndarray) -> None:
    G, q = contacts.G, contacts.factor.T @ p
    assert_solved(G, q, *solve_contacts(contacts.joints, q, 0.0))


def test_many_parts():
    rng = np.random.default_rng(81)
    for _ in range(60):
        parts = [graph(rng, 1.0) for _ in range(rng.integers(1, 5))]
        contacts = _together(parts, rng)
        _check(contacts, rng.normal(size=contacts.mass.size))


@pytest.mark.parametrize("barriers", ["none", "left", "right", "both"])
@pytest.mark.parametrize("decades", [0.0, 1.0, 2.0])
def test_long_rows_in_any_order(barriers, decades):
    rng = np.random.default_rng(82)
    for _ in range(5):
        bodies = int(rng.integers(LONG_ROW + 2, 3 * LONG_ROW))
        contacts = _together([row(rng, bodies, decades, barriers), graph(rng, 1.0)], rng)
        _check(contacts, rng.normal(size=contacts.mass.size))


def test_two_rows_that_share_a_body_are_one_problem():
    # A body that heads two long rows: no single row, so the dense method has to see it.
    rng = np.random.default_rng(83)
    size = LONG_ROW
    first = [(i, i + 1) for i in range(size)]
    second = [(0 if i == 0 else size + i, size + i + 1) for i in range(size)]
    left, right = np.array(first + second, np.int64).T
    contacts = Contacts(left.copy(), right.copy(), rng.uniform(0.5, 2.0, 2 * size + 1))
    _check(contacts, rng.normal(size=contacts.mass.size))


def test_a_ring_of_contacts():
    # No first contact to start a row from.
    size = LONG_ROW + 6
    left = np.arange(size)
    contacts = Contacts(left, np.roll(left, -1), np.ones(size))
    _check(contacts, np.random.default_rng(84).normal(size=size))


def test_short_row_against_nnls():
    contacts = row(np.random.default_rng(85), 8, 0.3, "left")
    A = contacts.factor
    p = np.random.default_rng(86).normal(size=8)
    x, _, _ = solve_contacts(contacts.joints, A.T @ p, 0.0)
    # A row with one barrier has independent contacts: x is unique.
    np.testing.assert_allclose(x, nnls(A, -p)[0], rtol=1e-11, atol=1e-12)


def test_no_contacts():
    none = np.empty(0, np.int64)
    x, w, solved = solve_contacts(joints(none, none, np.ones(3)), np.empty(0), 0.0)
    assert solved
    assert x.size == w.size == 0
