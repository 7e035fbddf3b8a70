"""Signals that end a program, noted and answered where nothing is half done.

Ctrl-C (SIGINT), termination (SIGTERM) and the end of a time limit (SIGALRM) can come at any
instruction. Within `Deferred` they are noted only; whoever works asks `noted`, or for an `answer`,
where it can stop, and a signal that nobody answered is raised again at the end of the block.
"""

from __future__ import annotations

import signal
import threading
from types import FrameType, TracebackType
from typing import Any, Self

_ENDING = {signal.SIGINT, signal.SIGTERM, getattr(signal, "SIGALRM", signal.SIGTERM)}
"""Windows has no SIGALRM."""


class Deferred:
    """A block in which signals wait.

    Parameters
    ----------
    patient : bool
        Whether a second signal waits, too; otherwise it raises KeyboardInterrupt
        there and then, for whoever does not want to wait.
    """

    def __init__(self, *, patient: bool) -> None:
        self.noted: int | None = None
        """The first signal that came."""
        self._patient = patient
        self._before: dict[int, Any] = {}

    def __enter__(self) -> Self:
        # Python answers signals in the main thread only; no other can be interrupted.
        if threading.current_thread() is threading.main_thread():
            self._before = {
                number: signal.signal(number, self._note)
                for number in _ENDING
                # Another language's handler could not be put back.
                if signal.getsignal(number) is not None
            }
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)
        noted, self.noted = self.noted, None
        if noted is not None and error is None:
            signal.raise_signal(noted)

    def answer(self) -> None:
        """Answer a signal that has come as if it came now."""
        if self.noted is not None:
            self.__exit__(None, None, None)
            self.__enter__()

    def _note(self, number: int, frame: FrameType | None) -> None:
        if self.noted is not None and not self._patient:
            raise KeyboardInterrupt
        self.noted = self.noted or number


class Terminable:
    """A block in which termination is what Ctrl-C is: KeyboardInterrupt."""

    def __enter__(self) -> None:
        self._here = (
            threading.current_thread() is threading.main_thread()
            and signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
        )
        if self._here:
            signal.signal(signal.SIGTERM, signal.default_int_handler)

    def __exit__(self, *_: object) -> None:
        if self._here:
            signal.signal(signal.SIGTERM, signal.SIG_DFL)


def is_interruption(error: BaseException) -> bool:
    """Whether an error is a Ctrl-C, or the complaint of compiled code or of a lock that one came.

    Compiled code may take the exception for a fault of what it called, and complains of it
    with a `SystemError`; through some layers, of its own complaint again. A lock of Python that
    one came to while it was taken complains that it is not taken.
    """
    found: BaseException | None = error
    while isinstance(found, (SystemError, RuntimeError)):
        found = found.__cause__ or found.__context__
    return isinstance(found, KeyboardInterrupt)
