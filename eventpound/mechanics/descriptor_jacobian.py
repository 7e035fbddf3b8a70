"""Jacobian ``∂F/∂y + c_j ∂F/∂y'`` of `eventpound.mechanics.descriptor_motion.residual`."""

from __future__ import annotations

import numpy as np

from eventpound.mechanics.descriptor import Descriptor
from eventpound.mechanics.descriptor_motion import dot, pull_and_slopes, to_moving_frame
from eventpound.mechanics.hysteresis import z_rate_slopes
from eventpound.mechanics.reduced import Forcing
from eventpound.motion.forcing import ground_acceleration
from eventpound.motion.loads import LOADED, heavy_mass
from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import kernel


@kernel
def _acceleration_slopes(d: Descriptor, y: Floats, x_rate: Floats, slopes: Floats) -> None:
    """Add ∂u''/∂y, shape (N, size)."""
    N, H = d.mass.size, d.hysteretic
    for link in range(d.stiffness.size):
        x = dot(d.B[link], y[:N])
        _, by_x, by_rate = pull_and_slopes(link, x, x_rate[link], d)
        for b in range(N):
            pull = -d.B[link, b] / d.mass[b]
            if pull == 0.0:
                continue
            for c in range(N):
                slopes[b, c] += pull * by_x * d.B[link, c]
                slopes[b, N + c] += pull * by_rate * d.B[link, c]
            if d.z_of_link[link] >= 0:
                slopes[b, 2 * N + d.z_of_link[link]] += pull * d.law.strength[link]
    for b in range(N):
        for j in range(d.opening.size):
            slopes[b, 2 * N + H + j] = d.W[j, b] / d.mass[b]


@kernel
def _ledger_slopes(
    d: Descriptor, y: Floats, x_rate: Floats, ground: float, heavy: float, J: Floats
) -> None:
    """Rows of the ledger in the Jacobian, but for their own rates.

    Of the work of loads and of supports, bodies of `heavy` mass or more (kg), they know nothing:
    nothing follows from the ledger, so Newton's iteration needs one step more and no other.
    """
    N, first = d.mass.size, d.ledger
    for b in range(N):
        J[first, N + b] = d.mass[b] * ground if d.mass[b] < heavy else 0.0
    for link in range(d.plain):
        h = d.z_of_link[link]
        for b in range(N):
            J[first + 1, N + b] -= 2.0 * d.law.damping[link] * x_rate[link] * d.B[link, b]
            if h >= 0:
                J[first + 2, N + b] -= d.law.strength[link] * y[2 * N + h] * d.B[link, b]
        if h >= 0:
            J[first + 2, 2 * N + h] -= d.law.strength[link] * x_rate[link]


@kernel
def _constraint_slopes(d: Descriptor, slopes: Floats, J: Floats) -> None:
    """Rows of dependent bodies and of λ: gaps, their rates and their accelerations."""
    N, first = d.mass.size, 2 * d.mass.size + d.hysteretic
    for j in range(d.opening.size):
        body = d.dependent[j]
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
    N, law = d.mass.size, d.law
    for link in range(x_rate.size):
        h = d.z_of_link[link]
        if h < 0:
            continue
        own = law.yield_displacement[link], law.exponent[link], law.beta[link], law.gamma[link]
        by_rate, by_z = z_rate_slopes(x_rate[link], y[2 * N + h], *own)
        J[2 * N + h, 2 * N + h] = cj - by_z
        for b in range(N):
            J[2 * N + h, N + b] = -by_rate * d.B[link, b]


@kernel
def jacobian(
    tau: float, y: Floats, cj: float, J: Floats, d: Descriptor, forcing: Forcing, frame: Floats
) -> None:
    """Fill J, shape (size, size).

    Parameters
    ----------
    tau, y, d, forcing, frame
        As of `residual`.
    cj : float
        c_j (1/s), the leading coefficient of the method over the step.
    J : ndarray, shape (size, size)
        Overwritten.
    """
    N, t = d.mass.size, forcing.start + tau
    relative = y.copy()
    to_moving_frame(d, frame, t, -1.0, relative)
    x_rate = np.empty(d.stiffness.size)
    for link in range(x_rate.size):
        x_rate[link] = dot(d.B[link], relative[N : 2 * N])
    slopes = np.zeros((N, d.size))
    _acceleration_slopes(d, relative, x_rate, slopes)
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
        heavy = heavy_mass(forcing.coefficients) if forcing.family == LOADED else np.inf
        _ledger_slopes(d, relative, x_rate, ground, heavy, J)
        for i in range(d.ledger, d.size):
            J[i, i] = cj
            for k in range(d.size):
                J[i, k] *= d.ledger_weight
