"""Powers of power series against rational numbers and the binomial series."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.special import binom

from eventpound.numerics.power_series import power_coefficient


def _series(z: np.ndarray, n: float, order: int) -> np.ndarray:
    power = np.zeros(order + 1)
    for k in range(order + 1):
        power[k] = power_coefficient(z, power, n, k)
    return power


def _exact_power(z: list[Fraction], n: int) -> list[Fraction]:
    """Coefficients of z^n by n multiplications of rational numbers."""
    product = [Fraction(1)] + [Fraction(0)] * (len(z) - 1)
    for _ in range(n):
        product = [
            sum((product[j] * z[k - j] for j in range(k + 1)), Fraction(0)) for k in range(len(z))
        ]
    return product


@pytest.mark.parametrize("n", [1, 2, 5, 20])
@pytest.mark.parametrize("z0", [-7e-49, 3e-17, -1e-300, 5e-324])
def test_power_series_of_a_z_that_all_but_vanishes(n, z0):
    # An exact zero of z found to rounding only: dividing by it would leave no number at all.
    rng = np.random.default_rng(43)
    order = 14
    numbers = [Fraction(0)] + [Fraction(int(a), 16) for a in rng.integers(1, 9, order)]
    exact = np.array([float(a) for a in _exact_power(numbers, n)])
    z = np.array([float(a) for a in numbers])
    z[0] = z0
    power = _series(z, float(n), order)
    np.testing.assert_allclose(power, exact, rtol=1e-12, atol=1e-16)


@pytest.mark.parametrize("n", [1, 2, 3, 7, 20])
@pytest.mark.parametrize("leading", [0, 1, 2, 3])
@pytest.mark.parametrize("sign", [1, -1])
def test_power_series_against_rational_numbers(n, leading, sign):
    # z = ±τ^m (z_m + ...); |z|^n = (sign z)^n just after zero.
    rng = np.random.default_rng(42)
    order = 45
    numbers = [Fraction(int(a), 16) for a in rng.integers(-8, 9, order + 1)]
    numbers[:leading] = [Fraction(0)] * leading
    numbers[leading] = Fraction(11, 16)
    exact = np.array([float(a) for a in _exact_power(numbers, n)])
    z = sign * np.array([float(a) for a in numbers])
    power = _series(z, float(n), order)
    # The recurrence for 1/z_m-sized growth: relative to the largest term up to k.
    scale = np.maximum.accumulate(np.abs(exact)) + 1e-300
    assert np.max(np.abs(power - exact) / scale) < 1e-9
    np.testing.assert_allclose(power[: 13 + leading * n], exact[: 13 + leading * n], atol=1e-12)


@pytest.mark.parametrize("n", [1.0, 1.5, 2.7, 20.0])
def test_power_series_of_one_plus_tau(n):
    z = np.zeros(13)
    z[0], z[1] = 0.8, 0.8
    expected = 0.8**n * binom(n, np.arange(13))
    np.testing.assert_allclose(_series(z, n, 12), expected, rtol=1e-13, atol=1e-15)


def test_zero_has_no_power():
    assert not _series(np.zeros(13), 2.0, 12).any()
