"""Linear complementarity problems with a symmetric positive semidefinite matrix.

Find ``x`` with ``0 <= w ⊥ x >= 0`` and ``w = G x + q``. With ``G`` a Delassus
matrix ``Wᵀ M⁻¹ W`` this is the problem of impact and of resting contact; it is
the optimality condition of ``min ½ xᵀ G x + qᵀ x`` over ``x >= 0``, so ``w``
is unique, and ``x`` is where ``G`` is definite.

Two methods: `solve_dense` for any such matrix, singular ones included
(principal pivoting: R. W. Cottle, J.-S. Pang, R. E. Stone, The Linear
Complementarity Problem, 1992, section 4.2), and `solve_chain` for the
tridiagonal matrices of a row of bodies, whose off-diagonal entries are not
positive (R. Chandrasekaran, Opsearch 7, 1970).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from eventpound.numerics.arrays import Floats

EPS = float(np.finfo(np.float64).eps)
SINGULAR = 1e-12
"""A Schur complement below this fraction of its diagonal entry counts as zero."""
ROUNDING = 512.0 * EPS
"""Entries of w below this fraction of the terms they are summed from count as zero."""


@njit(cache=True)
def _solve_passive(G: Floats, rhs: Floats, passive: np.ndarray, count: int) -> Floats:
    """Solve ``G_PP x_P = rhs_P`` by Cholesky with one step of refinement; zero elsewhere."""
    size = rhs.size
    lower = np.zeros((count, count))
    index = np.empty(count, np.int64)
    k = 0
    for i in range(size):
        if passive[i]:
            index[k] = i
            k += 1
    for a in range(count):
        for b in range(a + 1):
            total = G[index[a], index[b]]
            for c in range(b):
                total -= lower[a, c] * lower[b, c]
            lower[a, b] = np.sqrt(total) if a == b else total / lower[b, b]
    x = np.zeros(size)
    residual = rhs.copy()
    for _ in range(2):
        step = np.empty(count)
        for a in range(count):
            total = residual[index[a]]
            for c in range(a):
                total -= lower[a, c] * step[c]
            step[a] = total / lower[a, a]
        for a in range(count - 1, -1, -1):
            total = step[a]
            for c in range(a + 1, count):
                total -= lower[c, a] * step[c]
            step[a] = total / lower[a, a]
        for a in range(count):
            x[index[a]] += step[a]
        for a in range(count):
            total = rhs[index[a]]
            for c in range(count):
                total -= G[index[a], index[c]] * x[index[c]]
            residual[index[a]] = total
    return x


@njit(cache=True)
def _most_violated(w: Floats, passive: np.ndarray, level: float) -> int:
    """Index outside the passive set whose w lies furthest below -level, or -1."""
    worst = -1
    lowest = -level
    for i in range(w.size):
        if not passive[i] and w[i] < lowest:
            lowest = w[i]
            worst = i
    return worst


@njit(cache=True)
def _residual(G: Floats, x: Floats, q: Floats, w: Floats) -> float:
    """W = G x + q; returns the rounding level of its entries."""
    largest = 0.0
    for i in range(q.size):
        w[i] = q[i]
        scale = abs(q[i])
        for j in range(q.size):
            w[i] += G[i, j] * x[j]
            scale += abs(G[i, j] * x[j])
        largest = max(largest, scale)
    return ROUNDING * largest


@njit(cache=True)
def _enter(G: Floats, x: Floats, w_j: float, j: int, passive: np.ndarray) -> bool:
    """Raise x_j until w_j vanishes, letting passive entries leave at zero.

    Keeps ``w_P = 0`` on the way. Returns False where nothing stops x_j and
    w_j stays negative: the problem then has no solution.
    """
    count = 0
    for i in range(passive.size):
        count += passive[i]
    while True:
        direction = _solve_passive(G, -G[:, j], passive, count)
        schur = G[j, j]
        for i in range(passive.size):
            if passive[i]:
                schur += G[j, i] * direction[i]
        full = np.inf if schur <= SINGULAR * G[j, j] else -w_j / schur
        step = full
        blocking = -1
        for i in range(passive.size):
            if passive[i] and direction[i] < 0.0 and -x[i] / direction[i] < step:
                step = -x[i] / direction[i]
                blocking = i
        if step == np.inf:
            return False
        for i in range(passive.size):
            if passive[i]:
                x[i] += step * direction[i]
        x[j] += step
        if blocking < 0:
            passive[j] = True
            return True
        w_j += step * schur
        x[blocking] = 0.0
        passive[blocking] = False
        count -= 1


@njit(cache=True)
def _pivot_to_solution(G: Floats, q: Floats, x: Floats, w: Floats) -> bool:
    """Principal pivoting on a matrix with unit diagonal; False where it did not end."""
    size = q.size
    passive = np.zeros(size, np.bool_)
    for _ in range(50 * size + 50):
        level = _residual(G, x, q, w)
        j = _most_violated(w, passive, level)
        if j < 0:
            for i in range(size):
                w[i] = 0.0 if passive[i] else max(w[i], 0.0)
            return True
        if not _enter(G, x, w[j], j, passive):
            return False
        fresh = _solve_passive(G, -q, passive, passive.sum())
        if np.all(fresh >= 0.0):
            x[:] = fresh
    return False


@njit(cache=True)
def solve_dense(G: Floats, q: Floats) -> tuple[Floats, Floats, bool]:
    """Solve ``0 <= G x + q ⊥ x >= 0`` for a symmetric positive semidefinite G.

    Parameters
    ----------
    G : ndarray, shape (k, k)
        Symmetric positive semidefinite, positive diagonal.
    q : ndarray, shape (k,)
        Right-hand side.

    Returns
    -------
    x, w : ndarray, shape (k,)
        The solution; at most one of ``x_i`` and ``w_i`` differs from zero.
    solved : bool
        False where the problem has no solution or pivoting did not end.
    """
    size = q.size
    root = np.sqrt(np.diag(G))
    scaled = np.empty((size, size))
    for i in range(size):
        for j in range(size):
            scaled[i, j] = G[i, j] / (root[i] * root[j])
    x = np.zeros(size)
    w = np.empty(size)
    solved = _pivot_to_solution(scaled, q / root, x, w)
    return x / root, w * root, solved


@njit(cache=True)
def _solve_tridiagonal(
    diagonal: Floats, off: Floats, rhs: Floats, passive: np.ndarray, x: Floats
) -> None:
    """Solve ``G_PP x_P = rhs_P`` run by run of neighbouring passive entries; zero elsewhere.

    Where a run is singular (a row between two barriers) the unknown whose
    pivot vanishes is free and taken as zero.
    """
    size = rhs.size
    pivot = np.empty(size)
    for i in range(size):
        x[i] = 0.0
        if not passive[i]:
            continue
        pivot[i] = diagonal[i]
        x[i] = rhs[i]
        if i > 0 and passive[i - 1]:
            factor = off[i - 1] / pivot[i - 1]
            pivot[i] -= factor * off[i - 1]
            x[i] -= factor * x[i - 1]
        if pivot[i] <= SINGULAR * diagonal[i]:
            pivot[i] = np.inf
    for i in range(size - 1, -1, -1):
        if passive[i]:
            if i + 1 < size and passive[i + 1]:
                x[i] -= off[i] * x[i + 1]
            x[i] /= pivot[i]


@njit(cache=True)
def solve_chain(diagonal: Floats, off: Floats, q: Floats) -> tuple[Floats, Floats]:
    """Solve ``0 <= G x + q ⊥ x >= 0`` for a semidefinite tridiagonal G, ``off <= 0``.

    Such a matrix is a Stieltjes matrix: an entry that has become positive
    never has to return to zero, so whole sets enter at once and each pass
    costs O(k).

    Parameters
    ----------
    diagonal : ndarray, shape (k,)
        Positive.
    off : ndarray, shape (k - 1,)
        Not positive.
    q : ndarray, shape (k,)
        Right-hand side.

    Returns
    -------
    x, w : ndarray, shape (k,)
        The solution.
    """
    size = q.size
    x = np.zeros(size)
    w = q.copy()
    passive = np.zeros(size, np.bool_)
    grown = True
    while grown:
        grown = False
        for i in range(size):
            scale = abs(q[i])
            w[i] = q[i] + diagonal[i] * x[i]
            if i > 0:
                w[i] += off[i - 1] * x[i - 1]
                scale += abs(off[i - 1] * x[i - 1])
            if i + 1 < size:
                w[i] += off[i] * x[i + 1]
                scale += abs(off[i] * x[i + 1])
            if not passive[i] and w[i] < -32.0 * EPS * scale:
                passive[i] = True
                grown = True
        if grown:
            _solve_tridiagonal(diagonal, off, -q, passive, x)
    for i in range(size):
        if passive[i]:
            w[i] = 0.0
            x[i] = max(x[i], 0.0)
        else:
            w[i] = max(w[i], 0.0)
    return x, w
