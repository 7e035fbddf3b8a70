"""The benchmark commands run, and the problems that trip others are right at all tolerances."""

from dataclasses import replace

import pytest

from eventpound.motion.synthetic import synthetic_motion
from eventpound.solvers import solver_named
from tests.benchmarks import scipy_baseline, suite, yardsticks
from tests.benchmarks.answers import answer_of, deviation
from tests.benchmarks.peers.programs import PROGRAMS

YARDSTICKS = yardsticks.load()
ALLOWED = 1e3
"""Multiples of rtol that an error may be."""


@pytest.mark.parametrize("name", ["P1", "P3", "P4", "PZ"])
@pytest.mark.parametrize("rtol", [1e-4, 1e-8, 1e-12])
def test_errors_follow_the_tolerance(name, rtol):
    problem = YARDSTICKS[name]
    recording = solver_named("cvode").solve(replace(problem.task, rtol=rtol))
    far = deviation(answer_of(recording), problem.answer, problem.task.end)
    assert far.remark == ""
    # What the issue allows: errors of some hundred steps, amplified by a few impacts. The
    # stored answers hold to 1e-11 of scale, a hundredth of the smallest error allowed here.
    assert far.error <= ALLOWED * rtol


@pytest.mark.parametrize("method", ["LSODA", "DOP853"])
def test_baseline_solves_a_problem_without_accumulation(method):
    problem = YARDSTICKS["P3"]
    run = scipy_baseline.solve(replace(problem.task, rtol=1e-8), method, seconds=60.0)
    assert run.trouble == ""
    far = deviation(run.answer, problem.answer, problem.task.end)
    assert far.remark == ""
    assert far.error <= ALLOWED * 1e-8


OTHERS = [
    (name, problem)
    for name, program in PROGRAMS.items()
    if program.sources and program.installed and "SciPy" not in name
    for problem in program.problems.split()
]


@pytest.mark.parametrize(("name", "problem"), OTHERS)
def test_programs_of_others_are_right(name, problem):
    call, _ = PROGRAMS[name].ready(YARDSTICKS[problem], 1e-10)
    far = deviation(call(), YARDSTICKS[problem].answer, YARDSTICKS[problem].task.end)
    assert (far.remark, far.error < 1e-6) == ("", True)


def test_suite_command_prints_its_table(capsys, monkeypatch, tmp_path):
    monkeypatch.setattr(suite, "REPEATS", 1)
    motion = synthetic_motion(1, 2)
    (tmp_path / motion.name).write_bytes(motion.content)
    (tmp_path / "broken.AT2").write_text("no record\n")
    suite.main([str(tmp_path / "*")])
    printed = capsys.readouterr().out
    assert "left out broken.AT2" in printed
    assert "1 records, rtol 1e-09" in printed
    assert f"({motion.name})" in printed
