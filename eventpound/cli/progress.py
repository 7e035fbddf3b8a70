"""What is said on stderr while a command works."""

from __future__ import annotations

import math
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from eventpound.case import Case

_SECONDS_BETWEEN_REPORTS = 0.2


def announce_compilation(solver: str) -> None:
    """Say that the first run compiles, where no function of the solver is kept compiled."""
    from eventpound.solvers import solver_named

    folder = solver_named(solver).kernels
    kernels = Path(__file__).parents[1] / "solvers" / folder / "__pycache__"
    if folder and not any(kernels.glob("*.nbi")):
        print(
            "eventpound: compiling for the first run, half a minute to two minutes", file=sys.stderr
        )


class Progress:
    """The share of a run that is done, on one line of a terminal."""

    def __init__(self, case: Case) -> None:
        self._start, self._duration = case.run.start_time, case.run.duration
        self._last = -math.inf

    def __call__(self, t: float) -> None:
        """Show that the run has reached the time t (s)."""
        now = time.monotonic()
        if now - self._last >= _SECONDS_BETWEEN_REPORTS:
            self._last = now
            share = (t - self._start) / self._duration
            print(f"\r{share:5.0%}  t = {t:.3f} s ", end="", file=sys.stderr, flush=True)

    def clear(self) -> None:
        """Take the line away."""
        print("\r\033[K", end="", file=sys.stderr, flush=True)


class Counter:
    """How many of a number of things are done, on one line of a terminal."""

    def __init__(self, total: int, what: str) -> None:
        self._total, self._what = total, what
        self._last = -math.inf

    def __call__(self, done: int) -> None:
        """Show that so many are done."""
        now = time.monotonic()
        if now - self._last >= _SECONDS_BETWEEN_REPORTS:
            self._last = now
            print(f"\r{done} of {self._total} {self._what} ", end="", file=sys.stderr, flush=True)

    def clear(self) -> None:
        """Take the line away."""
        print("\r\033[K", end="", file=sys.stderr, flush=True)
