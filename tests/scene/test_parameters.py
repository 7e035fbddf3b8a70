"""Keys of the numbers of a scene, other scenes with them, and which variants tell of all."""

from dataclasses import replace

import numpy as np
import pytest

from eventpound.errors import InputError
from eventpound.motion import Record, Sine
from eventpound.scene import (
    Backfill,
    BilinearElastic,
    Body,
    BoucWen,
    Contact,
    Dashpot,
    Linear,
    Scene,
    Series,
    Spring,
    Support,
)
from eventpound.scene.check import scene_problems
from eventpound.scene.parameters import number_places, value_at, with_values
from eventpound.study.checked_numbers import variants_to_check

SCENE = Scene(
    bodies=(Body("a", 1.0), Body("b.1", 2.0)),
    springs=(
        Spring("s", ("ground", "a"), BoucWen(1.0, 2.0, 0.1, initial_z=0.2)),
        Spring("soil", ("ground", "b.1"), Backfill(1.0, 2.0, 0.7, 0.02)),
        Spring("stop", ("a", "b.1"), Series((Linear(3.0), BilinearElastic(0.0, 4.0, 0.1)))),
    ),
    dashpots=(Dashpot(("ground", "a"), 0.1), Dashpot(("ground", "a"), 0.2)),
    contacts=(Contact("c", "a", "b.1", 0.01, 0.5), Contact("wall", "barrier", "a", 0.1, 1.0)),
    motion=Sine(5.0, 6.0),
)
PLACES = number_places(SCENE)


def test_every_number_has_a_key():
    numbers = {
        "body.a": {"mass": 1.0, "displacement": 0.0, "velocity": 0.0},
        "body.b.1": {"mass": 2.0, "displacement": 0.0, "velocity": 0.0},
        "spring.s": {"stiffness": 1.0, "strength": 2.0, "yield_displacement": 0.1, "exponent": 20.0,
                     "beta": 0.5, "gamma": 0.5, "initial_z": 0.2},
        "spring.soil": {"initial_stiffness": 1.0, "ultimate_force": 2.0, "failure_ratio": 0.7,
                        "gap": 0.02, "initial_gap": 0.0},
        "spring.stop.parts.1": {"stiffness": 3.0},
        "spring.stop.parts.2": {"compression": 0.0, "extension": 4.0, "offset": 0.1},
        "dashpot.ground-a": {"coefficient": 0.1},
        "dashpot.ground-a.2": {"coefficient": 0.2},
        "contact.c": {"gap": 0.01, "restitution": 0.5},
        "contact.wall": {"gap": 0.1, "restitution": 1.0},
        "excitation": {"amplitude": 5.0, "period": 6.0, "start": 0.0},
    }  # fmt: skip
    assert {key: value_at(SCENE, place) for key, place in PLACES.items()} == {
        f"{of}.{key}": value for of, keys in numbers.items() for key, value in keys.items()
    }


@pytest.mark.parametrize("key", PLACES)
def test_a_number_is_changed_and_no_other(key):
    changed = with_values(SCENE, {PLACES[key]: 0.75})
    for other, place in PLACES.items():
        assert value_at(changed, place) == (0.75 if other == key else value_at(SCENE, place))


def test_a_record_keeps_its_mean_period():
    record = Record(np.sin(0.3 * np.arange(400)), 0.02)
    scene = replace(SCENE, motion=record)
    places = number_places(scene)
    assert record.mean_period == record.mean_period
    louder = with_values(scene, {places["excitation.scale"]: 3.0}).motion
    slower = with_values(scene, {places["excitation.time_step"]: 0.04}).motion
    for motion in (louder, slower):
        fresh = Record(record.samples, motion.time_step)
        assert motion.mean_period == fresh.mean_period


EDGES = (-np.inf, -1.0, -1e-300, 0.0, 1e-300, 0.2, 0.5, 1.0, 1.0 + 1e-15, 1.5, 40.0, 1e300)


def problems_of(scene: Scene, columns: dict[str, np.ndarray], row: int) -> list:
    places = number_places(scene)
    return scene_problems(with_values(scene, {places[k]: v[row] for k, v in columns.items()}))


def told_of(scene: Scene, columns: dict[str, np.ndarray]) -> list[int]:
    """Variants that are looked at; where any is wrong one of them must be."""
    places, count = number_places(scene), len(next(iter(columns.values())))
    rows = variants_to_check(scene, {places[k]: v for k, v in columns.items()}, count).tolist()
    wrong = [row for row in range(count) if problems_of(scene, columns, row)]
    assert bool(wrong) == any(row in wrong for row in rows)
    return rows


@pytest.mark.parametrize("key", [key for key in PLACES if not key.startswith("excitation")])
@pytest.mark.parametrize("value", EDGES)
def test_a_wrong_variant_is_among_those_looked_at(key, value):
    fine = value_at(SCENE, PLACES[key])
    assert len(told_of(SCENE, {key: np.array([fine, fine, value, fine])})) <= 4


def test_conditions_of_several_numbers_are_seen():
    """Bounds of z of 1, 1/0.6, none and 0.737; gaps that are open only without the others' u."""
    shape = {
        "spring.s.beta": np.array([0.5, 0.1, -0.6, 2.0]),
        "spring.s.exponent": np.array([1.0, 1.0, 3.0, 3.0]),
        "spring.s.initial_z": np.array([1.1, 1.1, 0.0, 0.7]),
    }
    moved = {
        "body.a.displacement": np.array([0.0, 0.02, -0.05, -0.2]),
        "body.b.1.displacement": np.array([-0.005, 0.0, -0.1, 0.0]),
    }
    gaps = {
        # A gap of 0 is taken for that of the spring, so what lies between may be wrong alone.
        "spring.soil.initial_gap": np.array([0.3, 0.0, 0.1, 0.3]),
        "spring.soil.gap": np.array([0.2, 0.0, 0.2, 0.4]),
    }
    for columns in (shape, moved, gaps):
        for row in range(4):
            # Of two variants, neither of which has the extreme of any column by itself.
            told_of(SCENE, {key: v[[row, 1, 1, row]] for key, v in columns.items()})
    told_of(SCENE, {"spring.soil.initial_gap": np.array([0.0, 0.001, 0.3])})
    assert told_of(SCENE, {key: v[[0, 0, 2, 0, 0]] for key, v in moved.items()}) == [0, 2]


def test_on_supports_every_variant_is_looked_at():
    """Where a support is as a run begins depends on its delay and on the motion."""
    scene = replace(
        SCENE,
        supports=(Support("pier", delay=0.1),),
        contacts=(Contact("joint", "a", "pier", 0.01, 0.5),),
    )
    assert told_of(scene, {"contact.joint.gap": np.array([0.01, -0.02, 0.03])}) == [0, 1, 2]


def test_a_motion_refuses_its_own_numbers():
    with pytest.raises(InputError, match="amplitude"):
        with_values(SCENE, {PLACES["excitation.amplitude"]: -1.0})
