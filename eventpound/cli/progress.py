"""What is shown while a command works, how long it will take, and how it is stopped.

Event-driven steps are as long as the motion allows, so that nobody knows their number
before; the rate of simulated against wall time tells more the longer one waits.
"""

from __future__ import annotations

import math
import os
import sys
import time
from collections.abc import Callable
from types import FrameType
from typing import TYPE_CHECKING, Self

from eventpound.basics.interruption import Deferred
from eventpound.cli.talk import complain, is_quiet, tell_step
from eventpound.errors import ComputationError, InterruptionError
from eventpound.numerics.compiling import Stopwatch

if TYPE_CHECKING:
    from eventpound.case import Case
    from eventpound.numerics.compiling import Compiling

_SECONDS_BETWEEN_REPORTS = 0.2
_LEAST_SECONDS, _SECONDS_A_FUNCTION = 15.0, 0.12
"""What the kernels of cvode take together, which are small, and a function of a large kernel
(`python -m tests.benchmarks.first_run`)."""
_SECONDS_TO_JUDGE = 5.0
"""Wall time after which the rate is trusted so far as to warn."""
_LONG = 600.0
"""Seconds left that nobody waits for without being asked."""
_STOPPING = b"\neventpound: stopping where the run can be left; once more to stop at once\n"


class _Line:
    """One line of a terminal, written now and then, and a block after which it is taken away.

    Nothing is written where stderr is no terminal.
    """

    def __init__(self) -> None:
        self._last = -math.inf

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.clear()

    def _show(self, text: Callable[[], str]) -> None:
        now = time.monotonic()
        if now - self._last >= _SECONDS_BETWEEN_REPORTS:
            self._last = now
            if sys.stderr.isatty():
                print(f"\r{text()}\033[K", end="", file=sys.stderr, flush=True)

    @staticmethod
    def clear() -> None:
        """Take the line away."""
        if sys.stderr.isatty():
            print("\r\033[K", end="", file=sys.stderr, flush=True)


class CompilationLine(_Line):
    """That kernels are compiled, small ones said once together; on a terminal how far it is."""

    def __init__(self) -> None:
        super().__init__()
        self._said: set[str] = set()
        self._last_state: Compiling | None = None

    def __call__(self, state: Compiling | None) -> None:
        """Show how far a compilation is; None where it has ended."""
        if state is None:
            self.clear()
            if self._last_state is not None:
                tell_step(f"compiled {self._last_state.name}: {self._last_state.seconds:.1f} s")
            return
        self._last_state = state
        seconds = max(_LEAST_SECONDS, _SECONDS_A_FUNCTION * state.total)
        large = seconds > _LEAST_SECONDS
        if state.name not in self._said and (large or not self._said) and not is_quiet():
            self._said.add(state.name)
            complain(
                "compiling what this needs, which is kept for later runs: about "
                f"{duration_text(seconds)}, more on a slow machine"
            )
        self._show(lambda: _compilation_text(state))


def _compilation_text(state: Compiling) -> str:
    what = f"{state.done} of {state.total} functions"
    if state.done == state.total:
        what = f"{state.total} functions, which are optimised together now"
    return f"compiling {state.name}: {what}, {state.seconds:.0f} s"


class Progress(_Line):
    """The share of a run that is done, and the time left, as its `forecast` has it."""

    def __init__(self, case: Case) -> None:
        super().__init__()
        self._start, self._duration = case.run.start_time, case.run.duration
        self.forecast = Forecast(self._start, self._start + self._duration)
        self._pass = ""

    def begins(self, what: str) -> None:
        """Say of what comes next what it is: each pass goes from the start to the end."""
        tell_step(what)
        self._pass = f"{what}: "

    def __call__(self, t: float) -> None:
        """Show that the run has reached the time t (s)."""
        self._show(lambda: self._line(t, self.forecast.left(t)))

    def _line(self, t: float, left: float | None) -> str:
        line = f"{self._pass}{(t - self._start) / self._duration:5.0%}  t = {t:.6g} s"
        return line if left is None else f"{line}, about {duration_text(left)} left"


class Counter(_Line):
    """How many of a number of things are done, their rate and the time left."""

    def __init__(self, what: str) -> None:
        super().__init__()
        self._what, self._before, self._began = what, 0, -math.inf

    def __call__(self, done: int, total: int) -> None:
        """Show that so many are done; what is at first was there before."""
        if self._began == -math.inf:
            self._before, self._began = done, time.monotonic()
        self._show(lambda: self._line(done, total))

    def _line(self, done: int, total: int) -> str:
        line = f"{done / total:5.0%}  {done} of {total} {self._what}"
        passed = time.monotonic() - self._began
        if done == self._before or passed <= 0.0:
            return line
        rate = (done - self._before) / passed
        return f"{line}, {rate:.3g} a second, {duration_text((total - done) / rate)} left"


class Doing(_Line):
    """What is being done."""

    def __call__(self, what: str) -> None:
        """Say that this begins."""
        tell_step(what)
        self._last = -math.inf
        self._show(lambda: what)


class Forecast:
    """Wall time left of a run, and one warning where it is long.

    Parameters
    ----------
    start, end : float
        The run (s).
    """

    def __init__(self, start: float, end: float) -> None:
        self._start, self._end = start, end
        self._clock = Stopwatch()
        self._began = self._first = self._last = math.inf
        self._warned = False

    def left(self, t: float) -> float | None:
        """Wall time (s) until the end at the rate so far; None while it says nothing."""
        # Compilation says nothing of the rate.
        now = time.monotonic() - self._clock.compilation
        if t < self._last < math.inf or self._began == math.inf:
            self._began, self._first = now, t
        self._last = t
        passed = now - self._began
        if passed < _SECONDS_TO_JUDGE or t <= self._first:
            return None
        return (self._end - t) * passed / (t - self._first)

    def warn(self, t: float) -> None:
        """Say so on stderr, once, where the run will take unreasonably long."""
        if self._warned:
            return
        left = self.left(t)
        if left is None or left < _LONG:
            return
        self._warned = True
        done = (t - self._start) / (self._end - self._start)
        _Line.clear()
        complain(
            f"warning: {done:.2g} of the run is done; at this rate the rest takes "
            f"about {duration_text(left)}; --time-limit or --max-steps bounds it, a larger rtol "
            "or time_step makes it shorter"
        )


def duration_text(seconds: float) -> str:
    """Days, hours, minutes or seconds, whichever reads well."""
    for size, unit in ((86400.0, "days"), (3600.0, "h"), (60.0, "min")):
        if seconds >= 1.5 * size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.0f} s"


class Watch(Deferred):
    """What a solver calls with the time reached, and may be stopped by.

    Parameters
    ----------
    limit : float or None
        Seconds after which the run is left.
    shows : callable
        Each is called with the time reached (s).
    """

    def __init__(self, limit: float | None, *shows: Callable[[float], None]) -> None:
        super().__init__(patient=False)
        self._limit, self._shows = limit, shows
        self._began = time.monotonic()

    def __call__(self, t: float) -> None:
        """Show the time reached, or stop there.

        Raises
        ------
        InterruptionError
            After a signal.
        ComputationError
            After the time limit.
        """
        if self.noted is not None:
            raise InterruptionError("interrupted", t)
        if self._limit is not None and time.monotonic() - self._began > self._limit:
            raise ComputationError(
                f"the time limit of {self._limit:g} s is reached; give a longer --time-limit, "
                "a larger --rtol or a shorter duration",
                t,
            )
        for show in self._shows:
            show(t)

    def _note(self, number: int, frame: FrameType | None) -> None:
        super()._note(number, frame)
        # A print could be what was interrupted.
        os.write(sys.__stderr__.fileno() if sys.__stderr__ else 2, _STOPPING)
