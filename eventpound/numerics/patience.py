"""When a kernel that Python can run by itself is compiled: once that pays.

What an instant demands takes some 25 s to compile and 10 ms to run in Python: for a run in
which springs turn or bodies are struck 370 times, the one is seven times the other. So such a
kernel is compiled once Python has spent on it about what compiling takes, in whichever
processes. Whoever decides so never spends more than twice what the better of the two would
have taken, however long the work turns out to be (the ski rental problem; Karlin, Manasse,
Rudolph and Sleator, "Competitive snoopy caching", Algorithmica 3, 1988).

`eventpound.numerics.compiled.tiered` has such kernels.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

Result = TypeVar("Result")

_PERIOD = 0.01
"""Shares of it in which what was spent is written down (s)."""
_at_once = 0
_counting = threading.Lock()


class StoppedInPythonError(Exception):
    """Python could not do what compiled code does, as a division by zero."""


@contextmanager
def compiled_at_once() -> Iterator[None]:
    """Compile kernels when they are first called, for whoever measures time or prepares it."""
    global _at_once
    with _counting:
        _at_once += 1
    try:
        yield
    finally:
        with _counting:
            _at_once -= 1


def in_python_or_compiled(run: Callable[[], Result]) -> Result:
    """What a run returns; where Python was stopped in it, it is done anew by compiled code.

    Parameters
    ----------
    run : callable
        Can be called again.
    """
    try:
        return run()
    except StoppedInPythonError:
        with compiled_at_once():
            return run()


class Account:
    """What Python has spent on a kernel.

    Parameters
    ----------
    store : KernelStore
        Keeps it for all processes.
    patience : float
        What Python may spend (s).
    """

    def __init__(self, store: Any, patience: float) -> None:
        self._store, self._patience = store, patience
        self._spent: float | None = None
        self._unwritten = 0.0

    @property
    def patient(self) -> bool:
        """Whether it is too early to compile."""
        if self._spent is None:
            self._spent = self._store.spent()
        return not _at_once and self._spent < self._patience

    def add(self, seconds: float) -> None:
        """Add to it (s)."""
        self._unwritten += seconds
        if self._unwritten >= _PERIOD:
            self._store.spend(self._unwritten)
            # Other processes have spent, too; and nothing may have been written.
            self._spent = max(self._store.spent(), (self._spent or 0.0) + self._unwritten)
            self._unwritten = 0.0
