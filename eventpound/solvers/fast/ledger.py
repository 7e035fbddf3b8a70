"""The energy ledger: powers integrated over a step by Gauss's rule, apart from the series."""

from __future__ import annotations

import numpy as np

from eventpound.motion.forcing import ground_acceleration
from eventpound.solvers.events.cascade import T
from eventpound.solvers.fast.compiled import compiled_apart
from eventpound.solvers.fast.evaluate import look_apart
from eventpound.solvers.fast.run import Piece, Run

NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)
"""Exact for polynomials up to degree 23 (Abramowitz and Stegun, table 25.4)."""


@compiled_apart
def add_work(tau: float, order: int, piece: Piece, run: Run) -> None:
    """Add input, viscous and hysteretic work of a step (J) to the ledger; `seen` is overwritten."""
    family, coefficients, samples = piece.family, piece.coefficients, piece.samples
    plan, state, seen = run.plan, run.state, run.seen
    links, law = plan.links, plan.links.law
    for i in range(NODES.size):
        at = 0.5 * tau * (1.0 + NODES[i])
        weight = 0.5 * tau * WEIGHTS[i]
        g = ground_acceleration(family, coefficients, samples, state.clock[T] + at)
        look_apart(at, order, g, run)
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
