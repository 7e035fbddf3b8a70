"""How much a command says: with ``-v`` what it is doing, and when; with ``-q`` errors only."""

from __future__ import annotations

import argparse
import os
import re
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

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
