"""Work and time against error: ``python -m tests.benchmarks.work [--problems ...] [--rtol ...]``.

Three tables in Markdown on stdout, progress on stderr: work of our runs beside
SciPy runs of nearly their error; times at equal error; and P4 and PZ at every
tolerance. Times are medians of three warm runs, and one where a run takes more
than two seconds; only ratios within one call of this command carry over.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterator

from tests.benchmarks import yardsticks
from tests.benchmarks.problem import Problem, case_names, case_problem
from tests.benchmarks.runs import Method, Run, measure, milliseconds_at

LADDER = tuple(10.0**-k for k in range(4, 13))
"""Tolerances from which times at equal error are found."""
SHOWN = (1e-6, 1e-9, 1e-12)
ERRORS = (1e-5, 1e-7, 1e-9)
TRIPPING = ("P4", "PZ")
ALL_TOLERANCES = tuple(10.0**-k for k in range(3, 14))
ALLOWED = 1e3
"""Multiples of rtol that an error on P4 and PZ may be."""
Ladders = dict[Method, list[Run]]


def climb(problem: Problem, tolerances: tuple[float, ...], seconds: float) -> Ladders:
    """Run a problem by every method at every tolerance.

    A SciPy method that is not through within `seconds` (s) at one tolerance is
    not tried at the smaller ones.
    """
    ladders: Ladders = {}
    measure(problem, Method.CVODE, max(tolerances), seconds, repeats=1)
    for method in Method:
        runs = ladders[method] = []
        for rtol in sorted(tolerances, reverse=True):
            runs.append(measure(problem, method, rtol, seconds))
            print(f"{problem.name} {method} {rtol:.0e}: {runs[-1]}", file=sys.stderr, flush=True)
            if runs[-1].milliseconds > 1e3 * seconds and method is not Method.CVODE:
                break
    return ladders


def _row(*cells: object) -> str:
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def _header(*cells: str) -> str:
    return _row(*cells) + "\n" + "|" + " --- |" * len(cells)


def _number(value: float) -> str:
    """Three digits, or as many as stand before the point."""
    if math.isnan(value):
        return "-"
    return f"{value:.0f}" if value >= 100.0 else f"{value:.3g}"


def nearest(run: Run, others: list[Run]) -> Run:
    """The run whose error is nearest to that of another; a failed one where all have failed."""
    sound = [other for other in others if not other.remark and other.error > 0.0]
    if not sound or not run.error > 0.0:
        return (sound or others)[-1]
    return min(sound, key=lambda other: abs(math.log(other.error / run.error)))


def work_rows(name: str, ladders: Ladders, shown: tuple[float, ...]) -> Iterator[str]:
    """Rows of the first table."""
    for run in ladders[Method.CVODE]:
        if run.rtol not in shown:
            continue
        cells: list[object] = [name, f"{run.rtol:.0e}", run.rhs, run.steps, run.restarts]
        cells += [_number(run.milliseconds), run]
        for method in (Method.LSODA, Method.DOP853):
            other = nearest(run, ladders[method])
            cells += [f"{other.rtol:.0e}", other.rhs, _number(other.milliseconds), other]
        yield _row(*cells)


def equal_error_rows(problem: Problem, ladders: Ladders) -> Iterator[str]:
    """Rows of the second table."""
    for error in ERRORS:
        ours, lsoda, dop853 = (milliseconds_at(error, ladders[method]) for method in Method)
        reached = [value for value in (lsoda, dop853) if not math.isnan(value)]
        ratio = min(reached) / ours if reached else math.nan
        kind = "hysteretic" if problem.hysteretic else "elastic"
        times = [_number(value) for value in (ours, lsoda, dop853, ratio)]
        yield _row(problem.name, kind, f"{error:.0e}", *times)


def tripping_rows(problem: Problem, seconds: float) -> Iterator[str]:
    """Rows of the third table."""
    for rtol in ALL_TOLERANCES:
        ours, lsoda, dop853 = (measure(problem, m, rtol, seconds, repeats=1) for m in Method)
        right = not ours.remark and ours.error <= ALLOWED * rtol
        verdict = "right" if right else "WRONG"
        print(f"{problem.name} {rtol:.0e}: {verdict}", file=sys.stderr, flush=True)
        yield _row(problem.name, f"{rtol:.0e}", ours, verdict, lsoda, dop853)


def problems(names: list[str]) -> Iterator[Problem]:
    """The problems of the given names, yardsticks first, all where none is given."""
    stored, cases = yardsticks.load(), case_names()
    unknown = [name for name in names if name not in stored and name not in cases]
    if unknown:
        known = ", ".join([*stored, *cases])
        raise SystemExit(f"no problem {', '.join(unknown)}; known: {known}")
    for name in stored:
        if not names or name in names:
            yield stored[name]
    for name in cases:
        if not names or name in names:
            print(f"{name}: its true answer", file=sys.stderr, flush=True)
            yield case_problem(name)


def main(arguments: list[str] | None = None) -> None:
    """Print the three tables."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.work")
    parser.add_argument("--problems", nargs="+", default=[], help="P1 ... PZ, names of cases")
    parser.add_argument("--rtol", nargs="+", type=float, default=[], help="no others are run")
    parser.add_argument("--seconds", type=float, default=20.0, help="when SciPy is given up")
    options = parser.parse_args(arguments)
    ladder = tuple(options.rtol) or LADDER
    equal_error, tripping = [], []
    scipy = [f"{method} {what}" for method in ("LSODA", "DOP853") for what in
             ("rtol", "rhs", "ms", "error")]  # fmt: skip
    print(_header("problem", "rtol", "rhs", "steps", "restarts", "ms", "error", *scipy))
    for problem in problems(options.problems):
        ladders = climb(problem, ladder, options.seconds)
        print("\n".join(work_rows(problem.name, ladders, tuple(options.rtol) or SHOWN)), flush=True)
        equal_error += list(equal_error_rows(problem, ladders))
        if problem.name in TRIPPING and not options.rtol:
            tripping += list(tripping_rows(problem, options.seconds))
    print("\nTime in ms at equal error\n")
    print(_header("problem", "kind", "error", "cvode", "LSODA", "DOP853", "best SciPy / cvode"))
    print("\n".join(equal_error))
    if tripping:
        print("\nEvery tolerance: error allowed 1e3 rtol\n")
        print(_header("problem", "rtol", "cvode error", "", "LSODA error", "DOP853 error"))
        print("\n".join(tripping))


if __name__ == "__main__":
    main()
