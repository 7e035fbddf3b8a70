"""Series of a cluster on links to the ground, and of the hysteretic variable of a link.

A cluster that is tied to no other gets the terms of its motion by itself, from the sums of what its
links put on it, and no more of them than it needs; of others `eventpound.solvers.fast.expansion`.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.elements import INVERSE, begin_curve, next_z, pull_per_z
from eventpound.numerics.arrays import Ints
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.links import DOWN, UP, elongation, link_force, tangent
from eventpound.solvers.fast.run import LINEAR, FastRun, FastSeries

FEWEST = 5
"""Order of a series, at least."""
CONVERGED = 0.5
"""Error of a step, in units of its tolerance, at which no further term is added."""


@compiled
def begin_link(a: int, run: FastRun) -> None:
    """Elongation of a link, its rate, force and tangent at the start of a step."""
    links, state, series = run.plan.links, run.state, run.series
    x, x_rate = elongation(links.ends[a, 0], links.ends[a, 1], state.u, state.v)
    series.x[a], series.x_rate[a] = x, x_rate
    force, z = link_force(a, x, run)
    if links.z_of_link[a] >= 0:
        series.z[links.z_of_link[a], 0] = z
    series.stiffness[a] = tangent(a, links, state)
    series.F[a, 0] = force + links.law.damping[a] * x_rate


@compiled
def on_curve(h: int, part: Ints) -> bool:
    """Whether a hysteretic link is on a curved part of its backbone."""
    return bool(DOWN <= part[h] <= UP)


@compiled
def curve_begins(a: int, h: int, run: FastRun) -> None:
    """Make link a, whose z_0 stands, ready for `curve_coefficient`."""
    series, sign = run.series, 1.0 if run.state.part[h] == UP else -1.0
    memory, z = run.plan.links.law.memory, series.z[h, 0]
    begin_curve(a, memory, sign, z, series.power[h], series.curve[h])


@compiled
def curve_coefficient(h: int, k: int, x: float, s: FastSeries) -> float:
    """Coefficient k of z on a curved part, `x` that of the elongation; those before it stand."""
    return next_z(k, x, s.z[h], s.power[h], s.speed[h], s.weighted[h], s.curve[h])


@compiled
def gather(c: int, run: FastRun) -> None:
    """Force at the start, stiffness and damping of a cluster that goes by itself; links stand."""
    series, damping = run.series, run.plan.links.law.damping
    apart = series.apart
    force, stiffness, drag = 0.0, 0.0, 0.0
    for i in range(apart.links[c], apart.links[c + 1]):
        a = series.active[i]
        force += series.F[a, 0] if series.ends[a, 1] < 0 else -series.F[a, 0]
        stiffness += series.stiffness[a]
        drag += damping[a]
    apart.sums[0, c], apart.sums[1, c], apart.sums[2, c] = force, stiffness, drag


@compiled
def expand_alone(c: int, h: float, most: int, run: FastRun) -> tuple[int, float]:
    """Fill `series.X` for a cluster that goes by itself, of which `gather` has the sums.

    Its velocity stands. Returned are the highest power, beyond which terms are zero, and the error
    of a step of h (s) in units of its tolerance.
    """
    series, links, part, sums = run.series, run.plan.links, run.state.part, run.series.apart.sums
    X, ground, per_mass = series.X[c], series.ground, series.inverse_mass[c]
    stiffness, damping = sums[1, c] * per_mass, sums[2, c] * per_mass
    of_u, of_v, over = series.weights[0, c], series.weights[1, c], 1.0 / h
    a, side, of_z, z = series.apart.hysteretic[c], 1.0, 0.0, -1
    if a != LINEAR and on_curve(links.z_of_link[a], part):
        z = links.z_of_link[a]
        side = 1.0 if series.ends[a, 1] >= 0 else -1.0
        of_z = side * pull_per_z(a, links.law.memory) * per_mass
        curve_begins(a, z, run)
    low, high = X[1], 0.5 * (sums[0, c] * per_mass - ground[0])
    X[2] = high
    order, error, power = most, np.inf, h * h
    for k in range(1, most - 1):
        scale = INVERSE[k + 1] * INVERSE[k + 2]
        pull = ground[k] + low * stiffness
        if z >= 0:
            pull += of_z * curve_coefficient(z, k, side * low, series)
        x = -pull * scale - high * (damping * (INVERSE[k + 2]))
        X[k + 2] = x
        power *= h
        if k + 2 >= FEWEST:
            last = power * max(abs(x), over * abs(high))
            error = last * max(of_u, (k + 2) * over * of_v)
            if error <= CONVERGED:
                order = k + 2
                break
        low, high = high, x
    X[order + 1 : most + 1] = 0.0
    return order, error
