"""Whatever is given wrongly from Python is an InputError that names it."""

import inspect
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import eventpound
from eventpound import (
    Body,
    BoucWen,
    Contact,
    ContactLaw,
    Cosine,
    Dashpot,
    Force,
    InputError,
    Linear,
    Point,
    Record,
    Response,
    Scene,
    Series,
    Spring,
    Study,
    Support,
    load_case,
    rayleigh,
    simulate,
    simulate_many,
    verify,
)
from eventpound.case.record_options import RecordOptions
from eventpound.case.suite import Suite
from tests.models import ROOT

SCENE = Scene(
    [Body("deck", 1.3e6)],
    [Spring("pier", ("ground", "deck"), Linear(1e7))],
    contacts=[Contact("joint", "deck", "barrier", 0.01, 0.7)],
    motion=Cosine(3.9, 0.8),
)
PAIR = load_case(ROOT / "cases" / "pair")
SUITE = replace(PAIR, suite=Suite("*.AT2", (), RecordOptions()))
EXAMPLE = ROOT / "README.md"
OF_KIND = {
    "none": None,
    "truth": True,
    "number": 5,
    "text": "nonsense",
    "sequence": [1, [2]],
    "mapping": {"a": []},
    "object": object(),
    "class": Cosine,
}
"""Something of each kind."""
TAKEN = {
    "none": r"None|Optional",
    "truth": r"bool",
    "number": r"Number|float|int|Count|^_(Stiffness|Loss|Force)$|_Gaps",
    "text": r"^(str|Source)( \| None)?$|Path|GivenEnd\]$",
    "mapping": r"_Given\]$|FinalState|Mapping\[str, (object|str \| int)\]",
    "class": r"Reached|Counted|Keep|Report",
}
"""Where an argument says that it takes something of a kind, as it is annotated. Of a text, any."""
PULSE = {"amplitude": 1.0, "period": 1.0}
LAW = {"stiffness": 1.0, "strength": 1.0, "yield_displacement": 1.0}
DAMPED = {"bodies": SCENE.bodies, "springs": SCENE.springs, "ratio": 0.05}
ENDS = {"between": ("ground", "a")}
GAPS = {"contact.joint.gap": [0.01]}
OF_SCENE = {"case": SCENE}
RIGHT: Mapping[str, Mapping[str, Any]] = {
    "Body": {"name": "a", "mass": 1.0},
    "Linear": {"stiffness": 1.0},
    "BilinearElastic": {"compression": 1.0, "extension": 1.0},
    "Series": {"parts": ()},
    "Backfill": {"initial_stiffness": 2e7, "ultimate_force": 3e5, "failure_ratio": 0.7},
    "Backfill.of_wall": {"height": 2.0, "width": 9.0},
    "BoucWen": LAW,
    "DegradingBoucWen": LAW,
    "BoucWen.from_yield": {"initial_stiffness": 1.0, "yield_force": 1.0},
    "Slider": {"friction": 0.05, "normal_force": 1.0},
    "Slider.pendulum": {"friction": 0.05, "normal_force": 1.0, "radius": 2.0},
    "Spring": {"name": "s", "law": Linear(1.0)} | ENDS,
    "Dashpot": {"coefficient": 1.0} | ENDS,
    "Dashpot.from_ratio": {"ratio": 0.05, "stiffness": 1.0, "mass": 1.0} | ENDS,
    "Contact": {"name": "c", "left": "a", "right": "b", "gap": 0.0, "restitution": 0.5},
    "ContactLaw": {"kind": "hertz", "stiffness": 1e9},
    "Point": {"weights": {"a": 1.0}},
    "Deck": {"name": "d", "mass": 1.0, "length": 1.0, "width": 1.0},
    "Joint": {"name": "j", "between": ("d", "barrier"), "gap": 0.01, "restitution": 0.5},
    "Seat": {"name": "e"} | ENDS,
    "Support": {"name": "s"},
    "Force": {"body": "a", "history": 1.0},
    "Scene": {"bodies": SCENE.bodies},
    **dict.fromkeys(("Cosine", "Sine", "TypeC", "Harmonic", "Ricker"), PULSE),
    **dict.fromkeys(("AntisymmetricRicker", "MavroeidisPapageorgiou"), PULSE),
    "Record": {"samples": [0.0, 1.0], "time_step": 0.01},
    "read_record": {"path": "none.AT2"},
    "load_case": {"path": "none"},
    "simulate": OF_SCENE,
    "prepare": OF_SCENE,
    "sensitivities": OF_SCENE,
    "design_numbers": OF_SCENE,
    "verify": OF_SCENE,
    "simulate_many": {"case": SCENE, "parameters": GAPS},
    "simulate_suite": {"case": PAIR},
    "Study": {"case": SCENE, "axes": GAPS},
    "compare": {"case": PAIR, "solvers": ["fast"]},
    "rayleigh": DAMPED | {"modes": (1, 1)},
    "frame": {"name": "F", "stiffness": [[1e7]], "mass": [1e5]},
    "modal_damping": DAMPED,
    "stiffness_proportional": DAMPED | {"damped": ["pier"], "period": 1.0},
    "plot": {"source": "none", "directory": "none"},
    "write": {"response": object.__new__(Response), "directory": "none"},
}
"""Public names, or methods that make one, with a call that is right."""
NOT_CALLED = {
    *(name for name in eventpound.__all__ if name.endswith(("Error", "Warning"))),
    *("BatchResponse", "Case", "NoMotion", "Prepared", "Response", "StudyTable"),
}
"""What nobody makes by hand, and what takes no argument."""


def called(name: str) -> Callable[..., Any]:
    found: Any = eventpound
    for part in name.split("."):
        found = getattr(found, part)
    return found


def wrong_kinds(name: str) -> Iterator[tuple[str, str]]:
    """Arguments of a call, each with the kinds that it does not take."""
    for key, argument in inspect.signature(called(name)).parameters.items():
        unsaid = "none" if argument.default is None else ""
        for kind in OF_KIND:
            taken = kind in TAKEN and re.search(TAKEN[kind], argument.annotation)
            if not taken and kind != unsaid:
                yield key, kind


def test_every_public_name_is_in_the_table():
    assert {name.partition(".")[0] for name in RIGHT} | NOT_CALLED == set(eventpound.__all__)
    assert sum(1 for name in RIGHT for _ in wrong_kinds(name)) > 1000


def escaped(call: Callable[..., Any], key: str, arguments: Mapping[str, Any]) -> str:
    """What a wrong call ended in, empty where it is an InputError that names the argument."""
    try:
        call(**arguments)
    except InputError as error:
        return "" if key.removesuffix("s") in str(error) else f"InputError: {error}"
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return "accepted"


@pytest.mark.parametrize("name", RIGHT)
def test_an_argument_of_a_wrong_kind_is_an_input_error(name):
    found = {
        f"{key} = {OF_KIND[kind]!r}": outcome
        for key, kind in wrong_kinds(name)
        if (outcome := escaped(called(name), key, {**RIGHT[name], key: OF_KIND[kind]}))
    }
    assert not found


@pytest.fixture(scope="module")
def response():
    return simulate(SCENE, "fast", duration=0.1)


def record(*samples: Any, **numbers: Any) -> Record:
    return Record(samples, 0.01, **numbers)


IMPOSSIBLE: dict[str, Callable[[], Any]] = {
    "a mass beyond doubles": lambda: Body("a", 10**400),
    "a mass in metres": lambda: Body("a", "1301 m"),
    "a body among springs": lambda: Scene([Body("a", 1.0)], [Body("b", 1.0)]),
    "a spring of one end": lambda: Spring("s", ["ground"], Linear(1.0)),
    "a spring of three ends": lambda: Spring("s", ["ground", "a", "b"], Linear(1.0)),
    "a dashpot of negative mass": lambda: Dashpot.from_ratio(("ground", "a"), 0.05, 1.0, -1.0),
    "a yield force of zero": lambda: BoucWen.from_yield(1.0, 0.0),
    "a point of three": lambda: Point([("a", 0.5, 0.5)]),
    "a record of texts": lambda: record("a", "b"),
    "a record of one sample": lambda: record(1.0),
    "a record of rows": lambda: record([1.0, 2.0], [3.0, 4.0]),
    "a record of ragged rows": lambda: record([1.0, 2.0], [3.0]),
    "a record that is not finite": lambda: record(0.0, np.nan),
    "a record of two sizes": lambda: record(0.0, 1.0, pga="0.3 g", scale=2.0),
    "an endless run": lambda: simulate(Scene([Body("a", 1.0)])),
    "rows without number": lambda: simulate(SCENE, output_step=1e-12),
    "a run of no time": lambda: simulate(SCENE, duration=1e-200),
    "a tolerance of one": lambda: simulate(SCENE, rtol=1.0),
    "a tolerance that is not finite": lambda: simulate(SCENE, rtol=float("nan")),
    "a time in newtons": lambda: simulate(SCENE, duration="3 kN"),
    "no steps": lambda: simulate(SCENE, max_steps=0),
    "a setting of a number": lambda: simulate(SCENE, settings={5: 1}),
    "a setting that is a list": lambda: simulate(SCENE, settings={"method": []}),
    "a solver that there is not": lambda: simulate(SCENE, "nope"),
    "no variants": lambda: simulate_many(SCENE, {}),
    "variants of a text": lambda: simulate_many(SCENE, {"contact.joint.gap": "abc"}),
    "variants of a number": lambda: simulate_many(SCENE, {5: [1.0]}),
    "variants in a table": lambda: simulate_many(SCENE, {"contact.joint.gap": [[1.0]]}),
    "a negative number of threads": lambda: simulate_many(
        SCENE, {"contact.joint.gap": [0.01]}, workers=-1
    ),
    "durations that are too many": lambda: simulate_many(
        SCENE, {"contact.joint.gap": [0.01]}, duration=np.ones(2)
    ),
    "a tolerance of many that is text": lambda: simulate_many(
        SCENE, {"contact.joint.gap": [0.01]}, rtol="x"
    ),
    "a quantity that there is not": lambda: simulate_many(
        SCENE, {"contact.joint.gap": [0.01]}, quantities=["nope"]
    ),
    "a study over what there is not": lambda: Study(SCENE, {"nope": [1]}),
    "a study of a solver that there is not": lambda: Study(
        SCENE, {"contact.joint.gap": [0.01]}, solver="nope"
    ),
    "a study in negative processes": lambda: Study(SCENE, {"contact.joint.gap": [0.01]}).run(
        processes=-1
    ),
    "a study in negative threads": lambda: Study(SCENE, {"contact.joint.gap": [0.01]}).run(
        workers=-1
    ),
    "a tolerance that nothing keeps": lambda: verify(SCENE, 2.0),
    "a moment in kilograms": lambda: verify(SCENE, moments=["1 kg"]),
    "a moment after the end": lambda: verify(SCENE, moments=[1e9]),
    "a moment that is not finite": lambda: verify(SCENE, moments=[float("nan")]),
    "no patience": lambda: verify(SCENE, patience=-1.0),
    "no repeats": lambda: eventpound.compare(PAIR, ["fast"], repeats=0),
    "no solvers": lambda: eventpound.compare(PAIR, []),
    "no tolerances": lambda: eventpound.compare(PAIR, ["fast"], rtol=[]),
    "a negative step": lambda: eventpound.compare(PAIR, ["moreau"], steps=[-1.0]),
    "a restitution of two": lambda: eventpound.compare(PAIR, ["fast"], restitution=2.0),
    "a history that there is not": lambda: eventpound.compare(PAIR, ["fast"], against=["nope"]),
    "damping of no mode": lambda: rayleigh(SCENE.bodies, SCENE.springs, 0.05, modes=(0, 1)),
    "damping of three modes": lambda: rayleigh(SCENE.bodies, SCENE.springs, 0.05, modes=(1, 1, 1)),
    "damping of nothing": lambda: rayleigh([], [], 0.05, modes=(1, 1)),
    "a period of zero": lambda: rayleigh(SCENE.bodies, SCENE.springs, 0.05, periods=(0.0, 1.0)),
    "a time step of nothing": lambda: eventpound.read_record(EXAMPLE, time_step=-1.0),
    "a record that is a folder": lambda: eventpound.read_record(ROOT),
    "threads of a suite": lambda: eventpound.simulate_suite(SUITE, workers=-1),
    "a solver of a suite": lambda: eventpound.simulate_suite(SUITE, solver="nope"),
    "a law that there is not": lambda: simulate(
        Scene(
            SCENE.bodies,
            SCENE.springs,
            contacts=[Contact("c", "deck", "barrier", 0.1, law=ContactLaw("nope", 1e9))],
            motion=SCENE.motion,
        )
    ),
    "a support without motion": lambda: simulate(
        Scene(SCENE.bodies, SCENE.springs, motion=SCENE.motion, supports=[Support("s")])
    ),
    "a force on nobody": lambda: simulate(
        Scene(SCENE.bodies, SCENE.springs, motion=SCENE.motion, forces=[Force("x", "1 kN")])
    ),
    "a series of nothing": lambda: simulate(
        Scene(SCENE.bodies, [Spring("s", ("ground", "deck"), Series([]))], motion=SCENE.motion)
    ),
}
"""Calls whose arguments are of the right kind, and impossible all the same."""


@pytest.mark.parametrize("what", IMPOSSIBLE)
def test_an_impossible_value_is_an_input_error(what):
    with pytest.raises(InputError):
        IMPOSSIBLE[what]()


def test_what_a_response_is_asked_wrongly(response, tmp_path):
    for call in (
        lambda: response.quantity("nope"),
        lambda: response.quantity(5),
        lambda: response.rows("all"),
        lambda: response.at([[1.0]]),
        lambda: response.at(np.array(["soon"])),
        lambda: response.plot(5),
        lambda: eventpound.write(response, tmp_path / "file" / "below"),
        lambda: eventpound.plot(response, tmp_path, xlim=(2.0, 1.0)),
        lambda: eventpound.plot(response, tmp_path, xlim=(1.0,)),
    ):
        (tmp_path / "file").write_text("")
        with pytest.raises(InputError):
            call()


def test_a_message_says_how_a_case_is_read():
    with pytest.raises(InputError, match=r"found 'mybridge'; accepted: a Case \(load_case"):
        simulate("mybridge")


def test_a_scene_put_into_a_case_is_checked_as_one_by_itself():
    law = ContactLaw("kelvin-voigt", 1e9, 0.3)
    twice = replace(SCENE, contacts=[Contact("joint", "deck", "barrier", 0.01, 0.7, law)])
    shut = replace(SCENE, bodies=[Body("deck", 1.3e6, displacement=0.02)])
    calls: tuple[Callable[[eventpound.Case], object], ...] = (
        simulate,
        verify,
        eventpound.prepare,
        eventpound.design_numbers,
        lambda case: eventpound.compare(case, ["fast"]),
    )
    for call in calls:
        with pytest.raises(InputError, match="one of restitution and damping"):
            call(replace(PAIR, scene=twice))
        with pytest.raises(InputError, match="not penetrated at the start"):
            call(replace(PAIR, scene=shut))


def test_a_motion_that_sets_no_duration_asks_for_one():
    free = replace(SCENE, motion=eventpound.NoMotion())
    for call in (simulate, verify, eventpound.prepare, eventpound.design_numbers):
        with pytest.raises(InputError, match="duration: missing, and free motion sets none"):
            call(free)


def test_a_solver_may_be_named_with_its_settings():
    with pytest.raises(InputError, match="events"):
        simulate(SCENE, "cvode:events=nothing")
    with pytest.raises(InputError, match=r"solvers: moreau:time_step=1: time_step cannot stand"):
        eventpound.compare(PAIR, ["moreau:time_step=1"])
    with pytest.raises(InputError, match="settings: time_step: found '1 kg'"):
        simulate(SCENE, "moreau", settings={"time_step": "1 kg"})
    with pytest.raises(InputError, match="settings: found beside solver"):
        simulate(SCENE, "moreau:theta=0.6", settings={"time_step": "1 ms"})
    said = simulate(SCENE, "moreau", settings={"time_step": "1 ms"}, duration=0.1)
    assert said.task.settings == {"time_step": 0.001}
    said = simulate(SCENE, "moreau:theta=0.6:time_step=1 ms", duration=0.1)
    assert said.task.settings == {"theta": 0.6, "time_step": 0.001}
