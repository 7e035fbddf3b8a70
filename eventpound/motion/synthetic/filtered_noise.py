"""Modulated white noise through a filter whose frequency changes with time.

At the times t_k = k dt, with standard normal numbers u_i and q(t) (m/s^2) of
`eventpound.motion.synthetic.modulation`,

    x(t_k) = q(t_k) sum_i s_i(t_k) u_i,
    s_i(t_k) = h_i(t_k - t_i) / sqrt(sum_j h_j(t_k - t_j)^2),    i, j < k

so that x(t_k) has the variance q^2 whatever the filter is. The filter excited
at t_i is a damped oscillator with the frequency and damping of that instant,

    h_i(tau) = omega_i / sqrt(1 - zeta^2) exp(-zeta omega_i tau)
               sin(omega_i sqrt(1 - zeta^2) tau),
    omega_i = max(omega_mid + omega' (t_i - t_mid), omega_least).

The ground must come to rest: x drives a critically damped oscillator,
z'' + 2 omega_c z' + omega_c^2 z = x, and z'' is the acceleration. Its response
to the x that is linear between the t_k is exact.

Source: S. Rezaeian and A. Der Kiureghian, A stochastic ground motion model
with separable temporal and spectral nonstationarity, Earthquake Engineering
and Structural Dynamics 37 (2008), 1565-1584, and their paper of 2010.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from eventpound.numerics.arrays import Floats

LEAST_FREQUENCY = 2.0 * math.pi * 0.3
"""omega_least (rad/s): a filter that falls with time would else reach zero."""
CORNER_FREQUENCY = 2.0 * math.pi * 0.1
"""omega_c (rad/s)."""


@dataclass(frozen=True, slots=True)
class Filter:
    """The filter, its frequency linear in time.

    Parameters
    ----------
    omega_mid : float
        Frequency at t_mid (rad/s).
    omega_prime : float
        Its rate (rad/s^2).
    t_mid : float
        When 45 % of the Arias intensity are reached (s).
    zeta_f : float
        Damping ratio, 0 < zeta_f < 1.
    """

    omega_mid: float
    omega_prime: float
    t_mid: float
    zeta_f: float

    def frequency(self, t: Floats) -> Floats:
        """The frequency omega_f at t (s), shape of `t` (rad/s)."""
        straight = self.omega_mid + self.omega_prime * (np.asarray(t, dtype=float) - self.t_mid)
        return np.maximum(straight, LEAST_FREQUENCY)


def unit_process(shape: Filter, noise: Floats, time_step: float) -> Floats:
    """The filtered noise before it is modulated.

    Parameters
    ----------
    shape : Filter
        The filter.
    noise : ndarray, shape (n,)
        Standard normal numbers u_i.
    time_step : float
        dt (s).

    Returns
    -------
    ndarray, shape (n + 1,)
        At 0, dt, ..., n dt; of variance 1, but for the first value, which is 0.
    """
    omega = shape.frequency(time_step * np.arange(noise.size, dtype=np.float64))
    damped = math.sqrt(1.0 - shape.zeta_f**2)
    # h_i(tau) is the imaginary part of a spiral that turns by this each step.
    turn = np.exp((-shape.zeta_f + 1j * damped) * omega * time_step)
    spirals = np.zeros(noise.size, dtype=complex)
    process = np.zeros(noise.size + 1)
    for k in range(1, noise.size + 1):
        spirals[k - 1] = omega[k - 1] / damped
        spirals[:k] *= turn[:k]
        h = spirals[:k].imag
        process[k] = h @ noise[:k] / math.sqrt(h @ h)
    return process


def at_rest_in_the_end(acceleration: Floats, time_step: float) -> Floats:
    """Acceleration without the long periods that would leave the ground moving.

    Parameters
    ----------
    acceleration : ndarray, shape (n,)
        x, linear between its values (m/s^2).
    time_step : float
        Their distance (s).

    Returns
    -------
    ndarray, shape (n,)
        z'' (m/s^2).
    """
    from scipy.signal import cont2discrete, lfilter

    w = CORNER_FREQUENCY
    (numerator,), denominator, _ = cont2discrete(
        ([1.0, 0.0, 0.0], [1.0, 2.0 * w, w * w]), time_step, method="foh"
    )
    z: Floats = lfilter(numerator, denominator, acceleration)
    return z
