"""Parameters drawn for synthetic motions: distributions and regression as printed elsewhere."""

import math

import numpy as np
import pytest
from scipy.stats import norm

from eventpound.motion.synthetic.population import (
    DISTANCES,
    GROUNDS,
    MAGNITUDES,
    REGRESSION,
    Site,
    draw_parameters,
    draw_site,
    parameters_of,
)
from eventpound.units import STANDARD_GRAVITY

# Mean and standard deviation of the distributions fitted to the 206 motions behind the model,
# by the moments of beta and gamma distributions with the exponents of the source.
FITTED = {
    "D_5_95": (17.646, 8.692, 1.0),
    "t_mid": (12.450, 7.275, 1.0),
    "omega_mid": (5.873, 2.901, 2.0 * math.pi),
    "zeta_f": (0.2154, 0.1372, 1.0),
}
# Mean and standard deviation of the 206 motions themselves.
SAMPLE = {
    "D_5_95": (17.25, 9.31),
    "t_mid": (12.38, 7.44),
    "omega_mid": (5.87, 3.11),
    "zeta_f": (0.213, 0.143),
}
# bbp/comps/rzz2015_gmpe.py of the SCEC Broadband Platform: the same regression with more digits,
# its factors of M, R and V in 1, 1/km and s/m: constant, M, F, R, V, tau, sigma.
PLATFORM = np.array(
    [
        [-6.1946, 0.9703, -0.7034, 0.0087, -0.0007, 0.4574, 0.5688],
        [-5.0105, 0.6625, -0.3450, 0.0139, -0.0002, 0.5114, 0.4145],
        [2.2525, -0.2586, -0.0808, -0.0084, 0.0000, 0.6918, 0.7228],
        [-2.4886, 0.3440, 0.0441, 0.0026, -0.0001, 0.1286, 0.9529],
        [-0.2583, 0.1293, -0.4772, -0.0115, 0.0004, 0.6815, 0.7601],
    ]
)
# Of I_a, its factors of F, M/7, ln(R/25 km), ln(V/750 m/s), tau, sigma.
PLATFORM_INTENSITY = [-0.0707, 2.9440, -1.3564, -0.2654, 0.2738, 0.5937]
# The midpoint rule in the probability.
SHARES = (np.arange(2000) + 0.5) / 2000


@pytest.fixture(scope="module")
def quantiles():
    nus = norm.ppf(SHARES)
    found = [parameters_of(np.full(6, nu)) for nu in nus]
    names = ("I_a", "D_5_95", "t_mid", "omega_mid", "omega_prime", "zeta_f")
    return {name: np.array([getattr(p, name) for p in found]) for name in names}


def test_the_regression_is_that_of_an_independent_print():
    """Ours has three decimals, it has four: each may be off by half a unit of its last."""
    ours = REGRESSION[1:, [0, 2, 1, 3, 4, 5, 6]]
    units = np.array([1.0, 7.0, 1.0, 25.0, 750.0, 1.0, 1.0])
    assert np.all(np.abs(ours - PLATFORM * units) <= 0.5e-3 + 0.5e-4 * units + 1e-12)
    assert REGRESSION[0, 1:] == pytest.approx(PLATFORM_INTENSITY, abs=0.5e-3 + 0.5e-4)


def test_constant_of_the_intensity_fits_the_other_five():
    """The normal variables of the records behind a regression have a mean near zero.

    The five rows whose constants agree with the independent print give the mean F, M, R and V
    of those records. With them I_a has a mean near zero, too, if the mean of ln R is 0.05 to
    0.25 below ln of the mean, as it is for distances from 10 to 100 km; with the platform's
    constant, less by ln(pi/2), it has not.
    """
    rows = REGRESSION[1:, :5]
    f, m, r, v = np.linalg.lstsq(rows[:, 1:], -rows[:, 0], rcond=None)[0]
    assert rows @ [1.0, f, m, r, v] == pytest.approx(np.zeros(5), abs=0.1)
    for below in (0.05, 0.25):
        nu = float(REGRESSION[0, :5] @ [1.0, f, m, math.log(r) - below, math.log(v)])
        assert abs(nu) < 0.2
        assert nu - math.log(math.pi / 2.0) < -0.25


@pytest.mark.parametrize("name", FITTED)
def test_moments(name, quantiles):
    mean, deviation, unit = FITTED[name]
    values = quantiles[name] / unit
    # The midpoint rule misses a little of the tails.
    assert np.mean(values) == pytest.approx(mean, rel=2e-3)
    assert np.std(values) == pytest.approx(deviation, rel=1e-2)
    # A fitted distribution has about the moments of its sample.
    assert SAMPLE[name] == pytest.approx((mean, deviation), rel=0.08)


def test_the_lognormal_intensity(quantiles):
    logarithms = np.log(quantiles["I_a"] / STANDARD_GRAVITY)
    assert np.mean(logarithms) == pytest.approx(-4.8255, abs=1e-9)
    assert np.std(logarithms) == pytest.approx(1.4318, rel=2e-3)


def test_rate_of_frequency_has_its_density(quantiles):
    """The mean of the printed density, (area x mean of each side), is the published -0.089 Hz/s."""
    values = quantiles["omega_prime"] / (2.0 * math.pi)
    assert values.min() > -2.0
    assert values.max() < 0.5
    # By hand: -4.8512 / 6.7729^2 + 4.8512 / 17.095^2.
    assert np.mean(values) == pytest.approx(-0.0892, abs=5e-4)
    assert np.mean(values < 0.0) == pytest.approx(4.8512 / 6.7729, abs=1e-3)


@pytest.mark.parametrize("F", [0, 1])
@pytest.mark.parametrize("R", [20.0, pytest.param(40.0, marks=pytest.mark.sweep)])
@pytest.mark.parametrize("M", [6.5, 7.0, 7.5])
def test_median_intensity_is_near_another_relation(M, R, F):
    """Travasarou, Bray and Abrahamson (2003, EESD 32, 1133-1155), stiff ground, a factor of 2.5.

    Their sigma is above a factor of 2.5; a slip of g or pi, or moments of the sample in the
    place of the fit, would be seen.
    """
    V = 700.0
    logarithm = (
        2.800
        - 1.981 * (M - 6.0)
        + 20.72 * math.log(M / 6.0)
        - 1.703 * math.log(math.hypot(R, 8.78))
        + 0.454
        + 0.101 * (M - 6.0)
        + 0.512 * F
    )
    site = Site(M, F, R, V)
    random = np.random.default_rng(1)
    drawn = [math.log(draw_parameters(site, random).I_a) for _ in range(2000)]
    assert abs(float(np.mean(drawn)) - logarithm) < math.log(2.5)


def test_draws_stay_in_their_ranges_and_are_reproducible():
    random, again = np.random.default_rng(5), np.random.default_rng(5)
    for _ in range(200):
        site = draw_site(random)
        assert MAGNITUDES[0] <= site.M <= MAGNITUDES[1]
        assert DISTANCES[0] <= site.R <= DISTANCES[1] * (1.0 + 1e-15)
        assert GROUNDS[0] <= site.V <= GROUNDS[1]
        assert site.F in (0, 1)
        parameters = draw_parameters(site, random)
        assert 5.0 <= parameters.D_5_95 <= 45.0
        assert 0.02 <= parameters.zeta_f < 1.0
        assert (site, parameters) == (draw_site(again), draw_parameters(site, again))


def test_closer_is_stronger_and_larger_is_longer():
    def medians(site: Site) -> tuple[float, float]:
        random = np.random.default_rng(0)
        drawn = [draw_parameters(site, random) for _ in range(400)]
        return (
            float(np.median([p.I_a for p in drawn])),
            float(np.median([p.D_5_95 for p in drawn])),
        )

    near, far = medians(Site(7.0, 0, 10.0, 760.0)), medians(Site(7.0, 0, 40.0, 760.0))
    small, large = medians(Site(6.1, 0, 20.0, 760.0)), medians(Site(7.6, 0, 20.0, 760.0))
    # beta_3 ln(10 / 40) of a lognormal with sigma_ln 1.432: a factor of exp(2.69) between them.
    assert near[0] / far[0] == pytest.approx(math.exp(1.4318 * 1.356 * math.log(4.0)), rel=0.35)
    assert large[1] > 1.5 * small[1]
