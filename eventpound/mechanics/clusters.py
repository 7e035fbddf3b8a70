"""Which bodies move as one: clusters of bodies joined by resting contacts.

Resting contacts make their bodies one rigid mass; a cluster that touches a
barrier stands still. The contact forces inside follow from the motion of the
cluster, body by body from its leaves, where the contacts form a tree. Where
there are more contacts than that takes, their forces are not unique: those
that a solution found pressed carry them. On a directed cycle (a row squeezed
between two barriers) no contact can open: it is locked, and the least-norm
forces are given.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eventpound.numerics.arrays import Bools, Floats, Ints


@dataclass(frozen=True)
class Clusters:
    """Bodies grouped by resting contacts.

    Parameters
    ----------
    of_body : ndarray of int, shape (N,)
        Cluster of each body, numbered from the left; -1 for bodies that stand
        still.
    offset : ndarray, shape (N,)
        ``u_body = q_cluster + offset`` (m), with q = 0 for cluster -1.
    count : int
        Number of moving clusters.
    resting : ndarray of int, shape (R,)
        The resting contacts.
    locked : ndarray of bool, shape (R,)
        Those that cannot open.
    redundant : ndarray of bool, shape (R,)
        Those that the others keep closed; they are given no force of their own.
    elimination : ndarray of int, shape (E, 4)
        Rows (body, contact, parent, sign) in the order in which forces follow:
        ``λ = sign r_body``, then ``r_parent += r_body``.
    least_norm : ndarray, shape (R, N)
        Maps residual forces to least-norm contact forces; empty where the
        elimination gives them all.
    """

    of_body: Ints
    offset: Floats
    count: int
    resting: Ints
    locked: Bools
    redundant: Bools
    elimination: Ints
    least_norm: Floats

    def unique(self, left: Ints, right: Ints) -> Bools:
        """Resting contacts whose force is unique, shape (R,), for the ends of all contacts."""
        body = np.where(right[self.resting] >= 0, right[self.resting], left[self.resting])
        cluster = self.of_body[body]
        return np.asarray(~np.isin(cluster, cluster[self.redundant]))

    @property
    def tree(self) -> bool:
        """Whether all contact forces are unique."""
        return not self.redundant.any()


def form_clusters(
    left: Ints, right: Ints, gap: Floats, resting: Ints, bodies: int, pressed: Bools | None = None
) -> Clusters:
    """Group bodies by resting contacts.

    Parameters
    ----------
    left, right : ndarray of int, shape (K,)
        Bodies of the contacts, -1 for a barrier.
    gap : ndarray, shape (K,)
        Openings at zero displacement (m).
    resting : ndarray of int, shape (R,)
        Resting contacts.
    bodies : int
        N.
    pressed : ndarray of bool, shape (K,), optional
        Contacts that a solution of the acceleration problem found pressed:
        where contacts are redundant, these carry the forces.
    """
    order = (
        resting
        if pressed is None
        else np.concatenate((resting[pressed[resting]], resting[~pressed[resting]]))
    )
    carrying = _forest(left, right, order, bodies)
    redundant = np.array([j not in carrying for j in resting], np.bool_)
    neighbours: list[list[tuple[int, int]]] = [[] for _ in range(bodies + 1)]
    for j in sorted(carrying):
        neighbours[left[j]].append((int(right[j]), j))
        neighbours[right[j]].append((int(left[j]), j))
    of_body = np.full(bodies, -2, np.int64)
    offset = np.zeros(bodies)
    tree_edges: list[tuple[int, int, int]] = []
    _spread(-1, -1, neighbours, left, gap, of_body, offset, tree_edges)
    count = 0
    for body in range(bodies):
        if of_body[body] == -2:
            of_body[body] = count
            _spread(body, count, neighbours, left, gap, of_body, offset, tree_edges)
            count += 1
    elimination = np.array(
        [(b, j, p, 1 if right[j] == b else -1) for b, j, p in reversed(tree_edges)], np.int64
    ).reshape(-1, 4)
    locked = np.zeros(len(resting), np.bool_)
    least_norm = np.empty((0, 0))
    if redundant.any():
        locked = _in_cycles(left, right, resting, bodies)
    if locked.any():
        least_norm = _least_norm_map(left, right, resting, bodies)
    return Clusters(of_body, offset, count, resting, locked, redundant, elimination, least_norm)


def _forest(left: Ints, right: Ints, order: Ints, bodies: int) -> set[int]:
    """Contacts that join what was not joined before, taken in order."""
    parent = list(range(bodies + 1))

    def root(node: int) -> int:
        while parent[node] != node:
            parent[node] = parent[parent[node]]
            node = parent[node]
        return node

    carrying = set()
    for j in order:
        a, b = root(int(left[j]) % (bodies + 1)), root(int(right[j]) % (bodies + 1))
        if a != b:
            parent[a] = b
            carrying.add(int(j))
    return carrying


def _spread(
    root: int,
    cluster: int,
    neighbours: list[list[tuple[int, int]]],
    left: Ints,
    gap: Floats,
    of_body: Ints,
    offset: Floats,
    tree_edges: list[tuple[int, int, int]],
) -> None:
    """Visit all bodies that resting contacts join to the root, breadth first."""
    queue = [root]
    for node in queue:
        base = 0.0 if node < 0 else offset[node]
        for other, j in neighbours[node]:
            if other < 0 or of_body[other] != -2:
                continue
            # g = δ + u_right - u_left = 0
            offset[other] = base - gap[j] if left[j] == node else base + gap[j]
            of_body[other] = cluster
            tree_edges.append((other, j, node))
            queue.append(other)


def _in_cycles(left: Ints, right: Ints, resting: Ints, bodies: int) -> Bools:
    """Resting contacts on a directed cycle left to right, barriers taken as one node."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    size = bodies + 1
    graph = coo_array(
        (np.ones(len(resting)), (left[resting] % size, right[resting] % size)), shape=(size, size)
    )
    _, label = connected_components(graph.tocsr(), directed=True, connection="strong")
    return np.asarray(label[left[resting] % size] == label[right[resting] % size])


def _least_norm_map(left: Ints, right: Ints, resting: Ints, bodies: int) -> Floats:
    """Pseudo-inverse of W restricted to the resting contacts, shape (R, N)."""
    W = np.zeros((bodies + 1, len(resting)))
    for column, j in enumerate(resting):
        W[left[j], column] -= 1.0
        W[right[j], column] += 1.0
    return np.asarray(np.linalg.pinv(W[:bodies]), dtype=np.float64)
