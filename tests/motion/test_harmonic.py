"""Harmonic motion, with and without end."""

import math

import numpy as np
import pytest

from eventpound.errors import InputError
from eventpound.motion import Harmonic


def test_endless_harmonic_has_no_last_piece():
    motion = Harmonic(2.0, 0.5, start=0.1)
    assert motion.end == math.inf
    assert len(motion.pieces()) == 2
    t = np.array([0.1, 7.3, 1000.0])
    # The argument 2 pi t / T = 1.3e4 is rounded to 1e-12.
    np.testing.assert_allclose(
        motion.acceleration(t), 2.0 * np.sin(4.0 * math.pi * (t - 0.1)), atol=1e-11
    )


def test_cycles_end_it_in_the_middle_of_a_period():
    motion = Harmonic(2.0, 0.5, cycles=1.25)
    assert motion.end == 0.625
    assert motion.acceleration(np.array([0.625 - 1e-9, 0.625])).tolist() == pytest.approx(
        [2.0, 0.0]
    )


@pytest.mark.parametrize("cycles", [0.0, -1.0, math.inf])
def test_cycles_must_be_positive(cycles):
    with pytest.raises(InputError, match=r"harmonic.*cycles"):
        Harmonic(1.0, 1.0, cycles=cycles)
