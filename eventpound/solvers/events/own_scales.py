"""How far and how fast each body moves by itself: what its absolute tolerances follow.

A stiff body beside a soft one moves by a small part of the scene's length L, and an error
of a part of L would be all of its motion, and a multiple of its forces. So a body has a
length and a speed of its own, never larger than the scene's, from what its springs make of
`SPARE` times the load m a of its own mass, a = L/T²: the displacement x_s at which they
carry it, yielded where it yields them, and the speed sqrt(SPARE a x_s) of a vibration of
that size, or that at which its dashpots carry it. Where the ground stands still the energy
E at the start limits both: ``x² <= 2 E / k``, ``v² <= 2 E / m``.

All follow from L, T and ratios of the scene's own numbers, so that a scaled scene has
scaled ones. Arrays may have leading axes, of many variants of a scene; each variant has to
the last bit what it has alone, so nothing is summed but link by link.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from eventpound.mechanics.model import LinkLaw, Model
from eventpound.numerics.arrays import Floats, Ints

SPARE = 3.0
"""Multiple of a body's static response to which it is taken to move: about the largest
amplification of an undamped body by a pulse of one period."""


class Attached(NamedTuple):
    """Links of a scene: ends (L, 2), and laws, stiffnesses and offsets (..., L) in SI."""

    ends: Ints
    law: LinkLaw
    compression: Floats
    extension: Floats
    offset: Floats


class Start(NamedTuple):
    """Displacement and velocity (..., N) and z (..., H) of the links `hysteretic` at the start."""

    u: Floats
    v: Floats
    z: Floats
    hysteretic: Ints


class _Held(NamedTuple):
    """What the links of each body add up to, shape (..., N).

    Stiffness before and after yielding (N/m), strength (N), dashpots (N s/m), and the energy
    at which its springs yield (J).
    """

    stiffness: Floats
    yielded: Floats
    strength: Floats
    damping: Floats
    yield_energy: Floats


def attached(model: Model) -> Attached:
    """Links of an assembled scene, without contact elements: they hold bodies in passing."""
    laws, law = model.elastic[: model.plain], model.law
    if model.plain < model.links:
        law = LinkLaw(*(column[: model.plain] for column in law))
    return Attached(
        model.link_ends[: model.plain],
        law,
        np.array([law.compression for law in laws], float),
        np.array([law.extension for law in laws], float),
        np.array([law.offset for law in laws], float),
    )


def own_scales(
    links: Attached,
    mass: Floats,
    start: Start,
    length: Any,
    time: Any,
    acceleration: Any,
    shaken: Any,
) -> tuple[Floats, Floats]:
    """Length (m) and speed (m/s) of each body, shape (..., N) each.

    Parameters
    ----------
    links : Attached
        What holds the bodies.
    mass : ndarray, shape (..., N)
        Masses (kg).
    start : Start
        The state at the start.
    length, time, acceleration : float or ndarray, shape (...)
        L, T and L/T² of the scene (SI).
    shaken : bool or ndarray, shape (...)
        Whether the scene has the scales of a ground motion.
    """
    held = _held(links, mass)
    length, time, acceleration, shaken = (
        np.asarray(x)[..., None] for x in (length, time, acceleration, shaken)
    )
    speed = length / time
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        load = SPARE * mass * acceleration
        reach = _reach(load, held)
        swift = np.minimum(
            np.sqrt(SPARE * acceleration * reach),
            np.where(held.damping > 0.0, load / held.damping, np.inf),
        )
        if not shaken.all():
            energy = _energy(links, mass, start)[..., None]
            moving = energy > 0.0
            free_reach = np.where(moving, _swing(energy, held), np.inf)
            free_swift = np.where(moving, np.sqrt(2.0 * energy / mass), np.inf)
            reach, swift = np.where(shaken, reach, free_reach), np.where(shaken, swift, free_swift)
    return np.minimum(length, reach), np.minimum(speed, swift)


def _held(links: Attached, mass: Floats) -> _Held:
    """What holds each body, were its neighbours held."""
    law = links.law
    # As stiff as the link gets: a stop or a cable holds on one side alone.
    after = np.maximum(links.compression, links.extension)
    strength, yielding = law.strength, law.yield_displacement
    of_link = (after + strength / yielding, after, strength, law.damping, 0.5 * strength * yielding)
    held = np.zeros((len(of_link), *mass.shape))
    each = np.empty((len(of_link), *of_link[0].shape))
    each[:] = of_link
    for i, ends in enumerate(links.ends.tolist()):
        for b in ends:
            if b >= 0:
                held[..., b] += each[..., i]
    return _Held(*held)


def _reach(load: Floats, held: _Held) -> Floats:
    """Displacement at which the springs carry a load, inf where they cannot (m)."""
    elastic = np.where(held.stiffness > 0.0, load / held.stiffness, np.inf)
    beyond = np.maximum(load - held.strength, 0.0)
    yielded = np.where(
        beyond > 0.0, np.where(held.yielded > 0.0, beyond / held.yielded, np.inf), 0.0
    )
    return np.asarray(np.maximum(elastic, yielded))


def _swing(energy: Floats, held: _Held) -> Floats:
    """Displacement at which the springs have taken up an energy, inf where they cannot (m)."""
    k = np.where(energy > held.yield_energy, held.yielded, held.stiffness)
    return np.asarray(np.where(k > 0.0, np.sqrt(2.0 * energy / k), np.inf))


def _energy(links: Attached, mass: Floats, start: Start) -> Floats:
    """Energy at the start (J), shape (...)."""
    total = np.zeros(mass.shape[:-1])
    for b in range(mass.shape[-1]):
        total = total + 0.5 * mass[..., b] * start.v[..., b] * start.v[..., b]
    for i, (first, second) in enumerate(links.ends.tolist()):
        near = start.u[..., first] if first >= 0 else 0.0
        far = start.u[..., second] if second >= 0 else 0.0
        x = far - near - links.offset[..., i]
        k = np.where(x < 0.0, links.compression[..., i], links.extension[..., i])
        total = total + 0.5 * k * x * x
    for h, i in enumerate(start.hysteretic.tolist()):
        law = links.law
        stored = law.strength[..., i] * law.yield_displacement[..., i]
        total = total + stored * np.abs(start.z[..., h])
    return np.asarray(total)
