"""The forces on a single body (`eventpound.solvers.fast.single_model`) in its present state."""

from __future__ import annotations

from eventpound.mechanics.backbone import backbone
from eventpound.numerics.arrays import Floats
from eventpound.solvers.fast.backbone_parts import SATURATED, UNLOADING
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.single_places import (
    DAMPING,
    PART,
    PER_SCALE,
    PULL,
    SIGMA,
    STIFFNESS,
    STRENGTH,
    U_R,
    XI_R,
)


@compiled
def place_of(u: float, w: Floats) -> float:
    """ξ of the hysteretic link at the displacement u (m)."""
    return w[XI_R] + w[SIGMA] * (u - w[U_R]) * w[PER_SCALE]


@compiled
def spring_state(u: float, table: Floats, w: Floats) -> float:
    """``σ y`` at the displacement u (m), reached without reversal; 0 without hysteresis."""
    if w[STRENGTH] == 0.0:
        return 0.0
    if w[PART] == SATURATED:
        return w[SIGMA]
    xi = place_of(u, w)
    if w[PART] <= UNLOADING:
        return w[SIGMA] * xi
    return w[SIGMA] * backbone(table, 0, xi)


@compiled
def absolute_acceleration(u: float, v: float, z: float, w: Floats) -> float:
    """Acceleration that the links give the body (m/s²)."""
    return w[PULL] - w[STIFFNESS] * u - w[DAMPING] * v - w[STRENGTH] * z
