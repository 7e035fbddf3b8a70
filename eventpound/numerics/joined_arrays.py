"""Arrays in one stretch of memory, copied and compared all at once."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from eventpound.numerics.arrays import Bytes

_BOUNDARY = 8
"""Bytes at a multiple of which each array begins."""


class JoinedArrays:
    """Contiguous arrays one after the other.

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
