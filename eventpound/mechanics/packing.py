"""The arrays of a mode in two flat ones, for the calls that are made at every step.

Handing a compiled function some seventy small arrays costs several times what
it then does with them; two flat arrays cost next to nothing, and the views
are taken inside.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.observables import Bodies, Observed, observe
from eventpound.mechanics.reduced import Forcing, Reduced, motion_rate
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.borrowing import borrow, part_in
from eventpound.numerics.compiled import kernel
from eventpound.numerics.lending import lend

HEADER = 14
"""Integers that lead: C, A, N, L, K, H, R, E, size, ledger, P, the active links before elements,
the rows of the projection, D, and whether forces are unique."""


def pack_mode(system: Reduced, bodies: Bodies) -> tuple[Ints, Floats]:
    """Flat arrays of a mode; `unpack_system` and `unpack_bodies` take them apart.

    Parameters
    ----------
    system : Reduced
        The equations of motion.
    bodies : Bodies
        The bodies.

    Returns
    -------
    ints, floats : ndarray, one-dimensional
        Everything, in the order of the two classes.
    """
    counts = [
        system.mass.size,
        system.link.size,
        bodies.mass.size,
        bodies.stiffness.size,
        bodies.gap.size,
        bodies.z_of.size,
        bodies.resting.size,
        bodies.elimination.shape[0],
        system.size,
        system.ledger,
        bodies.laws.size,
        system.plain,
        system.projection.shape[0],
        bodies.points.size,
        bodies.least_norm.shape[0],
    ]
    ints = [np.array(counts, np.int64)]
    floats: list[Floats] = []
    shared = {"cluster_mass", "iq", "iv", "z_of", "projection"}
    for source, skip in ((system, {"size", "ledger", "plain"}), (bodies, shared)):
        for name, value in source._asdict().items():
            if name not in skip:
                (floats if value.dtype == np.float64 else ints).append(value.ravel())
    return np.concatenate(ints), np.concatenate(floats)


@kernel
def unpack_system(ints: Ints, floats: Floats) -> Reduced:
    """The equations of motion as views of the flat arrays of `pack_mode`."""
    clusters, active, hysteretic = ints[0], ints[1], ints[5]
    i = HEADER + 1
    ends = part_in(ints, i, (active, 2))
    i += 2 * active
    iq, iv = part_in(ints, i, clusters), part_in(ints, i + clusters, clusters)
    i += 2 * clusters
    iz = part_in(ints, i, active)
    z_of = part_in(ints, i + active, hysteretic)
    link = part_in(ints, i + active + hysteretic, active)
    law = part_in(floats, clusters, (9, active))
    return Reduced(
        ints[8],
        part_in(floats, 0, clusters),
        ends,
        law[0],
        law[1],
        law[2],
        law[3],
        law[4],
        law[5],
        law[6],
        law[7],
        law[8],
        iq,
        iv,
        iz,
        ints[9],
        z_of,
        link,
        ints[11],
        part_in(floats, clusters + 9 * active, (ints[12], ints[12])),
    )


@kernel
def unpack_bodies(ints: Ints, floats: Floats, system: Reduced) -> Bodies:
    """The bodies as views of the flat arrays of `pack_mode`."""
    clusters, active = ints[0], ints[1]
    bodies, links, contacts, hysteretic = ints[2], ints[3], ints[4], ints[5]
    rests, tree = ints[6], ints[7]
    i = HEADER + 1 + 4 * active + 2 * clusters + hysteretic
    link_ends = part_in(ints, i, (links, 2))
    i += 2 * links
    z_of_link = part_in(ints, i, links)
    i += links
    of_body = part_in(ints, i, bodies)
    i += bodies
    elimination = part_in(ints, i, (tree, 4))
    i += 4 * tree
    resting = part_in(ints, i, rests)
    i += rests
    left, right = part_in(ints, i, contacts), part_in(ints, i + contacts, contacts)
    laws = part_in(ints, i + 2 * contacts, ints[10])
    points = part_in(ints, i + 2 * contacts + ints[10], ints[13])
    f = clusters + 9 * active + ints[12] * ints[12]
    mass = part_in(floats, f, bodies)
    f += bodies
    law = part_in(floats, f, (4, links))
    f += 4 * links
    offset = part_in(floats, f, bodies)
    f += bodies
    frozen_z = part_in(floats, f, hysteretic)
    f += hysteretic
    rows = ints[HEADER]
    least_norm = part_in(floats, f, (rows, bodies))
    f += rows * bodies
    gap = part_in(floats, f, contacts)
    spread = part_in(floats, f + contacts, (ints[13], bodies))
    return Bodies(
        mass,
        link_ends,
        law[0],
        law[1],
        law[2],
        law[3],
        z_of_link,
        of_body,
        offset,
        system.mass,
        system.iq,
        system.iv,
        system.z_of,
        frozen_z,
        elimination,
        resting,
        least_norm,
        left,
        right,
        gap,
        laws,
        points,
        spread,
        system.projection,
    )


def observed_size(bodies: int, links: int, contacts: int, hysteretic: int) -> int:
    """Length of the flat array of an `Observed`."""
    return 5 * bodies + 2 * hysteretic + 5 * links + 5 * contacts + 4


@kernel
def unpack_observed(
    flat: Floats, bodies: int, links: int, contacts: int, hysteretic: int
) -> Observed:
    """An `Observed` as views of a flat array of `observed_size`."""
    N, L, K, H = bodies, links, contacts, hysteretic
    i = 3 * N
    z = part_in(flat, i, (2, H))
    i += 2 * H
    force = part_in(flat, i, (2, L))
    i += 2 * L
    acceleration = part_in(flat, i, (2, N))
    i += 2 * N
    contact_force = part_in(flat, i, (2, K))
    i += 2 * K
    gap = part_in(flat, i + 2, (3, K))
    elongation = part_in(flat, i + 2 + 3 * K, (3, L))
    return Observed(
        part_in(flat, 0, N),
        part_in(flat, N, N),
        part_in(flat, 2 * N, N),
        z,
        force,
        acceleration,
        contact_force,
        part_in(flat, i, 2),
        gap,
        elongation,
        part_in(flat, i + 2 + 3 * K + 3 * L, 2),
    )


@kernel
def observe_state(
    tau: float, y: Floats, ints: Ints, floats: Floats, forcing: Forcing, out: Observed
) -> None:
    """Fill `out` with everything known of a state, its rate from the equations of motion.

    `ints`, `floats`: as of `pack_mode`.
    """
    ints, floats, rate = borrow(ints), borrow(floats), np.empty(y.size)
    system = lend(unpack_system(ints, floats))
    motion_rate(tau, y, rate, system, forcing)
    observe(tau, y, rate, lend(unpack_bodies(ints, floats, system)), forcing, lend(out))
