"""Motions that come later."""

import numpy as np
import pytest

from eventpound.motion import AntisymmetricRicker, Cosine, NoMotion, Ricker, Sine
from eventpound.motion.delayed import Delayed, travelled
from tests.motion.test_loaded import RECORD, ends_beside

pytestmark = pytest.mark.usefixtures("interpreted")


@pytest.mark.parametrize("kind", [Ricker, AntisymmetricRicker])
def test_a_piece_ends_where_a_tail_has_begun(kind):
    wavelet = kind(1.0, 0.5, center=5.0)
    for ground, moved in ((NoMotion(), wavelet), (wavelet, Delayed(wavelet, 0.2))):
        (end,) = ends_beside(ground, moved)
        apart = abs(float(ground.acceleration(np.array(end)) - moved.acceleration(np.array(end))))
        assert 1e-13 < apart <= 1e-11
    # As a run begins it is late for that.
    assert ends_beside(NoMotion(), kind(1.0, 0.5, center=0.5)) == []


@pytest.mark.parametrize("motion", [Sine(2.0, 0.7), Cosine(1.0, 0.9), RECORD, Ricker(2.0, 0.8)])
def test_a_motion_later(motion):
    later = Delayed(motion, 0.3)
    t = np.linspace(-0.5, 3.0, 200)
    for name in ("acceleration", "velocity", "displacement"):
        assert np.array_equal(getattr(later, name)(t), getattr(motion, name)(t - 0.3))
    for piece, own in zip(later.pieces(), motion.pieces(), strict=True):
        assert piece.end == own.end + 0.3
    assert later.end == motion.end + 0.3


@pytest.mark.parametrize("delay", np.linspace(0.01, 1.3, 100))
def test_a_later_jump_is_where_its_piece_begins(delay):
    motion = Cosine(1.0, 0.9, start=0.1)
    later = Delayed(motion, delay)
    for piece, values in zip(later.pieces()[1:], ((0.0, 1.0), (1.0, 0.0)), strict=True):
        t = np.array([np.nextafter(piece.start, -np.inf), piece.start])
        np.testing.assert_allclose(later.acceleration(t), values, atol=1e-14)


def test_a_wavelet_has_begun_long_before():
    """Displacement from -inf: what `start` counts from is not where it was at rest."""
    ricker = Ricker(2.0, 0.8)
    t = np.linspace(-3.0, 4.0, 20001)
    d, v = travelled(ricker, t)
    step = t[1] - t[0]
    a = ricker.acceleration(t)
    summed = np.concatenate(([0.0], np.cumsum(0.5 * step * (a[1:] + a[:-1]))))
    assert np.abs(v - summed).max() < 1e-6
    assert abs(d[0]) < 1e-15
    assert np.abs(np.diff(d) / step - 0.5 * (v[1:] + v[:-1])).max() < 1e-6
