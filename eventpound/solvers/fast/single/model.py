"""A single body on springs and dashpots to the ground, seen as one oscillator.

All its links together are ``u'' = p - K u - C v - q σ y - a_g`` with
``y = Φ(ξ)`` of the one hysteretic link, or none.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from eventpound.mechanics.model import Model
from eventpound.numerics.arrays import Floats
from eventpound.solvers.fast.run import Hysteresis, Links, Oscillator

LEAST_PLAY = 1e-9
"""Distance between two barriers, as part of L, below which a body may touch both at once."""


def oscillators_of(
    model: Model,
    mass: Floats,
    gap: Floats,
    length: Floats | float,
    links: Links,
    hysteresis: Hysteresis,
    *,
    energy: bool,
) -> Any:
    """Constants of scenes of one body, `alone` where the scalar kernel serves them.

    Parameters
    ----------
    model : Model
        Who is joined to whom.
    mass, gap : ndarray, shape (..., N) and (..., K)
        Masses (kg) and gaps (m).
    length : float or ndarray, shape (...)
        The scene's own, L (m).
    links, hysteresis
        Of the plan, with the same leading axes.
    energy : bool
        Whether the ledger is kept, which the scalar kernel does not.

    Returns
    -------
    Oscillator
        Its numbers are arrays of the leading shape.
    """
    to_right, to_left = np.flatnonzero(model.right < 0), np.flatnonzero(model.left < 0)
    fits = (
        model.bodies == 1
        and model.loads == 0
        and model.laws.size == 0
        and not energy
        and model.hysteretic.size <= 1
        and max(to_right.size, to_left.size) <= 1
    )
    runs = mass.shape[:-1]
    zero = np.zeros(runs)
    numbers: dict[str, Any] = {
        "alone": np.full(runs, fits),
        "stiffness": zero,
        "damping": zero,
        "pull": zero,
        "strength": zero,
        "side": zero + 1.0,
        "scale": zero + np.inf,
        "right": int(to_right[0]) if to_right.size else -1,
        "left": int(to_left[0]) if to_left.size else -1,
    }
    if not fits:
        return Oscillator(**numbers)
    m = mass[..., 0]
    # Elongation of each link for a displacement of the body.
    side = np.where(model.link_ends[:, 1] == 0, 1.0, -1.0)
    for link in model.hysteretic:
        numbers["side"] = zero + side[link]
        numbers["strength"] = links.law.strength[..., link] * hysteresis.bound[..., 0] / m
        numbers["scale"] = hysteresis.scale[..., 0]
    numbers["alone"] = ~np.asarray(links.compression != links.extension).any(axis=-1)
    if to_right.size and to_left.size:
        numbers["alone"] &= gap.sum(axis=-1) > LEAST_PLAY * np.asarray(length)
    numbers["stiffness"] = links.extension.sum(axis=-1) / m
    numbers["damping"] = links.law.damping.sum(axis=-1) / m
    numbers["pull"] = (side * links.extension * links.offset).sum(axis=-1) / m
    return Oscillator(**numbers)


def oscillator_of(
    model: Model, length: float, links: Links, hysteresis: Hysteresis, *, energy: bool
) -> Oscillator:
    """The same for one scene, its numbers plain."""
    o = oscillators_of(model, model.mass, model.gap, length, links, hysteresis, energy=energy)
    plain: dict[str, Any] = {
        key: value.item() if isinstance(value, np.ndarray | np.generic) else value
        for key, value in o._asdict().items()
    }
    return Oscillator(**plain)
