"""A single body at rest on a barrier, until its contact force vanishes.

It stands still to the ground, so on the right barrier ``λ = m (A - a_g)`` with A
the constant acceleration that its links give it, and on the left one the
negative. The Taylor series of the ground motion tells when that passes zero, and
the extremes of λ and of the absolute acceleration a_g.
"""

from __future__ import annotations

import math

import numpy as np

from eventpound.motion.base import Family
from eventpound.motion.forcing import ground_acceleration, ground_taylor, next_sample
from eventpound.numerics.arrays import Floats
from eventpound.numerics.polynomial import value_and_slope
from eventpound.solvers.events.cascade import SINCE_IMPACT, T
from eventpound.solvers.events.event_bounds import update_extreme, update_turning_point
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.extremes import turning_times
from eventpound.solvers.fast.run import OUTPUT, REST_TERMS, ROWS, STALLED, STEPS
from eventpound.solvers.fast.search import release_time
from eventpound.solvers.fast.single_extremes import exceeds, place_of_acceleration
from eventpound.solvers.fast.single_history import write_single_row
from eventpound.solvers.fast.single_places import (
    FLAT_TIME,
    LEFT_FORCE,
    MASS,
    NO_FORCE,
    OF_W,
    RELEASED,
    RESTS_ON,
    RIGHT_FORCE,
    ROOM,
    A,
    Z,
)
from eventpound.solvers.fast.single_run import SingleRun

LONGEST = 1.0
"""Longest step under a sinusoid, in its radians; `REST_TERMS` terms then err by rounding."""
LONGEST_GAUSSIAN = 0.25
"""The same under a Gaussian pulse, in its own time 1/sqrt(q)."""
_SAMPLES, _GAUSSIAN, _SINUSOIDS = int(Family.SAMPLES), int(Family.GAUSSIAN), int(Family.SINUSOIDS)


@compiled
def set_force(g: float, w: Floats) -> None:
    """Contact forces (N) under the acceleration g of the ground (m/s²)."""
    side = w[RESTS_ON]
    w[RIGHT_FORCE] = w[MASS] * (w[A] - g) if side > 0.0 else 0.0
    w[LEFT_FORCE] = w[MASS] * (g - w[A]) if side < 0.0 else 0.0


@compiled_apart
def rest_step(
    stop: float,
    family: int,
    coefficients: Floats,
    samples: Floats,
    run: SingleRun,
) -> bool:
    """One step at rest, to `stop` (s) at most; False where the record has no room.

    RELEASED says then whether the contact force has vanished.
    """
    w, clock, count = run.w, run.clock, run.count
    t, side = clock[T], w[RESTS_ON]
    if family == _SAMPLES:
        stop = next_sample(coefficients, t, stop)
    h = min(stop - t, _longest(family, coefficients))
    f = w[OF_W : OF_W + ROOM]
    ground_taylor(family, coefficients, samples, t, REST_TERMS, f)
    for k in range(REST_TERMS):
        f[k] = -side * f[k]
    f[0] += side * w[A]
    release = _release(h, count[STALLED] > 0, f, run)
    tau = min(h, release)
    t_end = stop if tau == stop - t else t + tau
    if not _sample(t, t_end, family, coefficients, samples, run):
        return False
    _extremes_inside(t, tau, f, run)
    g = ground_acceleration(family, coefficients, samples, t_end)
    set_force(g, w)
    i = place_of_acceleration(run)
    update_extreme(i, g, t_end, run.running)
    if side > 0.0:
        update_extreme(i + 2 + run.right, w[RIGHT_FORCE], t_end, run.running)
    else:
        update_extreme(i + 2 + run.left, w[LEFT_FORCE], t_end, run.running)
    w[RELEASED] = 1.0 if release <= tau else 0.0
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
    c, level = run.rate, run.w[NO_FORCE]
    for k in range(REST_TERMS):
        c[k] = f[k]
    kept = kept and abs(f[0]) <= level
    k, rounding = 0, level
    while kept and k < REST_TERMS and abs(c[k]) <= rounding:
        c[k] = 0.0
        rounding /= run.time
        k += 1
    return release_time(c, REST_TERMS, h, h, level, kept, run.work)


@compiled
def _extremes_inside(t: float, tau: float, f: Floats, run: SingleRun) -> None:
    """Turning points of the contact force and of the acceleration of the ground."""
    w, d, running, spread = run.w, run.rate, run.running, 0.0
    for k in range(REST_TERMS - 1, 0, -1):
        spread = (spread + abs(f[k])) * tau
        d[k - 1] = k * f[k]
    side, mass, i = w[RESTS_ON], w[MASS], place_of_acceleration(run)
    force = i + 2 + (run.right if side > 0.0 else run.left)
    g = w[A] - side * f[0]
    if not (
        exceeds(i, g - spread, g + spread, running)
        or exceeds(force, mass * (f[0] - spread), mass * (f[0] + spread), running)
    ):
        return
    for m in range(turning_times(d, REST_TERMS - 1, tau, run.turns, run.work)):
        at = run.turns[m]
        value, _ = value_and_slope(f[:REST_TERMS], at)
        update_turning_point(i, w[A] - side * value, t + at, w[FLAT_TIME], running)
        update_turning_point(force, mass * value, t + at, w[FLAT_TIME], running)


@compiled
def _sample(
    t: float, t_end: float, family: int, coefficients: Floats, samples: Floats, run: SingleRun
) -> bool:
    """History at the output times of a step; False where the record has no room."""
    count, times, w = run.count, run.times, run.w
    while count[OUTPUT] < times.size and times[count[OUTPUT]] < t_end:
        now = times[count[OUTPUT]]
        if now >= t:
            if count[ROWS] + 4 > run.rows.shape[0]:
                return False
            g = ground_acceleration(family, coefficients, samples, now)
            set_force(g, w)
            write_single_row(now, g, 0.0, 0.0, g, w[Z], run)
        count[OUTPUT] += 1
    return True
