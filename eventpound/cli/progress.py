"""What is said on stderr while a command works."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.cli.forecast import Forecast, duration_text

if TYPE_CHECKING:
    from eventpound.case import Case

_SECONDS_BETWEEN_REPORTS = 0.2


def announce_compilation(solver: str) -> bool:
    """Say that the first run compiles, where no function of the solver is kept compiled.

    Returns whether it does.
    """
    from eventpound.solvers import solver_named

    folder = solver_named(solver).kernels
    kernels = Path(__file__).parents[1] / "solvers" / folder / "__pycache__"
    compiles = bool(folder) and not any(kernels.glob("*.nbi"))
    if compiles:
        print(
            "eventpound: compiling for the first run, half a minute to three minutes",
            file=sys.stderr,
        )
    return compiles


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
    """The share of a run that is done, and the time left."""

    def __init__(self, case: Case, forecast: Forecast) -> None:
        super().__init__()
        self._start, self._duration = case.run.start_time, case.run.duration
        self._forecast = forecast

    def __call__(self, t: float) -> None:
        """Show that the run has reached the time t (s)."""
        self._show(lambda: self._line(t, self._forecast.left(t)))

    def _line(self, t: float, left: float | None) -> str:
        line = f"{(t - self._start) / self._duration:5.0%}  t = {t:.6g} s"
        return line if left is None else f"{line}, about {duration_text(left)} left"


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
        return f"{line}, {rate:.3g} a second, {duration_text((self._size - total) / rate)} left"
