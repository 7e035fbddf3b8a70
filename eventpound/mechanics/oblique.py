"""Slip at contacts with friction, which makes the motion of a mode an oblique projection.

Of a mode with the constraints W of all that rests and sticks, ``q'' = A f`` with A of
`eventpound.mechanics.followers`, and λ = F r gives contact forces from what these put on the
coordinates, ``r = M q'' - f``. While contacts slip, each adds ``w_s λ_s`` with
``w_s = -σ μ W_T`` of its tangential row and λ_s its normal force, so that

    λ_s = -H f,   H = (I + P w)⁻¹ P,   P = F_s (I - M A)
    q'' = A (f - w H f),   λ = F r - F w (I + F_s w)⁻¹ F_s r

and friction takes the power ``Σ_s (w_s · v) (H_s · f)``. Where ``I + P w`` has no inverse, friction
presses as much as it lifts (Painlevé); the acceleration problem has said so before.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from eventpound.mechanics.clusters import Clusters, ContactEnds
from eventpound.mechanics.followers import rows_of
from eventpound.mechanics.observables import difference
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import kernel
from eventpound.numerics.small_systems import dot, invert
from eventpound.tolerances import DEPENDENT


class Slips(NamedTuple):
    """Contacts that slip in a mode, of F with friction.

    which (S,): which of the F. rest (S,): place of each among the resting contacts. left, right
    (S,): coordinates along which it slides. drag (S,): ``-σ μ``.
    """

    which: Ints
    rest: Ints
    left: Ints
    right: Ints
    drag: Floats


@kernel
def slips_of(
    rubbing: Ints, friction: Floats, between: ContactEnds, branch: Ints, resting: Ints
) -> Slips:
    """Contacts that slip in a mode.

    Parameters
    ----------
    rubbing, friction
        Those of the `Model` with friction.
    between : ContactEnds
        Its contacts.
    branch : ndarray of int, shape (L,)
        Ways of slips, of the last F links.
    resting : ndarray of int, shape (R,)
        The resting contacts.
    """
    F, count = rubbing.size, 0
    which, rest = np.zeros(F, np.int64), np.zeros(F, np.int64)
    for f in range(F):
        for i in range(resting.size):
            if resting[i] == rubbing[f] and branch[branch.size - F + f] != 0:
                which[count], rest[count] = f, i
                count += 1
    which = which[:count].copy()
    along, way = between.left.size - F + which, branch[branch.size - F + which]
    ends, drag = (between.left[along], between.right[along]), -way * friction[rubbing[which]]
    return Slips(which, rest[:count].copy(), ends[0], ends[1], drag)


class _Moved(NamedTuple):
    """What slips change of `Clusters`, fields of the same names."""

    of_body: Ints
    count: int  # type: ignore[assignment]  # hides the method of tuples
    compliance: Floats
    carried: Floats
    force_map: Floats


@kernel
def _forces(slips: Slips, coordinates: int) -> Floats:
    """``w`` of each slip for a normal force of 1, (S, N)."""
    rows = np.zeros((slips.rest.size, coordinates))
    for s in range(slips.rest.size):
        if slips.right[s] >= 0:
            rows[s, slips.right[s]] += slips.drag[s]
        if slips.left[s] >= 0:
            rows[s, slips.left[s]] -= slips.drag[s]
    return rows


@kernel
def _of_clusters(rows: Floats, clusters: _Moved) -> Floats:
    """Sums of each row (S, N) over the coordinates of every cluster, (S, C)."""
    found = np.zeros((rows.shape[0], clusters.count))
    for b in range(rows.shape[1]):
        if clusters.of_body[b] >= 0:
            found[:, clusters.of_body[b]] += rows[:, b]
    return found


@kernel
def _pressing(slips: Slips, clusters: _Moved, mass: Floats) -> Floats:
    """``P`` of each slip, (S, N): its normal force for forces on coordinates, with a minus."""
    S, N = slips.rest.size, mass.size
    found = np.empty((S, N))
    for s in range(S):
        held = clusters.force_map[slips.rest[s]]
        weighted = np.zeros(clusters.count)
        for b in range(N):
            if clusters.of_body[b] >= 0:
                weighted[clusters.of_body[b]] += held[b] * mass[b]
        for b in range(N):
            found[s, b] = held[b]
            if clusters.of_body[b] >= 0:
                for c in range(clusters.count):
                    found[s, b] -= weighted[c] * clusters.compliance[c, clusters.of_body[b]]
    return found


@kernel
def _solved(rows: Floats, forces: Floats) -> Floats:
    """``(I + rows forcesᵀ)⁻¹ rows``, (S, N)."""
    S = rows.shape[0]
    matrix, inverse = np.eye(S), np.empty((S, S))
    for s in range(S):
        for t in range(S):
            for b in range(rows.shape[1]):
                matrix[s, t] += rows[s, b] * forces[t, b]
    found = np.full(rows.shape, np.nan)
    if invert(matrix, inverse, DEPENDENT):
        found[:] = 0.0
        for s in range(S):
            for t in range(S):
                found[s] += inverse[s, t] * rows[t]
    return found


@kernel
def _oblique(
    slips: Slips, contacts: int, clusters: _Moved, mass: Floats
) -> tuple[Floats, Floats, Floats, Floats]:
    """Compliance and force map with slip; ``w`` and H of F `contacts` with friction, (F, C)."""
    C, N = clusters.count, mass.size
    forces = _forces(slips, N)
    pressing = _solved(_pressing(slips, clusters, mass), forces)
    carried = _solved(clusters.force_map[slips.rest].copy(), forces)
    moved = _of_clusters(forces, clusters)
    # What acts on a cluster acts on its first coordinate: none that a link pulls at touches others.
    press, slide = np.zeros((contacts, C)), np.zeros((contacts, C))
    for b in range(N - 1, -1, -1):
        if clusters.of_body[b] >= 0:
            for s in range(slips.rest.size):
                press[slips.which[s], clusters.of_body[b]] = pressing[s, b]
    compliance, force_map = clusters.compliance.copy(), clusters.force_map.copy()
    for s in range(slips.rest.size):
        slide[slips.which[s]] = moved[s]
        for c in range(C):
            along = 0.0
            for d in range(C):
                along += clusters.compliance[c, d] * moved[s, d]
            compliance[c] -= along * press[slips.which[s]]
        for i in range(force_map.shape[0]):
            along = 0.0
            for b in range(N):
                along += clusters.force_map[i, b] * forces[s, b]
            force_map[i] -= along * carried[s]
    return compliance, force_map, slide, press


@kernel
def _with_standing(clusters: Clusters, mass: Floats) -> _Moved:
    """Clusters with one, which nothing moves, for each body that stands still.

    What pushes it presses contacts, and so has to do with what these slow down.
    """
    of_body, count, moving = clusters.of_body.copy(), clusters.count, clusters.count
    for b in range(mass.size):
        if of_body[b] < 0 and mass[b] > 0.0:
            of_body[b] = count
            count += 1
    compliance, carried = np.zeros((count, count)), np.zeros(count)
    compliance[:moving, :moving], carried[:moving] = clusters.compliance, clusters.carried
    return _Moved(of_body, count, compliance, carried, clusters.force_map)


@kernel
def _share_out(between: ContactEnds, clusters: Clusters) -> None:
    """Make contact forces of a mode that are not unique the least ones, in its force map.

    Least weighted by the compliance of each contact, as `eventpound.numerics.coulomb` has them when
    it decides who sticks: what it found within the cones of friction the mode has, too.
    """
    rests, force_map = clusters.resting, clusters.force_map
    rows = rows_of(between.left[rests], between.right[rests], between.mass.size, between.weights)
    R, bodies = rows.shape
    size, idle, count = np.zeros(R), np.zeros((R, R)), 0
    for i in range(R):
        for b in range(bodies):
            size[i] += rows[i, b] * rows[i, b] / between.mass[b]
        size[i] = np.sqrt(size[i])
    for i in range(R):
        if not clusters.redundant[i] or size[i] == 0.0:
            continue
        # Forces that do nothing together: that of a redundant contact, and what others take of it.
        z = idle[count]
        for a in range(R):
            z[a] = size[a] * ((a == i) - dot(force_map[a, :bodies], rows[i]))
        for b in range(count):
            z -= dot(idle[b], z) * idle[b]
        z /= np.sqrt(dot(z, z))
        count += 1
    for b in range(force_map.shape[1]):
        for c in range(count):
            along = 0.0
            for a in range(R):
                along += idle[c, a] * size[a] * force_map[a, b]
            for a in range(R):
                if size[a] > 0.0:
                    force_map[a, b] -= along * idle[c, a] / size[a]


@kernel
def with_slips(clusters: Clusters, slips: Slips, contacts: int, between: ContactEnds) -> Clusters:
    """Clusters of a mode of a scene in which so many `contacts` have friction, some of them slip.

    Parameters
    ----------
    clusters : Clusters
        As if nothing had friction; forces that are not unique become the least ones.
    slips : Slips
        Who slips.
    contacts : int
        F.
    between : ContactEnds
        All contacts.
    """
    return Clusters(*_slipping(clusters, slips, contacts, between))


@kernel
def _slipping(
    clusters: Clusters, slips: Slips, contacts: int, between: ContactEnds
) -> tuple[Any, ...]:
    """The fields of `with_slips`, a plain tuple for callers in Python."""
    if clusters.redundant.any():
        _share_out(between, clusters)
    of_body, count, carried = clusters.of_body, clusters.count, clusters.carried
    compliance, force_map = clusters.compliance, clusters.force_map
    slide = np.zeros((contacts, count))
    press = slide
    if slips.rest.size > 0:
        moved = _with_standing(clusters, between.mass)
        of_body, count, carried = moved.of_body, moved.count, moved.carried
        compliance, force_map, slide, press = _oblique(slips, contacts, moved, between.mass)
    return (
        *(of_body, clusters.offset, count, clusters.resting, clusters.locked, clusters.redundant),
        *(clusters.elimination, clusters.unique, force_map, compliance, carried, slide, press),
    )


@kernel
def are_tied(left: Ints, right: Ints, clusters: Clusters) -> Bools:
    """Pairs of coordinates (S,) whose distance no force changes in a mode."""
    tied = np.zeros(left.size, np.bool_)
    for s in range(left.size):
        ends = np.full(2, -1)
        for i, b in ((0, left[s]), (1, right[s])):
            ends[i] = clusters.of_body[b] if b >= 0 else -1
        apart, size = 0.0, 0.0
        for c in range(clusters.count):
            column = clusters.compliance[:, c]
            apart = max(apart, abs(difference(column, ends[0], ends[1])))
            for end in ends:
                size = max(size, abs(column[end]) if end >= 0 else 0.0)
        tied[s] = apart <= DEPENDENT * size
    return tied
