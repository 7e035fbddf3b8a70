"""A single linear body without damping on ground that stands still: from turn to turn.

With the tangent stiffness k for each unit of mass, ``ω = √k``, ``y = -u''/k`` the distance from
the place of equilibrium and ``r = v/ω``,

    y(τ) = y cos ωτ + r sin ωτ,

so the body turns at ``ωτ = atan2(|r|, ±y)`` and a distance ``R = √(y² + r²)``. One step goes
there, however long that takes, where no barrier and no border of the backbone is
reached before. A body on a hysteretic link, whose way is seldom straight, tries that only
when it has just turned.
"""

from __future__ import annotations

import math

from eventpound.numerics.arrays import Floats
from eventpound.solvers.fast.backbone_parts import CORE, DOWN, UNLOADING, UP
from eventpound.solvers.fast.compiled import compiled, compiled_apart
from eventpound.solvers.fast.plan import OUTPUT, T
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
from eventpound.solvers.fast.single_run import Run
from eventpound.solvers.fast.single_step import FREE, TURNED


@compiled
def _tangent(w: Floats) -> float:
    """Tangent stiffness for each unit of mass (1/s²), where the link is on a line."""
    hysteretic = w[STRENGTH] > 0.0 and w[PART] <= UNLOADING
    return w[STIFFNESS] + (w[STRENGTH] * w[PER_SCALE] if hysteretic else 0.0)


@compiled
def free_swing(stop: float, run: Run) -> float:
    """Time to the next turn of the body, or to `stop` (s), or -1 where it may meet something.

    What the motion is there stands as at the end of a step.
    """
    w, hysteretic = run.w, run.w[STRENGTH] > 0.0
    v, a, tangent = w[V], w[A], _tangent(w)
    if (hysteretic and v != 0.0) or w[DAMPING] > 0.0 or not tangent > 0.0:
        return -1.0
    # At the level of rounding the ordinary step knows better which way the body goes.
    if 0.0 < abs(v) <= w[STILL] or (v == 0.0 and abs(a) <= w[NO_ACCELERATION]):
        return -1.0
    way = math.copysign(1.0, v if v != 0.0 else a)
    if not _turns_first(way, tangent, hysteretic, w):
        return -1.0
    omega, left = math.sqrt(tangent), stop - run.clock[T]
    y, r = -a / tangent, v / omega
    tau, rate = math.atan2(abs(r), way * y) / omega, 0.0
    # R - |y| of a small swing far from equilibrium without its cancellation.
    far = math.sqrt(y * y + r * r) + abs(y)
    change = way * (r * r / far if way * y > 0.0 else far)
    if tau >= left:
        tau = left
        change, rate = _harmonic(tau, omega, y, r)
    w[CHANGE], w[RATE], w[BEND] = change, rate, -tangent * (y + change)
    return tau if _fits(tau, run) else -1.0


@compiled
def _turns_first(way: float, tangent: float, hysteretic: bool, w: Floats) -> bool:
    """Whether a barrier and the border of the backbone are further away than the turn.

    They are at a distance d where ``y + d > R``; both sides are multiplied by k.
    """
    a, reach = w[A], (w[RIGHT] if way > 0.0 else w[LEFT]) - w[OWN]
    if hysteretic:
        part, on_curve = w[PART], way * w[SIGMA]
        if DOWN <= part <= UP or (part != CORE and on_curve < 0.0):
            return False
        if part != CORE and 2.0 * abs(a) <= tangent * w[STANDING]:
            return False
        if part <= UNLOADING:
            reach = min(reach, (w[CORE_END] - on_curve * place_of(w[U], w)) * w[SCALE])
    beyond = tangent * reach - way * a
    return bool(beyond > 0.0 and beyond * beyond > a * a + tangent * w[V] * w[V])


@compiled
def _fits(tau: float, run: Run) -> bool:
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


@compiled
def swing_freely(tau: float, stop: float, run: Run) -> int:
    """Take the step that `free_swing` has found; GOING_ON, or why not."""
    w, count, times, t = run.w, run.count, run.times, run.clock[T]
    t_end = stop if tau == stop - t else t + tau
    if count[OUTPUT] < times.size and times[count[OUTPUT]] < t_end:
        _write_rows(t, t_end, run)
    turned = w[RATE] == 0.0
    event = TURNED if turned and w[STRENGTH] > 0.0 and w[PART] != CORE else FREE
    return arrive(tau, t_end, turned, event, run)


@compiled_apart
def _write_rows(t: float, t_end: float, run: Run) -> None:
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
