"""How much a command says: with ``-v`` what it is doing, and when; with ``-q`` errors only."""

from __future__ import annotations

import argparse
import sys
import time


class _Talk:
    """Of this process: whether steps are told, and since when."""

    verbose = False
    began = time.monotonic()


def add_loudness(parser: argparse.ArgumentParser, default: object = argparse.SUPPRESS) -> None:
    """Add ``-q`` and ``-v`` to a parser; a command's leave alone what was said before it."""
    group = parser.add_argument_group("how much is said")
    group.add_argument(
        "-q", "--quiet", action="store_true", default=default, help="errors and warnings only"
    )
    group.add_argument(
        "-v", "--verbose", action="store_true", default=default, help="also each step, and when"
    )


def set_loudness(verbose: bool) -> None:
    """Tell the steps of a command from now on, or not."""
    _Talk.verbose, _Talk.began = verbose, time.monotonic()


def say(text: str) -> None:
    """Say on stderr what begins or has ended, with the time since the command began."""
    if _Talk.verbose:
        print(f"{time.monotonic() - _Talk.began:8.2f} s  {text}", file=sys.stderr, flush=True)
