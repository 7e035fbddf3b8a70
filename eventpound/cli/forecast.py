"""How long a run will take, from how far it has come.

Event-driven steps are as long as the motion allows, so that nobody knows their number
before; the rate of simulated against wall time tells more the longer one waits.
"""

from __future__ import annotations

import math
import sys
import time

from eventpound.numerics.compiling import Stopwatch

_SECONDS_TO_JUDGE = 5.0
"""Wall time after which the rate is trusted so far as to warn."""
_LONG = 600.0
"""Seconds left that nobody waits for without being asked."""


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
        print(
            "\r\033[K"
            * sys.stderr.isatty()
            + f"eventpound: warning: {done:.2g} of the run is done; at this rate the rest takes "
            f"about {duration_text(left)}; --time-limit or --max-steps bounds it, a larger rtol "
            "or time_step makes it shorter",
            file=sys.stderr,
        )


def duration_text(seconds: float) -> str:
    """Days, hours, minutes or seconds, whichever reads well."""
    for size, unit in ((86400.0, "days"), (3600.0, "h"), (60.0, "min")):
        if seconds >= 1.5 * size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.0f} s"
