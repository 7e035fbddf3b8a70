"""Rows of bodies with contact laws against an independent program; what their records say."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from eventpound.motion import NoMotion, Sine
from eventpound.motion.constant import PhasedSine
from eventpound.numerics.arrays import Floats
from eventpound.scene import (
    BARRIER,
    GROUND,
    Body,
    Contact,
    ContactLaw,
    Dashpot,
    Force,
    Linear,
    Scene,
    Spring,
)
from eventpound.scene.contact_law import BY_WORD
from eventpound.scene.parameters import number_places, with_values
from eventpound.simulation import response_of
from eventpound.solvers import solver_named
from eventpound.solvers.base import EventKind, Recording, Task
from eventpound.solvers.sundials import library
from eventpound.study.many import simulate_many
from tests.oracle.line import solved

WORDS = [*BY_WORD, "cut"]
STEPS = 50
"""Of the other program, at the least: nothing here begins and ends within one."""


def law_of(word: str, k: float) -> tuple[float | None, ContactLaw]:
    """Restitution and law; ``"cut"`` is kelvin-voigt without tension."""
    if word == "cut":
        return 0.5, ContactLaw("kelvin-voigt", k, None, False)
    return (0.5 if BY_WORD[word].damped else None), ContactLaw(word, k)


def pair(word: str, k: float = 4e4) -> Scene:
    """Two oscillators and a wall; every contact with the law."""
    return Scene(
        (Body("a", 2.0), Body("b", 3.0)),
        (Spring("s", (GROUND, "a"), Linear(80.0)), Spring("t", (GROUND, "b"), Linear(300.0))),
        (Dashpot((GROUND, "a"), 0.8), Dashpot(("a", "b"), 0.3)),
        (
            Contact("joint", "a", "b", 0.01, *law_of(word, k)),
            Contact("wall", "b", BARRIER, 0.02, *law_of(word, 0.5 * k)),
        ),
        Sine(6.0, 0.9),
    )


def run(
    scene: Scene, end: float, rtol: float = 1e-11, solver: str = "cvode", **settings: object
) -> Recording:
    times = np.linspace(0.0, end, 201)
    return solver_named(solver).solve(
        Task(scene, 0.0, end, rtol, output_times=times, energy=True, settings=settings)
    )


@pytest.mark.parametrize("word", WORDS)
def test_against_another_program(word):
    scene, end = pair(word), 2.5
    found = run(scene, end)
    assert sum(e.kind is EventKind.IMPACT for e in found.events) >= 6
    answer = solved(scene, end, 0.04, 0.1, [0.9], STEPS)
    # Bodies move by 0.04 m and at 0.3 m/s; each of a dozen contacts magnifies the errors of both
    # programs, some 1e-12 of that, a few times.
    np.testing.assert_allclose(found.u, answer.u, rtol=0, atol=4e-10)
    np.testing.assert_allclose(found.v, answer.v, rtol=0, atol=8e-9)
    assert abs(found.energy.closure) < 1e-9


@pytest.mark.parametrize("settings", [{"events": "sundials"}, {"method": "BDF"}], ids=str)
@pytest.mark.parametrize("word", ["kelvin-voigt", "jankowski"])
def test_ways_of_cvode_agree(word, settings):
    _agree(pair(word), **settings)


@pytest.mark.sweep
def test_cvode_through_python_agrees(monkeypatch):
    found = run(pair("jankowski"), 2.5)
    monkeypatch.setattr(library, "library", lambda: None)
    _agree(pair("jankowski"), found)


def _agree(scene: Scene, found: Recording | None = None, **settings: object) -> None:
    found = found or run(scene, 2.5)
    other = run(scene, 2.5, **settings)
    assert [e[1:4] for e in found.events] == [e[1:4] for e in other.events]
    np.testing.assert_allclose(found.u, other.u, rtol=0, atol=1e-9)


def test_history_has_the_forces():
    scene = pair("hertz")
    found = run(scene, 2.5)
    gap, force = found.history.gap, found.history.contact_force
    k = np.array([4e4, 2e4])
    np.testing.assert_allclose(force, k * np.maximum(-gap, 0.0) ** 1.5, rtol=1e-9, atol=1e-9)
    assert (force > 0.0).any(axis=0).all()
    # The push on a body is in its acceleration, and in no base shear.
    pull = found.history.force
    shear = pull[:, 0] + pull[:, 1] + 0.8 * found.history.v[:, 0]
    assert found.base_shear.maximum[0] >= shear.max() * (1.0 - 1e-9)
    assert found.base_shear.maximum[0] < 1.1 * shear.max()
    mass, a = np.array([2.0, 3.0]), found.history.a
    total = (mass * a).sum(axis=1) + shear
    np.testing.assert_allclose(total, -force[:, 1], rtol=0, atol=1e-7)


@pytest.mark.parametrize("solver", ["cvode", "penalty"])
@pytest.mark.parametrize("word", WORDS)
def test_pressed_shut_from_the_start_to_the_end(solver, word):
    # k = 300 and 1000 in parallel beside the wall, overlap 1 cm at rest: a time in contact that
    # is cut by the end of the run.
    scene = Scene(
        (Body("b", 3.0, velocity=0.01),),
        (Spring("t", (GROUND, "b"), Linear(300.0)),),
        (),
        (Contact("wall", "b", BARRIER, -0.1, *law_of(word, 1000.0)),),
        NoMotion(),
    )
    settings = {"steps_per_period": 4000} if solver == "penalty" else {}
    found = run(scene, 0.05, 1e-10, solver, **settings)
    (event,) = found.events
    assert event.kind is EventKind.CUT
    assert event.t == 0.0
    assert event.gap_velocity_before == pytest.approx(-0.01)
    assert event.gap_velocity_after == pytest.approx(-found.v[0], rel=1e-12)
    answer = solved(scene, 0.05, 0.01, 0.1, steps=STEPS)
    close = 1e-4 if solver == "penalty" else 1e-9
    assert found.v[0] == pytest.approx(answer.v[0], rel=close)
    # What the spring and the contact did is the change of momentum.
    spring = np.trapezoid(found.history.force[:, 0], found.history.t)
    assert event.impulse == pytest.approx(-3.0 * (found.v[0] - 0.01) - spring, rel=1e-4)
    assert found.laws.longest_contact[0] == pytest.approx(0.05, rel=1e-9)
    assert abs(found.energy.closure) < (1e-3 if solver == "penalty" else 1e-8)


def test_newton_and_law_in_one_scene():
    # b rests on a stop by Newton's law while a presses on it by a spring contact.
    scene = Scene(
        (Body("a", 2.0, 0.0, 1.0), Body("b", 3.0)),
        (),
        (),
        (
            Contact("joint", "a", "b", 0.1, None, ContactLaw("hertz", 4e4)),
            Contact("stop", "b", BARRIER, 0.0, 0.0),
        ),
        NoMotion(),
    )
    found = run(scene, 0.4)
    by_kind = {kind: [e for e in found.events if e.kind is kind] for kind in EventKind}
    (struck,) = [e for e in by_kind[EventKind.IMPACT] if e.contact == 0]
    # The stop holds b: a comes back with all its speed.
    assert -struck.gap_velocity_after / struck.gap_velocity_before == pytest.approx(-1.0 * -1.0)
    assert found.u[1] == 0.0
    largest = 4e4 * (1.25 * 2.0 / 4e4) ** 0.6
    assert found.max_force[0] == pytest.approx(largest, rel=1e-9)
    assert found.max_force[1] == pytest.approx(largest, rel=1e-9)
    assert abs(found.energy.closure) < 1e-9


def test_many_variants_are_the_same_runs():
    scene, stiffness = pair("hertz-damp"), [2e4, 8e4]
    many = simulate_many(scene, {"contact.joint.stiffness": stiffness}, rtol=1e-8, duration=1.5)
    for i, k in enumerate(stiffness):
        place = number_places(scene)["contact.joint.stiffness"]
        one = response_of(with_values(scene, {place: k}), "cvode", 1e-8, duration=1.5)
        np.testing.assert_array_equal(many.u[i], one.recording.u)
    assert many.u[0, 0] != many.u[1, 0]


def test_the_error_of_a_stepper_falls_to_that_of_its_own_model():
    scene, end = pair("kelvin-voigt"), 1.2
    true = run(scene, end).u
    errors = [
        float(np.abs(run(scene, end, solver="penalty", time_step=h).u - true).max())
        for h in (4e-5, 2e-5, 1e-5)
    ]
    # The force jumps at closing and opening: of first order.
    assert errors[2] < 0.3 * errors[0] < 1e-4


def test_stiffness_to_infinity_is_newtons_law():
    """The time in contact is what a law adds, and falls with 1/sqrt(k)."""
    end = 0.9
    rigid = replace(
        pair("kelvin-voigt"),
        contacts=tuple(replace(c, law=None) for c in pair("kelvin-voigt").contacts),
    )
    true = run(rigid, end).u
    errors = []
    for k in (1e6, 1e8, 1e10):
        errors.append(float(np.abs(run(pair("kelvin-voigt", k), end).u - true).max()))
    # Ten times smaller for a stiffness a hundred times larger, to first order.
    assert math.log(errors[2] / errors[1]) / math.log(100.0) == pytest.approx(-0.5, abs=0.02)


def test_what_is_pressed_shut_closes_what_only_touches():
    """b touches a, and a wall pushes it there: a time in contact from the start, without a blow.

    A blow of no speed would give hertz-damp a dashpot without a bound.
    """
    scene = Scene(
        (Body("a", 3.5), Body("b", 0.3)),
        (Spring("t", (GROUND, "a"), Linear(300.0)),),
        (),
        (
            Contact("joint", "b", "a", 0.0, 0.8, ContactLaw("hertz-damp", 1e5)),
            Contact("wall", BARRIER, "b", -0.005, None, ContactLaw("linear", 2.5e4)),
        ),
        NoMotion(),
    )
    found = run(scene, 0.1, 1e-9)
    first = {e.contact: e for e in reversed(found.events)}
    assert first[0].t == first[1].t == 0.0
    assert first[0].gap_velocity_before == 0.0
    assert found.work.steps < 5000
    answer = solved(scene, 0.1, 0.005, 0.1, steps=STEPS)
    np.testing.assert_allclose(found.u, answer.u, rtol=0, atol=1e-7)


@pytest.mark.parametrize("word", ["hertz", "hertz-damp"])
def test_a_contact_that_closes_as_another_opens(word):
    """Both at one place, where either gap is zero by rounding of either sign."""
    mass, spring, left, right, end = 0.37, 80.0, 1.5e5, 1.3e6, 0.03
    e, law = law_of(word, right)
    contact = Contact("right", "b", BARRIER, 0.0, e, law)
    for v in (0.0013, 0.0014, 0.0015):
        scene = Scene(
            (Body("b", mass, -1e-6, v),),
            (Spring("t", (GROUND, "b"), Linear(spring)),),
            (),
            (Contact("left", BARRIER, "b", 0.0, None, ContactLaw("linear", left)), contact),
            NoMotion(),
        )
        t, y, struck = 0.0, np.array([-1e-6, v]), 0.0

        def rate(_: float, y: Floats, a: float, inside: bool) -> list[float]:
            push = right * max(y[0], 0.0) ** 1.5 * (1.0 + a * y[1]) if inside else left * y[0]
            return [y[1], -(spring * y[0] + push) / mass]

        def passing(_: float, y: Floats, *others: object) -> float:
            return float(y[0])

        passing.terminal = True
        while t < end:
            inside = y[1] > 0.0 and t > 0.0
            struck = y[1] if inside else 1.0
            passing.direction = -1.0 if inside else 1.0
            given = ((contact.damping or 0.0) / struck, inside)
            found = solve_ivp(
                rate, (t, end), y, "DOP853", args=given, events=passing, rtol=1e-12, atol=1e-20
            )
            t, y = float(found.t[-1]), found.y[:, -1]
        ours = run(scene, end, 1e-10)
        # Parts of 1e-5 m and 1.5 mm/s, in a scene whose length they are.
        np.testing.assert_allclose(ours.u, y[:1], rtol=0, atol=1e-12)
        np.testing.assert_allclose(ours.v, y[1:], rtol=0, atol=1e-9)


@pytest.mark.parametrize("speed", [1e-6, 1e-9, 1e-12])
def test_a_wall_lets_go_beside_an_element_that_was_hardly_struck(speed):
    """Its damping, over that speed, is beyond all numbers of the scene; the force is not."""
    push, period, end = 5.0, 1.0, 0.6
    history = PhasedSine(push, period, phase=0.5 * math.pi)
    scene = Scene(
        (Body("a", 4e5, 0.0, speed), Body("b", 8e5)),
        (),
        (),
        (
            Contact("joint", "a", "b", 0.0, 0.3, ContactLaw("hertz-damp", 2e9)),
            Contact("wall", "b", BARRIER, 0.0, 0.0),
        ),
        NoMotion(),
        (),
        tuple(Force(name, history, per_mass=True) for name in ("a", "b")),
    )
    ours = run(scene, end, 1e-9)
    omega, half = 2.0 * math.pi / period, 0.25 * period
    free = -push / omega**2 * math.cos(omega * end) - push / omega * (end - half)
    # What the element still pushes for a moment moves b by less than 0.1 % of the speed's rest.
    np.testing.assert_allclose(ours.u[1], free, rtol=0, atol=1e-6)
    (gone,) = (e.t for e in ours.events if e.kind is EventKind.DETACHMENT)
    assert half < gone < half + 1e-4
