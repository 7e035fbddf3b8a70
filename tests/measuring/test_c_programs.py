"""The hand-written program gives the yardstick answers where a C compiler is present."""

from __future__ import annotations

from dataclasses import replace

import pytest
from scipy.special import hyp2f1

from eventpound.solvers import solver_named
from eventpound.solvers.base import EventKind
from tests.benchmarks import c_programs, yardsticks
from tests.benchmarks.answers import deviation
from tests.benchmarks.c_programs import CProgram
from tests.benchmarks.oscillator import oscillator_of

PROBLEMS = {n: p for n, p in yardsticks.load().items() if oscillator_of(p.task)}
TAYLOR = CProgram("C Taylor", "taylor.c")
STORED = 1e-11
"""What the stored answers are good to, as a part of scale."""
needs_compiler = pytest.mark.skipif(c_programs.compiler() is None, reason="no C compiler")


def test_problems_have_one_body_and_one_barrier():
    assert sorted(PROBLEMS) == ["P1", "P2", "P3", "P4", "P7", "PZ"]


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


@needs_compiler
def test_program_rests_and_detaches_when_it_should():
    task = PROBLEMS["PZ"].task
    found = TAYLOR.answer(replace(task, rtol=1e-9))
    events = solver_named("cvode").solve(replace(task, rtol=1e-9)).events
    (rest,) = (event.t for event in events if event.kind is EventKind.REST)
    (detachment,) = (event.t for event in events if event.kind is EventKind.DETACHMENT)
    # The stored rest is where the closing speed falls to 1e-7, 6e-7 s before the limit.
    assert found.rest == pytest.approx(rest, abs=1e-8 * task.end)
    assert found.detachment == pytest.approx(detachment, abs=1e-8 * task.end)
    # Speeds halve at least from 0.31 to 1e-15 of it: 48 impacts or a few more.
    assert 40 <= found.impacts <= 60


@needs_compiler
@pytest.mark.parametrize("z", [0.1, 0.3, 0.6, 0.9, 0.99, 1.0 - 1e-6])
def test_loading_curve_is_the_inverse_of_a_hypergeometric_function(z):
    # d xi = dz / (1 - z^20). Rounding of z^20 beside 1 costs xi 1e-16 / (1 - z^20), and its
    # Phi that times the slope: nothing.
    xi = z * hyp2f1(1.0, 0.05, 1.05, z**20)
    assert TAYLOR.loading_curve(xi) == pytest.approx(z, abs=4e-15)
