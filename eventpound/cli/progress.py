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

    kernels = Path(__file__).parents[1] / "solvers" / solver_named(solver).kernels / "__pycache__"
    if not any(kernels.glob("*.nbi")):
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


class StudyProgress:
    """Runs of a study that are done, their rate and the time left, on one line of a terminal.

    Parameters
    ----------
    size : int
        Number of runs.
    """

    def __init__(self, size: int) -> None:
        self._size, self._began = size, time.monotonic()
        self._last = -math.inf

    def __call__(self, done: int, before: int) -> None:
        """Show that `done` runs were made after the `before` that were there."""
        now = time.monotonic()
        if now - self._last < _SECONDS_BETWEEN_REPORTS:
            return
        self._last = now
        total = before + done
        line = f"\r{total / self._size:5.0%}  {total} of {self._size} runs"
        if done:
            rate = done / (now - self._began)
            line += f", {rate:.3g} a second, {_duration((self._size - total) / rate)} left"
        print(line + "\033[K", end="", file=sys.stderr, flush=True)

    def clear(self) -> None:
        """Take the line away."""
        print("\r\033[K", end="", file=sys.stderr, flush=True)


def _duration(seconds: float) -> str:
    """Hours, minutes or seconds, whichever reads well."""
    if seconds >= 5400.0:
        return f"{seconds / 3600.0:.1f} h"
    return f"{seconds / 60.0:.0f} min" if seconds >= 90.0 else f"{seconds:.0f} s"
