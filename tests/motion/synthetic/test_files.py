"""Files of synthetic motions: the same for the same seed, and read back as what they are."""

import math

import numpy as np
import pytest

from eventpound.motion import Record, read_record
from eventpound.motion.synthetic import synthetic_motion
from eventpound.units import STANDARD_GRAVITY


def test_same_seed_same_bytes():
    first, again = synthetic_motion(3, 2), synthetic_motion(3, 2)
    assert first.content == again.content
    assert first.name == "synthetic-3-0002.AT2"
    assert synthetic_motion(3, 1).content != first.content
    assert synthetic_motion(4, 2).content != first.content


def test_file_is_read_as_written_and_says_what_it_is(tmp_path):
    motion = synthetic_motion(1, 1)
    file = tmp_path / motion.name
    file.write_bytes(motion.content)
    data = read_record(file)
    assert b"SYNTHETIC" in motion.content.splitlines()[0]
    assert data.event is None
    assert (data.format, data.units, data.time_step) == ("at2", "G", 0.01)
    assert np.array_equal(data.acceleration, motion.record.acceleration)
    # Seven decimals of a number between 1 and 10.
    largest = np.abs(motion.acceleration).max()
    assert np.abs(data.acceleration - motion.acceleration).max() <= 0.5e-7 * largest * 1.01


def test_ground_comes_to_rest():
    for number in (1, 2, 3):
        data = synthetic_motion(1, number).record
        record = Record(data.acceleration, data.time_step)
        speed = np.abs(record.velocity(np.linspace(0.0, record.end, 4000))).max()
        # After the noise a critically damped oscillator is left, for 9.4 / omega_c:
        # what remains of its velocity is below (1 + 9.4) exp(-9.4) = 8.6e-4.
        assert abs(float(record.velocity(np.array(record.end)))) < 1e-3 * speed


def test_arias_intensity_is_the_one_drawn_on_average():
    """The ratio of a motion's own intensity to I_a, over 15 motions.

    It has the mean 1 less what the high-pass takes and the noise after the
    last 0.1 % would have added. Its variance is that of a sum of squares with
    some 2 zeta_f omega_mid D / pi independent ones, a few per cent of 1.
    """
    ratios = []
    for number in range(1, 16):
        motion = synthetic_motion(2, number)
        a, dt = motion.record.acceleration, motion.record.time_step
        own = math.pi / (2.0 * STANDARD_GRAVITY) * float(a @ a) * dt
        ratios.append(own / motion.parameters.I_a)
    error = np.std(ratios) / math.sqrt(len(ratios))
    assert np.mean(ratios) == pytest.approx(1.0, abs=4.0 * error + 0.02)
