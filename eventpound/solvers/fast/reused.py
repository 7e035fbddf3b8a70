"""What one run of a scene leaves for the next: arrays in one block, and parts made of the same."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, Protocol, TypeVar

import numpy as np

from eventpound.numerics.arrays import Bytes

Made = TypeVar("Made")

_BOUNDARY = 8
"""Bytes at a multiple of which each array begins."""


class JoinedArrays:
    """Contiguous arrays one after the other, copied and compared all at once.

    Parameters
    ----------
    arrays : sequence of ndarray
        What is copied there.

    Attributes
    ----------
    data : ndarray of uint8
        All of them.
    """

    def __init__(self, arrays: Sequence[np.ndarray]) -> None:
        self._kinds, end = list[tuple[tuple[int, ...], np.dtype, int]](), 0
        for array in arrays:
            self._kinds.append((array.shape, array.dtype, end))
            end += -(-array.nbytes // _BOUNDARY) * _BOUNDARY
        self.data: Bytes = np.zeros(end, np.uint8)
        for own, array in zip(self.arrays, arrays, strict=True):
            own[...] = array

    @cached_property
    def arrays(self) -> list[np.ndarray]:
        """Each of them, a view of `data`."""
        return [np.ndarray(shape, kind, self.data, first) for shape, kind, first in self._kinds]

    def copy(self) -> JoinedArrays:
        """Equal arrays in a block of their own."""
        other = object.__new__(JoinedArrays)
        other._kinds, other.data = self._kinds, self.data.copy()
        return other


class Reuse(Protocol):
    """Gives what `make` makes, which depends on nothing but the numbers in `of`."""

    def __call__(self, of: tuple[Any, ...], make: Callable[[], Made]) -> Made:
        """`of` begins with a word for what is made; arrays stand in it as bytes."""
        ...


def made_anew(of: tuple[Any, ...], make: Callable[[], Made]) -> Made:
    """Keep nothing."""
    return make()


class LatestParts:
    """Keeps the latest of each word."""

    def __init__(self) -> None:
        self._known: dict[str, tuple[tuple[Any, ...], Any]] = {}

    def __call__(self, of: tuple[Any, ...], make: Callable[[], Made]) -> Made:
        """See `Reuse`; what is made is not to be written to."""
        known = self._known.get(of[0])
        if known is None or known[0] != of:
            known = self._known[of[0]] = of, make()
        found: Made = known[1]
        return found
