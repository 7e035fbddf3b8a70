"""Random scenes with resting contacts, and states that respect them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eventpound.mechanics.clusters import Clusters, between_of, form_clusters
from eventpound.mechanics.model import Model, assemble
from eventpound.mechanics.observables import Bodies, Observed, bodies_of
from eventpound.mechanics.reduced import Branches, Forcing, Reduced, reduce
from eventpound.motion.base import Family
from eventpound.scene import (
    BARRIER,
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Linear,
    Scene,
    Spring,
)
from tests.mechanics.dense import Answer, direction

LEDGER = 3


@dataclass(frozen=True)
class Instant:
    """A scene in a mode, with one state of it."""

    scene: Scene
    model: Model
    resting: list[int]
    clusters: Clusters
    system: Reduced
    bodies: Bodies
    forcing: Forcing
    u: np.ndarray
    v: np.ndarray
    z: np.ndarray

    @property
    def y(self) -> np.ndarray:
        """State vector, packed cluster by cluster from its first body."""
        y = np.zeros(self.system.size)
        for c in range(self.clusters.count):
            body = int(np.flatnonzero(self.clusters.of_body == c)[0])
            y[self.system.iq[c]] = self.u[body] - self.clusters.offset[body]
            y[self.system.iv[c]] = self.v[body]
        for place, z in zip(self.system.z_of, self.z, strict=True):
            if place >= 0:
                y[place] = z
        return y


def sine_forcing(start: float) -> Forcing:
    """a = 2 cos(3 t - 0.4) + cos(7 t) (m/s²) from `start` on."""
    numbers = np.array([0.0, 2.0, 3.0, -0.4, 1.0, 7.0, 0.0])
    return Forcing(int(Family.SINUSOIDS), numbers, np.empty(0), start)


def random_law(rng: np.random.Generator) -> Linear | BilinearElastic | BoucWen:
    """One of the laws with numbers of order one."""
    kind = rng.integers(3)
    if kind == 0:
        return Linear(rng.uniform(0.0, 3.0))
    if kind == 1:
        return BilinearElastic(*rng.uniform(0.0, 3.0, 2), rng.normal())
    n, gamma = rng.choice([1.0, 2.0, 3.5, 20.0]), rng.uniform(0.2, 1.0)
    beta = rng.uniform(-0.1, 1.0)
    z = rng.uniform(-0.95, 0.95) * (beta + gamma) ** (-1.0 / n)
    return BoucWen(*rng.uniform(0.1, 2.0, 2), rng.uniform(0.3, 2.0), n, beta, gamma, z)


def random_instant(
    rng: np.random.Generator, *, squeezed: bool = False, ledger: bool = True
) -> Instant:
    """A row with springs between any ends; some contacts rest, all if `squeezed`."""
    count = int(rng.integers(1, 6))
    names = [f"b{i}" for i in range(count)]
    ends = [GROUND, *names]
    springs, dashpots = [], []
    for i in range(int(rng.integers(1, 8))):
        first, second = rng.choice(len(ends), 2, replace=False)
        springs.append(Spring(f"s{i}", (ends[first], ends[second]), random_law(rng)))
    for _ in range(int(rng.integers(0, 5))):
        first, second = rng.choice(len(ends), 2, replace=False)
        dashpots.append(Dashpot((ends[first], ends[second]), rng.uniform(0.0, 2.0)))
    row = [BARRIER, *names, BARRIER]
    gaps = rng.normal(size=count + 1)
    if squeezed:
        gaps[-1] = -gaps[:-1].sum()
    contacts = tuple(Contact(f"c{i}", row[i], row[i + 1], gaps[i], 0.5) for i in range(count + 1))
    bodies = tuple(Body(name, rng.uniform(0.3, 3.0)) for name in names)
    scene = Scene(bodies, tuple(springs), tuple(dashpots), contacts)
    # A mode in which all but one of the contacts may rest, so that the gaps stay free.
    rests = np.ones(count + 1, bool) if squeezed else rng.random(count + 1) < 0.5
    if not squeezed:
        rests[rng.integers(count + 1)] = False
    return instant(scene, list(np.flatnonzero(rests)), rng, ledger=ledger)


def clusters_of(model: Model, resting: list[int]) -> Clusters:
    """The clusters of a model with the given contacts at rest, all of them pressed."""
    rests = np.isin(np.arange(model.contacts), resting)
    return form_clusters(between_of(model), rests, rests)


def reduced(
    model: Model, clusters: Clusters, stiffness: np.ndarray, preload: np.ndarray, *, ledger: bool
) -> Reduced:
    """The equations of motion of a mode of a model."""
    return reduce(
        model.link_ends,
        model.law,
        model.mass,
        model.hysteretic,
        clusters,
        Branches(stiffness, preload),
        LEDGER if ledger else 0,
    )


def instant(scene: Scene, resting: list[int], rng: np.random.Generator, *, ledger: bool) -> Instant:
    """A random state of a scene with the given contacts at rest."""
    model = assemble(scene)
    clusters = clusters_of(model, resting)
    moving = clusters.of_body >= 0
    u, v = clusters.offset.copy(), np.zeros(model.bodies)
    u[moving] += rng.normal(size=clusters.count)[clusters.of_body[moving]]
    v[moving] += rng.normal(size=clusters.count)[clusters.of_body[moving]]
    x = model.elongations(u)
    stiffness, preload = model.elastic.on_side(np.where(x < model.elastic.offset, -1, 1))
    system = reduced(model, clusters, stiffness, preload, ledger=ledger)
    bodies = bodies_of(model, clusters, system, stiffness, preload, model.z0.copy())
    return Instant(
        scene,
        model,
        resting,
        clusters,
        system,
        bodies,
        sine_forcing(rng.uniform(0.0, 5.0)),
        u,
        v,
        model.z0.copy(),
    )


def assert_contacts(observed: Observed, at: Instant, answer: Answer, squeezed: bool) -> np.ndarray:
    """What is observed of contacts is what full matrices give; their forces (N) are returned."""
    force = np.zeros(at.model.contacts)
    force[at.resting] = answer.contact_force
    # In a squeezed row they are unique but for a constant; those expected have the mean 0.
    told = observed.contact_force[0] - (observed.contact_force[0].mean() if squeezed else 0.0)
    np.testing.assert_allclose(told, force, atol=1e-10)
    for j, contact in enumerate(at.scene.contacts):
        W = direction(at.scene, contact.left, contact.right)
        gaps = (contact.gap + W @ at.u, W @ at.v, W @ answer.acceleration)
        np.testing.assert_allclose(observed.gap[:, j], gaps, atol=1e-11)
    return force
