from dataclasses import replace

import numpy as np
import pytest

from eventpound.accuracy.conditioning import LARGE, SMALL, conditioning, perturbed
from eventpound.motion.pulses import Sine, TypeC
from eventpound.motion.record import Record
from eventpound.scene import BARRIER, GROUND, Body, BoucWen, Contact, Linear, Scene, Spring
from eventpound.scene.check import check_scene

OSCILLATOR = Scene((Body("b", 2.0, 0.3),), (Spring("s", (GROUND, "b"), Linear(50.0)),))


def _measure(function):
    """Values of the oscillator's numbers m, k, u_0 instead of those of its motion."""

    def measure(scene):
        body, law = scene.bodies[0], scene.springs[0].law
        values = function(body.mass, law.stiffness, body.displacement)
        return np.atleast_1d(values), np.array([[body.displacement]])

    return measure


def test_amplification_of_a_smooth_function():
    """u_0 cos(3 sqrt(k/m)): at most the sum of the parts of all inputs, and near it."""
    found = conditioning(OSCILLATOR, _measure(lambda m, k, u: u * np.cos(3.0 * np.sqrt(k / m))))
    phase = 3.0 * np.sqrt(25.0)
    largest = abs(0.3 * np.cos(phase)) + 2.0 * abs(0.5 * phase * 0.3 * np.sin(phase))
    # The second order is η times that of the first.
    assert 0.3 * largest < found.slope[0] <= largest * (1.0 + 1e-4)
    assert found.exponent[0] == pytest.approx(1.0, abs=0.15)
    assert found.growth[0] == pytest.approx(0.3 * LARGE, rel=0.5)


def test_exponents_of_a_graze_and_a_jump():
    found = conditioning(
        OSCILLATOR,
        _measure(lambda m, k, u: np.array([np.sqrt(abs(k / 50.0 - 1.0)), float(k > 50.0)])),
    )
    # Draws of the largest among eight differ by a factor of two or so at either size.
    assert found.exponent == pytest.approx([0.5, 0.0], abs=0.15)
    assert found.of_rounding[1] == 1.0
    assert found.largest_slope[1] == 1.0 / SMALL


def test_a_quantity_that_a_small_change_takes_away_is_lost():
    found = conditioning(
        OSCILLATOR, _measure(lambda m, k, u: np.array([k, np.nan if k > 50.0 else 1.0]))
    )
    assert found.lost.tolist() == [False, True]


@pytest.mark.parametrize(
    "motion",
    [
        Sine(2.0, 0.7),
        TypeC(2.0, 0.7, cycles=2),
        TypeC(2.0, 0.7, cycles=2.0),
        Record(np.array([0.0, 1.0, -0.5]), 0.1, pga=3.0),
        Record(np.array([0.0, 1.0, -0.5]), 0.1, scale=2.0),
    ],
)
def test_every_measured_number_changes_and_the_scene_stays_valid(motion):
    scene = Scene(
        (Body("a", 1.0, 0.1), Body("b", 2.0, -0.05)),
        (Spring("s", (GROUND, "a"), BoucWen(5.0, 1.0, 0.02, initial_z=1.0)),),
        (),
        (Contact("closed", "a", "b", 0.15, 1.0), Contact("open", "b", BARRIER, 0.4, 0.5)),
        motion,
    )
    check_scene(scene)
    for seed in range(10):
        other = perturbed(scene, 1e-3, np.random.default_rng(seed))
        check_scene(other)
        a, b = other.bodies
        assert other.contacts[0].gap == a.displacement - b.displacement
        assert a.mass != 1.0
        assert other.springs[0].law.stiffness != 5.0
        assert abs(a.mass - 1.0) <= 1e-3
        if isinstance(motion, Record):
            assert not np.array_equal(other.motion.samples, motion.samples)
        if isinstance(motion, TypeC):
            assert other.motion == replace(other.motion, cycles=2)
