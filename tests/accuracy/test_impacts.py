"""Which impacts count as missed or extra, and by how much matched ones are late."""

from __future__ import annotations

import math

import numpy as np

from eventpound.score.pairing import pair_events
from eventpound.solvers.base import Event, EventKind


def _impact(t, speed=1.0, contact=0):
    return Event(t, EventKind.IMPACT, 0, contact, -speed, 0.5 * speed)


def _errors(reference, found, covered=(-np.inf, np.inf)):
    return pair_events(tuple(reference), tuple(found), 0.5, speed=1.0, covered=covered)


def test_shifts_and_those_without_a_partner():
    errors = _errors(
        [_impact(1.0), _impact(2.0), _impact(3.0)], [_impact(1.01), _impact(2.98), _impact(9.0)]
    )
    assert (errors.matched, errors.missed, errors.extra) == (2, 1, 1)
    assert errors.largest_shift == 0.020000000000000018
    assert [pair.t for pair in errors.listed] == [1.0, 2.0, 3.0, 9.0]


def test_contacts_are_not_mixed():
    errors = _errors([_impact(1.0, contact=0)], [_impact(1.0, contact=1)])
    assert (errors.matched, errors.missed, errors.extra) == (0, 1, 1)
    assert math.isnan(errors.largest_shift)


def test_slow_ones_are_paired_but_not_missed():
    """Of 1, 0.011 and 0.009 the slower two are on either side of the hundredth that counts."""
    reference = [_impact(1.0), _impact(2.0, 0.011), _impact(3.0, 0.009)]
    assert _errors(reference, [_impact(1.0)]).missed == 1
    # A run in which the speeds lie on the other sides has them all.
    errors = _errors(reference, [_impact(1.0), _impact(2.0, 0.009), _impact(3.0, 0.011)])
    assert (errors.matched, errors.missed, errors.extra) == (3, 0, 0)


def test_an_accumulation_followed_for_longer_is_no_error():
    """Impacts at 1 - 2^-k with speeds 2^-k: one run stops below a thousandth, one goes on."""
    long = [_impact(1.0 - 2.0**-k, 2.0**-k) for k in range(40)]
    errors = _errors(long, long[:10])
    assert (errors.matched, errors.missed, errors.extra) == (10, 0, 0)


def test_other_events_are_left_out():
    rest = Event(2.0, EventKind.REST, 1, 0)
    errors = _errors([_impact(1.0), rest], [_impact(1.0)])
    assert (errors.matched, errors.missed) == (1, 0)


def test_only_the_time_both_cover():
    errors = _errors([_impact(1.0), _impact(2.0)], [_impact(1.0)], covered=(0.0, 1.5))
    assert (errors.matched, errors.missed) == (1, 0)


def test_a_speed_that_is_not_known_counts():
    unknown = Event(5.0, EventKind.IMPACT, 0, 0, math.nan, math.nan)
    assert _errors([_impact(1.0)], [_impact(1.0), unknown]).extra == 1


def test_extra_impacts_where_the_reference_has_none():
    """They are held against the speed of the scene, here 1 m/s."""
    assert _errors([], [_impact(1.0, 0.02), _impact(2.0, 0.005)]).extra == 1
