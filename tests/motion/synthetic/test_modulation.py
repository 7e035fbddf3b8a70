"""The modulating function has the intensity, duration and middle asked for, by quadrature."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from eventpound.errors import InputError
from eventpound.motion.synthetic.filtered_noise import Modulation, modulation_of
from eventpound.units import STANDARD_GRAVITY

CASES = [(0.5, 12.0, 8.0), (0.02, 5.0, 12.0), (3.0, 40.0, 9.0)]


def intensity(modulation: Modulation, end: float) -> float:
    """Expected Arias intensity up to a time (m/s), by quadrature."""
    area, _ = quad(lambda t: float(modulation(np.array(t))) ** 2, 0.0, end, epsrel=1e-12, limit=500)
    return math.pi / (2.0 * STANDARD_GRAVITY) * area


@pytest.mark.parametrize(("arias", "duration", "middle"), CASES)
def test_intensity_duration_and_middle(arias, duration, middle):
    modulation = modulation_of(arias, duration, middle)
    start = middle - duration
    t_5 = modulation.time_of(0.05)
    assert t_5 > max(start, 0.0)
    # Beyond the time of the share 1 - 1e-13 less than that is missing.
    total = intensity(modulation, modulation.time_of(1.0 - 1e-13))
    assert total == pytest.approx(arias, rel=1e-9)
    assert intensity(modulation, t_5) == pytest.approx(0.05 * arias, rel=1e-9)
    assert intensity(modulation, middle) == pytest.approx(0.45 * arias, rel=1e-9)
    assert intensity(modulation, t_5 + duration) == pytest.approx(0.95 * arias, rel=1e-9)


def test_begins_at_zero_and_has_one_peak():
    modulation = modulation_of(0.5, 12.0, 8.0)
    peak = (modulation.alpha_2 - 1.0) / modulation.alpha_3
    t = np.array([0.0, 0.999 * peak, peak, 1.001 * peak])
    q = modulation(t)
    assert q[0] == 0.0
    assert q[2] > max(q[1], q[3])


def test_a_duration_too_long_for_its_middle_is_refused():
    with pytest.raises(InputError, match=r"D_5-95 = 40.0 s with t_mid = 8.0 s; accepted: a ratio"):
        modulation_of(1.0, 40.0, 8.0)
