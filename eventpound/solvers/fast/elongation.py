"""Elongations of the links, from the motion of the bodies."""

from __future__ import annotations

from eventpound.numerics.arrays import Floats, Ints
from eventpound.solvers.fast.compiled import compiled


@compiled
def elongations(ends: Ints, u: Floats, v: Floats, x: Floats, x_rate: Floats) -> None:
    """Elongations of all links (m) and their rates (m/s), into `x` and `x_rate` (L,)."""
    for a in range(ends.shape[0]):
        first, second = ends[a, 0], ends[a, 1]
        x[a] = x_rate[a] = 0.0
        if second >= 0:
            x[a], x_rate[a] = u[second], v[second]
        if first >= 0:
            x[a] -= u[first]
            x_rate[a] -= v[first]
