"""The benchmark commands run, and the problems that trip others are right at all tolerances."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from eventpound.motion.synthetic import synthetic_motion
from eventpound.solvers import solver_named
from tests.benchmarks import rows, scipy_baseline, suite, work, yardsticks
from tests.benchmarks.answers import Answer, Impact, answer_of, deviation
from tests.benchmarks.runs import Run, milliseconds_at

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


def test_time_at_an_error_lies_on_the_line_between_runs():
    def run(milliseconds: float, error: float) -> Run:
        return Run(1e-6, milliseconds, error)

    runs = [run(1.0, 1e-2), run(100.0, 1e-6), run(50.0, 1e-1)]
    assert milliseconds_at(1e-4, runs) == pytest.approx(10.0)
    assert milliseconds_at(1.0, runs) == pytest.approx(1.0)
    assert math.isnan(milliseconds_at(1e-8, runs))


def test_work_command_prints_its_table(capsys):
    work.main(["--problems", "P4", "elastic-barrier", "--rtol", "1e-6"])
    printed = capsys.readouterr().out
    assert "| P4 | " in printed
    assert "| elastic-barrier | " in printed


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
