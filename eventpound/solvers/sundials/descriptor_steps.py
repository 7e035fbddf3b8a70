"""Between the event loop's clusters and the descriptor form: starts, and steps examined.

The loop keeps one coordinate a cluster; here every body has its own. What the loop is shown
of a step, it observes of its own state, made of the unknowns of the descriptor form.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.descriptor_motion import (
    DescriptorProblem,
    constraint_errors,
    relative_to_ground,
    residual,
    to_moving_frame,
)
from eventpound.mechanics.followers import place_points
from eventpound.mechanics.ground_frame import frame_motion
from eventpound.mechanics.observables import Bodies, Observed, observe_motion
from eventpound.mechanics.reduced import Reduced, put_clusters
from eventpound.numerics.arrays import Floats
from eventpound.numerics.borrowing import copy_numbers
from eventpound.numerics.compiled import kernel
from eventpound.solvers.events.run import Dynamics
from eventpound.solvers.events.step_check import CLEAR, MARKED, Examination, examine, rate_at
from eventpound.solvers.sundials.memory import Tolerances
from eventpound.tolerances import FIRST_STEP, FIRST_TRIAL


@kernel
def to_clusters(y: Floats, share: float, system: Reduced, bodies: Bodies, clusters: Floats) -> None:
    """The loop's state: clusters move with the momentum of their bodies, or with a support.

    `share` of the bodies' offsets in their clusters is in `y`: all, or none of a derivative.
    """
    N, H = bodies.mass.size - bodies.weights.shape[0], bodies.z_of.size
    u, v = np.empty(bodies.mass.size), np.empty(bodies.mass.size)
    for b in range(N):
        u[b], v[b] = y[b], y[N + b]
    place_points(bodies.weights, u)
    place_points(bodies.weights, v)
    clusters[:] = 0.0
    put_clusters(u, v, share, bodies, bodies.mass, system, clusters)
    for h in range(H):
        if bodies.z_of[h] >= 0:
            clusters[bodies.z_of[h]] = y[2 * N + h]
    if system.ledger >= 0:
        copy_numbers(y[y.size - (clusters.size - system.ledger) :], clusters[system.ledger :])


@kernel
def full_residual(
    tau: float, y: Floats, rate: Floats, out: Floats, problem: DescriptorProblem, mode: Dynamics
) -> None:
    """`residual`, and the rows of the energy ledger, whose rates are those that the loop counts."""
    residual(tau, y, rate, out, problem)
    d, system = problem.d, mode.system
    if d.ledger < 0:
        return
    state, moved = np.empty(system.size), np.empty(system.size)
    to_clusters(y, 1.0, system, mode.bodies, state)
    rate_at(tau, state, moved, system, problem.forcing, problem.frame)
    for i in range(d.ledger, d.size):
        put_in = moved[system.ledger + i - d.ledger]
        # Small, for none of these rows may become the pivot of another unknown.
        out[i] = d.ledger_weight * (rate[i] - put_in)


@kernel
def _consistent(
    tau: float,
    state: Floats,
    y: Floats,
    rate: Floats,
    problem: DescriptorProblem,
    mode: Dynamics,
    scratch: Observed,
) -> Floats:
    """Unknowns and their rates, in the frame, of a state of the loop, whose rate is returned."""
    d, frame, system, bodies = problem.d, problem.frame, mode.system, mode.bodies
    N, H, moved = d.mass.size, d.hysteretic, np.empty(state.size)
    observe_motion(tau, state, moved, system, bodies, problem.forcing, scratch)
    for b in range(N):
        y[b], y[N + b] = scratch.u[b], scratch.v[b]
        rate[b], rate[N + b] = scratch.v[b], scratch.a[b]
    for h in range(H):
        place = bodies.z_of[h]
        # Here a z that stands still is an unknown like any other.
        y[2 * N + h] = state[place] if place >= 0 else bodies.frozen_z[h]
        rate[2 * N + h] = moved[place] if place >= 0 else 0.0
    for i in range(d.carrying.size):
        y[2 * N + H + i], rate[2 * N + H + i] = scratch.contact_force[:, d.carrying[i]]
    if d.ledger >= 0:
        copy_numbers(state[system.ledger :], y[d.ledger :])
        copy_numbers(moved[system.ledger :], rate[d.ledger :])
    to_moving_frame(problem, tau, 1.0, y)
    if frame.shape[1] > 0:
        _, v, a = frame_motion(frame, problem.forcing.start + tau)
        for b in range(N):
            rate[b] += d.framed[b] * v
            rate[N + b] += d.framed[b] * a
    return moved


@kernel
def begin_descriptor(
    tau: float,
    state: Floats,
    y: Floats,
    rate: Floats,
    problem: DescriptorProblem,
    mode: Dynamics,
    tolerances: Tolerances,
    time: float,
    scratch: Observed,
) -> float:
    """Consistent unknowns and rates of a start; the length of a first step (s).

    A step of order one of that length errs by half a tolerance, ``h² |y''| / 2``. y'' is a
    difference of rates over the time in which a body moves by one tolerance (Hairer, Nørsett
    and Wanner, "Solving ODEs I", II.4). SUNDIALS' own guess is as long as that time and leaves some
    twenty doublings to be made.

    Parameters
    ----------
    tau : float
        Local time (s).
    state : ndarray
        The loop's.
    y, rate : ndarray, shape (size,)
        Overwritten, in the frame.
    problem, mode : DescriptorProblem, Dynamics
        The mode in descriptor form, and as the loop has it.
    tolerances : Tolerances
        Of a step.
    time : float
        The scene's own T (s).
    scratch : Observed
        Overwritten.
    """
    moved = _consistent(tau, state, y, rate, problem, mode, scratch)
    last = 2 * problem.d.mass.size + problem.d.hysteretic
    fastest, tolerance = 0.0, np.empty(last)
    # λ, which the error test leaves out, and the ledger count for nothing here.
    for i in range(last):
        tolerance[i] = tolerances.atol[i] + tolerances.rtol * abs(y[i])
        fastest = max(fastest, abs(rate[i]) / tolerance[i])
    h = min(1.0 / fastest, FIRST_TRIAL * time) if fastest > 0.0 else FIRST_TRIAL * time
    ahead, y_ahead, rate_ahead = state.copy(), np.empty(y.size), np.empty(y.size)
    for i in range(state.size):
        ahead[i] += h * moved[i]
    _consistent(tau + h, ahead, y_ahead, rate_ahead, problem, mode, scratch)
    curvature = 0.0
    for i in range(last):
        curvature = max(curvature, abs(rate_ahead[i] - rate[i]) / (h * tolerance[i]))
    longest = FIRST_STEP * time
    return min(1.0 / np.sqrt(curvature), longest) if curvature > 0.0 else longest


@kernel
def examine_descriptor(
    tau_0: float,
    tau_1: float,
    first: int,
    z_allowed: float,
    y: Floats,
    problem: DescriptorProblem,
    e: Examination,
) -> tuple[int, float]:
    """`eventpound.solvers.events.step_check.examine` of unknowns (size,), in the frame.

    The drift of the problem is brought up to date.
    """
    mode, drift, relative = e.dynamics, problem.drift, relative_to_ground(tau_1, y, problem)
    to_clusters(relative, 1.0, mode.system, mode.bodies, e.y[1 - first])
    verdict, excess = examine(tau_0, tau_1, first, z_allowed, e)
    if verdict in (CLEAR, MARKED):
        gap, gap_rate = constraint_errors(problem.d, relative)
        drift[0], drift[1] = max(drift[0], gap), max(drift[1], gap_rate)
    return verdict, excess
