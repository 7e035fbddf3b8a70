"""The solved problems, every one, at the tightest and at a loose tolerance."""

from __future__ import annotations

import pytest

from eventpound.simulation import simulate
from tests.reference.comparison import compare
from tests.reference.problems import load

PROBLEMS = load()


@pytest.mark.parametrize("name", PROBLEMS)
@pytest.mark.parametrize(
    ("solver", "rtol", "accuracy"),
    [("cvode", 1e-12, 1e-9), ("cvode", 1e-6, 1e-4), ("fast", 1e-12, 1e-9), ("fast", 1e-6, 1e-5)],
)
def test_solved_problem(name, solver, rtol, accuracy):
    problem = PROBLEMS[name]
    response = simulate(problem.scene, solver, rtol, duration=problem.end)
    assert compare(problem, response, accuracy).failures == []
