"""Names for the array types used everywhere, and room in one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Bytes = NDArray[np.uint8]
Records = NDArray[np.void]


GROWTH = 4
"""Times the room there was, where it is too little."""


def longer(rows: Floats, wanted: int) -> Floats:
    """The rows with room behind them, for as many as are wanted at the least."""
    result = np.empty((max(GROWTH * rows.shape[0], wanted), rows.shape[1]))
    result[: rows.shape[0]] = rows
    return result
