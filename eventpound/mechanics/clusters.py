"""Which bodies move as one: clusters of bodies joined by resting contacts.

Resting contacts make their bodies one rigid mass; a cluster that touches a
barrier stands still. The contact forces inside follow from the motion of the
cluster, body by body from its leaves, where the contacts form a tree. Where
there are more contacts than that takes, their forces are not unique: those
that a solution found pressed carry them. On a directed cycle (a row squeezed
between two barriers) no contact can open: it is locked, and its forces here may
have any sign (`eventpound.mechanics.pressures` has those that are told).

Where a scene has points, clusters may follow others (`eventpound.mechanics.followers`).

All barriers are one node of the graph of contacts, number N. So are supports where it is asked
what joins what: contacts may join two of them only while they move alike, and their forces are then
not unique. A cluster never holds more than one.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from eventpound.mechanics.followers import Grouped, Rests, examine_rests, follow, is_unmoved
from eventpound.mechanics.model import Model
from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import in_python, kernel
from eventpound.numerics.graph import grouped, on_directed_cycles, root


class ContactEnds(NamedTuple):
    """What K contacts are between.

    Parameters
    ----------
    left, right : ndarray of int, shape (K,)
        Coordinates of the contacts, -1 for a barrier.
    gap : ndarray, shape (K,)
        Openings at zero displacement (m).
    mass : ndarray, shape (N,)
        Of the coordinates, inf of supports, none of points.
    weights : ndarray, shape (D, N)
        Of the points (`Model.weights`).
    own : int
        How many of them, the first ones, are contacts. Behind them stand those of sliders, which
        give way either way: they lock nothing.
    """

    left: Ints
    right: Ints
    gap: Floats
    mass: Floats
    weights: Floats
    own: int


def between_of(model: Model) -> ContactEnds:
    """What the contacts of a model are between."""
    ends = model.left, model.right, model.gap
    return ContactEnds(*ends, model.mass, model.weights, model.own_contacts)


class Clusters(NamedTuple):
    """Coordinates of bodies and points grouped by resting contacts.

    Parameters
    ----------
    of_body : ndarray of int, shape (N,)
        Cluster of each body, numbered from the left; -1 for bodies that stand
        still.
    offset : ndarray, shape (N,)
        ``u_body = q_cluster + offset`` (m), with q = 0 for cluster -1.
    count : int
        Number of moving clusters, C.
    resting : ndarray of int, shape (R,)
        The resting contacts.
    locked : ndarray of bool, shape (R,)
        Those that cannot open.
    redundant : ndarray of bool, shape (R,)
        Those that the others keep closed; they are given no force of their own.
    elimination : ndarray of int, shape (E, 4)
        Rows (body, contact, parent, sign) in the order in which forces follow:
        ``λ = sign r_body``, then ``r_parent += r_body``.
    unique : ndarray of bool, shape (R,)
        Those whose force is.
    force_map : ndarray, shape (R, N)
        Maps residual forces to contact forces in a scene with points; else empty: the
        elimination gives them all.
    compliance : ndarray, shape (C, C)
        A of `eventpound.mechanics.followers` in such a scene (1/kg), else empty: 1/m of each.
    carried : ndarray, shape (C,)
        r there, else empty: 1.
    slide, press : ndarray, shape (F, C)
        Of F contacts with friction, while they slip, as `eventpound.mechanics.oblique` has them,
        else zero; empty in other scenes.
    """

    of_body: Ints
    offset: Floats
    count: int  # type: ignore[assignment]  # hides the method of tuples
    resting: Ints
    locked: Bools
    redundant: Bools
    elimination: Ints
    unique: Bools
    force_map: Floats
    compliance: Floats
    carried: Floats
    slide: Floats
    press: Floats

    @property
    def tree(self) -> bool:
        """Whether all contact forces are unique."""
        return not self.redundant.any()


@kernel
def form_clusters(between: ContactEnds, resting: Bools, pressed: Bools) -> Clusters:
    """Group coordinates by resting contacts.

    Parameters
    ----------
    between : ContactEnds
        The contacts.
    resting : ndarray of bool, shape (K,)
        Contacts at rest.
    pressed : ndarray of bool, shape (K,)
        Contacts that a solution of the acceleration problem found pressed:
        where contacts are redundant, these carry the forces.
    """
    return Clusters(*_joined(between, resting, pressed))


def form_clusters_of_few(between: ContactEnds, resting: Bools, pressed: Bools) -> Clusters:
    """`form_clusters` for callers in Python: what resting contacts need is compiled when one is."""
    if not resting.any() and between.weights.size == 0:
        return _bodies_alone(between.mass.size)
    return in_python(form_clusters)(between, resting, pressed)


def _bodies_alone(bodies: int) -> Clusters:
    """Clusters without a resting contact."""
    none, nobody = np.zeros(0, np.int64), np.zeros(0, np.bool_)
    no_rows, no_map = np.zeros((0, 4), np.int64), np.zeros((0, 0))
    return Clusters(
        *(np.arange(bodies), np.zeros(bodies), bodies, none, nobody, nobody, no_rows),
        *(nobody, no_map, no_map, np.zeros(0), no_map, no_map),
    )


@kernel
def _joined(between: ContactEnds, resting: Bools, pressed: Bools) -> tuple[Any, ...]:
    """The fields of `form_clusters`, a plain tuple for callers in Python."""
    mass, weights, members = between.mass, between.weights, np.flatnonzero(resting)
    bodies, own = mass.size, int((members < between.own).sum())
    first_node, second_node = between.left[members], between.right[members]
    first_node[first_node < 0] = bodies
    second_node[second_node < 0] = bodies
    # Supports count as the barrier only here: where bodies are placed, these go with theirs.
    tail, head = _anchored(between.left[members], mass), _anchored(between.right[members], mass)
    points, rests = weights.shape[0], members.size
    carrying, locked = np.zeros(rests, np.bool_), np.zeros(rests, np.bool_)
    unique = np.zeros(rests, np.bool_)
    force_map = np.zeros((rests if points > 0 else 0, bodies))
    if points == 0:
        carrying = _forest(tail, head, pressed[members], bodies + 1)
    elif rests > 0:
        ends, carry = (between.left[members], between.right[members]), pressed[members]
        examine_rests(Rests(*ends, carry, carrying, locked, unique, force_map), own, mass, weights)
    of_body, offset, count, elimination = _spread(
        members[carrying], first_node[carrying], second_node[carrying], between.gap, bodies
    )
    compliance, carried, no_slips = np.zeros((0, 0)), np.zeros(0), np.zeros((0, 0))
    if points > 0:
        grouped_at = Grouped(of_body, offset, np.zeros((bodies, bodies)), np.zeros(bodies))
        count = follow(count, mass, weights, grouped_at)
        compliance = grouped_at.compliance[:count, :count].copy()
        carried = grouped_at.carried[:count].copy()
    else:
        # Only a redundant contact closes a cycle.
        if not carrying.all():
            locked[:own] = on_directed_cycles(tail[:own], head[:own], bodies + 1)
        unique = _unique(carrying, first_node, second_node, of_body, count)
    return (
        *(of_body, offset, count, members, locked, ~carrying, elimination, unique),
        *(force_map, compliance, carried, no_slips, no_slips),
    )


@kernel
def _unique(
    carrying: Bools, first_node: Ints, second_node: Ints, of_body: Ints, count: int
) -> Bools:
    """Resting contacts whose force is unique, shape (R,): no other in their cluster is redundant.

    `first_node`, `second_node` (R,): their ends, N for ground and barriers.
    """
    cluster = np.empty(carrying.size, np.int64)
    several = np.zeros(count + 1, np.bool_)
    for i in range(carrying.size):
        for end in (first_node[i], second_node[i]):
            # The bodies that stand still count as one cluster, the last.
            cluster[i] = of_body[end] if end < of_body.size else -1
            several[cluster[i]] |= not carrying[i]
    return ~several[cluster]


@kernel
def have_ends(clusters: Clusters, first_holding: int) -> Bools:
    """Resting contacts (R,) whose forces tell when their rest ends.

    Not those that are locked, nor redundant ones, which are given none. But of those from
    `first_holding` on, which hold what friction does, each takes part of it, and has a bound.
    """
    found = np.empty(clusters.resting.size, np.bool_)
    for i in range(found.size):
        idle = clusters.redundant[i] and clusters.resting[i] < first_holding
        found[i] = not (clusters.locked[i] or idle)
    return found


def close_one(left: int, right: int, gap: float, mass: Floats, u: Floats) -> None:
    """Put two bodies, or one at a barrier, in touch, their centre of mass kept.

    With velocities and no gap it gives them one velocity, their momentum kept.
    """
    if right < 0:
        u[left] = gap
    elif left < 0:
        u[right] = -gap
    else:
        opening = gap + u[right] - u[left]
        share = mass[right] / (mass[left] + mass[right]) if mass[right] < np.inf else 1.0
        if share == 1.0:
            # What is so much heavier, or a support, stays where it is, whichever side it is on.
            u[left] = u[right] + gap
            return
        # Beside a body so light that its share is rounding the other one stays where it is.
        if 1.0 - share < 1.0:
            u[left] += share * opening
        u[right] = u[left] - gap


@kernel
def _anchored(ends: Ints, mass: Floats) -> Ints:
    """Nodes of the graph at ends of contacts, N of barriers and supports."""
    result = ends.copy()
    for i in range(ends.size):
        if is_unmoved(ends[i], mass):
            result[i] = mass.size
    return result


@kernel
def _forest(first_node: Ints, second_node: Ints, pressed: Bools, nodes: int) -> Bools:
    """Contacts that join what was not joined before, the pressed ones taken first."""
    parent = np.arange(nodes)
    carrying = np.zeros(pressed.size, np.bool_)
    for turn in (True, False):
        for i in range(pressed.size):
            if pressed[i] == turn:
                a, b = root(parent, first_node[i]), root(parent, second_node[i])
                # Where both are in one set already this changes nothing.
                parent[a] = b
                carrying[i] = a != b
    return carrying


@kernel
def _spread(
    contacts: Ints, first_node: Ints, second_node: Ints, gap: Floats, bodies: int
) -> tuple[Ints, Floats, int, Ints]:
    """Clusters, offsets, number of clusters and elimination of a forest of contacts.

    The bodies that contacts join to the barriers are visited first, then those
    of each cluster from its first body on, breadth first.
    """
    ends = np.empty(2 * contacts.size, np.int64)
    for i in range(contacts.size):
        ends[2 * i], ends[2 * i + 1] = first_node[i], second_node[i]
    start, place = grouped(ends, bodies + 1)
    of_body = np.full(bodies + 1, -2, np.int64)
    offset = np.zeros(bodies + 1)
    elimination = np.empty((contacts.size, 4), np.int64)
    rows = contacts.size
    queue = np.empty(bodies + 1, np.int64)
    count = -1  # the number of the cluster of the barriers, which comes first
    for source in range(-1, bodies):
        if of_body[source] != -2:
            continue
        # For the source -1 this is the last place, that of the barriers.
        of_body[source] = count
        queue[0] = source % (bodies + 1)
        length, k = 1, 0
        while k < length:
            node = queue[k]
            k += 1
            for i in place[start[node] : start[node + 1]]:
                # Both ends of a contact stand side by side: the other differs in the last bit.
                other, j = ends[i ^ 1], contacts[i // 2]
                if of_body[other] != -2:
                    continue
                # g = δ + u_right - u_left = 0; even places are left ends.
                sign = 1 if i % 2 == 0 else -1
                offset[other] = offset[node] - sign * gap[j]
                of_body[other] = count
                # From the end on, so that a body stands before the one from which it was reached.
                rows -= 1
                elimination[rows, 0], elimination[rows, 1] = other, j
                elimination[rows, 2], elimination[rows, 3] = (-1 if node == bodies else node), sign
                queue[length] = other
                length += 1
        count += 1
    return of_body[:bodies].copy(), offset[:bodies].copy(), count, elimination
