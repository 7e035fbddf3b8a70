"""What was measured to choose how CVODE is used; the tables of docs/measured/choices.md.

``python -m tests.benchmarks.choices``
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any
from unittest.mock import patch

import numpy as np

from eventpound.mechanics.ground_frame import NO_FRAME
from eventpound.motion.pulses import Sine
from eventpound.scene import BARRIER, GROUND, Body, Contact, Linear, Scene, Spring
from eventpound.simulation import simulate
from eventpound.solvers.base import Recording, Task
from eventpound.solvers.cvode import Cvode, integrator
from eventpound.solvers.events.loop import EventLoop
from eventpound.solvers.events.roots import EVENTS
from eventpound.solvers.sundials.layout import LOCAL_SHARE
from tests.reference.problems import Problem, load

TOLERANCES = (1e-6, 1e-8, 1e-10)
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
    segment = "eventpound.solvers.events.segment."
    settings: dict[str, Any] = {"STOP_AT_SAMPLES": math.inf if stops else 0.0}
    if not frame:
        settings["moving_frame"] = lambda piece: NO_FRAME
    patches = [patch(segment + name, value) for name, value in settings.items()]
    for item in patches:
        item.start()
    try:
        yield
    finally:
        for item in patches:
            item.stop()


def _line(label: str, problem: Problem, method: str) -> None:
    cells = []
    for rtol in TOLERANCES:
        run = _run(problem, rtol, method)
        cells.append(f"{run.work.rhs:>7} {_error(problem, run):8.1e}")
    print(f"{label:<44}" + "  ".join(cells))


def methods() -> None:
    """Adams against BDF on pulses and records."""
    print("calls of the right-hand side and error, at rtol 1e-6, 1e-8, 1e-10")
    problems = load()
    for name in ("A01", "A10", "A20", "B12", "E01"):
        for method in ("Adams", "BDF"):
            _line(f"{name} {method}", problems[name], method)


def records() -> None:
    """Coordinates and stops for a sampled record."""
    problems = load()
    for name in ("F01", "E07"):
        for frame in (False, True):
            for stops in (False, True):
                with _variant(frame=frame, stops=stops):
                    label = f"{name} {'moving frame' if frame else 'relative'}, " + (
                        "stops at samples" if stops else "free"
                    )
                    _line(label, problems[name], "Adams")


def grazes() -> None:
    """A barrier that a harmonic motion overshoots by little: who finds the impact, at what cost."""
    peak = -float(simulate(_oscillator(()), rtol=1e-12, duration=9.0).peaks["min"].iloc[0])
    print(
        "\na barrier overshot by a part of the peak: whether the first pass is found, with how many"
    )
    print("right-hand side until then, or, with events of the solver, of the whole run, and ms")
    print(f"{'overshoot':>10} {'rtol':>7} {'gap':>12} {'gap and rate':>14}", end="")
    print(f"{'events = sundials':>20} {'events = own':>20}")
    for overshoot in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8):
        gap = peak * (1.0 - overshoot)
        scene = _oscillator((Contact("wall", BARRIER, "body", gap, 0.5),))
        for rtol in (1e-6, 1e-8, 1e-10):
            plain = [_plain(gap, rtol, with_rate=with_rate) for with_rate in (False, True)]
            taken, runs = _in_turns(Task(scene, 0.0, 9.0, rtol))
            cells = [f"{_seen(found):>4} {calls:>5}" for found, calls in plain]
            cells += [
                f"{_seen(bool(run.events)):>8} {run.work.rhs:>4} {1e3 * seconds:>5.2f}"
                for run, seconds in zip(runs[::-1], taken[::-1], strict=True)
            ]
            print(f"{overshoot:>10.0e} {rtol:>7.0e}   " + "   ".join(cells))


def _seen(found: bool) -> str:
    return "yes" if found else "no"


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


def finders() -> None:
    """Whoever finds events, on solved problems: calls, error, and time in turns."""
    print("\nevents = own, then sundials: calls of the right-hand side, error, ratio of times")
    problems = load()
    for name in ("A01", "A10", "A20", "B12", "B15", "C03", "E01", "E07", "F01"):
        problem = problems[name]
        cells = []
        for rtol in TOLERANCES:
            taken, runs = _in_turns(Task(problem.scene, 0.0, problem.end, rtol))
            cells += [f"{run.work.rhs:>7} {_error(problem, run):8.1e}" for run in runs]
            cells.append(f"{taken[1] / taken[0]:5.2f}")
        print(f"{name:<5}" + " ".join(cells))


def _in_turns(task: Task) -> tuple[list[float], list[Recording]]:
    """Shortest processor times (s) and runs of a task, events found by the loop and by CVODE."""
    taken, runs = [math.inf, math.inf], []
    for _ in range(REPEATS):
        runs = []
        for i, events in enumerate(EVENTS):
            began = time.process_time()
            runs.append(Cvode().solve(replace(task, settings={"events": events})))
            taken[i] = min(taken[i], time.process_time() - began)
    return taken, runs


def _oscillator(contacts: tuple[Contact, ...]) -> Scene:
    body = Body("body", 1.0)
    spring = Spring("spring", (GROUND, "body"), Linear(1.0))
    return Scene((body,), (spring,), (), contacts, Sine(1.0, 2.0 * math.pi / 1.3))


if __name__ == "__main__":
    methods()
    records()
    grazes()
    finders()
