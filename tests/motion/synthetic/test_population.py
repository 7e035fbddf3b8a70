"""Parameters drawn for synthetic motions: their distributions have the published moments."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import norm

from eventpound.motion.synthetic.population import (
    DISTANCES,
    GROUNDS,
    MAGNITUDES,
    Site,
    draw_parameters,
    draw_site,
    parameters_of,
)
from eventpound.units import STANDARD_GRAVITY

# Mean and standard deviation of the 206 motions behind the model (their table of statistics).
PUBLISHED = {
    "D_5_95": (17.25, 9.31, 1.0),
    "t_mid": (12.38, 7.44, 1.0),
    "omega_mid": (5.87, 3.11, 2.0 * math.pi),
    "zeta_f": (0.213, 0.143, 1.0),
}
# The midpoint rule in the probability.
SHARES = (np.arange(2000) + 0.5) / 2000


@pytest.fixture(scope="module")
def quantiles() -> dict[str, np.ndarray]:
    nus = norm.ppf(SHARES)
    found = [parameters_of(np.full(6, nu)) for nu in nus]
    names = ("I_a", "D_5_95", "t_mid", "omega_mid", "omega_prime", "zeta_f")
    return {name: np.array([getattr(p, name) for p in found]) for name in names}


@pytest.mark.parametrize("name", PUBLISHED)
def test_moments(name: str, quantiles: dict[str, np.ndarray]) -> None:
    mean, deviation, unit = PUBLISHED[name]
    values = quantiles[name] / unit
    # The midpoint rule misses a little of the tails.
    assert np.mean(values) == pytest.approx(mean, rel=2e-3)
    assert np.std(values) == pytest.approx(deviation, rel=1e-2)


def test_median_of_the_lognormal_intensity(quantiles: dict[str, np.ndarray]) -> None:
    median = 0.0468 / math.sqrt(1.0 + (0.164 / 0.0468) ** 2) * STANDARD_GRAVITY
    assert np.median(quantiles["I_a"]) == pytest.approx(median, rel=1e-2)


def test_rate_of_frequency_has_its_density(quantiles: dict[str, np.ndarray]) -> None:
    """The mean of the printed density, (area x mean of each side), is the published -0.089 Hz/s."""
    values = quantiles["omega_prime"] / (2.0 * math.pi)
    assert values.min() > -2.0
    assert values.max() < 0.5
    # By hand: -4.85 / 6.77^2 + 4.85 / 17.10^2.
    assert np.mean(values) == pytest.approx(-0.0892, abs=5e-4)
    assert np.mean(values < 0.0) == pytest.approx(4.85 / 6.77, abs=1e-3)


def test_draws_stay_in_their_ranges_and_are_reproducible() -> None:
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


def test_closer_is_stronger_and_larger_is_longer() -> None:
    def medians(site: Site) -> tuple[float, float]:
        random = np.random.default_rng(0)
        drawn = [draw_parameters(site, random) for _ in range(400)]
        return (
            float(np.median([p.I_a for p in drawn])),
            float(np.median([p.D_5_95 for p in drawn])),
        )

    near, far = medians(Site(7.0, 0, 10.0, 760.0)), medians(Site(7.0, 0, 40.0, 760.0))
    small, large = medians(Site(6.1, 0, 20.0, 760.0)), medians(Site(7.6, 0, 20.0, 760.0))
    # beta_3 ln(10 / 40) of a lognormal with sigma_ln 1.607: a factor of exp(3.02) between them.
    assert near[0] / far[0] == pytest.approx(math.exp(1.607 * 1.356 * math.log(4.0)), rel=0.35)
    assert large[1] > 1.5 * small[1]
