"""What the one call takes: a solver of one's own, units, and what it refuses."""

import math
from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest

from eventpound import (
    Body,
    Contact,
    ContactLaw,
    Cosine,
    Dashpot,
    InputError,
    Linear,
    MavroeidisPapageorgiou,
    Record,
    Ricker,
    Scene,
    Spring,
    Support,
    compare,
    load_case,
    simulate,
)
from eventpound.solvers.from_samples import sampled_recording
from tests.test_response import CASE


class Still:
    """A solver that finds that nothing ever moves."""

    name = "motionless"
    summary = "nothing moves"
    settings: ClassVar = {"time_step": "distance of its rows (s)"}

    def solve(self, task):
        t = np.linspace(task.start, task.end, 11)
        bodies, springs = len(task.scene.bodies), len(task.scene.hysteretic_springs)
        rows = np.zeros((t.size, bodies))
        return sampled_recording(task, t, rows, rows, np.zeros((t.size, springs)))


def test_a_solver_of_ones_own_is_an_object():
    case = load_case(CASE)
    response = simulate(case, Still(), settings={"time_step": 0.1})
    assert response.solver == "motionless"
    assert response.peaks["abs_max"].iloc[0] == 0.0
    assert response.quantity(f"free.peaks.{response.scene.bodies[0].name}.max") == 0.0
    table = compare(case, [Still(), "fast"], rtol=[1e-7], steps=[0.05], repeats=1)
    errors = table.set_index("solver")["peak_error"]
    # All of the largest displacement is missing, to which errors are parts.
    assert errors["motionless"] > 0.5 > 1e-5 > errors["fast"]


@pytest.mark.parametrize("solver", [5, object(), type("Short", (), {"name": "short"})()])
def test_what_is_no_solver(solver):
    with pytest.raises(InputError, match=r"has no .*solve"):
        simulate(load_case(CASE), solver)


def test_a_name_that_is_taken():
    taken = Still()
    taken.name = "fast"
    with pytest.raises(InputError, match="another solver is called 'fast'"):
        simulate(load_case(CASE), taken)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"rtol": "1e-6 m"}, "rtol: found '1e-6 m'"),
        ({"rtol": [1e-6]}, "rtol: found [1e-06]"),
        ({"duration": "12 kN"}, "duration: found '12 kN'"),
        ({"duration": -1.0}, "duration: found -1.0; accepted: a positive time (s)"),
        ({"output_step": None, "duration": True}, "duration: found True"),
    ],
)
def test_wrong_arguments_are_named(options, said):
    with pytest.raises(InputError) as caught:
        simulate(load_case(CASE), **options)
    assert said in str(caught.value)


def test_units_in_arguments_and_parts():
    case = load_case(CASE)
    said = simulate(case, "fast", "1e-6", duration="1500 ms", output_step="0.5 s")
    meant = simulate(case, "fast", 1e-6, duration=1.5, output_step=0.5)
    assert said.peaks.equals(meant.peaks)
    scene = Scene(
        (Body("deck", "1301 t", velocity="5 cm/s"),),
        (Spring("pier", ("ground", "deck"), Linear("12 kN/mm")),),
        (Dashpot(("ground", "deck"), "1743 kN s/m"),),
        (Contact("joint", "deck", "barrier", "1.27 cm", "70 %"),),
    )
    assert scene.bodies[0] == Body("deck", 1.301e6, 0.0, 0.05)
    assert scene.springs[0].law == Linear(1.2e7)
    assert scene.dashpots[0].coefficient == 1.743e6
    assert scene.contacts[0] == Contact("joint", "deck", "barrier", 0.0127, 0.7)
    assert Cosine("0.4 g", "0.8 s") == Cosine(0.4 * 9.80665, 0.8)
    assert Ricker("4 m/s^2", 0.7, center="700 ms") == Ricker(4.0, 0.7, center=0.7)
    record = Record([0.0, 1.0], "0.01 s", pga="0.3 g", start="1 s")
    assert (record.time_step, record.pga, record.start) == (0.01, 0.3 * 9.80665, 1.0)
    assert MavroeidisPapageorgiou(1.0, 1.0, phase="90 deg").phase == pytest.approx(math.pi / 2)
    assert Support("pier", "120 ms").delay == 0.12
    assert ContactLaw("hertz", "2 kN/mm^1.5").stiffness == pytest.approx(2e3 / 0.001**1.5)
    lists = Scene(list(scene.bodies), [replace(scene.springs[0], between=["ground", "deck"])])
    assert lists == Scene(scene.bodies, scene.springs)
    with pytest.raises(InputError, match=r"Body: mass: found '1301 m'"):
        Body("deck", "1301 m")
