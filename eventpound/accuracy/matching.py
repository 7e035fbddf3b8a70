"""Which event of one sequence is which of another, whatever the shifts in time.

Of all pairings of two increasing sequences of times that keep their order and pair no two
times further apart than a window w, the one of least cost

    Σ_pairs |t_i - s_j| + (w/2) (number of unpaired times)

is found by dynamic programming (Needleman and Wunsch 1970): so a pair is made exactly
where it is cheaper than two times left alone, and one event too many does not set all
later ones against the wrong partner.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from eventpound.numerics.arrays import Floats, Ints


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
    pairs: list[tuple[int, int]] = []
    for part_r, part_f in _apart(reference, found, window):
        shifts = np.abs(reference[part_r, None] - found[part_f])
        pairs += [(part_r.start + i, part_f.start + j) for i, j in _pairs(shifts, window)]
    paired = np.array(pairs, np.int64).reshape(-1, 2)
    return Matching(
        paired,
        np.setdiff1d(np.arange(reference.size), paired[:, 0]),
        np.setdiff1d(np.arange(found.size), paired[:, 1]),
    )


def _apart(reference: Floats, found: Floats, window: float) -> list[tuple[slice, slice]]:
    """Stretches of both sequences between which nothing can be paired."""
    every = np.sort(np.concatenate((reference, found)))
    starts = every[np.flatnonzero(np.diff(every, prepend=-np.inf) > window)]
    borders = [
        np.append(np.searchsorted(times, starts), times.size) for times in (reference, found)
    ]
    return [
        (slice(borders[0][i], borders[0][i + 1]), slice(borders[1][i], borders[1][i + 1]))
        for i in range(starts.size)
    ]


def _pairs(shifts: Floats, window: float) -> list[tuple[int, int]]:
    """Pairs of least cost for the shifts of all pairs, shape (n, m)."""
    cost = _costs(shifts, window)
    i, j = shifts.shape
    pairs = []
    while i > 0 and j > 0:
        together = cost[i - 1, j - 1] + shifts[i - 1, j - 1]
        if together <= min(cost[i - 1, j], cost[i, j - 1]) + 0.5 * window:
            pairs.append((i - 1, j - 1))
            i, j = i - 1, j - 1
        elif cost[i - 1, j] <= cost[i, j - 1]:
            i -= 1
        else:
            j -= 1
    return pairs[::-1]


def _costs(shifts: Floats, window: float) -> Floats:
    """Least cost of pairing the first i with the first j times, shape (n + 1, m + 1).

    ``c_ij = min(c_(i-1)(j-1) + shift, c_(i-1)j + w/2, c_i(j-1) + w/2)``; a shift above w
    never pays. Row by row, the last alternative is a running minimum.
    """
    alone = 0.5 * window
    n, m = shifts.shape
    steps = alone * np.arange(m + 1)
    cost = np.empty((n + 1, m + 1))
    cost[0] = steps
    for i in range(1, n + 1):
        best = cost[i - 1] + alone
        best[1:] = np.minimum(best[1:], cost[i - 1, :-1] + shifts[i - 1])
        cost[i] = np.minimum.accumulate(best - steps) + steps
    return cost


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
