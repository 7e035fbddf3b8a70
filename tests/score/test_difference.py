"""Distances of motions against closed forms."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from eventpound.numerics.arrays import Floats
from eventpound.score.difference import MotionScales, distance, furthest_vertex, one_sided
from eventpound.solvers.base import History

NOTHING = np.empty(0)


def _history(t, u, v, z=None):
    """A history of which only the motion is filled in."""
    t = np.asarray(t, dtype=float)
    u, v = (np.asarray(x, dtype=float).reshape(t.size, -1) for x in (u, v))
    z = np.empty((t.size, 0)) if z is None else np.asarray(z, dtype=float).reshape(t.size, -1)
    return History(t, NOTHING, u, v, NOTHING, z, NOTHING, NOTHING, NOTHING)


def _scales(bodies=1, springs=0, time=1.0):
    return MotionScales(time, np.ones(bodies), np.ones(bodies), np.ones(springs))


def _bounce(at, speed=1.0):
    """Down with speed 1 until `at`, then up: the point before the bounce is (at, 1 - at)."""
    t = [0.0, at, at, 2.0]
    return t, [1.0, 1.0 - at, 1.0 - at, 1.0 - at + speed * (2.0 - at)], [-1.0, -1.0, speed, speed]


@pytest.mark.parametrize("late", [0.1, 1e-3, 1e-6, 1e-9])
def test_a_bounce_that_comes_later(late):
    """A barrier δ further down: u lags by 2 δ at the end, and the jump of v counts for nothing."""
    found = distance(_history(*_bounce(1.0)), _history(*_bounce(1.0 + late)), _scales())
    # Subtracting numbers near 1 leaves 2e-16.
    assert found.graph == pytest.approx(2.0 * late, abs=1e-15)
    assert found.sup == 2.0


@pytest.mark.parametrize("late", [0.1, 1e-3, 1e-6, 1e-9])
def test_a_jump_that_comes_later(late):
    """With u of no weight a jump of v is a vertical line, and two of them δ/T apart."""
    scales = MotionScales(10.0, np.array([1e30]), np.ones(1), np.empty(0))
    found = distance(_history(*_bounce(1.0)), _history(*_bounce(1.0 + late)), scales)
    assert found.graph == pytest.approx(late / 10.0, abs=1e-16)
    assert found.graph_time == pytest.approx(1.0, abs=2.0 * late)
    assert found.sup == 2.0


def test_a_jump_of_another_height():
    """v after the bounce is 0.8, not 1: the corner is 0.2 off, more than the rest near it."""
    late = distance(_history(*_bounce(1.0)), _history(*_bounce(1.0, 0.8)), _scales())
    assert late.graph >= 0.2
    # At the end u differs by 0.2 as well, so that the two components make √2 0.2 there.
    assert late.graph == pytest.approx(np.hypot(0.2, 0.2), rel=1e-12)


def test_two_bodies_whose_jumps_swap_places():
    """Body 1 jumps at 1 and body 2 at 1 + δ, or the reverse: far apart at no time but these."""
    late = 1e-4
    t = [0.0, 1.0, 1.0, 1.0 + late, 1.0 + late, 2.0]
    early, after = np.array([0, 0, 1, 1, 1, 1.0]), np.array([0, 0, 0, 0, 1, 1.0])
    still = np.zeros((6, 2))
    first = _history(t, still, np.column_stack((early, after)))
    second = _history(t, still, np.column_stack((after, early)))
    found = distance(first, second, _scales(2))
    assert found.graph == pytest.approx(late, rel=1e-9)
    assert found.sup == 1.0


def test_a_missed_jump_is_far():
    straight = _history([0.0, 1.0, 2.0], [1.0, 0.0, -1.0], [-1.0, -1.0, -1.0])
    found = distance(_history(*_bounce(1.0)), straight, _scales())
    # The last point (2, 1, 1) is nearest to (1, 0, -1) of the other.
    assert found.graph == pytest.approx(np.sqrt(6.0), rel=1e-12)


def test_symmetric_and_zero_for_the_same():
    a, b = _history(*_bounce(1.0)), _history(*_bounce(1.3, 0.5))
    assert distance(a, b, _scales()) == distance(b, a, _scales())
    same = distance(a, a, _scales())
    assert (same.graph, same.sup) == (0.0, 0.0)


def test_hysteresis_has_a_graph_of_its_own():
    t, still = [0.0, 1.0, 2.0], np.zeros(3)
    a, b = (_history(t, still, still, z) for z in ([0.0, 0.5, 0.0], [0.0, 0.6, 0.0]))
    found = distance(a, b, _scales(springs=1))
    # The peak (1, 0.6) is seen from the segment from (0, 0) to (1, 0.5), at its end.
    assert found.graph == pytest.approx(0.1, rel=1e-12)
    assert found.sup == pytest.approx(0.1, rel=1e-12)


def test_velocities_that_are_not_known_are_left_out():
    t, u, _ = _bounce(1.0)
    unknown = _history(t, u, [np.nan] * 4)
    assert distance(_history(*_bounce(1.0)), unknown, _scales()).sup == 0.0


def test_only_the_time_both_cover():
    t, u, v = _bounce(1.0)
    short = _history(t[:3], u[:3], v[:3])
    assert distance(_history(t, u, v), short, _scales()).graph == 0.0


def test_sides_of_a_jump():
    times, values = np.array([0.0, 1.0, 1.0, 2.0]), np.array([0.0, 1.0, 5.0, 7.0])
    t = np.array([-1.0, 0.0, 0.5, 1.0, 1.5, 2.0, 3.0])
    np.testing.assert_array_equal(
        one_sided(t, times, values, before=True), [0.0, 0.0, 0.5, 1.0, 6.0, 7.0, 7.0]
    )
    np.testing.assert_array_equal(
        one_sided(t, times, values, before=False), [0.0, 0.0, 0.5, 5.0, 6.0, 7.0, 7.0]
    )


pytestmark = pytest.mark.usefixtures("interpreted")


def _every_pair(points: Floats, curve: Floats) -> float:
    """The same by all points and all segments at once."""
    start, step = curve[:-1], np.diff(curve, axis=0)
    apart = points[:, None] - start
    length = (step**2).sum(axis=1)
    part = np.clip((apart * step).sum(axis=2) / np.where(length > 0.0, length, 1.0), 0.0, 1.0)
    distances = np.linalg.norm(apart - part[..., None] * step, axis=2)
    return float(distances.min(axis=1).max())


@st.composite
def _polylines(draw):
    count = draw(st.integers(2, 12))
    columns = draw(arrays(float, (count, 3), elements=st.integers(-8, 8).map(float)))
    columns[:, 0] = np.sort(columns[:, 0])
    return columns


@settings(deadline=None)
@given(_polylines(), _polylines())
def test_against_every_pair(points, curve):
    # Coordinates are small whole numbers: rounding is some units of 1e-15.
    assert furthest_vertex(points, curve)[0] == pytest.approx(_every_pair(points, curve), abs=1e-13)


def test_a_point_beside_a_segment_and_beyond_its_ends():
    curve = np.array([[0.0, 0.0], [2.0, 0.0]])
    for point, far in (([1.0, 3.0], 3.0), ([-4.0, 3.0], 5.0), ([5.0, 4.0], 5.0)):
        assert furthest_vertex(np.array([point]), curve) == (far, 0)


def test_a_curve_of_one_vertex():
    assert furthest_vertex(np.array([[3.0, 4.0]]), np.zeros((1, 2))) == (5.0, 0)
