"""What the run-time checks of cvode and ida cost: ``python -m tests.benchmarks.step_checks``.

After every step both check that every number of the state and of its rate is finite and that
no |z| is beyond its bound; where a step is looked at for an event, and after every step of a
cascade, that no contact penetrates or pulls; at the end, that the energy ledger closes. The
first are compiled and timed by themselves on the numbers a run has left; the second are
timed where they are called; the third needs the ledger, which is kept where it is asked for.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
from numba import njit

from eventpound.numerics.arrays import Floats
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task
from eventpound.solvers.events import loop, segment, settling
from tests.benchmarks.invariants import RTOL, fastest, tasks

ROUNDS = 300_000
RUNS = 15


@njit(_nrt=False, error_model="numpy")
def _checks(rounds: int, checked: bool, y: Floats, rate: Floats, z: Floats, bound: Floats) -> int:
    """Steps that pass the checks of `examine`, of `rounds`."""
    passed = 0
    for _ in range(rounds):
        y[0] += 1e-300
        sound = True
        if checked:
            excess = -1.0
            for h in range(z.size):
                excess = max(excess, abs(z[h]) - bound[h])
            for i in range(y.size):
                if not np.isfinite(y[i]) or not np.isfinite(rate[i]):
                    sound = False
            sound = sound and excess <= 1.0
        passed += sound
    return passed


class Watched:
    """The contact checks of a run, counted and timed, and its last segment."""

    def __init__(self) -> None:
        self.calls, self.seconds = 0, 0.0
        self.segment: Any = None

    def timed(self, function: Callable[..., None]) -> Callable[..., None]:
        """The same function, its calls counted and timed."""

        def call(*arguments: object) -> None:
            began = time.process_time()
            function(*arguments)
            self.seconds += time.process_time() - began
            self.calls += 1

        return call


@contextmanager
def watching() -> Iterator[Watched]:
    """Watch the checks of every run made here."""
    watched = Watched()
    check, begin = loop.check_contacts, segment.Segment.__init__

    def kept(self: Any, *arguments: Any) -> None:
        begin(self, *arguments)
        watched.segment = self

    loop.check_contacts = settling.check_contacts = watched.timed(check)
    segment.Segment.__init__ = kept  # type: ignore[method-assign]
    try:
        yield watched
    finally:
        loop.check_contacts = settling.check_contacts = check
        segment.Segment.__init__ = begin  # type: ignore[method-assign]


def seconds(solver: str, task: Task) -> float:
    """Processor time of a run, the smallest of some (s)."""
    times = []
    for _ in range(RUNS):
        began = time.process_time()
        solver_named(solver).solve(task)
        times.append(time.process_time() - began)
    return min(times)


def step_check(watched: Watched) -> float:
    """Processor time of the checks of one step (s)."""
    e = watched.segment._examined
    z = watched.segment._seen(0).z[0].copy()
    numbers = e.y[0].copy(), e.rate[0].copy(), z, e.z_bound + 2.0
    _checks(1, True, *numbers)
    one, none = (fastest(lambda c=c: _checks(ROUNDS, c, *numbers)) for c in (True, False))
    return (one - none) / ROUNDS


def row(name: str, solver: str, task: Task) -> str:
    """A line of the table."""
    solver_named(solver).solve(task)
    whole = seconds(solver, task)
    ledger = seconds(solver, replace(task, energy=True))
    with watching() as watched:
        steps = solver_named(solver).solve(task).work.steps
    each = step_check(watched)
    part = (steps * each + watched.seconds) / whole
    return (
        f"| {name} | {solver} | {steps} | {1e3 * whole:.3g} | {1e9 * each:.2g} | "
        f"{watched.calls} | {1e6 * watched.seconds / max(watched.calls, 1):.2g} | "
        f"{100.0 * part:.1f} | {100.0 * (ledger / whole - 1.0):.0f} |"
    )


def main() -> None:
    """Print the table."""
    print(f"rtol {RTOL:g}")
    print(
        "| problem | solver | steps | ms a run | checks of a step (ns) | contact checks | "
        "each (µs) | both, part of the run (%) | the ledger, where asked for (%) |"
    )
    print("|" + " --- |" * 9)
    for name, task in tasks().items():
        for solver in ("cvode", "ida"):
            print(row(name, solver, task), flush=True)


if __name__ == "__main__":
    main()
