"""A single linear body without damping on ground that stands still: from turn to turn.

With the tangent stiffness k for each unit of mass, ``ω = √k``, ``y = -u''/k`` the distance from
the place of equilibrium and ``r = v/ω``,

    y(τ) = y cos ωτ + r sin ωτ,

so the body turns at ``ωτ = atan2(|r|, ±y)``, at a distance ``R = √(y² + r²)``, or meets a
barrier at a distance ``D < R`` before. One step goes there, however long that takes, where
no border of the backbone is reached. A body on a hysteretic link, whose way is seldom
straight, tries that only when it has just turned.
"""

from __future__ import annotations

import math

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.solvers.events.cascade import T
from eventpound.solvers.fast.backbone_parts import CORE, DOWN, UNLOADING, UP
from eventpound.solvers.fast.compiled import compiled, compiled_apart, compiled_deferred_loop
from eventpound.solvers.fast.run import OUTPUT
from eventpound.solvers.fast.single import absolute_acceleration, place_of, spring_state
from eventpound.solvers.fast.single_advance import arrive, fits
from eventpound.solvers.fast.single_history import write_single_row
from eventpound.solvers.fast.single_places import (
    ATOL_U,
    ATOL_V,
    BEND,
    CHANGE,
    CORE_END,
    DAMPING,
    LEFT,
    NEXT_A,
    NEXT_EVEN,
    NEXT_G,
    NEXT_ODD,
    NEXT_Z,
    NO_ACCELERATION,
    OF_U,
    OF_V,
    OWN,
    PART,
    PER_SCALE,
    RATE,
    RIGHT,
    RTOL,
    SCALE,
    SIGMA,
    STANDING,
    STIFFNESS,
    STILL,
    STRENGTH,
    A,
    U,
    V,
)
from eventpound.solvers.fast.single_run import SingleRun
from eventpound.solvers.fast.single_step import CLOSED_LEFT, CLOSED_RIGHT, FREE, TURNED

NOT_FREE = -1
"""What `swing_freely` answers where the motion is not harmonic after all."""


@compiled
def _tangent(w: Floats) -> float:
    """Tangent stiffness for each unit of mass (1/s²), where the link is on a line."""
    hysteretic = w[STRENGTH] > 0.0 and w[PART] <= UNLOADING
    return w[STIFFNESS] + (w[STRENGTH] * w[PER_SCALE] if hysteretic else 0.0)


@compiled
def swings_freely(w: Floats) -> bool:
    """Whether the body swings as far as it turns or meets a barrier, if the ground stands still."""
    hysteretic = w[STRENGTH] > 0.0
    v, a, tangent = w[V], w[A], _tangent(w)
    if (hysteretic and v != 0.0) or w[DAMPING] > 0.0 or not tangent > 0.0:
        return False
    # At the level of rounding the ordinary step knows better which way the body goes.
    if 0.0 < abs(v) <= w[STILL] or (v == 0.0 and abs(a) <= w[NO_ACCELERATION]):
        return False
    way = _way(w)
    if (w[RIGHT] if way > 0.0 else w[LEFT]) < w[OWN]:
        return False
    if not hysteretic:
        return True
    part, on_curve = w[PART], way * w[SIGMA]
    if DOWN <= part <= UP or (part != CORE and on_curve < 0.0):
        return False
    # It has just turned, so the next turn is 2 |y| away.
    border = np.inf
    if part <= UNLOADING:
        border = (w[CORE_END] - on_curve * place_of(w[U], w)) * w[SCALE]
    least = 0.0 if part == CORE else w[STANDING]
    return bool(tangent * least < 2.0 * abs(a) < tangent * border)


@compiled
def _way(w: Floats) -> float:
    """Direction in which the body moves, or is about to move."""
    return math.copysign(1.0, w[V] if w[V] != 0.0 else w[A])


@compiled_deferred_loop
def swing_freely(stop: float, run: SingleRun) -> int:
    """Go to the next turn or barrier, or to `stop` (s); GOING_ON, or why not.

    `NOT_FREE` says that the forces do not give the acceleration there, and nothing was done.
    """
    w, count, times, t = run.w, run.count, run.times, run.clock[T]
    tangent, way, left = _tangent(w), _way(w), stop - t
    omega = math.sqrt(tangent)
    y, r = -w[A] / tangent, w[V] / omega
    gap, event = (w[RIGHT] if way > 0.0 else w[LEFT]), FREE
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
        event = CLOSED_RIGHT if way > 0.0 else CLOSED_LEFT
    elif w[STRENGTH] > 0.0 and w[PART] != CORE:
        event = TURNED
    if tau >= left:
        tau, event = left, FREE
        change, rate = _harmonic(tau, omega, y, r)
    w[CHANGE], w[RATE], w[BEND] = change, rate, -tangent * (y + change)
    if not (tau > 0.0 and _fits(tau, run)):
        return NOT_FREE
    t_end = stop if tau == left else t + tau
    if count[OUTPUT] < times.size and times[count[OUTPUT]] < t_end:
        _write_rows(t, t_end, run)
    return arrive(tau, t_end, rate == 0.0, event, run)


@compiled
def _fits(tau: float, run: SingleRun) -> bool:
    """Whether the forces at the end give the acceleration there."""
    w = run.w
    w[OF_U] = w[ATOL_U] + w[RTOL] * abs(w[U])
    w[OF_V] = w[ATOL_V] + w[RTOL] * abs(w[V])
    u = w[U] + w[CHANGE]
    w[NEXT_EVEN] = w[NEXT_ODD] = w[NEXT_G] = 0.0
    w[NEXT_Z] = spring_state(u, run.table, w)
    w[NEXT_A] = absolute_acceleration(u, w[RATE], w[NEXT_Z], w)
    return fits(tau, 1, w)


@compiled
def _harmonic(tau: float, omega: float, y: float, r: float) -> tuple[float, float]:
    """Change of displacement (m) and velocity (m/s) after tau (s)."""
    half, sine = math.sin(0.5 * omega * tau), math.sin(omega * tau)
    square = 2.0 * half * half
    return r * sine - y * square, omega * (r * (1.0 - square) - y * sine)


@compiled_apart
def _write_rows(t: float, t_end: float, run: SingleRun) -> None:
    """History at the output times of a step, for all of which the record has room."""
    w, count, times = run.w, run.count, run.times
    tangent = _tangent(w)
    omega = math.sqrt(tangent)
    while count[OUTPUT] < times.size and times[count[OUTPUT]] < t_end:
        now = times[count[OUTPUT]]
        if now >= t:
            change, v = _harmonic(now - t, omega, -w[A] / tangent, w[V] / omega)
            u = w[U] + change
            z = spring_state(u, run.table, w)
            write_single_row(now, 0.0, change, v, absolute_acceleration(u, v, z, w), z, run)
        count[OUTPUT] += 1
