"""Pairing of times, impacts and rests: by hand, and against SciPy's assignment."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment

from eventpound.score.pairing import pair_events, pair_times
from eventpound.solvers.base import Event, EventKind


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


def _impact(t, speed=1.0, contact=0):
    return Event(t, EventKind.IMPACT, 0, contact, -speed, 0.5 * speed)


def of_impacts(reference, found, covered=(-np.inf, np.inf)):
    return pair_events(tuple(reference), tuple(found), 0.5, speed=1.0, covered=covered)


def test_impacts_and_those_without_a_partner():
    errors = of_impacts(
        [_impact(1.0), _impact(2.0), _impact(3.0)], [_impact(1.01), _impact(2.98), _impact(9.0)]
    )
    assert (errors.matched, errors.missed, errors.extra) == (2, 1, 1)
    assert errors.largest_shift == 0.020000000000000018
    assert [pair.t for pair in errors.listed] == [1.0, 2.0, 3.0, 9.0]


def test_impacts_of_contacts_are_not_mixed():
    errors = of_impacts([_impact(1.0, contact=0)], [_impact(1.0, contact=1)])
    assert (errors.matched, errors.missed, errors.extra) == (0, 1, 1)
    assert math.isnan(errors.largest_shift)


def test_slow_impacts_are_paired_but_not_missed():
    """Of 1, 0.011 and 0.009 the slower two are on either side of the hundredth that counts."""
    reference = [_impact(1.0), _impact(2.0, 0.011), _impact(3.0, 0.009)]
    assert of_impacts(reference, [_impact(1.0)]).missed == 1
    # A run in which the speeds lie on the other sides has them all.
    errors = of_impacts(reference, [_impact(1.0), _impact(2.0, 0.009), _impact(3.0, 0.011)])
    assert (errors.matched, errors.missed, errors.extra) == (3, 0, 0)


def test_an_accumulation_followed_for_longer_is_no_error():
    """Impacts at 1 - 2^-k with speeds 2^-k: one run stops below a thousandth, one goes on."""
    long = [_impact(1.0 - 2.0**-k, 2.0**-k) for k in range(40)]
    errors = of_impacts(long, long[:10])
    assert (errors.matched, errors.missed, errors.extra) == (10, 0, 0)


def test_events_other_than_impacts_are_left_out():
    rest = Event(2.0, EventKind.REST, 1, 0)
    errors = of_impacts([_impact(1.0), rest], [_impact(1.0)])
    assert (errors.matched, errors.missed) == (1, 0)


def test_impacts_in_the_time_that_both_cover():
    errors = of_impacts([_impact(1.0), _impact(2.0)], [_impact(1.0)], covered=(0.0, 1.5))
    assert (errors.matched, errors.missed) == (1, 0)


def test_a_speed_that_is_not_known_counts():
    unknown = Event(5.0, EventKind.IMPACT, 0, 0, math.nan, math.nan)
    assert of_impacts([_impact(1.0)], [_impact(1.0), unknown]).extra == 1


def test_extra_impacts_where_the_reference_has_none():
    """They are held against the speed of the scene, here 1 m/s."""
    assert of_impacts([], [_impact(1.0, 0.02), _impact(2.0, 0.005)]).extra == 1


def _rest(first, last=None, contact=0, end=EventKind.DETACHMENT):
    events = [Event(first, EventKind.REST, 0, contact)]
    return events if last is None else [*events, Event(last, end, 0, contact)]


def of_rests(reference, found, covered=(-np.inf, np.inf)):
    in_time = [sorted(events, key=lambda event: event.t) for events in (reference, found)]
    return pair_events(*in_time, 1.0, ("rest", "detachment"), covered=covered)


def _counts(errors, kind):
    found = errors.of(kind)
    return found.matched, found.missed, found.extra


def test_rests_and_those_without_a_partner():
    reference = _rest(1.0, 2.0) + _rest(5.0, 6.0) + _rest(9.0)
    found = _rest(1.01, 1.97) + _rest(9.002)
    errors = of_rests(reference, found)
    assert _counts(errors, "rest") == (2, 1, 0)
    assert _counts(errors, "detachment") == (1, 1, 0)
    assert errors.of("rest").largest_shift == pytest.approx(0.01)
    assert errors.of("detachment").largest_shift == pytest.approx(0.03)
    assert [pair.t for pair in errors.pairs] == [1.0, 2.0, 5.0, 6.0, 9.0]


def test_a_rest_that_does_not_end_in_one_of_them():
    errors = of_rests(_rest(1.0, 3.0), _rest(1.0))
    assert _counts(errors, "rest") == (1, 0, 0)
    assert _counts(errors, "detachment") == (0, 1, 0)
    assert math.isnan(errors.of("detachment").largest_shift)


def test_an_impulse_elsewhere_ends_a_rest_as_well():
    errors = of_rests(_rest(1.0, 3.0, end=EventKind.SEPARATION), _rest(1.0, 3.1))
    assert _counts(errors, "detachment") == (1, 0, 0)


def test_rests_of_contacts_are_not_mixed():
    errors = of_rests(_rest(1.0, contact=0), _rest(1.0, contact=1))
    assert _counts(errors, "rest") == (0, 1, 1)


def test_short_rests_are_matched_but_not_missed():
    """Of 0.009 and 0.011 of T one is on either side of the hundredth that counts."""
    reference = _rest(1.0, 1.009) + _rest(5.0, 5.011)
    assert _counts(of_rests(reference, []), "rest") == (0, 1, 0)
    assert _counts(of_rests(reference, reference), "rest") == (2, 0, 0)
    assert _counts(of_rests([], _rest(1.0, 1.0005)), "rest") == (0, 0, 0)


def test_rests_in_the_time_that_both_cover():
    """A rest that goes on at the end of the stretch has no end in it."""
    errors = of_rests(_rest(1.0, 3.0) + _rest(7.0, 8.0), _rest(1.0), covered=(0.0, 2.0))
    assert _counts(errors, "rest") == (1, 0, 0)
    assert _counts(errors, "detachment") == (0, 0, 0)
