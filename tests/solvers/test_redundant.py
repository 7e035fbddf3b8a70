"""Contacts whose forces are not unique decide nothing: a split body moves as the whole one."""

import math
from itertools import pairwise

import numpy as np
import pytest

from eventpound.motion.delayed import travelled
from eventpound.motion.pulses import Sine
from eventpound.scene import BARRIER, GROUND, Body, Contact, Linear, Scene, Spring
from eventpound.simulation import response_of
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task
from tests.solvers.random_scenes import driven_scene, random_scene


def _row(middle: dict[str, tuple[float, float]]) -> Scene:
    """Body A, bodies in the middle (mass, stiffness) side by side, body D, a barrier."""
    masses = {"A": (1.0, 1.5), **middle, "D": (2.0, 1.0)}
    bodies = tuple(Body(name, mass) for name, (mass, _) in masses.items())
    springs = tuple(
        Spring(f"s{name}", (GROUND, name), Linear(stiffness))
        for name, (_, stiffness) in masses.items()
    )
    pairs = [("A", name) for name in middle] + [(name, "D") for name in middle] + [("D", BARRIER)]
    contacts = tuple(Contact(a + b, a, b, 0.0, 0.4) for a, b in pairs)
    return Scene(bodies, springs, (), contacts, Sine(1.0, 2.0 * math.pi, reverse=True))


def test_two_halves_side_by_side_move_as_the_whole(solver):
    rtol = 1e-9
    whole = response_of(_row({"B": (1.0, 1.0)}), solver, rtol, duration=25.0)
    split = response_of(_row({"B": (0.5, 0.5), "C": (0.5, 0.5)}), solver, rtol, duration=25.0)
    for body in ("A", "B", "D"):
        wanted = whole.history[f"u.{body}"]
        # The two runs take the same steps; their difference is rounding through
        # some twenty events, far below the tolerance.
        assert abs(split.final[body]["u"] - whole.final[body]["u"]) < rtol * wanted.abs().max()
    assert not split.recording.unique_forces[:4].any()
    assert whole.recording.unique_forces.all()
    assert np.all(split.recording.history.contact_force > -1e-10)


def test_a_locked_row_is_pressed_as_little_as_may_be(solver):
    # Random masses and springs between two barriers without play, under a sine: nothing moves. Of
    # forces that balance springs and ground the smallest without a pull leave some contact none.
    dice = np.random.default_rng(7)
    names = [f"b{i}" for i in range(5)]
    bodies = tuple(Body(name, dice.uniform(0.5, 2.0), dice.normal()) for name in names)
    springs = tuple(
        Spring(f"s{i}", (first, second), Linear(dice.uniform(1.0, 9.0)))
        for i, (first, second) in enumerate(pairwise([GROUND, *names]))
    )
    place = [0.0, *(body.displacement for body in bodies), 0.0]
    contacts = tuple(
        Contact(f"c{i}", left, right, place[i] - place[i + 1], 0.5)
        for i, (left, right) in enumerate(pairwise([BARRIER, *names, BARRIER]))
    )
    scene = Scene(bodies, springs, (), contacts, Sine(3.0, 1.0))
    recording = response_of(scene, solver, 1e-9, duration=1.5, output_step=0.01).recording
    assert not recording.unique_forces.any()
    history = recording.history
    force = history.contact_force[history.t > 0.0]
    mass = np.array([body.mass for body in bodies])
    pull = np.diff(history.force[history.t > 0.0], append=0.0)
    wanted = history.ground[history.t > 0.0, None] * mass - pull
    size = np.abs(wanted).max()
    np.testing.assert_allclose(force[:, :-1] - force[:, 1:], wanted, atol=1e-12 * size)
    np.testing.assert_allclose(force.min(axis=1), 0.0, atol=1e-14 * size)
    assert force.min() >= 0.0


def test_a_contact_that_others_keep_closed_has_no_force_of_a_mode_before():
    # Two bodies without play between two barriers, locked after a cascade at the start.
    scene, end = random_scene(149)
    fast, wanted = (
        response_of(scene, solver, 1e-9, duration=end).recording for solver in ("fast", "cvode")
    )
    np.testing.assert_allclose(fast.max_force, wanted.max_force, rtol=1e-7)


@pytest.mark.parametrize("rtol", [1e-6, 1e-9])
def test_bodies_that_fill_a_moving_support_go_with_it(solver, rtol):
    # Three bodies without play between two walls of one support, which a spring and a force press
    # now to one side and now to the other: when one wall lets go the other has to take over.
    scene, end = driven_scene(200179)
    times = np.linspace(0.0, end, 201)
    recording = solver_named(solver).solve(Task(scene, 0.0, end, rtol, output_times=times))
    motion = scene.supports[0].motion
    assert motion is not None
    t = recording.history.t
    wall = travelled(motion, t)[0] - travelled(scene.motion, t)[0]
    wall -= wall[0]
    size = np.abs(wall).max()
    assert size > 0.5
    assert np.abs(recording.history.u - wall[:, None]).max() < 10.0 * rtol * size
    assert recording.smallest_gap.min() > -1e-12 * size
    assert recording.largest_gap.max() < 1e-12 * size
