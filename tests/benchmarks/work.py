"""Time of cvode and of SciPy at equal error: ``python -m tests.benchmarks.work [--problems ...]``.

A table in Markdown on stdout, progress on stderr: by problem, the time of `cvode` at an error of
1e-7 and how many times as long the better of SciPy's two methods takes at three errors. Times are
medians of three warm runs, and one where a run takes more than two seconds; only ratios
within one call of this command carry over.
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
ERRORS = (1e-5, 1e-7, 1e-9)
SHOWN = 1e-7
"""Error at which the time of `cvode` is printed."""
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


def _number(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.3g}"


def equal_error_row(name: str, ladders: Ladders) -> str:
    """Time of ours, and the ratio of the better of the others to it at each error."""
    ratios = []
    for error in ERRORS:
        ours, *others = (milliseconds_at(error, ladders[method]) for method in Method)
        reached = [value for value in others if not math.isnan(value)]
        ratios.append(_number(min(reached) / ours if reached else math.nan))
    return _row(name, _number(milliseconds_at(SHOWN, ladders[Method.CVODE])), *ratios)


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
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.work")
    parser.add_argument("--problems", nargs="+", default=[], help="P1 ... PZ, names of cases")
    parser.add_argument("--rtol", nargs="+", type=float, default=LADDER, help="no others are run")
    parser.add_argument("--seconds", type=float, default=20.0, help="when SciPy is given up")
    options = parser.parse_args(arguments)
    ratios = [f"SciPy / `cvode` at {error:.0e}" for error in ERRORS]
    print(_row("problem", f"`cvode`, ms at {SHOWN:.0e}", *ratios))
    print(_row(*["---"] * (2 + len(ERRORS))))
    for problem in problems(options.problems):
        ladders = climb(problem, tuple(options.rtol), options.seconds)
        print(equal_error_row(problem.name, ladders), flush=True)


if __name__ == "__main__":
    main()
