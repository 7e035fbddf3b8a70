"""Which rests and detachments count as missed or extra, and by how much matched ones are late."""

from __future__ import annotations

import math

import numpy as np
import pytest

from eventpound.score.pairing import pair_events
from eventpound.solvers.base import Event, EventKind


def _rest(first, last=None, contact=0, end=EventKind.DETACHMENT):
    events = [Event(first, EventKind.REST, 0, contact)]
    return events if last is None else [*events, Event(last, end, 0, contact)]


def _errors(reference, found, covered=(-np.inf, np.inf)):
    in_time = [sorted(events, key=lambda event: event.t) for events in (reference, found)]
    return pair_events(*in_time, 1.0, ("rest", "detachment"), covered=covered)


def _counts(errors, kind):
    found = errors.of(kind)
    return found.matched, found.missed, found.extra


def test_shifts_and_those_without_a_partner():
    reference = _rest(1.0, 2.0) + _rest(5.0, 6.0) + _rest(9.0)
    found = _rest(1.01, 1.97) + _rest(9.002)
    errors = _errors(reference, found)
    assert _counts(errors, "rest") == (2, 1, 0)
    assert _counts(errors, "detachment") == (1, 1, 0)
    assert errors.of("rest").largest_shift == pytest.approx(0.01)
    assert errors.of("detachment").largest_shift == pytest.approx(0.03)
    assert [pair.t for pair in errors.pairs] == [1.0, 2.0, 5.0, 6.0, 9.0]


def test_a_rest_that_does_not_end_in_one_of_them():
    errors = _errors(_rest(1.0, 3.0), _rest(1.0))
    assert _counts(errors, "rest") == (1, 0, 0)
    assert _counts(errors, "detachment") == (0, 1, 0)
    assert math.isnan(errors.of("detachment").largest_shift)


def test_an_impulse_elsewhere_ends_a_rest_as_well():
    errors = _errors(_rest(1.0, 3.0, end=EventKind.SEPARATION), _rest(1.0, 3.1))
    assert _counts(errors, "detachment") == (1, 0, 0)


def test_contacts_are_not_mixed():
    errors = _errors(_rest(1.0, contact=0), _rest(1.0, contact=1))
    assert _counts(errors, "rest") == (0, 1, 1)


def test_short_ones_are_matched_but_not_missed():
    """Of 0.009 and 0.011 of T one is on either side of the hundredth that counts."""
    reference = _rest(1.0, 1.009) + _rest(5.0, 5.011)
    assert _counts(_errors(reference, []), "rest") == (0, 1, 0)
    assert _counts(_errors(reference, reference), "rest") == (2, 0, 0)
    assert _counts(_errors([], _rest(1.0, 1.0005)), "rest") == (0, 0, 0)


def test_only_the_time_both_cover():
    """A rest that goes on at the end of the stretch has no end in it."""
    errors = _errors(_rest(1.0, 3.0) + _rest(7.0, 8.0), _rest(1.0), covered=(0.0, 2.0))
    assert _counts(errors, "rest") == (1, 0, 0)
    assert _counts(errors, "detachment") == (0, 0, 0)
