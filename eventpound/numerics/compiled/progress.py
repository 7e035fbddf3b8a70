"""What is being compiled, how far it is, and the time it took."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def compiling(function: Callable[..., Any]) -> Iterator[None]:
    """While an entry is made ready."""
    yield


def part_done(function: Callable[..., Any]) -> None:
    """Say that a part has been lowered."""
