"""Records: values, jumps, scaling and refusals."""

import math

import numpy as np
import pytest

from eventpound.errors import InputError
from eventpound.motion import Record

SAMPLES = np.array([0.5, -1.0, 2.0, -3.0, 1.0])


def test_linear_between_samples_with_jumps_at_both_ends():
    record = Record(SAMPLES, 0.1, start=1.0)
    t = np.array([1.0 - 1e-9, 1.0, 1.05, 1.25, record.end - 1e-12, record.end, 9.0])
    np.testing.assert_allclose(
        record.acceleration(t), [0.0, 0.5, -0.25, -0.5, 1.0, 0.0, 0.0], atol=1e-9
    )
    assert record.acceleration(np.array([1.0]))[0] == 0.5


def test_kinematics_at_every_sample_of_a_long_record():
    samples = np.random.default_rng(3).normal(size=4000)
    dt = 0.02
    record = Record(samples, dt)
    t = dt * np.arange(4000)
    # With the triangle function of every sample: v(t_n) is the trapezoidal sum
    # exactly, d(t_n) = sum_i a_i times the second integral of its triangle.
    weights = np.full(4000, dt)
    weights[[0, -1]] = dt / 2.0
    n = 3999
    lever = dt * (n - np.arange(4000.0))
    lever[0] -= dt / 3.0
    lever[-1] += dt / 3.0
    # 4000 additions of numbers up to |v|, |d| ~ 10 in double precision.
    assert record.velocity(t[-1:])[0] == pytest.approx(np.dot(weights, samples), abs=1e-11)
    assert record.displacement(t[-1:])[0] == pytest.approx(
        np.dot(weights * lever, samples), abs=1e-10
    )


def test_after_the_end_the_ground_keeps_its_velocity():
    record = Record(SAMPLES, 0.1)
    at, late = record.velocity(np.array([record.end, record.end + 2.0]))
    d_at, d_late = record.displacement(np.array([record.end, record.end + 2.0]))
    assert at == late
    assert d_late == pytest.approx(d_at + 2.0 * at, rel=1e-15)


def test_scale_pga_and_reverse():
    t = np.linspace(-0.1, 0.6, 71)
    plain = Record(SAMPLES, 0.1).acceleration(t)
    scaled = Record(SAMPLES, 0.1, scale=2.5).acceleration(t)
    np.testing.assert_allclose(scaled, 2.5 * plain, atol=1e-14)
    turned = Record(SAMPLES, 0.1, pga=6.0, reverse=True)
    np.testing.assert_allclose(turned.acceleration(t), -2.0 * plain, atol=1e-14)
    assert turned.scales().a_g == 6.0
    assert turned.scales().period == pytest.approx(Record(SAMPLES, 0.1).mean_period, rel=1e-15)


def test_samples_are_a_copy_that_cannot_change():
    mine = SAMPLES.copy()
    record = Record(mine, 0.1)
    mine[0] = 99.0
    assert record.samples[0] == 0.5
    with pytest.raises(ValueError, match="read-only"):
        record.samples[0] = 1.0


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"samples": [1.0]}, "at least 2"),
        ({"samples": [1.0, math.nan]}, "sample 2 is nan"),
        ({"samples": [0.0, 0.0, 0.0]}, "every sample is zero"),
        ({"time_step": 0.0}, "time_step"),
        ({"scale": -1.0}, "scale"),
        ({"pga": 0.0}, "pga"),
        ({"pga": 1.0, "scale": 2.0}, "give one of them"),
        ({"start": math.nan}, "start"),
    ],
)
def test_refusals_name_what_is_wrong(arguments, text):
    with pytest.raises(InputError, match=text):
        Record(**{"samples": SAMPLES, "time_step": 0.1, **arguments})
