"""One measured run of a problem, and the time that a solver takes at a given error."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from statistics import median

import numpy as np

from eventpound.errors import ComputationError
from eventpound.solvers import solver_named
from tests.benchmarks import scipy_baseline
from tests.benchmarks.answers import answer_of, deviation
from tests.benchmarks.problem import Problem

REPEATS = 3
"""Runs whose median time is quoted."""
LONG = 2.0
"""A run that takes longer (s) is quoted from one."""
OVERLAP = 1e-3
"""Penetration, as a part of the largest |u|, from which it is remarked upon."""


class Method(StrEnum):
    """What solves a problem."""

    CVODE = "cvode"
    LSODA = "LSODA"
    DOP853 = "DOP853"


@dataclass(frozen=True)
class Run:
    """A measured run.

    Parameters
    ----------
    rtol : float
        Its tolerance.
    milliseconds : float
        Processor time, the median of some.
    error : float
        Part of scale; see `answers`.
    remark : str
        What is wrong with it: it did not end, has other impacts, or overlaps.
    """

    rtol: float
    milliseconds: float
    error: float
    remark: str = ""

    def __str__(self) -> str:
        """The error, and what is wrong."""
        number = "-" if math.isnan(self.error) else f"{self.error:.1e}"
        return f"{number}, {self.remark}" if self.remark else number


def measure(
    problem: Problem, method: Method, rtol: float, seconds: float, repeats: int = REPEATS
) -> Run:
    """Run a problem some times and judge the answer.

    Parameters
    ----------
    problem : Problem
        What to run.
    method : Method
        What runs it.
    rtol : float
        Relative tolerance.
    seconds : float
        Processor time after which SciPy is given up (s).
    repeats : int
        Runs whose median time is taken; a long one is not repeated.
    """

    def once() -> Run:
        return (
            _eventpound(problem, rtol)
            if method is Method.CVODE
            else _scipy(problem, method, rtol, seconds)
        )

    run, spent = _timed(once)
    times = [spent]
    while len(times) < repeats and spent < LONG:
        times.append(_timed(once)[1])
    return replace(run, milliseconds=1e3 * median(times))


def _timed(once: Callable[[], Run]) -> tuple[Run, float]:
    began = time.process_time()
    run = once()
    return run, time.process_time() - began


def _eventpound(problem: Problem, rtol: float) -> Run:
    try:
        recording = solver_named("cvode").solve(replace(problem.task, rtol=rtol))
    except ComputationError as error:
        return Run(rtol, math.nan, math.nan, f"failed {str(error).partition(';')[0]}")
    far = deviation(answer_of(recording), problem.answer, problem.task.end)
    return Run(rtol, math.nan, far.error, far.remark)


def _scipy(problem: Problem, method: Method, rtol: float, seconds: float) -> Run:
    run = scipy_baseline.solve(replace(problem.task, rtol=rtol), method.value, seconds)
    error, remark = math.nan, run.trouble
    if not remark:
        far = deviation(run.answer, problem.answer, problem.task.end)
        error, remark = far.error, far.remark
        overlap = run.penetration / problem.answer.length
        if overlap > OVERLAP:
            remark = f"{remark}, overlaps by {overlap:.0e}".removeprefix(", ")
    return Run(rtol, math.nan, error, remark)


def milliseconds_at(error: float, runs: Sequence[Run]) -> float:
    """Time in which a method gets to an error, between its runs (log-log).

    Parameters
    ----------
    error : float
        Part of scale.
    runs : sequence of Run
        Of one problem by one method at several tolerances; those with a remark
        do not count, nor those that a faster one surpasses.

    Returns
    -------
    float
        Processor time (ms); that of the fastest where all are better, not a number
        where none is good enough.
    """
    front: list[Run] = []
    for run in sorted((r for r in runs if not r.remark), key=lambda r: r.milliseconds):
        if not front or run.error < front[-1].error:
            front.append(run)
    if not front or error < front[-1].error:
        return math.nan
    # An error of zero has no logarithm; rounding is its floor.
    errors = np.log([max(run.error, np.finfo(float).eps) for run in reversed(front)])
    times = np.log([run.milliseconds for run in reversed(front)])
    return float(np.exp(np.interp(math.log(error), errors, times)))
