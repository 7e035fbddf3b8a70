"""Different combinations of values among many."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from eventpound.numerics.arrays import Floats, Ints


def distinct(columns: Sequence[Floats], count: int) -> tuple[Ints, Ints]:
    """First variant of each different combination of values, and which one each variant has.

    Parameters
    ----------
    columns : sequence of ndarray, shape (count,)
        Values; without any, all variants are the same.
    count : int
        Number of variants.

    Returns
    -------
    ndarray of int, shape (m,)
        First variant of each combination.
    ndarray of int, shape (count,)
        Combination of each variant.
    """
    if not columns:
        return np.zeros(1, np.int64), np.zeros(count, np.int64)
    _, first, which = np.unique(
        np.column_stack(columns), axis=0, return_index=True, return_inverse=True
    )
    return first, which.reshape(-1)
