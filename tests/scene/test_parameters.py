"""Keys of the numbers of a scene, other scenes with them, and variants in doubt."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from eventpound.errors import InputError
from eventpound.motion import Record, Sine
from eventpound.scene import (
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Linear,
    Scene,
    Series,
    Spring,
)
from eventpound.scene.check import scene_problems
from eventpound.scene.doubt import doubtful
from eventpound.scene.parameters import places_of, value_at, with_values

SCENE = Scene(
    bodies=(Body("a", 1.0), Body("b.1", 2.0)),
    springs=(
        Spring("s", ("ground", "a"), BoucWen(1.0, 2.0, 0.1, initial_z=0.2)),
        Spring("stop", ("a", "b.1"), Series((Linear(3.0), BilinearElastic(0.0, 4.0, 0.1)))),
    ),
    dashpots=(Dashpot(("ground", "a"), 0.1), Dashpot(("ground", "a"), 0.2)),
    contacts=(Contact("c", "a", "b.1", 0.01, 0.5), Contact("wall", "barrier", "a", 0.1, 1.0)),
    motion=Sine(5.0, 6.0),
)
PLACES = places_of(SCENE)


def test_every_number_has_a_key():
    assert {key: value_at(SCENE, place) for key, place in PLACES.items()} == {
        "body.a.mass": 1.0,
        "body.a.displacement": 0.0,
        "body.a.velocity": 0.0,
        "body.b.1.mass": 2.0,
        "body.b.1.displacement": 0.0,
        "body.b.1.velocity": 0.0,
        "spring.s.stiffness": 1.0,
        "spring.s.strength": 2.0,
        "spring.s.yield_displacement": 0.1,
        "spring.s.exponent": 20.0,
        "spring.s.beta": 0.5,
        "spring.s.gamma": 0.5,
        "spring.s.initial_z": 0.2,
        "spring.stop.parts.1.stiffness": 3.0,
        "spring.stop.parts.2.compression": 0.0,
        "spring.stop.parts.2.extension": 4.0,
        "spring.stop.parts.2.offset": 0.1,
        "dashpot.ground-a.coefficient": 0.1,
        "dashpot.ground-a.2.coefficient": 0.2,
        "contact.c.gap": 0.01,
        "contact.c.restitution": 0.5,
        "contact.wall.gap": 0.1,
        "contact.wall.restitution": 1.0,
        "excitation.amplitude": 5.0,
        "excitation.period": 6.0,
        "excitation.start": 0.0,
    }


@pytest.mark.parametrize("key", PLACES)
def test_a_number_is_changed_and_no_other(key):
    changed = with_values(SCENE, {PLACES[key]: 0.75})
    for other, place in PLACES.items():
        assert value_at(changed, place) == (0.75 if other == key else value_at(SCENE, place))


def test_a_record_keeps_its_mean_period():
    record = Record(np.sin(0.3 * np.arange(400)), 0.02)
    scene = replace(SCENE, motion=record)
    places = places_of(scene)
    assert record.mean_period == record.mean_period
    louder = with_values(scene, {places["excitation.scale"]: 3.0}).motion
    slower = with_values(scene, {places["excitation.time_step"]: 0.04}).motion
    for motion in (louder, slower):
        assert isinstance(motion, Record)
        fresh = Record(record.samples, motion.time_step)
        assert motion.mean_period == fresh.mean_period


EDGES = (-np.inf, -1.0, -1e-300, 0.0, 1e-300, 0.2, 0.5, 1.0, 1.0 + 1e-15, 1.5, 40.0, 1e300)


@pytest.mark.parametrize("key", [key for key in PLACES if not key.startswith("excitation")])
def test_variants_without_doubt_have_no_problems(key):
    column = np.array(EDGES)
    doubt = doubtful(SCENE, {PLACES[key]: column}, column.size)
    for value, doubted in zip(column, doubt, strict=True):
        problems = scene_problems(with_values(SCENE, {PLACES[key]: value}))
        assert doubted or not problems
        # In doubt without need: within 1e-12 of the bound of z, 1, and where a gap is rounding.
        at_bound = key.endswith("initial_z") and abs(abs(value) - 1.0) < 1e-12
        at_bound |= key.endswith(".gap") and abs(value) < 1e-16
        assert problems or not doubted or at_bound


def test_joint_conditions_are_seen():
    columns = {
        "spring.s.beta": np.array([0.5, 0.1, -0.6, 2.0]),
        "spring.s.exponent": np.array([1.0, 1.0, 3.0, 3.0]),
        "spring.s.initial_z": np.array([1.1, 1.1, 0.0, 0.7]),
    }
    doubt = doubtful(SCENE, {PLACES[k]: v for k, v in columns.items()}, 4)
    # Bounds 1, 1/0.6, none, 2.5^(-1/3) = 0.737.
    assert doubt.tolist() == [True, False, True, False]
    columns = {
        "body.a.displacement": np.array([0.0, 0.02, -0.05, -0.2]),
        "body.b.1.displacement": np.array([-0.005, 0.0, -0.1, 0.0]),
    }
    doubt = doubtful(SCENE, {PLACES[k]: v for k, v in columns.items()}, 4)
    assert doubt.tolist() == [False, True, True, True]


def test_a_motion_refuses_its_own_numbers():
    with pytest.raises(InputError, match="amplitude"):
        with_values(SCENE, {PLACES["excitation.amplitude"]: -1.0})
