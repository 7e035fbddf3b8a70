"""Laws whose time cannot be eliminated, on the fast solver: beside CVODE, in batches, at events."""

from dataclasses import replace

import numpy as np
import pytest

from eventpound import NoMotion, Response, simulate, simulate_many
from eventpound.scene import BARRIER, GROUND, Backfill, Body, Contact, Linear, Scene, Spring
from eventpound.scene.parameters import number_places, with_values
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task
from tests.solvers import test_backfill, test_degrading
from tests.solvers.random_scenes import driven_scene, random_scene, resting_scene
from tests.solvers.test_degrading import worn

SOIL, WORN = test_backfill.POUNDING, test_degrading.POUNDING
BOTH = replace(SOIL, springs=(*SOIL.springs, replace(WORN.springs[1], name="worn")))


def run(scene: Scene, end: float, solver: str = "fast", rtol: float = 1e-10, **more) -> Response:
    return simulate(scene, solver, rtol, duration=end, error_estimate=False, **more)


def soiled(scene: Scene, seed: int) -> Scene:
    """The scene with soil beside most bodies, or between them; some of it pushed in before."""
    rng, scales = np.random.default_rng([seed, 77]), scene.motion.scales()
    strength = scales.a_g if scales else rng.uniform(1.0, 5.0)
    period = scales.period if scales else rng.uniform(0.4, 2.0)
    length, springs = strength * (period / (2.0 * np.pi)) ** 2, []
    for i, body in enumerate(scene.bodies):
        if i > 0 and rng.random() < 0.4:
            continue
        inside = i + 1 < len(scene.bodies) and rng.random() < 0.3
        ends = (scene.bodies[i + 1].name if inside else GROUND, body.name)
        stiffness = body.mass * strength / length * 10.0 ** rng.uniform(-0.5, 1.5)
        force = body.mass * strength * 10.0 ** rng.uniform(-0.7, 0.5)
        gap = float(rng.choice([0.0, length * rng.uniform(0.0, 1.0)]))
        left = float(rng.choice([0.0, gap + length * rng.uniform(0.0, 0.5)]))
        law = Backfill(stiffness, force, float(rng.choice([0.5, 0.7, 1.0])), gap, left)
        springs.append(Spring(f"soil{i}", ends[:: int(rng.choice([1, -1]))], law))
    return replace(scene, springs=(*scene.springs, *springs))


@pytest.mark.parametrize("make", [random_scene, driven_scene, resting_scene])
@pytest.mark.parametrize("seed", range(1, 8))
def test_random_scenes_move_as_with_cvode(make, seed):
    scene, end = make(seed)
    scene = worn(soiled(scene, seed), seed)
    fast, cvode = (run(scene, end, solver, energy=True) for solver in ("fast", "cvode"))
    history = cvode.recording.history
    size = np.abs(history.u).max()
    # Impacts let errors of single steps grow.
    np.testing.assert_allclose(fast.recording.u, cvode.recording.u, rtol=0.0, atol=1e-6 * size)
    of_z = 1e-5 * np.maximum(1.0, np.abs(history.z).max(axis=0, initial=0.0))
    assert np.all(np.abs(fast.recording.z - cvode.recording.z) <= of_z)
    assert abs(fast.energy.closure) < 1e-9


@pytest.mark.parametrize("scene", [SOIL, WORN, BOTH], ids=["soil", "worn", "both"])
def test_extremes_rows_and_events_are_those_of_cvode(scene):
    fast, cvode = (run(scene, 5.0, solver, 1e-11, output_step=0.5) for solver in ("fast", "cvode"))
    np.testing.assert_allclose(fast.peaks, cvode.peaks, rtol=1e-7, atol=1e-8)
    # Rounding decides whether soil touched for the first time has something to be inside of.
    rows = [r.recording.history for r in (fast, cvode)]
    at = [[np.flatnonzero(h.t == t)[0] for t in 0.5 * np.arange(1, 10)] for h in rows]
    for column in ("u", "v", "z"):
        mine, other = (getattr(h, column)[i] for h, i in zip(rows, at, strict=True))
        np.testing.assert_allclose(mine, other, rtol=0.0, atol=1e-8)
    times = [[event.t for event in r.recording.events] for r in (fast, cvode)]
    assert len(times[0]) > 3
    np.testing.assert_allclose(*times, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("scene", [SOIL, WORN, BOTH], ids=["soil", "worn", "both"])
def test_errors_follow_the_tolerance(scene):
    exact = run(scene, 3.0, rtol=1e-14).recording
    for rtol in (1e-5, 1e-7, 1e-9, 1e-11):
        found = run(scene, 3.0, rtol=rtol).recording
        assert np.abs(found.u - exact.u).max() < 10.0 * rtol
        assert np.abs(found.z - exact.z).max() < 1e3 * rtol


def changed(scene: Scene, numbers: dict[str, list[float]], i: int) -> Scene:
    places = number_places(scene)
    return with_values(scene, {places[key]: values[i] for key, values in numbers.items()})


NUMBERS = {
    "soil": (SOIL, {
        "spring.left.ultimate_force": [3.0e6, 5.0e6, 8.0e6], "spring.left.gap": [0.01, 0.02, 0.03],
        "spring.far.initial_gap": [0.0, 0.03, 0.05], "body.deck.displacement": [0.0, 0.001, -0.025],
    }),
    "worn": (WORN, {
        "spring.pier.strength_degradation": [0.0, 0.1, 0.4], "body.deck.mass": [1e6, 9e5, 8e5],
        "spring.pier.yield_displacement": [0.01, 0.012, 0.02],
        "spring.far.initial_loss": [0.0, 1.0, 2.0], "spring.far.initial_z": [0.0, 0.3, -0.4],
    }),
}  # fmt: skip


@pytest.mark.parametrize("which", NUMBERS)
def test_variants_are_single_runs_to_the_last_bit(which):
    scene, numbers = NUMBERS[which]
    many = simulate_many(scene, numbers, duration=3.0, rtol=1e-8)
    task = Task(scene, 0.0, 3.0, 1e-8)
    ready = solver_named("fast").ready(task)
    for i in range(3):
        one = run(changed(scene, numbers, i), 3.0, rtol=1e-8).recording
        values = {number_places(scene)[key]: column[i] for key, column in numbers.items()}
        again = ready.run(values, task)()
        for u, z in ((many.u[i], many.z[i]), (again.u, again.z)):
            np.testing.assert_array_equal(u, one.u)
            np.testing.assert_array_equal(z, one.z)


def test_laws_of_scenes_that_differ_in_them_alone_are_not_confused():
    spring = Spring("s", (GROUND, "deck"), Backfill("100 MN/m", "5 MN", 0.7))
    soil = Scene((Body("deck", 1e6, velocity=-1.0),), (spring,), motion=NoMotion())
    plain = replace(soil, springs=(replace(spring, law=test_degrading.PLAIN),))
    before = [run(scene, 1.0).recording.u for scene in (soil, plain)]
    np.testing.assert_array_equal(run(soil, 1.0).recording.u, before[0])
    np.testing.assert_allclose(before[1], run(plain, 1.0, "cvode").recording.u, rtol=1e-8)


def test_soil_touched_as_bodies_meet_and_left_at_once_is_none():
    soil = Spring("soil", ("a", "b"), Backfill(1e3, 10.0, 0.7))
    scene = Scene(
        (Body("a", 1.0, velocity=1.0), Body("b", 1.0)),
        (soil, Spring("s", (GROUND, "b"), Linear(40.0))),
        contacts=(Contact("joint", "a", "b", 0.0, 0.5), Contact("wall", "b", BARRIER, 0.1, 0.5)),
        motion=NoMotion(),
    )
    for solver in ("fast", "cvode"):
        gap = run(scene, 2.0, solver).quantity("springs.soil.residual_gap")
        assert gap == pytest.approx(0.0, abs=1e-12)
