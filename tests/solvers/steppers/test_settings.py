"""What ``[solver]`` may say to a stepper, and what it does where nothing is said."""

import math

import numpy as np
import pytest

from eventpound.case.loading import load_case
from eventpound.case.solver_options import HERTZIAN
from eventpound.errors import InputError
from eventpound.motion.pulses import Sine
from eventpound.motion.record import Record
from eventpound.scene import BARRIER, GROUND, Body, Contact, Linear, Scene, Spring
from eventpound.scene.contact_law import Element
from eventpound.simulation import response_of
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task


def _scene(motion=None, eps: float = 0.5) -> Scene:
    spring = Spring("k", (GROUND, "m"), Linear(18.0))
    contact = Contact("wall", "m", BARRIER, 0.2, eps)
    return Scene((Body("m", 2.0, 0.1, 0.5),), (spring,), (), (contact,), motion or Sine(1.0, 0.5))


def _run(solver: str, scene: Scene, **settings):
    return solver_named(solver).solve(Task(scene, 0.0, 1.0, 1e-9, settings=settings))


@pytest.mark.parametrize(
    ("solver", "settings", "message"),
    [
        ("moreau", {"time_step": 0.0}, "time_step = 0.0; accepted: a positive time"),
        ("moreau", {"time_step": "x"}, "time_step = 'x'; accepted: a positive time"),
        ("moreau", {"time_step": math.nan}, "time_step = nan; accepted"),
        ("moreau", {"time_step": True}, "time_step = True; accepted"),
        ("moreau", {"steps_per_period": -1}, "steps_per_period = -1; accepted: a positive number"),
        ("moreau", {"time_step": 0.1, "steps_per_period": 9}, "accepted: one of them"),
        ("moreau", {"theta": 0.4}, "theta = 0.4; accepted: a number from 0.5 to 1"),
        ("moreau", {"theta": 1.1}, "theta = 1.1; accepted: a number from 0.5 to 1"),
        ("moreau", {"time_step": 1e-12}, "accepted: at most 2000000000"),
        ("penalty", {"contact_steps": 0, "time_step": 0.1}, "accepted: a positive number of steps"),
        ("penalty", {"contact_steps": 20}, "contact_steps = 20; accepted: with time_step"),
    ],
)
def test_refused(solver, settings, message):
    with pytest.raises(InputError, match=message):
        _run(solver, _scene(), **settings)


@pytest.mark.parametrize(
    ("motion", "shortest"),
    [(Sine(1.0, 0.5), 0.5), (Sine(1.0, 9.0), 2.0 * math.pi / 3.0)],
    ids=["pulse", "structure"],
)
def test_default_step_is_a_hundredth_of_the_shortest_period(motion, shortest):
    work = _run("moreau", _scene(motion)).work
    # Two pieces, each of them cut into whole steps.
    assert 0 <= work.steps - 1.0 / (shortest / 100.0) <= 2.0
    assert _run("moreau", _scene(motion), steps_per_period=300).work.steps == pytest.approx(
        300 / shortest, abs=2.0
    )


def test_default_step_sees_every_sample():
    motion = Record(np.sin(np.arange(401.0)), 0.0025)
    assert _run("moreau", _scene(motion)).work.steps == 400


def test_default_step_resolves_the_contact():
    # m = 2 kg, k = 100 · 18 N/m: a period of 2 π/30 s, half of which is the contact.
    work = _run("penalty", _scene(Sine(1.0, 9.0))).work
    assert work.steps == pytest.approx(100 / (2.0 * math.pi / 30.0), abs=2.0)


def test_words_of_the_case_are_those_of_the_elements():
    assert set(HERTZIAN) == {element.word for element in Element if element.hertzian}


def _case(tmp_path, solver: str):
    (tmp_path / "case.toml").write_text(
        """
body = [{ name = "m", mass = 2.0 }]
spring = [{ between = ["ground", "m"], law = "linear", stiffness = 18.0 }]
contact = [{ between = ["m", "barrier"], gap = 0.01, restitution = 0.5 }]
[excitation]
kind = "sine"
amplitude = 1.0
period = 0.5
[solver]
"""
        + solver
    )
    return load_case(tmp_path)


def test_units_in_a_case(tmp_path):
    case = _case(tmp_path, 'name = "penalty"\ncontact_steps = 20\ntime_step = "0.5 ms"\n')
    assert case.solver.settings == {"contact_steps": 20, "time_step": 5e-4}
    assert response_of(case).impacts > 0


def test_hertz_stiffness_has_its_own_unit(tmp_path):
    text = 'name = "opensees"\ncontact = "hertz-damp"\ncontact_stiffness = "2 kN/{}"\n'
    case = _case(tmp_path, text.format("m^1.5"))
    assert case.solver.settings["contact_stiffness"] == pytest.approx(2000.0)
    with pytest.raises(InputError, match=r"no unit of Hertz stiffness; accepted: .*N/m\^1.5"):
        _case(tmp_path, text.format("m"))
