"""Moreau–Jean with Coulomb friction at contacts: closed forms, order, energy, refusals."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

from eventpound import ComputationError, Harmonic, InputError, simulate
from eventpound.scene import (
    BARRIER,
    Body,
    Contact,
    ContactLaw,
    Dashpot,
    Deck,
    Force,
    Linear,
    Point,
    Scene,
    Spring,
)
from eventpound.scene.deck import DeckStart
from eventpound.solvers import solver_named
from eventpound.solvers.base import Recording, Task
from tests.solvers.friction_scenes import (
    GRAVITY,
    MASS,
    block,
    corner_contacts,
    slid,
    slid_under,
    struck_corner,
)


def _run(scene: Scene, end: float, step: float) -> Recording:
    task = Task(scene, 0.0, end, 1e-9, settings={"time_step": step}, energy=True)
    return solver_named("moreau").solve(task)


@pytest.mark.parametrize(
    ("friction", "slope", "speed"),
    [(0.3, 0.1, 0.0), (0.3, 0.5, 0.0), (0.3, 0.1, 2.0), (0.3, 0.1, -2.0), (0.3, 0.5, -3.0)],
)
def test_a_block_on_a_slope(friction: float, slope: float, speed: float) -> None:
    exact = slid(friction, slope, speed, 1.0)
    drives, holds = GRAVITY * math.sin(slope), GRAVITY * friction * math.cos(slope)
    # There and back where it goes up first.
    way = abs(exact) if drives < holds else exact + speed**2 / (drives + holds) * (speed < 0.0)
    for step in (0.01, 0.001):
        recording = _run(block(friction, slope, speed), 1.0, step)
        # In the step in which it turns, friction is off by at most itself twice, and so the speed.
        assert abs(recording.u[0] - exact) <= 2.0 * holds * step + 1e-12
        assert abs(recording.energy.closure) < 1e-11
        assert recording.energy.friction == pytest.approx(recording.friction.work.sum())
        np.testing.assert_allclose(recording.friction.path, way, atol=3.0 * holds * step + 1e-12)


def test_a_shaken_block_sticks_and_slips() -> None:
    """Beside the balance of a sliding mass by tiny steps of its own; first order in h."""
    friction, amplitude, period = 0.2, 4.0, 0.8
    scene = block(friction, motion=Harmonic(amplitude, period))
    exact = slid_under(amplitude, period, friction * GRAVITY, 1.5)
    errors = [abs(_run(scene, 1.5, 0.01 / n).u[0] - exact) for n in (1, 4, 16)]
    assert errors[0] < 5e-3
    assert errors[2] < errors[0] / 4.0


@pytest.mark.parametrize("corner", range(6))
def test_one_corner_strikes(corner: int) -> None:
    rng = np.random.default_rng(corner)
    deck = Deck("B", MASS, rng.uniform(2.0, 6.0), rng.uniform(1.0, 4.0))
    friction, restitution = rng.uniform(0.1, 0.5), rng.uniform(0.0, 0.6)
    start = DeckStart((0.0, 0.0), (rng.uniform(-2.0, 2.0), -1.0), 0.0, rng.uniform(-0.1, 0.1))
    contacts = corner_contacts(deck, 1, friction, restitution)
    scene = Scene(deck.bodies(start), contacts=contacts, decks=[deck])
    recording = _run(scene, 0.01, 0.01)
    v = np.array([*start.velocity, start.spin])
    expected, (normal, tangential) = struck_corner(deck, v, friction, restitution)
    np.testing.assert_allclose(recording.v / [1.0, 1.0, deck.radius], expected, rtol=1e-10)
    np.testing.assert_allclose(recording.friction.impulse, normal, rtol=1e-10)
    np.testing.assert_allclose(recording.friction.tangential, abs(tangential), rtol=1e-10)
    inertia = np.array([deck.mass, deck.mass, deck.inertia_about_centre])
    lost = 0.5 * inertia @ (v**2 - expected**2)
    assert recording.energy.impact == pytest.approx(lost, rel=1e-9)


def test_without_friction_it_is_as_if_none_were_given() -> None:
    scene = block(0.3, motion=Harmonic(3.0, 0.5))
    smooth = replace(scene, contacts=[replace(c, friction=0.0) for c in scene.contacts])
    bare = [Contact(c.name, c.left, c.right, c.gap, c.restitution) for c in scene.contacts]
    one, other = _run(smooth, 0.5, 0.005), _run(replace(scene, contacts=bare), 0.5, 0.005)
    assert one.u.tobytes() == other.u.tobytes()
    # Nothing holds it: it stays where it is in space.
    ground = 3.0 * (0.5 / (2.0 * math.pi)) * 0.5
    assert one.u[0] == pytest.approx(-ground, rel=1e-3)


def test_what_gains_energy_ends_the_run() -> None:
    """Newton's law with friction, the corner far out and nearly elastic (found by search)."""
    deck = Deck("B", 1.0, 5.390649732448921, 3.721012615946246)
    start = DeckStart((0.0, 0.0), (0.72328432, -1.0), 0.0, 0.31032001)
    found = corner_contacts(deck, 1, 0.24545278407384907, 0.9930182703461161)
    scene = Scene(deck.bodies(start), contacts=found, decks=[deck])
    with pytest.raises(ComputationError, match=r"gains kinetic energy.*'c0' \(friction 0.245"):
        _run(scene, 0.01, 0.01)


@pytest.mark.parametrize("solver", ["ida", "penalty"])
def test_others_refuse(solver: str) -> None:
    with pytest.raises(InputError, match=r"friction \('c0', 'c1'\).*accepted: .*moreau"):
        simulate(block(0.3), solver, duration=0.1)


@pytest.mark.parametrize(
    ("contact", "said"),
    [
        (Contact("w", BARRIER, "a", 0.1, 0.5, friction=0.3), "0 but between places of decks"),
        (Contact("w", BARRIER, "a", 0.1, 0.5, friction=-0.3), "a number >= 0"),
        (
            Contact("w", BARRIER, "a", 0.1, 0.5, ContactLaw("kelvin-voigt", 1e6), friction=0.3),
            "friction is of newton's law",
        ),
    ],
)
def test_what_friction_asks_for(contact: Contact, said: str) -> None:
    scene = Scene(
        [Body("a", 1.0)], [Spring("k", ("ground", "a"), Linear(10.0))], contacts=[contact]
    )
    with pytest.raises(InputError, match=said):
        simulate(scene, "moreau", duration=0.1)


def test_points_and_forces_come_to_the_matrix_they_stand_for() -> None:
    """Springs and dashpots at points under constant forces: ``exp(A t)``, at second order."""
    names, mass = ["a", "b", "c"], np.array([2.0, 1.0, 3.0])
    rows = np.array([[1.0, 0.0, 0.0], [-0.4, -0.6, 1.0], [0.0, 0.7, 0.0]])
    k, c = np.array([900.0, 500.0, 700.0]), np.array([0.0, 8.0, 3.0])
    ends = [("ground", "a"), (Point({"a": 0.4, "b": 0.6}), "c"), ("ground", _high())]
    scene = Scene(
        [Body(name, m, 0.01 * i, 0.1) for i, (name, m) in enumerate(zip(names, mass, strict=True))],
        [Spring(f"s{i}", end, Linear(k[i])) for i, end in enumerate(ends)],
        [Dashpot(end, c[i]) for i, end in enumerate(ends) if c[i] > 0.0],
        forces=[Force("b", 4.0), Force("c", "-0.5 m/s^2")],
    )
    inverse = np.diag(1.0 / mass)
    A = np.zeros((7, 7))
    A[:3, 3:6] = np.eye(3)
    A[3:6, :3] = -inverse @ (rows.T * k) @ rows
    A[3:6, 3:6] = -inverse @ (rows.T * c) @ rows
    A[3:6, 6] = [0.0, 4.0, -0.5]
    start = np.array([0.0, 0.01, 0.02, 0.1, 0.1, 0.1, 1.0])
    exact = expm(A * 2.0) @ start
    errors = []
    for step in (4e-3, 2e-3):
        recording = _run(scene, 2.0, step)
        errors.append(np.abs(np.append(recording.u, recording.v) - exact[:6]).max())
        assert abs(recording.energy.closure) < 1e-12
    assert errors[1] < 1e-3
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)


def _high() -> Point:
    return Point({"b": 0.7, "ground": 0.3})
