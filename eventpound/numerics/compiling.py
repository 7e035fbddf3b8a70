"""What is being compiled, how far it is, and the time it takes."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import CodeType
from typing import Any

from eventpound.basics.interruption import Deferred


@dataclass(frozen=True)
class Compiling:
    """How far the compilation of a kernel is.

    Attributes
    ----------
    name : str
        The kernel: the function that Python calls.
    done, total : int
        Functions of it that the compiler has read, and how many there are. Then all of them
        are optimised together, which takes about as long again.
    seconds : float
        Wall time so far (s).
    """

    name: str
    done: int
    total: int
    seconds: float


Watcher = Callable[[Compiling | None], None]
"""Told of a compilation as it goes on; None where it has ended."""


class _Mine(threading.local):
    """Of each thread: what it compiles, and the time it has spent on it."""

    def __init__(self) -> None:
        self.depth = 0
        self.seconds = 0.0
        self.function: Any = None
        self.began = 0.0
        self.read: set[CodeType] = set()
        self.total = 0
        self.signals = Deferred(patient=True)


_mine = _Mine()
_watchers: list[Watcher] = []


@contextmanager
def watched(watcher: Watcher) -> Iterator[None]:
    """Tell `watcher` of every compilation meanwhile."""
    _watchers.append(watcher)
    try:
        yield
    finally:
        _watchers.remove(watcher)


@contextmanager
def getting_ready(function: Callable[..., Any]) -> Iterator[None]:
    """While a kernel is loaded or compiled, which counts as compilation.

    A signal that came at any instruction would leave a compiler that is half in C between two
    states, and kernels made thereafter wrong. It is answered where a function has been read.
    """
    outermost = _mine.depth == 0
    _mine.depth += 1
    if outermost:
        _mine.function, _mine.began = function, time.perf_counter()
        _mine.read, _mine.total = set(), 0
    try:
        if outermost:
            with _mine.signals:
                yield
        else:
            yield
    finally:
        _mine.depth -= 1
        if outermost:
            _mine.seconds += time.perf_counter() - _mine.began
            if _mine.total > 0:
                for watcher in tuple(_watchers):
                    watcher(None)


def compilation_begins() -> None:
    """Say that the kernel that is made ready was not kept."""
    if _watchers:
        _mine.total = _functions_below(_mine.function)
        _tell()


def compilation_waits() -> None:
    """Say that the kernel is made by another process, on which this one waits."""
    _mine.signals.answer()
    if _mine.total > 0:
        _tell()


def function_read(function: Callable[..., Any]) -> None:
    """Say that a function of the kernel has been read."""
    _mine.signals.answer()
    if _mine.total > 0 and function.__code__ not in _mine.read:
        _mine.read.add(function.__code__)
        _tell()


def _tell() -> None:
    seconds = time.perf_counter() - _mine.began
    done = min(len(_mine.read), _mine.total)
    state = Compiling(_mine.function.__qualname__, done, _mine.total, seconds)
    for watcher in tuple(_watchers):
        watcher(state)


def _functions_below(function: Callable[..., Any]) -> int:
    """How many compiled functions a function calls, directly or not, itself among them."""
    visited: set[CodeType] = set()
    waiting: list[Any] = [function]
    while waiting:
        each = waiting.pop()
        code = each.__code__
        if code in visited:
            continue
        visited.add(code)
        for name in code.co_names:
            called = each.__globals__.get(name)
            if hasattr(called, "py_func"):
                waiting.append(called.py_func)
    return len(visited)


@dataclass
class Stopwatch:
    """Wall time from now on, without that in which this thread compiles."""

    _began: float = field(default_factory=time.perf_counter)
    _compiled: float = field(default_factory=lambda: _mine.seconds)

    @property
    def compilation(self) -> float:
        """What it took to load and compile kernels (s)."""
        return _mine.seconds - self._compiled

    @property
    def seconds(self) -> float:
        """What everything else took (s)."""
        return time.perf_counter() - self._began - self.compilation
