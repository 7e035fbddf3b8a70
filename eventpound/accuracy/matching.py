"""Which event of one sequence is which of another, whatever the shifts in time.

Of all pairings of two increasing sequences of times that keep their order and pair no two
times further apart than a window w, the one of least cost

    Σ_pairs |t_i - s_j| + (w/2) (number of unpaired times)

(`eventpound.score.pair_times`): so a pair is made exactly where it is cheaper than two times
left alone, and one event too many does not set all later ones against the wrong partner.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from eventpound.numerics.arrays import Floats, Ints
from eventpound.score import pair_times


@dataclass(frozen=True, slots=True)
class Matching:
    """A pairing of two sequences.

    Parameters
    ----------
    pairs : ndarray of int, shape (k, 2)
        Positions in the first and the second sequence.
    missed, extra : ndarray of int
        Positions in the first and in the second sequence that have no partner.
    """

    pairs: Ints
    missed: Ints
    extra: Ints


def match(reference: Floats, found: Floats, window: float) -> Matching:
    """Pair the times of two sequences.

    Parameters
    ----------
    reference, found : ndarray, shape (n,), (m,)
        Times (s), not decreasing.
    window : float
        w, largest shift of a pair (s), positive.
    """
    pairs = pair_times(reference, found, window)
    paired = np.array(pairs, np.int64).reshape(-1, 2)
    return Matching(
        paired,
        np.setdiff1d(np.arange(reference.size), paired[:, 0]),
        np.setdiff1d(np.arange(found.size), paired[:, 1]),
    )


class Pair(Protocol):
    """What happens in the reference, in the run, or in both; None where there is none."""

    @property
    def reference(self) -> object | None:
        """In the reference."""

    @property
    def found(self) -> object | None:
        """In the run."""

    @property
    def shift(self) -> float:
        """How much later the run has it (s); NaN without a partner."""


def count_matched(pairs: Sequence[Pair]) -> int:
    """Number of those that both have."""
    return sum(p.reference is not None and p.found is not None for p in pairs)


def count_missed(pairs: Sequence[Pair]) -> int:
    """Number of those of the reference that the run lacks."""
    return sum(p.found is None for p in pairs)


def count_extra(pairs: Sequence[Pair]) -> int:
    """Number of those of the run that the reference lacks."""
    return sum(p.reference is None for p in pairs)


def largest_shift(pairs: Sequence[Pair]) -> float:
    """Largest error of the time of a matched one (s); NaN without one."""
    shifts = (abs(p.shift) for p in pairs)
    return max((shift for shift in shifts if not math.isnan(shift)), default=math.nan)
