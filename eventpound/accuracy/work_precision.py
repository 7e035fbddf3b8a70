"""Speed against error: one solver at one tolerance or time step, judged and timed.

The wall time is the median of several runs after a first one, which compiles and fills
caches and is reported apart. Timed runs write no history; extremes, events and the final
state are computed. The run that is judged writes one: at the times of the case or, with a
fixed step, at every step, so that nothing is lost between rows.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from statistics import median

import numpy as np

from eventpound.accuracy.quantities import errors_of
from eventpound.accuracy.reference import Reference
from eventpound.case.case import Case
from eventpound.case.solver_options import SolverOptions
from eventpound.errors import ComputationError, InputError
from eventpound.score.difference import Difference
from eventpound.simulation import solved, task_with
from eventpound.solvers import solver_named
from eventpound.solvers.base import Recording, Solver, Task, Work

STEP = "time_step"
"""The setting that makes a solver one of fixed steps."""
RESTS = "rests"
"""Attribute of a solver, False where its contacts never rest."""
LONG, ENOUGH = 2.0, 0.1
"""A run of more than `LONG` s is timed once more only; short ones up to `ENOUGH` s in all."""
MOST_REPEATS = 50
MOST_ROWS = 50_000
FASTEST_RTOL = 1e-9
"""Tolerance handed to a solver of fixed steps, which has no use for it."""


@dataclass(frozen=True)
class SolverChoice:
    """A solver with its settings, at one tolerance or one time step.

    Parameters
    ----------
    solver : str
        Its name.
    settings : mapping
        Its own settings (SI), without the time step.
    rtol : float or None
        Relative tolerance.
    time_step : float or None
        Fixed step (s); just one of the two is given.
    """

    solver: str
    settings: Mapping[str, object]
    rtol: float | None
    time_step: float | None

    @property
    def line(self) -> str:
        """What entries of one line of a diagram share."""
        return " ".join((self.solver, *(f"{k}={_brief(v)}" for k, v in self.settings.items())))

    @property
    def size(self) -> str:
        """Its tolerance or step, in words."""
        if self.time_step is not None:
            return f"step {_brief(self.time_step)} s"
        return f"rtol {_brief(self.rtol)}"

    @property
    def options(self) -> SolverOptions:
        """What a case would say in [solver]."""
        step = {} if self.time_step is None else {STEP: self.time_step}
        return SolverOptions(self.solver, self.rtol or FASTEST_RTOL, {}, {**self.settings, **step})

    def task(self, case: Case) -> Task:
        """What it is asked: the case with this tolerance or step, and rows to be judged by."""
        run = case.run
        if self.time_step is not None:
            stride = math.ceil(run.duration / (self.time_step * MOST_ROWS))
            run = run.lasting(run.duration, self.time_step * stride)
        return task_with(case.scene, replace(run, energy=False), self.options, None)


def _brief(value: object) -> str:
    """A value in few characters, 1e-4 rather than 0.0001 or 1e-04."""
    if not isinstance(value, float):
        return str(value)
    mantissa, _, exponent = f"{value:.3e}".partition("e")
    power = f"{float(mantissa):g}e{int(exponent)}"
    return min(f"{value:.4g}", power, key=len)


@dataclass(frozen=True)
class Judged:
    """A run with its errors and cost.

    Parameters
    ----------
    label, size : str
        Its line in a diagram, and its tolerance or step.
    entry : SolverChoice or None
        What was run; None for a history of another program.
    errors : Difference or None
        None where it failed.
    work : Work
        Cost; steps are zero for a history of another program.
    seconds, first_seconds : float
        Median wall time, and how much longer the first run took (s); NaN where not known.
    repeats : int
        Runs of which the median was taken.
    remark : str
        Why it failed, or what has to be said of it.
    rigid : Difference or None
        Against the rigid law, where the contacts have others.
    """

    label: str
    size: str
    entry: SolverChoice | None
    errors: Difference | None
    work: Work = field(default_factory=Work)
    seconds: float = math.nan
    first_seconds: float = math.nan
    repeats: int = 0
    remark: str = ""
    rigid: Difference | None = None

    @property
    def wrong(self) -> bool:
        """Whether impacts are missed or extra."""
        return (
            self.errors is not None and self.errors.impacts.missed + self.errors.impacts.extra > 0
        )


def is_stepped(solver: Solver) -> bool:
    """Whether a solver takes fixed steps."""
    return STEP in solver.settings


def judge(case: Case, entry: SolverChoice, truth: Reference, repeats: int) -> Judged:
    """Run an entry, time it and hold it against the reference.

    Parameters
    ----------
    case : Case
        What is run.
    entry : SolverChoice
        By what.
    truth : Reference
        Its reference.
    repeats : int
        Runs whose median time is taken, at least.

    Returns
    -------
    Judged
        Without errors where the run failed.

    Raises
    ------
    InputError
        Where the solver cannot be asked this.
    """
    task = entry.task(case)
    solver = solver_named(entry.solver)
    try:
        first, times = _timed(solver, replace(task, output_times=np.empty(0)), repeats)
        recording = solved(solver, task)
    except InputError:
        raise
    except ComputationError as error:
        return Judged(entry.line, entry.size, entry, None, remark=f"failed {error}")
    # A stepper of somebody else may fail in any way; it must not spoil the comparison.
    except Exception as error:
        what = f"failed: {type(error).__name__}: {error}"
        return Judged(entry.line, entry.size, entry, None, remark=what)
    usual = median(times)
    return Judged(
        entry.line,
        entry.size,
        entry,
        _errors(case, task, recording, truth, solver),
        recording.work,
        usual,
        max(0.0, first - usual),
        len(times),
        "" if recording.success else recording.message,
        None if truth.rigid is None else _errors(case, task, recording, truth.rigid, solver),
    )


def _timed(solver: Solver, task: Task, repeats: int) -> tuple[float, list[float]]:
    """Wall time of the first run and of later ones (s)."""
    first = _seconds(solver, task)
    times = [_seconds(solver, task)]
    while times[0] < LONG and (
        len(times) < repeats or (sum(times) < ENOUGH and len(times) < MOST_REPEATS)
    ):
        times.append(_seconds(solver, task))
    return first, times


def _seconds(solver: Solver, task: Task) -> float:
    began = time.perf_counter()
    solved(solver, task)
    return time.perf_counter() - began


def _errors(
    case: Case, task: Task, recording: Recording, truth: Reference, solver: Solver
) -> Difference:
    rows = truth.rows(task.output_times)
    known = bool(getattr(solver, RESTS, True))
    return errors_of(case.scene, recording, truth.truth, rows, rests=known)
