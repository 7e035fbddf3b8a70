"""The benchmark commands run, and the problems that trip others are right at all tolerances."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from eventpound.motion.synthetic import synthetic_motion
from eventpound.solvers import solver_named
from tests.benchmarks import rows, scipy_baseline, suite, yardsticks
from tests.benchmarks.answers import Answer, Impact, answer_of, deviation
from tests.benchmarks.peers import __main__ as peers
from tests.benchmarks.peers.programs import PROGRAMS, lines_of

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


def test_record_of_p7_is_the_sum_written_down():
    t = 5.0
    expected = (
        math.exp(-(((t - 6.0) / 3.0) ** 2))
        * sum(math.sin(1.7 * j**1.3 * t + j * j) for j in range(1, 26))
        / 5.0
    )
    # Rounding of phases up to 1200 rad, 25 of them.
    assert yardsticks.record_samples()[1000] == pytest.approx(expected, abs=1e-11)


def test_deviation_counts_impacts_and_takes_the_largest_error():
    still = np.zeros(1)
    true = Answer(np.array([-2.0]), still, still, (Impact(1.0, 0, 1.0), Impact(2.0, 0, 1e-5)))
    late = replace(true, impacts=(Impact(1.5, 0, 1.0),))
    assert deviation(true, true, 10.0).error == 0.0
    # The slow impact is missed without harm; the other is 0.5 s of 10 s late.
    assert deviation(late, true, 10.0).error == pytest.approx(0.05)
    assert deviation(replace(late, u_min=np.array([-1.5])), true, 10.0).error == 0.25
    assert deviation(replace(true, impacts=()), true, 10.0).remark == "0 impacts, not 1"


def test_program_of_peers_gets_to_the_error_at_the_loosest_tolerance_that_does():
    timed = peers.at_error(PROGRAMS["SciPy, DOP853"], YARDSTICKS["P3"])
    far = deviation(timed.call(), YARDSTICKS["P3"].answer, YARDSTICKS["P3"].task.end)
    assert (far.remark, far.error <= peers.ERROR, timed.runs) == ("", True, 1)
    # It is not written for a body that stays at its barrier.
    assert peers.at_error(PROGRAMS["SciPy, DOP853"], YARDSTICKS["PZ"]) is None


def test_cvode_from_python_follows_the_tolerance():
    problem = YARDSTICKS["P3"]
    task = replace(problem.task, rtol=1e-8)
    run = scipy_baseline.solve(task, scipy_baseline.SUNDIALS, seconds=60.0)
    far = deviation(run.answer, problem.answer, problem.task.end)
    assert (run.trouble, far.remark, far.error <= ALLOWED * 1e-8) == ("", "", True)


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


def test_lines_of_a_program_leave_out_comments_and_docstrings():
    what = '"""What\nit does."""\n\n# why\nx = 1  # so\n\n'
    text = what + 'def f():\n    """Nothing."""\n    return (\n        x\n    )\n'
    assert lines_of(text) == 5


def test_peers_command_prints_its_table(capsys):
    peers.main(["--programs", "SciPy, DOP853", "sundials4py", "--problems", "P3", "--no-bridge"])
    rows = capsys.readouterr().out.splitlines()
    assert rows[2].startswith("| SciPy, DOP853 | ")
    assert ("absent" in rows[3]) != PROGRAMS["sundials4py"].installed


@pytest.mark.sweep
def test_rows_command_prints_its_table(capsys):
    rows.main(["--bodies", "1", "3", "--end", "0.5"])
    printed = capsys.readouterr().out
    assert "| 3 | " in printed
    assert "time of a step: exponent" in printed


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
