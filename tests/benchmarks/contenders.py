"""Error and time of our solvers, hand-written programs and other packages, in one table.

``python -m tests.benchmarks.contenders [--problems ...] [--contenders ...] [--rtol ...]``

Prints, in Markdown, every run (tolerance, error, time) and the time that each contender
takes at errors of 1e-6, 1e-8 and 1e-10, read off its runs (log-log). Problems are those
with one body and one barrier. A time is the best of several warm runs: of the C programs
and numbalsoda within one compiled call, of the others as called from Python. Any solver
of eventpound is a contender by its name. What is not installed is named and left out.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Protocol

from eventpound.errors import ComputationError
from eventpound.solvers import available, solver_named
from eventpound.solvers.base import Task
from tests.benchmarks import scipy_baseline, yardsticks
from tests.benchmarks.answers import answer_of, deviation
from tests.benchmarks.c_programs import CProgram
from tests.benchmarks.numbalsoda_baseline import NumbaLsoda
from tests.benchmarks.oscillator import baseline_run, oscillator_of
from tests.benchmarks.problem import Problem
from tests.benchmarks.runs import OVERLAP, Run, milliseconds_at
from tests.benchmarks.scipy_baseline import BaselineRun
from tests.benchmarks.worker import Worker

LADDER = tuple(10.0**-k for k in range(4, 13))
ERRORS = (1e-6, 1e-8, 1e-10)
TRIALS, ENOUGH = 20, 1.0
"""Runs of which the fastest counts, and total time (s) after which there are no more."""


class Contender(Protocol):
    """What solves a problem."""

    name: str

    def missing(self) -> str:
        """Why it cannot run; empty where it can."""
        ...

    def solve(self, task: Task, seconds: float) -> BaselineRun:
        """Run a task; give up after `seconds` (s)."""
        ...

    def seconds(self, task: Task) -> float:
        """Wall time of a warm run (s)."""
        ...


def _best(task: Task, contender: Contender) -> float:
    """The fastest of several runs called from Python (s)."""
    best, spent = math.inf, 0.0
    for _ in range(TRIALS):
        began = time.perf_counter()
        contender.solve(task, math.inf)
        took = time.perf_counter() - began
        best, spent = min(best, took), spent + took
        if spent > ENOUGH:
            break
    return best


# Those called from Python, timed as called.
class Eventpound:
    """A solver of eventpound."""

    def __init__(self, name: str) -> None:
        self.name = name

    def missing(self) -> str:
        return ""

    def solve(self, task: Task, seconds: float) -> BaselineRun:
        try:
            recording = solver_named(self.name).solve(task)
        except ComputationError as error:
            return baseline_run((0.0, 0.0), 0.0, [], str(error).partition(";")[0], 0.0)
        work = recording.work
        return BaselineRun(
            answer_of(recording), task.end, "", 0.0, work.rhs, work.steps, work.restarts
        )

    def seconds(self, task: Task) -> float:
        return _best(task, self)


class Scipy:
    """A method of SciPy's `solve_ivp`."""

    def __init__(self, method: str) -> None:
        self.name, self.method = f"SciPy {method}", method

    def missing(self) -> str:
        return ""

    def solve(self, task: Task, seconds: float) -> BaselineRun:
        return scipy_baseline.solve(task, self.method, seconds)

    def seconds(self, task: Task) -> float:
        return _best(task, self)


def contenders() -> dict[str, Contender]:
    """Every contender, by name: our solvers, then the hand-written, then other packages."""
    every: tuple[Contender, ...] = (
        *(Eventpound(name) for name in available()),
        CProgram("C Taylor", "taylor.c"),
        CProgram("C Runge-Kutta", "runge_kutta.c"),
        NumbaLsoda(),
        Worker("diffrax Dopri8", "diffrax", "diffrax_worker.py", "DIFFRAX_PYTHON"),
        Scipy("LSODA"),
        Scipy("DOP853"),
        Worker("OpenSeesPy", "openseespy.opensees", "opensees_worker.py", "OPENSEES_PYTHON"),
    )
    return {contender.name: contender for contender in every}


def measure(problem: Problem, contender: Contender, rtol: float, seconds: float) -> Run:
    """Run a problem, judge the answer and take the time.

    Parameters
    ----------
    problem : Problem
        What to run.
    contender : Contender
        What runs it.
    rtol : float
        Relative tolerance.
    seconds : float
        Wall time after which a run is given up (s).
    """
    task = replace(problem.task, rtol=rtol)
    found = contender.solve(task, seconds)
    if found.trouble:
        return Run(rtol, 0, 0, 0, math.nan, math.nan, found.trouble)
    far = deviation(found.answer, problem.answer, task.end)
    remark, overlap = far.remark, found.penetration / problem.answer.length
    if overlap > OVERLAP:
        remark = f"{remark}, overlaps by {overlap:.0e}".removeprefix(", ")
    milliseconds = 1e3 * contender.seconds(task)
    return Run(rtol, found.rhs, found.steps, found.restarts, milliseconds, far.error, remark)


def climb(
    problem: Problem, contender: Contender, ladder: tuple[float, ...], seconds: float
) -> Iterator[Run]:
    """Runs at smaller and smaller tolerances, until one takes too long or two fail alike."""
    failure = ""
    for rtol in sorted(ladder, reverse=True):
        run = measure(problem, contender, rtol, seconds)
        print(f"{problem.name} {contender.name} {rtol:.0e}: {run}", file=sys.stderr, flush=True)
        yield run
        failed = run.remark if math.isnan(run.milliseconds) else ""
        if run.milliseconds > 1e3 * seconds or (failed and failed == failure):
            return
        failure = failed


def problems() -> dict[str, Problem]:
    """Those of the yardstick problems that all contenders can run."""
    return {name: p for name, p in yardsticks.load().items() if oscillator_of(p.task)}


def _row(*cells: object) -> str:
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def _header(*cells: str) -> str:
    return _row(*cells) + "\n" + "|" + " --- |" * len(cells)


def _number(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.3g}"


def _chosen(known: dict[str, Contender], names: list[str]) -> list[Contender]:
    """The contenders of the given names, all where none is given, that can run here."""
    unknown = [name for name in names if name not in known]
    if unknown:
        raise SystemExit(f"no contender {', '.join(unknown)}; known: {', '.join(known)}")
    able = []
    for contender in (known[name] for name in names or known):
        lacking = contender.missing()
        if lacking:
            print(f"{contender.name} left out: {lacking}\n", flush=True)
        else:
            able.append(contender)
    return able


def main(arguments: list[str] | None = None) -> None:
    """Print both tables."""
    stored, known = problems(), contenders()
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.contenders")
    parser.add_argument("--problems", nargs="+", default=list(stored), choices=list(stored))
    parser.add_argument("--contenders", nargs="+", default=[], help=", ".join(known))
    parser.add_argument("--rtol", nargs="+", type=float, default=LADDER)
    parser.add_argument("--seconds", type=float, default=20.0, help="when a run is given up")
    options = parser.parse_args(arguments)
    chosen = _chosen(known, options.contenders)
    equal = []
    print(_header("problem", "contender", "rtol", "error", "ms"))
    for name in options.problems:
        for contender in chosen:
            runs = []
            for run in climb(stored[name], contender, tuple(options.rtol), options.seconds):
                runs.append(run)
                cells = (f"{run.rtol:.0e}", run, _number(run.milliseconds))
                print(_row(name, contender.name, *cells), flush=True)
            times = [_number(milliseconds_at(error, runs)) for error in ERRORS]
            equal.append(_row(name, contender.name, *times))
    for contender in chosen:
        if isinstance(contender, Worker):
            contender.close()
    print("\nTime in ms at equal error\n")
    print(_header("problem", "contender", *(f"{error:.0e}" for error in ERRORS)))
    print("\n".join(equal))


if __name__ == "__main__":
    main()
