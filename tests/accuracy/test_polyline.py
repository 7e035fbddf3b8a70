"""The distance of one polyline's vertices from another, against all pairs of them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from eventpound.numerics.arrays import Floats
from eventpound.score.difference import furthest_vertex

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
