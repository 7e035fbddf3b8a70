"""Where supports start and end, and what displacements make of elongations, gaps and forces."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from eventpound.motion.base import GroundMotion, moves
from eventpound.motion.delayed import travelled
from eventpound.numerics.arrays import Floats
from eventpound.scene.scene import Scene

DRIFTING = 1e-3
"""Part of the largest velocity of the motions that may be left between them at their end."""
_SAMPLED = 2000
"""Times at which the largest velocity of a motion is looked for."""


def starts_of_supports(scene: Scene, start: float) -> dict[str, float]:
    """Displacement of each support relative to the ground as a run starts (m).

    Those that have no motion are left out.
    """
    if not scene.supports:
        return {}
    now = np.array(start)
    reference = travelled(scene.motion, now)[0]
    return {
        support.name: float(travelled(support.moved_by(scene.motion), now)[0] - reference)
        for support in scene.supports
        if isinstance(support.motion, GroundMotion)
        or (support.delay is not None and support.delay >= 0.0)
    }


def support_warnings(scene: Scene, end: float) -> list[str]:
    """Sentences on supports that go apart for ever, or move only after the run.

    Parameters
    ----------
    scene : Scene
        Without problems.
    end : float
        Of the run (s); NaN where records of a suite set their own.
    """
    found = []
    for support in scene.supports:
        if support.delay is not None and support.delay > end:
            found.append(
                f"support '{support.name}': a delay of {support.delay:g} s is longer than the run, "
                f"which ends at {end:g} s: it stands still in space; shorten the delay"
            )
        if support.motion is not None:
            found += _drift(support.name, support.motion, scene.motion)
    return found


def _drift(name: str, own: GroundMotion, reference: GroundMotion) -> list[str]:
    """Warning of a motion that leaves a velocity beside the reference's."""
    last = max((m.end for m in (own, reference) if moves(m)), default=np.inf)
    if not np.isfinite(last):
        return []
    now = np.array(last)
    left = float(travelled(own, now)[1] - travelled(reference, now)[1])
    largest = max(_fastest(own, last), _fastest(reference, last))
    if abs(left) <= DRIFTING * largest:
        return []
    return [
        f"support '{name}': at the end of the motions, {last:.6g} s, it still moves at "
        f"{left:.3g} m/s beside the ground ({abs(left) / largest:.2g} of the largest velocity), "
        "so it goes on for ever; process the records (`processing` with baseline or highpass)"
    ]


def _fastest(motion: GroundMotion, end: float) -> float:
    """Largest velocity of a motion up to its end (m/s)."""
    first = min((p.end for p in motion.pieces() if np.isfinite(p.end)), default=0.0)
    t = np.linspace(min(first, end), end, _SAMPLED)
    return float(np.abs(travelled(motion, t)[1]).max())


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

    B, moved = rows(spring.direction for spring in scene.springs)
    W, shifted = rows(contact.direction for contact in scene.contacts)
    gap = np.array([c.gap for c in scene.contacts], float) + shifted
    load = np.zeros(len(index))
    for force in scene.forces:
        i = index[force.body]
        factor = scene.bodies[i].mass if force.per_mass else 1.0
        load[i] += factor * float(force.history.acceleration(np.array(start)))
    return Linkage(B, W, moved, gap, load)
