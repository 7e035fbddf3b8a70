from __future__ import annotations

from eventpound.accuracy.sequences import SOFT, loudness, match_events
from eventpound.solvers.base import Event, EventKind


def _events(*rows: tuple) -> list[Event]:
    """Rows (t, kind, contact, closing speed), each a problem of its own."""
    return [Event(t, kind, i, contact, -speed) for i, (t, kind, contact, speed) in enumerate(rows)]


IMPACT, REST = EventKind.IMPACT, EventKind.REST
LIMIT, OPEN = EventKind.ACCUMULATION, EventKind.DETACHMENT


def test_same_rows_in_another_order_are_paired():
    ours = _events((1.0, IMPACT, 0, 1.0), (1.0, IMPACT, 1, 0.5), (2.0, IMPACT, 0, 0.3))
    theirs = _events((1.0, IMPACT, 1, 0.5), (1.0, IMPACT, 0, 1.0), (2.1, IMPACT, 0, 0.3))
    matching = match_events(ours, theirs, 2)
    assert matching.pairs == {0: 1, 1: 0, 2: 2}
    assert matching.parting is None
    assert not matching.touches


def test_tail_of_a_cascade_may_differ():
    tail = [(3.0 - 0.1**k, IMPACT, 0, 0.1**k) for k in range(12)]
    end = [(3.0, LIMIT, 0, 1e-15), (3.0, REST, 0, 0.0), (4.0, OPEN, 0, 0.0), (5.0, IMPACT, 0, 0.7)]
    ours, theirs = _events(*tail[:9], *end), _events(*tail, *end)
    matching = match_events(ours, theirs, 1)
    loud = sum(0.1**k > SOFT for k in range(9))
    assert matching.pairs == {k: k for k in range(loud)} | {9 + k: 12 + k for k in range(4)}
    assert matching.parting is None
    assert not matching.touches


def test_soft_impact_outside_a_cascade_is_a_touch():
    ours = _events((1.0, IMPACT, 0, 1.0), (2.0, IMPACT, 0, 1e-8), (3.0, IMPACT, 0, 0.5))
    matching = match_events(ours, [ours[0], ours[2]], 1)
    assert matching.pairs == {0: 0, 2: 1}
    assert matching.touches
    assert matching.parting is None


def test_first_difference_is_named_and_the_rest_taken_up_again():
    ours = _events(
        (1.0, IMPACT, 0, 1.0), (2.0, IMPACT, 0, 0.5), (2.0, REST, 0, 0.0), (3.0, OPEN, 0, 0.0),
        (9.0, REST, 0, 0.0),
    )  # fmt: skip
    theirs = _events((1.0, IMPACT, 0, 1.0), (9.0, REST, 0, 0.0))
    matching = match_events(ours, theirs, 1)
    assert matching.pairs == {0: 0, 4: 1}
    parting = matching.parting
    assert parting is not None
    assert (parting.t, parting.found, parting.instead) == (2.0, "impact", "nothing")


def test_a_resting_contact_is_as_loud_as_the_impact_it_takes_part_in():
    rows = [Event(1.0, IMPACT, 0, 0, -0.5), Event(1.0, IMPACT, 0, 1, 0.0)]
    assert loudness(rows).tolist() == [0.5, 0.5]


def test_a_closed_contact_that_passes_on_soft_impacts_need_not_be_in_both_runs():
    rest = Event(1.0, EventKind.REST, 5, 0)
    passed_on = Event(1.0, EventKind.ACCUMULATION, 6, 0, 0.0, 0.0, 1e-16)
    release = Event(2.0, EventKind.DETACHMENT, 7, 0)
    matching = match_events([rest, passed_on, release], [rest, release], 1)
    assert matching.parting is None
    assert matching.pairs == {0: 0, 2: 1}


def test_every_contact_that_parts_is_told_the_first_one_first():
    ours = [Event(2.0, EventKind.REST, 0, 0), Event(1.0, EventKind.REST, 1, 2)]
    matching = match_events(ours, [], 3)
    assert matching.parted == (2, 0)
    assert matching.parting is not None
    assert matching.parting.contact == 2


def test_a_contact_that_opens_for_no_time_has_not_opened():
    """Forces that vanish together: who is released is decided by rounding, and taken back."""
    rest, end = Event(0.0, EventKind.REST, 0, 0), Event(2.0, EventKind.DETACHMENT, 9, 0)
    brief = [Event(1.0, EventKind.DETACHMENT, 1, 0), Event(1.0 + 2e-16, EventKind.REST, 2, 0)]
    matching = match_events([rest, *brief, end], [rest, end], 1)
    assert matching.parting is None
    assert matching.pairs == {0: 0, 3: 1}
    longer = [brief[0], Event(1.0 + 1e-9, EventKind.REST, 2, 0)]
    assert match_events([rest, *longer, end], [rest, end], 1).parting is not None
    struck = [brief[0], Event(1.0, IMPACT, 3, 0, -0.1), brief[1]]
    assert match_events([rest, *struck, end], [rest, end], 1).parting is not None


def test_a_rest_after_a_vibration_that_died_away_need_not_be_in_both_runs():
    """Impacts too soft to be listed, then a rest: open, as in the run that does not see it."""
    opened, struck = Event(1.0, OPEN, 0, 0), Event(5.0, IMPACT, 9, 0, -0.1)
    died = [Event(3.0, LIMIT, 1, 0, -1e-16, count=25), Event(3.0, REST, 2, 0)]
    for again in ([], [Event(4.0, OPEN, 3, 0)]):
        ours = [opened, *died, *again, struck]
        matching = match_events(ours, [opened, struck], 1)
        assert matching.parting is None
        assert matching.pairs == {0: 0, len(ours) - 1: 1}
    listed = [opened, Event(2.0, IMPACT, 4, 0, -1e-3), *died, struck]
    assert match_events(listed, [opened, listed[1], struck], 1).parting is not None


def test_a_vibration_that_dies_away_never_rests():
    """Impacts at even intervals get softer for ever; where they accumulate, intervals shrink."""
    beats = [(1.0 + k, IMPACT, 0, 0.1**k) for k in range(8)]
    longer = _events(*beats, *((9.0 + k, IMPACT, 0, 0.1 ** (8 + k)) for k in range(30)))
    rests = [
        Event(8.0 + 25.0, LIMIT, 90, 0, -1e-16, count=25),
        Event(8.0 + 25.0, REST, 91, 0),
        Event(60.0, OPEN, 92, 0),
    ]
    assert match_events([*longer[:8], *rests], longer, 1).parting is None
    accumulated = [Event(8.0 + 1.0, LIMIT, 90, 0, -1e-16, count=25), *rests[1:]]
    assert match_events([*longer[:8], *accumulated], longer, 1).parting is not None


def test_rests_after_soft_impacts_need_not_be_in_both_runs():
    """A body vibrates and rests by turns, ever softer: which rest is the last is rounding's."""
    hit = (1.0, IMPACT, 0, 1.0)

    def turns(first: int, last: int) -> list[tuple]:
        each = ((t, 10.0 ** (-0.5 * t)) for t in range(first, last))
        return [
            row
            for t, speed in each
            for row in (
                (t, IMPACT, 0, speed),
                (t, REST, 0, 0.0),
                (t + 0.5, OPEN, 0, 0.0),
            )
        ]

    few, many = _events(hit, *turns(2, 16)), _events(hit, *turns(2, 19))
    assert match_events(few, many, 1).parting is None
    # Impacts of 1e-3 are events in either run.
    assert match_events(_events(hit, *turns(2, 6)), many, 1).parting is not None


def test_where_a_collapse_is_cut_off_is_no_event():
    """The last of many impacts in no time may be that of either contact, if neither rests."""
    row = [(1.0, IMPACT, 0, 1.0), (1.0, IMPACT, 0, 1e-8)]
    later = [(2.0, IMPACT, 0, 0.5), (3.0, LIMIT, 0, 1e-15), (3.0, REST, 0, 0.0)]
    cut = _events(*row, (1.0, LIMIT, 0, 1e-11), *later)
    assert match_events(cut, _events(*row, *later), 1).parting is None
