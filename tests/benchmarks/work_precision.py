"""Speed against error of every solver: table and picture of docs/performance.md.

    python -m tests.benchmarks.work_precision            # all problems, into the table
    python -m tests.benchmarks.work_precision P3 pair    # the rows of these two
    python -m tests.benchmarks.work_precision P3 --solvers fast,cvode --out DIRECTORY
    python -m tests.benchmarks.work_precision front      # the picture

It runs `compare` on each and writes ``speed-against-error.csv``: the time (ms) in which a
solver comes within a graph distance with every impact right, empty where none of its runs does.
Rows of problems that are not measured stay as they are. Solvers that are not installed are left
out. Steps are parts of the period of a pulse, of a record parts and multiples of its own step.

The picture has two lines more for each of its problems (`tests.benchmarks.own_lines`): what a run
costs among many, and the contact element held against its own model instead of the rigid law.
"""

from __future__ import annotations

import argparse
import csv
import io
import math
import sys
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from PIL import Image

from eventpound import Case, ComputationError, InputError, Record, load_case
from eventpound.accuracy.compare import Comparison, entries, judge_entries
from eventpound.accuracy.comparison_tables import text_table
from eventpound.accuracy.work_precision import Judged, SolverChoice
from eventpound.case.run_options import RunOptions
from eventpound.case.solver_options import SolverOptions, solver_words
from eventpound.report import work_precision as diagram
from eventpound.report.style import png, styled
from eventpound.results import write_together
from eventpound.solvers import available, solver_named
from tests.benchmarks import yardsticks
from tests.benchmarks.own_lines import with_own_lines
from tests.benchmarks.problem import Problem, folder_of
from tests.models import DOCS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DOCS = DOCS / "measured"
TABLE, PICTURE = "speed-against-error.csv", "speed-against-error-front.png"
OTHERS = ("pair", "symmetric-triplet", "bridge-record", "row-of-eight")
FRONT = {
    "P1": "elastoplastic structure, barrier: one impact",
    "pair": "flexible and stiff structure under a pulse",
}
"""Problems of the picture, and what they are."""
FRONT_SOLVERS, PANEL = "fast,cvode,moreau,penalty", (4.6, 3.6)
SOLVERS = "fast,cvode,ida,moreau,penalty,opensees"
RTOL = tuple(10.0**-k for k in range(3, 12))
STEPS_A_PERIOD: tuple[float, ...] = (20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000)
STEPS_A_SAMPLE = (0.25, 0.5, 1, 2, 5, 10, 20, 50)
MOST_STEPS = 100_000
ROWS = 2000
ERRORS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8)
COLUMNS = ("problem", "solver", *(f"{error:.0e}" for error in ERRORS))


def names() -> tuple[str, ...]:
    """Those of all problems."""
    return (*yardsticks.load(), *OTHERS)


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
    return judge_entries(case, asked, repeats=repeats, progress=_say)


def _refusal(case: Case, entry: SolverChoice) -> str:
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


def milliseconds_within(error: float, runs: list[Judged]) -> float:
    """Least wall time (ms) of a run with this graph distance or less and no impact wrong."""
    times = [
        1e3 * run.seconds
        for run in runs
        if run.errors is not None
        and run.errors.distance.graph <= error
        and not run.errors.impacts.missed + run.errors.impacts.extra
    ]
    return min(times, default=math.nan)


def rows_of(comparison: Comparison) -> Iterator[list[str]]:
    """Rows of the table, a solver each."""
    for label in dict.fromkeys(run.label for run in comparison.runs):
        runs = [run for run in comparison.runs if run.label == label]
        times = [milliseconds_within(error, runs) for error in ERRORS]
        numbers = ["" if math.isnan(time) else f"{time:.3g}" for time in times]
        yield [comparison.case.title, label, *numbers]


def write_table(folder: Path, found: Mapping[str, Comparison]) -> None:
    """Put the rows of the problems found into the table."""
    _, *old = csv.reader((DOCS / TABLE).read_text(encoding="utf-8").splitlines())
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(COLUMNS)
    for name in names():
        kept = [row for row in old if row[0] == name]
        table.writerows(rows_of(found[name]) if name in found else kept)
    write_together(folder, {TABLE: text.getvalue().encode()})


def front(repeats: int) -> bytes:
    """Measure the problems of the picture, and draw it."""
    found = []
    for name, words in FRONT.items():
        print(name, file=sys.stderr, flush=True)
        case = replace(case_of(name, yardsticks.load().get(name)), title=f"{words} ({name})")
        found.append(with_own_lines(measured(case, FRONT_SOLVERS, repeats), steps_of(case)))
        print(f"{name}\n{text_table(found[-1])}", flush=True)
    return _few_colours(png(panels(found)))


def panels(comparisons: list[Comparison]) -> Figure:
    """Graph distance against wall time, a panel a comparison."""
    from matplotlib.figure import Figure

    looks = diagram._looks(comparisons)
    with styled():
        size = (PANEL[0] * len(comparisons), PANEL[1] + 0.6)
        figure = Figure(figsize=size, layout="constrained")
        beside = figure.subplots(1, len(comparisons), squeeze=False)[0]
        for axes, comparison in zip(beside, comparisons, strict=True):
            diagram._draw(axes, comparison, diagram.graph_measure(comparison), looks)
            axes.set(title=comparison.case.title, xlabel="wall time (ms)")
        beside[0].set_ylabel("graph distance of the motion")
        handles = diagram._legend(comparisons, looks)
        figure.legend(handles=handles, loc="outside upper center", ncols=max(2, len(beside)))
    return figure


def _few_colours(picture: bytes) -> bytes:
    """The same picture with a palette, a third of its size."""
    buffer = io.BytesIO()
    Image.open(io.BytesIO(picture)).convert("RGB").quantize(64).save(buffer, "png", optimize=True)
    return buffer.getvalue()


def main(arguments: list[str] | None = None) -> None:
    """Run what is asked for and write it."""
    known = ("front", *names())
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.work_precision")
    parser.add_argument("problems", nargs="*", metavar="PROBLEM", help=", ".join(known))
    parser.add_argument("--solvers", default=SOLVERS)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--out", type=Path, default=DOCS)
    options = parser.parse_args(arguments)
    strangers = [name for name in options.problems if name not in known]
    if strangers:
        parser.error(f"{', '.join(strangers)}: no problem; accepted: {', '.join(known)}")
    if "front" in options.problems:
        write_together(options.out, {PICTURE: front(options.repeats)})
        return
    found = {}
    for name in names():
        if not options.problems or name in options.problems:
            print(name, file=sys.stderr, flush=True)
            case = case_of(name, yardsticks.load().get(name))
            found[name] = measured(case, options.solvers, options.repeats)
            print(f"{name}\n{text_table(found[name])}", flush=True)
    write_table(options.out, found)


if __name__ == "__main__":
    main()
