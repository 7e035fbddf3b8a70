"""A scene at rest: every spring by the tangent of its law there, one rule for all that asks.

Periods and modes, ratios of damping, the default length of a run, and what is doubted in a scene
are those of the motion about the state at rest. That is where the bodies are given if everything
balances there, as after a start in equilibrium; else zero displacement. Velocities, the ground
motion and contacts play no part.

    linear, bilinear-elastic, series   its stiffness on that side of its kink
    Bouc-Wen                           k + Q/(eta u_y) (1 - nu (beta - gamma) |z|^n): it unloads
    backfill                           K0 where it is pressed, 0 in its gap
    slider                             the stiffness beside it: what sticks has none of its own
    each with a weight                 P/h less (P-Delta)

Where a law has two tangents at rest and no force, as a cable without slack, the smaller counts, so
that no period is too short. Where it has a force, as one that has yielded, it counts as it
unloads: so a small motion to and fro goes on.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.scene.elastic_laws import as_arrays, elastic_force, reduced
from eventpound.scene.linkage import Linkage, linkage_of, starts_of_supports
from eventpound.scene.scene import Scene
from eventpound.scene.spring import (
    Backfill,
    BoucWen,
    Hysteretic,
    Law,
    Linear,
    Series,
    Slider,
    Spring,
)

AT_KINK = 1e-9
"""Part of the lengths that make an elongation, within which it is that of a kink."""
BALANCED = 1e-6
"""Part of the forces at a body that may be left where they balance."""
APART = 0.01
"""Part of the larger by which two tangents of a spring differ that are told."""


class Tangent(NamedTuple):
    """Stiffness of a spring at rest (N/m): as it closes, as it opens, and what counts."""

    closing: float
    opening: float
    counts: float

    @property
    def two(self) -> bool:
        """Whether there are two of them."""
        return abs(self.closing - self.opening) > APART * max(abs(self.closing), abs(self.opening))


def at_rest(scene: Scene, start: float = 0.0) -> Scene:
    """The scene with linear and Bouc-Wen springs that begin as its own do at rest.

    Parameters
    ----------
    scene : Scene
        Whatever moves; of one at rest the same comes back.
    start : float
        When the run starts (s): forces and supports are those of that time.
    """
    found = []
    for spring, tangent in zip(scene.springs, tangents(scene, start), strict=True):
        law = spring.acting
        if isinstance(law, Linear | BoucWen) and stiffness_of(spring) == tangent.counts:
            found.append(spring)
            continue
        resting: Law = Linear(tangent.counts)
        if isinstance(law, BoucWen):
            resting = BoucWen(law.stiffness, tangent.counts - law.stiffness, 1.0)
        found.append(replace(spring, law=resting, weight=None))
    return replace(scene, springs=tuple(found))


def tangents(scene: Scene, start: float = 0.0) -> list[Tangent]:
    """Stiffness of each spring of a scene at rest, as `at_rest` takes it."""
    x, length = _elongations(scene, start)
    laws = (spring.acting for spring in scene.springs)
    return [_tangent(law, at, length) for law, at in zip(laws, x.tolist(), strict=True)]


def stiffness_of(spring: Spring, yielded: bool = False) -> float:
    """Stiffness (N/m) of a spring of a scene at rest, before it yields or after."""
    law = spring.acting
    if isinstance(law, BoucWen):
        return law.stiffness if yielded else law.initial_stiffness
    return law.stiffness if isinstance(law, Linear) else _tangent(law, 0.0, 0.0).counts


def theta_at_rest(spring: Spring) -> float | None:
    """P/(k h) of a storey at rest; None without a weight, or where it does not resist by itself."""
    k = 0.0 if spring.weight is None else stiffness_of(replace(spring, weight=None))
    return spring.geometric_stiffness / k if k > 0.0 else None


def stiffest(scene: Scene) -> Scene:
    """The scene with every spring at its largest stiffness: nothing swings faster."""

    def of(law: Law) -> Law:
        if isinstance(law, Backfill):
            return Linear(law.initial_stiffness)
        if isinstance(law, BoucWen):
            return law
        sides = reduced(law)
        return Linear(max(sides.compression, sides.extension))

    return replace(scene, springs=tuple(replace(s, law=of(s.law)) for s in scene.springs))


def springs_at_rest(scene: Scene, start: float = 0.0) -> dict[str, list[str]]:
    """Names of the springs that count at rest, of those that do not, and of those of two tangents.

    Of ``at_kink`` the smaller counts, of ``at_yield`` that of unloading.
    """
    found: dict[str, list[str]] = {"counts": [], "not": [], "at_kink": [], "at_yield": []}
    for spring, tangent in zip(scene.springs, tangents(scene, start), strict=True):
        told = spring.name if spring.frame is None else f"frame {spring.frame}"
        found["counts" if tangent.counts != 0.0 else "not"].append(told)
        if tangent.two:
            smaller = tangent.counts == min(tangent.closing, tangent.opening)
            found["at_kink" if smaller else "at_yield"].append(spring.name)
    return {key: [*dict.fromkeys(names)] for key, names in found.items()}


def _tangent(law: Law, x: float, length: float) -> Tangent:
    """Of a law at an elongation (m), which is a sum of lengths of this size (m)."""
    sides = reduced(law)
    kink = law.touched if isinstance(law, Backfill) else sides.offset
    if isinstance(law, Series):
        length = max(length, *(abs(reduced(part).offset) for part in law.parts))
    if abs(x - kink) <= AT_KINK * max(length, abs(kink)):
        x = kink
    if isinstance(law, Hysteretic):
        closing, opening = law.tangents(x)
        z = law.z_at(x)
    else:
        closing = sides.compression if x <= kink else sides.extension
        opening = sides.extension if x >= kink else sides.compression
        z = 0.0
    unloads = closing if z > 0.0 else opening if z < 0.0 else min(closing, opening)
    return Tangent(closing, opening, unloads)


def _elongations(scene: Scene, start: float) -> tuple[Floats, float]:
    """Elongations of the springs at rest (m), shape (S,), and the largest length in them (m)."""
    nowhere = np.zeros(len(scene.springs)), 0.0
    if all(isinstance(spring.law, Linear | BoucWen | Slider) for spring in scene.springs):
        return nowhere
    u = np.array([body.displacement for body in scene.bodies])
    places = [*u.tolist(), *starts_of_supports(scene, start).values()]
    length = max(map(abs, places), default=0.0)
    if length == 0.0:
        return nowhere
    link = linkage_of(scene, start)
    if not _balances(scene, link, u, length):
        return nowhere
    return link.moved + link.springs @ u, length


def _balances(scene: Scene, link: Linkage, u: Floats, length: float) -> bool:
    """Whether forces on the bodies balance at u (N,), with some of shut contacts and sliders."""
    laws, x = [spring.acting for spring in scene.springs], link.moved + link.springs @ u
    elastic = as_arrays(laws)
    force, stiff = elastic_force(elastic, x)[0], np.maximum(elastic.compression, elastic.extension)
    friction = np.zeros(x.size)
    for i, law in enumerate(laws):
        if isinstance(law, Slider):
            friction[i] = law.strength
        elif isinstance(law, BoucWen | Backfill):
            z = law.z_at(float(x[i]))
            force[i] += law.strength * (min(z, 0.0) if isinstance(law, Backfill) else z)
            stiff[i] += law.strength / law.yield_displacement
    rigid = np.array([contact.law is None for contact in scene.contacts], bool)
    shut = rigid & (link.gap + link.contacts @ u <= AT_KINK * length)
    net = link.load - force @ link.springs
    around = abs(link.springs.T)
    size = abs(link.load) + around @ abs(force)
    rows = np.vstack((link.contacts[shut], link.springs[friction > 0.0]))
    if rows.size:
        from scipy.optimize import lsq_linear

        slips = friction[friction > 0.0]
        low = np.append(np.zeros(shut.sum()), -slips)
        high = np.append(np.full(shut.sum(), np.inf), slips)
        held = lsq_linear(rows.T, -net, (low, high), tol=1e-14).x
        net, size = net + rows.T @ held, size + abs(rows.T) @ abs(held)
    least = BALANCED * size + AT_KINK * length * (around @ stiff)
    return bool((abs(net) <= least).all())
