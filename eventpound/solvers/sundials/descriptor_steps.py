"""Between the event loop's clusters and the descriptor form: starts, and steps examined.

The loop keeps one coordinate a cluster; here every body has its own, and what
the loop is shown of a step (`eventpound.mechanics.observables.Observed`) comes
from the unknowns of the descriptor form, contact forces included.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.clusters import is_support
from eventpound.mechanics.descriptor_motion import (
    DescriptorProblem,
    constraint_errors,
    solve_contact_forces,
    to_moving_frame,
)
from eventpound.mechanics.descriptor_observation import observe_descriptor
from eventpound.mechanics.ground_frame import frame_motion
from eventpound.mechanics.monitored import (
    Running,
    is_motion,
    motion_of,
    update_extremes,
    update_turning_point,
)
from eventpound.mechanics.observables import Bodies, Observed
from eventpound.mechanics.reduced import Reduced
from eventpound.numerics.arrays import Floats
from eventpound.numerics.borrowing import copy_numbers
from eventpound.numerics.compiled import kernel
from eventpound.numerics.small_systems import dot
from eventpound.solvers.events.event_bounds import inspect_step
from eventpound.solvers.events.step_check import CLEAR, MARKED, Examination, audit
from eventpound.solvers.sundials.memory import Tolerances
from eventpound.tolerances import FIRST_STEP, FIRST_TRIAL, SLOW_TURN

NEAR = 3.0
"""Times the reach of rounding about a peak within which the end of a step is the same peak."""


class Followed(NamedTuple):
    """A problem whose steps are examined.

    drift (2,): largest gap (m) and gap rate (m/s) of resting contacts so far; updated.
    acceleration: the scene's own, L/T² (m/s²).
    """

    problem: DescriptorProblem
    drift: Floats
    acceleration: float


@kernel
def from_clusters(clusters: Floats, system: Reduced, bodies: Bodies, y: Floats) -> None:
    """Positions, velocities, z and ledger of the descriptor form from the loop's state."""
    N, H = bodies.mass.size - bodies.weights.shape[0], bodies.z_of.size
    y[:] = 0.0
    for b in range(N):
        c = bodies.of_body[b]
        y[b] = bodies.offset[b]
        if c >= 0:
            y[b] += clusters[system.iq[c]]
            y[N + b] = clusters[system.iv[c]]
    for h in range(H):
        place = bodies.z_of[h]
        # Here a z that stands still is an unknown like any other.
        y[2 * N + h] = clusters[place] if place >= 0 else bodies.frozen_z[h]
    if system.ledger >= 0:
        copy_numbers(clusters[system.ledger :], y[y.size - (clusters.size - system.ledger) :])


@kernel
def to_clusters(y: Floats, share: float, system: Reduced, bodies: Bodies, clusters: Floats) -> None:
    """The loop's state: clusters move with the momentum of their bodies, or with a support.

    `share` of the bodies' offsets in their clusters is in `y`: all, or none of a derivative.
    """
    N, H = bodies.mass.size - bodies.weights.shape[0], bodies.z_of.size
    clusters[:] = 0.0
    for d in range(bodies.weights.shape[0]):
        c = bodies.of_body[N + d]
        # Points alone have no mass: they are where their bodies put them.
        if c >= 0 and bodies.cluster_mass[c] == 0.0:
            u, v = dot(bodies.weights[d, :N], y[:N]), dot(bodies.weights[d, :N], y[N : 2 * N])
            clusters[system.iq[c]], clusters[system.iv[c]] = u - share * bodies.offset[N + d], v
    for b in range(N):
        c = bodies.of_body[b]
        if c >= 0 and not is_support(b, bodies.mass):
            part = bodies.mass[b] / bodies.cluster_mass[c]
            clusters[system.iq[c]] += part * (y[b] - share * bodies.offset[b])
            clusters[system.iv[c]] += part * y[N + b]
    # Backwards: of several supports in a cluster the first one counts.
    for b in range(N - 1, -1, -1):
        c = bodies.of_body[b]
        if c >= 0 and is_support(b, bodies.mass):
            clusters[system.iq[c]] = y[b] - share * bodies.offset[b]
            clusters[system.iv[c]] = y[N + b]
    for h in range(H):
        if bodies.z_of[h] >= 0:
            clusters[bodies.z_of[h]] = y[2 * N + h]
    if system.ledger >= 0:
        copy_numbers(y[y.size - (clusters.size - system.ledger) :], clusters[system.ledger :])


@kernel
def consistent(
    tau: float, y: Floats, rate: Floats, problem: DescriptorProblem, scratch: Observed
) -> None:
    """Make λ and every rate agree with the positions, velocities and z; then enter the frame."""
    d, frame = problem.d, problem.frame
    N = d.mass.size
    # Relative to the ground; the frame comes last.
    solve_contact_forces(tau, y, problem)
    observe_descriptor(tau, y, problem, rate, scratch)
    to_moving_frame(problem, tau, 1.0, y)
    if frame.shape[1] > 0:
        _, v, a = frame_motion(frame, problem.forcing.start + tau)
        for b in range(N):
            rate[b] += d.framed[b] * v
            rate[N + b] += d.framed[b] * a


@kernel
def begin_descriptor(
    tau: float,
    y: Floats,
    rate: Floats,
    problem: DescriptorProblem,
    tolerances: Tolerances,
    time: float,
    scratch: Observed,
) -> float:
    """Consistent contact forces and rates of a start; the length of a first step (s).

    A step of order one of that length errs by half a tolerance, ``h² |y''| / 2``. y'' is a
    difference of rates over the time in which a body moves by one tolerance (Hairer, Nørsett
    and Wanner, "Solving ODEs I", II.4). SUNDIALS' own guess is as long as that time and leaves some
    twenty doublings to be made.

    Parameters
    ----------
    tau : float
        Local time (s).
    y, rate : ndarray, shape (size,)
        Unknowns of `from_clusters`, and room for their rates; overwritten, in the frame.
    problem : DescriptorProblem
        The mode in descriptor form.
    tolerances : Tolerances
        Of a step.
    time : float
        The scene's own T (s).
    scratch : Observed
        Overwritten.
    """
    consistent(tau, y, rate, problem, scratch)
    d = problem.d
    last = 2 * d.mass.size + d.hysteretic
    fastest, tolerance = 0.0, np.empty(last)
    # λ, which the error test leaves out, and the ledger count for nothing here.
    for i in range(last):
        tolerance[i] = tolerances.atol[i] + tolerances.rtol * abs(y[i])
        fastest = max(fastest, abs(rate[i]) / tolerance[i])
    h = min(1.0 / fastest, FIRST_TRIAL * time) if fastest > 0.0 else FIRST_TRIAL * time
    ahead, rate_ahead = y.copy(), np.zeros(y.size)
    for i in range(last):
        ahead[i] += h * rate[i]
    # `consistent` begins relative to the ground.
    to_moving_frame(problem, tau + h, -1.0, ahead)
    consistent(tau + h, ahead, rate_ahead, problem, scratch)
    curvature = 0.0
    for i in range(last):
        curvature = max(curvature, abs(rate_ahead[i] - rate[i]) / (h * tolerance[i]))
    longest = FIRST_STEP * time
    return min(1.0 / np.sqrt(curvature), longest) if curvature > 0.0 else longest


@kernel
def _turn(
    i: int,
    start: tuple[float, float],
    end: tuple[float, float],
    t: float,
    h: float,
    slow: float,
    running: Running,
) -> None:
    """Take a turning point in a short step of h from t on (s) into the extremes of quantity i.

    `start` and `end` are value and rate; one that turns by less than `slow` (m/s²) is
    left alone, as its rate may be rounding. Where the hysteresis turns with the motion, IDA's
    steps are so short that the inspection finds them flat, and ends of several of them
    lie within rounding of the peak, over a time ``sqrt(2 rounding / |x''|)``.
    """
    curvature = abs(end[1] - start[1]) / h
    if start[1] * end[1] >= 0.0 or curvature < slow:
        return
    after = start[1] / (start[1] - end[1]) * h
    near = NEAR * np.sqrt(2.0 * running.rounding[i] / curvature)
    # The parabola through value and rate at the start and the rate at the end.
    value = start[0] + 0.5 * start[1] * after
    update_turning_point(i, value, t + after, near, running)


@kernel
def _short_turns(
    before: Observed, after: Observed, t: float, h: float, slow: float, running: Running
) -> None:
    """Turning points of displacements, elongations and gaps in a step that was not marked.

    It begins at t and is h long (s).
    """
    at = running.at
    for i in range(at.gap, at.end):
        if is_motion(i, at):
            start, end = motion_of(i, at, before), motion_of(i, at, after)
            _turn(i, start[:2], end[:2], t, h, slow, running)


@kernel
def examine_descriptor(
    tau_0: float,
    tau_1: float,
    first: int,
    z_allowed: float,
    y: Floats,
    e: Examination,
    followed: Followed,
) -> tuple[int, float]:
    """`eventpound.solvers.events.step_check.examine` for the unknowns of the descriptor form.

    Parameters
    ----------
    tau_0, tau_1, first, z_allowed, e
        As there; no sample of a record lies within the step.
    y : ndarray, shape (size,)
        Unknowns at the end, relative to the ground.
    followed : Followed
        Whose steps.
    """
    problem, drift = followed.problem, followed.drift
    forcing, mode, last = e.forcing, e.dynamics, 1 - first
    after = e.observations[last]
    rate = np.zeros(y.size)
    observe_descriptor(tau_1, y, problem, rate, after)
    to_clusters(y, 1.0, mode.system, mode.bodies, e.y[last])
    verdict, excess = audit(y, rate, after, z_allowed, e)
    if verdict != CLEAR:
        return verdict, excess
    gap, gap_rate = constraint_errors(problem.d, y)
    # Also of steps that are marked.
    drift[0], drift[1] = max(drift[0], gap), max(drift[1], gap_rate)
    before, running = e.observations[first], e.record.running
    if inspect_step(before, after, tau_1 - tau_0, mode.watched, running, e.marks):
        return MARKED, excess
    update_extremes(after, forcing.start + tau_1, running)
    t, slow = forcing.start + tau_0, SLOW_TURN * followed.acceleration
    _short_turns(before, after, t, tau_1 - tau_0, slow, running)
    return CLEAR, excess


@kernel
def observe_interpolated(tau: float, y: Floats, problem: DescriptorProblem, out: Observed) -> None:
    """Observe an interpolated state: its contact forces from their equations.

    An interpolating polynomial of λ would carry the kinks of a record, and is
    left out of IDA's error test.
    """
    rate = np.zeros(y.size)
    solve_contact_forces(tau, y, problem)
    observe_descriptor(tau, y, problem, rate, out)
