"""What was measured to choose how CVODE is used; prints the tables of docs/method.md.

``python -m tests.benchmarks.choices``
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any
from unittest.mock import patch

import numpy as np

from eventpound.mechanics.ground_frame import NO_FRAME
from eventpound.motion.pulses import Sine
from eventpound.scene import BARRIER, GROUND, Body, Contact, Linear, Scene, Spring
from eventpound.simulation import simulate
from eventpound.solvers.base import Recording, Task
from eventpound.solvers.cvode import integrator
from eventpound.solvers.events.loop import EventLoop
from tests.reference.problems import Problem, load

TOLERANCES = (1e-6, 1e-8, 1e-10)


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
    """A barrier that a harmonic motion overshoots by little: who finds the impact."""
    from sksundae.cvode import CVODE

    peak = -float(simulate(_oscillator(()), rtol=1e-12, duration=9.0).peaks["min"].iloc[0])
    print("\nimpacts found at a barrier overshot by a part of the peak (first pass)")
    print(f"{'overshoot':>10} {'rtol':>7} {'gap as root of CVODE':>22} {'eventpound':>12}")

    def rate(t: float, y: np.ndarray, yp: np.ndarray) -> None:
        yp[0], yp[1] = y[1], -y[0] - math.sin(1.3 * t) * (t < 2.0 * math.pi / 1.3)

    for overshoot in (1e-2, 1e-3, 1e-4, 1e-6, 1e-8):
        gap = peak * (1.0 - overshoot)

        for rtol in (1e-6, 1e-8):
            plain = CVODE(
                rate, method="Adams", rtol=rtol, atol=rtol, eventsfn=_gap_root(gap), num_events=1,
                max_num_steps=10_000,
            )  # fmt: skip
            found = plain.solve(np.array([0.0, 9.0]), np.zeros(2)).t_events
            contact = Contact("wall", BARRIER, "body", gap, 0.5)
            ours = simulate(_oscillator((contact,)), rtol=rtol, duration=9.0)
            seen = "yes" if found is not None and len(found) else "no"
            here = "yes" if ours.impacts else "no"
            print(f"{overshoot:>10.0e} {rtol:>7.0e} {seen:>22} {here:>12}")


def _gap_root(gap: float) -> Any:
    """Root function of a barrier on the left for CVODE's own root finder."""

    def root(t: float, y: np.ndarray, g: np.ndarray) -> None:
        g[0] = gap + y[0]

    root.terminal, root.direction = [True], [-1]  # type: ignore[attr-defined]
    return root


def _oscillator(contacts: tuple[Contact, ...]) -> Scene:
    body = Body("body", 1.0)
    spring = Spring("spring", (GROUND, "body"), Linear(1.0))
    return Scene((body,), (spring,), (), contacts, Sine(1.0, 2.0 * math.pi / 1.3))


if __name__ == "__main__":
    methods()
    records()
    grazes()
