"""A prepared scene gives with other numbers what a scene with these numbers gives by itself."""

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from eventpound import Case, InputError, Record, Scene, load_case, prepare, simulate, simulate_many
from eventpound.numerics.arrays import Floats
from eventpound.response import Response
from eventpound.scene import Body, Contact, Dashpot, Linear, Series, Spring
from eventpound.scene.parameters import number_places, with_values
from tests.benchmarks import yardsticks
from tests.models import CASES
from tests.solvers.scenes import pounding_pair

PAIR = pounding_pair()
P1 = yardsticks.load()["P1"].task.scene
RIDE = Record(np.sin(np.arange(120.0)), 0.05)
IN_SERIES = Series((Linear(30.0), Linear(50.0)))
OTHER_PAIR = replace(
    PAIR,
    motion=RIDE,
    springs=(*PAIR.springs[:1], Spring("two", ("ground", "b"), IN_SERIES)),
    dashpots=(*PAIR.dashpots, Dashpot(("ground", "a"), 0.2)),
)
BETWEEN = replace(P1, contacts=(*P1.contacts, Contact("left", "barrier", "body0", 0.0, 0.5)))
NUMBERS: list[tuple[Scene, str, dict[str, float]]] = [
    (P1, "fast", {"contact.contact0.gap": 0.41}),
    (P1, "fast", {"spring.spring0.strength": 0.3, "body.body0.mass": 1.2}),
    (P1, "fast", {"spring.spring0.exponent": 9.0, "spring.spring0.beta": 0.4}),
    (P1, "fast", {"excitation.amplitude": 1.3, "excitation.period": 5.0}),
    # Without play it is not the kernel of a single body that runs.
    (BETWEEN, "fast", {"contact.contact0.gap": 0.0}),
    (P1, "cvode", {"excitation.amplitude": 1.3, "contact.contact0.restitution": 0.2}),
    (PAIR, "fast", {"contact.joint.gap": 0.035, "body.a.displacement": 0.002}),
    (PAIR, "fast", {"spring.cable.extension": 70.0, "body.b.velocity": 0.1}),
    (PAIR, "fast", {"spring.frame b.initial_z": -0.2, "dashpot.a-b.coefficient": 0.3}),
    (PAIR, "cvode", {"contact.left.gap": 0.07}),
    (OTHER_PAIR, "fast", {"spring.two.parts.2.stiffness": 70.0, "excitation.scale": 1.5}),
    (OTHER_PAIR, "fast", {"dashpot.ground-a.2.coefficient": 0.9}),
]


def _with(scene: Scene, numbers: Mapping[str, float]) -> Scene:
    places = number_places(scene)
    return with_values(scene, {places[key]: value for key, value in numbers.items()})


def _numbers(response: Response) -> dict[str, object]:
    history = response.history
    return {
        **{name: v for name, v in response.numbers().items() if not name.startswith("seconds")},
        "events": response.recording.events,
        "steps": response.work.steps,
        "history": {name: history[name].tolist() for name in history},
    }


def assert_same(found: Response, alone: Response) -> None:
    ours, theirs = _numbers(found), _numbers(alone)
    assert ours.keys() == theirs.keys()
    for name, value in ours.items():
        np.testing.assert_equal(value, theirs[name], err_msg=name)
    assert found.scene == alone.scene or isinstance(found.scene.motion, Record)


@pytest.mark.parametrize(("scene", "solver", "numbers"), NUMBERS)
@pytest.mark.parametrize("length", [None, 4.0])
def test_the_same_as_a_scene_with_these_numbers(scene, solver, numbers, length):
    prepared = prepare(scene, solver, 1e-7, duration=length)
    for values in (numbers, {}, numbers):
        found = prepared.run(values)
        end = found.task.end
        alone = _with(scene, values)
        if length is None:
            assert end == simulate(alone, solver, 1e-7, output_step=1.0).task.end
        options = {"duration": end, "output_step": end, "error_estimate": False}
        # A new thread has nothing of earlier runs, like a new process.
        with ThreadPoolExecutor(1) as new:
            assert_same(found, new.submit(simulate, alone, solver, 1e-7, **options).result())


def test_responses_stay_what_they_are_when_the_next_run_is_made():
    prepared = prepare(PAIR, "fast", 1e-7, duration=5.0)
    gaps = [0.03, 0.05, 0.04]
    responses = [prepared.run({"contact.joint.gap": gap}) for gap in gaps]
    for gap, response in zip(gaps, responses, strict=True):
        fresh = prepare(PAIR, "fast", 1e-7, duration=5.0).run({"contact.joint.gap": gap})
        assert_same(response, fresh)
        assert response.scene.contacts[1].gap == gap


def test_threads_may_share_it():
    prepared = prepare(PAIR, "fast", 1e-7, duration=5.0)
    gaps = np.linspace(0.03, 0.06, 40)

    def peak(gap: float) -> float:
        return float(prepared.run({"contact.joint.gap": float(gap)}).peaks["max"].max())

    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(peak, gaps))
    assert found == [peak(gap) for gap in gaps]


def _variants(case: Case | Scene, parameters: dict[str, Floats], **options: object) -> None:
    many = simulate_many(case, parameters, rtol=1e-7, **options)
    prepared = prepare(case, "fast", 1e-7, **options)
    for i in range(2):
        found = prepared.run({key: float(column[i]) for key, column in parameters.items()})
        np.testing.assert_array_equal(found.recording.u, many.u[i])
        np.testing.assert_array_equal(
            found.recording.displacement.maximum, many.displacement.maximum[i]
        )
        assert found.recording.t == many.t[i]


def test_terms_and_cases_are_as_many_variants_have_them():
    _variants(P1, {"pi.delta": np.array([0.3, 0.6]), "excitation.period": np.array([5.0, 6.0])})
    _variants(load_case(CASES / "bridge-pulse"), {"contact.joint.gap": np.array([0.01, 0.02])})
    _variants(load_case(CASES / "elastoplastic-barrier"), {"pi.epsilon": np.array([0.3, 0.6])})


def test_texts_with_units_and_rows():
    prepared = prepare(P1, "fast", 1e-7, output_step="0.5 s")
    found = prepared.run({"contact.contact0.gap": "45 cm"})
    alone = simulate(
        _with(P1, {"contact.contact0.gap": 0.45}),
        "fast",
        1e-7,
        output_step=0.5,
        error_estimate=False,
    )
    assert_same(found, alone)


@pytest.mark.parametrize(
    "numbers",
    [
        {"body.a.mass": -1.0},
        {"body.a.mass": np.nan},
        {"contact.joint.gap": -0.5},
        {"body.b.displacement": -0.6},
        {"contact.joint.restitution": 1.5},
        {"spring.frame a.beta": -0.7, "spring.frame a.gamma": 0.1},
        {"spring.frame b.initial_z": 1.5},
        {"spring.frame a.strength": -1.0, "spring.frame a.yield_displacement": 0.0},
        {"excitation.amplitude": -1.0},
        {"excitation.period": np.inf},
    ],
)
def test_what_simulate_refuses_is_refused_in_the_same_words(numbers):
    prepared = prepare(PAIR, "fast", 1e-7, duration=5.0)
    prepared.run({"body.a.mass": 0.1, "contact.joint.restitution": 1.0})
    with pytest.raises(InputError) as alone:
        simulate(_with(PAIR, numbers), "fast", 1e-7, duration=5.0)
    with pytest.raises(InputError) as found:
        prepared.run(numbers)
    assert found.value.problems == alone.value.problems


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ({"contact.joint.gapp": 0.1}, "values: contact.joint.gapp: unknown key"),
        ({"contact.joint.gap": "1 kg"}, "values: contact.joint.gap"),
        ({"pi.nothing": 0.1}, "pi.nothing|Π-term 'nothing'"),
    ],
)
def test_unknown_numbers_are_refused(numbers, words):
    with pytest.raises(InputError, match=words):
        prepare(PAIR, "fast", duration=5.0).run(numbers)


def test_a_condition_of_two_numbers_is_asked_of_both():
    # Each is known to be good with the other's own number.
    scene = Scene((Body("a", 1.0, 0.2),), contacts=(Contact("c", "a", "barrier", 0.5, 0.7),))
    prepared = prepare(scene, "fast", duration=1.0)
    prepared.run({"body.a.displacement": 0.4})
    prepared.run({"contact.c.gap": 0.3})
    with pytest.raises(InputError, match="penetrated at the start"):
        prepared.run({"body.a.displacement": 0.4, "contact.c.gap": 0.3})
