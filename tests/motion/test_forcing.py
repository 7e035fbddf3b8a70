"""Compiled Taylor coefficients against Cauchy's integral formula, and straight lines."""

import math

import numpy as np
import pytest

from eventpound.mechanics.reduced import Forcing, forcing_of
from eventpound.motion import (
    AntisymmetricRicker,
    Cosine,
    Family,
    MavroeidisPapageorgiou,
    Piece,
    Record,
    Ricker,
    Sine,
    TypeC,
)
from eventpound.motion.forcing import decay_time, ground_acceleration, ground_taylor

pytestmark = pytest.mark.usefixtures("interpreted")

ORDER = 24


def _taylor(piece: Piece, t: float, order: int = ORDER) -> np.ndarray:
    out = np.full(order + 1, np.nan)
    ground_taylor(forcing_of(piece, 0.0), t, order, out)
    assert math.isnan(out[order])
    return out[:order]


def _scaled_by_cauchy(piece: Piece, t: float, radius: float) -> np.ndarray:
    """a^(k)(t) / k! radius^k by the trapezoidal rule on a circle of that radius.

    The rule errs by the coefficients of order k + 256, times radius^256, which
    are far below rounding here.
    """
    circle = np.exp(2j * np.pi * np.arange(256) / 256)
    c = piece.coefficients
    s = t + radius * circle - c[0]
    if piece.family is Family.SINUSOIDS:
        values = sum(c[k] * np.cos(c[k + 1] * s + c[k + 2]) for k in range(1, c.size, 3))
    else:
        values = np.polyval(c[:1:-1], s) * np.exp(-c[1] * s**2)
    return np.real(np.fft.fft(values)[:ORDER]) / 256


@pytest.mark.parametrize(
    "motion",
    [
        Sine(2.0, 0.8, start=0.3),
        Cosine(2.0, 6.0, reverse=True),
        TypeC(2.0, 1.0, cycles=2),
        MavroeidisPapageorgiou(2.0, 0.9, gamma=1.4, phase=0.3),
        Ricker(2.0, 1.7),
        AntisymmetricRicker(2.0, 1.7),
    ],
    ids=lambda motion: motion.kind,
)
@pytest.mark.parametrize("t", [0.31, 0.77, 1.9])
def test_coefficients_agree_with_cauchys_formula(motion, t):
    piece = motion.pieces()[-1] if len(motion.pieces()) == 1 else motion.pieces()[1]
    radius = motion.period / (2.0 * math.pi)
    computed = _taylor(piece, t) * radius ** np.arange(ORDER)
    # On a circle of the natural time T / 2 pi the formulas stay below 100 a_p,
    # so both sides are right to a few hundred roundings of a_p = 2.
    np.testing.assert_allclose(computed, _scaled_by_cauchy(piece, t, radius), rtol=0.0, atol=1e-13)
    a = ground_acceleration(forcing_of(piece, 0.0), t)
    assert computed[0] == pytest.approx(a, abs=1e-15)


def test_a_sine_starts_with_an_exact_zero():
    piece = Sine(2.0, 0.8).pieces()[1]
    coefficients = _taylor(piece, 0.0, 4)
    assert coefficients[0] == 0.0
    assert coefficients[2] == 0.0
    assert coefficients[1] == pytest.approx(2.0 * 2.0 * math.pi / 0.8, rel=1e-15)


def test_zero_has_zero_coefficients():
    assert not np.any(_taylor(Sine(1.0, 1.0).pieces()[0], -3.0))


def test_a_record_gives_the_line_to_the_right_of_every_sample():
    samples = np.random.default_rng(5).normal(size=2000)
    dt = 0.005
    piece = Record(samples, dt, start=0.1).pieces()[1]
    for i in range(1999):
        a = _taylor(piece, 0.1 + i * dt, 3)
        assert a[0] == samples[i]
        assert a[1] == (samples[i + 1] - samples[i]) / dt
        assert a[2] == 0.0


def test_a_record_is_continued_by_its_first_and_last_line():
    piece = Record(np.array([1.0, 3.0, 2.0]), 0.5).pieces()[1]
    formula = forcing_of(piece, 0.0)
    assert ground_acceleration(formula, -0.25) == 0.0
    assert ground_acceleration(formula, 1.25) == 1.5
    assert ground_acceleration(formula, 0.25) == 2.0


@pytest.mark.parametrize("t", [-3.0, 0.5, 2.5])
def test_a_gaussian_dies_away_in_its_decay_time(t):
    # |f / f'| of exp(-q s^2), by Taylor coefficients.
    numbers = np.array([0.5, 1.7, 2.0, 0.0, 0.0, 0.0])
    value, slope = _taylor(Piece(-math.inf, math.inf, Family.GAUSSIAN, numbers), t, 2)
    expected = math.inf if slope == 0.0 else abs(value / slope)
    found = decay_time(Forcing(int(Family.GAUSSIAN), numbers, np.empty(0), 0.0), t)
    assert found == pytest.approx(expected, rel=1e-14)
    assert decay_time(Forcing(int(Family.ZERO), np.empty(0), np.empty(0), 0.0), t) == math.inf
