"""Sine, cosine and type-C pulses against closed forms and published phases."""

import math

import numpy as np
import pytest

from eventpound.errors import InputError
from eventpound.motion import Cosine, Sine, TypeC
from eventpound.motion.pulses import type_c_phase


@pytest.mark.parametrize(("n", "published"), [(1, 0.0697), (2, 0.0410)])
def test_phase_of_type_c_is_the_published_one(n, published):
    # Makris and Chang 2000 give phi / pi to four decimals.
    assert type_c_phase(n) / math.pi == pytest.approx(published, abs=0.5e-4)


@pytest.mark.parametrize("n", [1, 2, 3, 10, 100])
def test_phase_of_type_c_solves_its_equation(n):
    phi = type_c_phase(n)
    odd = (2 * n + 1) * math.pi
    residual = math.cos(odd - phi) + (odd - 2.0 * phi) * math.sin(phi) - math.cos(phi)
    # Rounding of the argument (2n+1) pi, and of the product in the middle.
    assert abs(residual) < 4.0 * np.finfo(float).eps * odd


@pytest.mark.parametrize("n", [1, 2, 5])
def test_type_c_ends_at_rest_where_it_started(n):
    pulse = TypeC(3.0, 0.7, cycles=n, start=0.4)
    late = np.array([pulse.end, pulse.end + 10.0])
    scales = pulse.scales()
    np.testing.assert_allclose(pulse.velocity(late), 0.0, atol=1e-14 * scales.a_g / scales.omega_g)
    # 10 s after the end the rounding of the velocity has grown by 10 s.
    np.testing.assert_allclose(pulse.displacement(late), 0.0, atol=1e-13 * scales.a_g)


def test_type_c_lasts_as_long_as_published():
    # (n + 1/2 - phi/pi) T_p with phi = 0.0697 pi.
    assert TypeC(1.0, 2.0).end == pytest.approx(2.0 * (1.5 - 0.0697), abs=1e-4)


def test_sine_leaves_its_permanent_displacement():
    pulse = Sine(2.0, 0.8)
    t = np.array([0.8, 5.0])
    np.testing.assert_allclose(pulse.displacement(t), 2.0 * 0.8**2 / (2.0 * math.pi), rtol=1e-14)
    np.testing.assert_allclose(pulse.velocity(t), 0.0, atol=1e-15)


def test_sine_starts_from_exactly_zero_and_cosine_with_a_jump():
    assert Sine(2.0, 0.8, start=0.3).acceleration(np.array([0.3]))[0] == 0.0
    cosine = Cosine(2.0, 0.8, start=0.3, reverse=True)
    before, at, end = cosine.acceleration(np.array([0.3 - 1e-12, 0.3, cosine.end]))
    assert (before, at, end) == (0.0, -2.0, 0.0)


@pytest.mark.parametrize(
    ("arguments", "key"),
    [
        ({"amplitude": 0.0, "period": 1.0}, "amplitude"),
        ({"amplitude": -1.0, "period": 1.0}, "amplitude"),
        ({"amplitude": math.nan, "period": 1.0}, "amplitude"),
        ({"amplitude": 1.0, "period": 0.0}, "period"),
        ({"amplitude": 1.0, "period": math.inf}, "period"),
        ({"amplitude": 1.0, "period": 1.0, "start": math.inf}, "start"),
        ({"amplitude": 1.0, "period": 1.0, "cycles": 0}, "cycles"),
        ({"amplitude": 1.0, "period": 1.0, "cycles": 1.5}, "cycles"),
    ],
)
def test_a_wrong_number_is_named(arguments, key):
    with pytest.raises(InputError, match=rf"type-c.*{key} = "):
        TypeC(**arguments)
