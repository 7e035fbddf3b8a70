"""Stiffnesses by frequency or period, and the masses that they go with."""

from __future__ import annotations

import math

import pytest

from eventpound.scene import (
    Linear,
)
from tests.case.test_springs import CLOSE, Table, case_with, problems, spring


@pytest.mark.parametrize(
    "keys", [{"stiffness": 50.0}, {"frequency": 5.0}, {"period": "1256.6370614359172 ms"}]
)
def test_linear(keys: Table) -> None:
    ends = {"between": ["a", "ground"]}
    (s,) = case_with(spring=[{**spring(law="linear", **keys), **ends}]).scene.springs
    assert isinstance(s.law, Linear)
    assert s.between == ("a", "ground")
    assert s.law.stiffness == pytest.approx(50.0, rel=CLOSE)


@pytest.mark.parametrize("mass", [5.0, "5 kg", ["a", "b"]])
def test_mass_of_a_period_that_is_not_the_body_s(mass: object) -> None:
    tables = [
        {**spring(law="linear", period="2 s", of_mass=mass), "between": ends}
        for ends in (["ground", "a"], ["a", "b"])
    ]
    for s in case_with(spring=tables).scene.springs:
        assert isinstance(s.law, Linear)
        assert s.law.stiffness == pytest.approx(5.0 * math.pi**2, rel=CLOSE)


def test_period_of_a_bouc_wen_spring_is_refused_in_one_message() -> None:
    for others in ({}, {"strength": 1}, {"strength": 1, "yield_displacement": 1}):
        text = problems(spring=[spring(law="bouc-wen", period="2 s", of_mass=4, **others)])
        assert len(text.splitlines()) == 1
        assert "[[spring]] 1: period: found '2 s'" in text
        for word in ("initial_period", "post_yield_period", "of_mass"):
            assert word in text


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"stiffness": 5, "of_mass": 4}, "of_mass: found 4; accepted: it beside a frequency"),
        ({"period": 1, "of_mass": 0}, "of_mass: found 0; accepted: a positive mass"),
        ({"period": 1, "of_mass": []}, "of_mass: found []; accepted: a positive mass"),
        ({"period": 1, "of_mass": "4 m"}, "of_mass: found '4 m': 'm' is no unit of mass"),
        ({"period": 1, "of_mass": ["a", "a"]}, "a list of different bodies, of a, b"),
        ({"period": 1, "of_mass": ["c"]}, "of_mass: found ['c']; accepted: a positive mass"),
        ({"period": 1, "of_mass": [["a"]]}, "of_mass: found [['a']]"),
        ({"period": 1, "frequency": 1}, "one of frequency and period; period says 78.9"),
        ({"period": 1, "between": ["a", "b"]}, "period: found 1; accepted: stiffness, or of_mass"),
        ({"period": -1}, "period: found -1; accepted: a positive period"),
        ({"frequency": -1}, "frequency: found -1; accepted: a frequency that is not negative"),
        ({"initial_period": 1}, "initial_period: unknown key"),
    ],
)
def test_wrong_frequencies_and_masses(keys: Table, said: str) -> None:
    assert said in problems(spring=[spring(law="linear", **keys)])


def test_periods_that_contradict_a_stiffness() -> None:
    keys: Table = {"initial_stiffness": 9.0, "initial_period": 1, "strength": 1, "stiffness": 1}
    said = problems(spring=[spring(law="bouc-wen", **keys)])
    assert "initial_stiffness: found 9.0; accepted: one of initial_stiffness and initial_p" in said
