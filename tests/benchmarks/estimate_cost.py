"""What the estimate of a single run's error costs, beside the run.

``python -m tests.benchmarks.estimate_cost [TURNS]``

Processor time of a run at rtol 1e-9 with a history of 1 001 rows, and of its estimate: of `cvode`
by `fast` and, as on a fresh installation, by itself; of `fast` by itself. Medians of the turns,
in which the best of some runs counts. Everything is compiled before.
"""

import sys
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from eventpound import Response, load_case
from eventpound.accuracy.estimate import estimate_errors
from eventpound.simulation import response_of
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task
from tests.benchmarks import yardsticks

BRIDGE = Path(__file__).parent / "frozen" / "bridge-el-centro"
ROWS, RTOL = 1001, 1e-9
REPEATED = 12
JUDGES = {"cvode": ("fast", "cvode"), "fast": ("fast",)}


def tasks() -> dict[str, Task]:
    """The yardsticks and a bridge under a record, with a history."""
    found = {name: problem.task for name, problem in yardsticks.load().items()}
    found["bridge"] = replace(response_of(load_case(BRIDGE), "fast").task, progress=None)
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


def calls_of(task: Task) -> list[Callable[[], object]]:
    """Each run, followed by its estimates."""
    found: list[Callable[[], object]] = []
    for name, judges in JUDGES.items():
        run = partial(solver_named(name).solve, task)
        response = Response(task, name, run())
        found += [run, *(partial(estimate_errors, response, judge) for judge in judges)]
    return found


def main(turns: int) -> None:
    """Measure and print a table."""
    calls = {name: calls_of(task) for name, task in tasks().items()}
    for each in calls.values():
        for call in each:
            call()
    seen = [{name: [best(call) for call in calls[name]] for name in calls} for _ in range(turns)]
    print("| problem | `cvode` (ms) | by `fast` (ms) | by itself (ms) "
          "| `fast` (ms) | by itself (ms) |")  # fmt: skip
    print("| --- " * 6 + "|")
    for name in calls:
        times = np.median([turn[name] for turn in seen], axis=0)
        print(f"| {name} | " + " | ".join(f"{ms:.3g}" for ms in times) + " |", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]) if sys.argv[1:] else 5)
