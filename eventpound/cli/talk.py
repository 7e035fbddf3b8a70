"""What a command says, whatever the terminal can show and whoever stops reading."""

from __future__ import annotations

import argparse
import os
import re
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, Self, TextIO


class Output:
    """A block in which printing neither fails nor stops the work.

    A letter that the terminal's encoding does not have is shown by its number. Where
    nobody reads any more (``eventpound run CASE | head -1``) the rest of the text is dropped
    and the work goes on: results and figures are written all the same. So they are where the
    text goes to a file on a full disk, which `trouble` then says.
    """

    trouble = ""
    """Why some of what went to stdout is lost, though somebody wanted it."""

    def __enter__(self) -> Self:
        self._before = sys.stdout, sys.stderr
        for stream in self._before:
            # What takes the place of a terminal in a test or a notebook takes any letter.
            if hasattr(stream, "reconfigure"):
                stream.reconfigure(errors="backslashreplace")
        self._out, self._err = (_Patient(stream) for stream in self._before)
        sys.stdout, sys.stderr = self._out, self._err
        return self

    def quieten(self) -> None:
        """Drop what goes to stdout from now on; stderr is no terminal that progress is shown on."""
        self._out.silent = self._err.plain = True

    def __exit__(self, *_: object) -> None:
        with suppress(ValueError):
            self._out.flush()
            self._err.flush()
        sys.stdout, sys.stderr = self._before
        self.trouble = self._out.trouble


class _Patient:
    """A stream whose text goes nowhere once its reader has gone."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self.trouble = ""
        self.silent = self.plain = False

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def isatty(self) -> bool:
        return not self.plain and self._stream.isatty()

    def write(self, text: str) -> int:
        if self.silent:
            return len(text)
        try:
            return self._stream.write(text)
        except OSError as error:
            self._let_go(error)
            return len(text)

    def flush(self) -> None:
        try:
            self._stream.flush()
        except OSError as error:
            self._let_go(error)

    def _let_go(self, error: OSError) -> None:
        """Lead the stream, and what waits in it, to nowhere."""
        if not isinstance(error, BrokenPipeError):
            self.trouble = error.strerror or str(error)
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self._stream.fileno())
        os.close(nowhere)


_PAGE = re.compile(r'the page "([\w-]+)"\s+of the documentation')


class _Talk:
    """Of this process: whether steps are told, and since when."""

    quiet = verbose = False
    began = time.monotonic()


def add_loudness(parser: argparse.ArgumentParser, default: object = argparse.SUPPRESS) -> None:
    """Add ``-q`` and ``-v`` to a parser; a command's leave alone what was said before it."""
    group = parser.add_argument_group("how much is said")
    told = {"quiet": "errors and warnings only", "verbose": "also each step, and when"}
    for word, text in told.items():
        names = f"-{word[0]}", f"--{word}"
        group.add_argument(*names, action="store_true", default=default, help=text)


def set_loudness(quiet: bool, verbose: bool) -> None:
    """Tell the steps of a command from now on, or not; quiet comes first."""
    _Talk.quiet, _Talk.verbose = quiet, verbose and not quiet
    _Talk.began = time.monotonic()


def is_quiet() -> bool:
    """Whether only errors and warnings are wanted."""
    return _Talk.quiet


def tell_step(text: str) -> None:
    """Say on stderr what begins or has ended, with the time since the command began."""
    if _Talk.verbose:
        print(f"{time.monotonic() - _Talk.began:8.2f} s  {text}", file=sys.stderr, flush=True)


def complain(text: str) -> None:
    """Say on stderr what somebody is to know whose stdout goes elsewhere."""
    print(f"eventpound: {text}", file=sys.stderr, flush=True)


@contextmanager
def going_on(kept: Callable[[], str] | None = None) -> Iterator[None]:
    """Say of runs that are stopped that they go on, and what is kept of them."""
    try:
        yield
    except KeyboardInterrupt:
        print(file=sys.stderr)
        goes_on = "the same command goes on"
        complain(f"{goes_on} with the rest" if kept is None else f"{kept()}; {goes_on}")
        raise


def located(text: str) -> str:
    """A text with the addresses of the pages it names; EVENTPOUND_DOCS says that of the site."""
    site = os.environ.get("EVENTPOUND_DOCS", "").rstrip("/")
    return _PAGE.sub(rf"{site}/\1.html", text) if site else text
