"""Clusters of resting bodies: offsets, contact forces, and what is locked."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from eventpound.contact.impacts import put_as_one
from eventpound.mechanics.clusters import Clusters, ContactEnds, form_clusters
from eventpound.numerics.compiled import in_python
from tests.numerics.problems import NO_POINTS, Contacts, graph


def _form(pairs: list[tuple[int, int]], gap: list[float], bodies: int) -> Clusters:
    left, right = np.array(pairs, np.int64).reshape(-1, 2).T
    every = np.ones(len(pairs), bool)
    ends = left.copy(), right.copy(), np.array(gap)
    return form_clusters(ContactEnds(*ends, np.ones(bodies), NO_POINTS, len(pairs)), every, every)


def _incidence(pairs: list[tuple[int, int]], bodies: int) -> np.ndarray:
    W = np.zeros((bodies + 1, len(pairs)))
    for j, (a, b) in enumerate(pairs):
        W[a, j] -= 1.0
        W[b, j] += 1.0
    return W[:-1]


def _random_forest(rng: np.random.Generator) -> tuple[list[tuple[int, int]], int]:
    """Contacts without a cycle, barriers being one node."""
    bodies = int(rng.integers(1, 9))
    order = rng.permutation(bodies)
    pairs = []
    for i, body in enumerate(order):
        if rng.random() < 0.7:
            other = -1 if i == 0 or rng.random() < 0.2 else int(order[rng.integers(i)])
            pairs.append((int(body), other) if rng.random() < 0.5 else (other, int(body)))
    return pairs, bodies


def _forces(clusters: Clusters, residual: np.ndarray, contacts: int) -> np.ndarray:
    """Elimination from the leaves as the table of clusters says."""
    force, left_over = np.zeros(contacts), residual.copy()
    for body, contact, parent, sign in clusters.elimination:
        force[contact] = sign * left_over[body]
        if parent >= 0:
            left_over[parent] += left_over[body]
    return force


def test_random_forests() -> None:
    rng = np.random.default_rng(31)
    for _ in range(150):
        pairs, bodies = _random_forest(rng)
        gap = rng.normal(size=len(pairs))
        clusters = _form(pairs, list(gap), bodies)
        W = _incidence(pairs, bodies)
        # u = q + offset closes every resting gap, whatever q.
        q = np.append(rng.normal(size=clusters.count), 0.0)
        u = q[clusters.of_body] + clusters.offset
        np.testing.assert_allclose(gap + W.T @ u, 0.0, atol=1e-14)
        # One coordinate a cluster: what the contacts leave free.
        assert clusters.count == bodies - np.linalg.matrix_rank(W)
        assert clusters.tree
        assert not clusters.locked.any()
        wanted = rng.normal(size=len(pairs))
        force = _forces(clusters, W @ wanted, len(pairs))
        np.testing.assert_allclose(force, wanted, atol=1e-14)
        np.testing.assert_allclose(force, np.linalg.lstsq(W, W @ wanted, rcond=None)[0], atol=1e-12)


@pytest.mark.parametrize("bodies", [1, 2, 5])
def test_row_between_two_barriers_is_locked(bodies: int) -> None:
    pairs = [(i - 1, i if i < bodies else -1) for i in range(bodies + 1)]
    gap = np.linspace(0.1, 0.5, bodies + 1)
    gap[-1] = -gap[:-1].sum()
    clusters = _form(pairs, list(gap), bodies)
    assert clusters.count == 0
    assert (clusters.of_body == -1).all()
    assert clusters.locked.all()
    assert not clusters.tree
    W = _incidence(pairs, bodies)
    np.testing.assert_allclose(gap + W.T @ clusters.offset, 0.0, atol=1e-15)
    # Forces in balance, one of the contacts without.
    residual = np.random.default_rng(1).normal(size=bodies)
    force = _forces(clusters, residual, len(pairs))
    np.testing.assert_allclose(W @ force, residual, atol=1e-13)
    assert force[clusters.redundant].tolist() == [0.0]


def test_parallel_contacts_are_not_locked() -> None:
    # Both open when the bodies part; their forces are not unique, and one carries all.
    clusters = _form([(0, 1), (0, 1)], [0.2, 0.2], 2)
    assert clusters.count == 1
    assert not clusters.locked.any()
    assert not clusters.tree
    np.testing.assert_array_equal(clusters.redundant, [False, True])
    assert _forces(clusters, np.array([-1.0, 1.0]), 2).tolist() == [1.0, 0.0]


def test_the_pressed_contact_carries_the_force() -> None:
    left, right = np.array([0, 0]), np.array([1, 1])
    pressed, one = np.array([False, True]), np.ones(2)
    between = ContactEnds(left, right, np.array([0.2, 0.2]), one, NO_POINTS, 2)
    clusters = form_clusters(between, np.ones(2, bool), pressed)
    np.testing.assert_array_equal(clusters.redundant, [True, False])


def test_diamond_is_not_locked() -> None:
    # 0 touches 1 and 2, which both touch 3: the outer ones may part.
    clusters = _form([(0, 1), (0, 2), (1, 3), (2, 3)], [0.0, 0.1, 0.3, 0.2], 4)
    assert clusters.count == 1
    assert not clusters.locked.any()
    assert not clusters.tree


def test_only_the_squeezed_part_is_locked() -> None:
    # Barrier 0 1 barrier, and 2 leaning on 1 from the side of the first barrier.
    clusters = _form([(-1, 0), (0, 1), (1, -1), (2, 1)], [0.0, 0.0, 0.0, 0.4], 3)
    np.testing.assert_array_equal(clusters.locked, [True, True, True, False])
    assert clusters.count == 0


def test_supports_are_one_node_and_no_cluster_has_two() -> None:
    # Supports 0 and 1; 2 and 3 between the first and a barrier, 4 between both.
    left, right = np.array([0, 2, 3, 0, 4]), np.array([2, 3, -1, 4, 1])
    every, mass = np.ones(5, bool), np.array([np.inf, np.inf, 1.0, 1.0, 1.0])
    pressed = np.array([True, True, False, False, True])
    between = ContactEnds(left, right, np.zeros(5), mass, NO_POINTS, 5)
    clusters = form_clusters(between, every, pressed)
    np.testing.assert_array_equal(clusters.of_body, [0, 1, 0, 0, 1])
    np.testing.assert_array_equal(clusters.redundant, [False, False, True, True, False])
    # From the barrier to the first support nothing leads, from the first to the second one row.
    np.testing.assert_array_equal(clusters.locked, every)
    assert not clusters.unique.any()


@pytest.mark.parametrize("mass", [1.0, 2.0])
def test_what_rests_on_a_support_is_put_there(mass: float) -> None:
    """One of 1 kg, too, for which it was once enough that the others of its cluster weigh that."""
    every, masses = np.ones(1, bool), np.array([np.inf, mass])
    ends = np.array([0]), np.array([1]), np.array([0.25])
    clusters = form_clusters(ContactEnds(*ends, masses, NO_POINTS, 1), every, every)
    for places, expected in ((True, [0.5, 0.25]), (False, [0.5, 0.5])):
        x = np.array([0.5, 0.375])
        in_python(put_as_one)(clusters, places, masses, x)
        np.testing.assert_array_equal(x, expected)


def test_nobody_rests() -> None:
    clusters = _form([], [], 3)
    np.testing.assert_array_equal(clusters.of_body, [0, 1, 2])
    assert clusters.count == 3
    assert clusters.tree
    assert clusters.resting.size == 0


def _random_rests(rng: np.random.Generator) -> tuple[Contacts, np.ndarray, np.ndarray]:
    """Contacts between any ends, repeated ones and cycles among them; who rests, who is pressed."""
    contacts = graph(rng, 0.0)
    resting = rng.random(contacts.left.size) < 0.8
    return contacts, resting, resting & (rng.random(resting.size) < 0.6)


def _components(contacts: Contacts, resting: np.ndarray, connection: str) -> np.ndarray:
    """Label of each body and, last, of the barriers."""
    size = contacts.mass.size + 1
    ends = (contacts.left[resting] % size, contacts.right[resting] % size)
    matrix = coo_array((np.ones(resting.sum()), ends), shape=(size, size)).tocsr()
    return connected_components(matrix, directed=True, connection=connection)[1]


def test_random_contact_graphs() -> None:
    rng = np.random.default_rng(32)
    seen_locked = seen_redundant = 0
    for _ in range(150):
        contacts, resting, pressed = _random_rests(rng)
        bodies, (left, right) = contacts.mass.size, (contacts.left, contacts.right)
        # Gaps that all close at one position u of the bodies, on a grid that sums exactly.
        place = np.append(rng.integers(-64, 64, bodies) / 64.0, 0.0)
        gap = place[left] - place[right]
        between = ContactEnds(left, right, gap, contacts.mass, NO_POINTS, gap.size)
        clusters = form_clusters(between, resting, pressed)
        W, members = contacts.W[:, resting], np.flatnonzero(resting)
        np.testing.assert_array_equal(clusters.resting, members)

        weak = _components(contacts, resting, "weak")
        together = clusters.of_body[:, None] == clusters.of_body
        np.testing.assert_array_equal(together, weak[:-1, None] == weak[:-1])
        np.testing.assert_array_equal(clusters.of_body < 0, weak[:-1] == weak[-1])
        moving = clusters.of_body[clusters.of_body >= 0]
        _, first = np.unique(moving, return_index=True)
        assert (np.diff(first) > 0).all()
        assert clusters.count == first.size == bodies - np.linalg.matrix_rank(W)
        assert not (gap[resting] + W.T @ clusters.offset).any()

        # What carries is independent, as many as the rank, as many pressed ones as may be.
        carrying = ~clusters.redundant
        assert carrying.sum() == np.linalg.matrix_rank(W) == len(clusters.elimination)
        assert np.linalg.matrix_rank(W[:, carrying]) == carrying.sum()
        by_pressed = pressed[members]
        rank_of_pressed = np.linalg.matrix_rank(W[:, by_pressed]) if by_pressed.any() else 0
        assert (carrying & by_pressed).sum() == rank_of_pressed
        wanted = np.where(carrying, rng.normal(size=members.size), 0.0)
        force = _forces(clusters, W @ wanted, resting.size)[members]
        np.testing.assert_allclose(force, wanted, atol=1e-13)

        strong = _components(contacts, resting, "strong")
        inside = strong[left[members]] == strong[right[members]]
        np.testing.assert_array_equal(clusters.locked, inside)
        in_tree = [(weak[left] == label)[members].sum() < (weak == label).sum() for label in weak]
        np.testing.assert_array_equal(clusters.unique, np.array(in_tree)[left[members]])
        seen_locked += inside.any()
        seen_redundant += clusters.redundant.any()
    assert seen_locked > 30
    assert seen_redundant > seen_locked
