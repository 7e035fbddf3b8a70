"""The equations of motion of one contact mode: one coordinate a cluster.

With the contacts at rest in a mode fixed, the state is

    y = [q (clusters), v (clusters), z (links that move), ledger]

    q' = v,   m v' = -Σ_l B_l F_l - m a_g,   F and z' by `eventpound.mechanics.elements`

of a cluster with a support q, v and v' are what they are said to be (`placed`),
and bodies at rest on each other share a row, so their gaps cannot drift. Where clusters follow
others, ``v' = -A Σ_l B_l F_l - r a_g`` (`eventpound.mechanics.followers`). The
ledger, where asked for, adds the rates of input ``-Σ m v a_g``, viscous
``Σ c x'^2`` and hysteretic work ``Σ Q z x'``, and of the work of each support.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from eventpound.mechanics.clusters import Clusters
from eventpound.mechanics.contact_laws import element_pull
from eventpound.mechanics.elements import (
    contact_code,
    drag,
    link_force,
    number_beside,
    pull_per_z,
    z_rate,
)
from eventpound.mechanics.followers import acceleration_of, answers, force_or_given, own_mass
from eventpound.mechanics.link_law import LinkLaw
from eventpound.mechanics.model import WORK_OF_SUPPORTS
from eventpound.mechanics.reduced_loads import add_load_coefficients, placed, support_of, taken
from eventpound.motion.base import Piece
from eventpound.motion.forcing import ground_acceleration
from eventpound.motion.loads import LOADED
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.numerics.graph import grouped


class Forcing(NamedTuple):
    """The ground motion on one smooth piece, time counted from `start` (s)."""

    family: int
    coefficients: Floats
    samples: Floats
    start: float


def forcing_of(piece: Piece, start: float) -> Forcing:
    """A piece of a ground motion as compiled functions take it, time counted from `start` (s)."""
    return Forcing(int(piece.family), piece.coefficients, piece.samples, start)


class Reduced(NamedTuple):
    """Arrays of the equations of motion of a mode, C clusters, A active links.

    `size` is the length of y; `iq`, `iv` (C,) and `iz` (A,) say where a
    coordinate stands in it (-1: no hysteresis, below: the code of a closed contact element, see
    `eventpound.mechanics.contact_laws`); `beside` (A,) is the place of the variable that the rate
    of a z depends on, too, that of z itself where there is none; `ledger` is the place of the
    first ledger entry or -1. `direction` (A,) is the sign that z' takes x' to have, 0 for its
    own. `z_of` (H,) is the place of each z of the model, -1 where it is frozen. `link` (A,) is
    the model's number of each link. `plain`: the links before contact elements, the last.
    `mass` is inf of clusters with supports, `own_mass` that of their other bodies.
    `compliance` (C, C) and `carried` (C,): A and r of the `Clusters`, empty without points;
    `slide` and `press` (F, C) of them, empty without friction at contacts.
    """

    size: int
    mass: Floats
    own_mass: Floats
    ends: Ints
    stiffness: Floats
    preload: Floats
    damping: Floats
    memory: Floats
    direction: Floats
    iq: Ints
    iv: Ints
    iz: Ints
    beside: Ints
    ledger: int
    z_of: Ints
    link: Ints
    plain: int
    compliance: Floats
    carried: Floats
    slide: Floats
    press: Floats


class Branches(NamedTuple):
    """k (N/m) and f (N) of ``F = k x + f`` of each link on its present branch, (L,) each."""

    stiffness: Floats
    preload: Floats


@kernel
def reduce(
    link_ends: Ints,
    law: LinkLaw,
    mass: Floats,
    hysteretic: Ints,
    clusters: Clusters,
    branches: Branches,
    ledger: int,
) -> Reduced:
    """Equations of motion of a mode.

    Parameters
    ----------
    link_ends, law, mass, hysteretic
        Those of the `Model`.
    clusters : Clusters
        Who moves with whom.
    branches : Branches
        Of the links.
    ledger : int
        Entries of the energy ledger (`Model.ledger_entries`), 0 where it is not kept.

    Returns
    -------
    Reduced
        Coordinates of neighbouring clusters stand next to each other, so the
        Jacobian of a row of bodies is banded.
    """
    return Reduced(*_fields(link_ends, law, mass, hysteretic, clusters, branches, ledger))


@kernel
def _fields(
    link_ends: Ints,
    law: LinkLaw,
    mass: Floats,
    hysteretic: Ints,
    clusters: Clusters,
    branches: Branches,
    ledger: int,
) -> tuple[Any, ...]:
    """The fields of a `Reduced`, a plain tuple for callers in Python."""
    stiffness, preload = branches
    cluster_mass, own = np.zeros(clusters.count), np.zeros(clusters.count)
    for b in range(mass.size):
        if clusters.of_body[b] >= 0:
            cluster_mass[clusters.of_body[b]] += mass[b]
            own[clusters.of_body[b]] += own_mass(b, mass)
    z_of_link = np.full(stiffness.size, -1, np.int64)
    for h in range(hysteretic.size):
        z_of_link[hysteretic[h]] = h
    link_clusters, shift = _ends_in_clusters(link_ends, clusters)
    # Within a cluster, or at a barrier, a link keeps its elongation, and so its z.
    active = np.flatnonzero(link_clusters[:, 0] != link_clusters[:, 1])
    ends, z_of_active, damping = link_clusters[active], z_of_link[active], law.damping[active]
    shifted, plain = np.empty(active.size), 0
    for a in range(active.size):
        i = active[a]
        # x of the bodies is x of their clusters and a constant, whose force belongs to f.
        shifted[a] = preload[i] + stiffness[i] * shift[i]
        code = contact_code(i, law.memory)
        if code >= 0:
            plain += 1
        elif stiffness[i] != 0.0:
            # A contact element: its law acts where it is closed.
            z_of_active[a] = code
        else:
            damping[a] = 0.0
    iq, iv, iz, z_of, size = _layout(clusters.count, ends, z_of_active, hysteretic.size)
    beside = iz.copy()
    for a in range(active.size):
        if iz[a] >= 0:
            # Both have the same ends, so both are active.
            beside[a] = z_of[z_of_link[number_beside(active[a], law.memory)]]
    first_entry = size if ledger > 0 else -1
    return (
        *(size + ledger, cluster_mass, own, ends, stiffness[active], shifted, damping),
        *(law.memory[active], np.zeros(active.size), iq, iv, iz, beside, first_entry, z_of),
        *(active, plain, clusters.compliance, clusters.carried, clusters.slide, clusters.press),
    )


@kernel
def _ends_in_clusters(link_ends: Ints, clusters: Clusters) -> tuple[Ints, Floats]:
    """Clusters at the ends of links (L, 2), and what their elongations are more by offsets (m)."""
    ends, shift = np.full(link_ends.shape, -1, np.int64), np.zeros(link_ends.shape[0])
    for i in range(shift.size):
        for end, sign in ((0, -1.0), (1, 1.0)):
            b = link_ends[i, end]
            if b >= 0:
                ends[i, end] = clusters.of_body[b]
                shift[i] += sign * clusters.offset[b]
    return ends, shift


@kernel
def _layout(
    clusters: int, ends: Ints, z_of_active: Ints, hysteretic: int
) -> tuple[Ints, Ints, Ints, Ints, int]:
    """Places of q, v and z: each z beside the later of the clusters it joins."""
    iq, iv = np.empty(clusters, np.int64), np.empty(clusters, np.int64)
    iz, z_of = np.full(ends.shape[0], -1, np.int64), np.full(hysteretic, -1, np.int64)
    owner = np.empty(ends.shape[0], np.int64)
    for a in range(owner.size):
        # The ground is -1, so an active link always has an owner.
        owner[a] = max(ends[a, 0], ends[a, 1])
    first, links = grouped(owner, clusters)
    place = 0
    for c in range(clusters):
        iq[c], iv[c] = place, place + 1
        place += 2
        for a in links[first[c] : first[c + 1]]:
            if z_of_active[a] >= 0:
                iz[a] = z_of[z_of_active[a]] = place
                place += 1
            else:
                iz[a] = z_of_active[a]
    return iq, iv, iz, z_of, place


@kernel
def state_vector(
    clusters: Any, system: Reduced, mass: Floats, u: Floats, v: Floats, z: Floats, ledger: Floats
) -> Floats:
    """State vector of a mode: clusters move with the momentum of their bodies, or with a support.

    Parameters
    ----------
    clusters : Clusters or Bodies
        Who moves with whom.
    system : Reduced
        The mode.
    mass, u, v : ndarray, shape (N,)
        Masses (kg), displacements (m) and velocities (m/s) of the bodies.
    z : ndarray, shape (H,)
        Hysteretic variables.
    ledger : ndarray, shape (E,)
        Works so far (J); used where the mode keeps them.

    Returns
    -------
    ndarray, shape (size,)
        y.
    """
    y = np.zeros(system.size)
    put_clusters(u, v, 1.0, clusters, mass, system, y)
    for h in range(z.size):
        if system.z_of[h] >= 0:
            y[system.z_of[h]] = z[h]
    if system.ledger >= 0:
        for i in range(ledger.size):
            y[system.ledger + i] = ledger[i]
    return y


@scalar_kernel
def put_clusters(
    u: Floats, v: Floats, share: float, clusters: Any, mass: Floats, system: Reduced, y: Floats
) -> None:
    """Put displacements and velocities of clusters into a state of zeros.

    `share` of the offsets in clusters is in those of the coordinates, u and v (N,): all, or none of
    derivatives.
    """
    # The mean weighted by mass keeps the momentum, and the place of the centre of mass.
    for b in range(mass.size):
        c = clusters.of_body[b]
        if c >= 0 and own_mass(b, mass) > 0.0:
            part = mass[b] / system.mass[c]
            y[system.iq[c]] += part * (u[b] - share * clusters.offset[b])
            y[system.iv[c]] += part * v[b]
    # Who has all the mass tells it alone: a support, and a point among points, which have none. Of
    # several the first does.
    for b in range(mass.size - 1, -1, -1):
        c = clusters.of_body[b]
        if c >= 0 and mass[b] == system.mass[c]:
            y[system.iq[c]], y[system.iv[c]] = u[b] - share * clusters.offset[b], v[b]


def bandwidth(system: Reduced) -> int:
    """Half bandwidth of the Jacobian of y' (the ledger apart)."""
    if system.compliance.size > 0:
        return system.size
    reach = 1
    for a in range(len(system.ends)):
        places = [
            place
            for c in system.ends[a]
            if c >= 0
            for place in (int(system.iq[c]), int(system.iv[c]))
        ]
        if system.iz[a] >= 0:
            places += [int(system.iz[a]), int(system.beside[a])]
        reach = max(reach, max(places) - min(places))
    return reach


@scalar_kernel
def link_motion(a: int, y: Floats, system: Reduced) -> tuple[float, float]:
    """Elongation of an active link (m) but for what its preload holds, and its rate (m/s)."""
    first, second = system.ends[a, 0], system.ends[a, 1]
    x, x_rate = 0.0, 0.0
    if second >= 0:
        x, x_rate = y[system.iq[second]], y[system.iv[second]]
    if first >= 0:
        x, x_rate = x - y[system.iq[first]], x_rate - y[system.iv[first]]
    return x, x_rate


@kernel
def motion_rate(tau: float, y: Floats, rate: Floats, system: Reduced, forcing: Forcing) -> None:
    """Fill `rate` with y' at the time ``forcing.start + tau``.

    Parameters
    ----------
    tau : float
        Time since the start of the segment (s).
    y, rate : ndarray, shape (size,)
        State and its rate.
    system : Reduced
        The mode.
    forcing : Forcing
        The piece of the ground motion.
    """
    ground = ground_acceleration(forcing, forcing.start + tau)
    y = placed(forcing.start + tau, y, system, forcing)
    rate_on_ground(ground, tau, y, rate, system, forcing)


@kernel
def rate_on_ground(
    ground: float, tau: float, y: Floats, rate: Floats, system: Reduced, forcing: Forcing
) -> None:
    """`motion_rate` where the acceleration of the ground is known (m/s²), and y is `placed`."""
    iq, iv = system.iq, system.iv
    for c in range(system.mass.size):
        rate[iq[c]] = y[iv[c]]
        rate[iv[c]] = 0.0
    viscous, hysteretic = 0.0, 0.0
    for a in range(system.stiffness.size):
        first, second = system.ends[a, 0], system.ends[a, 1]
        x, x_rate = link_motion(a, y, system)
        place, direction = system.iz[a], system.direction[a]
        if a < system.plain:
            z = y[place] if place >= 0 else 0.0
            force = link_force(a, system, x, x_rate, z)
            viscous += drag(a, system, x_rate) * x_rate
        elif place < -1:
            k, preload, c = system.stiffness[a], system.preload[a], system.damping[a]
            # What a closed contact element loses is counted with its contact.
            force = element_pull(place, k, preload, c, x, x_rate, direction)[0]
        else:
            continue
        if place >= 0:
            hysteretic += pull_per_z(a, system.memory) * z * x_rate
            # Held over a step, the direction keeps the kink of a reversal out of it.
            way = direction if direction != 0.0 else x_rate
            rate[place] = z_rate(a, system.memory, x_rate, way, z, y[system.beside[a]])
        if first >= 0:
            rate[iv[first]] += force
        if second >= 0:
            rate[iv[second]] -= force
    put_in = 0.0
    if forcing.family == LOADED:
        put_in = _add_loads(forcing.start + tau, ground, y, rate, system, forcing)
    for c in range(system.mass.size):
        # A support is left out, whose mass is infinite: its work is an entry of its own.
        put_in -= system.own_mass[c] * y[iv[c]] * ground
    if system.ledger >= 0 and system.slide.shape[0] > 0:
        # Also where nothing moves, or what stands there before would be its rate.
        _add_friction(y, rate, system)
    if system.compliance.size > 0:
        _answer_coupled(ground, system, rate)
    else:
        for c in range(system.mass.size):
            rate[iv[c]] = acceleration_of(c, rate[iv[c]], system.mass) - ground
    if system.ledger >= 0:
        rate[system.ledger] = put_in
        rate[system.ledger + 1] = viscous
        rate[system.ledger + 2] = hysteretic


@kernel
def _add_friction(y: Floats, rate: Floats, system: Reduced) -> None:
    """Power of friction at each contact (W), the last of the ledger, from the forces in `rate`."""
    first = system.size - system.slide.shape[0]
    for i in range(system.slide.shape[0]):
        way, pressed = 0.0, 0.0
        for c in range(system.mass.size):
            way += system.slide[i, c] * y[system.iv[c]]
            pressed += system.press[i, c] * rate[system.iv[c]]
        rate[first + i] = way * pressed


@kernel
def _answer_coupled(ground: float, system: Reduced, rate: Floats) -> None:
    """Accelerations where clusters follow others, in the place of the forces in `rate`."""
    force, found = np.empty(system.mass.size), np.empty(system.mass.size)
    for c in range(force.size):
        force[c] = rate[system.iv[c]]
    answers(system.compliance, force, found)
    for c in range(force.size):
        rate[system.iv[c]] = found[c] - system.carried[c] * ground


@kernel
def _add_loads(
    t: float, ground: float, y: Floats, rate: Floats, system: Reduced, forcing: Forcing
) -> float:
    """Add the loads at t (s) to the forces that stand in place of v'; returns their power (W)."""
    loads, power = np.zeros((2, 1, system.mass.size)), 0.0
    pushed, driven = loads[0, 0], loads[1, 0]
    add_load_coefficients(t, system, forcing, 1, loads[0], loads[1])
    if system.ledger >= 0:
        # First, as `rate` still holds what the links alone do to a cluster.
        given = taken(ground, rate[system.iv], pushed, driven, system)
        for a in range(system.link.size):
            k, c = support_of(system.link[a], forcing.coefficients), system.ends[a, 0]
            if k >= 0:
                rate[system.ledger + WORK_OF_SUPPORTS + k] = given[c] * y[system.iv[c]]
    for c in range(system.mass.size):
        power += y[system.iv[c]] * pushed[c]
        force = rate[system.iv[c]] + pushed[c]
        rate[system.iv[c]] = force_or_given(c, force, driven[c], system.mass)
    return power
