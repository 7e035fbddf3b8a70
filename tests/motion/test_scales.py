"""Mean period against sums written out and signals of known content."""

import math

import numpy as np
import pytest

from eventpound.motion.base import moves
from eventpound.motion.free import NoMotion
from eventpound.motion.intensity import Characteristics
from eventpound.motion.readers.base import RecordData
from eventpound.motion.record import Record
from eventpound.motion.scales import CONVENTIONS, mean_period, transform_length


def test_mean_period_by_a_transform_written_out():
    a = np.random.default_rng(1).normal(size=300)
    dt = 0.05
    length = 400  # 1 / (400 * 0.05 s) = 0.05 Hz
    frequency = np.arange(1, length // 2 + 1) / (length * dt)
    n = np.arange(300)
    power = np.array([abs(np.sum(a * np.exp(-2j * math.pi * f * dt * n))) ** 2 for f in frequency])
    inside = (frequency >= 0.25) & (frequency <= 20.0)
    expected = np.sum(power[inside] / frequency[inside]) / np.sum(power[inside])
    # The two transforms agree to about length * eps of the largest coefficient.
    assert mean_period(a, dt) == pytest.approx(expected, rel=1e-11)


def test_whole_number_of_cycles_in_the_transform_has_its_own_period():
    dt, length = 0.01, 4096
    frequency = 64 / (length * dt)  # on a bin, so it does not leak
    a = np.sin(2.0 * math.pi * frequency * dt * np.arange(length))
    assert mean_period(a, dt) == pytest.approx(1.0 / frequency, rel=1e-10)


@pytest.mark.parametrize(
    ("size", "dt", "length"),
    [(5000, 0.01, 5000), (2000, 0.01, 2000), (100, 0.02, 1000), (100, 0.0033, 6061)],
)
def test_padding_resolves_a_twentieth_of_a_hertz(size, dt, length):
    assert transform_length(size, dt) == length


def test_a_record_of_twenty_seconds_is_given_no_zeros():
    # A transform of 4096 samples has other frequencies between 0.25 and 20 Hz, and 12 % less.
    a = np.random.default_rng(20).normal(size=2000)
    assert mean_period(a, 0.01) == mean_period(a, 0.01, "literal")


def test_a_record_without_motion_in_the_band_has_no_mean_period():
    for convention in CONVENTIONS:
        assert math.isnan(mean_period(np.ones(2), 10.0, convention))
    # Without its mean nothing but rounding is left of it.
    assert math.isnan(mean_period(np.full(1000, 0.1), 0.01, "slammer"))


def test_a_record_without_a_mean_period_has_no_scales():
    constant = Record(np.ones(2), 10.0, scale=3.0)
    assert constant.scales() is None
    assert constant.peak == 3.0
    assert moves(constant)
    assert not moves(NoMotion())
    row = Characteristics(RecordData(np.ones(2), 10.0, "m/s^2", "columns", "r.txt", "0")).row()
    assert row["pga_m_s2"] == 1.0
    assert all(math.isnan(row[key]) for key in ("tm_s", "omega_g_rad_s", "le_m"))
