"""The energy ledger: powers integrated over a step by Gauss's rule, apart from the series."""

from __future__ import annotations

import numpy as np

from eventpound.motion.forcing import ground_acceleration
from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.cascade import T
from eventpound.solvers.fast.compiled import compiled_apart
from eventpound.solvers.fast.plan import Plan, Series, State
from eventpound.solvers.fast.seen import Seen, look_apart

NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)
"""Exact for polynomials up to degree 23 (Abramowitz and Stegun, table 25.4)."""


@compiled_apart
def add_work(
    tau: float,
    order: int,
    family: int,
    coefficients: Floats,
    samples: Floats,
    plan: Plan,
    state: State,
    series: Series,
    seen: Seen,
) -> None:
    """Add input, viscous and hysteretic work of a step (J) to the ledger; `seen` is overwritten."""
    links, law = plan.links, plan.links.law
    for i in range(NODES.size):
        at = 0.5 * tau * (1.0 + NODES[i])
        weight = 0.5 * tau * WEIGHTS[i]
        g = ground_acceleration(family, coefficients, samples, state.clock[T] + at)
        look_apart(at, order, g, plan, state, series, seen)
        for b in range(plan.mass.size):
            state.ledger[0] -= weight * plan.mass[b] * seen.v[b] * g
        for a in range(links.offset.size):
            first, second = links.ends[a, 0], links.ends[a, 1]
            x_rate = seen.v[second] if second >= 0 else 0.0
            x_rate -= seen.v[first] if first >= 0 else 0.0
            state.ledger[1] += weight * law.damping[a] * x_rate * x_rate
            h = links.z_of_link[a]
            if h >= 0:
                state.ledger[2] += weight * law.strength[a] * seen.z[h] * x_rate
