"""IDA beside CVODE on the solved problems: ``python -m tests.benchmarks.ida [RTOL]``.

For each problem the largest error of both (extremes, final state and event times,
as parts of their scales), what they cost, the drift of resting contacts, and the
part of the time that the event loop covers with the Taylor series both share.
"""

from __future__ import annotations

import statistics
import sys
import time

from eventpound.errors import ComputationError
from eventpound.simulation import simulate
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task
from eventpound.solvers.cvode import integrator
from eventpound.solvers.events import loop as event_loop
from eventpound.solvers.events.loop import EventLoop
from tests.reference.comparison import compare
from tests.reference.problems import Problem, load

REPEATS = 3
COLUMNS = (
    "problem", "error cvode", "error ida", "rhs", "residuals", "Jacobians", "steps cvode",
    "steps ida", "ms cvode", "ms ida", "drift", "shared",
)  # fmt: skip


def local_share(problem: Problem, rtol: float) -> float:
    """Part of the run that the event loop's own series cover."""
    loop = EventLoop(Task(problem.scene, 0.0, problem.end, rtol), integrator(rtol, "Adams"))
    covered, settle = [], event_loop.settle_instant

    def counted(now, piece):
        before = now.t
        settle(now, piece)
        covered.append(now.t - before)

    event_loop.settle_instant = counted
    try:
        loop.run()
    finally:
        event_loop.settle_instant = settle
    return sum(covered) / problem.end


def _seconds(solver: str, task: Task) -> float:
    """Processor time of a run (s)."""
    began = time.process_time()
    solver_named(solver).solve(task)
    return time.process_time() - began


def row(problem: Problem, rtol: float) -> list[str]:
    """One line of the table."""
    errors, runs, times = [], [], []
    task = Task(problem.scene, 0.0, problem.end, rtol)
    for solver in ("cvode", "ida"):
        response = simulate(problem.scene, solver, rtol, duration=problem.end)
        values = compare(problem, response, 1e-8).errors
        # The time of a peak errs as the root of what the peak errs.
        errors.append(max(v for k, v in values.items() if k != "extreme_times"))
        taken = [_seconds(solver, task) for _ in range(REPEATS)]
        runs.append(response.recording)
        times.append(1e3 * statistics.median(taken))
    work = [run.work for run in runs]
    drift = runs[1].drift
    return [
        problem.name,
        *(f"{e:.0e}" for e in errors),
        str(work[0].rhs),
        str(work[1].rhs),
        str(work[1].jacobian),
        *(str(w.steps) for w in work),
        *(f"{t:.1f}" for t in times),
        f"{max(drift.gap, drift.gap_rate):.0e}",
        f"{100.0 * local_share(problem, rtol):.1f} %",
    ]


def main() -> None:
    """Print the table."""
    rtol = float(sys.argv[1]) if len(sys.argv) > 1 else 1e-10
    print("| " + " | ".join(COLUMNS) + " |")
    print("|" + " --- |" * len(COLUMNS))
    for problem in load().values():
        try:
            print("| " + " | ".join(row(problem, rtol)) + " |", flush=True)
        except ComputationError as error:
            print(f"| {problem.name} | {error} |")


if __name__ == "__main__":
    main()
