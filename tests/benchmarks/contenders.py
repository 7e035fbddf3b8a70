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
from eventpound.solvers import solver_named, solver_names
from eventpound.solvers.base import Task
from tests.benchmarks import scipy_baseline, yardsticks
from tests.benchmarks.answers import answer_of, deviation
from tests.benchmarks.c_programs import CProgram
from tests.benchmarks.diffrax_baseline import Diffrax
from tests.benchmarks.numbalsoda_baseline import NumbaLsoda
from tests.benchmarks.opensees_baseline import OpenSees
from tests.benchmarks.oscillator import oscillator_of
from tests.benchmarks.problem import Problem
from tests.benchmarks.runs import OVERLAP, Run, milliseconds_at
from tests.benchmarks.scipy_baseline import BaselineRun

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
            return replace(_NOTHING, trouble=str(error).partition(";")[0])
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
