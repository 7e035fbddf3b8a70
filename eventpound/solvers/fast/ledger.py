"""The energy ledger: powers integrated over a step by Gauss's rule, apart from the series."""

from __future__ import annotations

import numpy as np

from eventpound.motion.forcing import ground_acceleration
from eventpound.motion.loads import (
    LOADED,
    body_of,
    heavy_mass,
    is_driven,
    load_value,
    own_mass,
    rows_of,
)
from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.cascade import T
from eventpound.solvers.fast.compiled import compiled_apart, compiled_deferred
from eventpound.solvers.fast.elongation import elongation
from eventpound.solvers.fast.evaluate import look_apart
from eventpound.solvers.fast.run import Piece, Run

NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)
"""Exact for polynomials up to degree 23 (Abramowitz and Stegun, table 25.4)."""


@compiled_deferred
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
        if family == LOADED:
            state.ledger[0] += weight * _power(state.clock[T] + at, g, coefficients, samples, run)
        else:
            for b in range(plan.mass.size):
                state.ledger[0] -= weight * plan.mass[b] * seen.v[b] * g
        for a in range(links.plain):
            first, second = links.ends[a, 0], links.ends[a, 1]
            x_rate = seen.v[second] if second >= 0 else 0.0
            x_rate -= seen.v[first] if first >= 0 else 0.0
            state.ledger[1] += weight * law.damping[a] * x_rate * x_rate
            h = links.z_of_link[a]
            if h >= 0:
                state.ledger[2] += weight * law.strength[a] * seen.z[h] * x_rate


@compiled_apart
def _power(t: float, ground: float, coefficients: Floats, samples: Floats, run: Run) -> float:
    """Power of the ground, of supports and of forces at the time t (s) that is `seen` (W).

    A support gives what moves with it what its acceleration takes, less what links give.
    """
    plan, series, seen = run.plan, run.series, run.seen
    heavy = heavy_mass(coefficients)
    power = 0.0
    for row in range(1, rows_of(coefficients) + 1):
        b = body_of(row, coefficients)
        c, v, mass = series.of_body[b], seen.v[b], own_mass(row, coefficients)
        load = load_value(row, coefficients, samples, t)
        if c < 0:
            continue
        if series.inverse_mass[c] * heavy > 1.0:
            power += v * (load - mass * ground)
        elif not is_driven(row, coefficients):
            # The force of its links, counted once, is what is seen without the load.
            power += v * (mass * (seen.a[b] - ground) + load)
    for b in range(plan.mass.size):
        c = series.of_body[b]
        if c >= 0 and series.inverse_mass[c] * heavy <= 1.0:
            pulled = seen.body_force[b]
            power -= seen.v[b] * (pulled if plan.mass[b] < heavy else _link_force(b, run))
    return power


@compiled_apart
def _link_force(b: int, run: Run) -> float:
    """Force of the links on a body (N), whose load hides it where that drives a support."""
    plan, seen, links, total = run.plan, run.seen, run.plan.links, 0.0
    for a in range(links.offset.size):
        for side, sign in ((0, 1.0), (1, -1.0)):
            if links.ends[a, side] == b:
                first, second = links.ends[a, 0], links.ends[a, 1]
                _, x_rate = elongation(first, second, seen.u, seen.v)
                total += sign * (seen.force[a] + plan.links.law.damping[a] * x_rate)
    return total
