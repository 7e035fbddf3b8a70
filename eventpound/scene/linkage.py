"""What displacements of the bodies make of elongations and gaps, and the forces on the bodies."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.scene.scene import Scene
from eventpound.scene.support_drift import starts_of_supports


class Linkage(NamedTuple):
    """N bodies, S springs and K contacts as a run starts.

    springs, contacts : ndarray, shape (S, N), (K, N)
        What displacements make of elongations and of gaps.
    moved, gap : ndarray, shape (S,), (K,)
        Elongations and gaps at zero displacements, supports where they are (m).
    load : ndarray, shape (N,)
        Forces on the bodies (N).
    """

    springs: Floats
    contacts: Floats
    moved: Floats
    gap: Floats
    load: Floats


def linkage_of(scene: Scene, start: float) -> Linkage:
    """That of a checked scene whose run starts at a time (s)."""
    index = {body.name: i for i, body in enumerate(scene.bodies)}
    placed = starts_of_supports(scene, start)

    def rows(ends: Iterable[Iterable[tuple[str, float]]]) -> tuple[Floats, Floats]:
        of_bodies, by_supports = [], []
        for pairs in ends:
            row = np.zeros(len(index))
            moved = 0.0
            for end, weight in pairs:
                if end in index:
                    row[index[end]] += weight
                moved += weight * placed.get(end, 0.0)
            of_bodies.append(row)
            by_supports.append(moved)
        return np.array(of_bodies).reshape(-1, len(index)), np.array(by_supports)

    B, moved = rows(zip(s.between, (-1.0, 1.0), strict=True) for s in scene.springs)
    W, shifted = rows(contact.direction for contact in scene.contacts)
    gap = np.array([c.gap for c in scene.contacts], float) + shifted
    load = np.zeros(len(index))
    for force in scene.forces:
        i = index[force.body]
        factor = scene.bodies[i].mass if force.per_mass else 1.0
        load[i] += factor * float(force.history.acceleration(np.array(start)))
    return Linkage(B, W, moved, gap, load)
