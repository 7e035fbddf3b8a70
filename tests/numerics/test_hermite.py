"""Bernstein coefficients: they are those of the polynomial, and they bound it."""

import numpy as np
import pytest
from scipy.special import comb

from eventpound.numerics.hermite import cubic_bernstein, quintic_bernstein

pytestmark = pytest.mark.usefixtures("interpreted")
EPS = np.finfo(float).eps
SAMPLES = np.linspace(0.0, 1.0, 401)


def _bernstein(coefficients: np.ndarray, s: np.ndarray) -> np.ndarray:
    degree = len(coefficients) - 1
    return sum(
        b * comb(degree, i) * s**i * (1.0 - s) ** (degree - i) for i, b in enumerate(coefficients)
    )


def _from_ends(polynomial: np.polynomial.Polynomial, h: float, degree: int) -> np.ndarray:
    p, d, s = polynomial, polynomial.deriv(), polynomial.deriv(2)
    if degree == 5:
        ends = [(float(p(x)), float(d(x)), float(s(x))) for x in (0.0, h)]
        return np.array(quintic_bernstein(*ends, h))
    return np.array(cubic_bernstein(*map(float, (p(0.0), d(0.0), p(h), d(h), h))))


@pytest.mark.parametrize("degree", [3, 5])
def test_random_polynomials(degree):
    rng = np.random.default_rng(1)
    for _ in range(100):
        h = 10.0 ** rng.uniform(-6, 3)
        # Terms of like size on [0, h], so that the rounding below means something.
        polynomial = np.polynomial.Polynomial(
            rng.normal(size=degree + 1) / h ** np.arange(degree + 1)
        )
        b = _from_ends(polynomial, h, degree)
        values = polynomial(h * SAMPLES)
        rounding = 200.0 * EPS * np.abs(polynomial.coef * h ** np.arange(degree + 1)).sum()
        np.testing.assert_allclose(_bernstein(b, SAMPLES), values, rtol=0.0, atol=rounding)
        assert b.min() - rounding <= values.min()
        assert values.max() <= b.max() + rounding


def test_a_dip_between_positive_ends_is_not_excluded():
    # (s - 1/2)^2 - 1e-9 is positive at both ends with slopes that hide nothing.
    p = np.polynomial.Polynomial([0.25 - 1e-9, -1.0, 1.0])
    assert _from_ends(p, 1.0, 5).min() < 0.0
    assert _from_ends(p, 1.0, 3).min() < 0.0
