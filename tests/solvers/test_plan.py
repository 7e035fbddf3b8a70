"""Decks in plan: closed forms, symmetry to the last bit, and a program of SciPy alone."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from eventpound.errors import ComputationError
from eventpound.motion import GroundMotion, NoMotion, Ricker
from eventpound.numerics.arrays import Floats
from eventpound.scene import BARRIER, GROUND, Dashpot, Deck, Joint, Linear, Scene, Spring
from eventpound.scene.deck import DeckStart, place_in_a_row
from eventpound.simulation import response_of
from eventpound.solvers import solver_named
from eventpound.solvers.base import EventKind, Recording, Task
from tests.oracle.plan import states
from tests.solvers.plan_scenes import random_plan

SOLVERS = ("cvode", "ida", "fast")
SEEDS = [range(10), pytest.param(range(10, 40), marks=pytest.mark.sweep)]
ALLOWED = 1e-9
"""Of the largest of each coordinate; the largest found is 7e-11, at rtol 1e-12."""


def run(scene: Scene, end: float, solver: str = "cvode", rtol: float = 1e-12) -> Recording:
    times = np.linspace(0.0, end, 26)
    return solver_named(solver).solve(Task(scene, 0.0, end, rtol, output_times=times))


def at_times(recording: Recording, times: Floats) -> Floats:
    """Displacements and velocities after what happens at a time."""
    h = recording.history
    i = np.searchsorted(h.t, times, "right") - 1
    return np.hstack((h.u[i], h.v[i]))


@cache
def by_scipy(seed: int) -> Floats | None:
    scene, joints, end = random_plan(seed)
    return states(scene, joints, np.linspace(0.0, end, 26))


@pytest.mark.parametrize("seeds", SEEDS)
@pytest.mark.parametrize("solver", SOLVERS)
def test_random_decks_against_scipy(solver: str, seeds: range) -> None:
    compared = 0
    for seed in seeds:
        expected = by_scipy(seed)
        if expected is None:
            continue
        scene, _, end = random_plan(seed)
        found = at_times(run(scene, end, solver), np.linspace(0.0, end, 26))
        size = np.maximum(np.abs(expected).max(axis=0), 1e-3)
        assert (np.abs(found - expected) <= ALLOWED * size).all(), seed
        compared += 1
    assert compared >= 0.7 * len(seeds)


def free_deck(skew: float, v: tuple[float, float], gaps: tuple[float, float], e: float) -> Scene:
    """A deck that nothing holds before a wall on its right."""
    deck = Deck("D", "1200 t", "40 m", "12 m", skew)
    joint = Joint("wall", ("D", BARRIER), gaps, e)
    return Scene(
        deck.bodies(DeckStart(velocity=v)), contacts=joint.contacts({"D": deck}), decks=[deck]
    )


@pytest.mark.parametrize("solver", SOLVERS)
def test_one_corner_of_a_rectangle(solver: str) -> None:
    """Two equations: of the push at the corner, and of its moment."""
    e, speed, half = 0.6, 0.5, 6.0
    scene = free_deck(0.0, (speed, 0.1), (0.02, 0.05), e)
    deck = scene.decks[0]
    m, J = deck.mass, deck.inertia_about_centre
    v = run(scene, 0.05, solver).v
    # The lower corner: its normal speed u' + half θ' turns round by e.
    impulse = (1.0 + e) * speed / (1.0 / m + half**2 / J)
    spin = -impulse * half / J
    assert v == pytest.approx([speed - impulse / m, 0.1, deck.radius * spin], rel=1e-12)
    assert v[0] + half * v[2] / deck.radius == pytest.approx(-e * speed, rel=1e-12)


@pytest.mark.parametrize("skew", [0.1, 0.3, 0.5, 0.9, -0.5])
def test_a_whole_edge_turns_a_deck_of_enough_skew(skew: float) -> None:
    """Both corners press where their arms have two signs, which W/L > sin(2 α)/2 says."""
    e, speed, L, W = 0.6, 0.5, 40.0, 12.0
    scene = free_deck(skew, (speed, 0.0), (0.02, 0.02), e)
    deck = scene.decks[0]
    m, J = deck.mass, deck.inertia_about_centre
    v = run(scene, 0.1).v
    normal = speed * math.cos(skew)
    arms = [0.5 * L * math.sin(skew) + side * 0.5 * W / math.cos(skew) for side in (1.0, -1.0)]
    arm = 0.0 if abs(math.sin(2.0 * skew)) / 2.0 < W / L else min(arms, key=abs)
    impulse = (1.0 + e) * normal / (1.0 / m + arm**2 / J)
    expected = [
        speed - impulse * math.cos(skew) / m,
        -impulse * math.sin(skew) / m,
        -deck.radius * arm * impulse / J,
    ]
    assert v == pytest.approx(expected, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("skew", [0.5, 0.8])
def test_an_edge_that_slips_has_another_boundary(skew: float) -> None:
    """What pushes leans by φ = arctan μ, and hits the edge where it hits that of less skew."""
    friction, L = 0.3, 40.0
    lean = math.atan(friction)
    boundary = L * math.sin(skew - lean) * math.cos(skew) / math.cos(lean)
    for part in (0.98, 1.02):
        deck = Deck("D", "1200 t", L, part * boundary, skew)
        joint = Joint("wall", ("D", BARRIER), 0.02, 0.5, friction)
        start = DeckStart(velocity=(0.5, 0.0))
        contacts = joint.contacts({"D": deck})
        v = run(Scene(deck.bodies(start), contacts=contacts, decks=[deck]), 0.1).v
        assert (abs(v[2]) > 1e-6) == (part < 1.0)


def bridge(
    skew: float, motion: GroundMotion, across: GroundMotion, attack: float = 0.0, e: float = 0.5
) -> Scene:
    """Two decks between abutments."""
    bare = [Deck("A", "1200 t", "40 m", "12 m", skew), Deck("B", "900 t", "34 m", "12 m", skew)]
    places = place_in_a_row(bare, [0.03])
    decks = [replace(deck, centre=at) for deck, at in zip(bare, places, strict=True)]
    known = {deck.name: deck for deck in decks}
    joints = (
        Joint("west", (BARRIER, "A"), "4 cm", e),
        Joint("middle", ("A", "B"), "3 cm", e),
        Joint("east", ("B", BARRIER), "4 cm", e),
    )
    springs, dashpots = [], []
    for deck, period in zip(decks, (1.2, 0.9), strict=True):
        for word in ("x", "y", "turn"):
            k = deck.mass * (2.0 * math.pi / period) ** 2
            ends = GROUND, f"{deck.name}.{word}"
            springs.append(Spring(ends[1], ends, Linear(k)))
            dashpots.append(Dashpot(ends, 0.1 * math.sqrt(k * deck.mass)))
    return Scene(
        [body for deck in decks for body in deck.bodies()],
        springs,
        dashpots,
        [contact for joint in joints for contact in joint.contacts(known)],
        motion,
        decks=decks,
        across=across,
        attack=attack,
    )


PULSE, OTHER = Ricker("0.5 g", "0.8 s"), Ricker("0.3 g", "0.7 s")


@pytest.mark.parametrize("solver", SOLVERS)
def test_without_skew_nothing_turns_to_the_last_bit(solver: str) -> None:
    recording = run(bridge(0.0, PULSE, NoMotion()), 4.0, solver, 1e-9)
    assert sum(event.kind is EventKind.IMPACT for event in recording.events) > 10
    still = [1, 2, 4, 5]
    assert (recording.history.u[:, still] == 0.0).all()
    assert (recording.history.v[:, still] == 0.0).all()
    assert np.abs(recording.history.u[:, [0, 3]]).max() > 0.03


@pytest.mark.parametrize("solver", SOLVERS)
def test_mirrored(solver: str) -> None:
    """The other skew under the other second component: y and turn the other way round."""
    own = run(bridge(0.5, PULSE, OTHER), 4.0, solver)
    other = run(bridge(-0.5, PULSE, replace(OTHER, reverse=True)), 4.0, solver)
    sign = np.array([1.0, -1.0, -1.0] * 2)
    times = np.linspace(0.0, 4.0, 26)
    found, mirrored = at_times(own, times), at_times(other, times) * np.tile(sign, 2)
    assert np.abs(found - mirrored).max() <= 1e-10 * np.abs(found).max()


def test_a_motion_from_the_side_is_a_second_component() -> None:
    """At 90 degrees the first component is the second, and the second the first turned round."""
    end, times = 3.0, np.linspace(0.0, 3.0, 26)
    turned = run(bridge(0.4, PULSE, OTHER, math.pi / 2), end)
    told = run(bridge(0.4, replace(OTHER, reverse=True), PULSE), end)
    size = np.abs(turned.history.u).max()
    assert np.abs(at_times(turned, times) - at_times(told, times)).max() <= 1e-9 * size


def test_accelerations_are_those_in_space() -> None:
    """What nothing holds has none until it is struck; its history shows the ground's motion."""
    scene = replace(bridge(0.3, PULSE, OTHER), springs=(), dashpots=(), contacts=())
    h = run(scene, 2.0).history
    assert np.abs(h.a).max() <= 1e-12 * 5.0
    assert np.abs(h.ground - PULSE.acceleration(h.t)).max() <= 1e-14
    assert np.abs(h.u[:, 0] + PULSE.displacement(h.t)).max() <= 1e-9


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_deck_that_turns_too_far_ends_the_run(solver: str) -> None:
    deck = Deck("D", "1200 t", "40 m", "12 m", "20 deg")
    scene = Scene(deck.bodies(DeckStart(spin=0.1)), decks=[deck])
    with pytest.raises(ComputationError, match=r"turned by more than 0\.2 rad") as caught:
        solver_named(solver).solve(
            Task(scene, 0.0, 9.0, 1e-9, output_times=np.linspace(0.0, 9.0, 91))
        )
    assert not caught.value.recording.success
    assert caught.value.time == pytest.approx(2.1, abs=0.11)
    response = response_of(scene, solver, duration=1.0, output_step=0.1)
    assert "more than 0.05" in response.warnings[0]
