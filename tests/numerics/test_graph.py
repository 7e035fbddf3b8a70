"""Disjoint sets, lists by node and directed cycles against SciPy's graph algorithms."""

from collections.abc import Iterator

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from eventpound.numerics.graph import grouped, on_directed_cycles, root

pytestmark = pytest.mark.usefixtures("interpreted")


def _graphs() -> Iterator[tuple[np.ndarray, np.ndarray, int]]:
    """Random edges: none to many, repeated ones and loops among them."""
    rng = np.random.default_rng(91)
    for _ in range(150):
        nodes = int(rng.integers(1, 12))
        tail, head = rng.integers(nodes, size=(2, rng.integers(0, 2 * nodes + 1)))
        yield tail, head, nodes


def _components(tail: np.ndarray, head: np.ndarray, nodes: int, connection: str) -> np.ndarray:
    matrix = coo_array((np.ones(tail.size), (tail, head)), shape=(nodes, nodes)).tocsr()
    return connected_components(matrix, directed=True, connection=connection)[1]


def test_directed_cycles_are_the_edges_inside_strong_components():
    for tail, head, nodes in _graphs():
        label = _components(tail, head, nodes, "strong")
        np.testing.assert_array_equal(
            on_directed_cycles(tail, head, nodes), label[tail] == label[head]
        )


def test_a_long_cycle_and_one_edge_that_leaves_it():
    tail = np.append(np.arange(1000), 500)
    head = np.append(np.arange(1, 1001) % 1000, 1000)
    found = on_directed_cycles(tail, head, 1001)
    assert found[:1000].all()
    assert not found[1000]


def test_sets_joined_edge_by_edge_are_the_weak_components():
    for tail, head, nodes in _graphs():
        parent = np.arange(nodes)
        for a, b in zip(tail, head, strict=True):
            parent[root(parent, a)] = root(parent, b)
        found = np.array([root(parent, i) for i in range(nodes)])
        label = _components(tail, head, nodes, "weak")
        np.testing.assert_array_equal(found[:, None] == found, label[:, None] == label)


def test_groups_keep_their_order():
    for label, _, groups in _graphs():
        first, position = grouped(label, groups)
        np.testing.assert_array_equal(position, np.argsort(label, kind="stable"))
        np.testing.assert_array_equal(np.diff(first), np.bincount(label, minlength=groups))
