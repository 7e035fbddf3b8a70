"""Dashpots by a ratio of critical damping."""

import math

import pytest

from eventpound.scene import Dashpot
from tests.case.test_damping import HYSTERETIC
from tests.case.test_springs import CLOSE, Table, case_with, problems, spring


@pytest.mark.parametrize(
    ("refers_to", "expected"),
    [
        ("initial-stiffness", 2 * 0.05 * math.sqrt(72.0 * 2.0)),
        ("post-yield-stiffness", 2 * 0.05 * math.sqrt(8.0 * 2.0)),
        ("6 rad/s", 2 * 0.05 * 2.0 * 6.0),
        (6.0, 2 * 0.05 * 2.0 * 6.0),
        ("0.5 s", 2 * 0.05 * 2.0 * 4.0 * math.pi),
    ],
)
def test_damping_ratio(refers_to, expected):
    dashpot: Table = {"between": ["a", "ground"], "ratio": "5 %", "refers_to": refers_to}
    (found,) = case_with(spring=[HYSTERETIC], dashpot=[dashpot]).scene.dashpots
    assert found.coefficient == pytest.approx(expected, rel=CLOSE)


def test_ratio_of_springs_in_parallel():
    linear = [spring(law="linear", stiffness=k) for k in (10.0, 8.0)]
    dashpot: Table = {"between": ["ground", "a"], "ratio": 0.5}
    (found,) = case_with(spring=linear, dashpot=[dashpot]).scene.dashpots
    assert found == Dashpot(("ground", "a"), 6.0)


def test_ratio_beside_a_kinked_spring_is_of_its_stiffness_at_rest():
    kinked = spring(law="bilinear-elastic", compression=0.0, extension=8.0, name="cable")
    dashpot: Table = {"between": ["ground", "a"], "ratio": 0.5}
    # 2 xi sqrt(k m), m = 2.
    (found,) = case_with(spring=[{**kinked, "offset": -0.1}], dashpot=[dashpot]).scene.dashpots
    assert found.coefficient == pytest.approx(4.0, rel=CLOSE)
    said = problems(spring=[{**kinked, "offset": 0.1}], dashpot=[dashpot])
    assert "coefficient; spring 'cable' does not resist at rest, refer to a frequency" in said


def test_hertz_is_refused_for_what_a_ratio_refers_to():
    dashpot: Table = {"between": ["ground", "a"], "ratio": 0.5, "refers_to": "1 Hz"}
    assert "refers_to: found '1 Hz'" in problems(spring=[HYSTERETIC], dashpot=[dashpot])
