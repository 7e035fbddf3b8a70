"""Whose run tells the errors of another."""

from dataclasses import replace

import pytest

from eventpound.accuracy.judge import judge_of, rtol_of_judge
from eventpound.scene import BARRIER, Contact, ContactLaw
from eventpound.simulation import response_of
from tests.accuracy.test_estimate import WALL


def test_fast_judges_no_scene_that_it_does_not_take():
    contact = Contact("wall", "b", BARRIER, 0.5, None, ContactLaw("hertz", 1e3))
    scene = replace(WALL, contacts=(contact,))
    for asked in (True, False):
        assert judge_of(response_of(scene, "cvode", duration=4.0), asked=asked) == "cvode"


@pytest.mark.parametrize(
    ("judge", "rtol", "of_others", "of_itself"),
    [
        ("fast", 1e-3, 1e-5, 1e-5),
        ("fast", 1e-12, 1e-14, 1e-14),
        ("fast", 1e-13, 1e-14, 1e-14),
        ("cvode", 5e-14, 1e-14, 5e-13),
        ("cvode", 1e-14, 1e-14, 1e-13),
        ("ida", 1e-10, 1e-12, 1e-12),
        pytest.param("ida", 1e-12, 1e-12, 1e-11, id="below 1e-12 the steps of ida get no finer"),
    ],
)
def test_a_run_never_judges_itself_by_the_same_steps(judge, rtol, of_others, of_itself):
    assert rtol_of_judge(rtol, judge, itself=False) == pytest.approx(of_others, rel=1e-12)
    assert rtol_of_judge(rtol, judge, itself=True) == pytest.approx(of_itself, rel=1e-12)
