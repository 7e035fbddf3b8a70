"""A single body on springs and dashpots to the ground, seen as one oscillator.

All its links together are ``u'' = p - K u - C v - q σ y - a_g`` with
``y = Φ(ξ)`` of the one hysteretic link, or none.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.model import Model


class Oscillator(NamedTuple):
    """Constants of a single body for each unit of its mass: K, C, p, q.

    `alone`: whether the scene is one. `side`: elongation of the hysteretic
    link for a displacement of one. `scale`: ``u_y b`` (m). `right`, `left`: contacts with
    the barriers on either side, -1 for none.
    """

    alone: bool
    stiffness: float
    damping: float
    pull: float
    strength: float
    side: float
    scale: float
    right: int
    left: int


def oscillator_of(model: Model, *, energy: bool) -> Oscillator:
    """Constants of a scene of one body, `alone` where the scalar kernel serves it."""
    laws, hysteretic = model.elastic, model.hysteretic
    to_right = np.flatnonzero(model.right < 0)
    to_left = np.flatnonzero(model.left < 0)
    alone = (
        model.bodies == 1
        and not energy
        and hysteretic.size <= 1
        and max(to_right.size, to_left.size) <= 1
        and all(law.compression == law.extension for law in laws)
    )
    if not alone:
        return Oscillator(False, 0.0, 0.0, 0.0, 0.0, 1.0, np.inf, -1, -1)
    mass = float(model.mass[0])
    # Elongation of each link for a displacement of the body.
    side = np.where(model.link_ends[:, 1] == 0, 1.0, -1.0)
    stiffness = np.array([law.extension for law in laws])
    offset = np.array([law.offset for law in laws])
    strength, scale, of_spring = 0.0, np.inf, 1.0
    for link in hysteretic:
        law, of_spring = model.law, float(side[link])
        bound = (law.beta[link] + law.gamma[link]) ** (-1.0 / law.exponent[link])
        strength = float(law.strength[link] * bound) / mass
        scale = float(law.yield_displacement[link] * bound)
    return Oscillator(
        True,
        float(stiffness.sum()) / mass,
        float(model.law.damping.sum()) / mass,
        float((side * stiffness * offset).sum()) / mass,
        strength,
        of_spring,
        scale,
        int(to_right[0]) if to_right.size else -1,
        int(to_left[0]) if to_left.size else -1,
    )
