"""Clusters of resting bodies: offsets, contact forces, and what is locked."""

from __future__ import annotations

import numpy as np
import pytest

from eventpound.mechanics.clusters import Clusters, form_clusters


def _form(pairs: list[tuple[int, int]], gap: list[float], bodies: int) -> Clusters:
    left, right = np.array(pairs, np.int64).reshape(-1, 2).T
    every = np.ones(len(pairs), bool)
    return form_clusters(left.copy(), right.copy(), np.array(gap), every, every, bodies)


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
    for _ in range(500):
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
    # Least-norm forces: W λ = r and no part along the self-stress (1, ..., 1).
    residual = np.random.default_rng(1).normal(size=bodies)
    force = clusters.least_norm @ residual
    np.testing.assert_allclose(W @ force, residual, atol=1e-13)
    assert abs(force.sum()) < 1e-13


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
    pressed = np.array([False, True])
    clusters = form_clusters(left, right, np.array([0.2, 0.2]), np.ones(2, bool), pressed, 2)
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


def test_nobody_rests() -> None:
    clusters = _form([], [], 3)
    np.testing.assert_array_equal(clusters.of_body, [0, 1, 2])
    assert clusters.count == 3
    assert clusters.tree
    assert clusters.resting.size == 0
