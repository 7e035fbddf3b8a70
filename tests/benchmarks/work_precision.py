"""Speed against error of every solver on the problems P1-P7 and PZ and on cases: the page.

    python -m tests.benchmarks.work_precision            # all, and rewrites the page
    python -m tests.benchmarks.work_precision --problems P3 pair --solvers fast,cvode --out /tmp/x

It runs `compare` on each, draws a panel each into ``docs/speed-against-error.png`` and
puts two tables between the marks of ``docs/speed-against-error.md``. Solvers that are not
installed are left out. Steps are parts of the period of a pulse, of a record parts and
multiples of its own step.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from eventpound import load_case
from eventpound.accuracy.compare import Comparison, compare, entries
from eventpound.accuracy.comparison_tables import impact_words, text_table
from eventpound.accuracy.errors import PEAKS
from eventpound.accuracy.work_precision import Entry, Judged
from eventpound.case.case import Case, RunOptions, SolverOptions
from eventpound.cli.solver_words import solver_words
from eventpound.errors import ComputationError, InputError
from eventpound.motion.record import Record
from eventpound.report.style import png
from eventpound.report.work_precision import work_precision_grid
from eventpound.results import write_together
from eventpound.solvers import available, solver_named
from tests.benchmarks import yardsticks
from tests.benchmarks.problem import CASES, Problem

DOCS = Path(__file__).parents[2] / "docs"
PAGE, PICTURE = "speed-against-error.md", "speed-against-error.png"
BEGIN, END = "<!-- tables: tests.benchmarks.work_precision -->", "<!-- end of tables -->"
OTHERS = ("pair", "symmetric-triplet", "bridge-record", "row-of-eight")
SOLVERS = "fast,cvode,ida,moreau,penalty,penalty:contact=linear,opensees"
RTOL = tuple(10.0**-k for k in range(3, 12))
STEPS_A_PERIOD: tuple[float, ...] = (20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000)
STEPS_A_SAMPLE = (0.25, 0.5, 1, 2, 5, 10, 20, 50)
MOST_STEPS = 100_000
ERRORS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8)
ROWS = 2000


def problems() -> dict[str, Problem | None]:
    """The problems by name; those that are cases have no stored answer."""
    return {**yardsticks.load(), **dict.fromkeys(OTHERS)}


def case_of(name: str, problem: Problem | None) -> Case:
    """A problem as a case; a case is given the name of its directory as its title."""
    if problem is None:
        return replace(load_case(CASES / name), title=name)
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


def confirmed(comparison: Comparison, problem: Problem | None) -> str:
    """How far the reference is from the stored answer, as a part of the largest |u|."""
    if problem is None:
        return "-"
    reference, answer = comparison.reference.truth.recording, problem.answer
    apart = np.concatenate(
        (reference.displacement.minimum - answer.u_min, reference.u - answer.final)
    )
    return f"{np.abs(apart).max() / answer.length:.0e}"


def milliseconds_at(error: float, runs: Sequence[Judged]) -> float:
    """Least wall time (ms) of a run with this graph distance or less and no impact wrong."""
    times = [
        1e3 * run.seconds
        for run in runs
        if run.errors is not None
        and run.errors.distance.graph <= error
        and not run.errors.impacts.missed + run.errors.impacts.extra
    ]
    return min(times, default=math.nan)


def _lines(comparison: Comparison) -> dict[str, list[Judged]]:
    lines: dict[str, list[Judged]] = {}
    for run in comparison.runs:
        lines.setdefault(run.label, []).append(run)
    return lines


def time_rows(comparison: Comparison) -> Iterator[str]:
    """Time each solver takes to come within each error."""
    for label, runs in _lines(comparison).items():
        times = [milliseconds_at(error, runs) for error in ERRORS]
        yield _row(comparison.case.title, label, *(_number(time) for time in times))


def best_rows(comparison: Comparison) -> Iterator[str]:
    """The most accurate run of each solver."""
    for label, runs in _lines(comparison).items():
        judged = [run for run in runs if run.errors is not None]
        if not judged:
            yield _row(comparison.case.title, label, *["-"] * 6)
            continue
        best = min(judged, key=lambda run: run.errors.distance.graph if run.errors else math.inf)
        assert best.errors is not None
        yield _row(
            comparison.case.title,
            label,
            best.size,
            f"{best.errors.distance.graph:.0e}",
            f"{best.errors.largest(PEAKS):.0e}",
            impact_words(best.errors.impacts),
            _number(1e3 * best.seconds),
            str(best.work.rhs),
        )


def _number(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.3g}"


def _row(*cells: object) -> str:
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def _header(*cells: str) -> str:
    return _row(*cells) + "\n" + "|" + " --- |" * len(cells)


def tables(comparisons: Sequence[Comparison], stored: Sequence[Problem | None]) -> str:
    """The tables of the page."""
    references = [
        _row(
            c.case.title,
            f"{c.reference.check.distance.graph:.0e}" if c.reference.check else "-",
            confirmed(c, problem),
        )
        for c, problem in zip(comparisons, stored, strict=True)
    ]
    parts = [
        "Time (ms) in which a solver comes within a graph distance, every impact right; - where "
        "none of its runs does.",
        "\n".join(
            [
                _header("problem", "solver", *(f"{error:.0e}" for error in ERRORS)),
                *(row for c in comparisons for row in time_rows(c)),
            ]
        ),
        "The most accurate run of each solver: impacts matched, missed, extra.",
        "\n".join(
            [
                _header("problem", "solver", "at", "graph", "peaks", "impacts", "ms", "forces"),
                *(row for c in comparisons for row in best_rows(c)),
            ]
        ),
        "The reference: graph distance of its check, and how far its smallest and final "
        "displacements are from the stored answer of an independent program.",
        "\n".join([_header("problem", "check", "stored"), *references]),
    ]
    return "\n\n".join(parts)


def write_page(folder: Path, comparisons: Sequence[Comparison], text: str) -> None:
    """Put the tables between the marks of the page, and the picture beside it."""
    page = (DOCS / PAGE).read_text(encoding="utf-8")
    head, _, rest = page.partition(BEGIN)
    _, _, tail = rest.partition(END)
    content = f"{head}{BEGIN}\n\n{text}\n\n{END}{tail}"
    picture = png(work_precision_grid(comparisons))
    write_together(folder, {PICTURE: picture, PAGE: content.encode()})


def main(arguments: list[str] | None = None) -> None:
    """Run everything and write the page."""
    known = problems()
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.work_precision")
    parser.add_argument("--problems", nargs="+", default=list(known), choices=list(known))
    parser.add_argument("--solvers", default=SOLVERS)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--out", type=Path, default=DOCS)
    options = parser.parse_args(arguments)
    comparisons = []
    for name in options.problems:
        print(name, file=sys.stderr, flush=True)
        comparison = measured(case_of(name, known[name]), options.solvers, options.repeats)
        print(f"{name}\n{text_table(comparison)}", flush=True)
        comparisons.append(comparison)
    text = tables(comparisons, [known[name] for name in options.problems])
    write_page(options.out, comparisons, text)


if __name__ == "__main__":
    main()
