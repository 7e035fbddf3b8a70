"""Damping ratios against the definition, by the eigenvalues of the damped matrices."""

import numpy as np
import pytest

from eventpound.scene import BilinearElastic, Body, BoucWen, Linear, Series, Spring
from eventpound.scene.damping import ratio_coefficient, rayleigh_coefficients, rayleigh_dashpots

EPS = np.finfo(float).eps


def test_ratio_is_that_of_the_free_vibration():
    m, k, xi = 1301e3, 233443e3, 0.05
    c = ratio_coefficient(xi, k, m)
    # m s^2 + c s + k = 0 has roots of modulus omega and real part -xi omega.
    root = np.roots([m, c, k])[0]
    assert -root.real / abs(root) == pytest.approx(xi, rel=1e-13)


def test_published_bridge():
    # 5 % of critical at the initial stiffness of the two-segment bridge, kN s/m.
    assert ratio_coefficient(0.05, 233443e3, 1301e3) == pytest.approx(1742.7e3, abs=50.0)
    assert ratio_coefficient(0.05, 101048e3, 3210e3) == pytest.approx(1801.0e3, abs=50.0)


def test_rayleigh_has_the_ratio_at_both_frequencies():
    xi, first, second = 0.03, 4.0, 25.0
    a, b = rayleigh_coefficients(xi, first, second)
    for omega in (first, second):
        assert 0.5 * (a / omega + b * omega) == pytest.approx(xi, rel=4 * EPS)


def test_rayleigh_dashpots_make_a_m_plus_b_k():
    bodies = (Body("one", 2.0), Body("two", 3.0), Body("outside", 5.0))
    bouc_wen = BoucWen(stiffness=10.0, strength=4.0, yield_displacement=0.1)
    springs = (
        Spring("s1", ("ground", "one"), bouc_wen),
        Spring("s2", ("one", "two"), Linear(70.0)),
        Spring("s3", ("two", "outside"), Linear(90.0)),
        Spring("s4", ("two", "ground"), Series((Linear(1.0),))),
        Spring("slack", ("two", "ground"), BilinearElastic(0.0, 9.0, 0.1)),
    )
    a, b = 0.2, 0.01
    dashpots = rayleigh_dashpots(bodies[:2], springs, a, b)
    index = {"one": 0, "two": 1}
    damping = np.zeros((2, 2))
    for dashpot in dashpots:
        direction = np.zeros(2)
        for end, sign in zip(dashpot.between, (-1.0, 1.0), strict=True):
            if end in index:
                direction[index[end]] = sign
        damping += dashpot.coefficient * np.outer(direction, direction)
    stiffness = np.array([[50.0 + 70.0, -70.0], [-70.0, 70.0 + 1.0]])
    np.testing.assert_allclose(damping, a * np.diag([2.0, 3.0]) + b * stiffness, rtol=8 * EPS)


def test_zero_coefficients_add_no_dashpots():
    springs = (Spring("s", ("ground", "one"), Linear(70.0)),)
    assert rayleigh_dashpots((Body("one", 2.0),), springs, 0.0, 0.0) == ()
