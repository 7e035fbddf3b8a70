"""Where a scene stands still under its forces: from there a run may start.

The forces of springs and contacts balance those on the bodies,

    Σ_s B_s F_s(B_sᵀ u) = p + W λ,   0 <= g ⊥ λ >= 0,

the condition of least potential energy, which is convex for springs of any law here. Newton's
method solves it; every step is a problem with linear springs and a small stiffness added to
each body, whose share vanishes as the steps do (R. T. Rockafellar, SIAM J. Control Optim. 14,
1976), and is solved by active sets. A Bouc-Wen spring is loaded straight from its initial state.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import solve_ivp

from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.scene.check import starts_of_supports
from eventpound.scene.elastic_laws import elastic_force, reduced
from eventpound.scene.scene import Scene
from eventpound.scene.spring import BoucWen, Spring

MOST_STEPS = 100
"""Of Newton's method; a body that nothing holds falls on and on."""
ADDED = 1e-7
"""Stiffness added to a body, as a part of the largest that one has."""
CLOSE = 1e-12
"""Part of the largest displacement, gap or yield displacement that a step may be at the end."""


def in_equilibrium(scene: Scene, start: float = 0.0) -> Scene:
    """The scene with its bodies, and z of its springs, where the forces at the start hold them.

    Parameters
    ----------
    scene : Scene
        A checked scene. Velocities and the ground motion play no part.
    start : float
        When the run starts (s): forces and supports are those of that time.

    Raises
    ------
    InputError
        Where there is no equilibrium, as of a body that nothing holds.
    """
    soft = [contact.name for contact in scene.contacts if contact.law is not None]
    if soft:
        raise InputError(
            f'start: found "equilibrium" beside the contact {soft[0]!r}, which has a law of its '
            "own; accepted: contacts that are rigid"
        )
    s = _Statics.of(scene, start)
    u, shut = s.u, np.zeros(len(scene.contacts), np.bool_)
    yielding = [x.law.yield_displacement for x in s.springs if isinstance(x.law, BoucWen)]
    given = max(np.abs(s.gap).max(initial=0.0), max(yielding, default=0.0))
    for _ in range(MOST_STEPS):
        step, shut = _step(s, u, shut)
        u = u + step
        largest = max(np.abs(u).max(), given)
        if np.abs(step).max() <= CLOSE * largest:
            return _standing(scene, s, _closed(s, u, shut))
    loose = scene.bodies[int(np.argmax(np.abs(step)))].name
    raise InputError(
        f'start: found "equilibrium", but nothing holds the body {loose!r} against its forces; '
        'accepted: "initial", or a spring or a contact that holds it'
    )


@dataclass(frozen=True)
class _Statics:
    """Bodies (N,) and what holds them: rows of springs (S, N) and contacts (K, N).

    `moved` (S,): elongation by the supports at u = 0 (m). gap (K,): at u = 0 (m). u, p: where
    the bodies are given, and the forces on them (N).
    """

    springs: Sequence[Spring]
    rows: Floats
    moved: Floats
    contacts: Floats
    gap: Floats
    u: Floats
    p: Floats

    @classmethod
    def of(cls, scene: Scene, start: float) -> _Statics:
        """Those of a scene."""
        index = {body.name: i for i, body in enumerate(scene.bodies)}
        placed = starts_of_supports(scene, start)
        now = np.array(start)
        p = np.zeros(len(index))
        for force in scene.forces:
            i = index[force.body]
            factor = scene.bodies[i].mass if force.per_mass else 1.0
            p[i] += factor * float(force.history.acceleration(now))

        def row(ends: Iterable[tuple[str, float]]) -> tuple[Floats, float]:
            found, by_supports = np.zeros(len(index)), 0.0
            for end, weight in ends:
                if end in index:
                    found[index[end]] += weight
                by_supports += weight * placed.get(end, 0.0)
            return found, by_supports

        springs = [row(zip(s.between, (-1.0, 1.0), strict=True)) for s in scene.springs]
        contacts = [row(contact.direction) for contact in scene.contacts]
        given = np.array([c.gap for c in scene.contacts], float)
        return cls(
            scene.springs,
            np.array([r for r, _ in springs]).reshape(-1, len(index)),
            np.array([x for _, x in springs], float),
            np.array([r for r, _ in contacts]).reshape(-1, len(index)),
            given + np.array([x for _, x in contacts], float),
            np.array([body.displacement for body in scene.bodies], float),
            p,
        )

    def elongations(self, u: Floats) -> Floats:
        """Of the springs (m), shape (S,)."""
        return self.rows @ u + self.moved


def _step(s: _Statics, u: Floats, shut: np.ndarray) -> tuple[Floats, np.ndarray]:
    """A step of Newton's method and the contacts that hold at its end."""
    x, x_0 = s.elongations(u), s.elongations(s.u)
    laws = [_force(spring, a, b) for spring, a, b in zip(s.springs, x, x_0, strict=True)]
    force, stiffness = np.array(laws).reshape(-1, 2).T
    K = (s.rows.T * stiffness) @ s.rows
    K += np.eye(u.size) * (ADDED * K.diagonal().max() or 1.0)
    rest = s.p - s.rows.T @ force
    return _held_step(K, rest, s.contacts, s.gap + s.contacts @ u, shut)


def _held_step(
    K: Floats, rest: Floats, W: Floats, gap: Floats, shut: np.ndarray
) -> tuple[Floats, np.ndarray]:
    """Least ``x' K x / 2 - rest' x`` with ``gap + W x >= 0``, and the contacts that are shut."""
    n, shut = rest.size, shut.copy()
    noise = 1e-14 * max(np.abs(gap).max(initial=0.0), np.finfo(float).tiny)
    for _ in range(10 * (gap.size + 1)):
        A = W[shut]
        system = np.block([[K, -A.T], [A, np.zeros((A.shape[0], A.shape[0]))]])
        found = np.linalg.lstsq(system, np.concatenate((rest, -gap[shut])), rcond=None)[0]
        x, force = found[:n], found[n:]
        if force.size and force.min() < -1e-12 * np.abs(force).max():
            shut[np.flatnonzero(shut)[np.argmin(force)]] = False
            continue
        after = np.where(shut, 0.0, gap + W @ x)
        if after.min(initial=0.0) >= -noise:
            return x, shut
        shut[np.argmin(after)] = True
    raise InputError('start: found "equilibrium", whose contacts could not be found')


def _force(spring: Spring, x: float, x_0: float) -> tuple[float, float]:
    """Force of a spring and its slope at an elongation, loaded from another (N, N/m)."""
    law = spring.law
    if isinstance(law, BoucWen):
        z = _loaded(law, x - x_0)
        same = (x >= x_0) == (z > 0.0)
        kappa = law.beta + law.gamma if same else law.beta - law.gamma
        slope = (1.0 - kappa * abs(z) ** law.exponent) / law.yield_displacement
        return law.stiffness * x + law.strength * z, law.stiffness + law.strength * max(slope, 0.0)
    force, stiffness = elastic_force(reduced(law), np.array(x))
    return float(force), float(stiffness)


def _loaded(law: BoucWen, travel: float) -> float:
    """The z of a Bouc-Wen spring after an elongation by `travel` (m) in one direction."""
    if travel == 0.0:
        return law.initial_z
    way = np.sign(travel)
    # What has yielded stays so.
    reach = min(abs(travel), 1e3 * law.yield_displacement)
    bound = (law.beta + law.gamma) ** (-1.0 / law.exponent)

    def rate(_: float, z: Floats) -> Floats:
        # Beyond the bound, where only a trial of the integrator is, powers may overflow.
        z = np.clip(z, -1.1 * bound, 1.1 * bound)
        kappa = np.where(way * z > 0.0, law.beta + law.gamma, law.beta - law.gamma)
        slope: Floats = way * (1.0 - kappa * np.abs(z) ** law.exponent) / law.yield_displacement
        return slope

    found = solve_ivp(rate, (0.0, reach), [law.initial_z], "LSODA", rtol=1e-12, atol=1e-14)
    return float(np.clip(found.y[0, -1], -bound, bound))


def _closed(s: _Statics, u: Floats, shut: np.ndarray) -> Floats:
    """Displacements with the contacts that hold shut to rounding, from the fixed ends on."""
    placed = ~s.contacts[shut].any(axis=0)
    rows, gaps = s.contacts[shut], s.gap[shut]
    while not placed.all():
        # A contact with one body whose place is not known says where that is.
        unknown = [np.flatnonzero((row != 0.0) & ~placed) for row in rows]
        ready = [i for i, bodies in enumerate(unknown) if bodies.size == 1]
        if not ready:
            placed[np.argmin(placed)] = True
            continue
        i = ready[0]
        b = int(unknown[i][0])
        others = np.where(np.arange(u.size) == b, 0.0, rows[i])
        u[b] = -(gaps[i] + others @ u) / rows[i, b]
        placed[b] = True
    return u


def _standing(scene: Scene, s: _Statics, u: Floats) -> Scene:
    """The scene at these displacements."""
    x, x_0 = s.elongations(u), s.elongations(s.u)
    springs = tuple(
        replace(spring, law=replace(spring.law, initial_z=_loaded(spring.law, float(a - b))))
        if isinstance(spring.law, BoucWen)
        else spring
        for spring, a, b in zip(scene.springs, x, x_0, strict=True)
    )
    bodies = tuple(
        replace(body, displacement=float(each)) for body, each in zip(scene.bodies, u, strict=True)
    )
    return replace(scene, bodies=bodies, springs=springs)
