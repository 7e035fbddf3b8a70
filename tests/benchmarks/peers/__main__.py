"""Ours beside other programs: ``python -m tests.benchmarks.peers [--programs ...] [--no-bridge]``.

Two tables in Markdown. The first: microseconds of processor time of one run at an error of at
most `ERROR` (`tests.benchmarks.answers`), at the loosest tolerance that gets there, the smallest
of some calls, all programs in turns; the lines that a user writes; and what P1 costs in a process
of its own, the first time and the next (s). Of the programs of others, what it takes to read the
problem is taken off. A dash: it does not get there, or is not written for that. The second:
`tests.benchmarks.peers.bridge`. A program that is not installed is said to be absent.
"""

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass

from eventpound import Response
from tests.benchmarks import yardsticks
from tests.benchmarks.answers import answer_of, deviation
from tests.benchmarks.peers import bridge
from tests.benchmarks.peers.programs import PROGRAMS, Program
from tests.benchmarks.problem import Problem

PROBLEMS = ("P1", "P3", "P5", "P6", "P7", "PZ")
ERROR = 1e-9
TOLERANCES = tuple(10.0 ** (-0.5 * k) for k in range(10, 27))
REPEATS, SHORTEST, LONG = 5, 0.05, 0.5
"""Turns, the least processor time of one (s), and that of a run that is not repeated (s)."""
READ = "from tests.benchmarks import yardsticks\nyardsticks.load()\n"


@dataclass
class Timed:
    """A program that gets to the error, and its shortest time (s)."""

    call: Callable[[], object]
    runs: int
    calls: int
    best: float

    def turn(self) -> None:
        """Take its time once more."""
        if self.best > LONG:
            return
        began = time.process_time()
        for _ in range(self.calls):
            self.call()
        spent = (time.process_time() - began) / (self.calls * self.runs)
        self.best = min(self.best, spent)


def at_error(program: Program, problem: Problem) -> Timed | None:
    """The program at the loosest tolerance that is good enough, or None."""
    if problem.name not in program.problems.split():
        return None
    for rtol in TOLERANCES:
        call, runs = program.ready(problem, rtol)
        found = call()
        if found is None:
            return None
        answer = answer_of(found.recording) if isinstance(found, Response) else found
        far = deviation(answer, problem.answer, problem.task.end)
        if not far.remark and far.error <= ERROR:
            began = time.process_time()
            call()
            spent = time.process_time() - began
            return Timed(call, runs, 1 + int(SHORTEST / spent), spent / runs)
    return None


def microseconds(names: list[str], problem: Problem) -> dict[str, str]:
    """Cells of the installed programs for a problem."""
    ready = {name: at_error(PROGRAMS[name], problem) for name in names}
    for _ in range(REPEATS):
        for timed in ready.values():
            if timed is not None:
                timed.turn()
    return {
        name: "-" if timed is None else f"{float(f'{1e6 * timed.best:.3g}'):.7g}"
        for name, timed in ready.items()
    }


def in_a_process(text: str) -> list[float]:
    """Processor time of a program with an empty store, and once more (s)."""
    spent = []
    with tempfile.TemporaryDirectory() as store:
        for _ in range(2):
            before = _children()
            subprocess.run(
                [sys.executable, "-c", text],
                env={**os.environ, "NUMBA_CACHE_DIR": store, "PYTHONWARNINGS": "ignore"},
                check=True,
                stdout=subprocess.DEVNULL,
            )
            spent.append(_children() - before)
    return spent


def _children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main(arguments: list[str] | None = None) -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.peers")
    parser.add_argument("--programs", nargs="+", default=list(PROGRAMS), choices=list(PROGRAMS))
    parser.add_argument("--problems", nargs="+", default=PROBLEMS, choices=PROBLEMS)
    parser.add_argument("--no-bridge", action="store_true", help="the first table only")
    options = parser.parse_args(arguments)
    installed = [name for name in options.programs if PROGRAMS[name].installed]
    cells: dict[str, list[str]] = {name: [] for name in installed}
    for problem in (yardsticks.load()[name] for name in options.problems):
        for name, cell in microseconds(installed, problem).items():
            cells[name].append(cell)
            print(f"{problem.name} {name}: {cell}", file=sys.stderr, flush=True)
    reading = in_a_process(READ)[1]
    heads = ["program", "lines", "first P1 (s)", "next (s)", *options.problems]
    print("| " + " | ".join(heads) + " |\n|" + " --- |" * len(heads))
    for name in options.programs:
        program = PROGRAMS[name]
        if name not in installed:
            print(f"| {name} | absent |" + " |" * (len(heads) - 2))
            continue
        first, again = in_a_process(program.text)
        off = reading if program.sources else 0.0
        costs = f"{program.lines} | {first - off:.2g} | {again - off:.2g}"
        print(f"| {name} | {costs} | " + " | ".join(cells[name]) + " |", flush=True)
    if not options.no_bridge:
        print()
        bridge.main()


if __name__ == "__main__":
    main()
