"""Poisson's law of impact with friction: closed forms, energy, and a program of SciPy alone."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eventpound import simulate
from eventpound.contact.poisson import compress_and_expand
from eventpound.errors import InputError
from eventpound.numerics.arrays import Floats
from eventpound.numerics.coulomb import ANSWERED, UNIQUE, Rubbing, solve_rubbing
from eventpound.scene import BARRIER, Contact, Deck, Scene
from eventpound.scene.deck import DeckStart
from eventpound.solvers import solver_named
from eventpound.solvers.base import Recording, Task
from eventpound.tolerances import QUIET
from tests.oracle.plan import Plan, plan_of, states
from tests.solvers.friction_scenes import MASS, block, corner_contacts, expanded_corner
from tests.solvers.test_friction import rubbing_plan, states_of

SOLVERS = ["cvode", "fast"]


def _run(scene: Scene, end: float, solver: str, **settings: object) -> Recording:
    times = np.linspace(0.0, end, 26)
    scene = replace(scene, impact_law="poisson")
    task = Task(scene, 0.0, end, 1e-12, output_times=times, energy=True, settings=settings)
    return solver_named(solver).solve(task)


def _struck(G: Floats, q: Floats, friction: Floats, restitution: Floats) -> tuple[Floats, Floats]:
    x, w, state = np.zeros(q.size), np.zeros(q.size), np.zeros(friction.size, np.int64)
    noise = np.full(q.size, QUIET * np.abs(q).max())
    problem = Rubbing(G, q, friction, np.zeros(friction.size, np.int64), noise)
    assert compress_and_expand(problem, restitution, x, w, state) in (UNIQUE, ANSWERED)
    return x, w


@pytest.mark.parametrize(("k", "problems"), [(1, 300), (2, 60), (3, 6)])
def test_beside_enumeration_and_without_a_gain(k: int, problems: int) -> None:
    rng = np.random.default_rng(k)
    pressed = 0
    for n in range(problems):
        # In directions that hang together less, or Painlevé's paradox is met.
        W = rng.normal(size=(2 * k, 2 * k + 1)) + np.eye(2 * k, 2 * k + 1)
        G, friction = W @ W.T, rng.uniform(0.0, 0.5, k) * (rng.random(k) < 0.8)
        v = -W.T @ np.linalg.solve(G, np.concatenate((rng.random(k), rng.normal(size=k))))
        q, ε = W @ v, rng.uniform(0.0, 1.0, k) if n % 2 else np.full(k, rng.random())
        x, w = _struck(G, q, friction, ε)
        plan = Plan(
            np.ones(v.size), *np.zeros((2, v.size, v.size)), np.zeros((v.size, 2)), W[:k], W[k:],
            np.zeros(k), ε, friction, (None, None), by_poisson=True,
        )  # fmt: skip
        np.testing.assert_allclose(w, W @ plan.impacts(np.zeros(v.size), v), atol=1e-11)
        # Momentum, and kinetic energy.
        np.testing.assert_allclose(w, q + G @ x, atol=1e-12)
        assert x @ q + 0.5 * x @ G @ x <= 1e-13 or n % 2
        pressed += (w[:k] < 1e-12).sum()
    # Where ε differs, one contact presses another together again.
    assert pressed > 0 or k == 1


def test_three_contacts_two_of_which_share_friction() -> None:
    """More than are gone through, and for some of these Lemke's method ends without an answer."""
    scene, joints, _ = rubbing_plan(88)
    plan = plan_of(replace(scene, impact_law="poisson"), joints)
    shut, speed = [2, 3, 5], 1e3 / np.sqrt(plan.mass)
    plan.gap[:], plan.gap[shut] = 1.0, 0.0
    rows, rng = np.vstack((plan.W[shut], plan.T[shut])), np.random.default_rng(0)
    G, rests, struck = rows / plan.mass @ rows.T, rows[2::3], 0
    for _ in range(40):
        v = rng.normal(size=speed.size) * speed
        v -= np.linalg.lstsq(rests, rests @ v, rcond=1e-12)[0]
        if (rows[:2] @ v < 0.0).all():
            struck += 1
            q = np.where(np.arange(6) != 2, rows @ v, 0.0)
            x, w = _struck(G, q, plan.friction[shut], plan.restitution[shut])
            expected = rows @ plan.impacts(np.zeros(v.size), v)
            np.testing.assert_allclose(w, expected, atol=1e-10 * np.abs(w).max())
            assert x @ rows @ v + 0.5 * x @ G @ x < 0.0
    assert struck > 10


def test_a_double_pendulum_gains_energy_by_newtons_law_and_loses_some_by_poissons() -> None:
    """Rods of 1 kg and 1 m at 20° and 30°, whose tip strikes a floor (as of Kane and Levinson)."""
    (s, t), (c, d) = np.sin(np.radians([20, 30])), np.cos(np.radians([20, 30]))
    coupled = 0.5 * math.cos(math.radians(10.0))
    M, W = np.array([[4.0 / 3.0, coupled], [coupled, 1.0 / 3.0]]), np.array([[s, t], [c, d]])
    v, friction, ε = np.array([-0.1, -0.2]), np.array([0.5]), np.array([0.5])
    G, q = W @ np.linalg.solve(M, W.T), W @ v
    by_newton, w, state = np.zeros(2), np.zeros(2), np.zeros(1, np.int64)
    asked = Rubbing(G, q * [1.0 + ε[0], 1.0], friction, np.zeros(1, np.int64), np.zeros(2))
    assert solve_rubbing(asked, by_newton, w, state) == UNIQUE
    by_poisson, _ = _struck(G, q, friction, ε)
    for x, part in ((by_newton, 0.5875), (by_poisson, -0.4551)):
        after = v + np.linalg.solve(M, W.T @ x)
        assert after @ M @ after / (v @ M @ v) - 1.0 == pytest.approx(part, abs=1e-4)
    # It slips backwards until it is compressed, and sticks in expansion.
    N = -q[0] / (G[0, 0] + 0.5 * G[0, 1])
    slip = q[1] + (G[1, 0] + 0.5 * G[1, 1]) * N
    T = 0.5 * N - (slip + G[1, 0] * ε[0] * N) / G[1, 1]
    np.testing.assert_allclose(by_poisson, [1.5 * N, T], rtol=1e-12)


@pytest.mark.parametrize("solver", [*SOLVERS, "moreau"])
@pytest.mark.parametrize("seed", range(6))
def test_one_corner_strikes(seed: int, solver: str) -> None:
    rng = np.random.default_rng(seed)
    deck = Deck("B", MASS, rng.uniform(2.0, 6.0), rng.uniform(1.0, 4.0))
    friction, restitution = rng.uniform(0.1, 0.5), rng.uniform(0.1, 1.0)
    start = DeckStart((0.0, 0.0), (rng.uniform(-2.0, 2.0), -1.0), 0.0, rng.uniform(-0.1, 0.1))
    scene = Scene(
        deck.bodies(start), contacts=corner_contacts(deck, 1, friction, restitution), decks=[deck]
    )
    recording = _run(scene, 0.01, solver, **({"time_step": 0.01} if solver == "moreau" else {}))
    v = np.array([*start.velocity, start.spin])
    expected, (normal, tangential) = expanded_corner(deck, v, friction, restitution)
    np.testing.assert_allclose(recording.v / [1.0, 1.0, deck.radius], expected, rtol=1e-11)
    event = recording.events[0]
    assert event.impulse == pytest.approx(normal, rel=1e-12)
    assert recording.friction is not None
    assert recording.friction.tangential[0] == pytest.approx(abs(tangential), rel=1e-11)
    inertia = np.array([deck.mass, deck.mass, deck.inertia_about_centre])
    assert event.energy_lost == pytest.approx(0.5 * inertia @ (v**2 - expected**2), rel=1e-10)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("speed", [0.1, 2.0])
def test_a_contact_below_the_centre_strikes_as_by_newtons_law(speed: float, solver: str) -> None:
    """Tangential impulses do not open it: it sticks, or slips all the time."""
    deck = Deck("B", MASS, 4.0, 2.0)
    wall = Contact("c", BARRIER, deck.toward((0.0, -1.0), (0.0, 1.0)), 0.01, 0.6, friction=0.4)
    start = DeckStart((0.0, 0.0), (speed, -1.0))
    scene = Scene(deck.bodies(start), contacts=[wall], decks=[deck])
    task = Task(scene, 0.0, 0.1, 1e-12)
    expected, found = solver_named(solver).solve(task), _run(scene, 0.1, solver)
    np.testing.assert_allclose(found.v, expected.v, rtol=1e-12, atol=1e-15)
    assert found.events[0].energy_lost == pytest.approx(expected.events[0].energy_lost, rel=1e-12)


@pytest.mark.parametrize("seed", [1, 3, 7, 16])
def test_random_decks_against_scipy(seed: int) -> None:
    scene, joints, end = rubbing_plan(seed)
    scene = replace(scene, impact_law="poisson")
    expected = states(scene, joints, np.linspace(0.0, end, 26))
    assert expected is not None
    size = np.maximum(np.abs(expected).max(axis=0), 1e-3)
    for solver in SOLVERS:
        recording = _run(scene, end, solver)
        assert (np.abs(states_of(recording, end) - expected) <= 1e-9 * size).all()
        assert abs(recording.energy.closure) < 1e-10


def test_what_it_asks_for(tmp_path: Path) -> None:
    rubs = replace(block(0.3), impact_law="poisson")
    with pytest.raises(
        InputError, match=r"ida does not take .* by poisson's law.*cvode, fast, mor"
    ):
        simulate(rubs, "ida", duration=0.1)
    with pytest.raises(
        InputError, match=r"impact_law: found 'poison'; accepted: one of newton, po"
    ):
        simulate(replace(rubs, impact_law="poison"), duration=0.1)
    with pytest.raises(InputError, match="accepted: newton where no contact has friction"):
        simulate(replace(block(0.0), impact_law="poisson"), duration=0.1)
