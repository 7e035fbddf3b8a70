"""The solved problems, every one, at the tightest and at a loose tolerance."""

from __future__ import annotations

import pytest

from eventpound.simulation import simulate
from tests.reference.comparison import compare
from tests.reference.problems import load

PROBLEMS = load()


@pytest.mark.parametrize("name", PROBLEMS)
@pytest.mark.parametrize(("rtol", "accuracy"), [(1e-12, 1e-9), (1e-6, 1e-4)])
def test_solved_problem(name, rtol, accuracy):
    problem = PROBLEMS[name]
    response = simulate(problem.scene, "cvode", rtol, duration=problem.end)
    assert compare(problem, response, accuracy).failures == []
