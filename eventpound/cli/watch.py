"""A run that is watched: shown as it goes on, left when a signal or the time limit says so."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from types import FrameType

from eventpound.errors import ComputationError, InterruptionError
from eventpound.interruption import Deferred


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


_STOPPING = b"\neventpound: stopping where the run can be left; once more to stop at once\n"
