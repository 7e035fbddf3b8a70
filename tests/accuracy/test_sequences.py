import math
from typing import NamedTuple

from eventpound.accuracy.sequences import (
    KINDS,
    first_parting,
    instead_of,
    loudness,
    touches,
    weights_for,
)
from eventpound.score.levels import UNIT_OF_TIME
from eventpound.score.pairing import pair_events
from eventpound.solvers.base import Event, EventKind


class _Matching(NamedTuple):
    pairs: dict[int, int]
    parting: tuple[float, int, str, str] | None
    parted: tuple[int, ...]
    touches: bool


def _matched(ours: list[Event], theirs: list[Event]) -> _Matching:
    """Rows of both in runs of 100 s; time, contact and kinds of the first parting."""
    paired = pair_events(ours, theirs, 100.0 * UNIT_OF_TIME, KINDS, weights=weights_for())
    one, other = ({id(event): row for row, event in enumerate(side)} for side in (ours, theirs))
    both = [pair for pair in paired.pairs if not math.isnan(pair.shift)]
    first = first_parting(paired)
    pair = next(iter(first.values()), None)
    return _Matching(
        {one[id(pair.reference)]: other[id(pair.found)] for pair in both},
        pair and (pair.t, pair.contact, pair.kind, instead_of(pair, paired)),
        tuple(first),
        touches(paired, ours, theirs),
    )


def _events(*rows: tuple) -> list[Event]:
    """Rows (t, kind, contact, closing speed), each a problem of its own."""
    return [Event(t, kind, i, contact, -speed) for i, (t, kind, contact, speed) in enumerate(rows)]


IMPACT, REST = EventKind.IMPACT, EventKind.REST
LIMIT, OPEN = EventKind.ACCUMULATION, EventKind.DETACHMENT


def test_same_rows_in_another_order_are_paired():
    ours = _events((1.0, IMPACT, 0, 1.0), (1.0, IMPACT, 1, 0.5), (2.0, IMPACT, 0, 0.3))
    theirs = _events((1.0, IMPACT, 1, 0.5), (1.0, IMPACT, 0, 1.0), (2.1, IMPACT, 0, 0.3))
    matching = _matched(ours, theirs)
    assert matching.pairs == {0: 1, 1: 0, 2: 2}
    assert matching.parting is None
    assert not matching.touches


def test_tail_of_a_cascade_may_differ():
    tail = [(3.0 - 0.1**k, IMPACT, 0, 0.1**k) for k in range(12)]
    end = [(3.0, LIMIT, 0, 1e-15), (3.0, REST, 0, 0.0), (4.0, OPEN, 0, 0.0), (5.0, IMPACT, 0, 0.7)]
    ours, theirs = _events(*tail[:9], *end), _events(*tail, *end)
    matching = _matched(ours, theirs)
    assert matching.pairs == {k: k for k in range(9)} | {9 + k: 12 + k for k in range(4)}
    assert matching.parting is None
    assert not matching.touches


def test_soft_impact_outside_a_cascade_is_a_touch():
    ours = _events((1.0, IMPACT, 0, 1.0), (2.0, IMPACT, 0, 1e-8), (3.0, IMPACT, 0, 0.5))
    matching = _matched(ours, [ours[0], ours[2]])
    assert matching.pairs == {0: 0, 2: 1}
    assert matching.touches
    assert matching.parting is None


def test_first_difference_is_named_and_the_rest_taken_up_again():
    ours = _events(
        (1.0, IMPACT, 0, 1.0), (2.0, IMPACT, 0, 0.5), (2.0, REST, 0, 0.0), (3.0, OPEN, 0, 0.0),
        (9.0, REST, 0, 0.0),
    )  # fmt: skip
    theirs = _events((1.0, IMPACT, 0, 1.0), (9.0, REST, 0, 0.0))
    matching = _matched(ours, theirs)
    assert matching.pairs == {0: 0, 4: 1}
    assert matching.parting == (2.0, 0, "impact", "nothing")


def test_runs_part_where_one_lacks_an_impact_that_it_has_more_much_later():
    """Paired one after the other, all between the two would be the next one's."""
    beats = [(float(t), IMPACT, 0, 1.0) for t in range(1, 91)]
    ours, theirs = _events(*beats[:9], *beats[10:]), _events(*beats[:79], *beats[80:])
    assert _matched(ours, theirs).parting == (10.0, 0, "impact", "nothing")


def test_a_resting_contact_is_as_loud_as_the_impact_it_takes_part_in():
    rows = [Event(1.0, IMPACT, 0, 0, -0.5), Event(1.0, IMPACT, 0, 1, 0.0)]
    assert loudness(rows).tolist() == [0.5, 0.5]


def test_a_closed_contact_that_passes_on_soft_impacts_need_not_be_in_both_runs():
    rest = Event(1.0, EventKind.REST, 5, 0)
    passed_on = Event(1.0, EventKind.ACCUMULATION, 6, 0, 0.0, 0.0, 1e-16)
    release = Event(2.0, EventKind.DETACHMENT, 7, 0)
    matching = _matched([rest, passed_on, release], [rest, release])
    assert matching.parting is None
    assert matching.pairs == {0: 0, 2: 1}


def test_every_contact_that_parts_is_told_the_first_one_first():
    ours = [Event(2.0, EventKind.REST, 0, 0), Event(1.0, EventKind.REST, 1, 2)]
    matching = _matched(ours, [])
    assert matching.parted == (2, 0)
    assert matching.parting == (1.0, 2, "rest", "nothing")


def test_a_contact_that_opens_for_no_time_has_not_opened():
    """Forces that vanish together: who is released is decided by rounding, and taken back."""
    rest, end = Event(0.0, EventKind.REST, 0, 0), Event(2.0, EventKind.DETACHMENT, 9, 0)
    brief = [Event(1.0, EventKind.DETACHMENT, 1, 0), Event(1.0 + 2e-16, EventKind.REST, 2, 0)]
    matching = _matched([rest, *brief, end], [rest, end])
    assert matching.parting is None
    assert matching.pairs == {0: 0, 3: 1}
    longer = [brief[0], Event(1.0 + 1e-9, EventKind.REST, 2, 0)]
    assert _matched([rest, *longer, end], [rest, end]).parting is not None
    struck = [brief[0], Event(1.0, IMPACT, 3, 0, -0.1), brief[1]]
    assert _matched([rest, *struck, end], [rest, end]).parting is not None


def test_a_rest_after_a_vibration_that_died_away_need_not_be_in_both_runs():
    """Impacts too soft to be listed, then a rest: open, as in the run that does not see it."""
    opened, struck = Event(1.0, OPEN, 0, 0), Event(5.0, IMPACT, 9, 0, -0.1)
    died = [Event(3.0, LIMIT, 1, 0, -1e-16, count=25), Event(3.0, REST, 2, 0)]
    for again in ([], [Event(4.0, OPEN, 3, 0)]):
        ours = [opened, *died, *again, struck]
        matching = _matched(ours, [opened, struck])
        assert matching.parting is None
        assert matching.pairs == {0: 0, len(ours) - 1: 1}
    listed = [opened, Event(2.0, IMPACT, 4, 0, -1e-3), *died, struck]
    assert _matched(listed, [opened, listed[1], struck]).parting is not None


def test_a_vibration_that_dies_away_never_rests():
    """Impacts at even intervals get softer for ever; where they accumulate, intervals shrink."""
    beats = [(1.0 + k, IMPACT, 0, 0.1**k) for k in range(8)]
    longer = _events(*beats, *((9.0 + k, IMPACT, 0, 0.1 ** (8 + k)) for k in range(30)))
    rests = [
        Event(8.0 + 25.0, LIMIT, 90, 0, -1e-16, count=25),
        Event(8.0 + 25.0, REST, 91, 0),
        Event(60.0, OPEN, 92, 0),
    ]
    assert _matched([*longer[:8], *rests], longer).parting is None
    accumulated = [Event(8.0 + 1.0, LIMIT, 90, 0, -1e-16, count=25), *rests[1:]]
    assert _matched([*longer[:8], *accumulated], longer).parting is not None


def test_rests_after_soft_impacts_need_not_be_in_both_runs():
    """A body vibrates and rests by turns, ever softer: which rest is the last is rounding's."""
    hit = (1.0, IMPACT, 0, 1.0)

    def turns(first: int, last: int) -> list[tuple]:
        each = ((t, 10.0 ** (-0.5 * t)) for t in range(first, last))
        return [
            row
            for t, speed in each
            for row in ((t, IMPACT, 0, speed), (t, REST, 0, 0.0), (t + 0.5, OPEN, 0, 0.0))
        ]

    few, many = _events(hit, *turns(2, 16)), _events(hit, *turns(2, 19))
    assert _matched(few, many).parting is None
    # Impacts of 1e-3 are events in either run.
    assert _matched(_events(hit, *turns(2, 6)), many).parting is not None


def test_where_a_collapse_is_cut_off_is_no_event():
    """The last of many impacts in no time may be that of either contact, if neither rests."""
    row = [(1.0, IMPACT, 0, 1.0), (1.0, IMPACT, 0, 1e-8)]
    later = [(2.0, IMPACT, 0, 0.5), (3.0, LIMIT, 0, 1e-15), (3.0, REST, 0, 0.0)]
    cut = _events(*row, (1.0, LIMIT, 0, 1e-11), *later)
    assert _matched(cut, _events(*row, *later)).parting is None


def test_a_slight_event_takes_no_partner_from_one_that_counts():
    """The limit of a cascade comes a little later; soft impacts pass through beside it."""
    ours = _events((1.0, IMPACT, 0, 1.0), (2.0, LIMIT, 0, 1e-15), (2.0, REST, 0, 0.0))
    passed_on = Event(2.2, LIMIT, 9, 0, 0.0)
    theirs = _events((1.0, IMPACT, 0, 1.0), (2.3, LIMIT, 0, 1e-15), (2.3, REST, 0, 0.0))
    matching = _matched([*ours, passed_on], theirs)
    assert matching.parting is None
    assert matching.pairs == {0: 0, 1: 1, 2: 2}
    soft = _events((1.0, IMPACT, 0, 1.0), (3.0, IMPACT, 0, 1e-8), (3.2, IMPACT, 0, 0.5))
    late = _events((1.0, IMPACT, 0, 1.0), (3.1, IMPACT, 0, 0.5))
    assert _matched(soft, late).pairs == {0: 0, 2: 1}
