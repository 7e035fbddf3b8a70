"""Baseline correction and filtering against what they must leave alone and take away."""

import math
from typing import Any

import numpy as np
import pytest

from eventpound.errors import InputError
from eventpound.motion.processing import Processing
from eventpound.motion.readers import RecordData


def data(acceleration: Any, time_step: float = 0.01) -> RecordData:
    return RecordData(np.asarray(acceleration, float), time_step, "g", "at2", "a.at2", "0" * 64)


def test_nothing_is_done_unless_asked_for():
    record = data([1.0, 2.0, 3.0])
    assert Processing().apply(record) is record
    assert Processing().described() == {}


@pytest.mark.parametrize("degree", [0, 1, 3, 6])
def test_a_polynomial_is_taken_away_and_what_is_left_has_none(degree):
    random = np.random.default_rng(degree)
    t = np.linspace(0.0, 1.0, 500)
    noise = random.normal(size=500)
    drift = np.polyval(random.normal(size=degree + 1), t)
    plain = Processing(baseline=degree).apply(data(noise)).acceleration
    drifting = Processing(baseline=degree).apply(data(noise + 100.0 * drift)).acceleration
    # The projection is linear, so the drift leaves rounding of its own size only.
    np.testing.assert_allclose(drifting, plain, atol=1e-13 * 500 * 100 * np.abs(drift).max())
    for power in range(degree + 1):
        assert abs(np.dot(plain, t**power)) < 1e-11 * 500


@pytest.mark.parametrize(
    ("corners", "frequency"),
    [
        ({"lowpass": 10.0}, 5.0),
        ({"lowpass": 10.0}, 10.0),
        ({"lowpass": 10.0}, 14.0),
        ({"highpass": 2.0}, 2.0),
        ({"highpass": 2.0}, 4.0),
    ],
)
@pytest.mark.parametrize("order", [2, 4])
def test_gain_is_the_square_of_butterworth_s_without_phase(corners, frequency, order):
    dt, n = 0.01, 8000
    t = dt * np.arange(n)
    sine = np.sin(2.0 * math.pi * frequency * t)
    processing = Processing(order=order, **corners)
    filtered = processing.apply(data(sine)).acceleration
    # |H|^2 of the bilinear transform, whose frequencies are tan(pi f dt).
    ((kind, corner),) = corners.items()
    ratio = math.tan(math.pi * frequency * dt) / math.tan(math.pi * corner * dt)
    ratio = 1.0 / ratio if kind == "highpass" else ratio
    gain = 1.0 / (1.0 + ratio ** (2 * order))
    middle = slice(n // 2 - 1000, n // 2 + 1000)
    # The ends ring and die out as exp(-pi f_c t) at the slowest; 30 s away that is nothing.
    np.testing.assert_allclose(filtered[middle], gain * sine[middle], atol=1e-9)


def test_a_band_and_a_baseline_are_noted():
    random = np.random.default_rng(0)
    processing = Processing(baseline=1, highpass=0.5, lowpass=20.0)
    record = processing.apply(data(random.normal(size=1000)))
    assert record.notes == (
        "processed: baseline of degree 1, highpass 0.5 Hz, lowpass 20 Hz, order 4",
    )
    assert record.acceleration.size == 1000
    assert processing.described() == {"baseline": 1, "highpass": 0.5, "lowpass": 20.0, "order": 4}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"baseline": -1}, r"baseline = -1; accepted: a whole number from 0"),
        ({"baseline": 7}, r"baseline = 7"),
        ({"order": 0}, r"order = 0"),
        ({"highpass": 0.0}, r"highpass = 0.0; accepted: a positive frequency"),
        ({"lowpass": -1.0}, r"lowpass = -1.0"),
        ({"lowpass": math.nan}, r"lowpass = nan"),
        ({"highpass": 5.0, "lowpass": 5.0}, r"the lower corner is that of highpass"),
    ],
)
def test_refusals(arguments, message):
    with pytest.raises(InputError, match=message):
        Processing(**arguments)


def test_a_corner_beyond_nyquist_is_refused():
    with pytest.raises(InputError, match=r"a.at2: a corner of 50 Hz; .* below 50 Hz"):
        Processing(lowpass=50.0).apply(data(np.ones(100)))


def test_a_record_that_is_all_baseline_is_refused():
    with pytest.raises(InputError, match="nothing is left"):
        Processing(baseline=0).apply(data(np.full(64, 0.5)))
