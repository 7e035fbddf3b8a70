"""What was measured to choose how CVODE is used; the tables of docs/measured/choices.md.

``python -m tests.benchmarks.choices``
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from typing import Any
from unittest.mock import patch

import numpy as np

from eventpound.mechanics.ground_frame import NO_FRAME
from eventpound.motion.pulses import Sine
from eventpound.scene import BARRIER, GROUND, Body, Contact, Linear, Scene, Spring
from eventpound.simulation import simulate
from eventpound.solvers import solver_named
from eventpound.solvers.base import Recording, Task
from eventpound.solvers.cvode import integrator
from eventpound.solvers.events.loop import EventLoop
from eventpound.solvers.events.roots import EVENTS
from eventpound.solvers.sundials.memory import LOCAL_SHARE
from tests.reference.problems import Problem, load

TOLERANCES = (1e-6, 1e-8, 1e-10)
AT = tuple(f"{rtol:.0e}" for rtol in TOLERANCES)
REPEATS = 7


def _run(problem: Problem, rtol: float, method: str) -> Recording:
    task = Task(problem.scene, 0.0, problem.end, rtol)
    return EventLoop(task, integrator(rtol, method)).run()


def _error(problem: Problem, run: Recording) -> float:
    """Error of the smallest displacements as part of the largest."""
    wanted = np.array([float(value) for value in problem.result["u_min"]])
    return float(np.abs(run.displacement.minimum - wanted).max() / np.abs(wanted).max())


@contextmanager
def _variant(*, frame: bool, stops: bool) -> Iterator[None]:
    events = "eventpound.solvers.events."
    settings: dict[str, Any] = {"loop.STOP_AT_SAMPLES": math.inf if stops else 0.0}
    if not frame:
        settings["loop.moving_frame"] = lambda piece: NO_FRAME
    patches = [patch(events + name, value) for name, value in settings.items()]
    for item in patches:
        item.start()
    try:
        yield
    finally:
        for item in patches:
            item.stop()


def _table(*columns: str) -> None:
    """Begin one; cells of tolerances are calls of the right-hand side and error."""
    _row(*columns)
    _row(*["---"] * len(columns))


def _row(*cells: str) -> None:
    print("| " + " | ".join(cells) + " |", flush=True)


def _line(first: str, second: str, problem: Problem, method: str) -> None:
    runs = [_run(problem, rtol, method) for rtol in TOLERANCES]
    _row(first, second, *(f"{run.work.rhs}, {_error(problem, run):.0e}" for run in runs))


def methods() -> None:
    """Adams against BDF on pulses and records."""
    _table("problem", "method", *AT)
    problems = load()
    for name in ("A01", "A10", "A20", "B12", "E01"):
        for method in ("Adams", "BDF"):
            _line(name, method, problems[name], method)


def records() -> None:
    """Coordinates and stops for a sampled record."""
    _table("record", "coordinates", *AT)
    problems = load()
    for name in ("F01", "E07"):
        for frame in (False, True):
            for stops in (False, True):
                with _variant(frame=frame, stops=stops):
                    label = "moving frame" if frame else "relative"
                    label += ", stops" if stops else ", free"
                    _line(name, label, problems[name], "Adams")


def grazes() -> None:
    """A barrier that a harmonic motion overshoots by little: who finds the impact, at what cost."""
    peak = -float(simulate(_oscillator(()), rtol=1e-12, duration=9.0).peaks["min"].iloc[0])
    _table("overshoot", "rtol", "gap", "gap and its rate", '`"sundials"`, ms', '`"own"`, ms')
    for overshoot in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8):
        gap = peak * (1.0 - overshoot)
        scene = _oscillator((Contact("wall", BARRIER, "body", gap, 0.5),))
        for rtol in (1e-6, 1e-8, 1e-10):
            plain = [_plain(gap, rtol, with_rate=with_rate) for with_rate in (False, True)]
            taken, runs = _in_turns(Task(scene, 0.0, 9.0, rtol), "cvode")
            cells = [f"{_seen(found)}, {calls}" for found, calls in plain]
            cells += [
                f"{_seen(bool(run.events))}, {run.work.rhs}, {1e3 * seconds:.1f}"
                for run, seconds in zip(runs[::-1], taken[::-1], strict=True)
            ]
            _row(f"{overshoot:.0e}", f"{rtol:.0e}", *cells)


def _seen(found: bool) -> str:
    return "found" if found else "missed"


def _plain(gap: float, rtol: float, *, with_rate: bool) -> tuple[bool, int]:
    """Whether CVODE finds the barrier by root functions of the gap, and calls until then.

    A rise of the gap's rate only tells of the bottom of a dip, from where the search goes on.
    """
    from sksundae.cvode import CVODE

    def rate(t: float, y: np.ndarray, yp: np.ndarray) -> None:
        yp[0], yp[1] = y[1], -y[0] - math.sin(1.3 * t) * (t < 2.0 * math.pi / 1.3)

    def root(t: float, y: np.ndarray, g: np.ndarray) -> None:
        g[0] = gap + y[0]
        if with_rate:
            g[1] = y[1] or 1e-300

    functions = 2 if with_rate else 1
    root.terminal = [True] * functions  # type: ignore[attr-defined]
    root.direction = [-1, 1][:functions]  # type: ignore[attr-defined]
    # As tight as a step of the solver is (`LOCAL_SHARE`).
    solver = CVODE(
        rate, method="Adams", rtol=LOCAL_SHARE * rtol, atol=LOCAL_SHARE * rtol, eventsfn=root,
        num_events=functions, max_num_steps=10_000,
    )  # fmt: skip
    result = solver.init_step(0.0, np.zeros(2))
    while result.t < 9.0:
        result = solver.step(9.0, "onestep", 9.0)
        if gap + result.y[0] < 0.0 or (result.status == 2 and result.i_events[-1][0]):
            return True, result.nfev
    return False, result.nfev


def finders(solver: str) -> None:
    """Whoever finds events, on solved problems: calls, error, and time in turns."""
    _table("problem", "events", *AT)
    problems = load()
    for name in ("A01", "A10", "A20", "B12", "B15", "C03", "E01", "E07", "F01"):
        problem = problems[name]
        tasks = [Task(problem.scene, 0.0, problem.end, rtol) for rtol in TOLERANCES]
        both = [_in_turns(task, solver) for task in tasks]
        for i, events in enumerate(EVENTS):
            runs = [found[i] for _, found in both]
            cells = [f"{run.work.rhs}, {_error(problem, run):.0e}" for run in runs]
            _row(name, f'`"{events}"`', *cells)
        _row(name, "ratio of times", *(f"{taken[1] / taken[0]:.2f}" for taken, _ in both))


def _in_turns(task: Task, solver: str) -> tuple[list[float], list[Recording]]:
    """Shortest processor times (s) and runs of a task, events found by the loop and by SUNDIALS."""
    taken, runs = [math.inf, math.inf], []
    for _ in range(REPEATS):
        runs = []
        for i, events in enumerate(EVENTS):
            began = time.process_time()
            settings = {"events": events}
            runs.append(solver_named(solver).solve(replace(task, settings=settings)))
            taken[i] = min(taken[i], time.process_time() - began)
    return taken, runs


def _oscillator(contacts: tuple[Contact, ...]) -> Scene:
    body = Body("body", 1.0)
    spring = Spring("spring", (GROUND, "body"), Linear(1.0))
    return Scene((body,), (spring,), (), contacts, Sine(1.0, 2.0 * math.pi / 1.3))


def main() -> None:
    """Print the five tables."""
    for part in (methods, records, grazes, partial(finders, "cvode"), partial(finders, "ida")):
        part()
        print()


if __name__ == "__main__":
    main()
