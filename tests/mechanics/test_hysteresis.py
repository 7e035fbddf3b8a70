"""The Bouc–Wen law: eq. 3 as printed, its bound, its power series, its backbone."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import binom, hyp2f1

from eventpound.mechanics.hysteresis import power_coefficient, z_bound, z_rate
from eventpound.scene import BoucWen
from tests.mechanics.dense import literal_z_rate

EPS = np.finfo(float).eps


def test_rate_is_the_printed_one() -> None:
    rng = np.random.default_rng(41)
    for _ in range(1000):
        n, beta = rng.choice([1.0, 1.5, 2.0, 7.3, 20.0]), rng.uniform(-1.0, 1.0)
        gamma = rng.uniform(0.0, 1.0) - min(beta, 0.0)
        u_y = 10.0 ** rng.uniform(-3, 1)
        z = rng.choice([0.0, rng.uniform(-1.2, 1.2)])
        x_rate = rng.choice([0.0, rng.normal()])
        law = BoucWen(0.0, 1.0, u_y, n, beta, gamma)
        terms = abs(x_rate) / u_y * (1.0 + (abs(beta) + gamma) * abs(z) ** n)
        assert z_rate(x_rate, x_rate, z, u_y, n, beta, gamma) == pytest.approx(
            literal_z_rate(law, x_rate, z), abs=32 * EPS * terms
        )


@pytest.mark.parametrize(("beta", "gamma"), [(0.5, 0.5), (0.1, 0.9), (-0.2, 1.0), (2.0, 3.0)])
@pytest.mark.parametrize("n", [1.0, 2.0, 20.0])
def test_loading_ends_at_the_bound(beta: float, gamma: float, n: float) -> None:
    bound = z_bound(n, beta, gamma)
    # Terms of size one cancel there; n of the roundings of |z|^n come on top.
    assert abs(z_rate(1.0, 1.0, bound, 1.0, n, beta, gamma)) < 8 * (n + 2) * EPS
    assert z_rate(1.0, 1.0, 0.999 * bound, 1.0, n, beta, gamma) > 0.0
    assert z_rate(-1.0, -1.0, -0.999 * bound, 1.0, n, beta, gamma) < 0.0
    assert z_rate(-1.0, -1.0, bound, 1.0, n, beta, gamma) < 0.0


def test_default_bound_is_one() -> None:
    assert z_bound(20.0, 0.5, 0.5) == 1.0


@pytest.mark.parametrize("n", [1.0, 2.0, 5.0, 20.0])
def test_backbone(n: float) -> None:
    # Loading from zero: x/u_y = z 2F1(1, 1/n; 1 + 1/n; z^n), and z_rate integrated.
    u_y = 0.3
    ends = np.array([0.2, 0.6, 0.9, 0.99])
    x = u_y * ends * hyp2f1(1.0, 1.0 / n, 1.0 + 1.0 / n, ends**n)
    path = solve_ivp(
        lambda _, z: [z_rate(1.0, 1.0, z[0], u_y, n, 0.5, 0.5)],
        (0.0, x[-1]),
        [0.0],
        method="DOP853",
        t_eval=x,
        rtol=1e-13,
        atol=1e-14,
    )
    np.testing.assert_allclose(path.y[0], ends, rtol=0.0, atol=1e-11)


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
def test_power_series_of_a_z_that_all_but_vanishes(n: int, z0: float) -> None:
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
def test_power_series_against_rational_numbers(n: int, leading: int, sign: int) -> None:
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
def test_power_series_of_one_plus_tau(n: float) -> None:
    z = np.zeros(13)
    z[0], z[1] = 0.8, 0.8
    expected = 0.8**n * binom(n, np.arange(13))
    np.testing.assert_allclose(_series(z, n, 12), expected, rtol=1e-13, atol=1e-15)


def test_zero_has_no_power() -> None:
    assert not _series(np.zeros(13), 2.0, 12).any()
