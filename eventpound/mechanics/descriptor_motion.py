"""Residual of a contact mode in descriptor form, ``F(t, y, y') = 0``, and its Jacobian.

y and the equations are those of `eventpound.mechanics.descriptor`. In a moving
frame (`eventpound.mechanics.ground_frame`) the positions and velocities of the
bodies it carries are ``u + s`` and ``v + s'``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.mechanics.clusters import is_support
from eventpound.mechanics.descriptor import Descriptor
from eventpound.mechanics.elements import (
    link_force,
    number_beside,
    pull_per_z,
    slope_beside,
    z_rate,
    z_slopes,
)
from eventpound.mechanics.ground_frame import frame_motion
from eventpound.mechanics.model import WORK_OF_SUPPORTS
from eventpound.mechanics.reduced import Forcing
from eventpound.motion.forcing import ground_acceleration
from eventpound.motion.loads import (
    LOADED,
    add_body_loads,
    body_of,
    is_driven,
    load_value,
    rows_of,
    support_motion,
)
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import kernel
from eventpound.numerics.small_systems import dot


class DescriptorProblem(NamedTuple):
    """A mode in descriptor form, a piece of the ground motion, and the moving frame (4, n).

    n is 0 for no frame. Times tau (s) count from the start of the piece.
    """

    d: Descriptor
    forcing: Forcing
    frame: Floats


@kernel
def body_loads(d: Descriptor, forces: Floats, loads: Floats) -> None:
    """What the links put on each body, ``-Σ_l B_l F_l``."""
    for b in range(d.mass.size):
        total = 0.0
        for link in range(forces.size):
            total -= d.B[link, b] * forces[link]
        loads[b] = total


@kernel
def accelerations(d: Descriptor, loads: Floats, contact: Floats, ground: float, a: Floats) -> None:
    """``u'' = M⁻¹ (loads + W λ) - 1 a_g``; of a support `loads` (N,) is the acceleration."""
    for b in range(d.mass.size):
        total = loads[b]
        for j in range(contact.size):
            total += d.W[j, b] * contact[j]
        a[b] = total / d.mass[b] - ground
        if is_support(b, d.mass):
            a[b] = loads[b] - ground


@kernel
def contact_forces(d: Descriptor, loads: Floats, ground: float, contact: Floats) -> None:
    """λ of ``Wᵀ u'' = 0``."""
    closing, a = np.empty(contact.size), np.empty(d.mass.size)
    # With no contact force at first: λ is what takes the rest of Wᵀ u'' to zero.
    accelerations(d, loads, contact[:0], ground, a)
    for j in range(contact.size):
        closing[j] = -dot(d.W[j], a)
    for j in range(contact.size):
        contact[j] = dot(d.inverse_coupling[j], closing)


@kernel
def link_states(
    d: Descriptor, y: Floats, elongation: Floats, z_rates: Floats, forces: Floats
) -> None:
    """Elongations and their rates (2 rows or more), rates of z and forces of the links."""
    N, law = d.mass.size, d.law
    for link in range(forces.size):
        x, x_rate = dot(d.B[link], y[:N]), dot(d.B[link], y[N : 2 * N])
        h, k, c = d.z_of_link[link], d.stiffness[link], law.damping[link]
        z = y[2 * N + h] if h >= 0 else 0.0
        if h >= 0:
            beside = y[2 * N + d.z_of_link[number_beside(link, law.memory)]]
            z_rates[h] = z_rate(link, law.memory, x_rate, x_rate, z, beside)
        elongation[0, link], elongation[1, link] = x, x_rate
        forces[link] = link_force(link, law.memory, k, d.preload[link], c, x, x_rate, z)


@kernel
def _pushed(
    tau: float, y: Floats, problem: DescriptorProblem
) -> tuple[Floats, Floats, Floats, Floats]:
    """What moves the bodies at tau, contacts apart: all that acts on each, (N,), is the last.

    Of a support it is the acceleration (m/s²). Before it the links: rates of their elongations
    (L,), rates of z (H,), and their forces (L,).
    """
    d, forcing = problem.d, problem.forcing
    elongation, forces = np.empty((2, d.stiffness.size)), np.empty(d.stiffness.size)
    z_rates, loads = np.empty(d.hysteretic), np.empty(d.mass.size)
    link_states(d, y, elongation, z_rates, forces)
    body_loads(d, forces, loads)
    if forcing.family == LOADED:
        add_body_loads(forcing, forcing.start + tau, loads, loads)
    return elongation[1], z_rates, forces, loads


@kernel
def ledger_rates(d: Descriptor, y: Floats, x_rate: Floats, ground: float, rates: Floats) -> None:
    """Rates of input ``-Σ m v a_g``, viscous ``Σ c x'²`` and hysteretic work ``Σ Q z x'``."""
    N = d.mass.size
    rates[:] = 0.0
    for b in range(N):
        # The mass of a support is infinite; what it puts in has a row of its own.
        rates[0] -= 0.0 if is_support(b, d.mass) else d.mass[b] * y[N + b] * ground
    for link in range(d.stiffness.size):
        rates[1] += d.law.damping[link] * x_rate[link] * x_rate[link]
        h = d.z_of_link[link]
        if h >= 0:
            rates[2] += pull_per_z(link, d.law.memory) * y[2 * N + h] * x_rate[link]


@kernel
def loaded_powers(
    tau: float, y: Floats, problem: DescriptorProblem, pulled: Floats, rates: Floats
) -> None:
    """Add the power of forces, and of supports, to the `rates` of the ledger.

    `pulled` (N,): what the links put on each body, ``-Σ_l B_l F_l`` (N). A support resists them
    and its contacts. `rates` are in W.
    """
    d, forcing = problem.d, problem.forcing
    N, first = d.mass.size, 2 * d.mass.size + d.hysteretic
    coefficients = forcing.coefficients
    for row in range(1, rows_of(coefficients) + 1):
        b = body_of(row, coefficients)
        if is_driven(row, coefficients):
            total = pulled[b]
            for j in range(d.opening.size):
                total += d.W[j, b] * y[first + j]
            # The support holds against links and contacts, so it does the negative of their work.
            rates[WORK_OF_SUPPORTS + b] = -total * y[N + b]
        else:
            rates[0] += y[N + b] * load_value(row, forcing, forcing.start + tau)


@kernel
def to_moving_frame(problem: DescriptorProblem, tau: float, sign: float, y: Floats) -> None:
    """Add (sign +1) or take away (-1) the motion of the frame at tau, in place.

    Where there are loads there is no frame, and supports are put where they are at tau.
    """
    d, frame, forcing = problem.d, problem.frame, problem.forcing
    if forcing.family == LOADED:
        for row in range(1, rows_of(forcing.coefficients) + 1):
            if is_driven(row, forcing.coefficients):
                b = body_of(row, forcing.coefficients)
                y[b], y[d.mass.size + b] = support_motion(row, forcing, forcing.start + tau)
    if frame.shape[1] == 0:
        return
    N = d.mass.size
    s, v, _ = frame_motion(frame, problem.forcing.start + tau)
    for b in range(N):
        y[b] += sign * d.framed[b] * s
        y[N + b] += sign * d.framed[b] * v


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
        (free v and λ), 1/s (z), m and m/s (u and v of dependent bodies).
    problem : DescriptorProblem
        Whose equations.
    """
    d, forcing, frame = problem.d, problem.forcing, problem.frame
    N, H, R, t = d.mass.size, d.hysteretic, d.opening.size, forcing.start + tau
    ground = ground_acceleration(forcing, t)
    lift = frame_motion(frame, t)[2] if frame.shape[1] > 0 else 0.0
    relative = relative_to_ground(tau, y, problem)
    x_rate, z_rates, forces, loads = _pushed(tau, relative, problem)
    a = np.empty(N)
    accelerations(d, loads, relative[2 * N + H : 2 * N + H + R], ground, a)
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
    if d.ledger >= 0:
        last = out[d.ledger :]
        ledger_rates(d, relative, x_rate, ground, last)
        if forcing.family == LOADED:
            body_loads(d, forces, loads)
            loaded_powers(tau, relative, problem, loads, last)
        for i in range(last.size):
            # Small, for none of these rows may become the pivot of another unknown.
            last[i] = d.ledger_weight * (rate[d.ledger + i] - last[i])


@kernel
def solve_contact_forces(tau: float, y: Floats, problem: DescriptorProblem) -> None:
    """Put λ of the equations of motion into y (relative to the ground)."""
    d = problem.d
    N, H, R = d.mass.size, d.hysteretic, d.opening.size
    if R == 0:
        return
    ground = ground_acceleration(problem.forcing, problem.forcing.start + tau)
    loads = _pushed(tau, y, problem)[3]
    contact_forces(d, loads, ground, y[2 * N + H : 2 * N + H + R])


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
def onto_constraints(d: Descriptor, y: Floats) -> None:
    """Close the gaps and gap rates of resting contacts (y relative to the ground), in place.

    Bodies are moved as their contacts' forces would, ``M⁻¹ W (Wᵀ M⁻¹ W)⁻¹`` times the gaps: the
    least that moves them, weighted by mass, which leaves the momentum of each group.
    """
    N, R = d.mass.size, d.opening.size
    gaps, rates = np.empty(R), np.empty(R)
    # All of them before a body is moved, which opens the gaps beside.
    for j in range(R):
        gaps[j] = d.opening[j] + dot(d.W[j], y[:N])
        rates[j] = dot(d.W[j], y[N : 2 * N])
    for j in range(R):
        push, change = dot(d.inverse_coupling[j], gaps), dot(d.inverse_coupling[j], rates)
        for b in range(N):
            y[b] -= d.W[j, b] * push / d.mass[b]
            y[N + b] -= d.W[j, b] * change / d.mass[b]


@kernel
def _acceleration_slopes(d: Descriptor, slopes: Floats) -> None:
    """Add ∂u''/∂y, shape (N, size)."""
    N, H = d.mass.size, d.hysteretic
    for link in range(d.stiffness.size):
        for b in range(N):
            pull = -d.B[link, b] / d.mass[b]
            # It is zero for a support, too, whose mass is infinite.
            if pull == 0.0:
                continue
            for c in range(N):
                slopes[b, c] += pull * d.stiffness[link] * d.B[link, c]
                slopes[b, N + c] += pull * d.law.damping[link] * d.B[link, c]
            if d.z_of_link[link] >= 0:
                slopes[b, 2 * N + d.z_of_link[link]] += pull * pull_per_z(link, d.law.memory)
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
        J[first, N + b] = 0.0 if is_support(b, d.mass) else d.mass[b] * ground
    for link in range(d.stiffness.size):
        h, q = d.z_of_link[link], pull_per_z(link, d.law.memory)
        for b in range(N):
            J[first + 1, N + b] -= 2.0 * d.law.damping[link] * x_rate[link] * d.B[link, b]
            if h >= 0:
                J[first + 2, N + b] -= q * y[2 * N + h] * d.B[link, b]
        if h >= 0:
            J[first + 2, 2 * N + h] -= q * x_rate[link]


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
        memory, rate = d.law.memory, x_rate[link]
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
    _acceleration_slopes(d, slopes)
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
    for b in range(N):
        if is_support(b, d.mass):
            # Others follow its given motion.
            J[:, b], J[:, N + b] = 0.0, 0.0
            J[b, b] = J[N + b, N + b] = cj
            J[b, N + b] = -1.0
