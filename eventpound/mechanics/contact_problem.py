"""The complementarity problem over contacts between masses, part by part.

``w = G x + q``, ``0 <= w ⊥ x >= 0`` with the Delassus matrix
``G = Wᵀ M⁻¹ W``. Contacts that share no mass do not influence each other, so
the problem falls into parts; a part of one contact is a division, a long row
of bodies a tridiagonal problem, anything else a dense one.
"""

from __future__ import annotations

import numpy as np

from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.borrowing import put_numbers
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.numerics.graph import root
from eventpound.numerics.lcp import solve_chain, solve_dense

LONG_ROW = 24
"""Contacts in one row above which the tridiagonal method is used."""


@kernel
def parts(left: Ints, right: Ints, nodes: int) -> Ints:
    """Parts of the problem that do not influence each other.

    Parameters
    ----------
    left, right : ndarray of int, shape (k,)
        Masses each contact joins, not both -1, which does not move.
    nodes : int
        How many masses there are.

    Returns
    -------
    ndarray of int, shape (k,)
        The part of each contact, labelled by one of its masses.
    """
    parent = np.arange(nodes)
    for j in range(left.size):
        if left[j] >= 0 and right[j] >= 0:
            parent[root(parent, left[j])] = root(parent, right[j])
    label = np.empty(left.size, np.int64)
    for j in range(left.size):
        label[j] = root(parent, left[j] if left[j] >= 0 else right[j])
    return label


@scalar_kernel
def _coupling(left: Ints, right: Ints, inverse_mass: Floats, i: int, j: int) -> float:
    """Entry G_ij = Σ_b W_bi W_bj / m_b."""
    total = 0.0
    if right[i] >= 0:
        if right[i] == right[j]:
            total += inverse_mass[right[i]]
        if right[i] == left[j]:
            total -= inverse_mass[right[i]]
    if left[i] >= 0:
        if left[i] == left[j]:
            total += inverse_mass[left[i]]
        if left[i] == right[j]:
            total -= inverse_mass[left[i]]
    return total


@kernel
def delassus_matrix(left: Ints, right: Ints, inverse_mass: Floats, members: Ints) -> Floats:
    """``G = Wᵀ M⁻¹ W`` of some contacts, the members, shape (k, k) (1/kg)."""
    G = np.empty((members.size, members.size))
    for a in range(members.size):
        for b in range(members.size):
            G[a, b] = _coupling(left, right, inverse_mass, int(members[a]), int(members[b]))
    return G


@kernel
def _row_order(left: Ints, right: Ints, members: Ints, nodes: int) -> Ints:
    """The members from left to right where they form a simple row, else empty."""
    starting = np.full(nodes, -1, np.int64)
    ending = np.full(nodes, -1, np.int64)
    empty = np.empty(0, np.int64)
    for j in members:
        if left[j] >= 0:
            if starting[left[j]] >= 0:
                return empty
            starting[left[j]] = j
        if right[j] >= 0:
            if ending[right[j]] >= 0:
                return empty
            ending[right[j]] = j
    first = -1
    for j in members:
        if left[j] < 0 or ending[left[j]] < 0:
            first = j
    order = np.empty(members.size, np.int64)
    j = first
    for k in range(members.size):
        if j < 0:
            return empty
        order[k] = j
        j = starting[right[j]] if right[j] >= 0 else -1
    return order


@kernel
def solve_contacts(
    left: Ints, right: Ints, inverse_mass: Floats, q: Floats, noise: float
) -> tuple[Floats, Floats, bool]:
    """Solve ``0 <= Wᵀ M⁻¹ W x + q ⊥ x >= 0``.

    Parameters
    ----------
    left, right : ndarray of int, shape (k,)
        Masses each contact joins; -1 does not move.
    inverse_mass : ndarray, shape (nodes,)
        1/m (1/kg).
    q : ndarray, shape (k,)
        What each contact would do without the unknowns.
    noise : float
        What an entry of q may be wrong by.

    Returns
    -------
    x, w : ndarray, shape (k,)
        The solution.
    solved : bool
        False where a part has no solution.
    """
    x, w = np.zeros(q.size), np.zeros(q.size)
    label = parts(left, right, inverse_mass.size)
    solved = True
    members = np.empty(q.size, np.int64)
    for j in range(q.size):
        # No force moves what lies between two masses that move as they are told to.
        if _coupling(left, right, inverse_mass, j, j) == 0.0:
            w[j], label[j], solved = max(0.0, q[j]), -1, solved and q[j] >= 0.0
    for start in range(q.size):
        part, count = label[start], 0
        if part < 0:
            continue
        for j in range(start, q.size):
            if label[j] == part:
                members[count], label[j] = j, -1
                count += 1
        if count == 1:
            x[start] = max(0.0, -q[start] / _coupling(left, right, inverse_mass, start, start))
            w[start] = max(0.0, q[start])
            continue
        row = np.empty(0, np.int64)
        if count > LONG_ROW:
            row = _row_order(left, right, members[:count], inverse_mass.size)
        if row.size > 0:
            coupling = np.zeros(row.size + 1)
            for k in range(row.size + 1):
                mass = left[row[k]] if k < row.size else right[row[-1]]
                if mass >= 0:
                    coupling[k] = inverse_mass[mass]
            found, rate = solve_chain(coupling, q[row])
            put_numbers(found, row, x)
            put_numbers(rate, row, w)
            continue
        G, own = delassus_matrix(left, right, inverse_mass, members[:count]), np.empty(count)
        for a in range(count):
            own[a] = q[members[a]]
        found, rate, part_solved = solve_dense(G, own, noise)
        for a in range(count):
            x[members[a]], w[members[a]] = found[a], rate[a]
        solved = solved and part_solved
    return x, w, solved
