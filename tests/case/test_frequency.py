"""Frequencies, periods and the masses that they are of."""

import math

import pytest

from eventpound.scene import Linear
from tests.case.test_springs import CLOSE, case_with, problems, spring


@pytest.mark.parametrize("mass", [5.0, "5 kg", ["a", "b"]])
def test_mass_of_a_period_that_is_not_the_body_s(mass):
    tables = [
        {**spring(law="linear", period="2 s", of_mass=mass), "between": ends}
        for ends in (["ground", "a"], ["a", "b"])
    ]
    for s in case_with(spring=tables).scene.springs:
        assert isinstance(s.law, Linear)
        assert s.law.stiffness == pytest.approx(5.0 * math.pi**2, rel=CLOSE)


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
def test_wrong_frequencies_and_masses(keys, said):
    assert said in problems(spring=[spring(law="linear", **keys)])
