"""The hand-written programs give the yardstick answers where a C compiler is present."""

from __future__ import annotations

from dataclasses import replace

import pytest
from scipy.special import hyp2f1

from eventpound.solvers import solver_named
from eventpound.solvers.base import EventKind
from tests.benchmarks import c_programs, contenders
from tests.benchmarks.answers import deviation
from tests.benchmarks.c_programs import CProgram
from tests.benchmarks.numbalsoda_baseline import NumbaLsoda

PROBLEMS = contenders.problems()
STORED = 1e-11
"""What the stored answers are good to, as a part of scale."""
needs_compiler = pytest.mark.skipif(c_programs.compiler() is None, reason="no C compiler")


def test_problems_have_one_body_and_one_barrier():
    assert sorted(PROBLEMS) == ["P1", "P2", "P3", "P4", "P7", "PZ"]


@needs_compiler
@pytest.mark.parametrize("source", ["taylor.c", "runge_kutta.c"])
@pytest.mark.parametrize("name", PROBLEMS)
@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-9, 1e-12])
def test_program_gives_the_yardstick_answer(source, name, rtol):
    problem = PROBLEMS[name]
    found = CProgram("C", source).solve(replace(problem.task, rtol=rtol), 1.0)
    assert found.trouble == ""
    far = deviation(found.answer, problem.answer, problem.task.end)
    assert far.remark == ""
    # Errors of a hundred steps of a tenth of rtol each, amplified by a few impacts.
    assert far.error <= 100.0 * rtol + STORED


@needs_compiler
@pytest.mark.parametrize("source", ["taylor.c", "runge_kutta.c"])
def test_program_rests_and_detaches_when_it_should(source):
    task = PROBLEMS["PZ"].task
    found = CProgram("C", source).answer(replace(task, rtol=1e-9))
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
    assert CProgram("C", "taylor.c").loading_curve(xi) == pytest.approx(z, abs=4e-15)


def test_numbalsoda_gives_the_yardstick_answer_where_installed():
    pytest.importorskip("numbalsoda")
    problem = PROBLEMS["P3"]
    found = NumbaLsoda().solve(replace(problem.task, rtol=1e-9), 60.0)
    far = deviation(found.answer, problem.answer, problem.task.end)
    assert far.remark == ""
    assert far.error <= 100.0 * 1e-9


@needs_compiler
def test_command_prints_its_tables(capsys):
    contenders.main(["--problems", "P4", "--rtol", "1e-6", "--contenders", "cvode", "C Taylor"])
    printed = capsys.readouterr().out
    assert "| P4 | C Taylor | 1e-06 |" in printed
    assert "| problem | contender | 1e-06 | 1e-08 | 1e-10 |" in printed
