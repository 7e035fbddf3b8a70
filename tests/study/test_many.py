"""Many variants in one call give what each gives by itself, to the last bit."""

from dataclasses import replace

import numpy as np
import pytest

from eventpound import BatchResponse, Case, Response, load_case, simulate, simulate_many
from eventpound.case.run_options import RunOptions
from eventpound.case.solver_options import SolverOptions
from eventpound.errors import ComputationError, InputError
from eventpound.motion import Cosine, Harmonic, Record
from eventpound.numerics.arrays import Floats
from eventpound.scene import (
    BARRIER,
    GROUND,
    BilinearElastic,
    Body,
    Contact,
    Dashpot,
    Linear,
    Scene,
    Series,
    Spring,
)
from eventpound.scene.parameters import number_places, with_values
from eventpound.solvers.base import Extremes
from eventpound.solvers.fast import many as fast_many
from eventpound.solvers.fast.advance import advance
from eventpound.solvers.fast.many import run_rows, run_sdof_rows
from eventpound.solvers.fast.sdof.oscillator import oscillate
from tests.benchmarks import yardsticks
from tests.models import CASES
from tests.solvers.random_scenes import random_scene
from tests.solvers.scenes import pounding_pair

YARDSTICKS = yardsticks.load()
RNG = np.random.default_rng(5)


def variant(scene: Scene, parameters: dict[str, Floats], i: int) -> Scene:
    places = number_places(scene)
    return with_values(scene, {places[key]: float(v[i]) for key, v in parameters.items()})


def same(found: Extremes, of: Extremes, i: int) -> bool:
    pairs = (
        (found.maximum, of.maximum),
        (found.time_of_maximum, of.time_of_maximum),
        (found.minimum, of.minimum),
        (found.time_of_minimum, of.time_of_minimum),
    )
    return all(np.array_equal(many[i], one) for many, one in pairs)


def assert_identical(result: BatchResponse, i: int, alone: Response) -> None:
    one = alone.recording
    assert result.success[i]
    assert result.t[i] == one.t
    assert result.steps[i] == one.work.steps
    assert np.array_equal(result.u[i], one.u)
    assert np.array_equal(result.v[i], one.v)
    assert np.array_equal(result.z[i], one.z)
    assert same(result.displacement, one.displacement, i)
    assert same(result.elongation, one.elongation, i)
    assert np.array_equal(result.smallest_gap[i], one.smallest_gap)
    assert one.largest_gap is not None
    assert np.array_equal(result.largest_gap[i], one.largest_gap)
    assert np.array_equal(result.resting_time[i], one.resting_time)
    assert result.impacts[i].sum() == alone.impacts
    if result.acceleration is not None and result.base_shear is not None:
        assert same(result.acceleration, one.acceleration, i)
        assert same(result.base_shear, one.base_shear, i)


def spread(**columns: tuple[float, float]) -> dict[str, Floats]:
    """Columns of 40 random values between two bounds; ``__`` stands for a dot."""
    return {k.replace("__", "."): RNG.uniform(*bounds, 40) for k, bounds in columns.items()}


def elastic_pair() -> Scene:
    """A series spring, a kink and two dashpots beside one link, under nothing but a push."""
    stop = Series((Linear(40.0), BilinearElastic(90.0, 0.0, 0.01)))
    return Scene(
        (Body("a", 1.0, 0.0, 0.4), Body("b", 2.0)),
        (Spring("s", (GROUND, "a"), Linear(30.0)), Spring("stop", ("b", GROUND), stop)),
        (Dashpot(("a", GROUND), 0.2), Dashpot((GROUND, "a"), 0.1), Dashpot(("a", "b"), 0.3)),
        (Contact("joint", "a", "b", 0.02, 0.6),),
    )


P1, P5, PZ = (YARDSTICKS[name].task for name in ("P1", "P5", "PZ"))
SHAKEN = Record(yardsticks.record_samples()[:1600:4], 0.02)
SCENES: dict[str, tuple[Scene, float | None, dict[str, Floats]]] = {
    "strength": (P1.scene, P1.end, {"spring.spring0.strength": np.linspace(0.05, 2.0, 40)}),
    "accumulation and rest": (
        PZ.scene,
        PZ.end,
        {"contact.contact0.restitution": np.linspace(0.0, 1.0, 40)},
    ),
    "two bodies": (
        P5.scene,
        P5.end,
        spread(body__body0__mass=(0.3, 3.0), spring__spring1__yield_displacement=(0.01, 0.3)),
    ),
    "everything of a pair": (
        pounding_pair(),
        6.0,
        {
            "body.a.displacement": RNG.uniform(-0.05, 0.015, 40),
            "body.b.velocity": RNG.uniform(-0.3, 0.3, 40),
            "spring.frame a.stiffness": RNG.uniform(0.0, 40.0, 40),
            "spring.frame b.exponent": np.repeat([1.0, 2.5, 20.0, 35.0], 10),
            "spring.frame b.beta": np.tile([0.3, 0.5], 20),
            "spring.frame b.initial_z": RNG.uniform(-0.8, 0.8, 40),
            "spring.cable.extension": RNG.uniform(0.0, 90.0, 40),
            "spring.cable.offset": RNG.uniform(0.0, 0.03, 40),
            "dashpot.ground-a.coefficient": RNG.uniform(0.0, 0.5, 40),
            "contact.right.gap": RNG.uniform(0.03, 0.08, 40),
        },
    ),
    "period, default duration": (
        replace(P1.scene, motion=Cosine(1.0, 6.0)),
        None,
        spread(excitation__period=(4.0, 9.0), excitation__amplitude=(0.5, 2.0)),
    ),
    "a kink in some": (
        Scene(
            (Body("a", 1.0, 0.0, 0.4),),
            (Spring("s", (GROUND, "a"), BilinearElastic(20.0, 5.0, 0.01)),),
            contacts=(Contact("right", "a", BARRIER, 0.05, 0.6),),
            motion=Cosine(1.0, 1.0),
        ),
        4.0,
        {"spring.s.compression": np.where(np.arange(40) % 4 == 1, 5.0, RNG.uniform(1.0, 30.0, 40))},
    ),
    "two of which one has a kink in some": (
        replace(
            P5.scene,
            springs=(*P5.scene.springs, Spring("stop", (GROUND, "body0"), BilinearElastic(2, 2))),
        ),
        P5.end,
        {"spring.stop.compression": np.where(np.arange(40) % 4 == 1, 2.0, RNG.uniform(0.0, 5, 40))},
    ),
    "center": (pounding_pair(), 5.0, spread(excitation__center=(0.5, 2.0))),
    "record": (replace(P1.scene, motion=SHAKEN), 8.0, spread(excitation__scale=(0.3, 3.0))),
    "record, default duration": (
        replace(P1.scene, motion=SHAKEN),
        None,
        spread(excitation__pga=(0.3, 3.0), spring__spring0__stiffness=(0.5, 4.0)),
    ),
    "series and dashpots": (
        elastic_pair(),
        4.0,
        {
            "spring.stop.parts.2.compression": RNG.uniform(0.0, 200.0, 40),
            "spring.stop.parts.2.offset": RNG.uniform(-0.02, 0.02, 40),
            "dashpot.a-ground.coefficient": RNG.uniform(0.0, 1.0, 40),
            "dashpot.a-b.coefficient": RNG.uniform(0.0, 1.0, 40),
            "body.a.velocity": RNG.uniform(0.1, 1.0, 40),
        },
    ),
}


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("accelerations", [False, True])
def test_same_as_one_by_one(name, accelerations):
    scene, duration, parameters = SCENES[name]
    result = simulate_many(
        scene, parameters, duration=duration, accelerations=accelerations, workers=2
    )
    for i in range(0, 40, 3):
        alone = simulate(variant(scene, parameters, i), "fast", 1e-6, duration=duration)
        assert_identical(result, i, alone)


@pytest.mark.parametrize("seed", [255, 274, 505, 763, 891])
def test_no_variant_depends_on_those_before_it(seed):
    """Rows under a record in which a gap and a spring may be what a step ends with."""
    scene, duration = random_scene(seed)
    key = f"contact.{scene.contacts[0].name}.restitution"
    same_ones = {key: np.full(3, scene.contacts[0].restitution)}
    result = simulate_many(scene, same_ones, duration=duration, rtol=1e-8, workers=1)
    assert (result.steps == result.steps[0]).all()
    assert (result.u == result.u[0]).all()


def test_case_brings_its_options(tmp_path):
    run, options = RunOptions(0.5, 9.0, 0.1), SolverOptions("cvode", 1e-9, {"displacement": 1e-5})
    case = Case("", P1.scene, run, options, tmp_path, "", None, (), {})
    column = np.array([0.2, 0.4])
    for given, rtol in ((None, 1e-9), (1e-8, 1e-8)):
        result = simulate_many(case, {"body.body0.mass": column}, rtol=given)
        for i in range(2):
            scene = variant(P1.scene, {"body.body0.mass": column}, i)
            assert_identical(result, i, simulate(replace(case, scene=scene), "fast", rtol))
        assert (result.t == 0.5 + 9.0).all()


def test_failed_variant_is_marked_and_the_rest_kept():
    # Accelerations beyond the largest double.
    column = {"spring.s.stiffness": np.array([10.0, 1e308, 30.0])}
    scene = replace(elastic_pair(), motion=Cosine(1.0, 1.0))
    result = simulate_many(scene, column, duration=4.0)
    assert result.success.tolist() == [True, False, True]
    with pytest.raises(ComputationError) as error:
        simulate(variant(scene, column, 1), "fast", 1e-6, duration=4.0)
    assert result.message[1] == str(error.value)
    table = result.table
    numbers = table.drop(columns=[*column, "success", "message", "t_final", "work.steps"])
    assert numbers.loc[1].isna().all()
    assert numbers.loc[[0, 2]].notna().all(axis=None)
    for i in (0, 2):
        alone = simulate(variant(scene, column, i), "fast", 1e-6, duration=4.0)
        assert_identical(result, i, alone)


def test_scales_beyond_the_largest_double_are_a_failure_of_their_variant_only():
    speeds = {"body.a.velocity": np.array([0.1, 1e200, 0.3])}
    result = simulate_many(elastic_pair(), speeds, duration=4.0)
    assert result.success.tolist() == [True, False, True]
    assert "beyond" in result.message[1]
    assert np.isnan(result.u[1]).all()


@pytest.mark.parametrize("name", ["accumulation and rest", "everything of a pair", "two bodies"])
@pytest.mark.parametrize("at_once", [1, 16])
def test_numbers_of_contacts_are_those_of_one_by_one(name, at_once, monkeypatch):
    monkeypatch.setattr(fast_many, "LOGGED_AT_ONCE", at_once)
    scene, duration, parameters = SCENES[name]
    path = "contacts.<contact>.max_impulse"
    result = simulate_many(scene, parameters, duration=duration, quantities=[path], workers=2)
    own = [c for c in result.table.columns if c.startswith("contacts.")]
    assert len(own) == 15 * len(scene.contacts)
    assert result.impacts.sum() > 40
    for i in range(0, 40, 3):
        alone = simulate(variant(scene, parameters, i), "fast", 1e-6, duration=duration)
        found = alone.summary[own].astype(float)
        assert np.array_equal(result.table.loc[i, own].astype(float), found, equal_nan=True)


def test_many_events_run_by_themselves():
    # Some 600 bounces a minute between two barriers: more than there is room for at once.
    ball = Scene(
        (Body("ball", 1.0, 0.0, 1.0),),
        contacts=(
            Contact("left", BARRIER, "ball", 0.05, 1.0),
            Contact("right", "ball", BARRIER, 0.05, 1.0),
        ),
    )
    speeds = {"body.ball.velocity": np.array([0.5, 1.0])}
    result = simulate_many(ball, speeds, duration=60.0)
    # It meets a barrier after 0.05 m and then each 0.1 m; an impact at the end itself counts.
    assert abs(result.impacts.sum(axis=1) - [300, 600]).max() <= 1
    for i in range(2):
        assert_identical(result, i, simulate(variant(ball, speeds, i), "fast", 1e-6, duration=60.0))


def test_table_has_the_names_of_the_summary():
    scene, duration, parameters = SCENES["strength"]
    result = simulate_many(scene, parameters, duration=duration)
    table = result.table
    assert list(table.columns[:4]) == ["spring.spring0.strength", "success", "message", "t_final"]
    alone = simulate(variant(scene, parameters, 20), "fast", 1e-6, duration=duration)
    row = table.loc[20]
    for key, value in alone.peaks.loc["body0"].items():
        assert row[f"peaks.body0.{key}"] == value
    assert row["final.spring0.z"] == alone.final["spring0"]["z"]
    assert row["springs.spring0.ductility"] == row["peaks.body0.abs_max"] / 0.2
    assert row["impacts"] == row["contacts.contact0.impacts"] == alone.impacts


def test_progress_counts_to_the_end():
    scene, duration, parameters = SCENES["strength"]
    told: list[tuple[int, int]] = []
    simulate_many(
        scene, parameters, duration=duration, progress=lambda *counts: told.append(counts)
    )
    assert told == sorted(told)
    assert told[-1] == (40, 40)


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({"spring.spring0.strenght": [1.0]}, ["unknown key", "mean 'spring.spring0.strength'"]),
        ({"nothing": [1.0]}, ["unknown key", "accepted: body.body0.mass"]),
        ({"body.body0.mass": [1.0, 2.0], "contact.contact0.gap": [1.0]}, ["has 2", "has 1"]),
        ({"body.body0.mass": [1.0, np.nan]}, ["body.body0.mass", "nan"]),
        ({"body.body0.mass": np.array([1.0, np.inf])}, ["inf as value 1", "finite numbers"]),
        ({"body.body0.mass": [[1.0]]}, ["found [1.0]", "a number in kg"]),
        ({"body.body0.mass": np.array([[1.0]])}, ["shape (1, 1)", "a list of values"]),
        ({"body.body0.mass": 1.0}, ["found 1.0", "a list of values"]),
        ({"body.body0.mass": []}, ["has no values"]),
        ({"body.body0.mass": ["heavy"]}, ["heavy", "a number in kg"]),
        ({}, ["at least one key"]),
        ({"body.body0.mass": [1.0, 0.0]}, ["variant 1", "mass = 0.0", "a positive mass"]),
        ({"contact.contact0.restitution": [0.5, 1.5]}, ["variant 1", "a number from 0 to 1"]),
        ({"contact.contact0.gap": [0.5, -0.1]}, ["variant 1", "not penetrated"]),
        ({"spring.spring0.beta": [0.5, -0.5]}, ["variant 1", "beta + gamma > 0"]),
        ({"excitation.amplitude": [1.0, -1.0]}, ["variant 1", "amplitude = -1.0", "positive"]),
        ({"excitation.period": [1.0, 0.0]}, ["variant 1", "period = 0.0", "positive"]),
    ],
)  # fmt: skip
def test_wrong_parameters_are_refused_before_anything_runs(parameters, words):
    with pytest.raises(InputError) as error:
        simulate_many(P1.scene, parameters)
    assert len(error.value.problems) == 1
    for word in words:
        assert word in str(error.value)


def test_a_motion_that_cannot_be_is_refused():
    harmonic = replace(P1.scene, motion=Harmonic(1.0, 10.0, cycles=2.0))
    with pytest.raises(InputError, match=r"variant 1 .*cycles = 1e\+308"):
        simulate_many(harmonic, {"excitation.cycles": [2.0, 1e308]}, duration=1.0)


def test_nothing_is_compiled_anew_for_another_scene():
    # Arrays of another layout would be another type, and minutes of compilation.
    simulate(P1.scene, "fast", 1e-6, duration=1.0)
    simulate(P5.scene, "fast", 1e-6, duration=1.0)
    before = len(advance.signatures), len(oscillate.signatures)
    for name in ("strength", "everything of a pair", "record", "series and dashpots"):
        scene, duration, parameters = SCENES[name]
        simulate_many(scene, parameters, duration=duration)
    assert (len(advance.signatures), len(oscillate.signatures)) == before
    assert len(run_rows.signatures) == 1
    assert len(run_sdof_rows.signatures) == 1


def test_units_terms_and_the_same_without_contact():
    scene, duration, _ = SCENES["strength"]
    name = "free.peaks.body0.abs_max"
    axes = {"pi.delta": [0.1, 0.2], "spring.spring0.strength": ["1 N", "2 N"]}
    result = simulate_many(scene, axes, duration=duration, quantities=[name])
    assert result.table["pi.delta"].tolist() == [0.1, 0.2]
    gaps = result.parameters["contact.contact0.gap"]
    assert gaps[1] == pytest.approx(2.0 * gaps[0])
    for i in range(2):
        one = variant(scene, {k: v for k, v in result.parameters.items() if k[:2] != "pi"}, i)
        assert_identical(result, i, simulate(one, "fast", 1e-6, duration=duration))
        free = simulate(replace(one, contacts=()), "fast", 1e-6, duration=duration)
        assert result.further[name][i] == free.quantity("peaks.body0.abs_max")


def test_a_suite_is_refused():
    case = load_case(CASES / "figure-12")
    with pytest.raises(InputError, match="holds a suite of records"):
        simulate_many(case, {"contact.joint.gap": [0.01]})
