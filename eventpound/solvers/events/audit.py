"""Invariants checked after every step: a state that breaks one is not used."""

from __future__ import annotations

import numpy as np

from eventpound.errors import ComputationError
from eventpound.mechanics.observables import Observed
from eventpound.solvers.events.scales import SceneScales


def check_finite(t: float, seen: Observed) -> None:
    """Stop the run where a displacement, velocity or acceleration is not a number.

    Raises
    ------
    ComputationError
        With the time of the failure.
    """
    if not np.isfinite(seen.u.sum() + seen.v.sum() + seen.a.sum() + seen.z.sum()):
        raise ComputationError("the state is not a number any more; try a smaller rtol", t)


def z_excess(seen: Observed, scales: SceneScales) -> float:
    """Largest amount by which a |z| exceeds its bound (negative where none does)."""
    if scales.z_bound.size == 0:
        return -np.inf
    return float(np.max(np.abs(seen.z[0]) - scales.z_bound))
