"""Contact of a single body: impact, rest on a barrier, and detachment.

The rules are those of `eventpound.solvers.events.modes` for the two barriers, of
which one at most is closed. Newton's law is ``v⁺ = -ε v⁻``. A body that stands
still at a barrier moves, once let go, as ``u'' = A - a_g`` with A a constant as
long as it has not moved, so of ``0 <= g'' ⊥ λ >= 0`` and all higher orders there
remain the Taylor coefficients of A - a_g: the first that differs from zero decides.

At rest on the right barrier ``λ = m (A - a_g)``, and on the left one the negative. The Taylor
series of the ground motion tells when that passes zero, and the extremes of λ and of the absolute
acceleration a_g.
"""

from __future__ import annotations

import math

import numpy as np

from eventpound.motion.base import Family
from eventpound.motion.forcing import decay_time, ground_acceleration, ground_taylor, next_sample
from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.polynomial import value_and_slope
from eventpound.solvers.events.cascade import (
    FASTEST,
    IN_A_ROW,
    LISTED_SPEED,
    SINCE_IMPACT,
    T,
    is_plastic,
)
from eventpound.solvers.events.event_bounds import update_extreme, update_turning_point
from eventpound.solvers.events.event_rows import (
    EventRow,
    kind_of_impact,
    new_group,
    write_change,
    write_event,
)
from eventpound.solvers.events.modes import transition_code
from eventpound.solvers.events.rest import DIRECT
from eventpound.solvers.events.rest import ORDER as MOST_DECIDING
from eventpound.solvers.fast.compiled import compiled, compiled_apart, compiled_deferred
from eventpound.solvers.fast.extremes import turning_times
from eventpound.solvers.fast.links import CORE
from eventpound.solvers.fast.run import OUTPUT, REST_TERMS, RESTING, ROWS, STALLED, STEPS, Piece
from eventpound.solvers.fast.search import release_time
from eventpound.solvers.fast.single.body import (
    Body,
    SingleRun,
    absolute_acceleration,
    spring_state,
    turn_round,
)
from eventpound.solvers.fast.single.record import (
    exceeds,
    place_of_acceleration,
    write_single_row,
)


@compiled
def side_closed(body: Body) -> float:
    """1 for the barrier on the right, -1 for that on the left, 0 where both are open."""
    if body.right == 0.0:
        return 1.0
    return -1.0 if body.left == 0.0 else 0.0


@compiled
def acceleration_level(body: Body) -> float:
    """Rounding of the relative acceleration (m/s²), as the acceleration problem has it."""
    return max(DIRECT * abs(body.a), body.no_acceleration)


@compiled_apart
def impact_at_barrier(
    side: float,
    j: int,
    restitution: float,
    clock: Floats,
    count: Ints,
    events: Floats,
    body: Body,
) -> None:
    """Newton's law at the barrier on one side, contact j, which the body has met."""
    before = -side * body.v
    clock[FASTEST] = max(clock[FASTEST], -before)
    count[IN_A_ROW] += 1
    plastic = is_plastic(-before, clock[FASTEST], body.own_speed, count[IN_A_ROW], 1)
    listed = -before >= LISTED_SPEED * clock[FASTEST]
    kind = kind_of_impact(listed, plastic, before, restitution)
    if plastic:
        restitution = 0.0
    after = -restitution * before
    impulse = -(1.0 + restitution) * before * body.mass
    lost = 0.5 * impulse * (restitution - 1.0) * before
    body.v = -side * after
    if not listed:
        body.held_back = True
    clock[SINCE_IMPACT] = 0.0
    group = new_group(count)
    row = EventRow(clock[T], kind, group, j, before, after, impulse, lost, 1)
    write_event(row, count, events)


@compiled_deferred
def stays_closed(
    side: float,
    t: float,
    time: float,
    piece: Piece,
    body: Body,
) -> bool:
    """Whether a body that stands still at a barrier without a contact force stays there.

    Parameters
    ----------
    side : float
        1 for a barrier on the right, -1 for one on the left.
    t, time : float
        Present time, and the scene's own (s).
    piece : Piece
        The ground motion from now on.
    body : Body
        Its numbers.
    """
    ground, level = body.work[:], body.no_acceleration
    ground_taylor(piece, t, MOST_DECIDING, ground)
    time = min(time, decay_time(piece, t))
    for k in range(1, MOST_DECIDING):
        level /= time * k
        if abs(ground[k]) > level:
            return side * ground[k] < 0.0
    return True


@compiled
def put_on_barrier(side: float, body: Body) -> None:
    """Make the displacement agree with a gap of zero."""
    if side > 0.0:
        body.u = body.right_gap
    elif side < 0.0:
        body.u = -body.left_gap


@compiled
def settle_single(g: float, piece: Piece, run: SingleRun) -> None:
    """Do the duties of the present instant; `g` is the acceleration of the ground (m/s²)."""
    body, clock, count, events = run.body, run.clock, run.count, run.events
    side = side_closed(body)
    j = run.oscillator.right if side > 0.0 else run.oscillator.left
    put_on_barrier(side, body)
    body.z = spring_state(body.u, run.table, body)
    if side * body.v > 0.0:
        impact_at_barrier(side, j, run.contacts.restitution[j], clock, count, events, body)
    if body.part != CORE and body.sigma * body.v < -body.still:
        turn_round(body.u, run.table, body)
    body.a = absolute_acceleration(body.u, body.v, body.z, body)
    rests = 0.0
    if side != 0.0 and body.v == 0.0:
        pull = body.a - g
        stays = side * pull > 0.0
        if body.released or abs(pull) <= acceleration_level(body):
            stays = stays_closed(side, clock[T], run.limits.time, piece, body)
        rests = side if stays else 0.0
    if rests != body.rests_on:
        _write_rest(rests != 0.0, j, -side * body.v, run)
    body.rests_on, body.released = rests, False
    count[RESTING] = 1 if rests != 0.0 else 0


@compiled_deferred
def _write_rest(rests: bool, j: int, rate: float, run: SingleRun) -> None:
    """Write down that the body comes to rest on contact j, or no longer rests on it."""
    count, code = run.count, transition_code(not rests, rests, rate)
    write_change(code, j, new_group(count), rate, run.clock[T], count, run.events)


LONGEST = 1.0
"""Longest step under a sinusoid, in its radians; `REST_TERMS` terms then err by rounding."""
LONGEST_GAUSSIAN = 0.25
"""The same under a Gaussian pulse, in its own time 1/sqrt(q)."""
_SAMPLES, _GAUSSIAN, _SINUSOIDS = int(Family.SAMPLES), int(Family.GAUSSIAN), int(Family.SINUSOIDS)


@compiled
def set_force(g: float, body: Body) -> None:
    """Contact forces (N) under the acceleration g of the ground (m/s²)."""
    side = body.rests_on
    body.right_force = body.mass * (body.a - g) if side > 0.0 else 0.0
    body.left_force = body.mass * (g - body.a) if side < 0.0 else 0.0


@compiled_apart
def rest_step(
    stop: float,
    piece: Piece,
    run: SingleRun,
) -> bool:
    """One step at rest, to `stop` (s) at most; False where the record has no room.

    RELEASED says then whether the contact force has vanished.
    """
    body, clock, count = run.body, run.clock, run.count
    t, side = clock[T], body.rests_on
    if piece.family == _SAMPLES:
        stop = next_sample(piece.coefficients, t, stop)
    h = min(stop - t, _longest(piece.family, piece.coefficients))
    f = body.work[:]
    ground_taylor(piece, t, REST_TERMS, f)
    for k in range(REST_TERMS):
        f[k] = -side * f[k]
    f[0] += side * body.a
    release = _release(h, count[STALLED] > 0, f, run)
    tau = min(h, release)
    t_end = stop if tau == stop - t else t + tau
    if not _sample(t, t_end, piece, run):
        return False
    _extremes_inside(t, tau, f, run)
    g = ground_acceleration(piece, t_end)
    set_force(g, body)
    i = place_of_acceleration(run)
    update_extreme(i, g, t_end, run.running)
    if side > 0.0:
        update_extreme(i + 2 + run.oscillator.right, body.right_force, t_end, run.running)
    else:
        update_extreme(i + 2 + run.oscillator.left, body.left_force, t_end, run.running)
    body.released = release <= tau
    count[STALLED] = count[STALLED] + 1 if release <= tau and tau == 0.0 else 0
    clock[T] = t_end
    clock[SINCE_IMPACT] += tau
    count[STEPS] += 1
    return True


@compiled
def _longest(family: int, coefficients: Floats) -> float:
    """Longest step for which the series of the ground motion errs by rounding (s)."""
    longest = np.inf
    if family == _GAUSSIAN:
        longest = LONGEST_GAUSSIAN / math.sqrt(coefficients[1])
    elif family == _SINUSOIDS:
        for k in range(1, coefficients.size, 3):
            if coefficients[k + 1] > 0.0:
                longest = min(longest, LONGEST / coefficients[k + 1])
    return longest


@compiled
def _release(h: float, kept: bool, f: Floats, run: SingleRun) -> float:
    """When the contact force, ``Σ f_k τ^k`` for each unit of mass, falls below zero, or inf.

    `kept`: see `release_time`.
    """
    spread = 0.0
    for k in range(REST_TERMS - 1, 0, -1):
        spread = (spread + abs(f[k])) * h
    if f[0] > spread:
        return np.inf
    c, level = run.scratch.rate, run.body.no_force
    for k in range(REST_TERMS):
        c[k] = f[k]
    kept = kept and abs(f[0]) <= level
    k, rounding = 0, level
    while kept and k < REST_TERMS and abs(c[k]) <= rounding:
        c[k] = 0.0
        rounding /= run.limits.time
        k += 1
    return release_time(c, REST_TERMS, h, h, level, kept, run.scratch.work)


@compiled
def _extremes_inside(t: float, tau: float, f: Floats, run: SingleRun) -> None:
    """Turning points of the contact force and of the acceleration of the ground."""
    body, d, running, spread = run.body, run.scratch.rate, run.running, 0.0
    for k in range(REST_TERMS - 1, 0, -1):
        spread = (spread + abs(f[k])) * tau
        d[k - 1] = k * f[k]
    side, mass, i = body.rests_on, body.mass, place_of_acceleration(run)
    force = i + 2 + (run.oscillator.right if side > 0.0 else run.oscillator.left)
    g = body.a - side * f[0]
    if not (
        exceeds(i, g - spread, g + spread, running)
        or exceeds(force, mass * (f[0] - spread), mass * (f[0] + spread), running)
    ):
        return
    for m in range(turning_times(d, REST_TERMS - 1, tau, run.scratch.turns, run.scratch.work)):
        at = run.scratch.turns[m]
        value, _ = value_and_slope(f[:REST_TERMS], at)
        update_turning_point(i, body.a - side * value, t + at, body.flat_time, running)
        update_turning_point(force, mass * value, t + at, body.flat_time, running)


@compiled
def _sample(t: float, t_end: float, piece: Piece, run: SingleRun) -> bool:
    """History at the output times of a step; False where the record has no room."""
    count, times, body = run.count, run.times, run.body
    while count[OUTPUT] < times.size and times[count[OUTPUT]] < t_end:
        now = times[count[OUTPUT]]
        if now >= t:
            if count[ROWS] + 4 > run.rows.shape[0]:
                return False
            g = ground_acceleration(piece, now)
            set_force(g, body)
            write_single_row(now, g, 0.0, 0.0, g, body.z, run)
        count[OUTPUT] += 1
    return True
