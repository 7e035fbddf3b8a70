"""Taylor coefficients of the motion: closed form, order of convergence, an integrator."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from eventpound.mechanics.reduced import Forcing, motion_rate
from eventpound.mechanics.series import evaluate_series, motion_series
from eventpound.motion.base import Family
from eventpound.scene import GROUND, Body, BoucWen, Linear, Scene, Spring
from tests.mechanics.scenes import Instant, instant, random_instant

ORDER = 12


def _integrated(at: Instant, y: np.ndarray, h: float) -> np.ndarray:
    def rhs(tau: float, state: np.ndarray) -> np.ndarray:
        rate = np.empty(state.size)
        motion_rate(tau, state, rate, at.system, at.forcing)
        return rate

    path = solve_ivp(rhs, (0.0, h), y, method="DOP853", rtol=3e-14, atol=1e-16)
    return np.asarray(path.y[:, -1])


def test_elastic_oscillator_under_a_sine():
    # u'' + ω² u = -a sin(p t): u = A cos ωt + B sin ωt + D sin pt, D = -a/(ω² - p²).
    omega, p, a, t0, u0, v0 = 2.0, 3.0, 1.5, 0.4, 0.3, -0.7
    scene = Scene((Body("m", 2.0),), (Spring("k", (GROUND, "m"), Linear(2.0 * omega**2)),))
    at = instant(scene, [], np.random.default_rng(1), ledger=False)
    forcing = Forcing(int(Family.SINUSOIDS), np.array([0.0, a, p, -0.5 * math.pi]), np.empty(0), t0)
    D = -a / (omega**2 - p**2)
    free_u, free_v = u0 - D * math.sin(p * t0), v0 - D * p * math.cos(p * t0)
    k = np.arange(ORDER + 1)
    factorial = np.array([math.factorial(i) for i in k])
    u = (
        free_u * omega**k * np.cos(k * math.pi / 2)
        + free_v / omega * omega**k * np.sin(k * math.pi / 2)
        + D * p**k * np.sin(p * t0 + k * math.pi / 2)
    ) / factorial
    y = np.zeros(2)
    y[at.system.iq[0]], y[at.system.iv[0]] = u0, v0
    Y = motion_series(0.0, y, at.system, forcing, ORDER, 0.0)
    np.testing.assert_allclose(Y[:, at.system.iq[0]], u, rtol=1e-13, atol=1e-16)
    np.testing.assert_allclose(Y[:-1, at.system.iv[0]], (u * k)[1:], rtol=1e-13, atol=1e-15)


def _smooth_instants(rng: np.random.Generator, count: int) -> list[tuple[Instant, np.ndarray]]:
    """Random scenes, ledger included, far from a reversal and from a zero of z."""
    found = []
    while len(found) < count:
        at = random_instant(rng)
        speeds = at.model.elongations(at.v)[at.model.hysteretic]
        moving = at.system.z_of >= 0
        if (np.abs(speeds[moving]) > 0.3).all() and (np.abs(at.z[moving]) > 0.2).all():
            found.append((at, at.y))
    return found


def test_random_scenes_against_an_integrator():
    h = 0.01
    for at, y in _smooth_instants(np.random.default_rng(61), 40):
        Y = motion_series(0.0, y, at.system, at.forcing, ORDER, 1e-13)
        state, rate = evaluate_series(Y, h)
        # Rates up to 20/s: the first neglected term is below (20 h)^13 = 1e-9 of the state
        # at n = 20 near the bound, else far less; DOP853 adds 1e-13.
        last = np.abs(Y[-1]).max() * h**ORDER
        assert np.abs(state - _integrated(at, y, h)).max() < 1e-12 + last
        actual = np.empty(at.system.size)
        motion_rate(h, state, actual, at.system, at.forcing)
        assert np.abs(rate - actual).max() < 1e-11 + 20 * ORDER * last / h


@pytest.mark.parametrize(("order", "longest"), [(2, 0.02), (3, 0.04), (5, 0.06), (8, 0.15)])
def test_order_of_convergence(order, longest):
    # A series cut after τ^p errs by O(h^(p+1)): slope of log error over log h. The next
    # term shifts the slope by O(h), less than would confuse it with a neighbour.
    law = BoucWen(0.5, 1.0, 0.8, 2.0, 0.3, 0.7, 0.3)
    springs = (Spring("k", (GROUND, "a"), law), Spring("l", ("a", "b"), Linear(1.0)))
    scene = Scene((Body("a", 1.0), Body("b", 2.0)), springs)
    at = instant(scene, [], np.random.default_rng(7), ledger=True)
    Y = motion_series(0.0, at.y, at.system, at.forcing, order, 0.0)
    lengths = longest * np.array([0.5, 0.7, 1.0])
    errors = [np.abs(evaluate_series(Y, h)[0] - _integrated(at, at.y, h)).max() for h in lengths]
    slope = np.polyfit(np.log(lengths), np.log(errors), 1)[0]
    assert slope == pytest.approx(order + 1, abs=0.35)


@pytest.mark.parametrize("z", [0.0, 0.6, -0.6])
@pytest.mark.parametrize("pull", [1.0, -1.0])
@pytest.mark.parametrize("n", [1.0, 2.0, 20.0])
def test_start_from_rest(z, pull, n):
    # x' = 0 at first: its sign is that of the first coefficient that does not vanish.
    law = BoucWen(0.5, 1.0, 0.4, n, 0.3, 0.7, z)
    scene = Scene((Body("m", 1.0),), (Spring("k", (GROUND, "m"), law),))
    at = instant(scene, [], np.random.default_rng(2), ledger=False)
    y = np.array([0.0, 0.0, z])
    forcing = Forcing(int(Family.SAMPLES), np.array([0.0, 1.0]), np.full(2, -5.0 * pull), 0.0)
    Y = motion_series(0.0, y, at.system, forcing, 2 * ORDER, 1e-13)
    at = replace(at, forcing=forcing)
    h = 0.05
    # For z = 0 and n = 20 the loop shows from τ^40 on: beyond the series, and 1e-40 here.
    np.testing.assert_allclose(
        evaluate_series(Y, h)[0], _integrated(at, y, h), rtol=0.0, atol=2e-13
    )


def test_rate_of_a_series_is_its_derivative():
    rng = np.random.default_rng(63)
    Y = rng.normal(size=(9, 4))
    state, rate = evaluate_series(Y, 0.7)
    for i in range(4):
        p = np.polynomial.Polynomial(Y[:, i])
        assert state[i] == pytest.approx(p(0.7), abs=1e-14)
        assert rate[i] == pytest.approx(p.deriv()(0.7), abs=1e-13)
