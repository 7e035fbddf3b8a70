"""A benchmark problem: a scene to be run over a stretch of time, and its true answer."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from eventpound import Scene, load_case
from eventpound.simulation import task_of
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task
from tests.benchmarks.answers import Answer, answer_of
from tests.models import CASES

FROZEN = Path(__file__).parent / "frozen"
"""Cases as they were when first measured, where those under cases/ have changed since."""
TIGHTEST = 1e-13
"""Tolerance of the run that a case, which has no stored answer, is judged by."""


@dataclass(frozen=True)
class Problem:
    """A problem.

    Parameters
    ----------
    name : str
        Its name.
    task : Task
        The scene and the stretch of time, with no rows of a history.
    answer : Answer
        The true answer, stored or from our own run at `TIGHTEST`.
    """

    name: str
    task: Task
    answer: Answer

    @property
    def scene(self) -> Scene:
        """What moves."""
        return self.task.scene


def case_names() -> list[str]:
    """Names of the directories under cases/."""
    return sorted(file.parent.name for file in CASES.glob("*/case.toml"))


def folder_of(name: str) -> Path:
    """Directory of the case of this name that benchmarks measure: the frozen one, if any."""
    return FROZEN / name if (FROZEN / name).is_dir() else CASES / name


def case_problem(name: str) -> Problem:
    """A case as a problem, judged by our own run at `TIGHTEST`."""
    task = replace(task_of(load_case(folder_of(name)), TIGHTEST), output_times=np.empty(0))
    return Problem(name, task, answer_of(solver_named("cvode").solve(task)))
