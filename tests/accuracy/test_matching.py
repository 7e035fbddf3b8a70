"""Pairing of event times: by hand, and against SciPy's assignment."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment

from eventpound.score.pairing import pair_times


@pytest.mark.parametrize(
    ("reference", "found", "pairs"),
    [
        # One too many shifts nothing.
        ([1.0, 2.0, 3.0, 4.0], [1.01, 1.6, 2.01, 3.01, 4.01], [(0, 0), (1, 2), (2, 3), (3, 4)]),
        ([1.0, 2.0, 3.0], [1.1, 3.1], [(0, 0), (2, 1)]),
        # Every assignment costs the same here; only one of them keeps the order.
        ([1.0, 1.1, 1.2], [1.3, 1.4, 1.5], [(0, 0), (1, 1), (2, 2)]),
        # Too far apart, though they are the first of both.
        ([1.0, 5.0], [2.5, 5.2], [(1, 1)]),
        ([], [], []),
        ([1.0], [], []),
        ([], [1.0], []),
    ],
)
def test_pairs(reference, found, pairs):
    assert pair_times(np.array(reference), np.array(found), 1.0) == pairs


_TIMES = st.lists(st.floats(0.0, 6.0), max_size=9).map(lambda t: np.array(sorted(t)))


@settings(deadline=None)
@given(_TIMES, _TIMES)
def test_least_cost(reference, found):
    """A time may also be assigned to nothing, at half a window."""
    window = 1.0
    n, m = reference.size, found.size
    cost = np.full((n + m, n + m), window / 2.0)
    cost[n:, m:] = 0.0
    cost[:n, :m] = np.abs(reference[:, None] - found)
    rows, columns = linear_sum_assignment(cost)
    pairs = np.array(pair_times(reference, found, window), np.int64).reshape(-1, 2)
    i, j = pairs.T
    alone = n + m - 2 * len(pairs)
    mine = np.abs(reference[i] - found[j]).sum() + alone * window / 2.0
    assert mine == pytest.approx(cost[rows, columns].sum(), abs=1e-12)
    assert np.all(np.diff(pairs, axis=0) > 0)
