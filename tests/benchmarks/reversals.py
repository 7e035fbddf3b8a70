"""``python -m tests.benchmarks.reversals [COUNT]``: whether a tighter tolerance errs less.

The elastoplastic body of `tests/solvers/test_reversals.py`, whose motion is 70 yield
displacements, at COUNT tolerances (250) from 9e-10 to 1e-12: the error of its final place in
parts of its peak and of rtol, against ``fast`` at 1e-13.
"""

from __future__ import annotations

import sys

import numpy as np

from eventpound.simulation import simulate
from tests.solvers.test_reversals import LENGTH, STRUCK

WAYS = (("cvode", "own"), ("cvode", "sundials"), ("ida", "own"))


def main() -> None:
    """Print a line for each solver and each who finds its events."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 250
    truth = simulate(STRUCK, "fast", 1e-13, duration=LENGTH).recording
    size = abs(truth.displacement.minimum[0])
    print("| solver | events found by | median | 95 % | largest | steps of a run |")
    print("|" + " --- |" * 6)
    for solver, events in WAYS:
        errors, steps = [], 0
        for rtol in np.geomspace(9e-10, 1e-12, count):
            run = simulate(STRUCK, solver, rtol, duration=LENGTH, settings={"events": events})
            errors.append(abs(run.recording.u[0] - truth.u[0]) / (size * rtol))
            steps += run.recording.work.steps
        most = np.quantile(errors, [0.5, 0.95, 1.0])
        cells = (f"`{solver}`", f'`"{events}"`', *(f"{each:.0f}" for each in most))
        print(f"| {' | '.join(cells)} | {steps / count:.0f} |", flush=True)


if __name__ == "__main__":
    main()
