"""Linear complementarity problems with any matrix, by Lemke's method.

Find ``z`` with ``0 <= w ⊥ z >= 0`` and ``w = M z + q``: one more unknown, which all entries of w
have in common, makes a start that is feasible; from there one pivot follows the other until it
vanishes (C. E. Lemke, Management Science 11, 1965, 681-689; R. W. Cottle, J.-S. Pang, R. E. Stone,
The Linear Complementarity Problem, 1992, section 4.4). Ties are broken lexicographically, so that
no basis comes twice.
"""

from __future__ import annotations

import numpy as np

from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.tolerances import LEMKE_PIVOT, LEMKE_TIE


@scalar_kernel
def _leaving(tableau: Floats, basis: Ints, entering: int) -> int:
    """Row of the unknown that comes to zero first as one enters, -1 where none does."""
    n, best = basis.size, -1
    last = tableau.shape[1] - 1
    for i in range(n):
        pivot = tableau[i, entering]
        if pivot <= LEMKE_PIVOT:
            continue
        if best < 0:
            best = i
            continue
        # The ratio of the right-hand sides, then those of the inverse of the basis.
        for c in range(-1, n):
            column = last if c < 0 else c
            own, other = tableau[i, column], tableau[best, column]
            difference = own / pivot - other / tableau[best, entering]
            # The common unknown leaves as soon as it may.
            if c < 0 and abs(difference) <= LEMKE_TIE and 2 * n in (basis[i], basis[best]):
                best = i if basis[i] == 2 * n else best
                break
            if abs(difference) > LEMKE_TIE:
                best = i if difference < 0.0 else best
                break
    return best


@scalar_kernel
def _pivot(tableau: Floats, row: int, column: int) -> None:
    """Bring a column into the basis at a row."""
    rows, columns = tableau.shape
    divisor = tableau[row, column]
    for c in range(columns):
        tableau[row, c] /= divisor
    tableau[row, column] = 1.0
    for i in range(rows):
        factor = tableau[i, column]
        if i == row or factor == 0.0:
            continue
        for c in range(columns):
            tableau[i, c] -= factor * tableau[row, c]
        tableau[i, column] = 0.0


@kernel
def solve_lemke(M: Floats, q: Floats) -> tuple[Floats, bool]:
    """Solve ``0 <= M z + q ⊥ z >= 0``.

    Parameters
    ----------
    M : ndarray, shape (n, n)
        Any matrix, of entries near 1.
    q : ndarray, shape (n,)
        Right-hand side, of entries near 1.

    Returns
    -------
    z : ndarray, shape (n,)
        The answer.
    solved : bool
        False where the method ends without one; there may be one all the same.
    """
    n = q.size
    z = np.zeros(n)
    if np.min(q) >= 0.0:
        return z, True
    # Columns: w, z, the common unknown, the right-hand side.
    tableau = np.zeros((n, 2 * n + 2))
    basis = np.arange(n)
    for i in range(n):
        tableau[i, i], tableau[i, 2 * n], tableau[i, 2 * n + 1] = 1.0, -1.0, q[i]
        for j in range(n):
            tableau[i, n + j] = -M[i, j]
    row, entering = int(np.argmin(q)), 2 * n
    for _ in range(50 * n + 50):
        left = basis[row]
        _pivot(tableau, row, entering)
        basis[row] = entering
        if left == 2 * n:
            for i in range(n):
                if n <= basis[i] < 2 * n:
                    z[basis[i] - n] = max(0.0, tableau[i, 2 * n + 1])
            return z, True
        # The complement of what has left.
        entering = left - n if left >= n else left + n
        row = _leaving(tableau, basis, entering)
        if row < 0:
            return z, False
    return z, False
