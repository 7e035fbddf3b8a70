"""Whatever is given wrongly from Python is an InputError that names it."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import product
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
    "N": None,
    "B": True,
    "I": 5,
    "T": "nonsense",
    "L": [1, [2]],
    "M": {"a": []},
    "O": object(),
    "C": Cosine,
}
"""Something of each kind: none, a truth, a number, a text, a sequence, a mapping, an object and
a class in the place of one."""
NUMBER = "BTLMOC"
NEEDED = "N" + NUMBER
TEXT, FLAG = "NBILMOC", "NITLMOC"
THINGS = "NBITLMOC"
PULSE, SHAPE = {"amplitude": 1.0, "period": 1.0}, "amplitude period start"
WRONG: Mapping[str, tuple[Mapping[str, Any], Mapping[str, str]]] = {
    "Body": ({"name": "a", "mass": 1.0}, {TEXT: "name", NEEDED: "mass displacement velocity"}),
    "Linear": ({"stiffness": 1.0}, {NEEDED: "stiffness"}),
    "BilinearElastic": (
        {"compression": 1.0, "extension": 1.0},
        {NEEDED: "compression extension offset"},
    ),
    "Series": ({"parts": ()}, {THINGS: "parts"}),
    "Backfill": (
        {"initial_stiffness": 2e7, "ultimate_force": 3e5, "failure_ratio": 0.7},
        {NEEDED: "initial_stiffness ultimate_force failure_ratio gap"},
    ),
    "Backfill.of_wall": ({"height": 2.0, "width": 9.0}, {NEEDED: "height width gap"}),
    "BoucWen": (
        {"stiffness": 1.0, "strength": 1.0, "yield_displacement": 1.0},
        {NEEDED: "stiffness strength yield_displacement exponent beta gamma initial_z"},
    ),
    "DegradingBoucWen": (
        {"stiffness": 1.0, "strength": 1.0, "yield_displacement": 1.0},
        {NEEDED: "gamma strength_degradation stiffness_degradation initial_loss"},
    ),
    "BoucWen.from_yield": (
        {"initial_stiffness": 1.0, "yield_force": 1.0},
        {NEEDED: "initial_stiffness yield_force hardening exponent beta gamma"},
    ),
    "Slider": (
        {"friction": 0.05, "normal_force": 1.0},
        {NEEDED: "friction normal_force stiffness"},
    ),
    "Slider.pendulum": (
        {"friction": 0.05, "normal_force": 1.0, "radius": 2.0},
        {NEEDED: "friction normal_force radius"},
    ),
    "Spring": (
        {"name": "s", "between": ("ground", "a"), "law": Linear(1.0)},
        {TEXT: "name", THINGS: "between law", NUMBER: "height weight", "BILMOC": "frame"},
    ),
    "Dashpot": (
        {"between": ("ground", "a"), "coefficient": 1.0},
        {THINGS: "between", NEEDED: "coefficient"},
    ),
    "Dashpot.from_ratio": (
        {"between": ("ground", "a"), "ratio": 0.05, "stiffness": 1.0, "mass": 1.0},
        {THINGS: "between", NEEDED: "ratio stiffness mass"},
    ),
    "Contact": (
        {"name": "c", "left": "a", "right": "b", "gap": 0.0, "restitution": 0.5},
        {TEXT: "name left right", NEEDED: "gap", NUMBER: "restitution", "BITLMOC": "law"},
    ),
    "ContactLaw": (
        {"kind": "hertz", "stiffness": 1e9},
        {TEXT: "kind", NEEDED: "stiffness", NUMBER: "damping", FLAG: "tension"},
    ),
    "Point": ({"weights": {"a": 1.0}}, {"NBITLOC": "weights"}),
    "Deck": (
        {"name": "d", "mass": 1.0, "length": 1.0, "width": 1.0},
        {TEXT: "name", NEEDED: "mass length width", NUMBER: "inertia", THINGS: "centre"},
    ),
    "Joint": (
        {"name": "j", "between": ("d", "barrier"), "gap": 0.01, "restitution": 0.5},
        {TEXT: "name", THINGS: "between", NEEDED: "gap restitution friction"},
    ),
    "Seat": ({"name": "e", "between": ("ground", "a")}, {TEXT: "name", THINGS: "between"}),
    "Support": ({"name": "s"}, {TEXT: "name", NUMBER: "delay", "BITLMOC": "motion"}),
    "Force": ({"body": "a", "history": 1.0}, {TEXT: "body", NEEDED: "history", FLAG: "per_mass"}),
    "Scene": (
        {"bodies": SCENE.bodies},
        {THINGS: "bodies springs dashpots contacts supports forces motion"},
    ),
    "Cosine": (PULSE, {NEEDED: SHAPE, FLAG: "reverse"}),
    "Sine": (PULSE, {NEEDED: SHAPE, FLAG: "reverse"}),
    "TypeC": (PULSE, {NEEDED: SHAPE + " cycles", FLAG: "reverse"}),
    "Harmonic": (PULSE, {NEEDED: SHAPE, FLAG: "reverse", NUMBER: "cycles"}),
    "Ricker": (PULSE, {NEEDED: SHAPE, FLAG: "reverse", NUMBER: "center"}),
    "AntisymmetricRicker": (PULSE, {NEEDED: SHAPE, FLAG: "reverse", NUMBER: "center"}),
    "MavroeidisPapageorgiou": (PULSE, {NEEDED: SHAPE + " gamma phase", FLAG: "reverse"}),
    "Record": (
        {"samples": [0.0, 1.0], "time_step": 0.01},
        {
            THINGS: "samples",
            NEEDED: "time_step scale start",
            NUMBER: "pga psa psa_period psa_damping",
            FLAG: "reverse",
            "BITLMOC": "source",
            "BILMOC": "psa_at",
        },
    ),
    "read_record": (
        {"path": "none.AT2"},
        {
            TEXT: "path",
            "BILMOC": "format units component response",
            NUMBER: "time_step",
            FLAG: "as_needed",
        },
    ),
    "load_case": ({"path": "none"}, {TEXT: "path", "BILMOC": "suite"}),
    "simulate": (
        {"case": SCENE},
        {
            THINGS: "case",
            "BITLMOC": "solver",
            NUMBER: "rtol duration output_step max_steps",
            "ITLMOC": "energy error_estimate",
            "BITLOC": "settings start",
            "ITLMO": "progress",
        },
    ),
    "prepare": (
        {"case": SCENE},
        {
            THINGS: "case",
            "BITLMOC": "solver",
            NUMBER: "rtol duration output_step",
            "ITLMOC": "energy",
            "BITLOC": "settings",
        },
    ),
    "sensitivities": (
        {"case": SCENE},
        {THINGS: "case of to", NEEDED: "rtol", NUMBER: "duration workers", "BITLMO": "progress"},
    ),
    "simulate_many": (
        {"case": SCENE, "parameters": {"contact.joint.gap": [0.01]}},
        {
            THINGS: "case parameters quantities",
            NUMBER: "rtol duration workers",
            FLAG: "accelerations",
            "BITLMO": "progress",
        },
    ),
    "simulate_suite": (
        {"case": PAIR},
        {
            THINGS: "case",
            "BILMOC": "solver",
            NUMBER: "rtol workers",
            "ITLMOC": "error_estimate",
            "BITLMO": "progress keep",
            FLAG: "intensities",
        },
    ),
    "design_numbers": (
        {"case": SCENE},
        {THINGS: "case", "BILMOC": "folder", NUMBER: "workers", "BITLMO": "progress"},
    ),
    "Study": (
        {"case": SCENE, "axes": {"contact.joint.gap": [0.01]}},
        {
            THINGS: "case axes quantities together",
            "BILMOC": "records",
            "BITLMOC": "solver",
            NUMBER: "rtol duration",
        },
    ),
    "verify": (
        {"case": SCENE},
        {THINGS: "case moments", NEEDED: "rtol patience", NUMBER: "duration", "BITLMO": "report"},
    ),
    "compare": (
        {"case": PAIR, "solvers": ["fast"]},
        {THINGS: "case solvers rtol steps against", NEEDED: "repeats", NUMBER: "restitution"},
    ),
    "rayleigh": (
        {"bodies": SCENE.bodies, "springs": SCENE.springs, "ratio": 0.05, "modes": (1, 1)},
        {THINGS: "bodies springs", NEEDED: "ratio", "BITLMOC": "modes periods"},
    ),
    "frame": (
        {"name": "F", "stiffness": [[1e7]], "mass": [1e5]},
        {TEXT: "name on", THINGS: "stiffness mass", "BITLMOC": "damping names"},
    ),
    "modal_damping": (
        {"bodies": SCENE.bodies, "springs": SCENE.springs, "ratio": 0.05},
        {THINGS: "bodies springs", NEEDED: "ratio", TEXT: "base"},
    ),
    "stiffness_proportional": (
        {
            "bodies": SCENE.bodies,
            "springs": SCENE.springs,
            "damped": ["pier"],
            "ratio": 0.05,
            "period": 1.0,
        },
        {THINGS: "bodies springs damped", NEEDED: "ratio", "BITLMOC": "mode", NUMBER: "period"},
    ),
    "plot": (
        {"source": "none", "directory": "none"},
        {TEXT: "source directory", "BITLMOC": "paper xlim beside", FLAG: "pi"},
    ),
    "write": (
        {"response": object.__new__(Response), "directory": "none"},
        {
            THINGS: "response",
            TEXT: "directory",
            "BITLMOC": "case started",
            "BITLOC": "error_estimate",
        },
    ),
}
"""Public names, or methods that make one: a call that is right, and the kinds that are wrong with
the arguments that they are wrong for."""
NOT_CALLED = {
    *(name for name in eventpound.__all__ if name.endswith(("Error", "Warning"))),
    *("BatchResponse", "Case", "NoMotion", "Prepared", "Response", "StudyTable"),
}
"""What nobody makes by hand, and what takes no argument."""


def test_every_public_name_is_in_the_table():
    assert {name.partition(".")[0] for name in WRONG} | NOT_CALLED == set(eventpound.__all__)
    calls = sum(len(k) * len(v.split()) for _, wrong in WRONG.values() for k, v in wrong.items())
    assert calls > 119


def escaped(call: Callable[..., Any], key: str, arguments: Mapping[str, Any]) -> str:
    """What a wrong call ended in, empty where it is an InputError that names the argument."""
    try:
        call(**arguments)
    except InputError as error:
        return "" if key.removesuffix("s") in str(error) else f"InputError: {error}"
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return "accepted"


@pytest.mark.parametrize("name", WRONG)
def test_an_argument_of_a_wrong_kind_is_an_input_error(name):
    call: Any = eventpound
    for part in name.split("."):
        call = getattr(call, part)
    right, wrong = WRONG[name]
    found = {
        f"{key} = {OF_KIND[kind]!r}": outcome
        for kinds, keys in wrong.items()
        for key, kind in product(keys.split(), kinds)
        if (outcome := escaped(call, key, {**right, key: OF_KIND[kind]}))
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
