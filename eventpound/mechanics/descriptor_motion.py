"""Residual, Jacobian and observation of a contact mode in descriptor form.

``F(t, y, y') = 0`` with y and the equations of `eventpound.mechanics.descriptor`.
In a moving frame (`eventpound.mechanics.ground_frame`) the positions and
velocities of the bodies it carries are ``u + s`` and ``v + s'``.
"""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.descriptor import Descriptor
from eventpound.mechanics.ground_frame import frame_motion
from eventpound.mechanics.hysteresis import z_rate, z_rate_slopes
from eventpound.mechanics.observables import Observed
from eventpound.mechanics.reduced import Forcing
from eventpound.motion.forcing import ground_acceleration, ground_taylor
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import kernel


@kernel
def _dot(row: Floats, values: Floats) -> float:
    total = 0.0
    for i in range(row.size):
        total += row[i] * values[i]
    return total


@kernel
def _loads(d: Descriptor, forces: Floats, loads: Floats) -> None:
    """What the links put on each body, ``-Σ_l B_l F_l``."""
    for b in range(d.mass.size):
        total = 0.0
        for link in range(forces.size):
            total -= d.B[link, b] * forces[link]
        loads[b] = total


@kernel
def _accelerations(
    d: Descriptor, loads: Floats, contact: Floats, ground: float, a: Floats
) -> None:
    """``u'' = M⁻¹ (loads + W λ) - 1 a_g``."""
    for b in range(d.mass.size):
        total = loads[b]
        for j in range(contact.size):
            total += d.W[j, b] * contact[j]
        a[b] = total / d.mass[b] - ground


@kernel
def _contact_forces(d: Descriptor, loads: Floats, ground: float, contact: Floats) -> None:
    """λ of ``Wᵀ u'' = 0``."""
    closing = np.empty(contact.size)
    for j in range(contact.size):
        closing[j] = 0.0
        for b in range(d.mass.size):
            closing[j] -= d.W[j, b] * (loads[b] / d.mass[b] - ground)
    for j in range(contact.size):
        contact[j] = _dot(d.inverse_coupling[j], closing)


@kernel
def _links(
    d: Descriptor, y: Floats, elongation: Floats, z_rates: Floats, forces: Floats
) -> None:
    """Elongations and their rates (2 rows or more), rates of z and forces of the links."""
    N = d.mass.size
    for link in range(forces.size):
        x, x_rate = _dot(d.B[link], y[:N]), _dot(d.B[link], y[N : 2 * N])
        force = d.stiffness[link] * x + d.preload[link] + d.damping[link] * x_rate
        h = d.z_of_link[link]
        if h >= 0:
            z = y[2 * N + h]
            force += d.strength[link] * z
            z_rates[h] = z_rate(
                x_rate,
                z,
                d.yield_displacement[link],
                d.exponent[link],
                d.beta[link],
                d.gamma[link],
            )
        elongation[0, link], elongation[1, link], forces[link] = x, x_rate, force


@kernel
def _ledger_rates(
    d: Descriptor, y: Floats, x_rate: Floats, ground: float, rates: Floats
) -> None:
    """Rates of input ``-Σ m v a_g``, viscous ``Σ c x'²`` and hysteretic work ``Σ Q z x'``."""
    N = d.mass.size
    rates[:] = 0.0
    for b in range(N):
        rates[0] -= d.mass[b] * y[N + b] * ground
    for link in range(x_rate.size):
        rates[1] += d.damping[link] * x_rate[link] * x_rate[link]
        h = d.z_of_link[link]
        if h >= 0:
            rates[2] += d.strength[link] * y[2 * N + h] * x_rate[link]


@kernel
def to_inertial(d: Descriptor, frame: Floats, t: float, sign: float, y: Floats) -> None:
    """Add (sign +1) or take away (-1) the motion of the frame, in place."""
    if frame.shape[1] == 0:
        return
    N = d.mass.size
    s, v, _ = frame_motion(frame, t)
    for b in range(N):
        y[b] += sign * d.framed[b] * s
        y[N + b] += sign * d.framed[b] * v


@kernel
def residual(
    tau: float,
    y: Floats,
    rate: Floats,
    out: Floats,
    d: Descriptor,
    forcing: Forcing,
    frame: Floats,
) -> None:
    """Fill `out` with F(t, y, y') at ``t = forcing.start + tau``.

    Parameters
    ----------
    tau : float
        Time since the start of the segment (s).
    y, rate, out : ndarray, shape (size,)
        Unknowns and their rates, in the frame; the residual in m/s (free u), m/s²
        (free v and λ), 1/s (z), m and m/s (u and v of dependent bodies).
    d : Descriptor
        The mode.
    forcing : Forcing
        The piece of the ground motion.
    frame : ndarray, shape (4, n)
        The moving frame, n = 0 for none.
    """
    N, H, R, t = d.mass.size, d.hysteretic, d.opening.size, forcing.start + tau
    ground = ground_acceleration(forcing.family, forcing.coefficients, forcing.samples, t)
    still = y.copy()
    lift = 0.0
    if frame.shape[1] > 0:
        to_inertial(d, frame, t, -1.0, still)
        lift = frame_motion(frame, t)[2]
    elongation, forces = np.empty((2, d.stiffness.size)), np.empty(d.stiffness.size)
    z_rates, loads, a = np.empty(H), np.empty(N), np.empty(N)
    _links(d, still, elongation, z_rates, forces)
    _loads(d, forces, loads)
    _accelerations(d, loads, still[2 * N + H : 2 * N + H + R], ground, a)
    for b in range(N):
        out[b] = rate[b] - y[N + b]
        out[N + b] = rate[N + b] - a[b] - d.framed[b] * lift
    for j in range(R):
        out[d.dependent[j]] = d.opening[j] + _dot(d.W[j], still[:N])
        out[N + d.dependent[j]] = _dot(d.W[j], still[N : 2 * N])
        out[2 * N + H + j] = _dot(d.W[j], a)
    for h in range(H):
        out[2 * N + h] = rate[2 * N + h] - z_rates[h]
    if d.ledger >= 0:
        end = out[d.ledger :]
        _ledger_rates(d, still, elongation[1], ground, end)
        for i in range(end.size):
            end[i] = rate[d.ledger + i] - end[i]


@kernel
def _acceleration_slopes(d: Descriptor, slopes: Floats) -> None:
    """∂u''/∂y, shape (N, size)."""
    N, H = d.mass.size, d.hysteretic
    slopes[:] = 0.0
    for b in range(N):
        for link in range(d.stiffness.size):
            pull = -d.B[link, b] / d.mass[b]
            if pull == 0.0:
                continue
            for c in range(N):
                slopes[b, c] += pull * d.stiffness[link] * d.B[link, c]
                slopes[b, N + c] += pull * d.damping[link] * d.B[link, c]
            if d.z_of_link[link] >= 0:
                slopes[b, 2 * N + d.z_of_link[link]] += pull * d.strength[link]
        for j in range(d.opening.size):
            slopes[b, 2 * N + H + j] = d.W[j, b] / d.mass[b]


@kernel
def _ledger_slopes(
    d: Descriptor, y: Floats, x_rate: Floats, ground: float, J: Floats
) -> None:
    """Rows of the ledger in the Jacobian, but for their own rates."""
    N, first = d.mass.size, d.ledger
    for b in range(N):
        J[first, N + b] = d.mass[b] * ground
    for link in range(x_rate.size):
        h = d.z_of_link[link]
        for b in range(N):
            J[first + 1, N + b] -= 2.0 * d.damping[link] * x_rate[link] * d.B[link, b]
            if h >= 0:
                J[first + 2, N + b] -= d.strength[link] * y[2 * N + h] * d.B[link, b]
        if h >= 0:
            J[first + 2, 2 * N + h] -= d.strength[link] * x_rate[link]


@kernel
def jacobian(
    tau: float,
    y: Floats,
    cj: float,
    J: Floats,
    d: Descriptor,
    forcing: Forcing,
    frame: Floats,
) -> None:
    """Fill J, shape (size, size), with ``∂F/∂y + c_j ∂F/∂y'``; see `residual`."""
    N, H, R, t = d.mass.size, d.hysteretic, d.opening.size, forcing.start + tau
    still = y.copy()
    to_inertial(d, frame, t, -1.0, still)
    J[:] = 0.0
    slopes = np.empty((N, d.size))
    _acceleration_slopes(d, slopes)
    for b in range(N):
        J[b, b], J[b, N + b] = cj, -1.0
        for i in range(d.size):
            J[N + b, i] = -slopes[b, i]
        J[N + b, N + b] += cj
    for j in range(R):
        body = d.dependent[j]
        J[body, :] = 0.0
        J[N + body, :] = 0.0
        for b in range(N):
            J[body, b] = J[N + body, N + b] = d.W[j, b]
            for i in range(d.size):
                J[2 * N + H + j, i] += d.W[j, b] * slopes[b, i]
    x_rate = np.empty(d.stiffness.size)
    for link in range(x_rate.size):
        x_rate[link] = _dot(d.B[link], still[N : 2 * N])
        h = d.z_of_link[link]
        if h >= 0:
            by_rate, by_z = z_rate_slopes(
                x_rate[link],
                still[2 * N + h],
                d.yield_displacement[link],
                d.exponent[link],
                d.beta[link],
                d.gamma[link],
            )
            J[2 * N + h, 2 * N + h] = cj - by_z
            for b in range(N):
                J[2 * N + h, N + b] = -by_rate * d.B[link, b]
    if d.ledger >= 0:
        ground = ground_acceleration(forcing.family, forcing.coefficients, forcing.samples, t)
        _ledger_slopes(d, still, x_rate, ground, J)
        for i in range(d.ledger, d.size):
            J[i, i] = cj


@kernel
def solve_contact_forces(tau: float, y: Floats, d: Descriptor, forcing: Forcing) -> None:
    """Put λ of the equations of motion into y (relative to the ground)."""
    N, H, R = d.mass.size, d.hysteretic, d.opening.size
    if R == 0:
        return
    ground = ground_acceleration(
        forcing.family, forcing.coefficients, forcing.samples, forcing.start + tau
    )
    elongation, forces = np.empty((2, d.stiffness.size)), np.empty(d.stiffness.size)
    z_rates, loads = np.empty(H), np.empty(N)
    _links(d, y, elongation, z_rates, forces)
    _loads(d, forces, loads)
    _contact_forces(d, loads, ground, y[2 * N + H : 2 * N + H + R])


@kernel
def observe_descriptor(
    tau: float, y: Floats, d: Descriptor, forcing: Forcing, rate: Floats, out: Observed
) -> None:
    """Everything known of a state, and the rates of its unknowns.

    Parameters
    ----------
    tau : float
        Time since the start of the segment (s).
    y, rate : ndarray, shape (size,)
        Unknowns, relative to the ground; their rates, overwritten.
    d : Descriptor
        The mode.
    forcing : Forcing
        The piece of the ground motion.
    out : Observed
        Overwritten; gaps of resting contacts are zero, as the event loop counts them.
    """
    N, H, R = d.mass.size, d.hysteretic, d.opening.size
    ground_taylor(
        forcing.family, forcing.coefficients, forcing.samples, forcing.start + tau, 2, out.ground
    )
    contact, contact_rate = y[2 * N + H : 2 * N + H + R], rate[2 * N + H : 2 * N + H + R]
    loads, load_rates = np.empty(N), np.empty(N)
    a, a_rate = np.empty(N), np.empty(N)
    _links(d, y, out.elongation, rate[2 * N : 2 * N + H], out.force[0])
    _loads(d, out.force[0], loads)
    _accelerations(d, loads, contact, out.ground[0], a)
    _link_rates(d, a, rate[2 * N : 2 * N + H], out)
    _loads(d, out.force[1], load_rates)
    _contact_forces(d, load_rates, out.ground[1], contact_rate)
    _accelerations(d, load_rates, contact_rate, out.ground[1], a_rate)
    for b in range(N):
        rate[b], rate[N + b] = y[N + b], a[b]
        out.u[b], out.v[b], out.a[b] = y[b], y[N + b], a[b]
        out.acceleration[0, b] = a[b] + out.ground[0]
        out.acceleration[1, b] = a_rate[b] + out.ground[1]
    for h in range(H):
        out.z[0, h], out.z[1, h] = y[2 * N + h], rate[2 * N + h]
    if d.ledger >= 0:
        _ledger_rates(d, y, out.elongation[1], out.ground[0], rate[d.ledger :])
    _observe_contacts(d, contact, contact_rate, out)
    # The ground takes what all bodies together are given.
    out.shear[0], out.shear[1] = -np.sum(loads), -np.sum(load_rates)


@kernel
def _link_rates(d: Descriptor, a: Floats, z_rates: Floats, out: Observed) -> None:
    """Second rates of the elongations and ``F' = k x' + c x'' + Q z'``."""
    for link in range(d.stiffness.size):
        out.elongation[2, link] = _dot(d.B[link], a)
        force_rate = (
            d.stiffness[link] * out.elongation[1, link]
            + d.damping[link] * out.elongation[2, link]
        )
        if d.z_of_link[link] >= 0:
            force_rate += d.strength[link] * z_rates[d.z_of_link[link]]
        out.force[1, link] = force_rate


@kernel
def _observe_contacts(
    d: Descriptor, contact: Floats, contact_rate: Floats, out: Observed
) -> None:
    for j in range(d.all_openings.size):
        out.gap[0, j] = d.all_openings[j] + _dot(d.all_gaps[j], out.u)
        out.gap[1, j] = _dot(d.all_gaps[j], out.v)
        out.gap[2, j] = _dot(d.all_gaps[j], out.a)
        out.contact_force[0, j] = _dot(d.share[j], contact)
        out.contact_force[1, j] = _dot(d.share[j], contact_rate)
    for i in range(d.resting.size):
        out.gap[:, d.resting[i]] = 0.0


@kernel
def constraint_errors(d: Descriptor, y: Floats) -> tuple[float, float]:
    """Largest gap (m) and gap rate (m/s) of a resting contact, by their sizes."""
    N = d.mass.size
    gap, gap_rate = 0.0, 0.0
    for i in range(d.resting.size):
        j = d.resting[i]
        gap = max(gap, abs(d.all_openings[j] + _dot(d.all_gaps[j], y[:N])))
        gap_rate = max(gap_rate, abs(_dot(d.all_gaps[j], y[N : 2 * N])))
    return gap, gap_rate
