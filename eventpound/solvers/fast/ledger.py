"""The energy ledger: powers integrated over a step by Gauss's rule, apart from the series."""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.model import WORK_OF_SUPPORTS
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
            _add_loaded(state.clock[T] + at, weight, g, coefficients, samples, run)
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
def _add_loaded(
    t: float, weight: float, ground: float, coefficients: Floats, samples: Floats, run: Run
) -> None:
    """Add `weight` (s) times the powers at the time t (s) that is `seen` (W) to the ledger.

    Of the ground and of forces; and of supports, each of which gives what moves with it what that
    takes, less what links and forces give.
    """
    plan, series, seen, ledger = run.plan, run.series, run.seen, run.state.ledger
    heavy = heavy_mass(coefficients)
    for row in range(1, rows_of(coefficients) + 1):
        b = body_of(row, coefficients)
        if is_driven(row, coefficients) or series.of_body[b] < 0:
            continue
        load = load_value(row, coefficients, samples, t)
        push = load - own_mass(row, coefficients) * ground
        ledger[0] += weight * seen.v[b] * push
    for k in range(ledger.size - WORK_OF_SUPPORTS):
        c, taken = series.of_body[k], -_link_force(k, run)
        for b in range(plan.mass.size):
            if series.of_body[b] == c and plan.mass[b] < heavy:
                taken += plan.mass[b] * seen.a[b] - seen.body_force[b]
        ledger[WORK_OF_SUPPORTS + k] += weight * seen.v[k] * taken


@compiled_apart
def _link_force(b: int, run: Run) -> float:
    """Force of the links on a body (N), whose load hides it where that drives a support."""
    plan, seen, links, total = run.plan, run.seen, run.plan.links, 0.0
    for a in range(links.offset.size):
        for side, sign in ((0, 1.0), (1, -1.0)):
            if links.ends[a, side] == b:
                first, second = links.ends[a, 0], links.ends[a, 1]
                _, x_rate = elongation(first, second, seen.u, seen.v)
                # The force of a contact element is whole.
                damping = plan.links.law.damping[a] if a < links.plain else 0.0
                total += sign * (seen.force[a] + damping * x_rate)
    return total
