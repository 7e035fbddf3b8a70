"""Where the time of a step goes: ``python -m tests.benchmarks.overheads``.

One elastic oscillator, right-hand side in plain Python, driven through CVODE in
two ways and by SciPy's LSODA; then P1 by the reference solver, in two ways. Microseconds a
step, median of five runs.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp
from sksundae.cvode import CVODE

from eventpound.solvers.base import Task
from eventpound.solvers.cvode import Cvode
from eventpound.solvers.events.loop import EventLoop
from eventpound.solvers.sundials.python_cvode import WrappedCvode
from tests.benchmarks import yardsticks

END, RTOL = 100.0, 1e-9


def _rate(t: float, y: np.ndarray, yp: np.ndarray) -> None:
    yp[0] = y[1]
    yp[1] = -y[0]


def _solver() -> CVODE:
    return CVODE(_rate, method="Adams", rtol=RTOL, atol=RTOL, max_num_steps=100_000)


def by_solve() -> tuple[int, int]:
    """CVODE: all internal steps in one call."""
    solution = _solver().solve(np.array([0.0, END]), np.array([1.0, 0.0]))
    return len(solution.t) - 1, solution.nfev


def by_step() -> tuple[int, int]:
    """CVODE: each internal step asked for from Python."""
    solver = _solver()
    solver.init_step(0.0, np.array([1.0, 0.0]))
    steps, t = 0, 0.0
    while t < END:
        result = solver.step(END, "onestep", END)
        steps, t = steps + 1, result.t
    return steps, result.nfev


def by_lsoda() -> tuple[int, int]:
    """SciPy's LSODA."""
    solution = solve_ivp(
        lambda t, y: (y[1], -y[0]), (0.0, END), [1.0, 0.0], method="LSODA", rtol=RTOL, atol=RTOL
    )
    return len(solution.t) - 1, solution.nfev


def by_reference() -> tuple[int, int]:
    """P1 by the reference solver, events, extremes and audit included."""
    run = Cvode().solve(_p1())
    return run.work.steps, run.work.rhs


def by_wrapped() -> tuple[int, int]:
    """The same where each step is asked for through scikit-sundae."""
    run = EventLoop(_p1(), WrappedCvode(RTOL, "Adams")).run()
    return run.work.steps, run.work.rhs


def _p1() -> Task:
    task = yardsticks.load()["P1"].task
    return Task(task.scene, task.start, task.end, RTOL)


def measure(run: Callable[[], tuple[int, int]]) -> tuple[int, int, float]:
    """Steps, calls of the right-hand side, and microseconds a step."""
    steps, calls = run()
    seconds = []
    for _ in range(5):
        start = time.process_time()
        run()
        seconds.append(time.process_time() - start)
    return steps, calls, 1e6 * statistics.median(seconds) / steps


def main() -> None:
    """Print the table."""
    print("| way | steps | rhs | µs a step |\n| --- | --- | --- | --- |")
    for run in (by_solve, by_step, by_lsoda, by_reference, by_wrapped):
        steps, calls, microseconds = measure(run)
        print(f"| {run.__doc__} | {steps} | {calls} | {microseconds:.1f} |")


if __name__ == "__main__":
    main()
