"""Series of a cluster on links to the ground, and of the hysteretic variable of a link.

A cluster that is tied to no other gets the terms of its motion by itself, from the sums of what its
links put on it, and no more of them than it needs; of others `eventpound.solvers.fast.expansion`.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.backbone import integer_power
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.links import DOWN, UNLOADING, UP, elongation, link_force
from eventpound.solvers.fast.run import CURVE_PLACES, LINEAR, Links, Run, Series, State

FEWEST = 5
"""Order of a series, at least."""
CONVERGED = 0.5
"""Error of a step, in units of its tolerance, at which no further term is added."""
MOST_TERMS = 32
"""More than the highest order and two."""
(OVER_UY, OVER_Z, LIFT, KAPPA, WEIGHT) = range(CURVE_PLACES)
"""Places in a row of `Series.curve`: 1/u_y, 1/z_0, n P_0/z_0, κ and n + 1."""
INVERSE = np.array([0.0] + [1.0 / k for k in range(1, MOST_TERMS)])
"""1/k."""


@compiled
def begin_link(a: int, run: Run) -> None:
    """Elongation of a link, its rate, force and tangent at the start of a step."""
    links, state, series = run.plan.links, run.state, run.series
    x, x_rate = elongation(links.ends[a, 0], links.ends[a, 1], state.u, state.v)
    series.x[a], series.x_rate[a] = x, x_rate
    force, z = link_force(a, x, run)
    k = links.compression[a] if state.branch[a] < 0 else links.extension[a]
    h = links.z_of_link[a]
    if h >= 0:
        series.z[h, 0] = z
        if state.part[h] <= UNLOADING:
            k += links.law.strength[a] / links.law.yield_displacement[a]
    series.stiffness[a] = k
    series.F[a, 0] = force + links.law.damping[a] * x_rate


@compiled
def begin_curve(a: int, h: int, links: Links, state: State, series: Series) -> None:
    """Make a link on a curved part of its backbone ready for `next_z`; z_0 stands."""
    law, z = links.law, series.z[h, 0]
    n = law.exponent[a]
    power = integer_power(abs(z), n)
    series.power[h, 0] = power
    curve = series.curve[h]
    curve[OVER_UY], curve[OVER_Z] = 1.0 / law.yield_displacement[a], 1.0 / z
    curve[LIFT] = n * power * curve[OVER_Z]
    sign = 1.0 if state.part[h] == UP else -1.0
    curve[KAPPA] = law.beta[a] + sign * law.gamma[a]
    curve[WEIGHT] = n + 1.0


@compiled
def next_z(h: int, k: int, x: float, series: Series) -> float:
    """Coefficient k of z on a curved part, `x` that of the elongation; the links before it stand.

    ``k z_k = s_{k-1} - κ Σ s_i P_{k-1-i}`` with ``s = x'/u_y``, and of P, from ``n z' P = z P'``,
    ``z_0 m P_m = Σ ((n + 1) i - m) z_i P_{m-i}``. What came last is waited for, so its terms
    are added last, and each sum is made in two halves.
    """
    z, power, speed, weighted = series.z[h], series.power[h], series.speed[h], series.weighted[h]
    curve, m = series.curve[h], k - 1
    kappa, first = curve[KAPPA], speed[0]
    latest = k * curve[OVER_UY] * x
    speed[m] = latest
    if m == 0:
        value = latest * (1.0 - kappa * power[0])
    else:
        low, high, flow, later = 0.0, 0.0, 0.0, 0.0
        if m % 2 == 0:
            i = m // 2
            low = speed[i] * power[i]
            flow = (weighted[i] - m * z[i]) * power[i]
        for i in range((m - 1) // 2, 0, -1):
            j = m - i
            low += speed[i] * power[j]
            high += speed[j] * power[i]
            flow += (weighted[i] - m * z[i]) * power[j]
            later += (weighted[j] - m * z[j]) * power[i]
        power[m] = (flow + later) * (curve[OVER_Z] * INVERSE[m]) + curve[LIFT] * z[m]
        product = latest * power[0] + (low + high)
        value = ((latest - kappa * product) - kappa * first * power[m]) * INVERSE[k]
    z[k], weighted[k] = value, curve[WEIGHT] * k * value
    return float(value)


@compiled
def gather(c: int, run: Run) -> None:
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
def expand_alone(c: int, h: float, most: int, run: Run) -> tuple[int, float]:
    """Fill `series.X` for a cluster that goes by itself, of which `gather` has the sums.

    Its velocity stands. Returned are the highest power, beyond which terms are zero, and the error
    of a step of h (s) in units of its tolerance.
    """
    series, links, part, sums = run.series, run.plan.links, run.state.part, run.series.apart.sums
    X, ground, per_mass = series.X[c], series.ground, series.inverse_mass[c]
    stiffness, damping = sums[1, c] * per_mass, sums[2, c] * per_mass
    of_u, of_v, over = series.weights[0, c], series.weights[1, c], 1.0 / h
    a, side, strength, z = series.apart.hysteretic[c], 1.0, 0.0, -1
    if a != LINEAR and DOWN <= part[links.z_of_link[a]] <= UP:
        z = links.z_of_link[a]
        side = 1.0 if series.ends[a, 1] >= 0 else -1.0
        strength = side * links.law.strength[a] * per_mass
        begin_curve(a, z, links, run.state, series)
    low, high = X[1], 0.5 * (sums[0, c] * per_mass - ground[0])
    X[2] = high
    order, error, power = most, np.inf, h * h
    for k in range(1, most - 1):
        scale = INVERSE[k + 1] * INVERSE[k + 2]
        pull = ground[k] + low * stiffness
        if z >= 0:
            pull += strength * next_z(z, k, side * low, series)
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
