"""Taylor series of the motion in one contact mode, hysteresis eliminated, and how far they reach.

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

from eventpound.contact.kinks import still_rate
from eventpound.mechanics.elements import INVERSE, begin_curve, next_z, pull_per_z
from eventpound.mechanics.followers import drive, felt_mass, is_support, row_answer
from eventpound.motion.forcing import GAUSSIAN_STEP, CurrentPiece, ground_taylor
from eventpound.motion.loads import LOADED, add_load_series, shortest_times
from eventpound.numerics.arrays import Floats
from eventpound.solvers.fast.compiled import compiled, compiled_deferred, compiled_noinline
from eventpound.solvers.fast.followed import begin_followed, follow, follows, last_of_followed
from eventpound.solvers.fast.links import (
    CORE,
    DOWN,
    UP,
    elongation,
    link_force,
    reverse,
    saturate,
    tangent,
    with_drag,
)
from eventpound.solvers.fast.run import LOCAL_SHARE, FastRun, FastSeries
from eventpound.solvers.fast.search import distance_coefficient
from eventpound.tolerances import LONGEST_STEP, NO_ERROR, RETRIED

FEWEST = 5
"""Order of a series, at least."""
CONVERGED = 0.5
"""Error of a step, in units of its tolerance, at which no further term is added."""


@compiled
def _begin_link(i: int, run: FastRun) -> None:
    """Put what `expand` needs of the moving link i into one record."""
    plan, state, series = run.plan, run.state, run.series
    link, a, memory = series.moving[i], series.active[i], plan.links.law.memory
    head, tail, ground = series.ends[a, 0], series.ends[a, 1], plan.mass.size
    link.number = a
    # The ground is the row behind all clusters, whose coefficients are zero: no branch in the loop.
    link.head, link.tail = head if head >= 0 else ground, tail if tail >= 0 else ground
    link.stiffness, link.damping, link.curved = series.stiffness[a], plan.links.law.damping[a], -1
    h = plan.links.z_of_link[a]
    # On a curve the stiffness is without z, which the series adds term by term.
    if h >= 0 and DOWN <= state.part[h] <= UP:
        link.curved, link.pull = h, pull_per_z(a, memory)
        sign = 1.0 if state.part[h] == UP else -1.0
        begin_curve(a, memory, sign, series.z[h, 0], series.power[h], series.curve[h])


@compiled
def _curve_coefficient(h: int, k: int, x: float, s: FastSeries) -> float:
    """Coefficient k of z on a curved part, `x` that of the elongation; those before it stand."""
    return next_z(k, x, s.z[h], s.power[h], s.speed[h], s.weighted[h], s.curve[h])


@compiled_deferred
def _add_loads(k: int, mass: Floats, series: FastSeries) -> None:
    """Add coefficient k of the loads on bodies to the forces on clusters."""
    for b in range(mass.size):
        # That of a support, no force, is overwritten with what its cluster does.
        if series.of_body[b] >= 0:
            series.force[series.of_body[b]] += series.load[k, b]


@compiled_noinline
def _answer_coupled(k: int, scale: float, clusters: int, mass: Floats, series: FastSeries) -> None:
    """Coefficient k + 2 of the displacements where clusters follow others, by `series.force`."""
    if series.load.shape[0] > 0:
        drive(series.of_body, mass, series.load[k], series.force)
    for c in range(clusters):
        answer = row_answer(c, clusters, series.compliance, series.force)
        series.X[c, k + 2] = (answer - series.carried[c] * series.ground[k]) * scale
    series.force[:clusters] = 0.0


@compiled_noinline
def drive_clusters(k: int, mass: Floats, series: FastSeries) -> None:
    """Coefficient k + 2 of the displacements of clusters with a support, which is the first."""
    for b in range(mass.size - 1, -1, -1):
        c = series.of_body[b]
        if c >= 0 and is_support(b, mass):
            own = series.load[k, b] - series.ground[k]
            series.X[c, k + 2] = own * INVERSE[k + 1] * INVERSE[k + 2]


@compiled
def expand(h: float, most: int, run: FastRun) -> tuple[int, float]:
    """Fill `series.X` until a step of h (s) needs no further term, or up to the power `most`.

    What `begin_series` makes stands already. Returned are the highest power and the error of the
    step, in units of its tolerance.
    """
    plan, state, series = run.plan, run.state, run.series
    progress = state.progress[0]
    loaded, following = series.load.shape[0] > 0, follows(run)
    coupled = series.free.shape[0] > 0
    X, F, acceleration = series.X, series.F, series.force
    clusters, active = progress.clusters, progress.active
    if following:
        begin_followed(run)
    for i in range(active):
        _begin_link(i, run)
    acceleration[:] = 0.0
    order, error, power, over = most, np.inf, h, 1.0 / h
    for k in range(most - 1):
        for i in range(active):
            link = series.moving[i]
            a, head, tail = link.number, link.head, link.tail
            force = F[a, 0]
            if k > 0:
                # At order zero `begin_series` has the force from the state itself.
                x_k = X[tail, k] - X[head, k]
                rate_k = X[tail, k + 1] - X[head, k + 1]
                force = link.stiffness * x_k + link.damping * (k + 1) * rate_k
                if link.curved >= 0:
                    force += link.pull * _curve_coefficient(link.curved, k, x_k, series)
                F[a, k] = force
            acceleration[head] += force
            acceleration[tail] -= force
        if following:
            follow(k, run)
        if loaded:
            _add_loads(k, plan.mass, series)
        scale = INVERSE[k + 1] * INVERSE[k + 2]
        if coupled:
            _answer_coupled(k, scale, clusters, plan.mass, series)
        else:
            for c in range(clusters):
                X[c, k + 2] = (acceleration[c] * series.inverse_mass[c] - series.ground[k]) * scale
                acceleration[c] = 0.0
        if loaded:
            # After the forces: what is given of a support takes the place of what these make.
            drive_clusters(k, plan.mass, series)
        power *= h
        if k + 2 < FEWEST:
            continue
        order = k + 2
        error = _last_terms(order, power, over, clusters, series)
        # Only where the motion alone would end the series: it takes a look at every link.
        if (following or progress.resting > 0) and (error <= CONVERGED or order == most):
            error = max(error, _last_of_others(order, power * over, over, run))
        if error <= CONVERGED:
            break
    for c in range(clusters):
        X[c, order + 1 : most + 1] = 0.0
    return order, error


@compiled
def _last_terms(order: int, power: float, over: float, clusters: int, series: FastSeries) -> float:
    """The last two terms in units of their tolerance; `power` is h^order, `over` 1/h."""
    X, worst = series.X, 0.0
    of_u, of_v = series.weights[0], series.weights[1]
    for c in range(clusters):
        # A term x_k h^k of u is one of k x_k h^(k-1) in v.
        last = power * max(abs(X[c, order]), over * abs(X[c, order - 1]))
        worst = max(worst, last * max(of_u[c], order * over * of_v[c]))
    return worst


@compiled_noinline
def _last_of_others(order: int, power: float, over: float, run: FastRun) -> float:
    """The same of z that are followed, and of what contacts at rest balance.

    `power` is h^(order - 1). The force of a contact follows them itself, so each counts by the mass
    of the body alone: by that of the cluster it would not count beside a heavy one, and on a
    support, which no force moves, not at all.
    """
    plan, series, of_z = run.plan, run.series, 0.0
    if follows(run):
        of_z = last_of_followed(order, power, over, run)
    if run.state.progress[0].resting == 0:
        return of_z
    ground, limits, links = series.ground, plan.limits, plan.links
    last = power * max(abs(ground[order - 1]), over * abs(ground[order - 2]))
    for b in range(plan.mass.size if series.load.shape[0] > 0 else 0):
        of_load = max(abs(series.load[order - 1, b]), over * abs(series.load[order - 2, b]))
        # A point has no mass of its own.
        last = max(last, power * of_load / felt_mass(b, plan.mass, series.free))
    for i in range(run.state.progress[0].active):
        a = series.active[i]
        of_link = max(abs(series.F[a, order - 2]), over * abs(series.F[a, order - 3]))
        for side in range(2):
            b = links.ends[a, side]
            if b >= 0 and _moves_with_others(b, plan.mass, series):
                felt = felt_mass(b, plan.mass, series.free)
                last = max(last, power * over * of_link / felt)
    return max(of_z, last * limits.time**2 / (LOCAL_SHARE * limits.rtol * limits.length))


@compiled
def _moves_with_others(b: int, mass: Floats, series: FastSeries) -> bool:
    """Whether a body rests on another that is not negligible beside it, or on a barrier.

    In a scene with points any body may.
    """
    c = series.of_body[b]
    alone = series.free.shape[0] == 0 and series.inverse_mass[c] == 1.0 / mass[b]
    return bool(c < 0 or not alone)


@compiled
def _set_weights(run: FastRun) -> None:
    """What errors of u and v of each cluster are multiplied by, for those of its bodies."""
    plan, state, series = run.plan, run.state, run.series
    limits, weights = plan.limits, series.weights
    weights[:] = 0.0
    for b in range(plan.mass.size):
        c = series.of_body[b]
        if c >= 0:
            of_u = LOCAL_SHARE * (limits.atol_u[b] + limits.rtol * abs(state.u[b]))
            of_v = LOCAL_SHARE * (limits.atol_v[b] + limits.rtol * abs(state.v[b]))
            weights[0, c] = max(weights[0, c], 1.0 / of_u)
            weights[1, c] = max(weights[1, c], 1.0 / of_v)


@compiled_deferred
def expand_loads(piece: CurrentPiece, t: float, order: int, series: FastSeries) -> None:
    """Taylor coefficients of the loads on bodies at t (s) into `series.load`."""
    series.load[:] = 0.0
    add_load_series(piece, t, order, series.c, series.load)


@compiled
def begin_series(t: float, piece: CurrentPiece, run: FastRun) -> None:
    """All that `expand` needs at the present instant."""
    plan, state, series = run.plan, run.state, run.series
    ground_taylor(piece, t, plan.limits.order, series.ground)
    if piece.family == LOADED:
        expand_loads(piece, t, plan.limits.order, series)
    for b in range(plan.mass.size):
        c = series.of_body[b]
        if c >= 0:
            series.X[c, 1] = state.v[b]
    links, observed, known = plan.links, run.observed, state.progress[0].known
    for a in range(links.ends.shape[0]):
        x, x_rate = elongation(links.ends[a, 0], links.ends[a, 1], state.u, state.v)
        series.x[a], series.x_rate[a] = x, x_rate
        h = links.z_of_link[a]
        # The step before has ended here, and its end was observed.
        if known:
            z = observed.z[h] if h >= 0 else 0.0
            pull = with_drag(a, observed.force[a], x_rate, links)
        else:
            _, pull, z = link_force(a, x, x_rate, run)
        if h >= 0:
            series.z[h, 0] = z
        series.stiffness[a] = tangent(a, links, state)
        series.F[a, 0] = pull
    saturate(series.x, plan.hysteresis, state)
    _set_weights(run)


@compiled
def wrong_way(order: int, run: FastRun) -> bool:
    """Turn round links whose elongation rate has vanished and grows against their direction."""
    plan, state, series = run.plan, run.state, run.series
    hysteresis = plan.hysteresis
    still = still_rate(plan.limits.length, plan.limits.time)
    turned = False
    for h in range(hysteresis.link.size):
        a = hysteresis.link[h]
        head, tail = series.ends[a, 0], series.ends[a, 1]
        if state.part[h] == CORE or head == tail or abs(series.x_rate[a]) > still:
            continue
        for k in range(2, order + 1):
            x_k = distance_coefficient(head, tail, k, series)
            # The second is half the acceleration, whose rounding has no direction.
            if 2.0 * abs(x_k) > (still / plan.limits.time if k == 2 else 0.0):
                if state.sigma[h] * x_k < 0.0:
                    reverse(h, series.x[a], hysteresis, state)
                    turned = True
                break
    return turned


SINUSOID_STEP = 1.5
"""Longest step under a sinusoid, in its radians."""


@compiled
def defect_error(tau: float, order: int, ground: float, a: Floats, series: FastSeries) -> float:
    """Error of a step in units of its tolerance, from the defect of the equations at its end.

    By the forces there the absolute accelerations are a (N,). A defect that grows like τ^(p-1)
    leaves τ/p of itself in v and τ²/p² in u. That of z which are followed is known by then.
    """
    of_u, of_v = series.weights[0], series.weights[1]
    worst = series.followed.defect[0]
    for b in range(series.of_body.size):
        c = series.of_body[b]
        if c < 0:
            continue
        defect = abs(a[b] - ground - series.expected[c]) * tau / order
        worst = max(worst, defect * of_v[c], defect * tau / order * of_u[c])
    return worst


@compiled
def shortening(error: float, order: int) -> float:
    """Factor by which a step is to be shortened that has too large an error at its end."""
    return max(0.1, 0.9 * error ** (-1.0 / order)) if error < np.inf else 0.1


@compiled
def largest_step_size(limit: float, piece: CurrentPiece, run: FastRun) -> tuple[float, float]:
    """Longest step (s), `limit` at most, and the length that the series are made for."""
    gaussian, sinusoid, sampled = shortest_times(piece.family, piece.coefficients)
    longest = min(limit, GAUSSIAN_STEP * gaussian, SINUSOID_STEP * sinusoid)
    if not longest < np.inf:
        longest = run.plan.limits.time * LONGEST_STEP
    # To the next sample a further term costs less than a further step.
    return longest, longest if sampled else min(longest, 2.0 * run.state.progress[0].trial)


@compiled
def choose_step_size(tried: float, order: int, error: float, longest: float) -> float:
    """Length of a step (s), for which the series of this order were `tried` with this error."""
    if error > 1.0:
        # The lower of the two terms decides; half the tolerance is aimed at.
        shrunk = tried * (0.5 / error) ** (1.0 / (order - 1))
        return shrunk if error < np.inf else RETRIED * tried
    if tried < longest and error < 0.5:
        grown = tried * min(10.0, (0.5 / max(error, NO_ERROR)) ** (1.0 / (order - 1)))
        return min(longest, grown)
    return tried
