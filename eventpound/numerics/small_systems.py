"""Linear systems of a few unknowns, by plain loops: for these a library costs more to call.

Sums run in the order of the entries, so that the same numbers give the same bits everywhere.
"""

from __future__ import annotations

import numpy as np

from eventpound.numerics.arrays import Bools, Floats, Ints
from eventpound.numerics.compiled import kernel, scalar_kernel


@scalar_kernel
def dot(a: Floats, b: Floats) -> float:
    """Σ a_i b_i."""
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


@kernel
def solve_transposed(lower: Floats, given: Floats, order: Ints, found: Floats) -> None:
    """Solve ``Lᵀ x = given`` (overwritten), entry a of x into the place ``order[a]``."""
    for a in range(given.size - 1, -1, -1):
        for b in range(a + 1, given.size):
            given[a] -= lower[b, a] * given[b]
        given[a] /= lower[a, a]
        found[order[a]] = given[a]


@kernel
def solve_definite(K: Floats, right: Floats) -> Floats:
    """Solve ``K X = right`` with the lower triangle of K (n, n), by ``K = L D Lᵀ``; overwritten.

    Where K is diagonal, a division.
    """
    n = K.shape[0]
    # Without square roots, so that a diagonal K only divides.
    for j in range(n):
        for k in range(j):
            K[j, j] -= K[j, k] * K[j, k] * K[k, k]
        for i in range(j + 1, n):
            for k in range(j):
                K[i, j] -= K[i, k] * K[j, k] * K[k, k]
            K[i, j] /= K[j, j]
    for c in range(right.shape[1]):
        for i in range(n):
            for k in range(i):
                right[i, c] -= K[i, k] * right[k, c]
        for i in range(n):
            right[i, c] /= K[i, i]
        for i in range(n - 1, -1, -1):
            for k in range(i + 1, n):
                right[i, c] -= K[k, i] * right[k, c]
    return right


@kernel
def invert(matrix: Floats, inverse: Floats, least: float) -> bool:
    """Invert a matrix (n, n), overwritten; False where a pivot is below the least one.

    By Gauss' and Jordan's elimination with row exchanges.
    """
    n = matrix.shape[0]
    inverse[:] = np.eye(n)
    for c in range(n):
        pivot = c
        for i in range(c + 1, n):
            if abs(matrix[i, c]) > abs(matrix[pivot, c]):
                pivot = i
        if not abs(matrix[pivot, c]) > least:
            return False
        for j in range(n):
            matrix[c, j], matrix[pivot, j] = matrix[pivot, j], matrix[c, j]
            inverse[c, j], inverse[pivot, j] = inverse[pivot, j], inverse[c, j]
        divisor = matrix[c, c]
        matrix[c], inverse[c] = matrix[c] / divisor, inverse[c] / divisor
        for i in range(n):
            factor = matrix[i, c]
            if i != c and factor != 0.0:
                matrix[i] -= factor * matrix[c]
                inverse[i] -= factor * inverse[c]
    return True


@kernel
def solve_by_inverse(matrix: Floats, inverse: Floats, right: Floats) -> Floats:
    """Solve by an inverse, and once more for what rounding has left."""
    found = np.zeros(right.size)
    for _ in range(2):
        left = right.copy()
        for a in range(right.size):
            for b in range(right.size):
                left[a] -= matrix[a, b] * found[b]
        for a in range(right.size):
            for b in range(right.size):
                found[a] += inverse[a, b] * left[b]
    return found


@scalar_kernel
def rounding_growth(inverse: Floats) -> float:
    """What equations make, at the most, of the rounding of their right-hand sides, and that."""
    most = 1.0
    for a in range(inverse.shape[0]):
        total = 1.0
        for b in range(inverse.shape[1]):
            total += abs(inverse[a, b])
        most = max(most, total)
    return most


@kernel
def independent_columns(matrix: Floats, least: float) -> Bools:
    """Columns (n,) of which more than a `least` part is no sum of those before them."""
    rest, kept = matrix.copy(), np.zeros(matrix.shape[1], np.bool_)
    for a in range(kept.size):
        # Twice is enough: the first turn leaves the rounding of what it took away.
        for _ in range(2):
            for b in range(a):
                if kept[b]:
                    rest[:, a] -= dot(rest[:, b], rest[:, a]) * rest[:, b]
        length = np.sqrt(dot(rest[:, a], rest[:, a]))
        kept[a] = length > least * np.sqrt(dot(matrix[:, a], matrix[:, a]))
        if kept[a]:
            rest[:, a] /= length
    return kept
