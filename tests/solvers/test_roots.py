"""``events = "sundials"``: the library's own root finder gives the events of the table of modes."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from eventpound.accuracy.estimate import estimate_errors
from eventpound.case.solver_options import SolverOptions
from eventpound.errors import ComputationError, InputError
from eventpound.mechanics.ground_frame import NO_FRAME
from eventpound.motion.pulses import Sine
from eventpound.numerics.by_address import with_address
from eventpound.scene import (
    BARRIER,
    GROUND,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Linear,
    Scene,
    Spring,
)
from eventpound.simulation import check_solver, response_of
from eventpound.solvers import solver_named
from eventpound.solvers.base import EventKind, Task
from eventpound.solvers.cvode import Cvode, integrator
from eventpound.solvers.events.instant_loop import make_ready
from eventpound.solvers.events.integrator import Bounds
from eventpound.solvers.events.loop import EventLoop, Segment
from eventpound.solvers.events.roots import on_the_root, root_functions
from eventpound.solvers.events.step_check import BEYOND_BOUND, CLEAR, EVENT_FOUND, Examination
from eventpound.solvers.events.step_search import INTEGRATOR
from eventpound.solvers.sundials import library
from tests.hard.catalogue import REFUSED, WARNED, catalogue
from tests.hard.outcome import Outcome, verdict
from tests.reference.comparison import compare
from tests.reference.problems import load
from tests.reference.test_open import UNSEEN
from tests.solvers.accuracy import allowed
from tests.solvers.random_scenes import random_scene, resting_scene
from tests.solvers.scenes import pounding_pair

if library.library() is None:
    pytest.skip("the SUNDIALS library is out of reach here", allow_module_level=True)

from eventpound.solvers.sundials import integrators, wrapped
from eventpound.solvers.sundials.compiled_cvode import DirectCvode
from eventpound.solvers.sundials.loop import ROOT_RETURN, SAME_ROOT, steps_to_roots

SUNDIALS_ROOTS = {"events": "sundials"}


@pytest.fixture
def nothing_else_looks(monkeypatch):
    """In a segment the event loop has no event to look for, and looks for none."""

    begin = Segment.__init__

    def watched(self: Segment, *arguments: object) -> None:
        begin(self, *arguments)
        assert self.event_run.state.progress[0].finder == INTEGRATOR
        guards = self._examined.dynamics.guards
        assert not guards.open_contacts.any()
        assert not guards.unlocked.any()
        assert not guards.follows
        assert np.isinf((guards.kink_low, guards.kink_high)).all()

    monkeypatch.setattr(Segment, "__init__", watched)


TOLERANCES = {("cvode", 1e-6): 1e-4, ("cvode", 1e-12): 1e-9, ("ida", 1e-10): 1e-8}
"""Errors allowed, as parts of scale, of solvers and their tolerances."""
SOLVED = {
    ("cvode", 1e-6): ("A01", "B03", "C01", "D07"),
    ("cvode", 1e-12): ("A10", "B12", "C03", "D01", "E01", "E07", "F01"),
    ("ida", 1e-10): ("A17", "B03", "D23", "E04"),
}
HARD = (
    "accumulation-rest-detachment",
    "chain-of-10-pressed",
    "event-at-end",
    "event-at-sample",
    "event-at-start",
    "exponent-50",
    "four-at-once",
    "graze-hit-1e-06",
    "graze-miss-1e-12",
    "kink-at-contact",
    "kink-struck",
)


@pytest.mark.parametrize(
    ("solver", "rtol", "name"),
    [
        pytest.param(*way, name, marks=[] if name in SOLVED[way] else [pytest.mark.sweep])
        for way in TOLERANCES
        for name in load()
    ],
)
def test_solved_problem(nothing_else_looks, solver, rtol, name):
    problem = load()[name]
    response = response_of(
        problem.scene, solver, rtol, duration=problem.end, settings=SUNDIALS_ROOTS
    )
    failures = compare(problem, response, TOLERANCES[solver, rtol]).failures
    assert [f for f in failures if f not in UNSEEN.get((name, solver), ())] == []


@pytest.mark.parametrize(
    "hard",
    [
        pytest.param(hard, id=hard.name, marks=[] if hard.name in HARD else [pytest.mark.sweep])
        for hard in catalogue()
        if hard.name not in REFUSED
    ],
)
def test_hard_scene(hard):
    """Motion, counts and resting times of both finders; where they differ, a warning."""
    ways = (("cvode", {}), ("cvode", SUNDIALS_ROOTS), ("ida", SUNDIALS_ROOTS))
    responses = [response_of(hard.case, solver=s, settings=settings) for s, settings in ways]
    if hard.name == "chaotic":
        # The warning names the contact at which the first event differs, not all of them.
        assert all(estimate_errors(response)["warnings"] for response in responses)
        return
    found = verdict(
        hard, [Outcome(s, response) for (s, _), response in zip(ways, responses, strict=True)]
    )
    assert found.word in (("agree", "warns") if hard.name in WARNED else ("agree",)), found.remark


def _oscillator(gap: float) -> Scene:
    body = Body("body", 1.0)
    spring = Spring("spring", (GROUND, "body"), Linear(1.0))
    contact = Contact("wall", BARRIER, "body", gap, 0.5)
    return Scene((body,), (spring,), (), (contact,), Sine(1.0, 2.0 * math.pi / 1.3))


@pytest.mark.parametrize("rtol", [1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize("overshoot", [1e-2, 1e-3, 1e-4, 1e-5])
def test_a_dip_within_a_step_is_found(overshoot, rtol):
    # u'' + u = -sin ωt from rest: u = -(sin ωt - ω sin t)/(1 - ω²) while the pulse lasts,
    # with its first minimum where cos ωt = cos t, at t = 2π/(1 + ω).
    omega = 1.3
    t = 2.0 * math.pi / (1.0 + omega)
    peak = (math.sin(omega * t) - omega * math.sin(t)) / (1.0 - omega**2)
    scene = _oscillator(abs(peak) * (1.0 - overshoot))
    for solver in ("cvode", "ida"):
        response = response_of(scene, solver, rtol, duration=t + 0.5, settings=SUNDIALS_ROOTS)
        first = response.recording.events[0]
        assert first.kind is EventKind.IMPACT
        # Before the minimum, by sqrt(2 overshoot peak / u''), u'' = peak + sin(ωt).
        ahead = math.sqrt(2.0 * overshoot * abs(peak) / abs(abs(peak) - math.sin(omega * t)))
        assert first.t == pytest.approx(t - ahead, abs=0.2 * ahead)


def _loop(scene: Scene, rtol: float, end: float) -> tuple[EventLoop, DirectCvode]:
    chosen = integrator(rtol, "Adams")
    assert isinstance(chosen, DirectCvode)
    return EventLoop(Task(scene, 0.0, end, rtol), chosen, finds_events=True), chosen


@pytest.mark.parametrize("gap", [0.0, -1e-13])
def test_a_gap_that_is_zero_at_a_start_and_closes_is_found_at_once(gap):
    """CVODE alone would call such a root inactive and never report it."""
    bodies = (Body("b", 1.0, 1.0, -1.0),)
    scene = Scene(bodies, (), (), (Contact("wall", BARRIER, "b", 0.0, 0.5),))
    loop, chosen = _loop(scene, 1e-8, 1.0)
    run = loop.event_run
    run.state.u[0], run.state.gap[0] = gap, max(gap, 0.0)
    piece = run.piece(scene.motion.pieces()[0], 1.0)
    make_ready(run, run.mode, piece)
    assert Segment(run, chosen, piece, NO_FRAME).run()
    assert run.state.gap[0] == 0.0
    # Lifted by its noise, 1e-15 of L = 1 m, at 1 m/s.
    assert 0.0 < run.t < 3e-15


def test_roots_of_one_step_come_one_after_the_other():
    """Two bodies that fly to their walls, the second 1e-9 s after the first; third at once."""
    late = 1e-9
    bodies = tuple(Body(name, 1.0, 0.0, -1.0) for name in "abc")
    gaps = (1.0, 1.0 + late, 1.0)
    contacts = tuple(
        Contact(f"wall {b.name}", BARRIER, b.name, gap, 1.0)
        for b, gap in zip(bodies, gaps, strict=True)
    )
    recording = Cvode().solve(
        Task(Scene(bodies, (), (), contacts), 0.0, 1.5, 1e-10, settings=SUNDIALS_ROOTS)
    )
    assert [(e.contact, e.group) for e in recording.events] == [(0, 0), (2, 0), (1, 1)]
    times = [e.t for e in recording.events]
    np.testing.assert_allclose(times, [1.0, 1.0, 1.0 + late], rtol=0.0, atol=1e-12)


def test_a_kink_and_a_release():
    # A spring of 4 N/m in compression and 1 N/m in extension throws b off a at its zero force.
    bodies = (Body("a", 1.0, -0.3), Body("b", 1.0, -0.3))
    spring = Spring("k", (GROUND, "a"), BilinearElastic(8.0, 2.0, 0.0))
    scene = Scene(bodies, (spring,), (), (Contact("joint", "a", "b", 0.0, 0.5),))
    for solver in ("cvode", "ida"):
        rtol = 1e-9
        recording = response_of(
            scene, solver, rtol, duration=2.0, settings=SUNDIALS_ROOTS
        ).recording
        assert [e.kind for e in recording.events] == [EventKind.REST, EventKind.DETACHMENT]
        # Together at ω = 2; b leaves at the kink with 0.6 m/s, a swings at ω = sqrt(2) on.
        release = math.pi / 4.0
        assert recording.events[1].t == pytest.approx(release, abs=allowed(1.0, rtol))
        late, omega = 2.0 - release, math.sqrt(2.0)
        assert recording.u[1] == pytest.approx(0.6 * late, abs=allowed(0.7, rtol))
        assert recording.u[0] == pytest.approx(
            0.6 / omega * math.sin(omega * late), abs=allowed(0.5, rtol)
        )


def test_a_root_is_put_on_the_zero():
    # Two values fallen by 1e-14 and 4e-14 below their noise of 1e-15, at 1 m/s; a third still up.
    pairs = np.array([[-1e-14, -1.0], [-4e-14, -1.0], [0.1, -1.0]])
    noise = np.full(3, 1e-15)
    assert 1.0 - on_the_root(pairs, noise, 0.5, 1.0, 1e-13) == pytest.approx(4.1e-14, rel=1e-2)
    # Not beyond the bracket, nor before the step.
    assert on_the_root(pairs[1:2], noise[:1], 0.5, 1.0, 1e-14) == 1.0
    assert on_the_root(pairs, noise, 1.0 - 1e-14, 1.0, 1e-13) == 1.0


def test_a_rate_that_has_died_away_turns_no_more():
    # A link between bodies that rest on each other: its rate decays until its digits are gone.
    pairs = np.array([[0.4, -2e-311], [0.4, 0.0], [0.4, -1e-15]])
    root_functions(pairs, np.zeros(3))
    assert (pairs[:, 1] > 0.0).tolist() == [True, True, False]
    assert pairs[0, 1] * pairs[1, 1] > 0.0
    scene, end = resting_scene(500384)
    by = {name: response_of(scene, name, 1e-8, duration=end).recording for name in ("ida", "fast")}
    assert np.abs(by["ida"].u - by["fast"].u).max() < 1e-6 * np.abs(by["fast"].u).max()


def test_a_root_that_is_found_again_and_again_is_an_end():
    def steps(*given: Any) -> Any:
        return ROOT_RETURN, 0, 1.0, 1.5, CLEAR, 0.0, 0

    def at_root(*given: Any) -> Any:
        return CLEAR, 1.5

    examination: Any = SimpleNamespace(z_bound=np.empty(0), z_allowed=0.0, y=np.zeros((2, 0)))
    bounds = Bounds(2.0, False, np.inf, 10)
    flag, _, start, end, *_ = steps_to_roots(steps, at_root, 1.0, 0, 0.0, bounds, examination)
    assert flag == SAME_ROOT
    assert start == end == 1.0


def test_it_is_what_ida_takes_unless_told_otherwise(nothing_else_looks):
    scene = _oscillator(1.0)
    assert response_of(scene, "ida", 1e-6, duration=1.0).recording.success
    for solver, settings in (("ida", {"events": "own"}), ("cvode", {})):
        with pytest.raises(AssertionError):
            response_of(scene, solver, 1e-6, duration=1.0, settings=settings)


@pytest.mark.parametrize("solver", ["cvode", "ida"])
def test_a_word_that_is_none(solver):
    message = r"\[solver\]: events = 'foo'; accepted: own or sundials"
    options = SolverOptions(solver, settings={"events": "foo"})
    with pytest.raises(InputError, match=message):
        check_solver(options)
    with pytest.raises(InputError, match=message):
        response_of(_oscillator(1.0), solver, settings={"events": "foo"})


@pytest.mark.parametrize(
    ("solver", "rtol", "name", "allowed_error"),
    [
        pytest.param(solver, rtol, name, error, marks=[] if here else [pytest.mark.sweep])
        for solver, rtol, error, few in (
            ("cvode", 1e-6, 1e-4, ("B03",)),
            ("cvode", 1e-10, 1e-7, ()),
            ("ida", 1e-6, 1e-4, ("A14",)),
            ("ida", 1e-10, 1e-8, ()),
        )
        for name in load()
        for here in (name in few,)
    ],
)
def test_through_scikit_sundae_it_finds_the_same(
    nothing_else_looks, monkeypatch, solver, rtol, name, allowed_error
):
    """Where the library's symbols are out of reach, by the `eventsfn` of scikit-sundae."""
    monkeypatch.setattr(library, "library", lambda: None)
    monkeypatch.setattr(library, "ida_library", lambda: None)
    problem = load()[name]
    response = response_of(
        problem.scene, solver, rtol, duration=problem.end, settings=SUNDIALS_ROOTS
    )
    failures = compare(problem, response, allowed_error).failures
    assert [f for f in failures if f not in UNSEEN.get((name, solver), ())] == []


@pytest.mark.parametrize("solver", ["cvode", "ida"])
def test_through_scikit_sundae_every_search_has_a_log_of_its_own(monkeypatch, solver):
    """It keeps its log of roots on the function that it is given, and hands all of it out."""
    monkeypatch.setattr(library, "library", lambda: None)
    monkeypatch.setattr(library, "ida_library", lambda: None)
    logged: list[int] = []
    original = wrapped.Wrapped._step

    def watched(self: Any, stop: float) -> Any:
        step = self._present.step

        def counted(*given: Any) -> Any:
            result = step(*given)
            logged.append(0 if result.i_events is None else len(result.i_events))
            return result

        with monkeypatch.context() as patched:
            patched.setattr(self, "_present", type("Present", (), {"step": staticmethod(counted)}))
            return original(self, stop)

    monkeypatch.setattr(wrapped.Wrapped, "_step", watched)
    bodies, wall = (Body("b", 1.0, 0.0, -1.0),), Contact("wall", BARRIER, "b", 0.5, 1.0)
    springs = (Spring("k", (GROUND, "b"), Linear(1.0)),)
    response = response_of(
        Scene(bodies, springs, (), (wall,)), solver, 1e-8, duration=20.0, settings=SUNDIALS_ROOTS
    )
    # One that ends a segment, and a dip before it.
    assert len(response.events) >= 4
    assert 1 <= max(logged) <= 2


@pytest.mark.parametrize("solver", ["cvode", "ida"])
def test_a_leap_over_the_knee_is_no_event(monkeypatch, solver):
    """Where a root lies in a step whose end leaves |z| beyond its bound, the step is taken anew."""
    law = BoucWen(4.0, 0.5, 0.1, 20.0)
    body, spring = Body("b", 1.0, 0.0, 1.0), Spring("k", (GROUND, "b"), law)
    scene = Scene((body,), (spring,), (), (Contact("wall", "b", BARRIER, 0.2, 0.5),))
    task = Task(scene, 0.0, 0.5, 1e-9, settings=SUNDIALS_ROOTS)
    wanted = solver_named(solver).solve(task)
    said: list[tuple[float, int, float]] = []

    def with_a_leap(steps: Any, at_root: Any, *given: Any) -> Any:
        def at_root_there(
            start: float, tau: float, first: int, excess: float, e: Examination
        ) -> tuple[int, float]:
            there = e if said else with_address(e._replace(z_bound=0.0 * e.z_bound))
            verdict, end = at_root(start, tau, first, excess, there)
            said.append((tau, verdict, end))
            return verdict, end

        return steps_to_roots(steps, at_root_there, *given)

    monkeypatch.setattr(integrators, "steps_to_roots", with_a_leap)
    recording = solver_named(solver).solve(task)
    tau, verdict, end = said[0]
    assert verdict == BEYOND_BOUND
    assert end > tau
    assert said[-1][1] == EVENT_FOUND
    assert recording.work.restarts == wanted.work.restarts + 1
    times = [[event.t for event in run.events] for run in (recording, wanted)]
    np.testing.assert_allclose(*times, rtol=allowed(1.0, 1e-9))


def test_a_limit_of_steps_is_kept():
    with pytest.raises(ComputationError, match="the limit of 300 steps") as caught:
        response_of(pounding_pair(), "cvode", duration=6.0, settings=SUNDIALS_ROOTS, max_steps=300)
    recording = caught.value.recording
    assert recording.work.steps == 300


@pytest.mark.parametrize("seed", [156, 330, 439])
def test_rows_of_a_step_with_a_root_at_its_end_are_on_its_polynomial(seed):
    # The root is the bottom of a dip: the step goes on, but IDA has no more of it to tell.
    scene, end = random_scene(seed)
    settings = {"events": "sundials"}
    found = response_of(scene, "ida", duration=end, rtol=1e-9, settings=settings).recording
    u, extremes = found.history.u, found.displacement
    noise = 1e-9 * np.abs(u).max()
    assert np.all(u <= extremes.maximum + noise)
    assert np.all(u >= extremes.minimum - noise)


def test_what_is_done_meanwhile_changes_no_direction(monkeypatch):
    """Another thread may take free memory as soon as the library is called."""
    found = library.ida_library()
    told = []

    class Busy:
        def __getattr__(self, name: str) -> Any:
            return getattr(found.ida, name)

        def IDASetRootDirection(self, memory: int, ways: int) -> int:
            others = [np.full(n, 7, np.intc) for n in range(1, 9) for _ in range(20)]
            told.append(len(others))
            return found.ida.IDASetRootDirection(memory, ways)

    task = Task(pounding_pair(), 0.0, 6.0, 1e-8)
    alone = solver_named("ida").solve(task)
    monkeypatch.setattr(library, "ida_library", lambda: found._replace(ida=Busy()))
    beside = solver_named("ida").solve(task)
    assert told
    assert alone.events
    assert beside.events == alone.events
    np.testing.assert_array_equal(beside.history.u, alone.history.u)
