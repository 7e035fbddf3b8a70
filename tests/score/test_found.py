"""Impacts and extremes found in the rows of an answer."""

import numpy as np
import pytest

from eventpound import score
from eventpound.score.answer import turns
from eventpound.score.found import crests_of


@pytest.mark.parametrize("miss", [1e-3, 1e-6, 1e-9])
def test_a_near_miss_in_rows_is_no_impact(miss):
    """The reach of a step is 1e-6, more than some are missed by; the rows turn as a parabola."""
    t = np.linspace(0.0, 6.0, 6001)
    assert turns(t, 1.0 + miss + np.cos(t + 3.0), -np.sin(t + 3.0), 1.0) == []


@pytest.mark.parametrize("within", [0.0, 0.3, 0.5])
def test_an_impact_between_rows_is_one(within):
    """Where the gap is open in both of them, and in its middle, too, as Moreau's rule has it."""
    t = np.linspace(0.0, 2.0, 2001)
    late = t > 1.0
    gap = np.where(late, 0.5 * (t - 1.0), 1.0 - t) + within * 1e-3
    rates = np.where(late, 0.5, -1.0)
    ((at, before, after),) = turns(t, gap, rates, 1.0)
    assert at == pytest.approx(1.0, abs=1.1e-3)
    assert (before, after) == (-1.0, 0.5)


@pytest.mark.parametrize("rows", [9, 17, 33])
def test_extremes_are_those_of_the_cubics(rows):
    """Off by θ⁴/384 of the motion at most, θ the phase of a step; rows alone by θ²/8."""
    t = np.linspace(0.0, 6.0, rows)
    theta = 6.0 / (rows - 1)
    smooth = score.Motion(t, np.sin(t + 0.1)[:, None], np.cos(t + 0.1)[:, None])
    crests = crests_of(smooth, [])
    off = max(abs(crests.highest[0] - 1.0), abs(crests.lowest[0] + 1.0))
    assert 0.0 < off < theta**4 / 384.0
    assert off < crests.beyond[0] < theta**4 / 24.0
