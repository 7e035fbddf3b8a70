"""What runs leave out alike: ends of cascades, against their closed form."""

import pytest

from eventpound.accuracy.left_out import displaced, time_to_limits
from eventpound.motion.record import Record
from eventpound.scene import BARRIER, GROUND, Body, Contact, Linear, Scene, Spring
from eventpound.simulation import response_of
from eventpound.solvers.base import Event, EventKind
from eventpound.tolerances import EPS

E, SPEED = 0.8, 1e-3


def bounces(count: int, gravity: float = 9.81, soft: int = 1) -> list[Event]:
    """A ball dropped on a barrier, its impacts followed so far; the last `soft` as one row."""
    t, v, rows = 0.0, SPEED, []
    for _ in range(count):
        rows.append(Event(t, EventKind.IMPACT, len(rows), 0, -v, E * v, 1.0))
        v *= E
        t += 2.0 * v / gravity
    last = rows[-1]
    end = Event(last.t, EventKind.ACCUMULATION, last.group, 0, last.gap_velocity_before, count=soft)
    return [*rows[:-soft], end]


@pytest.mark.parametrize(("count", "soft"), [(2, 1), (30, 1), (30, 12)])
def test_the_limit_is_as_far_as_all_intervals_that_would_follow(count, soft):
    events = bounces(count, soft=soft)
    limit = 2.0 * E * SPEED / 9.81 / (1.0 - E)
    (later,) = time_to_limits(events).values()
    # A safety of two on what is missing.
    assert later == pytest.approx(2.0 * (limit - events[-1].t), rel=1e-9)


def test_an_end_without_impacts_before_it_has_no_limit():
    assert time_to_limits(bounces(1)) == {}


def test_bounces_of_a_run_end_before_their_limit_by_what_is_stated():
    """Pressed by a constant acceleration: the limit is known in closed form."""
    height, e, g = 0.3, 0.5, 2.0
    ball = Scene(
        (Body("b", 1.0),),
        (),
        (),
        (Contact("floor", "b", BARRIER, height, e),),
        Record([-g, -g], 4.0),
    )
    found = response_of(ball, "fast", 1e-12, duration=3.0).recording
    fall = (2.0 * height / g) ** 0.5
    limit = fall * (1.0 + 2.0 * e / (1.0 - e))
    (end,) = (event for event in found.events if event.kind is EventKind.ACCUMULATION)
    assert 0.0 <= limit - end.t < time_to_limits(found.events)[end.t] + 20 * EPS
    count = sum(e.count for e in found.events)
    assert displaced(found, ball) >= EPS * (found.work.steps + 4 * count)


def test_what_ends_in_one_instant_counts_with_what_is_taken_for_rounding():
    """A row between walls without play: its impacts of one instant go on to 1e-12 of the first."""
    names = "abc"
    ends = [BARRIER, *names, BARRIER]
    row = Scene(
        tuple(Body(name, 1.0, velocity=v) for name, v in zip(names, (1.0, 0.1, -1.0), strict=True)),
        (Spring("s", (GROUND, "a"), Linear(1.0)),),
        (),
        tuple(Contact(f"c{i}", *ends[i : i + 2], 0.0, 0.6) for i in range(4)),
    )
    found = response_of(row, "fast", duration=1.0).recording
    softest = max(e.gap_velocity_before for e in found.events if e.count > 1)
    assert 1e-13 < -softest < 1e-11
    assert displaced(found, row) > 1e-11
