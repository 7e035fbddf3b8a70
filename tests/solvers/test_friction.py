"""Coulomb friction at contacts: closed forms, energy, and a program of SciPy alone."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from eventpound import ComputationError, Harmonic, InputError, Joint, simulate
from eventpound.numerics.arrays import Floats
from eventpound.scene import (
    BARRIER,
    Contact,
    ContactLaw,
    Deck,
    Force,
    Linear,
    Scene,
    Slider,
    Spring,
)
from eventpound.scene.contact_law import IMPACT_LAWS
from eventpound.scene.deck import DeckStart
from eventpound.solvers import solver_named
from eventpound.solvers.base import EventKind, Recording, Task
from tests.oracle.plan import states
from tests.solvers.friction_scenes import (
    GRAVITY,
    MASS,
    block,
    corner_contacts,
    slid,
    slid_under,
    struck_corner,
)
from tests.solvers.plan_scenes import random_plan

SOLVERS = ["cvode", "fast"]
SEEDS = (1, 3, 7, 16, 22, 28, 35, 62, 63, 74, 81, 86)
"""Scenes, most of which slip and stick; of 150 those that the other program follows agree."""


def _run(
    scene: Scene, end: float, solver: str = "cvode", *, energy: bool = True, **settings: object
) -> Recording:
    times = np.linspace(0.0, end, 26)
    task = Task(scene, 0.0, end, 1e-12, output_times=times, energy=energy, settings=settings)
    return solver_named(solver).solve(task)


@pytest.mark.parametrize(
    ("solver", "settings"),
    [("cvode", {"events": "own"}), ("cvode", {"events": "sundials"}), ("fast", {})],
)
@pytest.mark.parametrize(
    ("friction", "slope", "speed"),
    [
        (0.3, 0.1, 0.0),
        (0.3, 0.5, 0.0),
        (0.1, 0.5, 0.0),
        (0.3, 0.1, 2.0),
        (0.3, 0.1, -2.0),
        (0.3, 0.5, -3.0),
    ],
)
def test_a_block_on_a_slope(
    friction: float, slope: float, speed: float, solver: str, settings: dict[str, object]
) -> None:
    recording = _run(block(friction, slope, speed), 1.0, solver, **settings)
    exact = slid(friction, slope, speed, 1.0)
    np.testing.assert_allclose(recording.u, [exact, 0.0, 0.0], atol=1e-12)
    drives, holds = GRAVITY * math.sin(slope), GRAVITY * friction * math.cos(slope)
    way = abs(exact) if drives < holds else exact + speed**2 / (drives + holds) * (speed < 0.0)
    np.testing.assert_allclose(recording.friction.path, way, rtol=1e-12, atol=1e-15)
    # All of the weight presses, and friction works with μ times that.
    assert recording.energy.friction == pytest.approx(MASS * holds * way, rel=1e-11, abs=1e-9)
    assert abs(recording.energy.closure) < 1e-12


@pytest.mark.parametrize(
    ("solver", "energy"), [("cvode", True), ("cvode", False), ("fast", True), ("fast", False)]
)
def test_a_shaken_block_sticks_and_slips(solver: str, energy: bool) -> None:
    """On two corners, which share friction; beside the balance of a mass by steps of 1e-6 s."""
    friction, amplitude, period, end = 0.2, 4.0, 0.8, 1.5
    scene = block(friction, motion=Harmonic(amplitude, period))
    exact = slid_under(amplitude, period, friction * GRAVITY, end)
    recording = _run(scene, end, solver, energy=energy)
    assert recording.u[0] == pytest.approx(exact, abs=1e-6)
    # Both corners rest, and let go together as the ground goes away to the right under them.
    told = [[e for e in recording.slides if e.contact == j] for j in (0, 1)]
    lets_go = math.asin(friction * GRAVITY / amplitude) * period / (2.0 * math.pi)
    for own in told:
        assert [e.kind.value for e in own[:3]] == ["stick", "slip-forward", "slip-backward"]
        assert own[1].t == pytest.approx(lets_go, abs=1e-11)
    np.testing.assert_allclose(*([e.t for e in own] for own in told), rtol=1e-12)
    if energy:
        assert abs(recording.energy.closure) < 1e-10
    if energy or solver != "cvode":
        return
    # Moreau–Jean comes to it at first order.
    errors = []
    for step in (4e-3, 1e-3, 2.5e-4):
        task = Task(scene, 0.0, end, 1e-9, settings={"time_step": step})
        found = solver_named("moreau").solve(task)
        errors.append(abs(found.u[0] - exact))
    assert errors[-1] < 0.2 * errors[0]
    assert errors[-1] < 2.5e-4 * amplitude
    # Between two slips it may stick for a step.
    slips = [[e for e in each if e.kind is not EventKind.STICK] for each in (found.slides, told[0])]
    own = [e for e in slips[0] if e.contact == 0]
    assert [e.kind for e in own] == [e.kind for e in slips[1]]
    np.testing.assert_allclose([e.t for e in own], [e.t for e in slips[1]], atol=1e-3)


@pytest.mark.parametrize("solver", [*SOLVERS, "moreau"])
def test_a_tall_block_rocks(solver: str) -> None:
    """It sticks on both corners until the load tips it, and then turns about the one behind."""
    b, h, amplitude, period, end = 0.5, 2.0, 6.0, 4.0, 0.5
    deck = Deck("B", MASS, 2.0 * b, 2.0 * h)
    scene = Scene(
        deck.bodies(DeckStart()),
        contacts=corner_contacts(deck, 2, 0.8),
        motion=Harmonic(amplitude, period),
        forces=[Force("B.y", -MASS * GRAVITY)],
        decks=[deck],
    )
    tight = solver != "moreau"
    settings = {} if tight else {"time_step": 1e-4}
    recording = _run(scene, end, solver, energy=tight, **settings)
    omega = 2.0 * math.pi / period
    tips = math.asin(GRAVITY * b / (h * amplitude)) / omega
    (lifted,) = [e for e in recording.events if e.kind is EventKind.DETACHMENT]
    assert lifted.contact == 1
    assert lifted.t == pytest.approx(tips, abs=1e-11 if tight else 1e-3)
    since, inertia = end - tips, deck.inertia_about_centre / MASS + b * b + h * h
    push = math.cos(omega * tips) * since / omega
    push -= (math.sin(omega * end) - math.sin(omega * tips)) / omega**2
    turn = (h * amplitude * push - 0.5 * GRAVITY * b * since**2) / inertia
    found = recording.u / [1.0, 1.0, deck.radius]
    error = 1e-11 if tight else 1e-4
    np.testing.assert_allclose(found, turn * np.array([-h, b, 1.0]), atol=error)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("seed", range(8))
def test_one_corner_strikes(seed: int, solver: str) -> None:
    rng = np.random.default_rng(seed)
    deck = Deck("B", MASS, rng.uniform(2.0, 6.0), rng.uniform(1.0, 4.0))
    friction, restitution = rng.uniform(0.1, 0.5), rng.uniform(0.0, 0.6)
    start = DeckStart((0.0, 0.0), (rng.uniform(-2.0, 2.0), -1.0), 0.0, rng.uniform(-0.1, 0.1))
    contacts = corner_contacts(deck, 1, friction, restitution)
    recording = _run(Scene(deck.bodies(start), contacts=contacts, decks=[deck]), 0.01, solver)
    v = np.array([*start.velocity, start.spin])
    expected, (normal, tangential) = struck_corner(deck, v, friction, restitution)
    event = recording.events[0]
    assert event.impulse == pytest.approx(normal, rel=1e-12)
    assert recording.friction.tangential[0] == pytest.approx(abs(tangential), rel=1e-12)
    inertia = np.array([deck.mass, deck.mass, deck.inertia_about_centre])
    assert event.energy_lost == pytest.approx(0.5 * inertia @ (v**2 - expected**2), rel=1e-10)
    if restitution > 0.0 and len(recording.events) == 1:
        np.testing.assert_allclose(recording.v / [1.0, 1.0, deck.radius], expected, rtol=1e-12)


def rubbing_plan(seed: int) -> tuple[Scene, list[Joint], float]:
    scene, joints, end = random_plan(seed)
    friction = float(np.random.default_rng(seed + 10000).choice([0.1, 0.3, 0.5, 0.8]))
    return (
        replace(scene, contacts=[replace(c, friction=friction) for c in scene.contacts]),
        joints,
        end,
    )


@pytest.mark.parametrize(
    "seed", [*SEEDS[::2], *(pytest.param(seed, marks=pytest.mark.sweep) for seed in SEEDS[1::2])]
)
def test_random_decks_against_scipy(seed: int) -> None:
    scene, joints, end = rubbing_plan(seed)
    expected = states(scene, joints, np.linspace(0.0, end, 26))
    assert expected is not None
    size = np.maximum(np.abs(expected).max(axis=0), 1e-3)
    for solver in SOLVERS:
        recording = _run(scene, end, solver)
        # The largest of 97 scenes is 1.1e-10, one of 62 impacts apart.
        assert (np.abs(states_of(recording, end) - expected) <= 1e-9 * size).all()
        assert abs(recording.energy.closure) < 1e-10


def states_of(recording: Recording, end: float) -> Floats:
    h = recording.history
    i = np.searchsorted(h.t, np.linspace(0.0, end, 26), "right") - 1
    return np.hstack((h.u[i], h.v[i]))


@pytest.mark.parametrize("seed", [0, 4, 9, 13, 17, 28])
def test_both_solvers_tell_the_same(seed: int) -> None:
    """Of friction, too; both corners of an edge that slides along another share what is one."""
    scene, _, end = rubbing_plan(seed)
    one, other = _run(scene, end), _run(scene, end, "fast")
    size = np.maximum(np.abs(states_of(one, end)).max(axis=0), 1e-3)
    # Of 250 scenes that have a course 1.0e-10 at most.
    assert (np.abs(states_of(other, end) - states_of(one, end)) <= 1e-9 * size).all()
    events = [[(e.kind, e.contact) for e in recording.events] for recording in (one, other)]
    assert events[0] == events[1]
    assert one.friction is not None
    assert other.friction is not None
    for key in ("path", "impulse"):
        told = getattr(one.friction, key)
        np.testing.assert_allclose(getattr(other.friction, key), told, rtol=1e-9, atol=1e-12)
    of_joints = [f.work.reshape(-1, 2).sum(axis=1) for f in (one.friction, other.friction)]
    np.testing.assert_allclose(of_joints[1], of_joints[0], rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(other.max_force, one.max_force, rtol=1e-9, atol=1e-3)


@pytest.mark.parametrize("solver", SOLVERS)
def test_friction_none_is_as_if_none_were_given(solver: str) -> None:
    scene, _, end = random_plan(16)
    given = replace(scene, contacts=[replace(c, friction=0.0) for c in scene.contacts])
    assert _run(given, end, solver).u.tobytes() == _run(scene, end, solver).u.tobytes()


@pytest.mark.parametrize("law", IMPACT_LAWS)
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_deck_without_skew_shaken_along_its_axis_does_not_turn(solver: str, law: str) -> None:
    """To the last bit."""
    deck = Deck("B", "10 t", "20 m", "8 m")
    joint = Joint("wall", ("B", "barrier"), 0.01, 0.5, 0.4)
    springs = [Spring(way, ("ground", f"B.{way}"), Linear(2e6)) for way in ("x", "y", "turn")]
    scene = Scene(
        deck.bodies(),
        springs=springs,
        contacts=joint.contacts({"B": deck}),
        motion=Harmonic(4.0, 0.6),
        decks=[deck],
        impact_law=law,
    )
    recording = _run(scene, 2.0, solver)
    assert len(recording.events) > 4
    along, across, turn = np.abs(recording.history.u).max(axis=0)
    assert along > 0.0
    assert across == turn == 0.0


@pytest.mark.parametrize("law", IMPACT_LAWS)
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_mirrored_scene_has_the_mirrored_motion(solver: str, law: str) -> None:
    """Turned about x: what slides upwards slides downwards, by as much."""
    deck = Deck("B", "10 t", "20 m", "8 m", "30 deg")
    other = replace(deck, skew=-deck.skew)
    joint = Joint("wall", ("B", "barrier"), (0.01, 0.02), 0.5)
    turned = Joint("wall", ("B", "barrier"), (0.02, 0.01), 0.5)
    start = DeckStart((0.0, 0.0), (0.4, 0.2), 0.0, 0.01)
    back = DeckStart((0.0, 0.0), (0.4, -0.2), 0.0, -0.01)
    found = []
    for each, way, begins in ((deck, joint, start), (other, turned, back)):
        contacts = [replace(c, friction=0.4) for c in way.contacts({"B": each})]
        scene = Scene(each.bodies(begins), contacts=contacts, decks=[each], impact_law=law)
        found.append(_run(scene, 0.5, solver))
    np.testing.assert_allclose(found[1].v * [1.0, -1.0, -1.0], found[0].v, rtol=1e-11)
    one, two = (recording.friction for recording in found)
    np.testing.assert_allclose(two.tangential[::-1], one.tangential, rtol=1e-11)


@pytest.mark.parametrize("solver", SOLVERS)
def test_what_gains_energy_ends_the_run(solver: str) -> None:
    deck = Deck("B", 1.0, 5.390649732448921, 3.721012615946246)
    start = DeckStart((0.0, 0.0), (0.72328432, -1.0), 0.0, 0.31032001)
    contacts = corner_contacts(deck, 1, 0.24545278407384907, 0.9930182703461161)
    scene = Scene(deck.bodies(start), contacts=contacts, decks=[deck])
    with pytest.raises(ComputationError, match=r"gains kinetic energy.*'c0' \(friction 0.245"):
        _run(scene, 0.01, solver)


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_paradox_of_painleve_ends_the_run(solver: str) -> None:
    """A tall block pushed over its edge: friction presses more than it lifts."""
    deck = Deck("B", MASS, 1.0, 4.0)
    pulls = block(0.0).forces
    scene = Scene(
        deck.bodies(DeckStart((0.0, 0.0), (1.0, 0.0))),
        contacts=corner_contacts(deck, 2, 3.0)[1:],
        forces=pulls,
        decks=[deck],
    )
    with pytest.raises(ComputationError, match=r"Painlev|not unique"):
        _run(scene, 0.1, solver)


@pytest.mark.parametrize("solver", SOLVERS)
def test_what_a_response_tells(solver: str) -> None:
    response = simulate(block(0.3, 0.1, 2.0), solver, duration=1.0, energy=True)
    summary = response.summary
    assert summary["contacts.c0.sliding_path"] == pytest.approx(slid(0.3, 0.1, 2.0, 1.0))
    assert summary["contacts.c0.friction_work"] > 0.0
    assert summary["energy.friction"] > 0.0
    # Down the slope, to the right of the normal, and not yet at rest.
    assert summary["contacts.c0.slips"] == 1
    kinds = response.events["kind"][response.events["contact"] == "c0"]
    assert kinds.tolist() == ["rest", "slip-backward"]


def test_friction_is_refused_beside_what_has_an_instant_of_its_own():
    """Sliders and laws of contact: nothing decides both at once."""
    scene = block(0.3)
    rail = Spring("rail", ("ground", "B.x"), Slider(0.1, MASS * GRAVITY))
    stop = Contact("stop", "B.x", BARRIER, 0.5, law=ContactLaw("linear", 1e8))
    for solver in ("cvode", "fast", "moreau"):
        with pytest.raises(InputError, match=r"friction: found 0\.3; accepted: 0 beside sliders"):
            simulate(replace(scene, springs=(rail,)), solver, duration=0.1)
        with pytest.raises(InputError, match=r"accepted: 0 beside a law of contact \('stop'\)"):
            simulate(replace(scene, contacts=(*scene.contacts, stop)), solver, duration=0.1)


def test_a_solver_that_takes_no_decks_says_so():
    with pytest.raises(InputError, match="'penalty' cannot take forces and decks in plan; acc"):
        simulate(block(0.3), "penalty", duration=0.1)
