"""Kernels that another process compiles meanwhile, where there is a second core.

Most of what compiling takes is Python, of which one process runs one thread at a time. So a
process beside this one compiles what every run comes to: deferred parts
(`eventpound.numerics.compiled.deferred`) from the moment at which their callers are read, and what
is foreseen. Both keep what they make. Whoever wants a kernel that another process is making waits
for it, and meanwhile compiles what that process has not come to.
"""

from __future__ import annotations

import atexit
import contextlib
import importlib
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any, NamedTuple

from eventpound.basics.cores import cores

try:
    import fcntl
except ImportError:  # Windows, where every process compiles for itself.
    fcntl = None  # type: ignore[assignment]

_PROGRAM = "from eventpound.numerics.compiled.beside import serve; serve()"
_OFTEN = 0.05
"""How often who waits looks whether a kernel is made (s)."""
_IDLE = 60.0
"""After which a process ends that is asked for nothing; to start may take long, too (s)."""


class Wanted(NamedTuple):
    """A kernel: its module and name, and Numba's types of its arguments."""

    module: str
    name: str
    arguments: tuple[Any, ...]

    def make(self) -> None:
        """Compile it, or load it where it is kept."""
        getattr(importlib.import_module(self.module), self.name).compile(self.arguments)


_asked: list[Wanted] = []
"""Of the process beside this one, or in that one of itself, the first first."""
_process: subprocess.Popen[bytes] | None = None


def compile_beside(wanted: Wanted) -> None:
    """Have a kernel compiled by a process beside this one, after what it was asked for before.

    Nothing is done where there is one core, or in a process of several that work together.
    """
    global _process
    if fcntl is None or cores() < 2 or multiprocessing.parent_process() is not None:
        return
    # Where that fails, the kernel is compiled here when a run comes to it.
    with contextlib.suppress(OSError):
        if _process is None or _process.poll() is not None:
            _process = _started()
        pipe: Any = _process.stdin
        pickle.dump(wanted, pipe)
        pipe.flush()
        _asked.append(wanted)


def compile_meanwhile(awaited: Wanted) -> None:
    """While another process makes a kernel, compile what the one beside has been asked for."""
    with contextlib.suppress(ValueError):
        _asked.remove(awaited)
    if _asked:
        _asked.pop(0).make()


def _started() -> subprocess.Popen[bytes]:
    silent = subprocess.DEVNULL
    command = [sys.executable, "-c", _PROGRAM]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=silent, stderr=silent)
    atexit.register(process.kill)
    return process


def serve() -> None:
    """Compile what is asked for on standard input, until whoever asks has ended."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    come = threading.Event()
    threading.Thread(target=_listen, args=(sys.stdin.buffer, come), daemon=True).start()
    while come.wait(_IDLE):
        come.clear()
        while _asked:
            _asked.pop(0).make()


def _listen(source: IO[bytes], come: threading.Event) -> None:
    try:
        while True:
            _asked.append(pickle.load(source))
            come.set()
    finally:
        # Nobody waits for what is half done, and files appear whole or not at all.
        os._exit(0)


class Claim:
    """That this process makes a kernel, which others wait for.

    Parameters
    ----------
    path : Path
        Where the kernel is to be kept.
    waits : callable
        Called while another process makes it; what it raises ends the waiting.
    """

    def __init__(self, path: Path, waits: Callable[[], None]) -> None:
        self._path = path.with_suffix(".making")
        self._opened: int | None = None
        if fcntl is None:
            return
        # In a folder that cannot be written, or on a disk without locks, nobody waits.
        with contextlib.suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            self._opened = os.open(self._path, os.O_RDWR | os.O_CREAT, 0o644)
            self._take(self._opened, waits)

    @staticmethod
    def _take(opened: int, waits: Callable[[], None]) -> None:
        while True:
            try:
                fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
                return
            except BlockingIOError:
                try:
                    waits()
                except BaseException:
                    os.close(opened)
                    raise
                time.sleep(_OFTEN)

    def release(self) -> None:
        """Let others make, or find, the kernel; also after a failure."""
        if self._opened is not None:
            with contextlib.suppress(OSError):
                self._path.unlink()
                # Of processes that were forked meanwhile, too.
                fcntl.flock(self._opened, fcntl.LOCK_UN)
            os.close(self._opened)
            self._opened = None
