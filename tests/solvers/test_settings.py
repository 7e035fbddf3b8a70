"""What `[solver]` may say, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from eventpound.case import load_case, write_template
from eventpound.errors import InputError
from eventpound.motion.record import Record
from eventpound.scene import GROUND, Body, Linear, Scene, Spring
from eventpound.simulation import response_of
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task


@pytest.fixture
def case(tmp_path):
    write_template(tmp_path / "case")
    return load_case(tmp_path / "case")


def _with(case, **changes):
    return replace(case, solver=replace(case.solver, **changes))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"settings": {"method": "RK4"}}, "method = 'RK4'; accepted: Adams or BDF"),
        (
            {"settings": {"coordinates": "polar"}},
            "coordinates = 'polar'; accepted: moving or relative",
        ),
        ({"settings": {"events": "foo"}}, "events = 'foo'; accepted: own or sundials"),
        ({"settings": {"theta": 0.5}}, "theta is not a setting of cvode; accepted: method"),
        ({"rtol": 0.5}, "rtol: found 0.5; accepted: a number from 1e-14 to 0.01"),
        ({"name": "euler"}, "solver = 'euler' is not known; accepted: cvode"),
    ],
)
def test_refused(case, changes, message):
    with pytest.raises(InputError, match=message.replace("(", r"\(")):
        response_of(_with(case, **changes))


def test_adams_and_bdf_agree(case):
    adams = response_of(case)
    bdf = response_of(_with(case, settings={"method": "BDF"}))
    wanted = adams.peaks["min"].iloc[0]
    # Two methods, each within some hundred times rtol = 1e-9 of the motion.
    assert bdf.peaks["min"].iloc[0] == pytest.approx(wanted, rel=2e-7)
    assert bdf.impacts == adams.impacts


def test_coordinates_agree_under_a_record():
    t = 0.02 * np.arange(300)
    scene = Scene(
        (Body("b", 1.0),),
        (Spring("s", (GROUND, "b"), Linear(40.0)),),
        motion=Record(np.sin(7.0 * t) * np.sin(0.8 * t), 0.02),
    )
    peaks = {}
    for coordinates in ("moving", "relative"):
        task = Task(scene, 0.0, 7.0, 1e-10, settings={"coordinates": coordinates})
        run = solver_named("cvode").solve(task)
        peaks[coordinates] = run.displacement.minimum[0], run.work.rhs
    # Each within some hundred times rtol of the motion; the moving frame is the cheaper.
    assert peaks["moving"][0] == pytest.approx(peaks["relative"][0], rel=2e-8)
    assert peaks["moving"][1] < peaks["relative"][1]
