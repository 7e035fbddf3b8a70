"""Distances that codes ask for between two structures, from their peaks u_1, u_2 without contact.

    absolute sum   u_1 + u_2
    SRSS           sqrt(u_1^2 + u_2^2)
    CQC            sqrt(u_1^2 + u_2^2 - 2 rho u_1 u_2)

    rho = 8 sqrt(x_1 x_2) (x_1 + r x_2) r^(3/2)
          / ((1 - r^2)^2 + 4 x_1 x_2 r (1 + r^2) + 4 (x_1^2 + x_2^2) r^2),    r = T_1/T_2

T_i and x_i are the longest period of each structure, before it yields, and the damping ratio of
that mode. Sources: sum, where each of two owners keeps a peak from the boundary: EN 1998-1:2004,
4.4.2.7(2) a; ASCE 7-16, eq. 12.12-1. SRSS: EN 1998-1:2004, 4.4.2.7(2) b; ASCE 7-16, eq. 12.12-2;
at the hinge of a bridge Caltrans SDC 1.7, 7.2.5.4. CQC, the spectral difference: V. Jeng, K. Kasai
and B. Maison, A spectral difference method to estimate building separations to avoid pounding,
Earthquake Spectra 8 (1992), 201-223; rho: A. Der Kiureghian, A response spectrum method for random
vibration analysis of MDF systems, Earthquake Engng Struct. Dyn. 9 (1981), 419-435.
"""

from __future__ import annotations

import math

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.scene.contact import Contact
from eventpound.scene.modes import modes_of
from eventpound.scene.scene import Scene
from eventpound.scene.structures import structures_of


def is_between_bodies(scene: Scene, i: int) -> bool:
    """Whether both ends of contact i are bodies, or points between them; not of decks in plan."""
    bodies = {body.name for body in scene.bodies}
    return bodies.issuperset(scene.contacts[i].ends) and not scene.decks


def is_between_structures(scene: Scene, i: int) -> bool:
    """Whether the two ends of contact i are of one structure each, not of the same."""
    if not is_between_bodies(scene, i):
        return False
    left, right = (_structures_at(scene, scene.contacts[i], sign) for sign in (-1.0, 1.0))
    return len(left) == len(right) == 1 and left != right


def correlation(scene: Scene, i: int) -> float:
    """How far the motions of the two structures at contact i go together, rho.

    Parameters
    ----------
    scene : Scene
        A checked scene.
    i : int
        A contact for which `is_between_structures` holds.
    """
    groups, modes = structures_of(scene), []
    for sign in (-1.0, 1.0):
        (which,) = _structures_at(scene, scene.contacts[i], sign)
        found = modes_of(scene, groups[which])
        held = np.flatnonzero(np.isfinite(found.period))
        if not held.size:
            return 0.0
        modes.append((float(found.period[held[0]]), float(found.damping[held[0]])))
    return correlation_of(*modes[0], *modes[1])


def correlation_of(t_1: float, x_1: float, t_2: float, x_2: float) -> float:
    """Correlation of two oscillators of periods T (s) and damping ratios x under white noise."""
    r = t_1 / t_2
    below = (1.0 - r**2) ** 2 + 4.0 * x_1 * x_2 * r * (1.0 + r**2) + 4.0 * (x_1**2 + x_2**2) * r**2
    if below == 0.0:
        # One motion twice.
        return 1.0
    return 8.0 * math.sqrt(x_1 * x_2) * (x_1 + r * x_2) * r**1.5 / below


def _structures_at(scene: Scene, contact: Contact, sign: float) -> set[int]:
    """Numbers of the structures at the left end of a contact (-1), or at the right one (1)."""
    names = {name for name, opens in contact.direction if opens * sign > 0.0}
    return {k for k, group in enumerate(structures_of(scene)) if names.intersection(group)}


def cqc(left: Floats, right: Floats, rho: Floats) -> Floats:
    """Combination of two peaks (m) whose motions go together by rho."""
    return np.sqrt(left**2 + right**2 - 2.0 * rho * left * right)
