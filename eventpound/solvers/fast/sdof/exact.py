"""Exact steps of a single body: at rest, from turn to turn, or from sample to sample.

*At rest* (`rest_step`). On the right barrier ``λ = m (A - a_g)`` with A constant, and on the left
one the negative. The Taylor series of the ground motion tells when that passes zero, and the
extremes of λ and of the absolute acceleration a_g.

*Without damping on ground that stands still* (`swing_freely`). With the tangent stiffness k for
each unit of mass, ``ω = √k``, ``y = -u''/k`` the distance from the place of equilibrium and
``r = v/ω``,

    y(τ) = y cos ωτ + r sin ωτ,

so the body turns at ``ωτ = atan2(|r|, ±y)``, at a distance ``R = √(y² + r²)``, or meets a
barrier at a distance ``D < R`` before. One step goes there, however long that takes, where
no border of the backbone is reached. A body on a hysteretic link, whose way is seldom
straight, tries that only when it has just turned.

*Under a record* (`sample_steps`). Between samples the ground acceleration is a straight line, so
with stiffness K_t and damping C the motion after dt is linear in the velocity v, the
relative acceleration a and the slope of the record (N. C. Nigam and P. C.
Jennings, Bull. Seism. Soc. Am. 59 (1969) 909-922):

    u += α_v v + α_a a + α_s slope,    v = β_v v + β_a a + β_s slope.

The six numbers are Taylor series, ``(k+1) (k+2) x_{k+2} = -K_t x_k - (k+1) C x_{k+1}``, summed to
rounding, once for each stiffness. With the largest tangent stiffness K,

    |a(τ)| <= (|a| + dt (K |v| + |slope|)) / (1 - C dt - K dt²/2).

A step is taken this way only where bounds exclude every event (`exact_step`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from eventpound.mechanics.monitored import update_extreme, update_turning_point
from eventpound.motion.base import Family
from eventpound.motion.forcing import (
    CurrentPiece,
    ground_acceleration,
    ground_taylor,
    next_sample,
    sample_time,
)
from eventpound.motion.loads import shortest_times
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled.recipe import SMALL
from eventpound.numerics.polynomial import value_and_slope
from eventpound.solvers.fast.compiled import compiled, compiled_deferred, compiled_noinline
from eventpound.solvers.fast.extremes import stays_within, turning_times
from eventpound.solvers.fast.links import CORE, DOWN, SATURATED, UNLOADING, UP
from eventpound.solvers.fast.record import is_due, pass_time
from eventpound.solvers.fast.run import REST_TERMS
from eventpound.solvers.fast.sdof.body import (
    SdofBody,
    SdofRun,
    absolute_acceleration,
    gap_to,
    observe_end,
    place_of,
    set_force,
    set_tolerance,
    spring_state,
    steepest,
    tangent,
)
from eventpound.solvers.fast.sdof.record import force_exceeds, sample_sdof, take_contact_forces
from eventpound.solvers.fast.sdof.series import linear_series, swing
from eventpound.solvers.fast.sdof.step import FREE, TURNED, arrive, closed_at, equations_hold
from eventpound.solvers.fast.search import release_time
from eventpound.tolerances import NO_TERM, SAME_SAMPLE

LONGEST = 1.0
"""Longest step under a sinusoid, in its radians; `REST_TERMS` terms then err by rounding."""
LONGEST_GAUSSIAN = 0.25
"""The same under a Gaussian pulse, in its own time 1/sqrt(q)."""
_SAMPLES = int(Family.SAMPLES)


@compiled_noinline
def rest_step(stop: float, piece: CurrentPiece, solo: SdofRun) -> bool:
    """One step at rest, to `stop` (s) at most; False where the record has no room.

    `SdofBody.released` says then whether the contact force has vanished.
    """
    body, t, side = solo.body, solo.now.t, solo.body.rests_on
    if piece.family == _SAMPLES:
        stop = next_sample(piece.coefficients, t, stop)
    gaussian, sinusoid, _ = shortest_times(piece.family, piece.coefficients)
    # Over a longer step the series of the ground motion errs by more than rounding.
    h = min(stop - t, LONGEST_GAUSSIAN * gaussian, LONGEST * sinusoid)
    f = body.work[:]
    ground_taylor(piece, t, REST_TERMS, f)
    for k in range(REST_TERMS):
        f[k] = -side * f[k]
    f[0] += side * body.a
    release = _release(h, solo.progress.stalled > 0, f, solo)
    tau = min(h, release)
    t_end = stop if tau == stop - t else t + tau
    if not sample_sdof(t, t_end, 0, piece, solo):
        return False
    _extremes_inside(t, tau, f, solo)
    g = ground_acceleration(piece, t_end)
    set_force(g, body)
    update_extreme(solo.running.at.acceleration, g, t_end, solo.running)
    take_contact_forces(t_end, solo)
    body.released = release <= tau
    pass_time(tau, t_end, 1, solo.now, solo.progress)
    return True


@compiled
def _release(h: float, kept: bool, f: Floats, solo: SdofRun) -> float:
    """When the contact force, ``Σ f_k τ^k`` for each unit of mass, falls below zero, or inf.

    `kept`: see `release_time`.
    """
    spread = 0.0
    for k in range(REST_TERMS - 1, 0, -1):
        spread = (spread + abs(f[k])) * h
    if f[0] > spread:
        return np.inf
    c, level = solo.scratch.rate, solo.body.no_force
    for k in range(REST_TERMS):
        c[k] = f[k]
    kept = kept and abs(f[0]) <= level
    k, rounding = 0, level
    while kept and k < REST_TERMS and abs(c[k]) <= rounding:
        c[k] = 0.0
        rounding /= solo.plan.limits.time
        k += 1
    return release_time(c, REST_TERMS, h, h, level, kept, solo.scratch.work)


@compiled
def _extremes_inside(t: float, tau: float, f: Floats, solo: SdofRun) -> None:
    """Turning points of the contact force and of the acceleration of the ground."""
    body, d, running, spread = solo.body, solo.scratch.rate, solo.running, 0.0
    for k in range(REST_TERMS - 1, 0, -1):
        spread = (spread + abs(f[k])) * tau
        d[k - 1] = k * f[k]
    side, mass, i = body.rests_on, body.mass, running.at.acceleration
    touched = solo.plan.oscillator.right if side > 0.0 else solo.plan.oscillator.left
    force = running.at.contact_force + touched
    g = body.a - side * f[0]
    low, high = mass * (f[0] - spread), mass * (f[0] + spread)
    if stays_within(i, g - spread, g + spread, running) and stays_within(force, low, high, running):
        return
    for m in range(turning_times(d, REST_TERMS - 1, tau, solo.scratch.turns, solo.scratch.work)):
        at = solo.scratch.turns[m]
        value, _ = value_and_slope(f[:REST_TERMS], at)
        update_turning_point(i, body.a - side * value, t + at, body.flat_time, running)
        update_turning_point(force, mass * value, t + at, body.flat_time, running)


NOT_FREE = -1
"""What `swing_freely` answers where the motion is not harmonic after all."""


@compiled
def swings_freely(body: SdofBody) -> bool:
    """Whether the body swings as far as it turns or meets a barrier, if the ground stands still."""
    hysteretic = body.hysteretic
    v, a, k = body.v, body.a, tangent(body)
    if (hysteretic and v != 0.0) or body.damping > 0.0 or not k > 0.0:
        return False
    # At the level of rounding the ordinary step knows better which way the body goes.
    if 0.0 < abs(v) <= body.still or (v == 0.0 and abs(a) <= body.no_acceleration):
        return False
    way = _way(body)
    if gap_to(way, body) < body.own_gap:
        return False
    if not hysteretic:
        return True
    part, on_curve = body.part, way * body.sigma
    if DOWN <= part <= UP or (part != CORE and on_curve < 0.0):
        return False
    # It has just turned, so the next turn is 2 |y| away.
    border = np.inf
    if part <= UNLOADING:
        border = (body.core_end - on_curve * place_of(body.u, body)) * body.scale
    least = 0.0 if part == CORE else body.standing
    return bool(k * least < 2.0 * abs(a) < k * border)


@compiled
def _way(body: SdofBody) -> float:
    """Direction in which the body moves, or is about to move."""
    return math.copysign(1.0, body.v if body.v != 0.0 else body.a)


@compiled_noinline
def swing_freely(stop: float, piece: CurrentPiece, solo: SdofRun) -> int:
    """Go to the next turn or barrier, or to `stop` (s); GOING_ON, or why not.

    `NOT_FREE` says that the forces do not give the acceleration there, and nothing was done.
    """
    body, t = solo.body, solo.now.t
    k, way, left = tangent(body), _way(body), stop - t
    omega = math.sqrt(k)
    y, r = -body.a / k, body.v / omega
    gap, event = gap_to(way, body), FREE
    tau, rate = math.atan2(abs(r), way * y) / omega, 0.0
    # R - |y| of a small swing far from equilibrium without its cancellation.
    far = math.sqrt(y * y + r * r) + abs(y)
    change = way * (r * r / far if way * y > 0.0 else far)
    square = r * r - gap * (2.0 * way * y + gap)
    if square > 0.0:
        # R² - D²: the barrier is nearer than the turn.
        root = math.sqrt(square)
        tau -= math.atan2(root, way * y + gap) / omega
        change, rate = way * gap, way * omega * root
        event = closed_at(way)
    elif body.hysteretic and body.part != CORE:
        event = TURNED
    if tau >= left:
        tau, event = left, FREE
        change, rate = swing(tau, body)
    body.change, body.rate, body.bend = change, rate, -k * (y + change)
    body.next_odd = body.next_g = 0.0
    set_tolerance(body)
    observe_end(solo)
    if not (tau > 0.0 and equations_hold(tau, 1, body)):
        return NOT_FREE
    t_end = stop if tau == left else t + tau
    if is_due(t_end, solo.plan.output_times, solo.progress):
        # The record has room, which was looked for before.
        sample_sdof(t, t_end, 0, piece, solo)
    return arrive(tau, t_end, rate == 0.0, event, solo)


ROW_ORDER = 16
"""Order of the series that gives rows between samples: 0.5^8 / 16! is far below rounding."""
MOST_TURN = 0.5
"""Largest ``C dt + K dt²`` for which the bounds of a step are good."""
_MOST_TERMS = 30


@compiled_noinline
def fill_table(stiffness: float, dt: float, body: SdofBody, step: Floats) -> None:
    """Numbers of a step of length dt (s): dt, α and β of velocity, acceleration and slope."""
    step[0] = dt
    for kind in range(3):
        low, high = 1.0 if kind == 0 else 0.0, 0.5 if kind == 1 else 0.0
        change, rate = dt * (low + dt * high), low + 2.0 * dt * high
        power, before, least = dt * dt, np.inf, NO_TERM * dt ** (kind + 1)
        for k in range(1, _MOST_TERMS):
            total = -1.0 if kind == 2 and k == 1 else 0.0
            total -= stiffness * low + body.damping * (k + 1) * high
            low, high = high, total / ((k + 1) * (k + 2))
            rate += (k + 2) * high * power
            change += high * power * dt
            last = abs(high) * power * dt
            power *= dt
            # Without damping every other term is zero.
            if max(last, before) < least:
                break
            before = last
        step[1 + kind], step[4 + kind] = change, rate


@compiled
def set_line(dt: float, body: SdofBody) -> None:
    """What an exact step of a length (s) needs to know of the line that a body is on, if it is.

    None is taken where it would be too long.
    """
    part, sigma, k, saturated = body.part, body.sigma, tangent(body), body.part == SATURATED
    body.steepest = steepest(body)
    turn = body.damping * dt + 0.5 * body.steepest * dt * dt
    body.inverse, body.low, body.high = 1.0 / (1.0 - turn), 1.0, -1.0
    if UNLOADING < part < SATURATED or max(turn, (body.damping + k * dt) * dt) > MOST_TURN:
        return
    table = body.saturated if saturated else body.on_line
    if table[0] != dt:
        fill_table(k, dt, body, table)
    z = sigma if saturated else sigma * place_of(0.0, body)
    body.line_pull = absolute_acceleration(0.0, 0.0, z, body)
    low, high = -np.inf, np.inf
    if part <= UNLOADING and body.hysteretic:
        # ξ = 0 is in the middle. Below it the part UNLOADING ends where the body turns.
        middle, width = body.u_r - sigma * body.xi_r * body.scale, body.core_end * body.scale
        if part == CORE or sigma < 0.0:
            low = middle - width
        if part == CORE or sigma > 0.0:
            high = middle + width
    body.low = max(low, body.own_gap - body.left_gap)
    body.high = min(high, body.right_gap - body.own_gap)


class ExactStep(NamedTuple):
    """Whether an exact step holds, and where it ends.

    change: of displacement (m). v: velocity (m/s). a: absolute acceleration (m/s²).
    """

    holds: bool
    change: float
    v: float
    a: float


@compiled
def exact_step(
    u: float, v: float, a: float, g: float, slope: float, dt: float, solo: SdofRun
) -> ExactStep:
    """The exact step of a body at u (m) with the velocity v and the absolute acceleration a.

    The acceleration of the ground is g (m/s²) with a slope (m/s³). It holds where bounds say that
    the body stays on its line and exceeds no extreme inside.
    """
    body = solo.body
    table = body.saturated if body.part == SATURATED else body.on_line
    pulled, k, damping = a - g, tangent(body), body.damping
    change = table[1] * v + table[2] * pulled + table[3] * slope
    next_v = table[4] * v + table[5] * pulled + table[6] * slope
    next_a = body.line_pull - k * (u + change) - damping * next_v
    # Of the relative acceleration.
    fastest = (abs(pulled) + dt * (body.steepest * abs(v) + abs(slope))) * body.inverse
    one_way, reach = abs(v) > dt * fastest, dt * (abs(v) + dt * fastest)
    low, high = min(u, u + change), max(u, u + change)
    if not one_way:
        low, high = u - reach, u + reach
    holds = body.low <= low and high <= body.high
    if body.part != CORE:
        holds = holds and one_way and body.sigma * v > 0.0
    if holds and not one_way:
        holds = stays_within(solo.running.at.displacement, low, high, solo.running)
    if holds and (damping > 0.0 or not one_way):
        spread = k * reach + damping * dt * fastest
        holds = not force_exceeds(a - spread, a + spread, solo)
    return ExactStep(holds, change, next_v, next_a)


@compiled_deferred.but(recipe=SMALL)
def sample_steps(
    budget: int, segment: int, piece_end: float, piece: CurrentPiece, solo: SdofRun
) -> int:
    """Steps from the sample `segment`, where the body is, as far as nothing can happen.

    Rows of the history that fall between samples are written on the way, so that
    the motion does not depend on them. The sample where the body is then is returned.
    """
    body, coefficients, samples = solo.body, piece.coefficients, piece.samples
    origin, dt = coefficients[0], coefficients[1]
    if UNLOADING < body.part < SATURATED:
        return segment
    set_line(dt, body)
    u, v, a, t, until = body.u, body.v, body.a, solo.now.t, piece_end - SAME_SAMPLE * dt
    first, started, due = segment, segment, True
    while due:
        due = False
        # This loop writes nothing, so what it needs to know stays where it is.
        while segment - first < budget and segment + 2 < samples.size:
            t_end = sample_time(origin, dt, segment + 1)
            if not t_end < until:
                break
            g, slope = samples[segment], (samples[segment + 1] - samples[segment]) / dt
            step = exact_step(u, v, a, g, slope, dt, solo)
            due = step.holds and is_due(t_end, solo.plan.output_times, solo.progress)
            if due or not step.holds:
                break
            u, v, a, t = u + step.change, step.v, step.a, t_end
            segment += 1
        if segment > started:
            _arrive(u, v, t, segment - started, dt, solo)
            started = segment
        if due:
            # The body's own ground is not known any more.
            body.odd, body.segment = slope, -1
            # Terms of its series are not needed to a tolerance.
            body.x[1], body.x[2] = v, 0.5 * (a - g)
            body.step, body.of_u, body.of_v = dt, 0.0, 0.0
            order, _ = linear_series(tangent(body), ROW_ORDER, body)
            due = sample_sdof(t, t_end, order, piece, solo)
        if due:
            u, v, a, t = u + step.change, step.v, step.a, t_end
            segment += 1
    if segment > first:
        body.z, body.a = spring_state(u, solo), a
    return segment


@compiled
def _arrive(u: float, v: float, t: float, steps: int, dt: float, solo: SdofRun) -> None:
    body = solo.body
    body.u, body.v, body.right, body.left = u, v, body.right_gap - u, body.left_gap + u
    pass_time(steps * dt, t, steps, solo.now, solo.progress)
