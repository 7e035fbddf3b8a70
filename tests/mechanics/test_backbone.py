"""The backbone Φ against the hypergeometric function, the rate law and itself."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import hyp2f1

from eventpound.mechanics.backbone import backbone, backbone_inverse, backbone_table
from eventpound.mechanics.elements import z_rate
from eventpound.mechanics.link_law import z_bound
from eventpound.tolerances import BEYOND_TABLE
from tests.mechanics.dense import memory_of

EPS = np.finfo(float).eps
EXPONENTS = (1.0, 1.5, 2.0, 5.0, 20.0, 20.5, 100.0, 1e4)
SHAPES = ((0.5, 0.5), (0.1, 0.9), (0.9, 0.1), (-0.2, 0.8), (1.0, 1.0))
ROUNDING = 16.0 * EPS
"""Of Φ: a cell's polynomial and the rounding handed on through the cells, which the
contraction ``Φ' < 1`` damps."""

many = pytest.mark.sweep
every_law = pytest.mark.parametrize(
    ("n", "beta", "gamma"), [(n, *shape) for n in EXPONENTS for shape in SHAPES]
)


def _phi(table: np.ndarray, xi: np.ndarray) -> np.ndarray:
    return np.array([backbone(table, 0, float(x)) for x in xi])


def _inverse(table: np.ndarray, y: np.ndarray) -> np.ndarray:
    return np.array([backbone_inverse(table, 0, float(x)) for x in y])


def _rho(beta: float, gamma: float) -> float:
    return (beta - gamma) / (beta + gamma)


def _sample(n: float) -> np.ndarray:
    """Values of y from 1e-12 to near 1, where |y|^n goes from nothing to nearly one."""
    w = np.array([1e-9, 1e-3, 0.1, 0.3, 0.5, 0.8, 0.95, 0.99, 0.9999])
    return np.unique(np.concatenate((10.0 ** np.linspace(-12.0, -0.3, 20), w ** (1.0 / n))))


@every_law
def test_against_the_hypergeometric_function(n, beta, gamma):
    # ∫_0^y ds / (1 - κ s^n) = y 2F1(1, 1/n; 1 + 1/n; κ y^n); SciPy's is good to 1e-13 or so
    # of its value, and an error of ξ is one of Φ times 1 - κ y^n.
    table = backbone_table(n, beta, gamma)
    y = _sample(n)
    for sign, kappa in ((1.0, 1.0), (-1.0, _rho(beta, gamma))):
        xi = y * hyp2f1(1.0, 1.0 / n, 1.0 + 1.0 / n, kappa * y**n)
        slope = 1.0 - kappa * y**n
        allowed = ROUNDING + 1e-13 * xi * slope
        error = np.abs(_phi(table, sign * xi) - sign * y)
        assert np.all(error <= allowed), (sign, np.max(error / allowed))


@pytest.mark.parametrize(
    ("n", "beta", "gamma"),
    [
        pytest.param(n, *shape, marks=[] if n in (1.0, 2.0, 20.0) and i in (0, 3) else many)
        for n in EXPONENTS
        for i, shape in enumerate(SHAPES)
    ],
)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_against_the_rate_law(n, beta, gamma, sign):
    # From z = 0 with x' = 1 both ways: loading is Φ(ξ > 0); unloading is found on the way
    # from Φ(ξ < 0) = y up to zero.
    u_y, memory = 0.3, memory_of(n, beta, gamma, 0.3)
    (bound,) = z_bound(memory)
    table = backbone_table(n, beta, gamma)
    y = 0.999 if sign > 0.0 else -0.9
    first, last = (0.0, y) if sign > 0.0 else (y, 0.0)
    xi = np.sort([backbone_inverse(table, 0, first), backbone_inverse(table, 0, last)])
    ends = np.linspace(xi[0], xi[1], 40)
    path = solve_ivp(
        lambda _, z: [z_rate(0, memory, 1.0, 1.0, z[0], 0.0)],
        (0.0, (xi[1] - xi[0]) * u_y * bound),
        [first * bound],
        method="DOP853",
        t_eval=np.minimum((ends - xi[0]) * u_y * bound, (xi[1] - xi[0]) * u_y * bound),
        rtol=1e-13,
        atol=1e-15,
        # |z|^n hides the knee from a step that is long.
        max_step=0.05 * u_y * bound / n if n < 1e3 else 0.5 * u_y * bound / n,
    )
    np.testing.assert_allclose(bound * _phi(table, ends), path.y[0], rtol=0.0, atol=3e-12 * bound)


@every_law
def test_the_inverse_undoes_it(n, beta, gamma):
    # A rounding of y is one of ξ divided by Φ' = 1 - κ |y|^n: so conditioned is the inverse.
    table = backbone_table(n, beta, gamma)
    y = np.concatenate((_sample(n), -_sample(n), [0.0, -1.0, 1.0 - 1e-9, 1.0 - 1e-12]))
    back = _phi(table, _inverse(table, y))
    np.testing.assert_allclose(back, y, rtol=ROUNDING, atol=ROUNDING)
    kappa = np.where(y > 0.0, 1.0, _rho(beta, gamma))
    slope = 1.0 - kappa * np.abs(y) ** n
    xi = _inverse(table, y)
    keep = slope > 1e-10
    again = _inverse(table, back[keep])
    # |y|^n itself errs by n roundings, beside the two of y.
    assert np.all(
        np.abs(again - xi[keep]) <= 2.0 * ROUNDING * (np.abs(xi[keep]) + 1.0 / slope[keep])
    )


@every_law
def test_continuous_and_monotone_within_its_bound(n, beta, gamma):
    table = backbone_table(n, beta, gamma)
    low, high = backbone_inverse(table, 0, -1.0), table[6]
    xi = np.concatenate((np.linspace(max(low, -3.0), high, 2_001), [high, 2.0 * high, 1e9]))
    y = _phi(table, xi)
    assert np.all(np.diff(y) >= -ROUNDING)
    assert y.max() <= 1.0 + ROUNDING
    assert np.all(y[-3:] >= 1.0 - ROUNDING)
    assert np.all(y >= -1.0 - 2.0 * BEYOND_TABLE)


@every_law
def test_no_jump_between_cells(n, beta, gamma):
    table = backbone_table(n, beta, gamma)
    borders = [0.0, table[3], *(table[3] + np.arange(1, int(table[5]) + 1) / table[4])]
    if _rho(beta, gamma) != 0.0:
        borders += list(-table[7] - np.arange(int(table[9])) / table[8])
    for border in borders:
        below, above = np.nextafter(border, -np.inf), np.nextafter(border, np.inf)
        # Beside the slope of at most 1 + |ρ|, over two roundings of ξ.
        steep = (1.0 + abs(_rho(beta, gamma))) * (above - below)
        assert abs(backbone(table, 0, above) - backbone(table, 0, below)) <= ROUNDING + steep


def test_an_elastic_perfectly_plastic_limit():
    # n → ∞: Φ = min(ξ, 1), the difference at the corner ln 2/n.
    table = backbone_table(1e4, 0.5, 0.5)
    xi = np.linspace(-0.99, 3.0, 400)
    assert np.max(np.abs(_phi(table, xi) - np.minimum(xi, 1.0))) < 1.01 * np.log(2.0) / 1e4
