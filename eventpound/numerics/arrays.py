"""Names for the array types used everywhere, and room in one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Bytes = NDArray[np.uint8]
Records = NDArray[np.void]


def longer(rows: Floats, times: int) -> Floats:
    """The rows with room behind them, `times` as many in all."""
    result = np.empty((times * rows.shape[0], rows.shape[1]))
    result[: rows.shape[0]] = rows
    return result
