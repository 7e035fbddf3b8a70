"""A scene of a plan: sizes, its first record that can be read, and what a call gives."""

import math

import pytest

from eventpound.case.record_options import RecordOptions
from eventpound.case.solver_options import SolverOptions
from eventpound.case.suite import Member
from eventpound.errors import InputError
from eventpound.motion.synthetic import synthetic_motion
from eventpound.scene import Body, Scene
from eventpound.study.axes import given_axes
from eventpound.study.base import base_of, solver_of

BALL = Scene((Body("ball", 2.0, velocity=1.0),))
BY = SolverOptions("fast", 1e-6)
GOOD = Member("a", "a.AT2", RecordOptions(), (1, 1))
BAD = Member("b", "b.txt", RecordOptions(), problem="b.txt: holds no numbers")


def base(records=(), length=math.nan):
    axes = given_axes("axes", {"body.ball.mass": [1.0, 2.0, 3.0]}, ())
    own = 2.0 if not records and math.isnan(length) else length
    return base_of(BALL, axes, records, BY, own)


def test_all_axes_vary_under_each_record():
    assert (base().size_of_record, base().size) == (3, 3)
    assert (base([GOOD, BAD]).size_of_record, base([GOOD, BAD]).size) == (3, 6)


def test_a_record_that_cannot_be_read_stands_aside_for_one_that_can():
    moved = base([BAD, GOOD]).at_first()
    assert moved.records == ()
    assert moved.case.scene.motion.peak == pytest.approx(
        abs(synthetic_motion(1, 1).record.acceleration).max(), rel=1e-15
    )
    with pytest.raises(InputError, match="holds no numbers"):
        base([BAD, BAD]).at_first()


def test_without_records_the_scene_is_its_own_first():
    own = base()
    assert own.at_first() is own


def test_a_length_given_is_that_of_all_runs():
    assert base(length=2.0).own_duration
    assert base(length=2.0).case.run.duration == 2.0
    assert not base([GOOD]).own_duration


def test_a_solver_that_is_named_takes_the_place_of_the_usual_one():
    assert solver_of(BALL, None).name == "fast"
    found = solver_of(BALL, "1e-8", "cvode:method=BDF")
    assert (found.name, found.rtol, dict(found.settings)) == ("cvode", 1e-8, {"method": "BDF"})
