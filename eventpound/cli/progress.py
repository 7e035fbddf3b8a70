"""What is said on stderr while a command works."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
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
            "eventpound: compiling for the first run, half a minute to three minutes",
            file=sys.stderr,
        )


class _Line:
    """One line of a terminal, written now and then."""

    def __init__(self) -> None:
        self._last = -math.inf

    def _show(self, text: Callable[[], str]) -> None:
        now = time.monotonic()
        if now - self._last >= _SECONDS_BETWEEN_REPORTS:
            self._last = now
            print(f"\r{text()}\033[K", end="", file=sys.stderr, flush=True)

    def clear(self) -> None:
        """Take the line away."""
        print("\r\033[K", end="", file=sys.stderr, flush=True)


class Progress(_Line):
    """The share of a run that is done."""

    def __init__(self, case: Case) -> None:
        super().__init__()
        self._start, self._duration = case.run.start_time, case.run.duration

    def __call__(self, t: float) -> None:
        """Show that the run has reached the time t (s)."""
        self._show(lambda: f"{(t - self._start) / self._duration:5.0%}  t = {t:.3f} s ")


class Counter(_Line):
    """How many of a number of things are done."""

    def __init__(self, total: int, what: str) -> None:
        super().__init__()
        self._total, self._what = total, what

    def __call__(self, done: int) -> None:
        """Show that so many are done."""
        self._show(lambda: f"{done} of {self._total} {self._what} ")


class StudyProgress(_Line):
    """Runs of a study that are done, their rate and the time left.

    Parameters
    ----------
    size : int
        Number of runs.
    """

    def __init__(self, size: int) -> None:
        super().__init__()
        self._size, self._began = size, time.monotonic()

    def __call__(self, done: int, before: int) -> None:
        """Show that `done` runs were made after the `before` that were there."""
        self._show(lambda: self._line(done, before + done))

    def _line(self, done: int, total: int) -> str:
        line = f"{total / self._size:5.0%}  {total} of {self._size} runs"
        if not done:
            return line
        rate = done / (time.monotonic() - self._began)
        return f"{line}, {rate:.3g} a second, {_duration((self._size - total) / rate)} left"


def _duration(seconds: float) -> str:
    """Hours, minutes or seconds, whichever reads well."""
    if seconds >= 5400.0:
        return f"{seconds / 3600.0:.1f} h"
    return f"{seconds / 60.0:.0f} min" if seconds >= 90.0 else f"{seconds:.0f} s"
