"""Everything known at one local time of a step: motion, forces, gaps, contact forces."""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.followers import (
    acceleration_of,
    drive,
    force_or_given,
    own_mass,
    place_points,
    row_answer,
)
from eventpound.motion.loads import add_body_loads
from eventpound.numerics.arrays import Floats
from eventpound.numerics.by_address import by_address
from eventpound.numerics.small_systems import dot
from eventpound.solvers.fast.compiled import compiled, compiled_deferred, compiled_noinline
from eventpound.solvers.fast.followed import follows, observe_followed
from eventpound.solvers.fast.links import add_pull, elongation, gap_of, link_force
from eventpound.solvers.fast.run import FastObserved, FastPlan, FastRun, piece_of
from eventpound.solvers.fast.search import gap_polynomial, motion
from eventpound.solvers.fast.sliding import any_slider, observe_slider_forces
from eventpound.tolerances import OWN_GAP


def blank_fast_observed(plan: FastPlan) -> FastObserved:
    """Empty arrays to fill."""
    bodies, links = plan.mass.shape[-1], plan.links.ends.shape[0]
    hysteretic, contacts = plan.hysteresis.link.size, plan.contacts.left.size
    sizes = (*(bodies,) * 3, hysteretic, links, bodies, *(contacts,) * 3, 2)
    return FastObserved(*(np.zeros(size) for size in sizes))


@compiled
def observe_at(tau: float, order: int, ground: float, run: FastRun) -> None:
    """Fill `observed` at the local time tau (s), the ground acceleration given (m/s²)."""
    plan, state, series, observed = run.plan, run.state, run.series, run.observed
    for b in range(plan.mass.size):
        c = series.of_body[b]
        observed.u[b], observed.v[b] = state.u[b], state.v[b]
        if c < 0:
            observed.v[b] = 0.0
        # At the start itself the state stays what it is, to the last bit.
        elif tau > 0.0:
            change, observed.v[b], series.expected[c] = motion(tau, order, series.X[c])
            observed.u[b] += change
    place_points(plan.contacts.weights, observed.u)
    place_points(plan.contacts.weights, observed.v)
    _link_forces(ground, run)
    if tau > 0.0 and follows(run):
        observe_followed(tau, order, run)
    if series.load.shape[0] > 0:
        _add_loads(tau, run)
    _accelerations(run)
    _gaps(tau, order, run)
    if state.progress[0].resting > 0:
        _contact_forces(run)
        if any_slider(run):
            observe_slider_forces(run)
    else:
        observed.contact_force[:] = 0.0


@compiled
def _link_forces(ground: float, run: FastRun) -> None:
    """Fill `observed` with z and the forces of the links at its displacements and velocities."""
    plan, observed = run.plan, run.observed
    observed.base[0] = ground
    links = plan.links
    observed.body_force[:] = 0.0
    observed.base[1] = 0.0
    for a in range(links.ends.shape[0]):
        x, x_rate = elongation(links.ends[a, 0], links.ends[a, 1], observed.u, observed.v)
        observed.force[a], pull, z = link_force(a, x, x_rate, run)
        if links.z_of_link[a] >= 0:
            observed.z[links.z_of_link[a]] = z
        add_pull(a, pull, links, observed)


@compiled_deferred
def _add_loads(tau: float, run: FastRun) -> None:
    """Add the loads of the present piece to `body_force`; those of supports are their `a`."""
    piece = by_address(piece_of(run.state.progress[0].piece, run.plan.ground))
    add_body_loads(piece, run.state.now[0].t + tau, run.observed.body_force, run.observed.a)


@compiled
def _accelerations(run: FastRun) -> None:
    plan, state, series, observed = run.plan, run.state, run.series, run.observed
    if state.progress[0].resting == 0 and series.free.shape[0] == 0:
        for b in range(plan.mass.size):
            # Those of supports `_add_loads` has put there.
            applied = force_or_given(b, observed.body_force[b], observed.a[b], plan.mass)
            observed.a[b] = acceleration_of(b, applied, plan.mass)
        return
    total = series.force
    total[:] = 0.0
    if series.free.shape[0] > 0:
        _answer_coupled(run)
        return
    for b in range(plan.mass.size):
        c = series.of_body[b]
        if c >= 0:
            total[c] += observed.body_force[b] * series.inverse_mass[c]
    drive(series.of_body, plan.mass, observed.a, total)
    for b in range(plan.mass.size):
        c = series.of_body[b]
        observed.a[b] = total[c] if c >= 0 else observed.base[0]


@compiled_deferred
def _answer_coupled(run: FastRun) -> None:
    """Absolute accelerations where clusters follow others; `series.force` is zero."""
    series, observed, clusters = run.series, run.observed, run.state.progress[0].clusters
    ground = observed.base[0]
    for b in range(observed.a.size):
        c = series.of_body[b]
        if c >= 0:
            series.force[c] += observed.body_force[b]
    drive(series.of_body, run.plan.mass, observed.a, series.force)
    for b in range(observed.a.size):
        c = series.of_body[b]
        observed.a[b] = ground
        if c >= 0:
            answer = row_answer(c, clusters, series.compliance, series.force)
            observed.a[b] = (1.0 - series.carried[c]) * ground + answer


@compiled
def _gaps(tau: float, order: int, run: FastRun) -> None:
    """Gaps by their own variables where they are small, else by the displacements."""
    plan, state, series, observed = run.plan, run.state, run.series, run.observed
    contacts = plan.contacts
    for j in range(contacts.gap.size):
        if state.resting[j]:
            observed.gap[j] = observed.gap_rate[j] = 0.0
            continue
        if tau == 0.0 or state.gap[j] == np.inf:
            observed.gap[j], observed.gap_rate[j] = state.gap[j], state.gap_rate[j]
            continue
        gap, rate = gap_of(j, contacts, observed.u, observed.v)
        # A difference of displacements has their rounding, which is much beside a small gap.
        if gap < OWN_GAP * plan.limits.length:
            gap_polynomial(j, order, run)
            c = series.c
            gap, rate = c[order], 0.0
            for k in range(order - 1, -1, -1):
                rate = rate * tau + gap
                gap = gap * tau + c[k]
        observed.gap[j], observed.gap_rate[j] = gap, rate


@compiled
def _contact_forces(run: FastRun) -> None:
    """λ of the resting contacts from ``W λ = m (u'' + a_g) - f``, in which supports are roots."""
    plan, series, observed = run.plan, run.series, run.observed
    observed.contact_force[:] = 0.0
    for b in range(plan.mass.size):
        series.force[b] = own_mass(b, plan.mass) * observed.a[b] - observed.body_force[b]
    spread_forces(observed.contact_force, run)


@compiled
def spread_forces(out: Floats, run: FastRun) -> None:
    """Contact forces that put `series.force` (N,) on the bodies; it is overwritten."""
    series, residual = run.series, run.series.force
    for i in range(run.state.progress[0].resting if series.free.shape[0] > 0 else 0):
        out[series.resting[i]] = dot(series.force_map[i], residual)
    if series.free.shape[0] > 0:
        return
    for i in range(run.state.progress[0].edges):
        # Leaves first: what a body lacks its contact gives, and the body behind bears it.
        b, parent = series.elimination[i, 0], series.elimination[i, 2]
        out[series.elimination[i, 1]] = series.elimination[i, 3] * residual[b]
        if parent >= 0:
            residual[parent] += residual[b]


@compiled_noinline
def observe_at_noinline(tau: float, order: int, ground: float, run: FastRun) -> None:
    """As `observe_at`, where it is not part of every step."""
    observe_at(tau, order, ground, run)


@compiled_deferred
def contact_force_series(order: int, run: FastRun) -> None:
    """Taylor coefficients of the forces of resting contacts."""
    plan, series = run.plan, run.series
    mass, ends, residual = plan.mass, plan.links.ends, series.force
    for k in range(order - 1):
        for b in range(mass.size):
            c, m = series.of_body[b], own_mass(b, mass)
            residual[b] = m * series.ground[k]
            if c >= 0:
                residual[b] += m * (k + 1) * (k + 2) * series.X[c, k + 2]
        for a in range(ends.shape[0]):
            # A link within a cluster does not change.
            if k > 0 and series.ends[a, 0] == series.ends[a, 1]:
                continue
            if ends[a, 0] >= 0:
                residual[ends[a, 0]] -= series.F[a, k]
            if ends[a, 1] >= 0:
                residual[ends[a, 1]] += series.F[a, k]
        for b in range(mass.size if series.load.shape[0] > 0 else 0):
            # Of supports they are no forces; these are roots, where nothing has to balance.
            residual[b] -= series.load[k, b]
        spread_forces(series.contact_force[:, k], run)
