"""The acceleration problem where contacts may be at points between bodies.

As `eventpound.solvers.events.rest`, with the contacts found pressed at points as constraints
(`eventpound.mechanics.points`) beside the clusters of the others, and a dense matrix.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.clusters import join_bodies
from eventpound.mechanics.points import DEPENDENT, independent, on_clusters, projection_of
from eventpound.mechanics.reduced import Branches, Reduced, reduce, state_vector
from eventpound.mechanics.series import motion_series
from eventpound.motion.base import Family
from eventpound.motion.forcing import decay_time, ground_taylor
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import in_python
from eventpound.numerics.lcp import solve_dense
from eventpound.solvers.events.noise import ACCELERATION
from eventpound.solvers.events.rest import (
    DIRECT,
    ORDER,
    UNDECIDED,
    Touching,
    clusters_pulled,
    links_held,
    pass_on,
)


class _Held(NamedTuple):
    """What moves with contacts pressed.

    rows (K, C): directions of the gaps in the coordinates of the clusters. mass (C,) (kg).
    leaves (K,): whether the contacts pressed leave the gap of a contact free. joined (C, C): which
    clusters they make depend on each other.
    """

    system: Reduced
    y: Floats
    rows: Floats
    mass: Floats
    leaves: Bools
    joined: Bools


def rest_contacts_at_points(
    touching: Touching, rows: Floats, at_points: Bools
) -> tuple[Bools, Bools, bool]:
    """The acceleration problem, order by order; returns as `rest_contacts`.

    Parameters
    ----------
    touching : Touching
        The problem.
    rows : ndarray, shape (K, N)
        Directions of the gaps, Wᵀ.
    at_points : ndarray of bool, shape (K,)
        Contacts at points.
    """
    undecided = touching.undecided.copy()
    pressed, kept = np.zeros(undecided.size, np.bool_), np.zeros(undecided.size, np.bool_)
    while undecided.any():
        now = _with_pressed(touching, rows, at_points, pressed)
        kept |= undecided & ~now.leaves
        undecided &= now.leaves
        if not undecided.any():
            break
        order, opening, level = _first_deciding(touching, now, undecided)
        if order < 0:
            break
        members = np.flatnonzero(undecided)
        D, P = now.rows[members], now.system.projection
        free = D / now.mass if P.size == 0 else (P @ (D / now.mass).T).T
        force, after, solved = solve_dense(D @ free.T, opening[members], level[members].max())
        if not solved:
            return undecided, pressed, False
        opens = after > level[members]
        decided = opens | (force > 0.0)
        if order == 0:
            decided &= ~touching.released[members]
        if not decided.any():
            break
        undecided[members[decided]] = False
        pressed[members[decided & ~opens]] = True
    return pressed | kept | undecided, pressed, True


def _with_pressed(touching: Touching, rows: Floats, at_points: Bools, pressed: Bools) -> _Held:
    mass, ordinary = touching.mass, pressed & ~at_points
    left, right, gap = touching.left, touching.right, touching.gap
    clusters = in_python(join_bodies)(left, right, gap, ordinary, ordinary, mass.size)
    system = in_python(reduce)(
        touching.link_ends,
        touching.law,
        mass,
        touching.hysteretic,
        clusters,
        Branches(touching.stiffness, touching.preload),
        0,
    )
    y = in_python(state_vector)(
        clusters, system, mass, touching.u, touching.v, touching.z, np.empty(0)
    )
    D, total = on_clusters(rows, clusters.of_body, mass, clusters.count)
    constraints = D[pressed & at_points]
    chosen = independent(constraints, total, np.ones(constraints.shape[0], np.bool_))
    left_of, joined = D, np.eye(total.size, dtype=np.bool_)
    if chosen.any():
        P = projection_of(constraints[chosen], total)
        system = system._replace(projection=P)
        left_of, joined = D @ P, joined | (P != 0.0)
    # In the metric of the masses, as the constraints are told apart.
    size = np.linalg.norm(left_of / np.sqrt(total), axis=1)
    leaves = size > DEPENDENT * np.linalg.norm(rows / np.sqrt(mass), axis=1)
    return _Held(system, y, D, total, leaves, joined)


def _first_deciding(touching: Touching, now: _Held, undecided: Bools) -> tuple[int, Floats, Floats]:
    """Lowest order at which an undecided gap accelerates, or -1.

    With it the coefficients of the accelerations of all gaps, shape (K,), and their noise.
    """
    forcing, system = touching.forcing, now.system
    stiffness, damping = in_python(links_held)(system)
    moved = (now.joined @ in_python(clusters_pulled)(system)) | (
        forcing.family != int(Family.GAUSSIAN)
    )
    together = _parts(now, undecided)
    time = min(touching.time, decay_time(forcing, forcing.start))
    opening = level = np.zeros(undecided.size)
    for highest in (1, ORDER):
        Y = in_python(motion_series)(0.0, now.y, system, forcing, highest, touching.speed_noise)
        ground = np.zeros(ORDER)
        ground_taylor(forcing, forcing.start, highest, ground)
        rounding = np.zeros((highest + 2, now.mass.size))
        own = ACCELERATION * touching.acceleration
        for order in range(highest):
            coefficient = Y[order + 1][system.iv]
            absolute = np.abs(coefficient + ground[order] / (order + 1))
            rounding[order] = np.where(moved, np.maximum(rounding[order], own), 0.0)
            part = DIRECT if order == 0 else UNDECIDED
            noise = np.maximum(part * absolute, rounding[order])
            in_python(pass_on)(rounding, order, system, stiffness, damping)
            level = np.max(np.where(together, noise, 0.0), axis=1, initial=0.0)
            own /= time * (order + 1)
            opening = now.rows @ coefficient
            opening[np.abs(opening) <= level] = 0.0
            deciding = undecided & (opening != 0.0)
            if order == 0:
                deciding &= ~touching.released
            if deciding.any():
                return order, opening, level
    return -1, opening, level


def _parts(now: _Held, undecided: Bools) -> Bools:
    """Clusters that have to do with a contact by way of undecided and pressed ones, (K, C)."""
    touched = now.rows != 0.0
    linked = now.joined | (touched[undecided].T.astype(int) @ touched[undecided].astype(int) > 0)
    for _ in range(max(1, int(np.ceil(np.log2(max(2, linked.shape[0])))))):
        linked = linked | (linked.astype(int) @ linked.astype(int) > 0)
    return np.asarray(touched.astype(int) @ linked.astype(int) > 0)
