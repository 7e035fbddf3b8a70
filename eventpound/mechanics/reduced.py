"""The equations of motion of one contact mode: one coordinate a cluster.

With the contacts at rest in a mode fixed, the state is

    y = [q (clusters), v (clusters), z (links that move), ledger]

    q' = v,   m v' = -Σ_l B_l F_l - m a_g,   F = k x + f + c x' + Q z,
    z' by eq. 3 of the founding paper

and bodies at rest on each other share a row, so their gaps cannot drift. The
ledger, where asked for, adds the rates of input ``-Σ m v a_g``, viscous
``Σ c x'^2`` and hysteretic work ``Σ Q z x'``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from eventpound.mechanics.clusters import Clusters
from eventpound.mechanics.hysteresis import z_rate
from eventpound.mechanics.model import Model
from eventpound.motion.forcing import ground_acceleration
from eventpound.numerics.arrays import Floats, Ints

LEDGER_ENTRIES = 3


class Forcing(NamedTuple):
    """The ground motion on one smooth piece, time counted from `start` (s)."""

    family: int
    coefficients: Floats
    samples: Floats
    start: float


class Reduced(NamedTuple):
    """Arrays of the equations of motion of a mode, C clusters, A active links.

    `size` is the length of y; `iq`, `iv` (C,) and `iz` (A,) say where a
    coordinate stands in it (-1: no hysteresis); `ledger` is the place of the
    first ledger entry or -1. `z_of` (H,) is the place of each z of the model,
    -1 where it is frozen. `link` (A,) is the model's number of each link.
    """

    size: int
    mass: Floats
    ends: Ints
    stiffness: Floats
    preload: Floats
    damping: Floats
    strength: Floats
    yield_displacement: Floats
    exponent: Floats
    beta: Floats
    gamma: Floats
    iq: Ints
    iv: Ints
    iz: Ints
    ledger: int
    z_of: Ints
    link: Ints


def reduce(
    model: Model, clusters: Clusters, stiffness: Floats, preload: Floats, *, ledger: bool
) -> Reduced:
    """Equations of motion of a mode.

    Parameters
    ----------
    model : Model
        The scene.
    clusters : Clusters
        Who moves with whom.
    stiffness, preload : ndarray, shape (L,)
        k (N/m) and f (N) of each link on its present branch.
    ledger : bool
        Append the energy ledger.

    Returns
    -------
    Reduced
        Coordinates of neighbouring clusters stand next to each other, so the
        Jacobian of a row of bodies is banded.
    """
    of_body = np.append(clusters.of_body, -1)
    offset = np.append(clusters.offset, 0.0)
    ends = of_body[model.link_ends]
    active = np.flatnonzero(ends[:, 0] != ends[:, 1])
    shift = offset[model.link_ends[:, 1]] - offset[model.link_ends[:, 0]]
    moving = clusters.of_body >= 0
    mass = np.zeros(clusters.count)
    np.add.at(mass, clusters.of_body[moving], model.mass[moving])
    hysteretic = np.isin(active, model.hysteretic)
    iq, iv, iz, size = _layout(clusters.count, ends[active], hysteretic)
    z_of = np.full(model.hysteretic.size, -1, np.int64)
    for a in np.flatnonzero(hysteretic):
        z_of[np.searchsorted(model.hysteretic, active[a])] = iz[a]
    return Reduced(
        size=size + LEDGER_ENTRIES * ledger,
        mass=mass,
        ends=np.ascontiguousarray(ends[active]),
        stiffness=stiffness[active],
        preload=preload[active] + stiffness[active] * shift[active],
        damping=model.law.damping[active],
        strength=model.law.strength[active],
        yield_displacement=model.law.yield_displacement[active],
        exponent=model.law.exponent[active],
        beta=model.law.beta[active],
        gamma=model.law.gamma[active],
        iq=iq,
        iv=iv,
        iz=iz,
        ledger=size if ledger else -1,
        z_of=z_of,
        link=active,
    )


def _layout(clusters: int, ends: Ints, hysteretic: np.ndarray) -> tuple[Ints, Ints, Ints, int]:
    """Places of q, v and z: each z beside the later of the clusters it joins."""
    iq, iv = np.empty(clusters, np.int64), np.empty(clusters, np.int64)
    iz = np.full(len(ends), -1, np.int64)
    owner = ends.max(axis=1) if len(ends) else np.empty(0, np.int64)
    links_of: list[list[int]] = [[] for _ in range(clusters)]
    for a in np.flatnonzero(hysteretic):
        links_of[owner[a]].append(int(a))
    place = 0
    for c in range(clusters):
        iq[c], iv[c] = place, place + 1
        place += 2
        for link in links_of[c]:
            iz[link] = place
            place += 1
    return iq, iv, iz, place


def bandwidth(system: Reduced) -> int:
    """Half bandwidth of the Jacobian of y' (the ledger apart)."""
    reach = 1
    for a in range(len(system.ends)):
        places = [
            place
            for c in system.ends[a]
            if c >= 0
            for place in (int(system.iq[c]), int(system.iv[c]))
        ]
        if system.iz[a] >= 0:
            places.append(int(system.iz[a]))
        reach = max(reach, max(places) - min(places))
    return reach


@njit(cache=True)
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
    ground = ground_acceleration(
        forcing.family, forcing.coefficients, forcing.samples, forcing.start + tau
    )
    iq, iv = system.iq, system.iv
    for c in range(system.mass.size):
        rate[iq[c]] = y[iv[c]]
        rate[iv[c]] = 0.0
    viscous, hysteretic = 0.0, 0.0
    for a in range(system.stiffness.size):
        first, second = system.ends[a, 0], system.ends[a, 1]
        x, x_rate = 0.0, 0.0
        if second >= 0:
            x, x_rate = y[iq[second]], y[iv[second]]
        if first >= 0:
            x, x_rate = x - y[iq[first]], x_rate - y[iv[first]]
        force = system.stiffness[a] * x + system.preload[a] + system.damping[a] * x_rate
        if system.iz[a] >= 0:
            z = y[system.iz[a]]
            force += system.strength[a] * z
            hysteretic += system.strength[a] * z * x_rate
            rate[system.iz[a]] = z_rate(
                x_rate,
                z,
                system.yield_displacement[a],
                system.exponent[a],
                system.beta[a],
                system.gamma[a],
            )
        viscous += system.damping[a] * x_rate * x_rate
        if first >= 0:
            rate[iv[first]] += force
        if second >= 0:
            rate[iv[second]] -= force
    put_in = 0.0
    for c in range(system.mass.size):
        rate[iv[c]] = rate[iv[c]] / system.mass[c] - ground
        put_in -= system.mass[c] * y[iv[c]] * ground
    if system.ledger >= 0:
        rate[system.ledger] = put_in
        rate[system.ledger + 1] = viscous
        rate[system.ledger + 2] = hysteretic
