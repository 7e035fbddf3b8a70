"""The oracle against answers that others computed, and a few certificates against the oracle."""

from decimal import Decimal

import pytest

from tests.accuracy.storeys import DURATION, SCENE, TRUE
from tests.oracle.certificates import Tally, judge
from tests.oracle.program import NoAnswerError, ask, program
from tests.reference.certificates import stated_amplification
from tests.reference.problems import load

PROBLEMS = load()


@pytest.fixture(autouse=True, scope="module")
def _oracle():
    try:
        program()
    except NoAnswerError as reason:
        pytest.skip(str(reason))


def test_113_bit_answers():
    answer = ask(SCENE, 0.0, DURATION)
    for name, true in TRUE.items():
        assert abs(answer.values[name].value - true) < Decimal("5e-18")
        assert answer.values[name].uncertainty < 5e-18


@pytest.mark.parametrize("name", ["A01", "A17", "B12", "C01", "D04", "D06", "D23", "E07", "F01"])
def test_28_digit_answers(name):
    """To what the rounding of the stored frequency to a double period makes of them."""
    problem = PROBLEMS[name]
    answer = ask(problem.scene, 0.0, problem.end)
    true = {}
    for i, body in enumerate(problem.scene.bodies):
        for key in ("u_max", "u_min"):
            true[f"peaks.{body.name}.{key[2:]}"] = Decimal(problem.result[key][i])
        for key in ("u", "v"):
            true[f"final.{body.name}.{key}"] = Decimal(problem.result["final"][key][i])
    scale = float(max(abs(value) for value in true.values()))
    allowed = 2.0**-53 * stated_amplification(problem) * scale
    for key, value in true.items():
        assert abs(answer.values[key].value - value) < allowed


@pytest.mark.parametrize(
    "seed", [16, 30247, *(pytest.param(seed, marks=pytest.mark.sweep) for seed in (3, 5, 9))]
)
def test_bounds_of_random_scenes_hold(seed):
    tally = Tally()
    judge(seed, tally)
    assert tally.wrong == []
    assert tally.scenes["given"] == 1
    assert tally.bounds["checked"] > 10


def test_bounds_hold_where_a_cascade_ends_in_one_instant():
    """198 impact problems at the start; routes part later, so not all is certified."""
    tally = Tally()
    judge(30193, tally)
    assert tally.wrong == []
    assert tally.bounds["checked"] > 100
