"""The energy of a state, and the ledger that must close at the end of a run."""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.model import Model
from eventpound.numerics.arrays import Floats
from eventpound.solvers.base import Energy
from eventpound.solvers.events.scales import SceneScales


def stored_energy(model: Model, u: Floats, v: Floats) -> tuple[float, float]:
    """Kinetic energy and that of the springs' ``k x`` parts (J), for u, v of shape (N,)."""
    kinetic = 0.5 * float(model.mass @ v**2)
    compression = np.array([law.compression for law in model.elastic], float)
    extension = np.array([law.extension for law in model.elastic], float)
    x = model.elongations(u) - np.array([law.offset for law in model.elastic], float)
    k = np.where(x < 0.0, compression, extension)
    return kinetic, 0.5 * float(k @ x**2)


def energy_ledger(
    model: Model,
    scales: SceneScales,
    u: Floats,
    v: Floats,
    work: Floats,
    impact: float,
) -> Energy:
    """The ledger at the state u, v.

    Parameters
    ----------
    model, scales
        The scene.
    u, v : ndarray, shape (N,)
        Displacement (m) and velocity (m/s).
    work : ndarray, shape (3,)
        Input, viscous and hysteretic work up to there (J).
    impact : float
        Kinetic energy lost in impacts up to there (J).
    """
    kinetic, elastic = stored_energy(model, u, v)
    put_in, viscous, hysteretic = (float(value) for value in work)
    initial = sum(stored_energy(model, model.u0, model.v0))
    rest = initial + put_in - kinetic - elastic - hysteretic - viscous - impact
    terms = (initial, abs(put_in), kinetic, elastic, abs(hysteretic), viscous, impact)
    closure = rest / max(*terms, scales.energy)
    return Energy(initial, put_in, kinetic, elastic, hysteretic, viscous, impact, closure)
