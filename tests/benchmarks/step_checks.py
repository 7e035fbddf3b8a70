"""What the run-time checks of cvode and ida cost: ``python -m tests.benchmarks.step_checks``.

After every step both check that every number of the state and of its rate is finite and that
no |z| is beyond its bound, which is timed by itself on the numbers a run has left; at the end,
that the energy ledger closes, which is kept where it is asked for. Where a step is looked at for
an event, a comparison or two a contact tell besides that none penetrates or pulls.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
from numba import njit

from eventpound.numerics.arrays import Floats
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task
from eventpound.solvers.events import loop
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


@contextmanager
def last_segment() -> Iterator[list[Any]]:
    """The segments of every run made here, the last of them last."""
    kept: list[Any] = []
    begin = loop.Segment.__init__

    def keep(self: Any, *arguments: Any) -> None:
        begin(self, *arguments)
        kept[:] = [self]

    loop.Segment.__init__ = keep  # type: ignore[method-assign]
    try:
        yield kept
    finally:
        loop.Segment.__init__ = begin  # type: ignore[method-assign]


def seconds(solver: str, task: Task) -> float:
    """Processor time of a run, the smallest of some (s)."""
    times = []
    for _ in range(RUNS):
        began = time.process_time()
        solver_named(solver).solve(task)
        times.append(time.process_time() - began)
    return min(times)


def step_check(last: Any) -> float:
    """Processor time of the checks of one step (s)."""
    e, z = last._examined, last.now.state.z.copy()
    numbers = e.y[0].copy(), e.rate[0].copy(), z, e.z_bound + 2.0
    _checks(1, True, *numbers)
    one, none = (fastest(lambda c=c: _checks(ROUNDS, c, *numbers)) for c in (True, False))
    return (one - none) / ROUNDS


def row(name: str, solver: str, task: Task) -> str:
    """A line of the table."""
    solver_named(solver).solve(task)
    whole = seconds(solver, task)
    ledger = seconds(solver, replace(task, energy=True))
    with last_segment() as last:
        steps = solver_named(solver).solve(task).work.steps
    each = step_check(last[0])
    return (
        f"| {name} | {solver} | {steps} | {1e3 * whole:.3g} | {1e9 * each:.2g} | "
        f"{100.0 * steps * each / whole:.1f} | {100.0 * (ledger / whole - 1.0):.0f} |"
    )


def main() -> None:
    """Print the table."""
    print(f"rtol {RTOL:g}")
    print(
        "| problem | solver | steps | ms a run | checks of a step (ns) | "
        "part of the run (%) | the ledger, where asked for (%) |"
    )
    print("|" + " --- |" * 7)
    for name, task in tasks().items():
        for solver in ("cvode", "ida"):
            print(row(name, solver, task), flush=True)


if __name__ == "__main__":
    main()
