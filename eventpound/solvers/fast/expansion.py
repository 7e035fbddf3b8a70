"""Taylor series of the motion in one contact mode, hysteresis eliminated.

With the displacement of a cluster ``q(τ) = Σ_k X_k τ^k`` and the force of a
link ``F(τ) = Σ_k F_k τ^k``,

    X_{k+2} = (Σ ± F_k / m - g_k) / ((k + 1) (k + 2)),
    F_k = K x_k + c (k + 1) x_{k+1} + Q z_k,

where K includes Q/u_y while z is linear in x and z_k is wanted only on the
curved parts of the backbone: ``z' = (x'/u_y)(1 - κ P)``, ``P = |z|^n``. There
``z_0 = σ b Φ(ξ)``, so z carries no error from step to step.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.backbone import integer_power
from eventpound.motion.forcing import ground_taylor
from eventpound.solvers.events import noise
from eventpound.solvers.fast.backbone_parts import (
    CORE,
    DOWN,
    UNLOADING,
    UP,
    hysteretic_variable,
    reverse,
    saturate,
)
from eventpound.solvers.fast.compiled import compiled
from eventpound.solvers.fast.elongation import elongation
from eventpound.solvers.fast.run import (
    ACTIVE,
    CLUSTERS,
    CURVE_PLACES,
    EXPANSIONS,
    Hysteresis,
    Links,
    Piece,
    Run,
    Series,
    State,
)

MOST_TERMS = 32
"""More than the highest order and two."""
(OVER_UY, OVER_Z, LIFT, KAPPA, WEIGHT) = range(CURVE_PLACES)
"""Places in a row of `Series.curve`: 1/u_y, 1/z_0, n P_0/z_0, κ and n + 1."""
INVERSE = np.array([0.0] + [1.0 / k for k in range(1, MOST_TERMS)])
"""1/k."""


@compiled
def link_state(links: Links, hysteresis: Hysteresis, state: State, series: Series) -> None:
    """Elongations, their rates and the forces of all links at the start of a step."""
    for a in range(links.offset.size):
        first, second = links.ends[a, 0], links.ends[a, 1]
        x, x_rate = elongation(first, second, state.u, state.v)
        series.x[a], series.x_rate[a] = x, x_rate
        k = links.compression[a] if state.branch[a] < 0 else links.extension[a]
        force = k * (x - links.offset[a]) + links.law.damping[a] * x_rate
        h = links.z_of_link[a]
        if h >= 0:
            z = hysteretic_variable(h, x, hysteresis, state)
            force += links.law.strength[a] * z
            series.z[h, 0] = z
            if state.part[h] <= UNLOADING:
                k += links.law.strength[a] / links.law.yield_displacement[a]
        series.stiffness[a] = k
        series.F[a, 0] = force


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
    are added last.
    """
    z, power, speed, weighted = series.z[h], series.power[h], series.speed[h], series.weighted[h]
    curve, m = series.curve[h], k - 1
    kappa, first = curve[KAPPA], speed[0]
    latest = k * curve[OVER_UY] * x
    speed[m] = latest
    if m == 0:
        value = latest * (1.0 - kappa * power[0])
    else:
        product, flow = latest * power[0], 0.0
        for i in range(1, m):
            p = power[m - i]
            product += speed[i] * p
            flow += (weighted[i] - m * z[i]) * p
        power[m] = flow * (curve[OVER_Z] * INVERSE[m]) + curve[LIFT] * z[m]
        value = ((latest - kappa * product) - kappa * first * power[m]) * INVERSE[k]
    z[k], weighted[k] = value, curve[WEIGHT] * k * value
    return float(value)


@compiled
def expand(
    known: int, order: int, links: Links, hysteresis: Hysteresis, state: State, series: Series
) -> None:
    """Fill `series.X` up to `order`; `link_state` and `series.ground` stand already.

    Parameters
    ----------
    known, order : int
        Powers of the displacement whose coefficients stand, 1 at first, and are wanted.
    links, hysteresis, state, series
        See `eventpound.solvers.fast.run`.
    """
    X, F, acceleration = series.X, series.F, series.force
    clusters, active = state.count[CLUSTERS], state.count[ACTIVE]
    law = links.law
    for i in range(active):
        a = series.active[i]
        h = links.z_of_link[a]
        if known == 1 and h >= 0 and DOWN <= state.part[h] <= UP:
            begin_curve(a, h, links, state, series)
    for k in range(known - 1, order - 1):
        acceleration[:clusters] = 0.0
        for i in range(active):
            a = series.active[i]
            first, second = series.ends[a, 0], series.ends[a, 1]
            if k > 0:
                x_k, rate_k = 0.0, 0.0
                if second >= 0:
                    x_k, rate_k = X[second, k], X[second, k + 1]
                if first >= 0:
                    x_k, rate_k = x_k - X[first, k], rate_k - X[first, k + 1]
                force = series.stiffness[a] * x_k + law.damping[a] * (k + 1) * rate_k
                h = links.z_of_link[a]
                if h >= 0 and DOWN <= state.part[h] <= UP:
                    force += law.strength[a] * next_z(h, k, x_k, series)
                F[a, k] = force
            if first >= 0:
                acceleration[first] += F[a, k]
            if second >= 0:
                acceleration[second] -= F[a, k]
        scale = INVERSE[k + 1] * INVERSE[k + 2]
        for c in range(clusters):
            X[c, k + 2] = (acceleration[c] * series.inverse_mass[c] - series.ground[k]) * scale


@compiled
def motion_at(b: int, tau: float, order: int, state: State, series: Series) -> tuple[float, float]:
    """Displacement (m) and velocity (m/s) of a body at the local time tau (s)."""
    c = series.of_body[b]
    if c < 0:
        return state.u[b], 0.0
    X = series.X
    change, rate = X[c, order], 0.0
    for k in range(order - 1, 0, -1):
        rate = rate * tau + change
        change = change * tau + X[c, k]
    rate = rate * tau + change
    return state.u[b] + change * tau, rate


@compiled
def acceleration_at(c: int, tau: float, order: int, series: Series) -> float:
    """Relative acceleration of a cluster from its series (m/s²)."""
    X = series.X
    value = order * (order - 1) * X[c, order]
    for k in range(order - 1, 1, -1):
        value = value * tau + k * (k - 1) * X[c, k]
    return float(value)


@compiled
def expand_all(t: float, order: int, piece: Piece, run: Run) -> None:
    """Taylor series of everything at the present instant."""
    family, coefficients, samples = piece.family, piece.coefficients, piece.samples
    plan, state, series = run.plan, run.state, run.series
    ground_taylor(family, coefficients, samples, t, order, series.ground)
    for b in range(plan.mass.size):
        c = series.of_body[b]
        if c >= 0:
            series.X[c, 1] = state.v[b]
    link_state(plan.links, plan.hysteresis, state, series)
    saturate(series.x, plan.hysteresis, state)
    expand(1, order, plan.links, plan.hysteresis, state, series)
    state.count[EXPANSIONS] += 1


@compiled
def wrong_way(order: int, run: Run) -> bool:
    """Turn round links whose elongation rate has vanished and grows against their direction."""
    plan, state, series = run.plan, run.state, run.series
    hysteresis = plan.hysteresis
    still = noise.SPEED * plan.limits.length / plan.limits.time
    turned = False
    for h in range(hysteresis.link.size):
        a = hysteresis.link[h]
        head, tail = series.ends[a, 0], series.ends[a, 1]
        if state.part[h] == CORE or head == tail or abs(series.x_rate[a]) > still:
            continue
        for k in range(2, order + 1):
            x_k = series.X[tail, k] if tail >= 0 else 0.0
            x_k -= series.X[head, k] if head >= 0 else 0.0
            if 2.0 * abs(x_k) > (still / plan.limits.time if k == 2 else 0.0):
                if state.sigma[h] * x_k < 0.0:
                    reverse(h, series.x[a], hysteresis, state)
                    turned = True
                break
    return turned
