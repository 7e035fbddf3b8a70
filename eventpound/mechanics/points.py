"""Contacts at points between bodies (`eventpound.scene.point`) in the equations of motion.

Bodies at rest on each other are one cluster; a resting contact at a point is a constraint
``Wᵀ u = const`` on the clusters instead. With ``P = I - M⁻¹ W (Wᵀ M⁻¹ W)⁻¹ Wᵀ`` the
accelerations that its forces leave are P times those without them, and of every derivative P
times what it would be. A mode without such a contact has an empty P, and nothing is done.

``Wᵀ u`` and ``Wᵀ v`` are linear and constant, which every integrator here keeps but for the
rounding of its sums: after n steps some ``ε n^½ (|u| + |v| t)``, and an event begins anew.

Which constraints of a mode are independent, its P, and the map from the forces on bodies to
those of all resting contacts are made once a mode, by NumPy.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.clusters import Clusters
from eventpound.mechanics.descriptor import contact_rows
from eventpound.mechanics.model import Model
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import kernel
from eventpound.tolerances import DEPENDENT, ZERO_SINGULAR_VALUE


@kernel
def hold(P: Floats, values: Floats) -> None:
    """Multiply values of the clusters, the first C, by P (C, C), in place."""
    free, clusters = values.copy(), P.shape[0]
    for c in range(clusters):
        values[c] = 0.0
        for d in range(clusters):
            values[c] += P[c, d] * free[d]


@kernel
def hold_at(P: Floats, places: Ints, values: Floats) -> None:
    """`hold` of what stands at these places (C,) of an array."""
    own = np.empty(places.size)
    for c in range(own.size):
        own[c] = values[places[c]]
    hold(P, own)
    for c in range(own.size):
        values[places[c]] = own[c]


@kernel
def hold_beside_ground(P: Floats, ground: float, values: Floats) -> None:
    """`hold` of absolute accelerations, or rates of them, over that of the ground."""
    for c in range(P.shape[0]):
        values[c] -= ground
    hold(P, values)
    for c in range(P.shape[0]):
        values[c] += ground


@kernel
def add_points(points: Ints, spread: Floats, values: Floats, gaps: Floats) -> None:
    """Add to the gaps of contacts at points what values (N,) of the bodies make of them.

    `points` (D,), `spread` (D, N): those of the `eventpound.mechanics.model.Model`. gaps (K,).
    """
    for p in range(points.size):
        for b in range(values.size):
            gaps[points[p]] += spread[p, b] * values[b]


def with_points(
    model: Model, clusters: Clusters, resting: Bools, pressed: Bools
) -> tuple[Clusters, Floats]:
    """Clusters with the contacts at points that rest, and the projection they make.

    Parameters
    ----------
    model : Model
        The scene.
    clusters : Clusters
        Those of the other resting contacts.
    resting, pressed : ndarray of bool, shape (K,)
        Contacts at points that rest, and those a solution found pressed, which carry the
        forces where contacts are redundant.
    """
    every, members = contact_rows(model), np.flatnonzero(resting)
    clusters = _with_standing(clusters, every[members], model.gap[members])
    rows, mass = on_clusters(every[members], clusters.of_body, model.mass, clusters.count)
    chosen = independent(rows, mass, pressed[members])
    all_resting = np.sort(np.concatenate((clusters.resting, members)))
    W = every[all_resting]
    carries = pressed[all_resting] & ~np.isin(all_resting, clusters.resting[clusters.redundant])
    redundant = ~independent(W, np.ones(model.bodies), carries)
    locked = held_closed(W) if redundant.any() else redundant
    forces, own = np.zeros(W.shape), slice(model.supports, None)
    forces[~redundant, own] = np.linalg.pinv(W[~redundant, own].T, ZERO_SINGULAR_VALUE)
    joined = clusters._replace(
        resting=all_resting, locked=locked, redundant=redundant, force_map=forces
    )
    return joined, projection_of(rows[chosen], mass)


def _with_standing(clusters: Clusters, rows: Floats, gap: Floats) -> Clusters:
    """Clusters of which those that constraints leave no motion stand still, as on a barrier.

    A mode in which nothing moves is known by that it has no clusters: its contact forces follow
    the ground alone, however long a step could be.

    Parameters
    ----------
    clusters : Clusters
        Without contacts at points.
    rows, gap : ndarray, shape (k, N), (k,)
        Directions of the constraints and gaps at zero displacement (m).
    """
    from scipy.linalg import null_space

    D, _ = on_clusters(rows, clusters.of_body, np.ones(rows.shape[1]), clusters.count)
    free = null_space(D, DEPENDENT) if D.size > 0 else np.eye(clusters.count)
    standing = np.linalg.norm(free, axis=1) <= DEPENDENT
    if not standing.any():
        return clusters
    q = np.linalg.lstsq(D, -(gap + rows @ clusters.offset), DEPENDENT)[0]
    number = np.append(np.where(standing, -1, np.cumsum(~standing) - 1), -1)
    held = np.append(standing, False)[clusters.of_body]
    offset = clusters.offset + np.where(held, np.append(q, 0.0)[clusters.of_body], 0.0)
    return clusters._replace(
        of_body=number[clusters.of_body], offset=offset, count=int((~standing).sum())
    )


def on_clusters(rows: Floats, of_body: Ints, mass: Floats, count: int) -> tuple[Floats, Floats]:
    """Directions of gaps in the coordinates of clusters, shape (k, C), and their masses (C,)."""
    found, total = np.zeros((rows.shape[0], count)), np.zeros(count)
    for b in np.flatnonzero(of_body >= 0):
        found[:, of_body[b]] += rows[:, b]
        total[of_body[b]] += mass[b]
    return found, total


def independent(rows: Floats, mass: Floats, first: Bools) -> Bools:
    """Rows (k, C) that no others of those chosen make up, `first` ones before others, (k,)."""
    scaled = rows / np.sqrt(mass)
    chosen = np.zeros(rows.shape[0], np.bool_)
    basis = np.zeros((0, rows.shape[1]))
    for j in (*np.flatnonzero(first), *np.flatnonzero(~first)):
        left = scaled[j].copy()
        for _ in range(2):
            left -= basis.T @ (basis @ left)
        length = float(np.linalg.norm(left))
        if length > DEPENDENT * np.linalg.norm(scaled[j]):
            basis, chosen[j] = np.vstack((basis, left / length)), True
    return chosen


def projection_of(rows: Floats, mass: Floats) -> Floats:
    """``I - M⁻¹ W (Wᵀ M⁻¹ W)⁻¹ Wᵀ`` of independent rows (k, C) of Wᵀ, shape (C, C).

    From orthonormal directions in the metric of the masses, so that it errs by rounding alone;
    clusters that no row names are left to the last bit. Empty where there are no rows.
    """
    if rows.shape[0] == 0:
        return np.zeros((0, 0))
    from scipy.linalg import qr

    P, root = np.eye(mass.size), np.sqrt(mass)
    named = np.flatnonzero(rows.any(axis=0))
    if named.size > 0:
        Q, R = qr((rows[:, named] / root[named]).T, mode="economic")
        held, own = np.isinf(root[named]), np.where(np.isinf(root), 1.0, root)[named]
        Q[held] = 0.0
        back = (Q @ Q.T) * own / own[:, None]
        if held.any():
            # No force moves what a support carries, which moves the others.
            back[:, held] = Q / own[:, None] @ np.linalg.solve(R.T, rows[:, named[held]])
        P[np.ix_(named, named)] -= back
    return P


def held_closed(W: Floats) -> Bools:
    """Contacts (R,) that cannot open: pressures of all others balance one on it.

    `W` (R, N): the rows of the resting contacts.
    """
    from scipy.optimize import nnls

    locked = np.zeros(W.shape[0], np.bool_)
    for j in range(W.shape[0]):
        others = np.delete(W, j, axis=0)
        left = nnls(others.T, -W[j])[1] if others.size > 0 else np.inf
        locked[j] = left <= DEPENDENT * np.linalg.norm(W[j])
    return locked


def unique_forces_of(W: Floats) -> Bools:
    """Resting contacts whose force is unique, shape (R,): no forces in balance have a part in it.

    `W` (R, N): their rows.
    """
    balance = np.eye(W.shape[0]) - W @ np.linalg.pinv(W, ZERO_SINGULAR_VALUE)
    return np.asarray(np.abs(np.diagonal(balance)) <= DEPENDENT)
