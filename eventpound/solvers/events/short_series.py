"""Short steps by Taylor series: what follows an event before the integrator restarts.

After an event the motion is expanded in local time. Gaps and their rates are
variables of their own, set to exact zeros at each impact, so that cascades of
impacts whose intervals shrink far below the rounding of t and u keep their
relative accuracy down to their limit.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.contact.kinks import still_rate
from eventpound.contact.rest import closing_time, is_none
from eventpound.contact.rounding import acceleration_noise
from eventpound.mechanics.contact_elements import FIRST_CODE
from eventpound.mechanics.contact_laws import element_exponents, element_pull
from eventpound.mechanics.elements import bends_at_zero, z_bend
from eventpound.mechanics.followers import on_body
from eventpound.mechanics.observables import Bodies
from eventpound.mechanics.reduced import Forcing, Reduced, link_motion, motion_rate
from eventpound.mechanics.series import evaluate_series, motion_series
from eventpound.motion.forcing import ground_acceleration, ground_taylor
from eventpound.motion.loads import LOADED, body_of, is_driven, load_taylor, rows_of
from eventpound.numerics.arrays import Bools, Floats
from eventpound.numerics.compiled import deferred_kernel, kernel, scalar_kernel
from eventpound.numerics.polynomial import first_root, root_work
from eventpound.solvers.events.dense import Dense
from eventpound.solvers.events.run import Dynamics, Run, State
from eventpound.tolerances import (
    ACCELERATION,
    GAP_COEFFICIENT,
    GROUND_ERROR,
    NO_POWER,
    SAME_INSTANT,
    SERIES_DEFECT,
    SERIES_SHARE,
)

ORDER = 12
"""Highest power of the local series."""
MOST_HALVINGS = 200
"""Of a length of a series, until it is a good one."""


@scalar_kernel
def _with_rounding(level: float, k: int, own: float, ground: float, acceleration: float) -> float:
    """The rounding `level` of coefficient k of a gap, with that of a body's `own`."""
    if k > 2:
        return level + GAP_COEFFICIENT * abs(own)
    return max(level, 0.5 * acceleration_noise(2.0 * own + ground, acceleration))


@kernel
def gap_series(
    Y: Floats,
    system: Reduced,
    bodies: Bodies,
    state: State,
    ground: float,
    acceleration: float,
    time: float,
) -> Floats:
    """Taylor coefficients of the gaps, shape (K, order + 1).

    The first two are the gaps' own variables, the others differences of the
    bodies'. A gap that opens goes on with the first coefficient that
    differs from the rounding of the bodies' own: for accelerations that of the acceleration
    problem, under the `ground`'s own and with the least that counts (m/s²). `time`: T (s).
    """
    order, gap, gap_rate = Y.shape[0] - 1, state.gap, state.gap_rate
    of_body = bodies.of_body
    C, level = np.zeros((gap.size, order + 1)), np.zeros((gap.size, order + 1))
    for j in range(gap.size):
        # One that rounding has put below zero, and that opens as if by rounding, may close at once.
        C[j, 0], C[j, 1] = max(gap[j], 0.0), gap_rate[j]
        for k in range(2, order + 1):
            for body, sign in ((bodies.right[j], 1.0), (bodies.left[j], -1.0)):
                if body < 0 or of_body[body] < 0:
                    continue
                own = Y[k, system.iq[of_body[body]]]
                C[j, k] += sign * own
                level[j, k] = _with_rounding(level[j, k], k, own, ground, acceleration)
                for b in range(of_body.size if bodies.weights.shape[0] > 0 else 0):
                    # What a point has errs as the bodies that it is a sum of.
                    if on_body(body, b, bodies.weights) and of_body[b] >= 0:
                        own = Y[k, system.iq[of_body[b]]]
                        level[j, k] = _with_rounding(level[j, k], k, own, ground, acceleration)
    for j in range(gap.size):
        none = gap_rate[j] > 0.0 or (gap[j] == 0.0 and gap_rate[j] == 0.0)
        for k in range(2, order + 1):
            none = none and is_none(k, C[j, k], level[j, k], gap_rate[j], time)
            if none:
                C[j, k] = 0.0
    return C


@kernel
def first_closings(C: Floats, open_contacts: Bools, limit: float) -> tuple[float, Bools]:
    """Time of the first closing within `limit` (s), or inf, and which contacts close then."""
    times = np.full(C.shape[0], np.inf)
    work = root_work(C.shape[1])
    for j in range(C.shape[0]):
        if open_contacts[j]:
            times[j] = closing_time(C[j], C.shape[1], limit, work)
    first = np.inf
    for j in range(times.size):
        first = min(first, times[j])
    closing = np.zeros(times.size, np.bool_)
    for j in range(times.size):
        closing[j] = times[j] <= first * (1.0 + SAME_INSTANT)
    return first, closing


@scalar_kernel
def _radius(c: Floats, allowed: float) -> float:
    """Time over which the last two terms of a series stay below what is allowed."""
    radius = np.inf
    # Two, since every other term of a series may be zero.
    for k in (c.size - 2, c.size - 1):
        if c[k] != 0.0:
            radius = min(radius, (allowed / abs(c[k])) ** (1.0 / k))
    return radius


@kernel
def _series_radius(Y: Floats, weight: Floats) -> float:
    """Time over which the last two terms stay below a share of the tolerance."""
    radius = np.inf
    for s in range(Y.shape[1]):
        radius = min(radius, _radius(Y[:, s], SERIES_SHARE * weight[s]))
    return radius


@deferred_kernel
def _closing_radius(y: Floats, system: Reduced, weight: Floats, radius: float) -> float:
    """`radius`, halved until contact elements that have only just closed do nothing within it.

    Their forces are no power series in time from there on, and the local series has none
    (`eventpound.numerics.power_series.power_coefficient`).
    """
    for a in range(system.plain, system.stiffness.size):
        k, preload, damping = system.stiffness[a], system.preload[a], system.damping[a]
        if system.iz[a] >= -1 or k == 0.0:
            continue
        x, x_rate = link_motion(a, y, system)
        exponent = element_exponents(FIRST_CODE - system.iz[a], True)[0]
        known = exponent == 1.0 or max(0.0, -x - preload / k) ** exponent >= NO_POWER
        if known or x_rate >= 0.0:
            continue
        for _ in range(MOST_HALVINGS):
            then = x + x_rate * radius
            force = abs(element_pull(system.iz[a], k, preload, damping, then, x_rate, 0.0)[0])
            nothing = True
            for c in system.ends[a]:
                if c >= 0:
                    change = force * radius / system.mass[c]
                    nothing = nothing and change <= SERIES_SHARE * weight[system.iv[c]]
            if nothing:
                break
            radius *= 0.5
    return radius


@kernel
def _ground_radius(forcing: Forcing, bodies_mass: Floats, acceleration: float) -> float:
    """Time over which the series of ground and loads hold to `acceleration` (m/s²)."""
    out = np.zeros(ORDER + 1)
    ground_taylor(forcing, forcing.start, ORDER + 1, out)
    radius = _radius(out, acceleration)
    if forcing.family != LOADED:
        return radius
    for row in range(1, rows_of(forcing.coefficients) + 1):
        load_taylor(row, forcing, forcing.start, ORDER + 1, out)
        driven = is_driven(row, forcing.coefficients)
        # The load of a support is an acceleration, and allowed as such.
        mass = 1.0 if driven else bodies_mass[body_of(row, forcing.coefficients)]
        radius = min(radius, _radius(out, acceleration * mass))
    return radius


@kernel
def _first_reversal(Y: Floats, system: Reduced, weight: Floats, limit: float) -> float:
    """First reversal of a hysteretic link, or zero of its z, that the series may not cross."""
    order = Y.shape[0] - 1
    first = limit
    for a in range(system.iz.size):
        iz = system.iz[a]
        if iz < 0:
            continue
        x_rate = np.zeros(order)
        for k in range(order):
            x_rate[k] = link_motion(a, Y[k], system)[1]
        travel = 0.0
        for k in range(order):
            travel += abs(x_rate[k]) * first ** (k + 1) / (k + 1)
        bend = z_bend(a, system.memory, Y[0, iz], Y[0, system.beside[a]], travel)
        # A z that is a line to within the tolerance is not bent by a reversal either.
        if bend <= SERIES_SHARE * weight[iz]:
            continue
        first = min(first, _sign_change(x_rate, first))
        if bends_at_zero(a, system.memory):
            first = min(first, _sign_change(Y[:, iz].copy(), first))
    return first


@kernel
def _sign_change(c: Floats, limit: float) -> float:
    start = 0
    while start < c.size and c[start] == 0.0:
        start += 1
    if start == c.size:
        return np.inf
    return first_root(c if c[start] > 0.0 else -c, c.size, limit, root_work(c.size))


@kernel
def _trusted(Y: Floats, system: Reduced, forcing: Forcing, weight: Floats, end: float) -> float:
    """`end`, halved until the series satisfies the equations of motion there and midway.

    The last coefficients alone do not show a yielding to come: |z|^n with
    n = 20 starts like a power of τ far beyond the order of the series. The end
    alone does not show it where x' and so z' vanish there, at a reversal.
    """
    actual = np.empty(system.size)
    for _ in range(MOST_HALVINGS):
        good = True
        for tau in (0.5 * end, end):
            state, rate = evaluate_series(Y, tau)
            motion_rate(tau, state, actual, system, forcing)
            for s in range(system.size):
                good = good and abs(rate[s] - actual[s]) * end <= SERIES_DEFECT * weight[s]
        if good:
            return end
        end *= 0.5
    return end


@scalar_kernel
def all_finite(Y: Floats) -> bool:
    """Whether every coefficient is a number."""
    finite = True
    for k in range(Y.shape[0]):
        for i in range(Y.shape[1]):
            finite = finite and abs(Y[k, i]) < np.inf
    return finite


class ShortSeries(NamedTuple):
    """Where a local series ends, and why.

    end (s): it ceases to be accurate, or contacts `closing` (K,) close. reverses: a link does
    there, and another expansion may go on. finite: whether it is numbers.
    """

    dense: Dense
    closing: Bools
    reverses: bool
    finite: bool


@kernel
def local_series(arrays: Run, forcing: Forcing, mode: Dynamics, limit: float) -> ShortSeries:
    """Expand the motion from the present instant, which is made ready, up to `limit` (s)."""
    rules, state, system, bodies = arrays.rules, arrays.state, mode.system, mode.bodies
    acceleration = rules.length / rules.time**2
    y = arrays.y[: system.size]
    weight = np.empty(y.size)
    for i in range(y.size):
        weight[i] = arrays.atol[i] + rules.rtol * abs(y[i])
    Y = motion_series(0.0, y, system, forcing, ORDER, still_rate(rules.length, rules.time))
    if not all_finite(Y):
        none = np.zeros(state.gap.size, np.bool_)
        nowhere = Dense(Y, 0.0, 0.0, 0.0, np.empty((4, 0)), True, np.empty((0, 0)))
        return ShortSeries(nowhere, none, False, False)
    radius = _series_radius(Y, weight)
    if system.plain < system.stiffness.size:
        radius = _closing_radius(y, system, weight, min(radius, limit))
    # A contact force follows the loads themselves, which move nobody that rests: no coefficient of
    # a body shows how far their series hold.
    pressed = forcing.family == LOADED and bodies.resting.size > 0
    if pressed or system.mass.size == 0:
        radius = min(radius, _ground_radius(forcing, bodies.mass, GROUND_ERROR * acceleration))
    ground = ground_acceleration(forcing, forcing.start)
    least = ACCELERATION * acceleration
    C = gap_series(Y, system, bodies, state, ground, least, rules.time)
    first, closing = first_closings(C, mode.guards.open_contacts, min(limit, radius))
    closed = min(first, limit, radius)
    # No further than to the first closing, and the check of the equations no further than to this.
    reversal = _first_reversal(Y, system, weight, closed)
    end = _trusted(Y, system, forcing, weight, reversal)
    # It ends before they close.
    if end < first:
        for j in range(closing.size):
            closing[j] = False
    dense = Dense(Y, 0.0, 0.0, end, np.empty((4, 0)), True, C)
    return ShortSeries(dense, closing, reversal == end and end < closed, True)
