"""What tolerances by body give a stiff body: ``python -m tests.benchmarks.own_tolerances``.

An undamped body of ω rad/s under a sine of one second, beside one of 1 rad/s, has a closed
form. Its error after that second in parts of its own motion, in units of rtol, and the steps,
with absolute tolerances that are the scene's for all and with those of each body.
"""

from __future__ import annotations

import math

from eventpound.motion.pulses import Sine
from eventpound.scene import GROUND, Body, Linear, Scene, Spring
from eventpound.solvers import solver_named
from eventpound.solvers.base import Task

A, PULSE = 3.0, 2.0 * math.pi
"""Amplitude (m/s²) and frequency (rad/s) of the ground motion."""
SOLVERS = ("cvode", "ida", "fast")
OMEGAS, TOLERANCES = (1e2, 1e3, 1e4), (1e-6, 1e-9, 1e-12)


def scene_of(omega: float) -> Scene:
    """The two bodies."""
    springs = (
        Spring("s", (GROUND, "stiff"), Linear(omega**2)),
        Spring("t", (GROUND, "soft"), Linear(1.0)),
    )
    return Scene((Body("stiff", 1.0), Body("soft", 1.0)), springs, motion=Sine(A, 1.0))


def error(solver: str, omega: float, rtol: float, *, alike: bool) -> str:
    """Error and steps of a run, its tolerances `alike` for both bodies or not."""
    atol = {"displacement": rtol * A / PULSE**2, "velocity": rtol * A / PULSE} if alike else {}
    run = solver_named(solver).solve(Task(scene_of(omega), 0.0, 1.0, rtol, atol))
    c, t = -A / (omega**2 - PULSE**2), 1.0
    u = c * (math.sin(PULSE * t) - PULSE / omega * math.sin(omega * t))
    v = c * PULSE * (math.cos(PULSE * t) - math.cos(omega * t))
    off = max(abs(run.u[0] - u), abs(run.v[0] - v) / omega) / abs(c)
    return f"{off / rtol:.0e}, {run.work.steps}"


def main() -> None:
    """Print the table."""
    titles = [f"`{s}`, {of}" for s in SOLVERS for of in ("L for all", "L_b")]
    print("| ω | rtol | " + " | ".join(titles) + " |")
    print("|" + " --- |" * (2 + len(titles)))
    for omega in OMEGAS:
        for rtol in TOLERANCES:
            cells = [error(s, omega, rtol, alike=a) for s in SOLVERS for a in (True, False)]
            print(f"| {omega:g} | {rtol:g} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
