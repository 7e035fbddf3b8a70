"""What the checks after every step cost: ``python -m tests.benchmarks.invariants``.

The fast solver checks after each step that the equations of motion hold at its end,
that all numbers are finite, that nothing penetrates and that time goes on. The same
compiled functions are timed by themselves, on the numbers that a run has left, and
their cost times the number of steps is given as a part of the time of the run.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numba import njit

from eventpound import load_case
from eventpound.contact.event_rows import EVENT_WIDTH
from eventpound.contact.impacts import DONE
from eventpound.mechanics.model import assemble
from eventpound.numerics.arrays import Ints
from eventpound.simulation import task_of
from eventpound.solvers.base import Task
from eventpound.solvers.events.recorder import row_width
from eventpound.solvers.events.scales import scene_scales
from eventpound.solvers.fast.advance import advance
from eventpound.solvers.fast.constants import blank_state, plan_of
from eventpound.solvers.fast.expansion import defect_error
from eventpound.solvers.fast.run import GOING_ON, STEPS, Run
from eventpound.solvers.fast.single.oscillator import oscillate
from eventpound.solvers.fast.single.step import audit, fits
from eventpound.solvers.fast.solver import run_of
from eventpound.solvers.fast.step import audit as audit_step
from tests.benchmarks import yardsticks
from tests.benchmarks.problem import folder_of

ROUNDS = 1_000_000
REPEATS = 9
RTOL = 1e-6
EVENTS = 4096
"""Events for which there is room."""
LAST_STEP = 0.01
"""Length of the step in which the checks are timed (s); their cost does not depend on it."""
COPIES = 16


@njit(_nrt=False, error_model="numpy")
def _single_checks(rounds: int, order: int, checked: bool, count: Ints, copies: Any) -> int:
    """Steps that pass, of `rounds`, on copies of the numbers in turn, lest any be reused."""
    passed = 0
    for i in range(rounds):
        body = copies[i % COPIES]
        body.bend += 1e-300
        if not checked or (fits(LAST_STEP, order, body) and audit(count, body) == GOING_ON):
            passed += 1
    return passed


@njit(_nrt=False, error_model="numpy")
def _general_checks(rounds: int, order: int, checked: bool, run: Run) -> int:
    """The same of several bodies."""
    passed = 0
    for _ in range(rounds):
        run.seen.a[0] += 1e-300
        run.state.u[0] += 1e-300
        if checked:
            error = defect_error(LAST_STEP, order, 0.0, run)
            passed += audit_step(error, run) >= DONE
        else:
            passed += 1
    return passed


def fastest(call: Callable[[], object]) -> float:
    """Smallest processor time of several calls (s)."""
    best = np.inf
    for _ in range(REPEATS):
        began = time.process_time()
        call()
        best = min(best, time.process_time() - began)
    return float(best)


class Prepared:
    """A run that can be made again and again without Python."""

    def __init__(self, task: Task) -> None:
        self.model = assemble(task.scene)
        self.scales = scene_scales(task.scene, self.model, task.end - task.start)
        self.plan = plan_of(task, self.model, self.scales)
        self.start = task.start
        self.fresh()

    def fresh(self) -> None:
        """Everything as at the start of the run."""
        model, plan = self.model, self.plan
        state = blank_state(plan, model.u0, model.v0, model.z0, self.start)
        run = run_of(plan, state, model, self.scales)
        record = run.record._replace(
            events=np.zeros((EVENTS, EVENT_WIDTH)), rows=np.zeros((2 * EVENTS, row_width(model)))
        )
        self.run = run._replace(record=record)

    def seconds(self) -> float:
        """Processor time of the run (s)."""
        best = np.inf
        for _ in range(3 * REPEATS):
            self.fresh()
            began = time.process_time()
            if self.plan.oscillator.alone:
                run = self.run
                ended = oscillate(10**6, run.plan, run.state, run.series.single, run.record)
            else:
                ended = advance(10**6, self.run)
            best = min(best, time.process_time() - began)
            assert ended == DONE
        return float(best)

    def checks(self) -> float:
        """Processor time of one step's checks (s)."""
        order = self.plan.limits.order
        if self.plan.oscillator.alone:
            numbers = order, self.run.state.count, np.tile(self.run.series.single.body, COPIES)
            one, none = (
                fastest(lambda c=c: _single_checks(ROUNDS, numbers[0], c, *numbers[1:]))
                for c in (True, False)
            )
            return (one - none) / ROUNDS
        one, none = (
            fastest(lambda c=c: _general_checks(ROUNDS, order, c, self.run)) for c in (True, False)
        )
        return (one - none) / ROUNDS


def tasks() -> dict[str, Task]:
    """The runs shown, by name."""
    known = {name: yardsticks.load()[name].task for name in ("P1", "P3", "P7", "PZ")}
    for name in ("pair", "bridge-pulse"):
        known[name] = task_of(load_case(folder_of(name)), RTOL)
    return {
        name: replace(task, rtol=RTOL, output_times=np.empty(0)) for name, task in known.items()
    }


def main() -> None:
    """Print the table."""
    print("| problem | steps | µs a run | checks of a step (ns) | part of the run (%) |")
    print("|" + " --- |" * 5)
    for name, task in tasks().items():
        prepared = Prepared(task)
        prepared.seconds()
        whole = prepared.seconds()
        steps, each = int(prepared.run.state.count[STEPS]), prepared.checks()
        part = 100.0 * steps * each / whole
        print(f"| {name} | {steps} | {1e6 * whole:.4g} | {1e9 * each:.2g} | {part:.1f} |")


if __name__ == "__main__":
    main()
