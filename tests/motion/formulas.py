"""A piece of a ground motion as compiled functions take it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.motion.base import Piece


class Compiled(NamedTuple):
    """As `eventpound.motion.forcing.Formula` says."""

    family: int
    coefficients: np.ndarray
    samples: np.ndarray


def formula_of(piece: Piece) -> Compiled:
    """The formula of a piece."""
    return Compiled(int(piece.family), piece.coefficients, piece.samples)
