"""First roots against closed forms, the companion matrix, and values in rational numbers."""

import math
from collections.abc import Sequence
from fractions import Fraction

import numpy as np
import pytest

from eventpound.numerics.polynomial import first_root, only_root, root_work, value_and_slope

pytestmark = pytest.mark.usefixtures("interpreted")
EPS = np.finfo(float).eps


def _root(c: np.ndarray, limit: float) -> float:
    return first_root(c, c.size, limit, root_work(c.size))


def _series(*leading: float, order: int = 12) -> np.ndarray:
    c = np.zeros(order + 1)
    c[: len(leading)] = leading
    return c


@pytest.mark.parametrize("exponent", range(-250, 4, 11))
def test_bounce_intervals_at_every_scale(exponent):
    # A ball thrown with speed v against a constant pull a returns after 2 v/a, whatever v.
    v, a = 10.0**exponent, 3.0
    root = _root(_series(0.0, v, -0.5 * a), 10.0 * max(1.0, v))
    assert root == pytest.approx(2.0 * v / a, rel=8 * EPS)


@pytest.mark.parametrize("exponent", range(-250, -19, 11))
def test_far_terms_do_not_hide_a_tiny_interval(exponent):
    # Terms that rule at x = 1 change the root by a factor 1 + O(v) only.
    v = 10.0**exponent
    c = _series(0.0, v, -1.5, 40.0, -7.0, 300.0, 0.0, -1e4, 1e4)
    assert _root(c, 1.0) == pytest.approx(v / 1.5, rel=8 * EPS)


def test_gap_closing_with_constant_acceleration():
    # g + γ x + a x²/2 in the forms without cancellation.
    rng = np.random.default_rng(2)
    for _ in range(500):
        g, rate, a = 10.0 ** rng.uniform(-30, 2, 3) * np.array([1, -1, rng.choice([-1, 1])])
        inside = rate * rate - 2.0 * a * g
        expected = 2.0 * g / (-rate + math.sqrt(inside)) if inside >= 0.0 else math.inf
        if inside < 1e-6 * rate * rate:
            continue
        limit = 3.0 * expected if expected < math.inf else 1e3
        root = _root(_series(g, rate, 0.5 * a), limit)
        # Rounding of the coefficients moves the root by EPS over its relative slope.
        slack = 16.0 * EPS * rate * rate / inside
        assert root == pytest.approx(expected, rel=slack + 8 * EPS)


@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("factor", [(1.0,), (1.0, 3.0), (1.0, -0.4, 0.3, 0.1), (2.0, 0.0, -0.5)])
@pytest.mark.parametrize("place", [0.03, 0.51, 0.97])
def test_grazes(depth, factor, place):
    # ((x - place)² - depth²) f(x) with f > 0 on [0, 1] dips below zero at place - depth.
    f = np.polynomial.Polynomial(factor)
    dip = np.polynomial.Polynomial([place**2 - depth**2, -2.0 * place, 1.0]) * f
    miss = np.polynomial.Polynomial([place**2 + depth**2, -2.0 * place, 1.0]) * f
    if depth > 1e-7:
        # The square of a smaller depth is lost in the rounding of the coefficients.
        # Where it is looked for decides from where the root is approached: between two that
        # all but meet there is a place at which a step is next to nothing.
        for limit in np.linspace(place + 2.0 * depth, 1.0, 100):
            root = _root(_series(*dip.coef), float(limit))
            assert root == pytest.approx(place - depth, abs=200.0 * EPS / depth)
        assert _root(_series(*miss.coef), 1.0) == math.inf
    else:
        root = _root(_series(*dip.coef), 1.0)
        assert root == math.inf or abs(root - place) < 1e-6


@pytest.mark.parametrize(
    "c", [(1.0,), (0.0, 1.0), (1.0, 1.0, 1.0), (1.0, -1.0, 0.2501), (0.0, 0.0, 2.0, 1.0), (0.0,)]
)
def test_no_root(c):
    assert _root(_series(*c), 100.0) == math.inf


def test_root_beyond_the_limit_is_none():
    assert _root(_series(1.0, -1.0), 1.0 - 1e-12) == math.inf
    assert _root(_series(1.0, -1.0), 1.0 + 1e-12) == pytest.approx(1.0, rel=4 * EPS)


@pytest.mark.parametrize("decay", [1.0, 0.4])
def test_random_polynomials(decay):
    rng = np.random.default_rng(3)
    found = 0
    for _ in range(600):
        degree = rng.integers(1, 13)
        c = rng.normal(size=degree + 1) * decay ** np.arange(degree + 1)
        c[0] = abs(c[0])
        roots = np.roots(c[::-1])
        real = roots[np.abs(roots.imag) < 1e-5].real
        if (np.abs(np.append(roots.imag, 1.0)) < 1e-5).sum() > (roots.imag == 0.0).sum():
            continue  # nearly double: the companion matrix cannot tell
        inside = np.sort(real[(real > 0.0) & (real <= 1.0)])
        expected = inside[0] if inside.size else math.inf
        if abs(expected - 1.0) < 1e-9:
            continue
        slope = value_and_slope(c, expected)[1] if inside.size else 1.0
        root = _root(c, 1.0)
        assert root == pytest.approx(expected, abs=1e-12 / abs(slope) + 1e-12)
        found += root < math.inf
    assert found > 60


def _value(c: np.ndarray, x: float) -> float:
    """Exact value over its rounding, ``EPS Σ |c_k| x^k``."""
    total = Fraction(0)
    for coefficient in c[::-1]:
        total = total * Fraction(x) + Fraction(float(coefficient))
    return float(total) / (EPS * float(np.polynomial.polynomial.polyval(x, np.abs(c))))


def _with_roots(roots: Sequence[Fraction]) -> np.ndarray:
    """Coefficients of the product of ``x - root``, each rounded once."""
    c = [Fraction(1)]
    for root in roots:
        shifted = [Fraction(0), *c]
        c = [high - root * low for high, low in zip(shifted, [*c, Fraction(0)], strict=True)]
    return np.array([float(each) for each in c])


def _hard(kind: str, rng: np.random.Generator) -> np.ndarray:
    """A polynomial that is positive at first, on [0, 1]."""
    degree, place = int(rng.integers(4, 15)), Fraction(rng.uniform(0.05, 0.95))
    near = place * Fraction(10.0 ** rng.uniform(-9.0, -2.0))
    if kind == "zero at the start":
        c = rng.normal(size=degree + 1)
        c[: rng.integers(1, 3)] = 0.0
    elif kind == "decaying":
        c = rng.normal(size=degree + 1) * 0.3 ** np.arange(degree + 1)
    else:
        roots = {
            "double": [place, place],
            "grazing": [place - near, place + near],
            "cluster": [place + near * Fraction(r) for r in rng.uniform(-1.0, 1.0, 4)],
        }[kind]
        others = rng.uniform(-3.0, 3.0, max(0, degree - len(roots)))
        c = _with_roots(roots + [Fraction(r) for r in others])
    return c if c[np.flatnonzero(c)[0]] > 0.0 else -c


@pytest.mark.parametrize("kind", ["zero at the start", "decaying", "double", "grazing", "cluster"])
@pytest.mark.parametrize("seed", range(40))
def test_hard_cases_err_by_rounding_at_every_scale(kind, seed):
    rng = np.random.default_rng(seed)
    scale, size = 10.0 ** rng.uniform(-9.0, 9.0, 2)
    c = _hard(kind, rng)
    c *= size / scale ** np.arange(c.size)
    limit = scale * rng.uniform(0.3, 1.0)
    root = _root(c, limit)
    end = min(root, limit)
    if root < math.inf:
        assert abs(_value(c, root)) <= 2.0
    # Nowhere before is it lower than at its lowest points, which NumPy finds well enough.
    lowest = np.roots(np.polynomial.polynomial.polyder(c)[::-1]).real
    for x in [*lowest[(lowest > 0.0) & (lowest < end)], *np.linspace(0.0, end, 20)[1:-1]]:
        assert _value(c, float(x)) >= -2.0


@pytest.mark.parametrize("seed", range(40))
def test_the_only_root_errs_by_rounding_at_every_scale(seed):
    # 1 less a polynomial that only grows, and hardly at first.
    rng = np.random.default_rng(seed)
    scale, size = 10.0 ** rng.uniform(-9.0, 9.0, 2)
    c = -rng.uniform(size=12) * rng.choice([0.0, 1e-6, 1.0], 12)
    c[0], c[-1] = 1.0, -1e-3
    c *= size / scale ** np.arange(c.size)
    assert abs(_value(c, only_root(c, c.size, 2.0 * scale))) <= 2.0
    assert only_root(c, c.size, 1e-4 * scale) == math.inf


def test_value_and_slope():
    rng = np.random.default_rng(4)
    for _ in range(100):
        c, x = rng.normal(size=13), rng.uniform(-1.0, 1.0)
        p = np.polynomial.Polynomial(c)
        assert value_and_slope(c, x) == pytest.approx((p(x), p.deriv()(x)), abs=1e-13)
