"""The complementarity problem over contacts between masses, part by part.

``w = G x + q``, ``0 <= w ⊥ x >= 0`` with the Delassus matrix
``G = Wᵀ M⁻¹ W``. Contacts that share no mass do not influence each other, so
the problem falls into parts; a part of one contact is a division, a long row
of bodies a tridiagonal problem, anything else a dense one.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.borrowing import put_numbers
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.numerics.graph import root
from eventpound.numerics.lcp import solve_chain, solve_dense

LONG_ROW = 24
"""Contacts in one row above which the tridiagonal method is used."""


class Joints(NamedTuple):
    """Contacts as pairs of n coordinates, and how these answer to forces.

    left, right (k,): coordinates each contact joins, not both -1, which does not move.
    inverse_mass (n,): of a coordinate by itself, 1/m (1/kg). compliance (n, n): by how much a
    force at one accelerates another (1/kg), where some follow others
    (`eventpound.mechanics.followers`); empty where that is the diagonal 1/m.
    """

    left: Ints
    right: Ints
    inverse_mass: Floats
    compliance: Floats


@kernel
def of_members(joints: Joints, members: Ints) -> Joints:
    """Some of the contacts."""
    left, right = joints.left[members], joints.right[members]
    return Joints(left, right, joints.inverse_mass, joints.compliance)


@kernel
def parts(joints: Joints) -> Ints:
    """Parts of the problem that do not influence each other.

    Returns
    -------
    ndarray of int, shape (k,)
        The part of each contact, labelled by one of its coordinates.
    """
    left, right, nodes = joints.left, joints.right, joints.inverse_mass.size
    if joints.compliance.size > 0:
        return _coupled_parts(joints)
    parent = np.arange(nodes)
    for j in range(left.size):
        # A barrier hands nothing on, so it joins no two contacts.
        if left[j] >= 0 and right[j] >= 0:
            parent[root(parent, left[j])] = root(parent, right[j])
    label = np.empty(left.size, np.int64)
    for j in range(left.size):
        label[j] = root(parent, left[j] if left[j] >= 0 else right[j])
    return label


@kernel
def _coupled_parts(joints: Joints) -> Ints:
    """`parts` where coordinates answer to forces at others."""
    left, right = joints.left, joints.right
    # Over contacts and not coordinates, as a force moves all that follow the one that it acts on.
    parent = np.arange(left.size)
    for i in range(left.size):
        for j in range(i):
            if coupling(joints, i, j) != 0.0:
                parent[root(parent, i)] = root(parent, j)
    label = np.empty(left.size, np.int64)
    for j in range(left.size):
        first = root(parent, j)
        label[j] = left[first] if left[first] >= 0 else right[first]
    return label


@scalar_kernel
def answer(joints: Joints, node: int, left: int, right: int) -> float:
    """Acceleration of a coordinate under the force 1 of a contact that pushes its ends apart."""
    total = 0.0
    # None moves what is given, whose column tells how others go along.
    if right >= 0 and joints.inverse_mass[right] > 0.0:
        total += joints.compliance[node, right]
    if left >= 0 and joints.inverse_mass[left] > 0.0:
        total -= joints.compliance[node, left]
    return total


@scalar_kernel
def coupling(joints: Joints, i: int, j: int) -> float:
    """Entry G_ij of ``Wᵀ M⁻¹ W`` (1/kg)."""
    left, right, total = joints.left, joints.right, 0.0
    inverse_mass = joints.inverse_mass
    if joints.compliance.size > 0:
        # g = δ + u_right - u_left: positive where a body is on the same side of both.
        if right[i] >= 0:
            total += answer(joints, right[i], left[j], right[j])
        if left[i] >= 0:
            total -= answer(joints, left[i], left[j], right[j])
        return total
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
def delassus_matrix(joints: Joints, members: Ints) -> Floats:
    """``G = Wᵀ M⁻¹ W`` of some contacts, the members, shape (k, k) (1/kg)."""
    G = np.empty((members.size, members.size))
    for a in range(members.size):
        for b in range(members.size):
            G[a, b] = coupling(joints, int(members[a]), int(members[b]))
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
    # In a ring none is the first, and the order stays empty.
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
def _solve_row(row: Ints, joints: Joints, q: Floats, x: Floats, w: Floats) -> None:
    """Put what `solve_contacts` returns of a row of contacts, from left to right, into x and w."""
    inverse = np.zeros(row.size + 1)
    for k in range(row.size + 1):
        mass = joints.left[row[k]] if k < row.size else joints.right[row[-1]]
        if mass >= 0:
            inverse[k] = joints.inverse_mass[mass]
    found, rate = solve_chain(inverse, q[row])
    put_numbers(found, row, x)
    put_numbers(rate, row, w)


@kernel
def solve_contacts(joints: Joints, q: Floats, noise: float) -> tuple[Floats, Floats, bool]:
    """Solve ``0 <= Wᵀ M⁻¹ W x + q ⊥ x >= 0``.

    Parameters
    ----------
    joints : Joints
        The contacts.
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
    label = parts(joints)
    solved, paired = True, joints.compliance.size == 0
    members = np.empty(q.size, np.int64)
    for j in range(q.size):
        # No force moves what lies between two masses that move as they are told to.
        if coupling(joints, j, j) == 0.0:
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
            x[start] = max(0.0, -q[start] / coupling(joints, start, start))
            w[start] = max(0.0, q[start])
            continue
        row = np.empty(0, np.int64)
        # A row with points is none: its bodies answer to forces beyond their neighbours.
        if count > LONG_ROW and paired:
            nodes = joints.inverse_mass.size
            row = _row_order(joints.left, joints.right, members[:count], nodes)
        if row.size > 0:
            _solve_row(row, joints, q, x, w)
            continue
        G, own = delassus_matrix(joints, members[:count]), np.empty(count)
        for a in range(count):
            own[a] = q[members[a]]
        found, rate, part_solved = solve_dense(G, own, noise)
        for a in range(count):
            x[members[a]], w[members[a]] = found[a], rate[a]
        solved = solved and part_solved
    return x, w, solved
