"""Pairing of event times: by hand, and against SciPy's assignment."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment

from eventpound.accuracy.matching import match


def _pairs(reference, found, window=1.0):
    return match(np.array(reference), np.array(found), window)


def test_one_too_many_shifts_nothing():
    matching = _pairs([1.0, 2.0, 3.0, 4.0], [1.01, 1.6, 2.01, 3.01, 4.01])
    assert matching.pairs.tolist() == [[0, 0], [1, 2], [2, 3], [3, 4]]
    assert matching.extra.tolist() == [1]
    assert matching.missed.size == 0


def test_one_missing():
    matching = _pairs([1.0, 2.0, 3.0], [1.1, 3.1])
    assert matching.pairs.tolist() == [[0, 0], [2, 1]]
    assert matching.missed.tolist() == [1]


def test_all_shifted_alike_keep_their_order():
    """Every assignment costs the same here; only one of them keeps the order."""
    times = np.array([1.0, 1.1, 1.2])
    assert match(times, times + 0.3, 1.0).pairs.tolist() == [[0, 0], [1, 1], [2, 2]]


def test_too_far_apart():
    matching = _pairs([1.0, 5.0], [2.5, 5.2])
    assert matching.pairs.tolist() == [[1, 1]]
    assert matching.missed.tolist() == [0]
    assert matching.extra.tolist() == [0]


@pytest.mark.parametrize(("reference", "found"), [([], []), ([1.0], []), ([], [1.0])])
def test_nothing_to_pair(reference, found):
    matching = _pairs(reference, found)
    assert matching.pairs.shape == (0, 2)
    assert matching.missed.size == len(reference)
    assert matching.extra.size == len(found)


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
    matching = match(reference, found, window)
    i, j = matching.pairs.T
    alone = matching.missed.size + matching.extra.size
    mine = np.abs(reference[i] - found[j]).sum() + alone * window / 2.0
    assert mine == pytest.approx(cost[rows, columns].sum(), abs=1e-12)
    assert np.all(np.diff(matching.pairs, axis=0) > 0)
    assert i.size + matching.missed.size == n
    assert j.size + matching.extra.size == m
