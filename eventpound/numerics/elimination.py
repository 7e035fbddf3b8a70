"""Equations ``Σ_b row_b q_b = 0`` between coordinates, each solved for one of them.

So ``q = N y``, y the coordinates left. Solved for is the one with the most of ``row M⁻¹ rowᵀ``, of
pairs the lighter: then NᵀMN is as well conditioned as M, and what light coordinates carry is no
difference of what heavy ones do, whatever the ratio of the masses. By an orthogonal factorisation
it would be. Of equations between pairs N has zeros and ones alone, and nothing is rounded.
"""

from __future__ import annotations

import numpy as np

from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import scalar_kernel
from eventpound.tolerances import DEPENDENT, TIE_ROUNDING


@scalar_kernel
def pivot_of(row: Floats, mass: Floats) -> int:
    """The coordinate for which an equation is solved, that of the largest ``row² / mass``; or -1.

    One without mass comes before all others. None is taken whose mass is infinite, which moves as
    it is told to.
    """
    best = -1
    for c in range(mass.size):
        if mass[c] == np.inf or abs(row[c]) <= DEPENDENT:
            continue
        if best < 0:
            best = c
            continue
        own, other = row[c] * row[c], row[best] * row[best]
        if mass[c] > 0.0 or mass[best] > 0.0:
            own, other = own * mass[best], other * mass[c]
        best = c if own > other else best
    return best


@scalar_kernel
def solve_for(rows: Floats, e: int, column: int, coordinates: int) -> None:
    """Solve equation e for the coordinate of a column, and put that into all others.

    `rows` is overwritten; its columns behind the `coordinates` go along.
    """
    pivot = rows[e, column]
    for c in range(rows.shape[1]):
        rows[e, c] /= pivot
    for f in range(rows.shape[0]):
        factor = rows[f, column]
        if f == e or factor == 0.0:
            continue
        for c in range(rows.shape[1]):
            change = factor * rows[e, c]
            size = abs(rows[f, c]) + abs(change)
            rows[f, c] -= change
            # What has cancelled is nothing: its rounding must not become a pivot.
            if c < coordinates and abs(rows[f, c]) <= TIE_ROUNDING * size:
                rows[f, c] = 0.0
        rows[f, column] = 0.0
