"""Graphs of a few nodes as arrays: disjoint sets, lists by node, directed cycles."""

from __future__ import annotations

import numpy as np

from eventpound.numerics.arrays import Bools, Ints
from eventpound.numerics.compiled import kernel, scalar_kernel


@scalar_kernel
def root(parent: Ints, node: int) -> int:
    """Representative of the set a node belongs to; paths are halved on the way.

    Parameters
    ----------
    parent : ndarray of int, shape (nodes,)
        A representative is its own parent.
    node : int
        The node.
    """
    while parent[node] != node:
        parent[node] = parent[parent[node]]
        node = parent[node]
    return node


@kernel
def grouped(label: Ints, groups: int) -> tuple[Ints, Ints]:
    """Positions by label, in their order.

    Parameters
    ----------
    label : ndarray of int, shape (n,)
        Group of each position.
    groups : int
        Number of groups.

    Returns
    -------
    first : ndarray of int, shape (groups + 1,)
        Group g is ``position[first[g] : first[g + 1]]``.
    position : ndarray of int, shape (n,)
        All positions, group after group.
    """
    first = np.zeros(groups + 1, np.int64)
    for i in range(label.size):
        # One place on, so that the sums below are where each group begins.
        first[label[i] + 1] += 1
    for g in range(groups):
        first[g + 1] += first[g]
    following = first[:groups].copy()
    position = np.empty(label.size, np.int64)
    for i in range(label.size):
        position[following[label[i]]] = i
        following[label[i]] += 1
    return first, position


@kernel
def on_directed_cycles(tail: Ints, head: Ints, nodes: int) -> Bools:
    """Which edges lie on a directed cycle: those whose head leads back to their tail.

    Parameters
    ----------
    tail, head : ndarray of int, shape (edges,)
        Nodes each edge leads from and to.
    nodes : int
        Number of nodes.
    """
    result = np.zeros(tail.size, np.bool_)
    first, leaving = grouped(tail, nodes)
    queue = np.empty(nodes, np.int64)
    for edge in range(tail.size):
        reached = np.zeros(nodes, np.bool_)
        reached[head[edge]] = True
        queue[0] = head[edge]
        length, k = 1, 0
        while k < length and not reached[tail[edge]]:
            for i in range(first[queue[k]], first[queue[k] + 1]):
                other = head[leaving[i]]
                if not reached[other]:
                    reached[other] = True
                    queue[length] = other
                    length += 1
            k += 1
        result[edge] = reached[tail[edge]]
    return result
