"""Rounding of the accelerations and contact forces of a step, below which they have no sign."""

from __future__ import annotations

from eventpound.solvers.events import noise
from eventpound.solvers.events.rest import DIRECT
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.run import Limits, Series

OF_BODIES = 0.2
"""Part of the largest acceleration that sums of forces have for theirs."""


@compiled
def acceleration_level(c: int, limits: Limits, series: Series) -> float:
    """Rounding of the acceleration of a cluster (m/s²), as the acceleration problem has it.

    See `eventpound.solvers.events.rest`. What the ground alone accelerates errs with its own
    acceleration only, however small.
    """
    absolute = 2.0 * series.X[c, 2] + series.ground[0]
    level = DIRECT * abs(absolute)
    if absolute != 0.0:
        level = max(level, noise.ACCELERATION * limits.length / limits.time**2)
    return level


@compiled
def force_level(count: int, limits: Limits, series: Series) -> float:
    """Rounding of a contact force in a step of `count` clusters (N)."""
    largest = limits.length / limits.time**2
    for c in range(count):
        largest = max(largest, OF_BODIES * abs(2.0 * series.X[c, 2] + series.ground[0]))
    return noise.FORCE * limits.mass * largest
