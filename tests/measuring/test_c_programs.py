"""The hand-written program gives the yardstick answers where a C compiler is present."""

from dataclasses import replace

import pytest

from tests.benchmarks import c_programs, yardsticks
from tests.benchmarks.answers import deviation
from tests.benchmarks.c_programs import CProgram
from tests.benchmarks.oscillator import oscillator_of

PROBLEMS = {n: p for n, p in yardsticks.load().items() if oscillator_of(p.task)}
TAYLOR = CProgram("C Taylor", "taylor.c")
STORED = 1e-11
"""What the stored answers are good to, as a part of scale."""
needs_compiler = pytest.mark.skipif(c_programs.compiler() is None, reason="no C compiler")


@needs_compiler
@pytest.mark.parametrize("name", PROBLEMS)
@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-9, 1e-12])
def test_program_gives_the_yardstick_answer(name, rtol):
    problem = PROBLEMS[name]
    found = TAYLOR.solve(replace(problem.task, rtol=rtol))
    far = deviation(found, problem.answer, problem.task.end)
    assert far.remark == ""
    # Errors of a hundred steps of a tenth of rtol each, amplified by a few impacts.
    assert far.error <= 100.0 * rtol + STORED
