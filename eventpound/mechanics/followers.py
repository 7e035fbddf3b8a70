"""Coordinates that follow others: points between bodies, and what rests at them.

The coordinates of a scene are its bodies and its points (`eventpound.scene.point`), which have no
mass: ``u_P = Σ w_b u_b``. A contact joins two coordinates, whatever they are. Those that rest make
clusters of coordinates (`eventpound.mechanics.clusters`), each with one coordinate of its own; and
then every point is an equation between these. So ``q = N y + q̂``, with N by elimination on the
equations (`eventpound.numerics.elimination`), as it is for pairs, where N has zeros and ones alone.

Of N everybody wants the *compliance* ``A = N (Nᵀ M N)⁻¹ Nᵀ`` alone: clusters accelerate by
``q'' = A f - r a_g``, with ``r = A M 1``, which is 1 but where points lean on the ground; the
contact problem has ``Wᵀ A W``; and ``A M q`` puts coordinates on their constraints, moving them the
least, weighted by mass. What is given, as the motion of supports, is eliminated nowhere, and no
force moves it: its columns of A, which would be zero, hold ``D = N_g - A M N_g`` instead, by which
others go along. So f has the accelerations of what is given in the places of forces on it, and
``r = A M 1 + D 1``. ``A f`` keeps ``Wᵀ q`` and ``Wᵀ q'`` but for the rounding of the sums of an
integrator, some ``ε n^½`` of the motion after n steps; an event begins anew.

Contact forces follow from what they put on the bodies, those with the least sum of squares.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import deferred_kernel, kernel, scalar_kernel
from eventpound.numerics.elimination import pivot_of, solve_for
from eventpound.numerics.lcp import solve_dense
from eventpound.numerics.small_systems import dot, solve_definite, solve_transposed
from eventpound.tolerances import DEPENDENT, TIE_ROUNDING


class Rests(NamedTuple):
    """Resting contacts (R,), and what is to be filled in of them.

    left, right: coordinates, -1 for ground and barriers. pressed: contacts that a solution found
    so. carrying: those whose forces determine all others'. locked: those that cannot open. unique:
    those whose force is. force_map (R, N): forces that put what they can of given ones on
    coordinates.
    """

    left: Ints
    right: Ints
    pressed: Bools
    carrying: Bools
    locked: Bools
    unique: Bools
    force_map: Floats


@scalar_kernel
def is_support(b: int, mass: Floats) -> bool:
    """Whether a body moves as it is told to, whatever acts on it: its mass is inf.

    So is that of a cluster which holds one.

    Only the first bodies (`eventpound.mechanics.supported`) are supports, and not all are.
    """
    return mass[b] == np.inf


@kernel
def supports_of(mass: Floats) -> Ints:
    """The supports, or clusters that hold one."""
    return np.flatnonzero(mass == np.inf)


@scalar_kernel
def is_unmoved(b: int, mass: Floats) -> bool:
    """Whether no force moves it: a support; or the ground or a barrier, which are -1."""
    return b < 0 or is_support(b, mass)


@scalar_kernel
def own_mass(b: int, mass: Floats) -> float:
    """Mass of a body that forces move (kg): none of a support."""
    return 0.0 if is_support(b, mass) else float(mass[b])


@scalar_kernel
def force_or_given(b: int, force: float, given: float, mass: Floats) -> float:
    """The force on a body or cluster (N), in its place the acceleration that is `given` (m/s²)."""
    return given if is_support(b, mass) else force


@scalar_kernel
def acceleration_of(b: int, force: float, mass: Floats) -> float:
    """Acceleration in space (m/s²) of what follows no other, by its `force_or_given`."""
    return force if is_support(b, mass) else force / float(mass[b])


@scalar_kernel
def drive(of_body: Ints, mass: Floats, given: Floats, values: Floats) -> None:
    """Give clusters with a support what is `given` of it (N,), whatever their `values` are."""
    # Backwards: of several supports in a cluster the first one counts.
    for b in range(mass.size - 1, -1, -1):
        if of_body[b] >= 0 and is_support(b, mass):
            values[of_body[b]] = given[b]


@kernel
def place_points(weights: Floats, values: Floats) -> None:
    """Give points, the last D of N values, the mean of those of bodies; `weights` (D, N)."""
    first = values.size - weights.shape[0]
    for d in range(weights.shape[0]):
        total = 0.0
        for b in range(first):
            total += weights[d, b] * values[b]
        values[first + d] = total


@scalar_kernel
def on_body(node: int, b: int, weights: Floats) -> bool:
    """Whether a coordinate is that of a point on a body."""
    first = weights.shape[1] - weights.shape[0]
    return node >= first and weights[node - first, b] != 0.0


@scalar_kernel
def row_answer(c: int, count: int, compliance: Floats, force: Floats) -> float:
    """``A f`` of one of the clusters, `count` of them."""
    total = 0.0
    for d in range(count):
        total += compliance[c, d] * force[d]
    return total


@scalar_kernel
def answers(compliance: Floats, force: Floats, values: Floats) -> None:
    """``A f`` into `values`, all of the size of the clusters at least."""
    count = compliance.shape[0]
    for c in range(count):
        values[c] = row_answer(c, count, compliance, force)


@scalar_kernel
def felt_mass(c: int, mass: Floats, compliance: Floats) -> float:
    """What a force at a cluster has to move (kg); `compliance` is empty without points."""
    coupled = compliance.shape[0] > 0 and not is_support(c, mass)
    return 1.0 / compliance[c, c] if coupled else float(mass[c])


@deferred_kernel
def examine_rests(rests: Rests, own: int, mass: Floats, weights: Floats) -> None:
    """Fill in which contacts carry, are locked and have unique forces, and their forces.

    Those behind the `own` ones, of sliders, lock none.
    """
    rows = rows_of(rests.left, rests.right, mass.size, weights)
    R, first = rows.shape
    # What moves as it is told to no force moves.
    for b in supports_of(mass[:first]):
        rows[:, b] = 0.0
    basis, parts, order = np.zeros(rows.shape), np.zeros((R, R)), np.zeros(R, np.int64)
    count = 0
    for turn in (True, False):
        for i in range(R):
            if rests.pressed[i] != turn:
                continue
            left = rows[i].copy()
            # Twice is enough: the first turn leaves the rounding of what it took away.
            for _ in range(2):
                for k in range(count):
                    share = dot(basis[k], left)
                    parts[i, k] += share
                    left -= share * basis[k]
            length = np.sqrt(dot(left, left))
            if length > DEPENDENT * np.sqrt(dot(rows[i], rows[i])):
                basis[count], parts[i, count], order[count] = left / length, length, i
                rests.carrying[i] = True
                count += 1
    lower = np.zeros((count, count))
    for a in range(count):
        lower[a] = parts[order[a], :count]
    for b in range(first):
        solve_transposed(lower, basis[:count, b].copy(), order, rests.force_map[:, b])
    # What acts on a point acts on its bodies.
    for d in range(weights.shape[0]):
        for b in range(first):
            rests.force_map[:, first + d] += weights[d, b] * rests.force_map[:, b]
    rests.unique[:] = True
    parts_of = np.zeros(R)
    # A redundant contact can take over from those that it is a sum of.
    for i in range(R):
        if not rests.carrying[i]:
            rests.unique[i] = False
            solve_transposed(lower, parts[i, :count].copy(), order, parts_of)
            for a in range(count):
                if abs(parts_of[order[a]]) > DEPENDENT:
                    rests.unique[order[a]] = False
    if count < R:
        rests.locked[:own] = held_closed(rows[:own])


@kernel
def rows_of(left: Ints, right: Ints, coordinates: int, weights: Floats) -> Floats:
    """Directions in the bodies of what is between these coordinates, shape (R, bodies)."""
    first = coordinates - weights.shape[0]
    rows = np.zeros((left.size, first))
    for i in range(left.size):
        for end, sign in ((left[i], -1.0), (right[i], 1.0)):
            if end >= first:
                for b in range(first):
                    rows[i, b] += sign * weights[end - first, b]
            elif end >= 0:
                rows[i, end] += sign
    return rows


@kernel
def held_closed(rows: Floats) -> Bools:
    """Contacts (R,) that cannot open: pressures of all others balance one on it.

    `rows` (R, bodies): their directions in what forces move. What is given balances any force: so
    they hold until its motion opens one, which is another mode. Which pressures balance a contact
    best is a complementarity problem (least squares without negative unknowns).
    """
    R, locked = rows.shape[0], np.zeros(rows.shape[0], np.bool_)
    G, q, x = np.empty((R - 1, R - 1)), np.empty(R - 1), np.zeros(R)
    for j in range(R):
        others = np.flatnonzero(np.arange(R) != j)
        for a in range(R - 1):
            # Least squares of row j plus Σ x_i row_i over x >= 0.
            q[a] = dot(rows[others[a]], rows[j])
            for b in range(R - 1):
                G[a, b] = dot(rows[others[a]], rows[others[b]])
        found, _, solved = solve_dense(G, q, 0.0)
        x[:], x[j] = 0.0, 1.0
        for a in range(R - 1):
            x[others[a]] = found[a]
        left = np.zeros(rows.shape[1])
        for i in range(R):
            left += x[i] * rows[i]
        size = np.sqrt(dot(rows[j], rows[j]))
        locked[j] = solved and np.sqrt(dot(left, left)) <= DEPENDENT * size
    return locked


class Grouped(NamedTuple):
    """Coordinates (N,) in groups that move alike, C of them; overwritten where some follow others.

    of_body: group of each, -1 of those that stand still. offset: its place in it (m). compliance
    (N, N): the first n rows and columns are A, n groups that move, those that follow others at
    last. carried (N,): r.
    """

    of_body: Ints
    offset: Floats
    compliance: Floats
    carried: Floats


@deferred_kernel
def follow(groups: int, mass: Floats, weights: Floats, out: Grouped) -> int:
    """Eliminate what points tie of so many groups; how many groups move after all.

    Parameters
    ----------
    groups : int
        C.
    mass : ndarray, shape (N,)
        Of the coordinates (kg), none of points.
    weights : ndarray, shape (D, N)
        Of the points, the last of them.
    out : Grouped
        Overwritten.
    """
    total = np.zeros(groups)
    for b in range(mass.size):
        if out.of_body[b] >= 0:
            total[out.of_body[b]] += mass[b]
    ties = _ties(groups, weights, out)
    row_of = _eliminate(ties, total)
    place = _number(ties, row_of)
    moving = 0
    for c in range(groups):
        moving = max(moving, place[c] + 1)
    N, weighed, free = np.zeros((moving, moving)), np.zeros(moving), 0
    for c in range(groups):
        if place[c] >= 0:
            weighed[place[c]] = total[c]
        if row_of[c] < 0:
            free += 1
            N[place[c], place[c]] = 1.0
        elif place[c] >= 0:
            for d in range(groups):
                if row_of[d] < 0:
                    # Solved for the group c its equation reads q_c = -Σ ties_d q_d - ties_C.
                    N[place[c], place[d]] = -ties[row_of[c], d]
    _put_compliance(N[:, :free].copy(), weighed, out)
    for b in range(mass.size):
        c = out.of_body[b]
        if c >= 0:
            out.of_body[b] = place[c]
            if row_of[c] >= 0:
                out.offset[b] -= ties[row_of[c], groups]
    return moving


@kernel
def _ties(groups: int, weights: Floats, at: Grouped) -> Floats:
    """An equation a point: coefficients of the groups, then what they add up to, less, (D, C + 1).

    ``u_P - Σ w_b u_b = 0``.
    """
    ties, first = np.zeros((weights.shape[0], groups + 1)), weights.shape[1] - weights.shape[0]
    for d in range(ties.shape[0]):
        for b in range(first + 1):
            node = b if b < first else first + d
            factor = -weights[d, b] if b < first else 1.0
            ties[d, groups] += factor * at.offset[node]
            if at.of_body[node] >= 0:
                ties[d, at.of_body[node]] += factor
    return ties


@kernel
def _eliminate(ties: Floats, mass: Floats) -> Ints:
    """Solve each equation for a group, and put that into the others; the row of each group, or -1.

    Groups without mass first, which must not be left; none that is given.
    """
    row_of, done = np.full(mass.size, -1, np.int64), np.zeros(ties.shape[0], np.bool_)
    for turn in range(2):
        for e in range(done.size):
            best = -1 if done[e] else pivot_of(ties[e], mass)
            if best >= 0 and (turn == 1 or mass[best] == 0.0):
                row_of[best], done[e] = e, True
                solve_for(ties, e, best, mass.size)
    return row_of


@kernel
def _number(ties: Floats, row_of: Ints) -> Ints:
    """New numbers of groups (C,): those left, then those that follow them, -1 that stand still."""
    place, count = np.full(row_of.size, -1, np.int64), 0
    for c in range(row_of.size):
        if row_of[c] < 0:
            place[c] = count
            count += 1
    for c in range(row_of.size):
        follows = False
        for d in range(row_of.size):
            follows |= row_of[c] >= 0 and row_of[d] < 0 and ties[row_of[c], d] != 0.0
        if follows:
            place[c] = count
            count += 1
    return place


@kernel
def _put_compliance(N: Floats, mass: Floats, out: Grouped) -> None:
    """A, with D in it, and r of n groups with such masses (kg), N of shape (n, those left)."""
    moving, free = N.shape
    # Nᵀ M N is symmetric: its lower triangle is all that is wanted.
    K, right, own = np.zeros((free, free)), N.T.copy(), mass.copy()
    for c in range(moving):
        own[c] = own_mass(c, mass)
        for a in range(free):
            for b in range(a + 1):
                K[a, b] += own[c] * N[c, a] * N[c, b]
    given = supports_of(mass[:free])
    for g in given:
        K[g], K[:, g], K[g, g], right[g] = 0.0, 0.0, 1.0, 0.0
    answer = solve_definite(K, right)
    out.compliance[:] = 0.0
    for c in range(moving):
        out.carried[c] = 0.0
        for d in range(moving):
            for a in range(free):
                out.compliance[c, d] += N[c, a] * answer[a, d]
            out.carried[c] += out.compliance[c, d] * own[d]
    for g in given:
        for c in range(moving):
            along = N[c, g]
            for d in range(moving):
                along -= out.compliance[c, d] * own[d] * N[d, g]
            out.compliance[c, g] = along
            out.carried[c] += along
    for c in range(moving):
        # What leans on no ground is carried by it whole.
        if abs(out.carried[c] - 1.0) <= TIE_ROUNDING * moving:
            out.carried[c] = 1.0
