"""Programs that take part: solvers of this package and commands in any language, run and judged.

A *size* is what an entrant may choose: a relative tolerance or, of fixed steps, the step in
parts of the run. A run that takes more processor time than the limit is given up, and so are
finer sizes. Times are processor times, of our solvers those of a second run, so that nothing is
compiled in them.
"""

from __future__ import annotations

import math
import shlex
import subprocess
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from eventpound import score
from eventpound.accuracy.quantities import says_rests
from eventpound.accuracy.work_precision import RESTS, SolverChoice, is_stepped
from eventpound.errors import ComputationError, EventpoundError, InputError
from eventpound.problems.collection import Collection, ProblemFolder
from eventpound.problems.files import problem_files
from eventpound.simulation import solved
from eventpound.solvers import solver_named
from eventpound.solvers.base import Recording, Solver, Task

try:
    import resource
except ImportError:  # Windows: commands are timed and limited on the clock.
    resource = None  # type: ignore[assignment]

TOLERANCES = (1e-4, 1e-7, 1e-10, 1e-12)
STEPS = (1e-3, 1e-4, 1e-5)
"""Sizes, if nothing else is said."""
LIMIT = 10.0
"""Processor time (s) that a run may take."""
_PATIENT = 600.0
"""The same of the first run at the coarsest size, in which kernels may be compiled (s)."""
_ASLEEP = 20.0
"""Times its limit that a command may take on the clock."""
_ROWS = 2000
"""Rows of the history of a solver with a tolerance, beside those that are asked for."""


@dataclass(frozen=True)
class Entrant:
    """A program that takes part.

    Parameters
    ----------
    label : str
        What tables call it.
    solver : str
        A solver of this package, or empty.
    settings : mapping
        Its settings.
    command : str
        A command line with ``{problem}`` and ``{out}``, perhaps ``{size}``; or empty.
    sizes : sequence of float
        Steps or tolerances; the usual ones where empty.
    """

    label: str
    solver: str = ""
    settings: Mapping[str, object] = field(default_factory=dict)
    command: str = ""
    sizes: Sequence[float] = ()

    @property
    def stepped(self) -> bool:
        """Whether its sizes are steps in parts of the run."""
        return not self.solver or is_stepped(solver_named(self.solver))

    def ladder(self) -> Sequence[float]:
        """Its sizes."""
        if self.command and "{size}" not in self.command:
            return (np.nan,)
        return self.sizes or (STEPS if self.stepped else TOLERANCES)


def materialized(collection: Collection, problem: ProblemFolder, folder: Path) -> Path:
    """Write the files of a problem below a folder; its directory."""
    place = folder / problem.name
    place.mkdir(parents=True, exist_ok=True)
    for name, content in problem_files(collection, problem).items():
        (place / name).write_bytes(content)
    return place


def cards_of(
    collection: Collection,
    problem: ProblemFolder,
    entrants: Sequence[Entrant],
    limit: float = LIMIT,
) -> dict[str, list[score.Card]]:
    """Cards of entrants for a problem, a list from coarse to fine for each.

    Parameters
    ----------
    collection, problem
        The problem.
    entrants : sequence of Entrant
        Who takes part.
    limit : float
        Time (s) that each run may take.
    """
    with TemporaryDirectory(prefix="problem-") as scratch:
        folder = materialized(collection, problem, Path(scratch))
        known = score.read_problem(folder)
        return {
            entrant.label: list(_ladder(problem, known, entrant, folder, limit))
            for entrant in entrants
        }


def _ladder(
    problem: ProblemFolder, known: score.Problem, entrant: Entrant, folder: Path, limit: float
) -> Iterator[score.Card]:
    for size in entrant.ladder():
        said = "" if np.isnan(size) else f"{size:g}"
        try:
            if entrant.solver:
                card = _by_solver(problem, known, entrant, size, limit)
            else:
                card = _by_command(known, entrant, size, folder, limit)
        except _TooLongError:
            why = f"takes more than {limit:g} s"
            yield score.Card.of_failure(problem.name, why, said)
            return
        except (EventpoundError, score.ScoreError) as error:
            why = str(error).replace(f"{folder}/", "").replace("\n", "; ")
            yield score.Card.of_failure(problem.name, why, said)
            continue
        card.size = said
        yield card


class _TooLongError(ComputationError):
    """A run takes longer than the limit."""


def _by_solver(
    problem: ProblemFolder, known: score.Problem, entrant: Entrant, size: float, limit: float
) -> score.Card:
    case = problem.case()
    step = size * case.run.duration if entrant.stepped else None
    entry = SolverChoice(entrant.solver, entrant.settings, None if step else size, step)
    task, solver = entry.task(case), solver_named(entrant.solver)
    silent = replace(task, output_times=np.empty(0))
    coarsest = size == entrant.ladder()[0]
    first = solved(solver, _bounded(silent, _PATIENT if coarsest else limit))
    began = time.process_time()
    solved(solver, _bounded(silent, limit))
    seconds = time.process_time() - began
    rows = task.output_times
    if not entrant.stepped:
        rows = np.linspace(task.start, task.end, _ROWS + 1)
    x = first.displacement
    ends = [task.start, task.end]
    wanted = [rows, ends, known.given["moments"], x.time_of_maximum, x.time_of_minimum]
    recording = solved(solver, replace(task, output_times=np.unique(np.concatenate(wanted))))
    if not recording.success:
        raise ComputationError(recording.message, recording.t)
    history = _history(recording, solver)
    score.check(known, history)
    return score.judge(known, history, max(seconds, 1e-6))


def _bounded(task: Task, limit: float) -> Task:
    """The task, given up after a time (s)."""
    began = time.process_time()

    def progress(t: float) -> None:
        if time.process_time() - began > limit:
            raise _TooLongError("the limit of time is reached", t)

    return replace(task, progress=progress)


def _history(recording: Recording, solver: Solver) -> score.Motion:
    rows = recording.history
    z = rows.z if rows.z.size else None
    kinds = _reported(recording, solver)
    return score.Motion(rows.t, rows.u, rows.v, z, recording.events, kinds)


def _reported(recording: Recording, solver: Solver) -> frozenset[str]:
    """Kinds of events that a solver would list if they occurred.

    Who knows how long contacts rested knows when; of accumulations no method of fixed steps
    says anything.
    """
    found = {event.kind.value for event in recording.events}
    kinds = {"impact", *(key for key, words in score.EVENTS.items() if found & set(words))}
    if getattr(solver, RESTS, True) and says_rests(recording):
        kinds |= {"rest", "detachment"}
        if not is_stepped(solver):
            kinds.add("accumulation")
    return frozenset(kinds)


def _by_command(
    known: score.Problem, entrant: Entrant, size: float, folder: Path, limit: float
) -> score.Card:
    out = folder / "out.csv"
    for old in (out, out.with_name("out.events.csv")):
        old.unlink(missing_ok=True)
    words = [
        word.format(problem=folder, out=out, size=f"{size:g}")
        for word in shlex.split(entrant.command)
    ]
    # It may use so much processor time, and is ended then.
    most = math.ceil(limit) + 1
    before = _children()
    try:
        run = subprocess.run(
            words,
            capture_output=True,
            text=True,
            timeout=_ASLEEP * limit if resource else limit,
            check=False,
            preexec_fn=(lambda: resource.setrlimit(resource.RLIMIT_CPU, (most, most + 1)))
            if resource
            else None,
        )
    except subprocess.TimeoutExpired as error:
        raise _TooLongError("the limit of time is reached", np.nan) from error
    except OSError as error:
        raise InputError(f"--run: {words[0]}: {error.strerror}") from error
    seconds = _children() - before
    if seconds > limit:
        raise _TooLongError("the limit of time is reached", np.nan)
    if run.returncode != 0:
        lines = (run.stderr.strip() or run.stdout.strip() or "nothing").splitlines()
        said = next((line for line in lines if line.startswith("error")), lines[-1])
        raise InputError(f"ended with {run.returncode} and said: {said[:200]}")
    history = score.read_history(known, out)
    return score.judge(known, history, max(seconds, 1e-6))


def _children() -> float:
    """Processor time (s) of programs that were run and have ended."""
    if not resource:
        return time.monotonic()
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
