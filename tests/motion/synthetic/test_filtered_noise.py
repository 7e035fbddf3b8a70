"""The filtered noise: its variance, its rate of zero crossings, and the ground at rest."""

import math

import numpy as np
import pytest

from eventpound.motion.synthetic.filtered_noise import (
    CORNER_FREQUENCY,
    LEAST_FREQUENCY,
    Filter,
    at_rest_in_the_end,
    unit_process,
)

STEP = 0.01


def noise(count: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal(count)


def test_process_is_the_sum_of_the_definition():
    """The recursion against the sum over all impulses, formula by formula."""
    shape = Filter(20.0, -3.0, 1.0, 0.3)
    u = noise(200, 1)
    process = unit_process(shape, u, STEP)
    t_i = STEP * np.arange(u.size)
    omega = np.maximum(20.0 - 3.0 * (t_i - 1.0), LEAST_FREQUENCY)
    damped = math.sqrt(1.0 - 0.3**2)
    for k in (1, 7, 200):
        tau = k * STEP - t_i[:k]
        h = omega[:k] / damped * np.exp(-0.3 * omega[:k] * tau) * np.sin(omega[:k] * damped * tau)
        expected = (h @ u[:k]) / math.sqrt(h @ h)
        # k complex products, each to a few units of rounding.
        assert process[k] == pytest.approx(expected, rel=0.0, abs=8.0 * 200 * 2.3e-16)


def test_variance_is_one_at_every_time():
    """Over m motions (m - 1) s^2 is chi-squared: its standard error is sqrt(2 / m)."""
    shape, runs = Filter(25.0, -1.0, 1.0, 0.25), 2000
    values = np.array([unit_process(shape, noise(60, seed), STEP) for seed in range(runs)])
    assert np.all(values[:, 0] == 0.0)
    variance = np.mean(values[:, [5, 30, 60]] ** 2, axis=0)
    assert np.all(np.abs(variance - 1.0) < 4.5 * math.sqrt(2.0 / runs))


@pytest.mark.parametrize(("hertz", "zeta"), [(2.0, 0.2), (5.0, 0.5)])
def test_zero_crossings_follow_the_filter_frequency(hertz, zeta):
    """An oscillator under white noise crosses zero upward omega_f / (2 pi) times a second.

    That is the rate of the continuous process. Seen at steps of dt its sign changes
    with the probability arccos(rho) / pi, where
    rho = exp(-zeta w dt) [cos(w_d dt) + zeta / sqrt(1 - zeta^2) sin(w_d dt)].
    """
    omega = 2.0 * math.pi * hertz
    steps = 40_000
    # The filter does not change, so short stretches after the transient are stationary.
    changes = np.zeros(0)
    for seed in range(20):
        process = unit_process(Filter(omega, 0.0, 0.0, zeta), noise(steps // 20, seed), STEP)
        settled = process[200:]
        changes = np.append(changes, np.diff(np.sign(settled)) != 0.0)
    damped = math.sqrt(1.0 - zeta**2)
    angle = omega * damped * STEP
    rho = math.exp(-zeta * omega * STEP) * (math.cos(angle) + zeta / damped * math.sin(angle))
    expected = math.acos(rho) / math.pi
    # Crossings of a narrow band are more regular than independent ones: a binomial bound.
    deviation = math.sqrt(expected * (1.0 - expected) / changes.size)
    # Impulses at the steps in the place of continuous noise change rho by (w dt)^2 / 6.
    bias = expected * (omega * STEP) ** 2 / 6.0
    assert abs(np.mean(changes) - expected) < 4.0 * deviation + bias
    # And the sampled rate is that of the continuous process, lowered by what dt hides.
    assert np.mean(changes) / (2.0 * STEP) == pytest.approx(hertz, rel=0.12)


def test_frequency_is_linear_in_time_and_bounded():
    shape = Filter(30.0, -2.0, 5.0, 0.2)
    assert shape.frequency(np.array([0.0, 5.0, 10.0])) == pytest.approx([40.0, 30.0, 20.0])
    assert float(shape.frequency(np.array(100.0))) == LEAST_FREQUENCY


def test_a_step_dies_out_as_in_the_closed_form():
    """z'' + 2 w z' + w^2 z = 1 from rest: z'' = (1 - w t) exp(-w t)."""
    t = STEP * np.arange(2000)
    # A ramp of one step stands for the jump that linear interpolation cannot have.
    ramp = np.minimum(t / STEP, 1.0)
    w = CORNER_FREQUENCY

    def ramp_response(s: np.ndarray) -> np.ndarray:
        """Of z'' to a ramp of slope 1/dt: the integral of (1 - w t) exp(-w t)."""
        s = np.maximum(s, 0.0)
        return s * np.exp(-w * s) / STEP

    expected = ramp_response(t) - ramp_response(t - STEP)
    # The recursion adds rounding at each of 2000 steps.
    assert at_rest_in_the_end(ramp, STEP) == pytest.approx(expected, abs=2000 * 2.3e-16 * 10)
