"""Stiffnesses by frequency or period, and the masses that they go with."""

import pytest

from eventpound.scene import Linear
from tests.case.test_springs import CLOSE, Table, case_with, problems, spring


@pytest.mark.parametrize(
    "keys", [{"stiffness": 50.0}, {"frequency": 5.0}, {"period": "1256.6370614359172 ms"}]
)
def test_linear(keys):
    ends = {"between": ["a", "ground"]}
    (s,) = case_with(spring=[{**spring(law="linear", **keys), **ends}]).scene.springs
    assert isinstance(s.law, Linear)
    assert s.between == ("a", "ground")
    assert s.law.stiffness == pytest.approx(50.0, rel=CLOSE)


def test_period_of_a_bouc_wen_spring_is_refused_in_one_message():
    for others in ({}, {"strength": 1}, {"strength": 1, "yield_displacement": 1}):
        text = problems(spring=[spring(law="bouc-wen", period="2 s", of_mass=4, **others)])
        assert len(text.splitlines()) == 1
        assert "[[spring]] 1: period: found '2 s'" in text
        for word in ("initial_period", "post_yield_period", "of_mass"):
            assert word in text


def test_periods_that_contradict_a_stiffness():
    keys: Table = {"initial_stiffness": 9.0, "initial_period": 1, "strength": 1, "stiffness": 1}
    said = problems(spring=[spring(law="bouc-wen", **keys)])
    assert "initial_stiffness: found 9.0; accepted: one of initial_stiffness and initial_p" in said
