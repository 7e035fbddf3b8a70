import numpy as np
import pytest

from eventpound.accuracy.bound import SAFETY
from eventpound.accuracy.conditioning import LARGE
from eventpound.accuracy.digits import LOST, WINDOWS, digits_over_time


def test_digits_fall_with_a_growing_error():
    """Errors 1e-12 e^t and changes 1e-10 e^t of a motion of size 2."""
    t = np.linspace(1.0, 11.0, 1001)
    still = np.full((t.size, 1), 2.0)
    error = 1e-12 * np.exp(t)
    found = digits_over_time(
        t,
        still,
        still + error[:, np.newaxis],
        [still + 3.0 * error[:, np.newaxis], still - 1.0],
        LARGE * np.exp(t),
        1.0,
    )
    assert found.t.size == found.digits.size == found.amplification.size == WINDOWS
    assert (found.start, found.t[-1]) == (1.0, 11.0)
    # S times the own difference exceeds the nearest distance; 2 is rounded to 1e-8 of it.
    assert found.digits[-1] == pytest.approx(-np.log10(SAFETY * error[-1] / 2.0), rel=1e-8)
    assert found.amplification[-1] == pytest.approx(np.exp(11.0) / 2.0, rel=1e-12)
    assert found.lost_from == pytest.approx(np.log(2.0 * LOST), abs=t[1] - t[0])


def test_a_steady_motion_loses_none():
    t = np.linspace(0.0, 1.0, 101)
    still = np.ones((t.size, 2))
    found = digits_over_time(t, still, still, [], np.zeros(t.size), 1.0)
    # Nothing tells more digits than a double has.
    assert np.all(found.digits == pytest.approx(-np.log10(np.finfo(float).eps)))
    assert found.lost_from is None
