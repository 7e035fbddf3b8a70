"""Contacts at points between bodies (`eventpound.scene.point`) in the equations of motion.

Bodies at rest on each other are one cluster; a resting contact at a point is a constraint
``Wᵀ u = const`` on the clusters instead. With ``P = I - M⁻¹ W (Wᵀ M⁻¹ W)⁻¹ Wᵀ`` the
accelerations that its forces leave are P times those without them, and of every derivative P
times what it would be. A mode without such a contact has an empty P, and nothing is done.

``Wᵀ u`` and ``Wᵀ v`` are linear and constant, which every integrator here keeps but for the
rounding of its sums: after n steps some ``ε n^½ (|u| + |v| t)``, and an event begins anew.
"""

from __future__ import annotations

import numpy as np

from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.compiled import kernel


@kernel
def hold(P: Floats, values: Floats) -> None:
    """Multiply values of the clusters (C,) by P (C, C), in place."""
    free = values.copy()
    for c in range(free.size):
        values[c] = 0.0
        for d in range(free.size):
            values[c] += P[c, d] * free[d]


@kernel
def hold_at(P: Floats, places: Ints, values: Floats) -> None:
    """`hold` of what stands at these places (C,) of an array."""
    own = np.empty(places.size)
    for c in range(own.size):
        own[c] = values[places[c]]
    hold(P, own)
    for c in range(own.size):
        values[places[c]] = own[c]


@kernel
def hold_beside_ground(P: Floats, ground: float, values: Floats) -> None:
    """`hold` of absolute accelerations, or rates of them, over that of the ground."""
    for c in range(values.size):
        values[c] -= ground
    hold(P, values)
    for c in range(values.size):
        values[c] += ground


@kernel
def add_points(points: Ints, spread: Floats, values: Floats, gaps: Floats) -> None:
    """Add to the gaps of contacts at points what values (N,) of the bodies make of them.

    `points` (D,), `spread` (D, N): those of the `eventpound.mechanics.model.Model`. gaps (K,).
    """
    for p in range(points.size):
        for b in range(values.size):
            gaps[points[p]] += spread[p, b] * values[b]
