"""Modulated white noise through a filter whose frequency changes with time.

The gamma modulating function of a synthetic motion, and its parameters.

    q(t) = alpha_1 t^(alpha_2 - 1) exp(-alpha_3 t),     t >= 0

is the standard deviation of the acceleration (m/s^2). With k = 2 alpha_2 - 1
and P the regularised lower incomplete gamma function the expected Arias
intensity up to the time t is

    pi / (2 g) int_0^t q^2 = I_a P(k, 2 alpha_3 t),
    I_a = pi / (2 g) alpha_1^2 Gamma(k) / (2 alpha_3)^k

(m/s), so the times at which 5, 45 and 95 % of it are reached are quantiles of
a gamma distribution. D_5-95 = t_95 - t_5 and t_mid = t_45 give alpha_2 and
alpha_3, I_a then alpha_1.

Source: S. Rezaeian and A. Der Kiureghian, Simulation of synthetic ground
motions for specified earthquake and site characteristics, Earthquake
Engineering and Structural Dynamics 39 (2010), 1155-1180.

At the times t_k = k dt, with standard normal numbers u_i and the q(t) above (m/s^2),

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

from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.units import STANDARD_GRAVITY

LARGEST_RATIO = 4.9
"""D_5-95 / t_mid is below 4.92 for k > 1, that is where q begins at zero."""
_LARGEST_SHAPE = 1.0e4
_REACHED_AT_MID = 0.45


@dataclass(frozen=True, slots=True)
class Modulation:
    """The gamma modulating function.

    Parameters
    ----------
    alpha_1 : float
        Its factor (m/s^2 s^(1 - alpha_2)), positive.
    alpha_2 : float
        Its shape, above 1.
    alpha_3 : float
        Its decay (1/s), positive.
    """

    alpha_1: float
    alpha_2: float
    alpha_3: float

    def __call__(self, t: Floats) -> Floats:
        """Standard deviation q of the acceleration at t >= 0 (s), shape of `t` (m/s^2)."""
        t = np.asarray(t, dtype=float)
        q: Floats = self.alpha_1 * t ** (self.alpha_2 - 1.0) * np.exp(-self.alpha_3 * t)
        return q

    def time_of(self, share: float) -> float:
        """Time (s) at which a share of the expected Arias intensity is reached."""
        from scipy.special import gammaincinv

        return float(gammaincinv(2.0 * self.alpha_2 - 1.0, share)) / (2.0 * self.alpha_3)


def modulation_of(arias_intensity: float, duration: float, middle: float) -> Modulation:
    """Modulating function with the wanted intensity, duration and middle.

    Parameters
    ----------
    arias_intensity : float
        Expected I_a (m/s), positive.
    duration : float
        D_5-95 (s), positive.
    middle : float
        t_mid (s), when 45 % of I_a are reached.

    Returns
    -------
    Modulation
        With these three to rounding.

    Raises
    ------
    InputError
        Where the duration is not between 0.024 and 4.9 times `middle`: such a
        function would begin at infinity or hardly last.
    """
    from scipy.optimize import brentq
    from scipy.special import gammaincinv, gammaln

    def ratio(k: float) -> float:
        """D_5-95 / t_mid, which falls as k grows."""
        t_5, t_mid, t_95 = gammaincinv(k, [0.05, _REACHED_AT_MID, 0.95])
        return float((t_95 - t_5) / t_mid)

    wanted = duration / middle
    if not ratio(_LARGEST_SHAPE) < wanted < LARGEST_RATIO:
        raise InputError(
            f"synthetic motion: D_5-95 = {duration!r} s with t_mid = {middle!r} s; "
            f"accepted: a ratio of {ratio(_LARGEST_SHAPE):.3f} to {LARGEST_RATIO:g}"
        )
    k = float(brentq(lambda k: ratio(k) - wanted, 1.0, _LARGEST_SHAPE, xtol=1e-12, rtol=1e-14))
    alpha_3 = float(gammaincinv(k, _REACHED_AT_MID)) / (2.0 * middle)
    log_factor = 0.5 * (
        math.log(2.0 * STANDARD_GRAVITY / math.pi * arias_intensity)
        + k * math.log(2.0 * alpha_3)
        - float(gammaln(k))
    )
    return Modulation(math.exp(log_factor), 0.5 * (k + 1.0), alpha_3)


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
