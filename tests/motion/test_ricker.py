"""Ricker wavelets: peaks, places of the peaks, what is left at start and end."""

import math

import numpy as np
import pytest

from eventpound.errors import InputError
from eventpound.motion import AntisymmetricRicker, Family, Ricker


def test_symmetric_wavelet_by_its_formula():
    wavelet = Ricker(1.3, 0.9, center=2.0)
    t = np.linspace(0.0, 4.0, 101)
    x2 = (math.pi * (t - 2.0) / 0.9) ** 2
    np.testing.assert_allclose(
        wavelet.acceleration(t), 1.3 * (1.0 - 2.0 * x2) * np.exp(-x2), atol=1e-14
    )
    assert wavelet.acceleration(np.array([2.0]))[0] == 1.3


def test_antisymmetric_wavelet_has_the_published_normalisation():
    # Vassiliou and Makris 2011: a_p / 1.3801 (4 pi^2 t^2 / (3 T^2) - 3) 2 pi t / (sqrt(3) T) ...
    wavelet = AntisymmetricRicker(1.0, 0.9, center=0.0)
    t = np.linspace(-2.0, 2.0, 101)
    x = 2.0 * math.pi * t / (math.sqrt(3.0) * 0.9)
    np.testing.assert_allclose(
        wavelet.acceleration(t), (x**2 - 3.0) * x * np.exp(-(x**2) / 2.0) / 1.3801, atol=5e-5
    )


def test_antisymmetric_wavelet_peaks_where_its_derivative_vanishes():
    wavelet = AntisymmetricRicker(2.0, 0.9, center=0.0)
    t = math.sqrt(3.0 - math.sqrt(6.0)) * math.sqrt(3.0) * 0.9 / (2.0 * math.pi)
    np.testing.assert_allclose(wavelet.acceleration(np.array([-t, t])), [2.0, -2.0], rtol=1e-15)


@pytest.mark.parametrize(
    ("wavelet", "fraction"), [(Ricker(1.0, 0.8), -9.7e-4), (AntisymmetricRicker(1.0, 0.8), -3.9e-5)]
)
def test_acceleration_left_at_the_start_is_the_documented_one(wavelet, fraction):
    magnitude = abs(wavelet.acceleration(np.array([0.0]))[0])
    assert magnitude == pytest.approx(abs(fraction), rel=0.01)


def test_nothing_is_cut_off():
    (piece,) = Ricker(1.0, 0.8, start=1.0).pieces()
    assert (piece.start, piece.end, piece.family) == (-math.inf, math.inf, Family.GAUSSIAN)


def test_default_centers():
    assert Ricker(1.0, 0.8, start=0.5).middle == pytest.approx(0.5 + 0.8)
    assert AntisymmetricRicker(1.0, 0.8, start=0.5).middle == pytest.approx(0.5 + 1.2)


def test_center_must_be_a_number():
    with pytest.raises(InputError, match=r"ricker.*center"):
        Ricker(1.0, 1.0, center=math.nan)
