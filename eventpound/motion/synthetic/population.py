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
Engineering and Structural Dynamics 39 (2010), 1155-1180. Its numbers were
compared with those of the same regression in the SCEC Broadband Platform
(``bbp/comps/rzz2015_gmpe.py``), from which the fitted distributions and the
correlations are; the page "synthetic" of the docs says what agrees and what does not.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from eventpound.motion.synthetic.filtered_noise import LARGEST_RATIO
from eventpound.numerics.arrays import Floats
from eventpound.units import STANDARD_GRAVITY

MAGNITUDES = (6.0, 7.7)
DISTANCES = (10.0, 40.0)
"""R (km)."""
GROUNDS = (600.0, 1000.0)
"""V_S30 (m/s)."""

REGRESSION = np.array(
    [
        [-1.844, -0.071, 2.944, -1.356, -0.265, 0.274, 0.594],
        [-6.195, -0.703, 6.792, 0.219, -0.523, 0.457, 0.569],
        [-5.011, -0.345, 4.638, 0.348, -0.185, 0.511, 0.414],
        [2.253, -0.081, -1.810, -0.211, 0.012, 0.692, 0.723],
        [-2.489, 0.044, 2.408, 0.065, -0.081, 0.129, 0.953],
        [-0.258, -0.477, 0.905, -0.289, 0.316, 0.682, 0.760],
    ]
)
"""beta_0 ... beta_4, tau, sigma of I_a, D_5-95, t_mid, omega_mid, omega', zeta_f, shape (6, 7)."""
_CORRELATION = np.array(
    [
        [1.0000, -0.3555, 0.0066, -0.1545, 0.1341, -0.0078],
        [-0.3555, 1.0000, 0.6729, -0.1303, -0.1576, -0.1958],
        [0.0066, 0.6729, 1.0000, -0.2761, -0.1977, -0.2188],
        [-0.1545, -0.1303, -0.2761, 1.0000, -0.2034, 0.2814],
        [0.1341, -0.1576, -0.1977, -0.2034, 1.0000, -0.0137],
        [-0.0078, -0.1958, -0.2188, 0.2814, -0.0137, 1.0000],
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
    deviation = np.sqrt(REGRESSION[:, 5] ** 2 + REGRESSION[:, 6] ** 2)
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
    means: Floats = REGRESSION[:, :5] @ terms
    terms[3:] = math.log(ratio_r), math.log(ratio_v)
    means[0] = REGRESSION[0, :5] @ terms
    return means


def parameters_of(nu: Floats) -> Parameters:
    """Parameters whose standard normal variables these are.

    Parameters
    ----------
    nu : ndarray, shape (6,)
        Of I_a, D_5-95, t_mid, omega_mid, omega', zeta_f.
    """
    from scipy.special import gammaincinv, ndtr

    share = ndtr(np.asarray(nu, dtype=float))
    hertz = 2.0 * math.pi
    return Parameters(
        # I_a / g (s) is lognormal.
        I_a=STANDARD_GRAVITY * math.exp(-4.8255 + 1.4318 * float(nu[0])),
        D_5_95=_beta(share[1], 5.0, 45.0, 1.1314, 2.4474),
        t_mid=_beta(share[2], 0.5, 40.0, 1.5792, 3.6405),
        omega_mid=hertz * 1.4330 * float(gammaincinv(4.0982, share[3])),
        omega_prime=hertz * _two_sided_exponential(share[4]),
        zeta_f=_beta(share[5], 0.02, 1.0, 1.4250, 5.7208),
    )


def _beta(share: float, low: float, high: float, a: float, b: float) -> float:
    """Quantile of the beta distribution on [low, high] with the exponents a - 1 and b - 1."""
    from scipy.special import betaincinv

    return low + (high - low) * float(betaincinv(a, b, share))


def _two_sided_exponential(share: float) -> float:
    """Quantile of the density c exp(b x) on [-2, 0] and c exp(-a x) on [0, 0.5]."""
    a, b, c = 17.095, 6.7729, 4.8512
    left = c / b * -math.expm1(-2.0 * b)
    right = c / a * -math.expm1(-0.5 * a)
    # The printed c makes the whole 0.9999, not 1.
    area = share * (left + right)
    if area <= left:
        return math.log(math.exp(-2.0 * b) + area * b / c) / b
    return -math.log1p(-(area - left) * a / c) / a
