"""Speed against error of every solver on problems, cases and hard scenes: the page.

    python -m tests.benchmarks.work_precision            # all, and rewrites the page
    python -m tests.benchmarks.work_precision P3 pair    # only the rows of these two
    python -m tests.benchmarks.work_precision hard       # one of the two groups
    python -m tests.benchmarks.work_precision P3 --solvers fast,cvode --out DIRECTORY
    python -m tests.benchmarks.work_precision front      # the picture at the head of the page

It runs `compare` on each, draws a panel each into ``speed-against-error.png`` or, for
the hard scenes, which are certified as well, ``speed-against-error-hard.png``, and puts tables
between the marks of ``speed-against-error.md``, all of them in ``docs/measured``. Solvers that
are not installed are left out. Steps are parts of the period of a pulse, of a record parts and
multiples of its own step.

The picture at the head, ``speed-against-error-front.png``, has two lines more for each of its
problems (`tests.benchmarks.own_lines`): what a run costs among many, and the
contact element held against its own model instead of the rigid law.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from eventpound import load_case
from eventpound.accuracy.compare import Comparison, compare, entries
from eventpound.accuracy.comparison_tables import text_table
from eventpound.accuracy.verify import verify
from eventpound.accuracy.work_precision import Entry
from eventpound.case.case import Case, RunOptions, SolverOptions
from eventpound.case.solver_words import solver_words
from eventpound.errors import ComputationError, InputError
from eventpound.motion.record import Record
from eventpound.results import write_together
from eventpound.solvers import available, solver_named
from tests.benchmarks import yardsticks
from tests.benchmarks.own_lines import with_own_lines
from tests.benchmarks.problem import Problem, folder_of
from tests.benchmarks.speed_page import DOCS, FRONT, Measured, front_picture, write_page
from tests.hard.catalogue import catalogue

OTHERS = ("pair", "symmetric-triplet", "bridge-record", "row-of-eight")
HARD = (
    "graze-hit-1e-06",
    "two-at-once",
    "kink-struck",
    "mass-ratio-light",
    "small-yield-displacement",
    "starts-compressed",
    "plastic-chain",
    "chain-of-10-pressed",
)
"""Of `cases/hard`, one of each kind."""
FRONT_PROBLEMS, FRONT_SOLVERS = ("P1", "pair"), "fast,cvode,moreau,penalty"
SOLVERS = "fast,cvode,ida,moreau,penalty,opensees"
RTOL = tuple(10.0**-k for k in range(3, 12))
STEPS_A_PERIOD: tuple[float, ...] = (20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000)
STEPS_A_SAMPLE = (0.25, 0.5, 1, 2, 5, 10, 20, 50)
MOST_STEPS = 100_000
ROWS = 2000


def groups() -> dict[str, tuple[str, ...]]:
    """Names of the problems, by the part of the page they belong to."""
    return {"problems": (*yardsticks.load(), *OTHERS), "hard": HARD}


def case_of(name: str, problem: Problem | None) -> Case:
    """A problem as a case; a case is given the name of its directory as its title."""
    if problem is None:
        return replace(load_case(folder_of(name)), title=name)
    task = problem.task
    run = RunOptions(task.start, task.end - task.start, (task.end - task.start) / ROWS)
    return Case(name, task.scene, run, SolverOptions(), Path(name), "", None, (), {})


def steps_of(case: Case) -> list[float]:
    """Fixed steps (s) for a case, with which a run has no more than `MOST_STEPS`."""
    motion = case.scene.motion
    scales = motion.scales()
    unit, parts = case.run.duration, STEPS_A_PERIOD
    if isinstance(motion, Record):
        unit, parts = motion.time_step, STEPS_A_SAMPLE
    elif scales is not None:
        unit = scales.period
    return [unit / n for n in parts if case.run.duration * n / unit <= MOST_STEPS]


def measured(case: Case, words: str, repeats: int) -> Comparison:
    """Compare every solver that is there and can express the scene."""
    steps = steps_of(case)
    chosen = [pair for pair in solver_words(words) if pair[0] in available()]
    asked = []
    for pair in chosen:
        tried = entries([pair], RTOL, steps)
        refusal = _refusal(case, tried[0])
        if refusal:
            print(f"{case.title}: {tried[0].line} left out: {refusal}", file=sys.stderr)
        else:
            asked += tried
    return compare(case, asked, repeats=repeats, progress=_say)


def _refusal(case: Case, entry: Entry) -> str:
    """Why a solver cannot express the scene; empty where it can."""
    try:
        solver_named(entry.solver).solve(entry.task(case))
    except InputError as error:
        return str(error)
    except ComputationError:
        # It can, though not with this step or tolerance.
        return ""
    return ""


def _say(what: str) -> None:
    print(f"    {what}", file=sys.stderr, flush=True)


def results(name: str, solvers: str, repeats: int) -> Measured:
    """Everything about one problem."""
    problem = yardsticks.load().get(name)
    hard = next((scene for scene in catalogue() if scene.name == name), None)
    if hard is None:
        return Measured(measured(case_of(name, problem), solvers, repeats), problem)
    case = replace(hard.case, title=name)
    certificate = verify(case.scene, duration=case.run.duration, report=_say)
    return Measured(measured(case, solvers, repeats), None, hard, certificate)


def write_front(folder: Path, repeats: int) -> None:
    """Measure the problems of the picture at the head, and draw it."""
    found = {}
    for name in FRONT_PROBLEMS:
        print(name, file=sys.stderr, flush=True)
        case = case_of(name, yardsticks.load().get(name))
        found[name] = with_own_lines(measured(case, FRONT_SOLVERS, repeats), steps_of(case))
        print(f"{name}\n{text_table(found[name])}", flush=True)
    write_together(folder, {FRONT: front_picture(found)})


def _chosen(names: list[str]) -> Iterator[str]:
    """Problems named, themselves or by their group, in the order of the page."""
    for group, members in groups().items():
        yield from (name for name in members if {name, group} & set(names))


def main(arguments: list[str] | None = None) -> None:
    """Run what is asked for and write the page."""
    known = groups()
    every = [name for members in known.values() for name in members]
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.work_precision")
    parser.add_argument(
        "problems",
        nargs="*",
        metavar="PROBLEM",
        help=f"front, {', '.join(known)}, {', '.join(every)}",
    )
    parser.add_argument("--solvers", default=SOLVERS)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--out", type=Path, default=DOCS)
    options = parser.parse_args(arguments)
    if options.problems == ["front"]:
        write_front(options.out, options.repeats)
        return
    strangers = [name for name in options.problems if name not in (*known, *every)]
    if strangers:
        parser.error(f"{', '.join(strangers)}: no problem; accepted: {', '.join((*known, *every))}")
    found = {}
    for name in _chosen(options.problems or list(known)):
        began = time.perf_counter()
        print(name, file=sys.stderr, flush=True)
        found[name] = results(name, options.solvers, options.repeats)
        print(f"{name}\n{text_table(found[name].comparison)}", flush=True)
        print(f"    {time.perf_counter() - began:.0f} s", file=sys.stderr, flush=True)
    write_page(options.out, known, found)


if __name__ == "__main__":
    main()
