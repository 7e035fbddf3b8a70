"""Where a rate given by its Taylor coefficients vanishes, against the roots of the polynomial."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from eventpound.numerics.polynomial import root_work
from eventpound.solvers.fast.extremes import turning_times

pytestmark = pytest.mark.usefixtures("interpreted")


@pytest.mark.parametrize("bend", [0.1, 1.0, 30.0])
@pytest.mark.parametrize("seed", range(10))
def test_turns_are_the_roots_of_the_rate(seed, bend):
    """With little bend the rate goes one way and has one root at most; with much it has several."""
    rng = np.random.default_rng(seed)
    c = rng.normal(size=9) * np.array([0.4, 1.0] + [bend] * 7)
    roots = Polynomial(c).roots()
    real = np.sort(roots.real[np.abs(roots.imag) < 1e-12])
    expected = real[(real > 0.0) & (real < 1.0)]
    turns = np.zeros(40)
    found = turning_times(c.copy(), c.size, 1.0, turns, root_work(c.size))
    assert found == expected.size
    # Both err by the rounding of the value over the slope at the root.
    for turn, root in zip(turns[:found], expected, strict=True):
        rounding = 1e-15 * np.abs(c * root ** np.arange(c.size)).sum()
        assert abs(turn - root) <= 40.0 * rounding / abs(Polynomial(c).deriv()(root)) + 1e-15
