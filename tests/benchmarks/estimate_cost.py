"""What the estimate of a single run's error costs, in parts of the run.

``python -m tests.benchmarks.estimate_cost [TURNS] [--checkout OTHER]``

Processor time of `cvode` at rtol 1e-9 with a history of 1 001 rows, of the estimate that a
default run makes beside it, and of what is asked of a run of `fast`: whether to make one. With
OTHER, a checkout with a Python of its own in `.venv`, also in parts of what `cvode` takes there,
turn by turn. Medians of the turns, in which the best of some runs counts.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__)
CHECKOUT = HERE.parents[2]
BRIDGE = HERE.parent / "frozen" / "bridge-el-centro"
ROWS, RTOL = 1001, 1e-9
REPEATED = 12


def tasks() -> dict[str, Any]:
    """The yardsticks and a bridge under a record, with a history."""
    from eventpound import load_case, simulate
    from tests.benchmarks import yardsticks

    found = {name: problem.task for name, problem in yardsticks.load().items()}
    found["bridge"] = replace(simulate(load_case(BRIDGE), "fast").task, progress=None)
    return {
        name: replace(task, rtol=RTOL, output_times=np.linspace(task.start, task.end, ROWS))
        for name, task in found.items()
    }


def best(call: Callable[[], object]) -> float:
    """Processor time (ms), the best of some; of few where one takes long."""
    times: list[float] = []
    while len(times) < REPEATED and sum(times) < 500.0:
        began = time.process_time()
        call()
        times.append(1e3 * (time.process_time() - began))
    return min(times)


def work(estimates: bool) -> None:
    """Measure once for each line of the input: cvode and, where wanted, estimates."""
    from eventpound.solvers import solver_named

    cases, cvode = tasks(), solver_named("cvode")
    calls: dict[str, list[Callable[[], object]]] = {
        name: [lambda task=task: cvode.solve(task)] for name, task in cases.items()
    }
    if estimates:
        from eventpound.accuracy.estimate import default_estimate
        from eventpound.response import Response

        for name, task in cases.items():
            for solver in ("cvode", "fast"):
                run = Response(task, solver, solver_named(solver).solve(task))
                calls[name].append(lambda run=run: default_estimate(run))
    for each in calls.values():
        for call in each:
            call()
    for _ in sys.stdin:
        print(json.dumps({name: [best(call) for call in each] for name, each in calls.items()}))
        sys.stdout.flush()


def worker(python: str, checkout: Path, *words: str) -> subprocess.Popen[str]:
    """This program in a process of its own, on the package of a checkout."""
    return subprocess.Popen(
        [python, str(HERE), "--worker", *words],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        cwd=checkout,
        env=os.environ | {"PYTHONPATH": str(checkout)},
    )


def turn(process: subprocess.Popen[str]) -> dict[str, list[float]]:
    """One measurement of a worker (ms)."""
    assert process.stdin is not None
    assert process.stdout is not None
    process.stdin.write("\n")
    process.stdin.flush()
    found: dict[str, list[float]] = json.loads(process.stdout.readline())
    return found


def main(turns: int, checkout: Path | None) -> None:
    """Measure in turns and print a table."""
    ours = worker(sys.executable, CHECKOUT, "--estimates")
    other = checkout and worker(str(checkout / ".venv/bin/python"), checkout.resolve())
    seen = [(turn(ours), turn(other) if other else None) for _ in range(turns)]
    print("| problem | `cvode` (ms) | estimate (ms) | part (%) | `cvode` there (ms) | part (%) "
          "| asked of `fast` (µs) |")  # fmt: skip
    print("| --- " * 7 + "|")
    for name in seen[0][0]:
        run, estimate, asked = np.median([mine[name] for mine, _ in seen], axis=0)
        there = float(np.median([theirs[name][0] for _, theirs in seen if theirs] or [np.nan]))
        part = np.median([100.0 * m[name][1] / t[name][0] for m, t in seen if t] or [np.nan])
        print(f"| {name} | {run:.3g} | {estimate:.3g} | {100.0 * estimate / run:.2g} "
              f"| {there:.3g} | {part:.2g} | {1e3 * asked:.2g} |")  # fmt: skip
    for process in (ours, other):
        if process:
            process.communicate()


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("turns", nargs="?", type=int, default=5)
    parser.add_argument("--checkout", type=Path)
    parser.add_argument("--worker", action="store_true")
    parser.add_argument("--estimates", action="store_true")
    asked_for = parser.parse_args()
    if asked_for.worker:
        work(asked_for.estimates)
    else:
        main(asked_for.turns, asked_for.checkout)
