"""Intensity measures against closed forms and the motion itself, finely sampled."""

import math

import numpy as np
import pytest

from eventpound.motion import Record
from eventpound.motion.intensity import intensity
from eventpound.units import STANDARD_GRAVITY


def test_a_triangle():
    # a rises from 0 to A in dt and falls back.
    peak, dt = 3.0, 0.1
    measures = intensity(Record(np.array([0.0, -peak, 0.0]), dt, start=5.0))
    assert measures.pga == peak
    assert measures.time_of_pga == dt
    # v ends at A dt, d at A dt^2.
    assert measures.pgv == pytest.approx(peak * dt, rel=1e-14)
    assert measures.pgd == pytest.approx(peak * dt**2, rel=1e-14)
    assert measures.cav == pytest.approx(peak * dt, rel=1e-14)
    assert measures.arias == pytest.approx(
        math.pi / (2.0 * STANDARD_GRAVITY) * peak**2 * dt, rel=1e-14
    )
    # Half of the sum of squares in each interval: 5 % after a tenth of the first.
    assert measures.duration_from == pytest.approx(0.1 * dt, rel=1e-13)
    assert measures.significant_duration == pytest.approx(1.8 * dt, rel=1e-13)


def test_extremes_between_samples():
    # a = 1 - 2 t / dt: v = t - t^2 / dt has its peak dt / 4 at dt / 2, and is zero
    # at dt, where d = dt^2 / 6; then a = -1 + 4 (t - dt) / dt.
    dt = 0.2
    measures = intensity(Record(np.array([1.0, -1.0, 3.0]), dt))
    # v(t) = -s + 2 s^2 / dt is back at zero after s = dt / 2, and dt at the end.
    assert measures.pgv == pytest.approx(dt, rel=1e-14)
    only = intensity(Record(np.array([1.0, -1.0]), dt))
    assert only.pgv == pytest.approx(0.25 * dt, rel=1e-14)
    assert only.pgd == pytest.approx(dt**2 / 6.0, rel=1e-14)


@pytest.mark.parametrize("seed", range(5))
def test_peaks_are_those_of_the_motion_finely_sampled(seed):
    samples = np.random.default_rng(seed).normal(size=60)
    dt, parts = 0.02, 2000
    record = Record(samples, dt, scale=1.7)
    measures = intensity(record)
    t = np.linspace(0.0, record.end, 59 * parts + 1)
    v, d = np.abs(record.velocity(t)).max(), np.abs(record.displacement(t)).max()
    # A parabola's peak between points h / 2 away is missed by at most a'' h^2 / 8.
    h = dt / parts
    slope = np.abs(np.diff(record.values)).max() / dt
    assert 0.0 <= measures.pgv - v + 1e-14 <= slope * h**2 / 8.0 + 2e-14
    assert 0.0 <= measures.pgd - d + 1e-14 <= measures.pga * h**2 / 8.0 + 2e-14


def test_a_sine_of_whole_cycles():
    # Trapezium sums of sin^2 over whole cycles are exact; those of |sin| are not.
    a_p, dt, n = 2.0, 0.01, 400
    t = dt * np.arange(n + 1)
    measures = intensity(Record(a_p * np.sin(2.0 * math.pi * t / 0.5), dt))
    duration = n * dt
    assert measures.arias == pytest.approx(
        math.pi / (2.0 * STANDARD_GRAVITY) * a_p**2 * duration / 2.0, rel=1e-12
    )
    # Euler-Maclaurin: each kink of |sin| costs (w dt)^2 / 12 of its cycle's area.
    angle = 2.0 * math.pi * dt / 0.5
    assert measures.cav == pytest.approx(
        a_p * duration * 2.0 / math.pi * (1.0 - angle**2 / 12.0), rel=angle**4
    )
    # The Husid curve is symmetric about the middle.
    assert measures.duration_from + measures.duration_to == pytest.approx(duration, rel=1e-12)
