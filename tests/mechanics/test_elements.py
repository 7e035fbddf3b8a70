"""The laws of springs: eq. 3 as printed, its bound, its series, in each form that is used."""

from dataclasses import asdict

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import hyp2f1

from eventpound.mechanics.elements import (
    CURVE_PLACES,
    begin_curve,
    branch_ends,
    memory_on_branches,
    memory_stiffness,
    next_branch,
    next_z,
    pull_per_z,
    slope_beside,
    z_coefficient,
    z_rate,
    z_slopes,
)
from eventpound.mechanics.link_law import APART, CLOSED, YIELDING, link_law, z_bound
from eventpound.scene import Backfill, BoucWen, DegradingBoucWen, Slider
from eventpound.solvers.fast.sdof.body import SdofBody
from eventpound.solvers.fast.sdof.series import curved_series
from tests.mechanics.dense import literal_z_rate, memory_of

EPS = np.finfo(float).eps


def test_rate_is_the_printed_one():
    rng = np.random.default_rng(41)
    for _ in range(1000):
        n, beta = rng.choice([1.0, 1.5, 2.0, 7.3, 20.0]), rng.uniform(-1.0, 1.0)
        gamma = rng.uniform(0.0, 1.0) - min(beta, 0.0)
        u_y = 10.0 ** rng.uniform(-3, 1)
        z = rng.choice([0.0, rng.uniform(-1.2, 1.2)])
        x_rate = rng.choice([0.0, rng.normal()])
        law = BoucWen(0.0, 1.0, u_y, n, beta, gamma)
        terms = abs(x_rate) / u_y * (1.0 + (abs(beta) + gamma) * abs(z) ** n)
        assert z_rate(0, memory_of(n, beta, gamma, u_y), x_rate, x_rate, z, 0.0) == pytest.approx(
            literal_z_rate(law, x_rate, z), abs=32 * EPS * terms
        )


@pytest.mark.parametrize(("beta", "gamma"), [(0.5, 0.5), (0.1, 0.9), (-0.2, 1.0), (2.0, 3.0)])
@pytest.mark.parametrize("n", [1.0, 2.0, 20.0])
def test_loading_ends_at_the_bound(beta, gamma, n):
    law = memory_of(n, beta, gamma)
    (bound,) = z_bound(law)
    # Terms of size one cancel there; n of the roundings of |z|^n come on top.
    assert abs(z_rate(0, law, 1.0, 1.0, bound, 0.0)) < 8 * (n + 2) * EPS
    assert z_rate(0, law, 1.0, 1.0, 0.999 * bound, 0.0) > 0.0
    assert z_rate(0, law, -1.0, -1.0, -0.999 * bound, 0.0) < 0.0
    assert z_rate(0, law, -1.0, -1.0, bound, 0.0) < 0.0


def test_default_bound_is_one():
    assert z_bound(memory_of(20.0, 0.5, 0.5)) == 1.0


@pytest.mark.parametrize("n", [1.0, 2.0, 5.0, 20.0])
def test_backbone(n):
    # Loading from zero: x/u_y = z 2F1(1, 1/n; 1 + 1/n; z^n), and z_rate integrated.
    u_y = 0.3
    ends = np.array([0.2, 0.6, 0.9, 0.99])
    x = u_y * ends * hyp2f1(1.0, 1.0 / n, 1.0 + 1.0 / n, ends**n)
    path = solve_ivp(
        lambda _, z: [z_rate(0, memory_of(n, 0.5, 0.5, u_y), 1.0, 1.0, z[0], 0.0)],
        (0.0, x[-1]),
        [0.0],
        method="DOP853",
        t_eval=x,
        rtol=1e-13,
        atol=1e-14,
    )
    np.testing.assert_allclose(path.y[0], ends, rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("n", [1.0, 1.5, 20.0])
@pytest.mark.parametrize("z", [-0.8, -0.3, 0.4, 0.9])
@pytest.mark.parametrize("x_rate", [-0.7, 1.3])
def test_slopes_are_those_of_the_rate(n, z, x_rate):
    law, small = memory_of(n, 0.3, 0.6, 0.1), 1e-6
    by_rate, by_z = z_slopes(0, law, x_rate, z, 0.0)
    assert by_rate == pytest.approx(z_rate(0, law, x_rate, x_rate, z, 0.0) / x_rate, rel=1e-13)
    ends = [z_rate(0, law, x_rate, x_rate, z + s, 0.0) for s in (-small, small)]
    assert by_z == pytest.approx((ends[1] - ends[0]) / (2.0 * small), rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("z", [0.4, -0.7])
@pytest.mark.parametrize("x_rate", [0.3, -0.3])
def test_a_law_that_degrades_has_the_rates_slopes_and_series_of_its_equations(z, x_rate):
    plain = BoucWen(0.0, 1.0, 0.25, 2.0, 0.2, 0.7)
    own = DegradingBoucWen(**asdict(plain), strength_degradation=0.3, stiffness_degradation=0.2)
    memory, energy, small = link_law([own], [0.0, 0.0], {0: 1}).memory, 1.5, 1e-6
    nu, eta = 1.0 + 0.3 * energy, 1.0 + 0.2 * energy
    held = x_rate / 0.25 - literal_z_rate(plain, x_rate, z)
    rate = z_rate(0, memory, x_rate, x_rate, z, energy)
    assert rate == pytest.approx((x_rate / 0.25 - nu * held) / eta, rel=1e-14)
    assert z_rate(1, memory, x_rate, x_rate, energy, z) == pytest.approx(z * x_rate / 0.25)
    for a, mine, other in ((0, z, energy), (1, energy, z)):
        found = (*z_slopes(a, memory, x_rate, mine, other),
                 slope_beside(a, memory, x_rate, mine, other))  # fmt: skip
        at = np.array([x_rate, mine, other])
        for slope, step in zip(found, small * np.eye(3), strict=True):
            ends = [z_rate(a, memory, v, v, m, o) for v, m, o in (at - step, at + step)]
            assert slope == pytest.approx((ends[1] - ends[0]) / (2.0 * small), rel=1e-6, abs=1e-9)
    x = np.array([0.0, x_rate, 0.1, -0.05, 0.02] + [0.0] * 16)
    Y, powers = np.zeros((2, x.size)), np.zeros((2, x.size))
    Y[:, 0], x_1 = (z, energy), np.arange(1, x.size) * x[1:]
    for k in range(x.size - 1):
        for a in range(2):
            Y[a, k + 1] = z_coefficient(
                a, k, memory, x_1, Y[a], Y[1 - a], powers[a], np.sign(x_rate)
            ) / (k + 1)
    t = 0.05
    exact = solve_ivp(
        lambda t, y: [
            z_rate(a, memory, v, v, y[a], y[1 - a])
            for v in [sum(c * t**k for k, c in enumerate(x_1.tolist()))]
            for a in range(2)
        ],
        (0.0, t), Y[:, 0], "DOP853", rtol=1e-13, atol=1e-15,
    ).y[:, -1]  # fmt: skip
    np.testing.assert_allclose(Y @ t ** np.arange(x.size), exact, rtol=1e-12)


def test_a_law_that_does_not_degrade_has_bouc_wens_rates_to_the_last_bit():
    plain = BoucWen(0.0, 1.0, 0.3, 3.0, 0.2, 0.7)
    pair = [link_law([law], [0.0]).memory for law in (plain, DegradingBoucWen(**asdict(plain)))]
    for z, x_rate in ((0.37, 0.1), (-0.9, 0.7), (0.6, -0.2)):
        first, second = (
            (z_rate(0, memory, x_rate, x_rate, z, 7.0), *z_slopes(0, memory, x_rate, z, 7.0))
            for memory in pair
        )
        assert first == second


def test_soil_yields_along_its_backbone():
    """``z = -y/(1 + y)`` at the depth y in parts of u_y: its rate, slopes and series."""
    law = link_law([Backfill(4.0, 0.5, 0.5)], [0.0]).memory
    law = memory_on_branches(law, np.array([YIELDING]))
    u_y, depth, x_rate, small = 0.25, 0.6, -0.3, 1e-6
    z = -depth / (1.0 + depth)
    rate = x_rate / u_y / (1.0 + depth) ** 2
    assert z_rate(0, law, x_rate, x_rate, z, 0.0) == pytest.approx(rate)
    by_rate, by_z = z_slopes(0, law, x_rate, z, 0.0)
    assert by_rate == pytest.approx(z_rate(0, law, 1.0, -1.0, z, 0.0))
    ends = [z_rate(0, law, x_rate, x_rate, z + s, 0.0) for s in (-small, small)]
    assert by_z == pytest.approx((ends[1] - ends[0]) / (2.0 * small), rel=1e-6)
    x = np.array([-u_y * depth, x_rate, 0.1, -0.05, 0.02] + [0.0] * 12)
    series = _series_of_z(law, x, z, -1.0)
    t = 0.05
    y = -sum(c * t**k for k, c in enumerate(x.tolist())) / u_y
    assert sum(c * t**k for k, c in enumerate(series.tolist())) == pytest.approx(
        -y / (1.0 + y), rel=1e-13
    )


def test_branches_of_soil_end_where_it_was_left_and_where_it_comes_apart():
    # K0 = F_ult = R_f = 1, pushed in by 1 and unloaded by 1/4: apart at -1/2, as by hand.
    law = link_law([Backfill(1.0, 1.0, 1.0)], [0.0]).memory
    for branch, ends in ((CLOSED, (-1.0, -0.5)), (YIELDING, (-np.inf, 0.0))):
        assert branch_ends(0, law, branch, 0.0, -0.75, -0.25) == pytest.approx(ends)
    assert branch_ends(0, law, APART, 0.0, 0.1, 0.6) == pytest.approx((-0.5, np.inf))
    following = [(CLOSED, -0.5, 0.0, APART), (CLOSED, -1.0, -0.5, YIELDING),
                 (YIELDING, -1.0, -0.5, CLOSED), (APART, -0.5, 0.0, CLOSED)]  # fmt: skip
    for branch, x, z, expected in following:
        assert next_branch(0, law, branch, 0.0, x, z, 1e-13) == expected
    # Soil that was never pushed in has nothing to be inside of.
    assert next_branch(0, law, APART, 0.0, 0.0, 0.0, 1e-13) == YIELDING
    # Touched for the first time and left at once: nothing was pushed in.
    assert next_branch(0, law, CLOSED, 0.0, -1e-15, -1e-15, 1e-13) == APART
    # A z that errs is a force where the backbone has none: it goes with the motion, not at once.
    assert next_branch(0, law, YIELDING, 0.0, 1e-15, -1e-9, 1e-13) == CLOSED
    assert next_branch(0, law, CLOSED, 0.0, 1e-15, -1e-9, 1e-13) == YIELDING


def _series_of_z(law: np.ndarray, x: np.ndarray, z_0: float, sigma: float) -> np.ndarray:
    """Taylor coefficients of z, from those of the elongation, by the general recurrence."""
    z, power = np.zeros(x.size), np.zeros(x.size)
    z[0], rate = z_0, np.arange(1, x.size) * x[1:]
    for k in range(x.size - 1):
        z[k + 1] = z_coefficient(0, k, law, rate, z, z, power, sigma) / (k + 1)
    return z


def test_soil_that_is_hardly_pressed_has_a_series():
    law = link_law([Backfill(1.0, 1.0, 0.5)], [0.0]).memory
    law = memory_on_branches(law, np.array([CLOSED]))
    # As it arrives at rest after a cascade.
    x = np.append((0.0, 1e-93), np.random.default_rng(5).normal(size=24))
    assert _series_of_z(law, x, -1e-186, 1.0)[1:] == pytest.approx(0.5 * x[1:], rel=1e-15)


@pytest.mark.parametrize("n", [1.0, 2.5, 20.0])
@pytest.mark.parametrize(("z_0", "sigma"), [(0.7, 1.0), (-0.6, 1.0), (0.6, -1.0), (-0.8, -1.0)])
def test_series_on_a_curve_is_the_general_one(n, z_0, sigma):
    rng = np.random.default_rng(7)
    law, x = memory_of(n, 0.3, 0.6, 0.5), rng.normal(size=20) * 0.3 ** np.arange(20)
    x[1] = sigma * 0.2
    wanted = _series_of_z(law, x, z_0, sigma)
    z, power, speed, weighted = np.zeros((4, x.size))
    curve = np.zeros(CURVE_PLACES)
    z[0] = z_0
    begin_curve(0, law, np.sign(z_0 * sigma), z_0, power, curve)
    for k in range(1, x.size):
        next_z(k, x[k], z, power, speed, weighted, curve)
    np.testing.assert_allclose(z, wanted, rtol=1e-9, atol=1e-12 * np.abs(wanted).max())


@pytest.mark.parametrize("kappa", [1.0, 0.2])
def test_series_of_one_body_is_the_general_one(kappa):
    """The recurrence that the kernel of one body has for itself, κ > 0 for y of either sign."""
    body = np.zeros(1, SdofBody.layout)[0]
    body.step, body.z, body.exponent, body.per_scale = 0.2, 0.7 if kappa == 1.0 else -0.7, 5.0, 2.0
    body.stiffness, body.damping, body.strength = 3.0, 0.1, 1.5
    body.x[1], body.x[2] = 0.3, -0.4
    body.of_u, body.odd, body.even = 1e-30, 1.0, 1.0
    order = abs(curved_series(kappa, 20, body))
    assert order > 10
    # β + γ = 1 where y > 0 and β - γ = κ where y < 0: one direction of loading.
    law = memory_of(5.0, 0.5 * (1.0 + kappa), 0.5 * (1.0 - kappa), 0.5)
    x = np.array(body.x[:order])
    wanted = _series_of_z(law, x, float(body.z), 1.0)
    np.testing.assert_allclose(body.z_terms[: order - 1], wanted[: order - 1], rtol=1e-10)


def test_slider_pulls_with_its_friction_in_the_direction_of_its_slip():
    law = link_law([Slider(0.1, 5.0, 2.0), BoucWen(0.0, 1.0, 0.1)], [0.0, 0.0]).memory
    for branch, ends in ((1, (0.0, np.inf)), (-1, (-np.inf, 0.0))):
        memory = memory_on_branches(law, np.array([branch, 0]))
        assert pull_per_z(0, memory) == 0.5 * branch
        assert z_rate(0, memory, 0.3, 0.3, 1.0, 0.0) == 0.0
        assert z_slopes(0, memory, 0.3, 1.0, 0.0) == (0.0, 0.0)
        assert memory_stiffness(0, memory) == 0.0
        assert branch_ends(0, memory, branch, 0.0, 0.2, 1.0) == ends
        np.testing.assert_array_equal(memory[1], law[1])
