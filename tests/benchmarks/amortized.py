"""What a run costs among many: ``python -m tests.benchmarks.amortized [--runs 500]``.

Each problem of `tests.benchmarks.yardsticks` is computed many times in one call of
`simulate_many` on one worker, which shares the cost of Python; the smallest of
several times, divided by the number of runs, stands beside the error of the run
and the time of the hand-written C program of the same method where there is one.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace

import numpy as np

from eventpound import simulate_many
from eventpound.solvers import solver_named
from tests.benchmarks import contenders, yardsticks
from tests.benchmarks.answers import answer_of, deviation
from tests.benchmarks.problem import Problem

REPEATS = 5


def microseconds(problem: Problem, rtol: float, runs: int) -> float:
    """Time of one run among many (µs)."""
    task = problem.task
    contact = task.scene.contacts[0]
    gaps = {f"contact.{contact.name}.gap": np.full(runs, contact.gap)}
    times = []
    for _ in range(REPEATS):
        began = time.perf_counter()
        simulate_many(task.scene, gaps, rtol=rtol, duration=task.end - task.start, workers=1)
        times.append(time.perf_counter() - began)
    return 1e6 * min(times) / runs


def beside(problem: Problem, rtol: float) -> str:
    """Time of the C program of the same method at this tolerance (µs), where it runs."""
    program = contenders.contenders().get("C Taylor")
    if program is None or problem.name not in contenders.problems():
        return "-"
    return f"{1e3 * contenders.measure(problem, program, rtol, 5.0).milliseconds:.3g}"


def main(arguments: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.amortized")
    parser.add_argument("--runs", type=int, default=500)
    parser.add_argument("--rtol", nargs="+", type=float, default=[1e-6, 1e-9])
    options = parser.parse_args(arguments)
    print("| problem | rtol | error | µs a run | C, same method (µs) |")
    print("|" + " --- |" * 5)
    for problem in yardsticks.load().values():
        for rtol in options.rtol:
            task = replace(problem.task, rtol=rtol)
            found = answer_of(solver_named("fast").solve(task))
            error = deviation(found, problem.answer, task.end).error
            cost = microseconds(problem, rtol, options.runs)
            print(
                f"| {problem.name} | {rtol:g} | {error:.1e} | {cost:.3g} | "
                f"{beside(problem, rtol)} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
