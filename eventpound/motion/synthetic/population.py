"""Which parameters synthetic motions have: published statistics, drawn with a seed.

A site draws magnitude, distance, ground and fault; the ranges are ours, within
those of the records behind the model (M >= 6, R >= 10 km, firm ground, V_S30
above 600 m/s). The six parameters theta of a motion follow as in the source.
Each is a standard normal variable nu turned into the distribution fitted to
that parameter, F(theta) = Phi(nu), and nu has the mean

    beta_0 + beta_1 F + beta_2 M/7 + beta_3 ln(R/25 km) + beta_4 ln(V/750 m/s)

for I_a, with R/25 km and V/750 m/s in the place of their logarithms for the
others, the variance tau^2 + sigma^2 (between and within earthquakes) and the
correlations of the source between the parameters of one motion.

Source: S. Rezaeian and A. Der Kiureghian, Simulation of synthetic ground
motions for specified earthquake and site characteristics, Earthquake
Engineering and Structural Dynamics 39 (2010), 1155-1180: distributions,
regression and correlation tables.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from eventpound.motion.synthetic.modulation import LARGEST_RATIO
from eventpound.numerics.arrays import Floats
from eventpound.units import STANDARD_GRAVITY

MAGNITUDES = (6.0, 7.7)
DISTANCES = (10.0, 40.0)
"""R (km)."""
GROUNDS = (600.0, 1000.0)
"""V_S30 (m/s)."""

# beta_0 ... beta_4, tau, sigma of I_a, D_5-95, t_mid, omega_mid, omega', zeta_f.
_REGRESSION = np.array(
    [
        [-1.844, -0.071, 2.944, -1.356, -0.265, 0.274, 0.594],
        [-6.195, -0.703, 6.792, 0.219, -0.523, 0.457, 0.569],
        [-5.011, -0.345, 4.638, 0.348, -0.185, 0.511, 0.414],
        [2.253, -0.081, -1.810, -0.211, 0.012, 0.692, 0.723],
        [-2.489, 0.044, 2.408, 0.065, -0.081, 0.129, 0.953],
        [-0.258, -0.477, 0.905, -0.289, 0.316, 0.682, 0.760],
    ]
)
_CORRELATION = np.array(
    [
        [1.00, -0.36, 0.01, -0.15, 0.13, -0.01],
        [-0.36, 1.00, 0.67, -0.13, -0.16, -0.20],
        [0.01, 0.67, 1.00, -0.28, -0.20, -0.22],
        [-0.15, -0.13, -0.28, 1.00, -0.20, 0.28],
        [0.13, -0.16, -0.20, -0.20, 1.00, -0.01],
        [-0.01, -0.20, -0.22, 0.28, -0.01, 1.00],
    ]
)


@dataclass(frozen=True, slots=True)
class Site:
    """An earthquake and a place.

    Parameters
    ----------
    M : float
        Moment magnitude.
    F : int
        0 for a strike-slip, 1 for a reverse fault.
    R : float
        Distance from the rupture (km).
    V : float
        V_S30, speed of shear waves in the upper 30 m (m/s).
    """

    M: float
    F: int
    R: float
    V: float


@dataclass(frozen=True, slots=True)
class Parameters:
    """What the stochastic model of one motion is given.

    Parameters
    ----------
    I_a : float
        Expected Arias intensity (m/s).
    D_5_95 : float
        Time between 5 and 95 % of it (s).
    t_mid : float
        Time at which 45 % of it are reached (s).
    omega_mid : float
        Frequency of the filter then (rad/s).
    omega_prime : float
        Rate of that frequency (rad/s^2).
    zeta_f : float
        Damping ratio of the filter.
    """

    I_a: float
    D_5_95: float
    t_mid: float
    omega_mid: float
    omega_prime: float
    zeta_f: float


def draw_site(random: np.random.Generator) -> Site:
    """Draw a site: M and V uniform, R uniform in its logarithm, F a coin."""
    return Site(
        M=float(random.uniform(*MAGNITUDES)),
        F=int(random.integers(2)),
        R=math.exp(random.uniform(*np.log(DISTANCES))),
        V=float(random.uniform(*GROUNDS)),
    )


def draw_parameters(site: Site, random: np.random.Generator) -> Parameters:
    """Draw the parameters of one motion at a site.

    A draw whose modulating function would begin at infinity (D_5-95 long
    beside t_mid) is put back and drawn again.
    """
    deviation = np.sqrt(_REGRESSION[:, 5] ** 2 + _REGRESSION[:, 6] ** 2)
    root = np.linalg.cholesky(_CORRELATION)
    while True:
        nu = _means(site) + deviation * (root @ random.standard_normal(6))
        parameters = parameters_of(nu)
        if parameters.D_5_95 / parameters.t_mid < LARGEST_RATIO:
            return parameters


def _means(site: Site) -> Floats:
    """Means of nu, shape (6,)."""
    ratio_r, ratio_v = site.R / 25.0, site.V / 750.0
    terms = np.array([1.0, site.F, site.M / 7.0, ratio_r, ratio_v])
    means: Floats = _REGRESSION[:, :5] @ terms
    terms[3:] = math.log(ratio_r), math.log(ratio_v)
    means[0] = _REGRESSION[0, :5] @ terms
    return means


def parameters_of(nu: Floats) -> Parameters:
    """Parameters whose standard normal variables these are.

    Parameters
    ----------
    nu : ndarray, shape (6,)
        Of I_a, D_5-95, t_mid, omega_mid, omega', zeta_f.
    """
    from scipy.special import ndtr

    share = ndtr(np.asarray(nu, dtype=float))
    hertz = 2.0 * math.pi
    mean, deviation = 0.0468, 0.164
    log_variance = math.log1p((deviation / mean) ** 2)
    median = mean * math.exp(-0.5 * log_variance)
    return Parameters(
        I_a=STANDARD_GRAVITY * median * math.exp(math.sqrt(log_variance) * float(nu[0])),
        D_5_95=_beta(share[1], 5.0, 45.0, 17.25, 9.31),
        t_mid=_beta(share[2], 0.5, 40.0, 12.38, 7.44),
        omega_mid=hertz * _gamma(share[3], 5.87, 3.11),
        omega_prime=hertz * _two_sided_exponential(share[4]),
        zeta_f=_beta(share[5], 0.02, 1.0, 0.213, 0.143),
    )


def _beta(share: float, low: float, high: float, mean: float, deviation: float) -> float:
    """Quantile of the beta distribution on [low, high] with these moments."""
    from scipy.special import betaincinv

    m, s = (mean - low) / (high - low), deviation / (high - low)
    size = m * (1.0 - m) / s**2 - 1.0
    return low + (high - low) * float(betaincinv(m * size, (1.0 - m) * size, share))


def _gamma(share: float, mean: float, deviation: float) -> float:
    """Quantile of the gamma distribution with these moments."""
    from scipy.special import gammaincinv

    shape = (mean / deviation) ** 2
    return mean / shape * float(gammaincinv(shape, share))


def _two_sided_exponential(share: float) -> float:
    """Quantile of the density 4.85 exp(6.77 x) on [-2, 0], 4.85 exp(-17.10 x) on [0, 0.5]."""
    height, rise, fall = 4.85, 6.77, 17.10
    left = height / rise * -math.expm1(-2.0 * rise)
    right = height / fall * -math.expm1(-0.5 * fall)
    # The printed height makes the whole 1.0000, not 1.
    area = share * (left + right)
    if area <= left:
        return math.log(math.exp(-2.0 * rise) + area * rise / height) / rise
    return -math.log1p(-(area - left) * fall / height) / fall
