"""What a run costs among many: ``python -m tests.benchmarks.amortized [--runs 4096]``.

With ``--calls`` it prints what one costs in a call of its own: `simulate` without an estimate,
and runs of a prepared scene, with the same numbers, another gap, another strength.

Each problem of `tests.benchmarks.yardsticks` is computed many times in one call of
`simulate_many` on one worker, which shares the cost of Python, in turns with the
hand-written C program of the same method where there is one. The smallest processor
time of several calls, divided by the number of runs, stands beside the error of the
run, the same of the C program, and the ratio of the two. Processor time is what a
busy machine leaves as it is, but for its caches.
"""

import argparse
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import count

import numpy as np

from eventpound import BoucWen, prepare, simulate, simulate_many
from eventpound.solvers import solver_named
from tests.benchmarks import yardsticks
from tests.benchmarks.answers import answer_of, deviation
from tests.benchmarks.c_programs import CProgram
from tests.benchmarks.oscillator import oscillator_of
from tests.benchmarks.problem import Problem

REPEATS = 9
CALLS = 50
"""Runs one after the other, each by a call of its own."""
C_RUNS = 200
"""Runs of the C program in one call."""


def many(problem: Problem, rtol: float, runs: int) -> Callable[[], object]:
    """The run a number of times by one worker."""
    task = problem.task
    contact = task.scene.contacts[0]
    gaps = {f"contact.{contact.name}.gap": np.full(runs, contact.gap)}
    end = task.end - task.start
    return lambda: simulate_many(task.scene, gaps, rtol=rtol, duration=end, workers=1)


def in_c(problem: Problem, rtol: float) -> Callable[[], object] | None:
    """The same by the C program, where it runs."""
    program = CProgram("C Taylor", "taylor.c")
    if program.missing() or oscillator_of(problem.task) is None:
        return None
    task = replace(problem.task, rtol=rtol)
    return lambda: program.repeat(task, C_RUNS)


def microseconds(calls: list[tuple[Callable[[], object], int]]) -> list[float]:
    """Smallest processor time of a run by each of several calls of many runs (µs)."""
    best = [np.inf] * len(calls)
    for _ in range(REPEATS):
        for i, (call, runs) in enumerate(calls):
            began = time.process_time()
            call()
            best[i] = min(best[i], 1e6 * (time.process_time() - began) / runs)
    return best


def calls_of(problem: Problem, rtol: float, solver: str) -> list[tuple[Callable[[], object], int]]:
    """A run by a call of its own, in four ways."""
    task, scene = problem.task, problem.scene
    end = task.end - task.start
    prepared = prepare(scene, solver, rtol, duration=end)
    gap, strength = f"contact.{scene.contacts[0].name}.gap", f"spring.{scene.springs[0].name}"
    law = scene.springs[0].law
    name = "strength" if isinstance(law, BoucWen) else "stiffness"
    growing = count(1)

    def with_other(key: str, own: float) -> Callable[[], object]:
        return lambda: prepared.run({key: own * (1.0 + 1e-9 * next(growing))})

    options = {"duration": end, "output_step": end, "error_estimate": False}
    ways = (
        lambda: simulate(scene, solver, rtol, **options),
        prepared.run,
        with_other(gap, scene.contacts[0].gap),
        with_other(f"{strength}.{name}", getattr(law, name)),
    )
    return [(partial(_repeat, way), CALLS) for way in ways]


def _repeat(call: Callable[[], object]) -> None:
    for _ in range(CALLS):
        call()


def print_calls(names: list[str], tolerances: list[float]) -> None:
    """Print the table of single calls."""
    print("| problem | solver | rtol | simulate (µs) | prepared | another gap | another strength |")
    print("|" + " --- |" * 7)
    for problem in (yardsticks.load()[name] for name in names):
        for solver in ("fast", "cvode"):
            for rtol in tolerances:
                found = microseconds(calls_of(problem, rtol, solver))
                shown = " | ".join(f"{each:.3g}" for each in found)
                print(f"| {problem.name} | {solver} | {rtol:g} | {shown} |", flush=True)


def main(arguments: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.amortized")
    parser.add_argument("--runs", type=int, default=4096)
    parser.add_argument("--rtol", nargs="+", type=float, default=[1e-6, 1e-9])
    parser.add_argument("--problems", nargs="+", default=list(yardsticks.load()))
    parser.add_argument("--calls", action="store_true")
    options = parser.parse_args(arguments)
    if options.calls:
        print_calls(options.problems, options.rtol)
        return
    print("| problem | rtol | error | µs a run | C, same method (µs) | ratio |")
    print("|" + " --- |" * 6)
    for problem in (yardsticks.load()[name] for name in options.problems):
        for rtol in options.rtol:
            task = replace(problem.task, rtol=rtol)
            found = answer_of(solver_named("fast").solve(task))
            error = deviation(found, problem.answer, task.end).error
            calls, beside = [(many(problem, rtol, options.runs), options.runs)], in_c(problem, rtol)
            if beside is not None:
                calls.append((beside, C_RUNS))
            ours, *theirs = microseconds(calls)
            compared = f"{theirs[0]:.3g} | {ours / theirs[0]:.2f}" if theirs else "- | -"
            print(
                f"| {problem.name} | {rtol:g} | {error:.1e} | {ours:.3g} | {compared} |", flush=True
            )


if __name__ == "__main__":
    main()
