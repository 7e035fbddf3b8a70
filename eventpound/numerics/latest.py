"""What was made last, kept for as long as it would be made of the same again."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, TypeVar

Made = TypeVar("Made")


class Keep(Protocol):
    """Gives what `make` makes, which depends on nothing but the numbers in `of`."""

    def __call__(self, of: tuple[Any, ...], make: Callable[[], Made]) -> Made:
        """`of` begins with a word for what is made; arrays stand in it as bytes."""
        ...


def made_anew(of: tuple[Any, ...], make: Callable[[], Made]) -> Made:
    """Keep nothing."""
    return make()


class Latest:
    """Keeps the latest of each word."""

    def __init__(self) -> None:
        self._known: dict[str, tuple[tuple[Any, ...], Any]] = {}

    def __call__(self, of: tuple[Any, ...], make: Callable[[], Made]) -> Made:
        """See `Keep`; what is made is not to be written to."""
        known = self._known.get(of[0])
        if known is None or known[0] != of:
            known = self._known[of[0]] = of, make()
        found: Made = known[1]
        return found
