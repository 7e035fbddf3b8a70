"""Tolerances follow each body: a stiff one beside a soft one is as accurate as alone."""

import math
from dataclasses import replace

import numpy as np
import pytest

from eventpound.mechanics.link_law import LinkLaw
from eventpound.mechanics.model import assemble
from eventpound.motion.harmonic import Harmonic
from eventpound.motion.pulses import Sine
from eventpound.motion.record import Record
from eventpound.scene import GROUND, Body, BoucWen, Contact, Dashpot, Linear, Scene, Spring
from eventpound.simulation import response_of
from eventpound.solvers.base import Task
from eventpound.solvers.events.scales import (
    SPARE,
    Attached,
    InitialState,
    SceneScales,
    attached,
    own_scales,
    scene_scales,
    tolerances,
)
from tests.properties.transforms import scaled
from tests.solvers.scenes import pounding_pair

A, OMEGA = 3.0, 2.0 * math.pi
"""Amplitude (m/s²) and frequency (rad/s) of the pulses; the masses here are 1 kg."""
LENGTH, TIME = A / OMEGA**2, 1.0 / OMEGA
GROWTH = 20.0
"""Units of rtol of the own motion that a solver may err by in each radian of a vibration."""


def _beside_a_soft_one(omega: float) -> Scene:
    """An undamped body of that frequency (rad/s), and another of 1 rad/s, far apart."""
    springs = (
        Spring("s", (GROUND, "stiff"), Linear(omega**2)),
        Spring("t", (GROUND, "soft"), Linear(1.0)),
    )
    return Scene((Body("stiff", 1.0), Body("soft", 1.0)), springs, motion=Sine(A, 1.0))


def _scales(scene: Scene) -> SceneScales:
    return scene_scales(scene, assemble(scene), 1.0)


@pytest.mark.parametrize("rtol", [1e-6, 1e-9])
@pytest.mark.parametrize("omega", [1e2, 1e3])
def test_a_stiff_body_beside_a_soft_one(solver, omega, rtol):
    """``u'' + ω² u = -a sin Ωt``, to a part of its own motion."""
    recording = response_of(_beside_a_soft_one(omega), solver, rtol, duration=0.9).recording
    c, t = -A / (omega**2 - OMEGA**2), 0.9
    u = c * (math.sin(OMEGA * t) - OMEGA / omega * math.sin(omega * t))
    v = c * OMEGA * (math.cos(OMEGA * t) - math.cos(omega * t))
    allowed = GROWTH * rtol * max(omega * t, 10.0)
    assert abs(recording.u[0] - u) <= allowed * abs(c)
    assert abs(recording.v[0] - v) <= allowed * abs(c) * omega


def test_a_stiff_body_under_a_record(solver):
    """Its motion drowns in the rounding of a frame that moves with the ground."""
    rng = np.random.default_rng(3)
    record = Record(np.cumsum(rng.normal(size=100)), 0.01, pga=A)
    scene = replace(_beside_a_soft_one(1e4), motion=record)
    truth = response_of(scene, "fast", 1e-14, duration=0.5).recording
    found = response_of(scene, solver, 1e-9, duration=0.5).recording
    static = A / 1e8
    assert abs(found.u[0] - truth.u[0]) <= GROWTH * 1e-9 * 1e4 * static


def test_what_carries_a_load():
    """Springs, yielded or not, and dashpots; never more than the scene's own scales."""
    strong = BoucWen(10.0, 50.0 * A, 1e-3)
    weak = BoucWen(1e3, 0.5 * A, 1e-3)
    bodies = tuple(Body(name, 1.0) for name in ("linear", "strong", "weak", "free", "damped"))
    springs = (
        Spring("a", (GROUND, "linear"), Linear(1e6)),
        Spring("b", ("strong", GROUND), strong),
        Spring("c", (GROUND, "weak"), weak),
    )
    scene = Scene(bodies, springs, (Dashpot((GROUND, "damped"), 1e3),), motion=Harmonic(A, 1.0))
    own = _scales(scene)
    load = SPARE * A
    reach = np.array([load / 1e6, load / (10.0 + 5e4 * A), (load - 0.5 * A) / 1e3])
    np.testing.assert_allclose(own.own_length, [*reach, LENGTH, LENGTH])
    np.testing.assert_allclose(own.own_speed, [*np.sqrt(load * reach), LENGTH / TIME, load / 1e3])


def test_energy_limits_free_motion():
    """The time of the stiffest body is that of the scene; the others' speeds do not follow it."""
    springs = (
        Spring("s", (GROUND, "stiff"), Linear(1e8)),
        Spring("t", (GROUND, "soft"), Linear(1.0)),
    )
    scene = Scene((Body("stiff", 1.0), Body("soft", 4.0, 1.0)), springs)
    own = _scales(scene)
    assert own.speed == pytest.approx(1e4)
    np.testing.assert_allclose(own.own_length, [1e-4, 1.0])
    np.testing.assert_allclose(own.own_speed, [1.0, 0.5])


def test_ordinary_scenes_keep_the_scales_of_the_scene():
    own = _scales(pounding_pair())
    np.testing.assert_array_equal(own.own_length, own.length)
    np.testing.assert_array_equal(own.own_speed, own.speed)


@pytest.mark.parametrize("omega", [1e2, 1e4])
def test_units_do_not_matter(omega):
    scene = _beside_a_soft_one(omega)
    one, other = _scales(scene), _scales(scaled(scene, 1e3, 1e-2, 1e5)[0])
    np.testing.assert_allclose(other.own_length / other.length, one.own_length / one.length)
    np.testing.assert_allclose(other.own_speed / other.speed, one.own_speed / one.speed)


def test_a_tolerance_that_is_given_is_that_of_every_body():
    scene = _beside_a_soft_one(1e3)
    given = tolerances(Task(scene, 0.0, 1.0, 1e-6, {"velocity": 1e-5}), _scales(scene))
    np.testing.assert_array_equal(given["velocity"], [1e-5, 1e-5])
    np.testing.assert_allclose(given["displacement"], [1e-6 * SPARE * A / 1e6, 1e-6 * LENGTH])


@pytest.mark.parametrize("rtol", [1e-12])
def test_impacts_and_rests_of_a_stiff_body(solver, rtol):
    """A soft body thrown at a stiff one: the contact opens where the stiff one lets go.

    Struck without restitution both go on as one on both springs, at first with the speed that
    momentum leaves them, until the contact force ``λ = m u'' + k u`` of the soft body vanishes.
    """
    omega, speed = 1e4, 0.3
    bodies = (Body("stiff", 1.0), Body("soft", 1.0, 0.0, -speed))
    springs = (Spring("s", (GROUND, "stiff"), Linear(omega**2)),)
    scene = Scene(bodies, springs, (), (Contact("c", "stiff", "soft", 0.0, 0.0),))
    recording = response_of(scene, solver, rtol, duration=0.01).recording
    together = omega / math.sqrt(2.0)
    rest = float(recording.resting_time[0])
    # Both swing back through zero, where the force changes sign.
    assert rest == pytest.approx(math.pi / together, rel=1e3 * rtol)
    assert recording.v[1] == pytest.approx(0.5 * speed, rel=1e3 * rtol)


def test_rows_of_many_are_what_each_is_alone():
    """To the last bit, with what differs in a leading axis."""
    stiffness = np.geomspace(1.0, 1e8, 9)
    mass = np.geomspace(1e-3, 1e3, 9)
    scene = _beside_a_soft_one(1.0)
    model = assemble(scene)
    law = attached(model)
    columns = {
        key: np.tile(getattr(law, key), (9, 1)) for key in ("compression", "extension", "offset")
    }
    columns["compression"][:, 0] = columns["extension"][:, 0] = stiffness
    laws = LinkLaw(*(np.repeat(x[None], 9, axis=0) for x in law.law))
    links = Attached(law.ends, laws, **columns, weights=law.weights)
    masses = np.column_stack((mass, np.ones(9)))
    still = np.zeros((9, 2))
    start = InitialState(still, still, np.zeros((9, 0)), model.hysteretic)
    scales = (np.full(9, x) for x in (LENGTH, TIME, LENGTH / TIME**2))
    length, speed = own_scales(links, masses, start, *scales, np.ones(9, bool))
    for i in range(9):
        own = replace(
            scene,
            bodies=(replace(scene.bodies[0], mass=mass[i]), scene.bodies[1]),
            springs=(replace(scene.springs[0], law=Linear(stiffness[i])), scene.springs[1]),
        )
        alone = _scales(own)
        np.testing.assert_array_equal(length[i], alone.own_length)
        np.testing.assert_array_equal(speed[i], alone.own_speed)
