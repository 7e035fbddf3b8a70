"""Symmetric positive definite systems with a narrow band, ``A = L D Lᵀ`` without pivoting.

A row of bodies couples neighbours only, so a system of n unknowns costs
O(n b²) with b sub-diagonals (G. H. Golub, C. F. Van Loan, Matrix Computations,
section 4.3). SciPy's banded solver cannot be called from compiled code.
"""

from __future__ import annotations

from eventpound.numerics.arrays import Floats
from eventpound.numerics.compiled import scalar_kernel


@scalar_kernel
def factor_banded(band: Floats) -> bool:
    """Overwrite the lower band of A with its factors.

    Parameters
    ----------
    band : ndarray, shape (n, b + 1)
        ``band[i, d] = A[i, i - d]``; left of the first column unused. On
        return ``band[i, 0] = D_i`` and ``band[i, d] = L[i, i - d]``.

    Returns
    -------
    bool
        False where A is not positive definite; the band is then spoilt.
    """
    width = band.shape[1] - 1
    for i in range(band.shape[0]):
        for d in range(min(width, i), 0, -1):
            j = i - d
            total = band[i, d]
            for e in range(d + 1, min(width, i) + 1):
                k = i - e
                # L_jk is zero beyond the band.
                if j - k <= width:
                    total -= band[i, e] * band[k, 0] * band[j, j - k]
            band[i, d] = total / band[j, 0]
        for d in range(1, min(width, i) + 1):
            band[i, 0] -= band[i, d] * band[i, d] * band[i - d, 0]
        # So asked, a pivot that is no number fails, too.
        if not band[i, 0] > 0.0:
            return False
    return True


@scalar_kernel
def solve_banded(band: Floats, x: Floats) -> None:
    """Overwrite a right-hand side with the solution, from `factor_banded`.

    Parameters
    ----------
    band : ndarray, shape (n, b + 1)
        The factors.
    x : ndarray, shape (n,)
        Right-hand side, then solution.
    """
    n, width = band.shape[0], band.shape[1] - 1
    for i in range(n):
        for d in range(1, min(width, i) + 1):
            x[i] -= band[i, d] * x[i - d]
    for i in range(n):
        x[i] /= band[i, 0]
    for i in range(n - 1, -1, -1):
        for d in range(1, min(width, n - 1 - i) + 1):
            x[i] -= band[i + d, d] * x[i + d]
