"""What a command prints, whatever the terminal can show and whoever stops reading."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
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
