"""How a single body changes from one part of the backbone to another.

The rules are those of `eventpound.solvers.fast.backbone_parts`, in the places of
`eventpound.solvers.fast.single_places`.
"""

from __future__ import annotations

from eventpound.mechanics.backbone import backbone_inverse
from eventpound.numerics.arrays import Floats
from eventpound.solvers.fast.backbone_parts import CORE, DOWN, SATURATED, UNLOADING, UP
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.single import place_of
from eventpound.solvers.fast.single_places import (
    CORE_END,
    DOWN_END,
    PART,
    SATURATION,
    SIGMA,
    U_R,
    XI_R,
    Z,
)


@compiled
def part_at(xi: float, w: Floats) -> int:
    """Part of the backbone that ξ lies on."""
    if xi >= w[SATURATION]:
        return SATURATED
    if xi > w[CORE_END]:
        return UP
    if xi >= -w[CORE_END]:
        return CORE
    return UNLOADING if xi >= w[DOWN_END] else DOWN


@compiled_apart
def turn_round(u: float, table: Floats, w: Floats) -> None:
    """Put the link on the curve for the other direction at u (m); ``σ y`` stays."""
    sigma = -w[SIGMA]
    y = min(max(sigma * w[Z], -1.0), 1.0)
    w[SIGMA], w[U_R] = sigma, u
    w[XI_R] = backbone_inverse(table, 0, y)
    w[PART] = part_at(w[XI_R], w)


@compiled_apart
def pass_border(u: float, w: Floats) -> None:
    """Move a link that has reached the border of its part to the next."""
    part = w[PART]
    if part == CORE and place_of(u, w) < 0.0:
        w[SIGMA], w[U_R], w[XI_R], w[PART] = -w[SIGMA], u, w[CORE_END], UP
    elif part <= UNLOADING:
        w[PART] = UP
    elif part == DOWN:
        w[U_R], w[XI_R] = u, w[DOWN_END]
        w[PART] = UNLOADING if w[DOWN_END] < -w[CORE_END] else CORE
