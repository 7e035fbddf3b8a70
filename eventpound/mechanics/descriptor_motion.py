"""Residual of a contact mode in descriptor form, ``F(t, y, y') = 0``, and its Jacobian.

y and the equations are those of `eventpound.mechanics.descriptor`. In a moving
frame (`eventpound.mechanics.ground_frame`) the positions and velocities of the
bodies it carries are ``u + s`` and ``v + s'``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.descriptor import Descriptor
from eventpound.mechanics.elements import (
    drag,
    drag_slope,
    link_force,
    number_beside,
    pull_per_z,
    slope_beside,
    z_rate,
    z_slopes,
)
from eventpound.mechanics.followers import acceleration_of, force_or_given, own_mass, supports_of
from eventpound.mechanics.ground_frame import frame_motion
from eventpound.mechanics.reduced import Forcing
from eventpound.motion.forcing import ground_acceleration
from eventpound.motion.loads import (
    LOADED,
    add_body_loads,
    body_of,
    is_driven,
    rows_of,
    support_motion,
)
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import kernel
from eventpound.numerics.small_systems import dot


class DescriptorProblem(NamedTuple):
    """A mode in descriptor form, a piece of the ground motion, and the moving frame (4, n).

    n is 0 for no frame. Times tau (s) count from the start of the piece. drift (2,): largest gap
    (m) and gap rate (m/s) of a resting contact so far, which who examines steps brings up to date.
    """

    d: Descriptor
    forcing: Forcing
    frame: Floats
    drift: Floats


@kernel
def _link_loads(d: Descriptor, y: Floats, z_rates: Floats, loads: Floats) -> None:
    """Rates of z (H,), and what the links put on each body (N,), ``-Σ_l B_l F_l``."""
    N = d.mass.size
    loads[:] = 0.0
    for link in range(d.stiffness.size):
        x, x_rate = dot(d.B[link], y[:N]), dot(d.B[link], y[N : 2 * N])
        h = d.z_of_link[link]
        z = y[2 * N + h] if h >= 0 else 0.0
        if h >= 0:
            beside = y[2 * N + d.z_of_link[number_beside(link, d.memory)]]
            z_rates[h] = z_rate(link, d.memory, x_rate, x_rate, z, beside)
        force = link_force(link, d, x, x_rate, z)
        for b in range(N):
            loads[b] -= d.B[link, b] * force


@kernel
def _accelerations(d: Descriptor, loads: Floats, contact: Floats, ground: float) -> Floats:
    """``u'' = M⁻¹ (loads + W λ) - 1 a_g``; of a support `loads` (N,) is the acceleration."""
    a = np.empty(d.mass.size)
    for b in range(a.size):
        total = loads[b]
        for j in range(contact.size):
            total += d.W[j, b] * contact[j]
        a[b] = acceleration_of(b, force_or_given(b, total, loads[b], d.mass), d.mass) - ground
    return a


@kernel
def to_moving_frame(problem: DescriptorProblem, tau: float, sign: float, y: Floats) -> float:
    """Add (sign +1) or take away (-1) the motion of the frame at tau, in place; its s'' (m/s²).

    Where there are loads there is no frame, and supports are put where they are at tau.
    """
    d, frame, forcing = problem.d, problem.frame, problem.forcing
    if forcing.family == LOADED:
        for row in range(1, rows_of(forcing.coefficients) + 1):
            if is_driven(row, forcing.coefficients):
                b = body_of(row, forcing.coefficients)
                y[b], y[d.mass.size + b] = support_motion(row, forcing, forcing.start + tau)
    if frame.shape[1] == 0:
        return 0.0
    N = d.mass.size
    s, v, a = frame_motion(frame, forcing.start + tau)
    for b in range(N):
        y[b] += sign * d.framed[b] * s
        y[N + b] += sign * d.framed[b] * v
    return a


@kernel
def relative_to_ground(tau: float, y: Floats, problem: DescriptorProblem) -> Floats:
    """Unknowns at tau that are those in the moving frame, relative to the ground.

    Supports, which IDA carries so that its steps are as short as their motion demands, are in
    their places.
    """
    result = y.copy()
    to_moving_frame(problem, tau, -1.0, result)
    return result


@kernel
def residual(tau: float, y: Floats, rate: Floats, out: Floats, problem: DescriptorProblem) -> None:
    """Fill `out` with F(t, y, y') at ``t = forcing.start + tau``.

    Parameters
    ----------
    tau : float
        Time since the start of the segment (s).
    y, rate, out : ndarray, shape (size,)
        Unknowns and their rates, in the frame; the residual in m/s (free u), m/s²
        (free v and λ), 1/s (z), m and m/s (u and v of dependent bodies). Rows of the ledger,
        from which nothing follows, are left as they are.
    problem : DescriptorProblem
        Whose equations.
    """
    d, forcing = problem.d, problem.forcing
    N, H, R, t = d.mass.size, d.hysteretic, d.opening.size, forcing.start + tau
    ground = ground_acceleration(forcing, t)
    relative = y.copy()
    lift = to_moving_frame(problem, tau, -1.0, relative)
    z_rates, loads = np.empty(H), np.empty(N)
    _link_loads(d, relative, z_rates, loads)
    if forcing.family == LOADED:
        add_body_loads(forcing, t, loads, loads)
    a = _accelerations(d, loads, relative[2 * N + H : 2 * N + H + R], ground)
    for b in range(N):
        out[b] = rate[b] - y[N + b]
        # In the frame the velocity is v + s', and its rate has s'' beside the acceleration.
        out[N + b] = rate[N + b] - a[b] - d.framed[b] * lift
    for j in range(R):
        # After the loop over all bodies: these take the place of u' = v and of the momentum of one.
        out[d.dependent[j]] = d.opening[j] + dot(d.W[j], relative[:N])
        out[N + d.dependent[j]] = dot(d.W[j], relative[N : 2 * N])
        out[2 * N + H + j] = dot(d.W[j], a)
    for h in range(H):
        out[2 * N + h] = rate[2 * N + h] - z_rates[h]


@kernel
def constraint_errors(d: Descriptor, y: Floats) -> tuple[float, float]:
    """Largest gap (m) and gap rate (m/s) of a resting contact, by their sizes."""
    N = d.mass.size
    gap, gap_rate = 0.0, 0.0
    # Also of those that no λ keeps closed, since others do.
    for i in range(d.resting.size):
        j = d.resting[i]
        gap = max(gap, abs(d.all_openings[j] + dot(d.all_gaps[j], y[:N])))
        gap_rate = max(gap_rate, abs(dot(d.all_gaps[j], y[N : 2 * N])))
    return gap, gap_rate


@kernel
def _acceleration_slopes(d: Descriptor, x_rate: Floats, slopes: Floats) -> None:
    """Add ∂u''/∂y, shape (N, size)."""
    N, H = d.mass.size, d.hysteretic
    for link in range(d.stiffness.size):
        by_rate = drag_slope(link, d, x_rate[link])
        for b in range(N):
            pull = -d.B[link, b] / d.mass[b]
            # It is zero for a support, too, whose mass is infinite.
            if pull == 0.0:
                continue
            for c in range(N):
                slopes[b, c] += pull * d.stiffness[link] * d.B[link, c]
                slopes[b, N + c] += pull * by_rate * d.B[link, c]
            if d.z_of_link[link] >= 0:
                slopes[b, 2 * N + d.z_of_link[link]] += pull * pull_per_z(link, d.memory)
    for b in range(N):
        for j in range(d.opening.size):
            slopes[b, 2 * N + H + j] = d.W[j, b] / d.mass[b]


@kernel
def _ledger_slopes(d: Descriptor, y: Floats, x_rate: Floats, ground: float, J: Floats) -> None:
    """Rows of the ledger in the Jacobian, but for their own rates.

    Of the work of loads and of supports they know nothing: nothing follows from the ledger, so
    Newton's iteration needs one step more and no other.
    """
    N, first = d.mass.size, d.ledger
    # The signs are those of `residual`: the rate less what it should be.
    for b in range(N):
        J[first, N + b] = own_mass(b, d.mass) * ground
    for link in range(d.stiffness.size):
        h, q, rate = d.z_of_link[link], pull_per_z(link, d.memory), x_rate[link]
        by_rate = drag(link, d, rate) + drag_slope(link, d, rate) * rate
        for b in range(N):
            J[first + 1, N + b] -= by_rate * d.B[link, b]
            if h >= 0:
                J[first + 2, N + b] -= q * y[2 * N + h] * d.B[link, b]
        if h >= 0:
            J[first + 2, 2 * N + h] -= q * rate


@kernel
def _constraint_slopes(d: Descriptor, slopes: Floats, J: Floats) -> None:
    """Rows of dependent bodies and of λ: gaps, their rates and their accelerations."""
    N, first = d.mass.size, 2 * d.mass.size + d.hysteretic
    for j in range(d.opening.size):
        body = d.dependent[j]
        # No rate is in the equation of a dependent body, so c_j goes with the rest of its row.
        J[body, :] = 0.0
        J[N + body, :] = 0.0
        for b in range(N):
            if d.W[j, b] == 0.0:
                continue
            J[body, b] = J[N + body, N + b] = d.W[j, b]
            for i in range(d.size):
                J[first + j, i] += d.W[j, b] * slopes[b, i]


@kernel
def _z_slopes(d: Descriptor, y: Floats, x_rate: Floats, cj: float, J: Floats) -> None:
    """Rows of z."""
    N = d.mass.size
    for link in range(x_rate.size):
        h = d.z_of_link[link]
        if h < 0:
            continue
        memory, rate = d.memory, x_rate[link]
        other = 2 * N + d.z_of_link[number_beside(link, memory)]
        by_rate, by_z = z_slopes(link, memory, rate, y[2 * N + h], y[other])
        # Before the entry of z itself: where nothing stands beside it this is the same place.
        J[2 * N + h, other] = -slope_beside(link, memory, rate, y[2 * N + h], y[other])
        J[2 * N + h, 2 * N + h] = cj - by_z
        for b in range(N):
            J[2 * N + h, N + b] = -by_rate * d.B[link, b]


@kernel
def jacobian(tau: float, y: Floats, cj: float, J: Floats, problem: DescriptorProblem) -> None:
    """Fill J, ``∂F/∂y + c_j ∂F/∂y'``, shape (size, size).

    Parameters
    ----------
    tau, y, problem
        As of `residual`.
    cj : float
        c_j (1/s), the leading coefficient of the method over the step.
    J : ndarray, shape (size, size)
        Overwritten.
    """
    d, forcing = problem.d, problem.forcing
    N, t = d.mass.size, forcing.start + tau
    relative = relative_to_ground(tau, y, problem)
    x_rate = np.empty(d.stiffness.size)
    for link in range(x_rate.size):
        x_rate[link] = dot(d.B[link], relative[N : 2 * N])
    slopes = np.zeros((N, d.size))
    _acceleration_slopes(d, x_rate, slopes)
    J[:] = 0.0
    for b in range(N):
        J[b, b], J[b, N + b] = cj, -1.0
        for i in range(d.size):
            J[N + b, i] = -slopes[b, i]
        J[N + b, N + b] += cj
    _constraint_slopes(d, slopes, J)
    _z_slopes(d, relative, x_rate, cj, J)
    if d.ledger >= 0:
        ground = ground_acceleration(forcing, t)
        _ledger_slopes(d, relative, x_rate, ground, J)
        # Weighed as the rows of `residual` are, their own rates included.
        for i in range(d.ledger, d.size):
            J[i, i] = cj
            for k in range(d.size):
                J[i, k] *= d.ledger_weight
    for b in supports_of(d.mass):
        # Others follow its given motion.
        J[:, b], J[:, N + b] = 0.0, 0.0
        J[b, b] = J[N + b, N + b] = cj
        J[b, N + b] = -1.0
