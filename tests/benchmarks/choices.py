"""What was measured to choose how CVODE is used; the tables of docs/measured/choices.md.

``python -m tests.benchmarks.choices``
"""

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any
from unittest.mock import patch

import numpy as np

from eventpound.mechanics.ground_frame import NO_FRAME
from eventpound.solvers import solver_named
from eventpound.solvers.base import Recording, Task
from eventpound.solvers.cvode import integrator
from eventpound.solvers.events.loop import EventLoop
from eventpound.solvers.events.roots import EVENTS
from tests.reference.problems import Problem, load

TOLERANCES = (1e-6, 1e-8, 1e-10)
AT = tuple(f"{rtol:.0e}" for rtol in TOLERANCES)
REPEATS = 7


def _run(problem: Problem, rtol: float, method: str) -> Recording:
    task = Task(problem.scene, 0.0, problem.end, rtol)
    return EventLoop(task, integrator(rtol, method)).run()


def _error(problem: Problem, run: Recording) -> float:
    """Error of the smallest displacements as part of the largest."""
    wanted = np.array([float(value) for value in problem.result["u_min"]])
    return float(np.abs(run.displacement.minimum - wanted).max() / np.abs(wanted).max())


@contextmanager
def _variant(*, frame: bool, stops: bool) -> Iterator[None]:
    events = "eventpound.solvers.events."
    settings: dict[str, Any] = {"loop.STOP_AT_SAMPLES": math.inf if stops else 0.0}
    if not frame:
        settings["loop.moving_frame"] = lambda piece: NO_FRAME
    patches = [patch(events + name, value) for name, value in settings.items()]
    for item in patches:
        item.start()
    try:
        yield
    finally:
        for item in patches:
            item.stop()


def _table(*columns: str) -> None:
    """Begin one; cells of tolerances are calls of the right-hand side and error."""
    _row(*columns)
    _row(*["---"] * len(columns))


def _row(*cells: str) -> None:
    print("| " + " | ".join(cells) + " |", flush=True)


def _line(first: str, second: str, problem: Problem, method: str) -> None:
    runs = [_run(problem, rtol, method) for rtol in TOLERANCES]
    _row(first, second, *(f"{run.work.rhs}, {_error(problem, run):.0e}" for run in runs))


def methods() -> None:
    """Adams against BDF on pulses and records."""
    _table("problem", "method", *AT)
    problems = load()
    for name in ("A01", "A10", "A20", "B12", "E01"):
        for method in ("Adams", "BDF"):
            _line(name, method, problems[name], method)


def records() -> None:
    """Coordinates and stops for a sampled record."""
    _table("record", "coordinates", *AT)
    problems = load()
    for name in ("F01", "E07"):
        for frame in (False, True):
            for stops in (False, True):
                with _variant(frame=frame, stops=stops):
                    label = "moving frame" if frame else "relative"
                    label += ", stops" if stops else ", free"
                    _line(name, label, problems[name], "Adams")


def finders() -> None:
    """Time with SUNDIALS' root finder over that with the location of the loop, on either solver."""
    _table("problem", *(f"`{solver}`, {at}" for solver in ("cvode", "ida") for at in AT))
    problems = load()
    for name in ("A01", "A10", "A20", "B12", "B15", "C03", "E01", "E07", "F01"):
        problem = problems[name]
        cells = []
        for solver in ("cvode", "ida"):
            for rtol in TOLERANCES:
                own, sundials = _in_turns(Task(problem.scene, 0.0, problem.end, rtol), solver)
                cells.append(f"{sundials / own:.2f}")
        _row(name, *cells)


def _in_turns(task: Task, solver: str) -> tuple[float, ...]:
    """Shortest processor times (s) of a task, events found by the loop and by SUNDIALS."""
    taken = [math.inf] * len(EVENTS)
    for _ in range(REPEATS):
        for i, events in enumerate(EVENTS):
            began = time.process_time()
            solver_named(solver).solve(replace(task, settings={"events": events}))
            taken[i] = min(taken[i], time.process_time() - began)
    return tuple(taken)


def main() -> None:
    """Print the three tables."""
    for part in (finders, methods, records):
        part()
        print()


if __name__ == "__main__":
    main()
