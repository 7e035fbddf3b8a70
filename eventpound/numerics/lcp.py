"""Linear complementarity problems with a symmetric positive semidefinite matrix.

Find ``x`` with ``0 <= w ⊥ x >= 0`` and ``w = G x + q``. With ``G`` a Delassus
matrix ``Wᵀ M⁻¹ W`` this is the problem of impact and of resting contact; it is
the optimality condition of ``min ½ xᵀ G x + qᵀ x`` over ``x >= 0``, so ``w``
is unique, and ``x`` is where ``G`` is definite.

Two methods: `solve_dense` for any such matrix, singular ones included
(principal pivoting: R. W. Cottle, J.-S. Pang, R. E. Stone, The Linear
Complementarity Problem, 1992, section 4.2), and `solve_chain` for a row of
bodies, whose tridiagonal matrix has no positive off-diagonal entries
(R. Chandrasekaran, Opsearch 7, 1970).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eventpound.numerics.arrays import Floats, Ints
from eventpound.numerics.borrowing import copy_numbers
from eventpound.numerics.compiled import kernel, scalar_kernel
from eventpound.tolerances import EPS, LCP_ROUNDING, SINGULAR


class _Work(NamedTuple):
    """Scratch of a problem of k unknowns: lower (k, k); rows (6, k), named below; places (k,)."""

    lower: Floats
    rows: Floats
    places: Ints


(_STEP, _RESIDUAL, _RIGHT, _FOUND, _TERMS, _NOISE) = range(6)
"""Rows of `_Work`: steps and residuals of a solution, its right-hand side, the solution, the sizes
of the terms of w, and their rounding along cycles."""


@scalar_kernel
def _solve_passive(G: Floats, passive: np.ndarray, count: int, work: _Work) -> None:
    """Solve ``G_PP x_P = rhs_P`` by Cholesky with one step of refinement; zero elsewhere.

    The right-hand side and the solution are rows of `work`.
    """
    lower, index = work.lower, work.places
    rhs, step, residual = work.rows[_RIGHT], work.rows[_STEP], work.rows[_RESIDUAL]
    x, k = work.rows[_FOUND], 0
    for i in range(rhs.size):
        x[i], residual[i] = 0.0, rhs[i]
        if passive[i]:
            index[k] = i
            k += 1
    for a in range(count):
        for b in range(a + 1):
            total = G[index[a], index[b]]
            for c in range(b):
                total -= lower[a, c] * lower[b, c]
            lower[a, b] = np.sqrt(total) if a == b else total / lower[b, b]
    # The second turn solves for what rounding has left of the right-hand side.
    for _ in range(2):
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


@scalar_kernel
def _most_violated(w: Floats, passive: np.ndarray, level: float, noise: Floats) -> int:
    """Index outside the passive set whose w lies furthest below `level` and its noise, or -1."""
    worst = -1
    lowest = 0.0
    for i in range(w.size):
        # What a cycle could not bring to zero is its rounding, and must not enter again.
        if not passive[i] and w[i] < -max(level, noise[i]) and w[i] < lowest:
            lowest = w[i]
            worst = i
    return worst


@scalar_kernel
def _residual(G: Floats, x: Floats, q: Floats, w: Floats, terms: Floats) -> float:
    """W = G x + q and the sizes of the terms of each entry; returns their rounding level."""
    largest = 0.0
    for i in range(q.size):
        w[i] = q[i]
        terms[i] = abs(q[i])
        for j in range(q.size):
            w[i] += G[i, j] * x[j]
            terms[i] += abs(G[i, j] * x[j])
        largest = max(largest, terms[i])
    return LCP_ROUNDING * largest


@scalar_kernel
def _enter(
    G: Floats, x: Floats, w_j: float, j: int, passive: np.ndarray, work: _Work
) -> tuple[float, float]:
    """Raise x_j until w_j vanishes, letting passive entries leave at zero.

    Keeps ``w_P = 0`` on the way. Returns what is left of w_j, and its
    rounding: where nothing stops x_j along a direction d with ``G d = 0``,
    ``w_j = d·q`` stays as it is.
    """
    count, terms, direction = _count(passive), work.rows[_TERMS], work.rows[_FOUND]
    while True:
        for i in range(x.size):
            work.rows[_RIGHT, i] = -G[i, j]
        _solve_passive(G, passive, count, work)
        schur = G[j, j]
        for i in range(passive.size):
            if passive[i]:
                schur += G[j, i] * direction[i]
        # Along a cycle of contacts G is singular: w_j stays as it is, however far x_j goes.
        full = np.inf if schur <= SINGULAR * G[j, j] else -w_j / schur
        step = full
        blocking = -1
        for i in range(passive.size):
            if passive[i] and direction[i] < 0.0 and -x[i] / direction[i] < step:
                step = -x[i] / direction[i]
                blocking = i
        # Then w_j is d·q and should vanish; it is no better than the terms along d.
        if step == np.inf:
            along = terms[j]
            for i in range(x.size):
                along += abs(direction[i]) * terms[i]
            return w_j, LCP_ROUNDING * along
        for i in range(passive.size):
            if passive[i]:
                x[i] += step * direction[i]
        x[j] += step
        # x_j went the whole way: w_j has vanished, and j is passive.
        if blocking < 0:
            passive[j] = True
            return 0.0, 0.0
        # An entry has come to zero: it leaves, and the way goes on from the w_j that is left.
        w_j += step * schur
        x[blocking] = 0.0
        passive[blocking] = False
        count -= 1


@scalar_kernel
def _count(passive: np.ndarray) -> int:
    """How many entries are passive."""
    total = 0
    for i in range(passive.size):
        total += passive[i]
    return total


@scalar_kernel
def _pivot_to_solution(
    G: Floats, q: Floats, noise: Floats, x: Floats, w: Floats, passive: np.ndarray, work: _Work
) -> bool:
    """Principal pivoting on a matrix with unit diagonal; False where it did not end."""
    size, cycle_noise, fresh = q.size, work.rows[_NOISE], work.rows[_FOUND]
    for _ in range(50 * size + 50):
        level = _residual(G, x, q, w, work.rows[_TERMS])
        j = _most_violated(w, passive, level, cycle_noise)
        if j < 0:
            for i in range(size):
                w[i] = 0.0 if passive[i] else max(w[i], 0.0)
            return True
        left, rounding = _enter(G, x, w[j], j, passive, work)
        rounding = max(rounding, noise[j])
        # x_j would grow for ever and help nothing: there is no solution.
        if -left > rounding:
            return False
        cycle_noise[j] = rounding
        # Solved anew from q, as the entries carry the rounding of every step so far.
        for i in range(size):
            work.rows[_RIGHT, i] = -q[i]
        _solve_passive(G, passive, _count(passive), work)
        feasible = True
        for i in range(size):
            feasible = feasible and fresh[i] >= 0.0
        # Where that makes one negative by rounding, the entries stay as the steps have left them.
        if feasible:
            copy_numbers(fresh, x)
    return False


@kernel
def solve_dense(G: Floats, q: Floats, noise: float) -> tuple[Floats, Floats, bool]:
    """Solve ``0 <= G x + q ⊥ x >= 0`` for a symmetric positive semidefinite G.

    Parameters
    ----------
    G : ndarray, shape (k, k)
        Symmetric positive semidefinite, positive diagonal.
    q : ndarray, shape (k,)
        Right-hand side.
    noise : float
        What an entry of q may be wrong by. Along a cycle of contacts w can be
        no larger than the sum of q, which then is zero only to this.

    Returns
    -------
    x, w : ndarray, shape (k,)
        The solution; at most one of ``x_i`` and ``w_i`` differs from zero.
    solved : bool
        False where the problem has no solution or pivoting did not end.
    """
    size = q.size
    scaled, lower = np.empty((size, size)), np.empty((size, size))
    root, right, level = np.empty(size), np.empty(size), np.empty(size)
    x, w = np.zeros(size), np.empty(size)
    for i in range(size):
        root[i] = np.sqrt(G[i, i])
        # Along a cycle up to all entries of q add up.
        right[i], level[i] = q[i] / root[i], size * noise / root[i]
    for i in range(size):
        for j in range(size):
            # With a unit diagonal thresholds mean the same for light and for heavy bodies.
            scaled[i, j] = G[i, j] / (root[i] * root[j])
    work = _Work(lower, np.zeros((6, size)), np.empty(size, np.int64))
    solved = _pivot_to_solution(scaled, right, level, x, w, np.zeros(size, np.bool_), work)
    for i in range(size):
        x[i] /= root[i]
        w[i] *= root[i]
    return x, w, solved


@kernel
def _solve_rows(coupling: Floats, rhs: Floats, passive: np.ndarray, x: Floats) -> None:
    """Solve ``G_PP x_P = rhs_P`` run by run of neighbouring passive entries; zero elsewhere.

    Each pivot is ``c_(i+1)`` and the coupling of the run so far to its left,
    which combine as springs do: nothing is subtracted, so a pivot has full
    relative accuracy and vanishes only where the matrix is singular. There,
    on a whole row between two ends that do not move, x is unique but for a
    constant, the smallest that keeps it from being negative.
    """
    size = rhs.size
    to_left = 0.0
    pivot = np.empty(size)
    for i in range(size):
        x[i] = rhs[i]
        if i > 0 and passive[i - 1]:
            x[i] += coupling[i] / pivot[i - 1] * x[i - 1]
            # Two springs in series, c_i and the run behind it.
            to_left *= coupling[i] / pivot[i - 1]
        else:
            to_left = coupling[i]
        pivot[i] = to_left + coupling[i + 1]
        if not passive[i] or pivot[i] == 0.0:
            x[i] = 0.0
    singular = pivot[size - 1] == 0.0 and passive.all()
    for i in range(size - 1, -1, -1):
        if passive[i] and pivot[i] > 0.0:
            if i + 1 < size and passive[i + 1]:
                x[i] += coupling[i + 1] * x[i + 1]
            x[i] /= pivot[i]
    if singular:
        x -= np.min(x)


@kernel
def solve_chain(coupling: Floats, q: Floats) -> tuple[Floats, Floats]:
    """Solve ``0 <= G x + q ⊥ x >= 0`` for a row of k contacts between k + 1 masses.

    ``G_ii = c_i + c_(i+1)``, ``G_(i,i+1) = -c_(i+1)`` is a Stieltjes matrix:
    an entry that has become positive never has to return to zero, so whole
    sets enter at once and each pass costs O(k).

    Parameters
    ----------
    coupling : ndarray, shape (k + 1,)
        c = 1/m of each mass, from left to right; zero for one that does not
        move, which only the two at the ends may be.
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
            diagonal = coupling[i] + coupling[i + 1]
            before = coupling[i] * x[i - 1] if i > 0 else 0.0
            after = coupling[i + 1] * x[i + 1] if i + 1 < size else 0.0
            w[i] = q[i] + diagonal * x[i] - before - after
            terms = abs(q[i]) + diagonal * abs(x[i]) + abs(before) + abs(after)
            # w is summed from four terms: within their rounding it has no sign.
            if not passive[i] and w[i] < -32.0 * EPS * terms:
                passive[i] = True
                grown = True
        if grown:
            _solve_rows(coupling, -q, passive, x)
    for i in range(size):
        if passive[i]:
            w[i] = 0.0
            # What has entered stays positive (a Stieltjes matrix): below zero it is rounding.
            x[i] = max(x[i], 0.0)
        else:
            w[i] = max(w[i], 0.0)
    return x, w
