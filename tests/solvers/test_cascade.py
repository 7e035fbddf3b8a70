"""When a cascade is over: without play, without loss, without an interval, without a speed."""

from types import SimpleNamespace

import numpy as np
import pytest

from eventpound.contact.cascade import (
    MOST_PROBLEMS,
    WINDOW,
    is_endless,
    is_plastic,
    last_speed,
    long_message,
)
from eventpound.contact.rest import is_none
from eventpound.errors import ComputationError
from eventpound.motion.pulses import Sine
from eventpound.scene import BARRIER, GROUND, BilinearElastic, Body, Contact, Linear, Scene, Spring
from eventpound.solvers import solver_named
from eventpound.solvers.base import Event, EventKind, Task
from eventpound.solvers.events.instant_loop import STEPS_AT_ONCE
from eventpound.solvers.events.short_series import first_closings, gap_series
from tests.properties.transforms import mirrored
from tests.solvers.accuracy import RTOL, allowed
from tests.solvers.random_scenes import random_scene
from tests.solvers.scenes import run


def _squeezed(eps: tuple[float, float], motion: Sine | None = None) -> Scene:
    """A body between two barriers that it touches."""
    return Scene(
        (Body("a", 2.0, 0.01, 0.3),),
        (Spring("k", (GROUND, "a"), Linear(5.0)),),
        contacts=(
            Contact("left wall", BARRIER, "a", -0.01, eps[0]),
            Contact("right wall", "a", BARRIER, 0.01, eps[1]),
        ),
        **({} if motion is None else {"motion": motion}),
    )


def test_no_play_and_no_loss_is_refused_at_once(solver):
    with pytest.raises(ComputationError, match="'left wall', 'right wall' leave no play") as error:
        run(_squeezed((1.0, 1.0)), RTOL, 1.0, solver=solver)
    recording = error.value.recording
    assert 0 < len(recording.events) <= WINDOW
    # Nothing has been lost, and nothing has moved.
    assert abs(recording.v[0]) == pytest.approx(0.3, rel=1e-12)
    assert recording.u[0] == pytest.approx(0.01, abs=1e-15)


@pytest.mark.parametrize("eps", [(1.0, 1.0 - 1e-6), (0.999, 0.999), (1.0, 0.0)])
def test_no_play_and_some_loss_comes_to_rest(solver, eps):
    # However little an impact loses, the limit of them all is the same: rest.
    recording = run(_squeezed(eps), RTOL, 1.0, solver=solver)
    np.testing.assert_array_equal(recording.v, 0.0)
    assert recording.u[0] == pytest.approx(0.01, abs=1e-15)
    assert len(recording.events) <= MOST_PROBLEMS + 10
    # Each problem may leave the two gap rates, -v and v, another rounding apart.
    energy = pytest.approx(0.09, rel=MOST_PROBLEMS**2 * np.finfo(float).eps)
    assert sum(e.energy_lost for e in recording.events) == energy
    # A speed of that rounding may be left, and a flight over as little.
    assert max(e.t for e in recording.events) < 1e-9


@pytest.mark.parametrize("eps", [(0.8, 0.0), (0.0, 0.8), (0.3, 0.5)])
def test_no_play_rests_on_both_sides(solver, eps):
    # A speed left by rounding would let it "fly" over gaps of 1e-18 m for ever.
    recording = run(_squeezed(eps, Sine(3.0, 0.5)), 1e-9, 2.0, solver=solver)
    rests = [e.contact for e in recording.events if e.kind is EventKind.REST]
    assert sorted(rests) == [0, 1]
    np.testing.assert_allclose(recording.resting_time, 2.0, rtol=0.0, atol=0.0)
    assert EventKind.DETACHMENT not in {e.kind for e in recording.events}


def test_a_push_that_ends_at_a_kink_parts_nobody(solver):
    # The spring pushes a into b as far as u = 0 and has no force beyond. λ vanishes with it
    # and stays zero: no order tells that they part, so they go on as one at u_0 ω.
    mass, k, u0 = 3.0, 12.0, -0.1
    scene = Scene(
        (Body("a", 1.0, u0), Body("b", 2.0, u0)),
        (Spring("buffer", (GROUND, "a"), BilinearElastic(k, 0.0)),),
        contacts=(Contact("joint", "a", "b", 0.0, 0.5),),
    )
    recording = run(scene, RTOL, 3.0, solver=solver)
    assert [e.kind for e in recording.events] == [EventKind.REST]
    omega = np.sqrt(k / mass)
    np.testing.assert_allclose(recording.v, -u0 * omega, rtol=allowed(1.0))
    free = -u0 * omega * (3.0 - 0.5 * np.pi / omega)
    np.testing.assert_allclose(recording.u, free, rtol=allowed(1.0))


@pytest.mark.usefixtures("interpreted")
def test_the_longer_an_elastic_contact_bounces_the_less_it_may_keep():
    # Plastic below 1e-15 L/T; after n times 10 000 in a row below n 1e-9 of the fastest, so
    # that bounces of any speed end.
    speeds = (0.9e-15, 1.1e-15, 0.9e-9, 1.9e-9)
    last = last_speed(1.0, False)
    plastic = [
        [is_plastic(speed, 1.0, last, n, 1) for speed in speeds] for n in (1, 10_001, 20_000)
    ]
    assert plastic == [[True, False, False, False], [True] * 3 + [False], [True] * 4]
    assert is_plastic(1.0, 1.0, last, 1, MOST_PROBLEMS + 1)
    # However fast the run was once, bounces end at the same speed.
    assert [is_plastic(0.9e-15, fastest, last, 1, 1) for fastest in (1e-9, 1e3)] == [True, True]
    assert not is_plastic(1.1e-15, 1e3, last, 1, 1)
    # Without any loss there is no limit, whenever it is looked at.
    assert not is_endless(0, 0.0, 0.0)
    assert [is_endless(WINDOW, lost, 1.0) for lost in (0.0, 1e-13, 1e-11)] == [True, True, False]
    assert not is_endless(WINDOW + 1, 0.0, 1.0)


@pytest.mark.parametrize("turned", [False, True])
def test_who_rests_first_at_the_limit_of_a_cascade_shows_nowhere(solver, turned):
    # Four bodies collapse at 0.9387 s: three contacts rest within 1e-16 s of each other, in an
    # order that rounding decides. The first pair to rest would for 1e-40 s be pushed with
    # 3.7 m/s², more than thrice what either sees before or after.
    scene, _ = random_scene(70278)
    scene = mirrored(scene)[0] if turned else scene
    times = np.linspace(0.0, 1.1, 4001)[1:-1]
    task = Task(scene, 0.0, 1.1, 1e-10, output_times=times)
    recording = solver_named(solver).solve(task)
    rests = [e.t for e in recording.events if e.kind is EventKind.REST and e.contact in (2, 3, 4)]
    assert len(rests) >= 3
    assert np.ptp(rests) < 1e-15
    history, extremes = recording.history, recording.acceleration
    sampled = history.a[np.isin(history.t, times)]
    # Within 0.3 ms they change little beside the 2.6 m/s² that the pair would add.
    np.testing.assert_allclose(extremes.maximum, sampled.max(axis=0), atol=0.05)
    np.testing.assert_allclose(extremes.minimum, sampled.min(axis=0), atol=0.05)
    # No time passes in the state before an impact at the start, and no extreme has it.
    begun = history.a[np.flatnonzero(history.t == 0.0)[-1] :]
    assert np.all(begun <= extremes.maximum + 1e-9)
    # The impacts before and after a mode that is none stand at one time in the history.
    assert np.all(np.diff(history.t) >= 0.0)
    assert {e.t for e in recording.events} <= set(history.t.tolist())


@pytest.mark.parametrize("solver", ["cvode", "ida"])
def test_a_cascade_can_be_stopped(solver):
    # An elastic contact that a constant push keeps shut: impact upon impact, all on series.
    scene = Scene(
        (Body("a", 1.0, 1e-9),),
        (Spring("push", (GROUND, "a"), BilinearElastic(1.0, 1.0, -1.0)),),
        contacts=(Contact("wall", BARRIER, "a", 0.0, 1.0),),
    )

    def stop(t: float) -> None:
        if t > 0.01:
            raise ComputationError("enough", t)

    with pytest.raises(ComputationError, match="enough") as error:
        solver_named(solver).solve(Task(scene, 0.0, 10.0, 1e-9, progress=stop))
    recording = error.value.recording
    # Each bounce takes 2 sqrt(2 h / a), h = 1e-9 and a = 1; whoever watches is told after some.
    bounce = 2.0 * np.sqrt(2e-9)
    assert 0.01 < recording.t < 0.01 + (STEPS_AT_ONCE + 1) * bounce
    assert len(recording.events) == pytest.approx(recording.t / bounce, abs=2)


def test_the_last_impact_of_a_collapse_stands_for_those_that_would_follow(solver):
    # b1, drawn towards b0, leaves the plastic b2 by a τ²/2 only before b0 throws it back: the
    # intervals square each time, and infinitely many impacts of some speed take no time.
    scene = Scene(
        (Body("b0", 50.0, 0.0, 0.3), Body("b1", 1.0, 0.0, -0.2), Body("b2", 50.0, 0.0, -0.2)),
        (
            Spring("left", (GROUND, "b0"), Linear(3.0)),
            Spring("right", (GROUND, "b2"), Linear(4.0)),
            Spring("pull", ("b0", "b1"), BilinearElastic(0.0, 10.0, -0.1)),
        ),
        contacts=(Contact("c0", "b0", "b1", 0.01, 0.9), Contact("c1", "b1", "b2", 0.0, 0.0)),
    )
    recording = run(scene, 1e-9, 0.3, solver=solver)
    impacts = [e for e in recording.events if e.kind is EventKind.IMPACT]
    assert len(impacts) > 10
    for e in impacts:
        expected = -scene.contacts[e.contact].restitution * e.gap_velocity_before
        assert e.gap_velocity_after == pytest.approx(expected, rel=1e-9, abs=1e-15)
    last = [e for e in recording.events if e.kind is EventKind.ACCUMULATION]
    assert [(e.contact, e.count, e.gap_velocity_after) for e in last] == [(0, 1, 0.0)]
    assert last[0].gap_velocity_before < -0.1
    assert last[0].impulse > 0.0


def two_bodies() -> SimpleNamespace:
    return SimpleNamespace(
        of_body=np.array([0, 1]),
        left=np.array([0]),
        right=np.array([1]),
        mass=np.ones(2),
        weights=np.zeros((0, 2)),
    )


@pytest.mark.usefixtures("interpreted")
def test_rounding_does_not_close_what_has_just_opened():
    # A gap opens by 4 τ³. After 4e-17 s, where a link turned, an acceleration of one rounding,
    # -4.5e-15 m/s², would close it in 5e-18 s, and so for ever. One that is known does close it.
    bodies = two_bodies()
    state = SimpleNamespace(gap=np.array([2.9e-49]), gap_rate=np.array([2.1e-32]))
    Y = np.zeros((5, 2))
    Y[3] = -4.8, -0.8

    def closes(relative: float) -> float:
        Y[2] = -0.09 - relative, -0.09
        C = gap_series(Y, SimpleNamespace(iq=np.arange(2)), bodies, state, 0.08, 1e-13, 1.0)
        return float(first_closings(C, np.ones(1, bool), 1.0)[0])

    assert closes(-4.5e-15) == np.inf
    assert closes(4.5e-15) == np.inf
    assert closes(-1e-10) == pytest.approx(2.1e-22, rel=1e-6)
    assert is_none(2, -1e-15, 1e-14, 1e-20, 1.0)
    assert not is_none(2, -1e-13, 1e-14, 1e-20, 1.0)
    assert not is_none(2, 1e-15, 1e-14, 1e-20, 1.0)
    assert not is_none(2, -1e-15, 1e-14, 1e-10, 1.0)
    assert is_none(2, -1e-13, 1e-14, 0.0, 1.0)


@pytest.mark.usefixtures("interpreted")
def test_a_gap_that_rounding_has_put_below_zero_closes_though_it_seems_to_open():
    bodies = two_bodies()
    state = SimpleNamespace(gap=np.array([-5.2e-18]), gap_rate=np.array([1.4e-17]))
    Y = np.zeros((5, 2))
    Y[2] = 0.0, -0.7
    C = gap_series(Y, SimpleNamespace(iq=np.arange(2)), bodies, state, 0.0, 1e-13, 1.0)
    assert first_closings(C, np.ones(1, bool), 1.0)[0] == pytest.approx(1.4e-17 / 0.7)


def test_a_cascade_given_up_names_its_contacts():
    contacts = [Contact(name, "a", "b", 0.0, 0.5) for name in ("early", "late", "slow")]
    early = [Event(0.1, EventKind.IMPACT, 0, 0, -1.0)] * WINDOW
    late = [Event(0.2, EventKind.IMPACT, 1, 1 + i % 2, -1e-4 / (1 + i)) for i in range(WINDOW)]
    message = long_message([*early, *late, Event(0.2, EventKind.REST, 2, 0)], contacts)
    assert "'late', 'slow' still meet with 1.0e-04 m/s" in message
    assert "early" not in message
